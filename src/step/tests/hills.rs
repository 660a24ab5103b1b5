//! What lies across hills so smooth that no sample of them is sharp, or rolls in a pipe.

use super::terrain::{field, ground, mesh, over};
use super::worlds::{body, books};
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

/// A ball of 0.1 m without friction that slides to and fro in a half-pipe of 0.5 m, a mesh of
/// strips of 2.6 mm, for 3 s. Truth: an integration of the ball on the deepest strip, with the same
/// law, loses 3 mJ of 0.48 J, at a penetration of 1 mm 15 mJ, and without dissipation 2 mJ. While
/// two strips carried the ball twice at each edge, it lost up to 62 mJ and up to 0.43 J, the more
/// the smaller the tolerance, and without dissipation it rose by 0.21 J.
#[test]
fn a_ball_in_a_pipe_of_triangles_is_carried_once() {
    let (wide, radius, strips) = (0.5, 0.1, 720);
    let at = |i: usize, y: f64| {
        let angle = 1.2 * std::f64::consts::PI * (i as f64 / strips as f64 - 0.5);
        Vec3::new(wide * angle.sin(), y, wide * (1.0 - angle.cos()))
    };
    let pipe: Vec<[Vec3; 3]> = (0..strips)
        .flat_map(|i| {
            let [a, b] = [i, i + 1].map(|i| [-0.5, 0.5].map(|y| at(i, y)));
            [[a[0], b[0], b[1]], [a[0], b[1], a[1]]]
        })
        .collect();
    let way = wide - radius;
    let begin = Vec3::new(way * 0.5_f64.sin(), 0.0, wide - way * 0.5_f64.cos());
    for (penetration, dissipation, most) in
        [(1e-4, 51.0, 0.022), (1e-3, 51.0, 0.026), (1e-4, 0.0, 0.022)]
    {
        for (tolerance, fixed_step) in [(1e-3, 0.0), (1e-4, 0.0), (1e-5, 0.0), (1e-3, 1.0 / 240.0)]
        {
            let mut model = over(
                ground(mesh(&pipe), Vec3::zeros()),
                body(1.0, Shape::Sphere { radius }, begin),
            );
            for link in &mut model.links {
                link.friction = 0.0;
            }
            model.contact.penetration = penetration;
            model.contact.dissipation = dissipation;
            model.solver.step_size = fixed_step;
            let mut s = start(model, tolerance);
            let (whole, mut least, mut rise) = (books(&s).2, f64::INFINITY, 0.0_f64);
            for i in 1..=720 {
                run(&mut s, f64::from(i) / 240.0, 1.0 / 240.0);
                let held = books(&s).2;
                least = least.min(held);
                rise = rise.max(held - least);
            }
            let lost = whole - books(&s).2;
            let case = format!("{penetration} m, {dissipation}, {tolerance}, {fixed_step}");
            assert!(lost < most, "{case}: {lost} J lost");
            assert!(rise < 6e-3, "{case}: rose by {rise} J");
        }
    }
}
