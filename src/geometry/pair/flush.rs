//! Solids that stand still with faces against each other, as the plates of a floor do.
//!
//! A plate has walls and edges where the next one begins, and nothing can come between the two.
//! With the rounded edge of each plate what slides over them would run against every edge: it lies
//! half a penetration deep, and comes upon an edge at up to 13°. So a direction out of a solid
//! never leans towards a wall that another one covers there: what the direction has along the
//! normal of that wall is left out. Between two level plates, the normal is that of both.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::beside::{Beside, Face};
use super::core::{Core, Solid};
use super::nearest::Apart;
use super::placed::{Placed, separation};
use super::points::{Points, point};
use crate::spatial::{Pose, Vec3};
use crate::tuning::{LEAN, SEAM, STRAIGHT};

impl Solid {
    /// Flat faces of a polyhedron.
    fn faces(&self) -> impl Iterator<Item = Face> + '_ {
        let mesh = &self.mesh;
        (0..mesh.normals.len()).map(|i| {
            let n = mesh.normals[i];
            (n, n.dot(&mesh.corners[mesh.face(i)[0]]))
        })
    }

    /// Whether it is a box or a hull.
    fn is_polyhedron(&self) -> bool {
        matches!(self.core, Core::Box { .. } | Core::Corners(_)) && !self.mesh.normals.is_empty()
    }

    /// What of `other`, which stands at `X` in its own axes, may cover its walls; none where these
    /// are apart.
    pub fn touched_by(&self, other: &Self, X: &Pose) -> Option<Beside> {
        let near = X.p.norm() <= self.reach + other.reach + SEAM;
        if !near || !self.is_polyhedron() || !other.is_polyhedron() {
            return None;
        }
        let faces: Vec<Face> = other
            .faces()
            .map(|(n, height)| {
                let n = X.R * n;
                (n, height + n.dot(&X.p))
            })
            .collect();
        let there: Vec<Vec3> = other.mesh.corners.iter().map(|x| X.point(x)).collect();
        let is_apart =
            |(n, height): Face, corners: &[Vec3]| corners.iter().all(|x| n.dot(x) > height + SEAM);
        let apart = faces.iter().any(|face| is_apart(*face, &self.mesh.corners))
            || self.faces().any(|face| is_apart(face, &there));
        (!apart).then_some(Beside::new(faces))
    }

    /// The same with others beside it; nothing where it has these already.
    pub fn with_beside(&self, beside: Vec<Beside>) -> Option<Self> {
        (self.beside != beside).then(|| Self {
            beside,
            ..self.clone()
        })
    }
}

/// A direction out of a solid that does not lean towards its covered walls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// The solid out of which it points: the first or the second.
    pub(super) first: bool,
    /// Unit vector out of the solid.
    pub(super) outward: Vec3,
    /// Between both cores along it, m.
    pub(super) distance: f64,
}

/// The direction out of `p` about the place `x`, in place of `n`; none where it stays.
fn kept(p: &Placed, n: &Vec3, x: &Vec3) -> Option<Vec3> {
    if p.solid.beside.is_empty() {
        return None;
    }
    let (mut d, mut x) = (p.R.tr_mul(n), p.R.tr_mul(&(x - p.p)));
    for (n, height) in p.solid.faces() {
        x -= n * (n.dot(&x) - height).max(0.0);
    }
    let mut changed = false;
    for (n, height) in p.solid.faces() {
        let lean = n.dot(&d);
        if lean > LEAN && is_covered(p.solid, (n, height), &x) {
            d -= n * lean;
            changed = true;
        }
    }
    // What points straight into a wall is deep in both solids, or in the corner between them.
    let d = d.try_normalize(STRAIGHT)?;
    changed.then(|| p.R * d)
}

/// Whether another solid covers a face beside the place `x` of it.
fn is_covered(solid: &Solid, (n, height): Face, x: &Vec3) -> bool {
    let beyond = x + n * (height - n.dot(x) + 2.0 * SEAM);
    solid.beside.iter().any(|other| other.holds(&beyond, SEAM))
}

/// The direction between two solids, from `b` to `a`, where one of them has covered walls to which
/// `n` leans.
///
/// Along it they are no deeper than before by more than the rounding of that solid, which is what
/// its edge takes away. Beside the edge of a table whose top a mat covers there would be a wall
/// left to point to, and what lies on the mat would be half its width deep in that.
///
/// - `apart`: how they are along `n`
pub(super) fn between(a: &Placed, b: &Placed, n: &Vec3, apart: &Apart) -> Option<Kept> {
    let radii = a.solid.radius + b.solid.radius;
    let of = |(p, o): (&Placed, &Placed), n: &Vec3, first| {
        let outward = kept(p, n, &apart.middle)?;
        let distance = separation(o, p, &outward);
        (distance >= apart.distance.min(radii) - p.solid.radius).then_some(Kept {
            first,
            outward,
            distance,
        })
    };
    of((b, a), n, false).or_else(|| of((a, b), &-n, true))
}

/// Whether a place is on the solid's own side of all its covered walls.
fn is_over(p: &Placed, x: &Vec3) -> bool {
    let x = p.R.tr_mul(&(x - p.p));
    p.solid
        .faces()
        .all(|face| face.0.dot(&x) <= face.1 || !is_covered(p.solid, face, &x))
}

/// The lowest places of a core: its corners, the ends of what is round, or its centre.
fn place(on: &Placed, down: &Vec3, index: usize) -> Option<Vec3> {
    let half = match on.core {
        Core::Segment { half } | Core::Cylinder { half, .. } => *half,
        Core::Point => 0.0,
        _ => return on.solid.core_corners.get(index).map(|x| on.world(x)),
    };
    let end = on.axis() * if index == 0 { half } else { -half };
    let radial = match on.core {
        Core::Cylinder { radius, .. } => {
            let across = down - on.axis() * on.axis().dot(down);
            across.try_normalize(f64::MIN_POSITIVE).unwrap_or_default() * *radius
        }
        _ => Vec3::zeros(),
    };
    let count = if half > 0.0 { 2 } else { 1 };
    (index < count).then(|| on.p + end + radial)
}

/// Adds the lowest points of what lies on a solid with covered walls, as far as they are over it:
/// they lose their shares as they rise by `blend` above the lowest one.
///
/// - `gap`, `left`: of the lowest one, m; the share of all together
pub(super) fn lowest(
    (a, b): (&Placed, &Placed),
    kept: &Kept,
    (gap, left): (f64, f64),
    blend: f64,
    points: &mut Points,
) {
    let (on, under) = if kept.first { (b, a) } else { (a, b) };
    let (up, down) = (kept.outward, -kept.outward);
    let places = || (0..).map_while(|i| place(on, &down, i));
    let least = places().fold(f64::INFINITY, |least, x| least.min(up.dot(&x)));
    let rise = |x: &Vec3| up.dot(x) - least;
    let weight = |x: &Vec3| (1.0 - rise(x) / blend).max(0.0);
    let total: f64 = places().map(|x| weight(&x)).sum();
    for x in places() {
        let (share, gap) = (left * weight(&x) / total, gap + rise(&x));
        if share > 0.0 && is_over(under, &x) {
            let middle = x - up * (on.solid.radius + 0.5 * gap);
            points.add(0, point(middle, -gap, share));
        }
    }
}
