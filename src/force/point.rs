//! Points of a contact: corners of a face, and the lowest point of a cylinder's rim. What they do
//! together is in [`super::contact`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::spatial::{Vec3, Vec6, across, angular, linear};

/// A point of a contact, as found at the start of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactPoint {
    /// Which one of its shape; none between two shapes, whose points come and go with the poses.
    pub corner: Option<usize>,
    /// Position from O, m, world axes.
    pub x: Vec3,
    /// The unit vector `n` along which it is pushed: that of the contact, but on uneven ground,
    /// where each point has its own.
    pub normal: Vec3,
    /// What velocities move it by along its normal: the normal, but where a secant adds to it.
    pub row: Vec3,
    /// The same for a rotation of its body about O, m: `x × n`.
    pub arm: Vec3,
    /// Depth along the normal, negative apart, m.
    pub depth: f64,
    /// Share `m_i` in a face.
    pub share: f64,
    /// Share `ŵ_i` of the load at the start, or of the load to come where none is inside.
    pub load: f64,
    /// The rim whose lowest point it is, of a cylinder.
    pub rim: Option<Rim>,
}

impl ContactPoint {
    /// The one at `x` from O that is so deep along `normal`, without a load yet.
    pub fn new(corner: Option<usize>, x: Vec3, normal: &Vec3, [depth, share]: [f64; 2]) -> Self {
        Self {
            corner,
            x,
            normal: *normal,
            row: *normal,
            arm: x.cross(normal),
            depth,
            share,
            ..Self::default()
        }
    }

    /// Whether it is the same point of a shape as another one, found at another pose.
    pub fn is(&self, other: &Self) -> bool {
        self.corner.is_some() && self.corner == other.corner
    }

    /// Velocity along its normal with the spatial velocity `W`, positive apart, m/s.
    #[inline]
    pub fn along(&self, W: &Vec6) -> f64 {
        self.row.dot(&linear(W)) + self.arm.dot(&angular(W))
    }
}

/// The rim of a cylinder, as it stands at the start of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rim {
    /// The cylinder's axis, a unit vector.
    axis: Vec3,
    /// m
    pub radius: f64,
    /// What of the axis lies in the tangent plane, times the radius, m.
    pub a: Vec3,
    /// Crown, m.
    crown: f64,
    /// The same for damping, m: as deep as the contact is under a load, so that the far side of
    /// the face lands like the corner of a box.
    landing: f64,
    /// `q`, m.
    q: f64,
    /// `a/q`
    e: Vec3,
    /// `a/q` where the point is: the point keeps its place when the rim is turned, and with it the
    /// part of the tilt that its own motion contains.
    lever: Vec3,
    /// `χ`: 1 where the face is flat on the ground, 0 where it leans.
    pub flatness: f64,
    /// `b`: length of `a` below which its direction swings faster than the step, at least the
    /// crown, m.
    swing: f64,
    /// `1/(|a|² + b²)`, 1/m².
    turning: f64,
    /// Share `½ χ²`, with `χ` of the landing, of the damping of rocking that acts against tilting.
    pub tilt_damping: f64,
}

/// Where a rim has tilted to.
#[derive(Clone, Copy, Debug)]
pub struct Tilted {
    /// `a`, m.
    pub a: Vec3,
    /// `a/q` and `1/q`.
    pub end: (Vec3, f64),
    /// How much deeper its lowest point is than the point that was the lowest one, m.
    pub deeper: f64,
}

impl Rim {
    /// The rim of `radius` about `axis`, where `a` is what of the axis lies in the tangent plane,
    /// times the radius.
    pub fn new(axis: Vec3, a: Vec3, [radius, crown, landing]: [f64; 3]) -> Self {
        let mut rim = Self {
            axis,
            radius,
            crown,
            landing,
            swing: crown,
            ..Self::default()
        };
        rim.stand(a);
        rim.lever = rim.e;
        rim
    }

    /// Lets the direction of `a` turn within a step where `a` is shorter than `swing`, m.
    pub(super) fn let_swing(&mut self, swing: f64) {
        self.swing = swing.max(self.crown);
        self.stand(self.a);
    }

    /// Takes another `a`, and finds what follows from it.
    fn stand(&mut self, a: Vec3) {
        let (squared, crown) = (a.norm_squared(), self.crown * self.crown);
        self.a = a;
        self.q = (squared + crown).sqrt();
        self.e = a / self.q;
        self.flatness = crown / (squared + crown);
        self.turning = 1.0 / (squared + self.swing * self.swing);
        let landing = self.landing * self.landing;
        let flat = landing / (squared + landing);
        self.tilt_damping = 0.5 * flat * flat;
    }

    /// How far its lowest point is below its centre, but for the crown, m.
    pub fn lowest(&self) -> f64 {
        self.q - self.crown
    }

    /// `a/q`: where the load of the face is, from its middle, in radii.
    pub fn place(&self) -> Vec3 {
        self.e
    }

    /// `a/q` where the point is.
    pub fn direction(&self) -> Vec3 {
        self.lever
    }

    /// Where it goes if `a` moves by `tilt`.
    #[inline]
    pub(super) fn tilted(&self, tilt: &Vec3) -> Tilted {
        let a = self.a + tilt;
        let q = (a.norm_squared() + self.crown * self.crown).sqrt();
        // The difference of the two lengths by their squares: it may be small.
        let longer = tilt.dot(&(a + self.a)) / (q + self.q);
        let inverse = 1.0 / q;
        Tilted {
            a,
            end: (a * inverse, inverse),
            deeper: longer - self.lever.dot(tilt),
        }
    }

    /// `T x` for a vector in the tangent plane.
    #[inline]
    fn tilting(&self, x: &Vec3) -> Vec3 {
        (x * (self.swing * self.swing) + self.a * self.a.dot(x)) * self.turning
    }

    /// A unit vector across the axis.
    #[inline]
    pub(crate) fn axis_across(&self) -> Vec3 {
        across(&self.axis)
    }

    /// `ȧ`, m/s, for an angular velocity.
    #[inline]
    pub(super) fn rate(&self, normal: &Vec3, w: &Vec3) -> Vec3 {
        let across = w.cross(&self.axis) * self.radius;
        self.tilting(&(across - normal * normal.dot(&across)))
    }

    /// Turns the rim by the small rotation `w`; returns how much deeper its lowest point is than
    /// the point that was the lowest one.
    pub(super) fn shift(&mut self, normal: &Vec3, w: &Vec3) -> f64 {
        let Tilted { a, deeper, .. } = self.tilted(&self.rate(normal, w));
        self.stand(a);
        deeper
    }

    /// The moment that does to the body what `force`, along the tangent plane, does to `a`.
    #[inline]
    pub(crate) fn moment(&self, force: &Vec3) -> Vec3 {
        self.axis.cross(&self.tilting(force)) * self.radius
    }
}

/// Velocity of a contact point.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointVelocity {
    /// Along the normal, positive apart, m/s.
    pub along: f64,
    /// `ȧ` of its rim, m/s; zero without one.
    pub tilt: Vec3,
}

impl PointVelocity {
    /// This and `share` times another.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self, share: f64) -> Self {
        Self {
            along: self.along + share * other.along,
            tilt: self.tilt + other.tilt * share,
        }
    }
}

/// What a contact point gives for a velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointResponse {
    /// `w_i = ∂δ/∂d_i`.
    pub weight: f64,
    /// `∂w_i/∂d_i` as far as the point is its own, `3 m_i (d_i/δ)²/δ`, 1/m.
    pub bend: f64,
    /// Impulse along the normal, N·s.
    pub impulse: f64,
    /// Damping of rocking, N, and its slope, N·s/m.
    pub rock: f64,
    /// See `rock`.
    pub rocking: f64,
    /// Impulse along `ȧ` of its rim, N·s; zero without one.
    pub tilting: Vec3,
    /// `e₀ − e`, by which its rim has tilted; zero without one.
    pub lean: Vec3,
    /// `a/q` and `1/q` of its rim at the end of the step.
    pub end: (Vec3, f64),
}

/// Depth `δ` of points and the sum of `∂δ/∂d_i`, where all are `deeper`, m, than they are; the
/// deepest one's and 1 where none is inside.
pub(super) fn norm(points: &[ContactPoint], deeper: f64) -> (f64, f64) {
    let depths = || points.iter().map(|p| p.depth + deeper);
    let deepest = depths().fold(f64::NEG_INFINITY, f64::max);
    if deepest <= 0.0 {
        return (deepest, 1.0);
    }
    together(depths().zip(points).map(|(depth, p)| (depth, p.share)))
}

/// Depth `δ = (Σ m d₊⁴)^¼` of depths `d` with their shares `m`, and the sum of `∂δ/∂d`; 0 and NaN
/// where none is positive.
pub(super) fn together(depths: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (mut fourth, mut third) = (0.0, 0.0);
    for (depth, share) in depths {
        let d = depth.max(0.0);
        third += share * d * d * d;
        fourth += share * d * d * d * d;
    }
    let delta = fourth.sqrt().sqrt();
    (delta, third / (delta * delta * delta))
}

#[cfg(test)]
crate::spoil::spoil!(Rim: axis radius a crown landing q e lever flatness swing turning
    tilt_damping;);
