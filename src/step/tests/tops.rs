//! Tops that spin fast on the ground, against the closed forms of a symmetric top.

use super::*;
use nalgebra::{Quaternion, UnitQuaternion};

/// A top of 0.1 kg on a round tip of 1 mm without friction, which spins with 300 rad/s: its centre
/// of mass is at rest, `l` above the tip's middle, and the ground pushes with `m g`. With `A` and
/// `C` across and along its axis, the lean `θ` and the rate `P` about the vertical, it precesses
/// steadily where
///
/// ```text
/// A P² cos θ − C w P + m g l = 0
/// ```
///
/// (Goldstein 1980, section 5-7, about the centre of mass.) The lean stays for ever. Bounds are for
/// the root mean square over four leans: one alone may be right by chance.
#[test]
fn a_top_without_friction_leans_as_it_begins() {
    let modes =
        [(1e-2, 3e-2), (1e-3, 2e-2), (1e-4, 2e-3)].map(|(tolerance, off)| (0.0, tolerance, off));
    let fixed = [(1.0 / 240.0, 1e-3, 1e-3)];
    for (step, tolerance, off) in modes.into_iter().chain(fixed) {
        let leans = [0.1_f64, 0.2, 0.304, 0.4];
        let errors = leans.map(|lean| leans_later(lean, [step, tolerance]) - lean);
        let mean = (errors.map(|e| e * e).iter().sum::<f64>() / 4.0).sqrt();
        assert!(mean < off, "{step} {tolerance}: {errors:?}");
    }
}

/// How much it leans after 8 s, rad.
fn leans_later(lean: f64, [step, tolerance]: [f64; 2]) -> f64 {
    let (mass, [across, along], high, spin) = (0.1, [1e-4, 5e-5], 0.04, 300.0);
    let (a, b, c) = (across * lean.cos(), along * spin, mass * G * high);
    let rate = (b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    let axis = Vec3::new(lean.sin(), 0.0, lean.cos());
    let mut top = Builder::new(true, inertia(mass, Vec3::zeros(), [across, across, along]));
    let tip = Shape::Sphere { radius: 1e-3 };
    top.shape(0u32.into_link(), tip, at(0.0, 0.0, -high));
    top.model.world.ground = Some(crate::model::Ground {
        friction: 0.0,
        ..Default::default()
    });
    top.model.roots[0].rpy.y = lean;
    top.model.roots[0].position.z = high * lean.cos() + 1e-3;
    top.model.roots[0].angular_velocity = axis * spin + (Vec3::z() - axis * lean.cos()) * rate;
    top.model.solver.step_size = step;
    let mut s = start(top.model, tolerance);
    run(&mut s, 8.0, 1.0 / 240.0);
    let q = &s.state().physical.q;
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[4], q[5], q[6]));
    (turn * Vec3::z()).z.acos()
}
