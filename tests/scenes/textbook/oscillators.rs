//! Springs: swinging, orbiting, in a row, driven, and with dry friction.

use super::joints::{body, plan};
use super::{BASE, Command, at_places, compare, hold_at_zero, motor, set};
use crate::scenes::truth::runge_kutta;
use crate::scenes::{G, H, Scene, X, Y, Z, fixed};
use crate::testing::at;
use urdf2fmu_core::model::{ActuatorMode, LinkId, Motion};
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, RigidInertia, Vec3};

/// A mass on an elastic string, tuned so that swinging and stretching exchange energy.
fn elastic_pendulum() -> Scene {
    let kp = 3.0 * G;
    let make = move || {
        let mut b = fixed();
        let hinge = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Revolute(-Y),
            RigidInertia::ZERO,
        );
        let bob = b.link(
            hinge,
            at(0.0, 0.0, -1.0),
            Motion::Prismatic(-Z),
            body(1.0, 0.0),
        );
        motor(&mut b, bob, ActuatorMode::Pd, [kp, 0.0]);
        b.model.initial.joint_positions = vec![0.5, 1.0 / 3.0];
        (b.model, hold_at_zero(1))
    };
    let truth = move || {
        let rates = |x: &[f64; 4]| {
            let [angle, stretch, turns, grows] = *x;
            let (r, (sin, cos)) = (1.0 + stretch, libm::sincos(angle));
            let bend = -(G * sin + 2.0 * grows * turns) / r;
            [
                turns,
                grows,
                bend,
                r * turns * turns + G * cos - kp * stretch,
            ]
        };
        runge_kutta(rates, [0.5, 1.0 / 3.0, 0.0, 0.0], 6.0, 60_000)[..2].to_vec()
    };
    let plan = plan("elastic pendulum, 6 s", "Lagrange's equations", 6.0);
    compare(plan, make, at_places([0, 1]), truth)
}

/// A mass on isotropic springs goes round an ellipse about their centre.
fn ellipse() -> Scene {
    let omega = std::f64::consts::TAU;
    let make = move || {
        let mut b = fixed();
        b.model.world.gravity = Vec3::zeros();
        let along = b.link(
            BASE,
            Pose::IDENTITY,
            Motion::Prismatic(X),
            RigidInertia::ZERO,
        );
        let bob = b.link(along, Pose::IDENTITY, Motion::Prismatic(Y), body(1.0, 1e-3));
        for link in [along, bob] {
            motor(&mut b, link, ActuatorMode::Pd, [omega * omega, 0.0]);
        }
        b.model.initial.joint_positions = vec![0.3, 0.0];
        b.model.initial.joint_velocities = vec![0.0, 0.2 * omega];
        (b.model, hold_at_zero(2))
    };
    let truth = || vec![0.0, 0.2];
    let plan = plan(
        "orbit in isotropic springs, 5 ¼ s",
        "(a cos ω t, b sin ω t)",
        5.25,
    );
    compare(plan, make, at_places([0, 1]), truth)
}

/// Five masses of 1 kg in a row of springs, one end fixed, in their first and third mode of the
/// frequencies `2 ω₀ sin((2 k − 1) π/22)`.
fn row_of_springs() -> Scene {
    let (first, end) = (std::f64::consts::TAU * 2.0, 5.0);
    let wave = |k: u32| f64::from(2 * k - 1) * std::f64::consts::PI / 11.0;
    // Stretches of the springs: differences of the displacements sin(j wave).
    let shape = move |k: u32, j: u32| {
        0.02 * (libm::sin(wave(k) * f64::from(j + 1)) - libm::sin(wave(k) * f64::from(j)))
    };
    let make = move || {
        let mut b = fixed();
        let mut parent: LinkId = BASE;
        let mut stretches = Vec::new();
        for j in 0..5 {
            parent = b.link(
                parent,
                at(0.3, 0.0, 0.0),
                Motion::Prismatic(X),
                body(1.0, 1e-3),
            );
            motor(&mut b, parent, ActuatorMode::Pd, [first * first, 0.0]);
            stretches.push(shape(1, j) + shape(3, j));
        }
        b.model.initial.joint_positions = stretches;
        (b.model, hold_at_zero(5))
    };
    let truth = move || {
        let swing = |k: u32| libm::cos(2.0 * first * libm::sin(0.5 * wave(k)) * end);
        (0..5)
            .map(|j| shape(1, j) * swing(1) + shape(3, j) * swing(3))
            .collect()
    };
    let plan = plan("row of five springs, 5 s", "2 ω₀ sin((2k − 1) π/22)", end);
    compare(plan, make, at_places([0, 1, 2, 3, 4]), truth)
}

/// A damped oscillator of 2 Hz driven at its resonance by a force that each communication step
/// sets anew.
fn resonance() -> Scene {
    let (omega, zeta) = (std::f64::consts::TAU * 2.0, 0.05);
    let force = move |t: f64| 2.0 * libm::sin(omega * t);
    let make = move || {
        let mut b = fixed();
        let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(X), body(1.0, 1e-3));
        motor(
            &mut b,
            link,
            ActuatorMode::Pd,
            [omega * omega, 2.0 * zeta * omega],
        );
        let command = move |s: &mut Simulation, t: f64| {
            set(s, InputSlot::Position, 0, 0.0);
            set(s, InputSlot::Effort, 0, force(t));
        };
        (b.model, Box::new(command) as Command)
    };
    let truth = move || {
        let mut x = [0.0; 2];
        for i in 0..1200 {
            let push = force(f64::from(i) * H);
            let pull = |x: &[f64; 2]| push - omega * omega * x[0] - 2.0 * zeta * omega * x[1];
            x = runge_kutta(|x: &[f64; 2]| [x[1], pull(x)], x, H, 20);
        }
        vec![x[0]]
    };
    let plan = plan(
        "resonance, force held per step, 5 s",
        "x'' + 2ζω x' + ω² x = F",
        5.0,
    );
    compare(plan, make, at_places([0]), truth)
}

/// An oscillator with dry friction loses `4 f/k` of its amplitude in each period and stays where
/// the spring pulls less than the friction.
fn dry_friction() -> Scene {
    let (kp, f) = (std::f64::consts::TAU * std::f64::consts::TAU, 0.5);
    let make = move || {
        let mut b = fixed();
        let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(X), body(1.0, 1e-3));
        motor(&mut b, link, ActuatorMode::Pd, [kp, 0.0]);
        b.model.joints[0].friction = f;
        b.model.initial.joint_positions = vec![0.1];
        (b.model, hold_at_zero(1))
    };
    // Half periods about ±f/k end at 0.1 − 2 n f/k in turn, until less than f/k is left.
    let truth = move || {
        let mut x: f64 = 0.1;
        while x.abs() > f / kp {
            x = -(x - 2.0 * f / kp * x.signum());
        }
        vec![x]
    };
    let plan = plan("oscillator with dry friction, 4 s", "4 f/k a period", 4.0);
    compare(plan, make, at_places([0]), truth)
}

pub fn all() -> Vec<Scene> {
    vec![
        elastic_pendulum(),
        ellipse(),
        row_of_springs(),
        resonance(),
        dry_friction(),
    ]
}
