//! A shape where it stands, and how far it reaches along a direction.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::{Core, Solid};
use crate::spatial::{Mat3, Pose, Vec3};

/// Outward unit normal of a flat face, and how far it is from the origin along that, m.
pub(super) type Face = (Vec3, f64);

/// A solid in a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub(super) solid: &'a Solid,
    pub(super) core: &'a Core,
    pub(super) R: Mat3,
    pub(super) p: Vec3,
}

impl<'a> Placed<'a> {
    /// The solid at `X`, with positions from `origin`.
    pub(super) fn new(solid: &'a Solid, X: &Pose, origin: &Vec3) -> Self {
        Self {
            solid,
            core: &solid.core,
            R: X.R,
            p: X.p - origin,
        }
    }

    /// The same with its inner core.
    pub(super) fn inner(&self) -> Self {
        Self {
            core: &self.solid.inner,
            ..*self
        }
    }

    /// The z axis of the solid.
    pub(super) fn axis(&self) -> Vec3 {
        self.R.column(2).into()
    }

    /// A point of its own axes in those of the poses.
    pub(super) fn world(&self, local: &Vec3) -> Vec3 {
        self.p + self.R * local
    }

    /// A face of its own axes in those of the poses.
    pub(super) fn face(&self, (n, height): Face) -> Face {
        let n = self.R * n;
        (n, height + n.dot(&self.p))
    }

    /// See [`Solid::sides`].
    pub(super) fn sides(&self, face: usize) -> impl Iterator<Item = Face> + '_ {
        self.solid.sides(face).map(|side| self.face(side))
    }

    /// The point of the core that is farthest along `d`.
    pub(super) fn support(&self, d: &Vec3) -> Vec3 {
        self.world(&self.support_local(d))
    }

    /// The same in its own axes.
    pub(super) fn support_local(&self, d: &Vec3) -> Vec3 {
        let signed = |x: f64, by: f64| if by < 0.0 { -x } else { x };
        let local = self.R.tr_mul(d);
        match self.core {
            Core::HalfSpace | Core::Field(_) | Core::Surface(_) | Core::Point => Vec3::zeros(),
            Core::Segment { half } => Vec3::new(0.0, 0.0, signed(*half, local.z)),
            Core::Cylinder { radius, half } => {
                // Round-off of a direction along the axis stays across it.
                let off = (local.x * local.x + local.y * local.y).sqrt();
                let out = if off > 0.0 { radius / off } else { 0.0 };
                Vec3::new(local.x * out, local.y * out, signed(*half, local.z))
            }
            Core::Box { half } => half.zip_map(&local, signed),
            Core::Corners(corners) => corners.farthest(&local),
        }
    }
}

/// The gap of the cores of `a` and `b` along `n`: `min n·x` of A minus `max n·y` of B.
pub(super) fn separation(a: &Placed, b: &Placed, n: &Vec3) -> f64 {
    n.dot(&(a.support(&-n) - b.support(n)))
}

/// Pairs are treated in this order: balls, round shapes, polyhedra, the half-space.
pub(super) fn rank(s: &Solid) -> usize {
    match s.core {
        Core::Point => 0,
        Core::Segment { .. } | Core::Cylinder { .. } => 1,
        Core::Box { .. } | Core::Corners(_) => 2,
        Core::HalfSpace | Core::Field(_) | Core::Surface(_) => 3,
    }
}

impl Solid {
    /// Whether it goes on below its surface without an end: what is deep in it is still pushed out.
    /// Of a mesh, what is behind a triangle is not known.
    pub fn is_endless(&self) -> bool {
        matches!(self.core, Core::HalfSpace | Core::Field(_))
    }

    /// Whether it is a ball: what it touches, it touches in one point, in the direction in which
    /// the depth grows most.
    pub fn is_ball(&self) -> bool {
        matches!(self.core, Core::Point)
    }
}
