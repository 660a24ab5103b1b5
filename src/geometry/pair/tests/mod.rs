//! Tests of contact between two shapes.

mod along;
mod apart;
mod cases;
mod depths;
mod distances;
mod heights;
mod jumps;
mod leads;
pub(crate) mod lifts;
mod meshes;
mod nearby;
pub(crate) mod solids;
mod thin;

use super::{Patch, PatchPoint, Side, Solid};
use crate::geometry::Shape;
use crate::spatial::{Mat3, Pose, Vec3};
use crate::testing::Random;

/// Within it corners of a hull count as in one face on a plane, m.
pub(super) const THICKNESS: f64 = 3e-4;

pub(super) fn solid(shape: &Shape) -> Solid {
    Solid::new(shape, THICKNESS)
}

pub(super) fn cube(half: f64) -> Shape {
    Shape::Box {
        half: Vec3::repeat(half),
    }
}

/// A rotation by an angle about an axis.
pub(super) fn turned(axis: Vec3, angle: f64) -> Mat3 {
    *nalgebra::Rotation3::new(axis.normalize() * angle).matrix()
}

pub(super) fn at(p: Vec3, R: Mat3) -> Pose {
    Pose { R, p }
}

pub(super) fn any_rotation(random: &mut Random) -> Mat3 {
    let axis = random.unit();
    turned(axis, random.uniform(0.0, std::f64::consts::PI))
}

/// Corners of a dodecahedron about a sphere of that radius.
pub(super) fn dodecahedron(radius: f64) -> Shape {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for i in 0..8 {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        vertices.push(Vec3::new(sign(1), sign(2), sign(4)));
        if i & 4 == 0 {
            let (x, y) = (sign(1) / golden, sign(2) * golden);
            vertices.push(Vec3::new(0.0, x, y));
            vertices.push(Vec3::new(x, y, 0.0));
            vertices.push(Vec3::new(y, 0.0, x));
        }
    }
    for v in &mut vertices {
        *v *= radius / 3.0_f64.sqrt();
    }
    Shape::Hull { vertices }
}

/// The hull of so many random points of an ellipsoid.
pub(super) fn cloud(count: usize, size: f64, random: &mut Random) -> Shape {
    let points: Vec<Vec3> = (0..count)
        .map(|_| (random.unit() * size).component_mul(&Vec3::new(1.0, 0.8, 0.6)))
        .collect();
    Shape::Hull {
        vertices: crate::geometry::convex_hull(&points).expect("a hull"),
    }
}

/// A ball, a capsule, a cylinder, a box or a hull.
pub(crate) fn any_shape(kind: usize, size: f64, random: &mut Random) -> Shape {
    let mut extent = || random.uniform(0.3, 1.0) * size;
    let (radius, half_length) = (extent(), extent());
    match kind {
        0 => Shape::Sphere { radius },
        1 => Shape::Capsule {
            radius,
            half_length,
        },
        2 => Shape::Cylinder {
            radius,
            half_length,
        },
        3 => Shape::Box {
            half: Vec3::new(radius, half_length, extent()),
        },
        _ => cloud(10 + random.below(20), 0.6 * size, random),
    }
}

/// Depth of the fourth-power mean.
pub(super) fn depth(points: &[PatchPoint]) -> f64 {
    let fourth: f64 = points
        .iter()
        .map(|p| p.share * p.depth.max(0.0).powi(4))
        .sum();
    fourth.sqrt().sqrt()
}

pub(super) fn find(a: (&Shape, Pose), b: (&Shape, Pose), reach: f64) -> Patch {
    let mut patch = Patch::new();
    patch.find((&solid(a.0), &a.1), (&solid(b.0), &b.1), reach);
    patch
}
