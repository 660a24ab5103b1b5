//! What lies across hills so smooth that no sample of them is sharp.

use super::terrain::{field, ground, over};
use super::worlds::body;
use super::*;
use crate::spatial::rotation_from_quaternion;

/// Radius of the hills, m: one metre from its top a hill is 5 cm lower.
const RADIUS: f64 = 10.0;

/// Half of the length of what lies on them, m.
const HALF: f64 = 1.0;

fn ridge(x: f64, _: f64) -> f64 {
    -0.5 * x * x / RADIUS
}

fn dome(x: f64, y: f64) -> f64 {
    ridge(x, 0.0) + ridge(y, 0.0)
}

/// A board, a plank as a hull, a roller and a capsule lying along x, and a disc that lies flat,
/// with half of their thickness, m.
fn shapes() -> [(&'static str, Shape, Vec3, f64); 5] {
    let (radius, half_length) = (0.05, HALF);
    let lying = Vec3::new(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    let half = Vec3::new(HALF, 0.25, radius);
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        half.component_mul(&Vec3::new(sign(1), sign(2), sign(4)))
    };
    let vertices = (0..8).map(corner).collect();
    let disc = Shape::Cylinder {
        radius: HALF,
        half_length: radius,
    };
    let roller = Shape::Cylinder {
        radius,
        half_length,
    };
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    [
        ("board", Shape::Box { half }, Vec3::zeros(), radius),
        ("hull", Shape::Hull { vertices }, Vec3::zeros(), radius),
        ("roller", roller, lying, radius),
        ("capsule", capsule, lying, radius),
        ("disc", disc, Vec3::zeros(), radius),
    ]
}

/// How deep a hill passes into the underside of what lies on it, m, and how far that tilts, rad:
/// the highest point of the hill over the lowest line along x, whose ends are 5 cm above the hill.
fn inside(s: &Simulation, thickness: f64, rpy: Vec3, hill: fn(f64, f64) -> f64) -> (f64, f64) {
    let q = &s.state().physical.q;
    let R = rotation_from_quaternion(&[q[3], q[4], q[5], q[6]]);
    let along = R * if rpy.y == 0.0 { Vec3::x() } else { Vec3::z() };
    let down = along * along.z - Vec3::z();
    let low = Vec3::new(q[0], q[1], q[2]) + down / down.norm() * thickness;
    let deep = (-1000..=1000).map(|k| {
        let x = low + along * (f64::from(k) * 1e-3 * HALF);
        hill(x.x, x.y) - x.z
    });
    (deep.fold(f64::NEG_INFINITY, f64::max), along.z)
}

/// Corners and rims alone let each of them 5 cm into the hill. Now a load rests on the places near
/// the top, one of at most `n` = 100 of a face: by the fourth-power mean of the law these are no
/// deeper than `n^¼` = 3.2 times the 0.05 mm of a face, but for what the hill is higher between two
/// places `c` = 0.17 m apart, `c²/(8 R)` = 0.36 mm.
#[test]
fn what_lies_across_a_smooth_hill_does_not_sink_into_it() {
    for (name, shape, rpy, thickness) in shapes() {
        for (kind, hill) in [("ridge", ridge as fn(f64, f64) -> f64), ("dome", dome)] {
            let fixed = 1.0 / 240.0;
            for (cells, x, step) in [(200, 0.0, 0.0), (60, 0.07, 0.0), (8, 0.03, fixed)] {
                let mut model = body(10.0, shape.clone(), Vec3::new(x, 0.0, thickness + 1e-3));
                model.roots[0].rpy = rpy;
                let hills = ground(field(4.0, cells, hill), Vec3::zeros());
                let mut model = over(hills, model);
                model.solver.step_size = step;
                let mut s = start(model, 1e-3);
                run(&mut s, 1.0, 1.0 / 60.0);
                let (deep, _) = inside(&s, thickness, rpy, hill);
                assert!(
                    (-1e-4..6e-4).contains(&deep),
                    "{name} on a {kind} of {cells} cells: {deep:e}"
                );
            }
        }
    }
}
