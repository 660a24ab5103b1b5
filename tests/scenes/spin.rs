//! Bodies that turn freely.

use super::truth::{angle_between, euler, runge_kutta};
use super::{BASE, H, Run, Scene, Solver, Z, figure, idle, last, play};
use crate::testing::{Builder, inertia};
use std::sync::OnceLock;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{ActuatorMode, Motion};
use urdf2fmu_core::simulation::Simulation;
use urdf2fmu_core::spatial::{Pose, Vec3, rotation_from_quaternion};

/// Moments of inertia of a satellite's body and of its wheel, kg·m².
const BODY: [f64; 3] = [0.02, 0.03, 0.045];
const WHEEL: [f64; 3] = [1.5e-4, 1.5e-4, 3e-4];
/// Angular velocity of the satellite at the beginning, rad/s.
pub const SPIN: [f64; 3] = [0.4, 0.8, 2.5];

/// Orientation, angle of the wheel, energy and angular momentum in world axes, from the formulas
/// of two bodies with one centre of mass.
fn satellite_state(s: &Simulation, stiffness: f64) -> Vec<f64> {
    let state = &s.state().physical;
    let quaternion = [state.q[3], state.q[4], state.q[5], state.q[6]];
    let R = rotation_from_quaternion(&quaternion);
    let w = R.transpose() * Vec3::new(state.v[0], state.v[1], state.v[2]);
    let (angle, rate) = (state.q[7], state.v[6]);
    let all = Vec3::from_fn(|i, _| BODY[i] + WHEEL[i]);
    let momentum = all.component_mul(&w) + Z * (WHEEL[2] * rate);
    let energy = 0.5 * w.dot(&all.component_mul(&w))
        + WHEEL[2] * rate * (w.z + 0.5 * rate)
        + 0.5 * stiffness * angle * angle;
    let momentum = R * momentum;
    let mut seen = quaternion.to_vec();
    seen.extend([angle, energy, momentum.x, momentum.y, momentum.z]);
    seen
}

/// A satellite that turns by `spin` at the beginning and has a wheel that an undamped pd law of
/// `stiffness` N·m/rad holds, or a velocity motor where that is 0, without gravity, for 300 s.
pub fn satellite(stiffness: f64, spin: [f64; 3]) -> Scene {
    let sprung = stiffness > 0.0;
    let end = 300.0;
    let simulate = move |solver| {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), BODY));
        b.model.world.gravity = Vec3::zeros();
        let wheel = inertia(0.2, Vec3::zeros(), WHEEL);
        let wheel = b.link(BASE, Pose::IDENTITY, Motion::Revolute(Z), wheel);
        let mode = if sprung {
            ActuatorMode::Pd
        } else {
            ActuatorMode::Velocity
        };
        b.actuator(wheel, mode, 10.0);
        b.model.actuators[0].kp = stiffness;
        b.model.roots[0].angular_velocity = Vec3::from(spin);
        let mut watch = last(move |s| satellite_state(s, stiffness));
        play(b.model, solver, [H, end], &mut idle, &mut watch)
    };
    // The same whatever the solver, and a million evaluations.
    let rigid = OnceLock::new();
    let judge = move |solver: Solver, run: &Run| {
        let seen = run.seen_or_nan(9);
        let all: [f64; 3] = std::array::from_fn(|i| BODY[i] + WHEEL[i]);
        let energy: f64 = (0..3).map(|i| 0.5 * all[i] * spin[i] * spin[i]).sum();
        let before = Vec3::from_fn(|i, _| all[i] * spin[i]);
        let momentum = Vec3::new(seen[6], seen[7], seen[8]);
        let start = [1.0, 0.0, 0.0, 0.0, spin[0], spin[1], spin[2]];
        let rigid = rigid.get_or_init(|| runge_kutta(euler(all), start, end, 300_000));
        vec![
            figure(
                "energy after 300 s, relative",
                seen[5] / energy - 1.0,
                solver.tolerances(10.0).unwrap_or(0.01),
            ),
            figure(
                "angular momentum, relative",
                (momentum - before).norm() / before.norm(),
                solver.tolerances(10.0).unwrap_or(0.01),
            ),
            figure(
                "orientation after 300 s, rad",
                angle_between(&seen[..4], &rigid[..4]),
                None,
            ),
        ]
    };
    let held = if sprung {
        format!("{stiffness} N·m/rad")
    } else {
        "a motor".into()
    };
    Scene {
        name: format!("satellite {spin:?} rad/s, wheel held by {held}"),
        source: "Euler's equations",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}

/// A box of 0.3 × 0.2 × 0.1 m and 1 kg that tumbles without gravity from the angular velocity
/// `spin` in its own axes, for 5 s; with its shape above a ground if `shaped`.
pub fn tumble(spin: [f64; 3], shaped: bool) -> Scene {
    let I = [0.05 / 12.0, 0.1 / 12.0, 0.13 / 12.0];
    let simulate = move |solver| {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), I));
        b.model.world.gravity = Vec3::zeros();
        b.model.roots[0].angular_velocity = Vec3::from(spin);
        if shaped {
            let half = Vec3::new(0.15, 0.1, 0.05);
            b.shape(BASE, Shape::Box { half }, Pose::IDENTITY);
            b.model.roots[0].position.z = 1.0;
        }
        let mut watch = last(|s| s.state().physical.q[3..7].to_vec());
        play(b.model, solver, [H, 5.0], &mut idle, &mut watch)
    };
    let judge = move |solver: Solver, run: &Run| {
        let start = [1.0, 0.0, 0.0, 0.0, spin[0], spin[1], spin[2]];
        let exact = runge_kutta(euler(I), start, 5.0, 50_000);
        let off = angle_between(&run.seen_or_nan(4), &exact[..4]);
        let name = "orientation after 5 s, rad";
        vec![figure(name, off, solver.falling(1e-2, 1e-7))]
    };
    Scene {
        name: format!(
            "tumble {spin:.2?} rad/s{}",
            if shaped { ", above a ground" } else { "" }
        ),
        source: "Euler's equations",
        simulate: Box::new(simulate),
        judge: Box::new(judge),
        reference: None,
    }
}
