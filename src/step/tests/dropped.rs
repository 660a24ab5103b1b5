//! What is dropped onto the ground or onto a box: how many steps it takes, and where it ends.

use super::worlds::{body, cube, depth, table, world};
use super::*;

/// Steps in `end` seconds of something that is dropped onto the plane, or onto a table whose top is
/// 1 m high, and where it is then; communication steps are 10 ms.
fn dropped(mut thing: Model, on_table: bool, tolerance: f64, end: f64) -> (u64, Simulation) {
    let model = if on_table {
        thing.roots[0].position.z += 1.0;
        world([table(), thing])
    } else {
        thing
    };
    let mut s = start(model, tolerance);
    run(&mut s, end, 0.01);
    (s.state().stepping.counters.steps, s)
}

/// A cube of 10 cm falls by 1 cm onto an edge, 0.1 rad beside its balance, and over onto a face: a
/// step for each communication step, and some for the two impacts, on the plane as on a box.
#[test]
fn a_cube_that_is_dropped_on_an_edge_takes_few_steps() {
    for (tolerance, most) in [(1e-3, 250), (1e-5, 900)] {
        for on_table in [false, true] {
            let tilt = std::f64::consts::FRAC_PI_4 - 0.1;
            let lowest = 0.05 * (libm::sin(tilt) + libm::cos(tilt));
            let mut thing = cube(1.0, Vec3::new(0.0, 0.0, lowest + 0.01));
            thing.roots[0].rpy.x = tilt;
            let (steps, s) = dropped(thing, on_table, tolerance, 2.0);
            let sunk = 0.05 + f64::from(u8::from(on_table)) - s.state().physical.q[2];
            assert!(
                (sunk - depth(1.0)).abs() < 1e-9,
                "{on_table}, {tolerance}: {sunk}"
            );
            assert!(steps <= most, "{on_table}, {tolerance}: {steps} steps");
        }
    }
}

/// A can of 3 cm radius and 12 cm is dropped 8.6° off upright: it rocks, and stands exactly still
/// within four seconds, as deep on its one rim as the law says, in less than 600 steps.
#[test]
fn a_can_that_is_dropped_askew_stands_still() {
    let (radius, half_length) = (0.03, 0.06);
    let shape = Shape::Cylinder {
        radius,
        half_length,
    };
    for on_table in [false, true] {
        let tilt = 8.6_f64.to_radians();
        let lowest = half_length * libm::cos(tilt) + radius * libm::sin(tilt);
        let mut thing = body(1.0, shape.clone(), Vec3::new(0.0, 0.0, lowest + 1e-3));
        thing.roots[0].rpy.x = tilt;
        let (steps, s) = dropped(thing, on_table, 1e-3, 4.0);
        let sunk = half_length + f64::from(u8::from(on_table)) - s.state().physical.q[2];
        let root = libm::pow(0.5, 0.25);
        let expected = depth(1.0 / root) / root;
        assert!(
            (sunk - expected).abs() < 1e-7,
            "{on_table}: {sunk} {expected}"
        );
        assert!(s.state().physical.v.iter().all(|v| *v == 0.0), "{on_table}");
        assert!(steps <= 600, "{on_table}: {steps} steps");
    }
}
