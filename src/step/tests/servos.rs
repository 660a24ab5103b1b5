//! Motors in closed loops: they move and carry more than what is beyond their joint.

use super::loops::{four_bar, gap};
use super::*;
use crate::closure::testing::anchor;
use crate::model::{JointId, LoopKind, Share};
use crate::spatial::rotation_from_rpy;

/// Weight at the pin of the boom over the cylinder's force: the cylinder pushes at 45°.
const LEVER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A level boom of `mass` kg and 2 m turns about y; a cylinder of 2 kg, from 0.8 m below and 0.2 m
/// beside, holds its middle. Only the cylinder is driven.
fn boom(mass: f64, mode: ActuatorMode, max_effort: f64) -> Builder {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let i = mass / 3.0;
    let beam = inertia(mass, X, [0.01 * mass, i, i]);
    let boom = b.link(LinkId(0), Pose::IDENTITY, Motion::Revolute(Y), beam);
    let foot = Pose {
        R: rotation_from_rpy(&(Y * -std::f64::consts::FRAC_PI_4)),
        ..at(0.2, 0.0, -0.8)
    };
    let half = |center: f64| inertia(1.0, X * center, [1e-3, 0.02, 0.02]);
    let tube = b.link(LinkId(0), foot, Motion::Revolute(Y), half(0.3));
    let length = 0.8 * std::f64::consts::SQRT_2;
    let rod = b.link(tube, at(length, 0.0, 0.0), Motion::Prismatic(X), half(-0.3));
    let ends = [(rod, 0.0), (boom, 1.0)].map(|(link, x)| anchor(Some(link), at(x, 0.0, 0.0)));
    b.close(LoopKind::Ball(ends));
    b.actuator(rod, mode, max_effort);
    b
}

/// The cylinder's mass beyond its joint is 1 kg, what it moves up to 8 t. Before motors in loops
/// felt what they move, it overshot by 16 to 76 mm and swung for seconds, and it held its load by
/// an error of 0.1 to 0.4 mm.
#[test]
fn a_servo_in_a_loop_reaches_its_target_without_overshoot_and_holds_its_load() {
    for (mass, reserve) in [(2.0, 3.0), (200.0, 3.0), (200.0, 10.0), (2000.0, 10.0)] {
        for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-5), (1.0 / 240.0, 1e-3)] {
            let mut b = boom(mass, ActuatorMode::Position, reserve * mass * G / LEVER);
            b.model.solver.step_size = step;
            let mut s = start(b.model, tolerance);
            s.set_input(InputSlot::Position(ActuatorId(0)), 0.1);
            let mut highest = 0.0_f64;
            for i in 1..=100 {
                s.advance_to(0.01 * f64::from(i)).expect("finite");
                highest = highest.max(s.state().physical.q[2]);
            }
            let at = format!("{mass} kg, {reserve} weights, step {step}, {tolerance}");
            assert!(highest < 0.1 + 2e-4, "{at}: overshoot {:e}", highest - 0.1);
            let off = (s.state().physical.q[2] - 0.1).abs();
            assert!(off < 1e-6, "{at}: {off:e} off");
            assert!(gap(&s) < 1e-12);
        }
    }
}

/// The same cylinder at 0.1 m/s: it overshot by 75 % and rang for half a second.
#[test]
fn a_velocity_motor_in_a_loop_takes_its_speed_without_overshoot() {
    for mass in [2.0, 200.0, 2000.0] {
        let b = boom(mass, ActuatorMode::Velocity, 3.0 * mass * G / LEVER);
        let mut s = start(b.model, 1e-4);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), 0.1);
        for i in 1..=300 {
            s.advance_to(1e-3 * f64::from(i)).expect("finite");
            let v = s.state().physical.v[2];
            assert!(v < 0.1 + 1e-3, "{mass} kg: {v} m/s at {i} ms");
            assert!(
                i < 200 || (v - 0.1).abs() < 1e-3,
                "{mass} kg: {v} m/s at {i} ms"
            );
        }
    }
}

/// Two lifts of 2 and 6 kg that are held together, each with a servo: both carry half of the sum.
#[test]
fn motors_that_hold_the_same_loop_share_its_load() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    for (mass, x) in [(2.0, 0.0), (6.0, 1.0)] {
        let cart = inertia(mass, Vec3::zeros(), [0.1; 3]);
        let lift = b.link(
            LinkId(0),
            at(x, 0.0, 0.0),
            Motion::Prismatic(Vec3::z()),
            cart,
        );
        b.actuator(lift, ActuatorMode::Position, 200.0);
    }
    let share = |joint, factor| Share {
        joint: JointId(joint),
        factor,
    };
    b.close(LoopKind::Coupler {
        terms: vec![share(0, 1.0), share(1, -1.0)],
        sum: Some(0.0),
    });
    let mut s = start(b.model, 1e-4);
    for actuator in 0..2 {
        s.set_input(InputSlot::Position(ActuatorId(actuator)), 0.3);
    }
    run(&mut s, 2.0, 0.01);
    for k in 0..2 {
        let off = (s.state().physical.q[k] - 0.3).abs();
        assert!(off < 1e-6, "{off:e}");
        let effort = s.output(OutputSlot::JointEffort(JointId(k as u32)));
        assert!((effort - 4.0 * G).abs() < 1e-2, "{effort}");
    }
}

/// Servos on both levers of a four-bar: the two cannot both be without acceleration while they
/// move, so that no forces hold them. Two arms of three servos that carried one bar made energy
/// from this without end while such accelerations counted as a load.
#[test]
fn servos_that_move_one_loop_together_come_to_their_targets() {
    // The crank stands at 1.57 and goes to `crank`; where two circles of 1 m meet is the rocker.
    for crank in [1.1, 1.3, 1.9] {
        let tip = [libm::cos(crank), libm::sin(crank)];
        let [x, z] = [1.2 - tip[0], -tip[1]];
        let square = x * x + z * z;
        let height = libm::sqrt((1.0 - 0.25 * square) / square);
        let pin = [0.5 * x - height * z, 0.5 * z + height * x].map(|x| -x);
        let pins = [pin, [-0.5 * x - height * z, -0.5 * z + height * x]];
        let angles = pins.map(|[x, z]| libm::atan2(z, x));
        for (step, tolerance) in [(0.0, 1e-3), (0.0, 1e-5), (1.0 / 240.0, 1e-3)] {
            let mut b = four_bar(LoopKind::Ball);
            b.model.initial.joint_velocities = vec![0.0; 3];
            for lever in [1u32, 3] {
                b.actuator(LinkId(lever), ActuatorMode::Position, 500.0);
            }
            b.model.solver.step_size = step;
            let mut s = start(b.model, tolerance);
            let from = s.state().physical.q[2];
            let apart = |angle: &f64| (angle - from).abs();
            let rocker = if apart(&angles[0]) < apart(&angles[1]) {
                angles[0]
            } else {
                angles[1]
            };
            s.set_input(InputSlot::Position(ActuatorId(0)), crank);
            s.set_input(InputSlot::Position(ActuatorId(1)), rocker);
            run(&mut s, 2.0, 0.01);
            let q = &s.state().physical.q;
            let off = (q[0] - crank).abs().max((q[2] - rocker).abs());
            assert!(
                off < 1e-6,
                "to {crank}, step {step}, {tolerance}: {off:e} off"
            );
        }
    }
}
