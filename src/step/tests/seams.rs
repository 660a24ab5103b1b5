//! What goes over edges between the triangles of a mesh.

use super::terrain::{ground, mesh, over};
use super::worlds::{body, depth};
use super::*;

/// Share of its energy that a ball without friction has left that went at `v` over one hollow edge
/// of `angle`, from level ground.
fn left(angle: f64, v: f64, [tolerance, step]: [f64; 2]) -> f64 {
    let (sin, cos) = libm::sincos(angle);
    let across = |[x, z]: [f64; 2], y: f64| Vec3::new(3.0 * x, y, 3.0 * z);
    let strip = |a, b| {
        let [p, q, r, s] = [
            across(a, -1.0),
            across(b, -1.0),
            across(b, 1.0),
            across(a, 1.0),
        ];
        [[p, q, r], [p, r, s]]
    };
    let edge = [0.0; 2];
    let valley = mesh(&[strip([-1.0, 0.0], edge), strip(edge, [cos, sin])].concat());
    let rest = 0.05 - depth(1.0);
    let ball = Shape::Sphere { radius: 0.05 };
    let mut one = body(1.0, ball, Vec3::new(-0.2, 0.013, rest));
    one.links[0].friction = 0.0;
    one.roots[0].linear_velocity.x = v;
    let mut model = over(ground(valley, Vec3::zeros()), one);
    model.solver.step_size = step;
    let mut s = start(model, tolerance);
    run(&mut s, 0.5 / v, 1.0 / 240.0);
    let state = &s.state().physical;
    assert!(state.q[0] > 0.2, "it is over the edge: {}", state.q[0]);
    let moving: f64 = state.v[3..6].iter().map(|v| 0.5 * v * v).sum();
    (moving + G * (state.q[2] - rest)) / (0.5 * v * v)
}

/// A rigid ball keeps the speed along the new facet, `cos²` of the angle of its energy. This one
/// lies in the edge on two springs, where its contact is `2^¼` times as deep at once: by the law
/// these hold 0.21 of its weight times its depth more than one did, which is lost where the ball
/// leaves the first one. It also swings on them, so that a third is allowed. Damping along rows
/// that secants had bent took up to 10 % of the energy.
#[test]
fn a_ball_that_crosses_a_hollow_edge_of_a_mesh_loses_what_a_rigid_one_does() {
    for degrees in [0.1_f64, 0.3] {
        let angle = degrees.to_radians();
        for v in [1.0, 3.0, 10.0] {
            let rigid = libm::cos(angle) * libm::cos(angle);
            let springs = G * depth(1.0) / 3.0 / (0.5 * v * v);
            for how in [
                [1e-3, 0.0],
                [1e-6, 0.0],
                [1e-8, 0.0],
                [1e-3, 1.0 / 240.0],
                [1e-3, 1e-4],
            ] {
                let left = left(angle, v, how);
                assert!(
                    (rigid - springs..1.0 + 1e-6).contains(&left),
                    "{degrees}° at {v} m/s, {how:?}: {left} of {rigid}"
                );
            }
        }
    }
}
