//! Inputs that vary within a step: their derivatives reach the solver's steps.

use super::*;

const COMMAND: ActuatorId = ActuatorId(0);

/// A slider of `mass` along x without gravity, on a fixed base.
fn slider(mass: f64, mode: ActuatorMode, effort: f64) -> Builder {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(mass, Vec3::zeros(), [0.1; 3]),
    );
    b.actuator(cart, mode, effort);
    b.model.world.gravity = Vec3::zeros();
    b
}

/// `m ẍ = a t + b t²/2 + c t³/6`, so `m x = a t³/6 + b t⁴/24 + c t⁵/120`. A third-order method has
/// the first term exactly; all of it is right to the share of the tolerance that explicit steps
/// use.
#[test]
fn an_effort_that_varies_in_time_is_integrated_within_one_step() {
    for ([a, b, c], accuracy) in [([3.0, 0.0, 0.0], 1e-12), ([3.0, -4.0, 5.0], 2e-8)] {
        let mut s = start(slider(2.0, ActuatorMode::Effort, 100.0).model, 1e-6);
        for (order, value) in [(1, a), (2, b), (3, c)] {
            s.set_input_derivative(InputSlot::Effort(COMMAND), order, value);
        }
        s.advance_to(1.0).expect("finite");
        let x = 0.5 * (a / 6.0 + b / 24.0 + c / 120.0);
        let error = (s.state().physical.q[0] - x).abs();
        assert!(error < accuracy, "{error}");
        // After the step the input stands where its polynomial ended, and stays there.
        let end = a + b / 2.0 + c / 6.0;
        assert!((s.input(InputSlot::Effort(COMMAND)) - end).abs() < 1e-15);
        let v = s.state().physical.v[0];
        s.advance_to(2.0).expect("finite");
        assert!((s.state().physical.v[0] - v - end / 2.0).abs() < 1e-12);
    }
}

/// Fixed steps follow a ramp of the effort by their explicit method of third order: `v = t²/2m` and
/// `x = t³/6m` are exact.
#[test]
fn fixed_steps_follow_an_effort_ramp() {
    let mut model = slider(1.0, ActuatorMode::Effort, 100.0).model;
    model.solver.step_size = 0.01;
    let mut s = start(model, 1e-3);
    s.set_input_derivative(InputSlot::Effort(COMMAND), 1, 1.0);
    s.advance_to(1.0).expect("finite");
    let (x, v) = (s.state().physical.q[0], s.state().physical.v[0]);
    assert!((v - 0.5).abs() < 1e-12, "{v}");
    assert!((x - 1.0 / 6.0).abs() < 1e-12, "{x}");
}

/// A block on the ground, pushed by a force that grows at 2 N/s from 0: it starts at `μ m g = 2 t`,
/// and then `m v = t² − t₁² − μ m g (t − t₁)`. One communication step holds all of it.
#[test]
fn a_block_at_rest_starts_to_slide_when_a_growing_force_exceeds_friction() {
    let mut b = block(0.5, 0.4);
    b.model.outputs.external_wrenches = vec![LinkId(0)];
    let mut s = start(b.model, 1e-5);
    run(&mut s, 1.0, 0.1);
    let x0 = s.state().physical.q[0];
    s.set_input_derivative(InputSlot::ExternalForce(LinkId(0), 0), 1, 2.0);
    let friction = 0.4 * 0.5 * G;
    let begin = friction / 2.0;
    s.advance_to(1.0 + begin - 0.05).expect("finite");
    assert!((s.state().physical.q[0] - x0).abs() < 1e-3, "too early");
    // The derivative holds for one step: give it again.
    s.set_input_derivative(InputSlot::ExternalForce(LinkId(0), 0), 1, 2.0);
    s.advance_to(3.0).expect("finite");
    let t: f64 = 2.0;
    let v = (t * t - begin * begin - friction * (t - begin)) / 0.5;
    let x = ((t.powi(3) - begin.powi(3)) / 3.0
        - begin * begin * (t - begin)
        - 0.5 * friction * (t - begin).powi(2))
        / 0.5;
    assert!(
        (s.state().physical.v[3] - v).abs() < 2e-3 * v,
        "{} {v}",
        s.state().physical.v[3]
    );
    let moved = s.state().physical.q[0] - x0;
    assert!((moved - x).abs() < 5e-3 * x, "{moved} {x}");
}

/// A block rises at 0.5 m/s beside the ground, so that its steps are implicit, and a force that
/// grows by 15 N/s adds `F' t³/6m`. Both stages of a step took the force of its middle, so that the
/// estimate of the error did not see it grow; steps were as short as they were because they seemed
/// to make energy, or 3e-5 m off at every tolerance.
#[test]
fn implicit_steps_follow_a_growing_force_within_their_tolerance() {
    for tolerance in [1e-5, 1e-6, 1e-7] {
        let mut b = block(2.0, 0.5);
        b.model.roots[0].position.z += 0.03;
        b.model.roots[0].linear_velocity.z = 0.5;
        b.model.outputs.external_wrenches = vec![LinkId(0)];
        let mut s = start(b.model, tolerance);
        let slot = InputSlot::ExternalForce(LinkId(0), 2);
        s.set_input(slot, 2.0 * G);
        s.set_input_derivative(slot, 1, 15.0);
        s.advance_to(0.1).expect("finite");
        let (z, v) = (s.state().physical.q[2], s.state().physical.v[5]);
        let error = z - 0.13 - 0.05 - 15.0 * 1e-3 / 12.0;
        assert!(error.abs() < 2.0 * tolerance, "{error} m at {tolerance}");
        assert!((v - 0.5 - 15.0 * 0.01 / 4.0).abs() < 1e-12, "{v}");
        let counters = s.state().stepping.counters;
        assert!(counters.steps < 100, "{counters:?} at {tolerance}");
    }
}

/// The target moves at 0.5 m/s: a servo that knows the rate follows without lag, at any
/// communication step. Without it the lag is that of a critically damped spring, `v/slope`.
#[test]
fn a_position_servo_follows_a_ramp_without_lag() {
    for (h, fixed) in [(2.0, 0.0), (0.1, 0.0), (0.013, 0.0), (0.05, 1e-3)] {
        let mut model = slider(2.0, ActuatorMode::Position, 50.0).model;
        model.solver.step_size = fixed;
        let mut s = start(model, 1e-4);
        let slot = InputSlot::Position(COMMAND);
        let mut t = 0.0_f64;
        while t < 2.0 - 1e-9 {
            let end = (t + h).min(2.0);
            s.set_input(slot, 0.5 * t);
            s.set_input_derivative(slot, 1, 0.5);
            s.advance_to(end).expect("finite");
            t = end;
        }
        let lag = 1.0 - s.state().physical.q[0];
        assert!(lag.abs() < 1e-6, "{h} {fixed}: {lag}");
        assert!(
            (s.state().physical.v[0] - 0.5).abs() < 1e-5,
            "{}",
            s.state().physical.v[0]
        );
        // Outputs are those of the end of the step: the servo does not brake.
        let effort = s.output(OutputSlot::JointEffort(0usize.into()));
        assert!(effort.abs() < 1e-2, "{h} {fixed}: {effort} N");
    }
}

/// Nothing changes while a servo or a stiff pd law follows a ramp: the estimate of the error does
/// not take the way of the target within a step for a change.
#[test]
fn what_follows_a_ramp_takes_long_steps() {
    for mode in [ActuatorMode::Position, ActuatorMode::Pd] {
        let mut b = slider(1.0, mode, 100.0);
        (b.model.actuators[0].kp, b.model.actuators[0].kd) = (1e5, 700.0);
        let mut s = start(b.model, 1e-5);
        let command = |s: &mut Simulation, t: f64| {
            s.set_input(InputSlot::Position(COMMAND), 0.5 * t);
            s.set_input_derivative(InputSlot::Position(COMMAND), 1, 0.5);
            s.set_input(InputSlot::Velocity(COMMAND), 0.5);
        };
        let mut before = 0;
        for i in 0..200 {
            let t = 5e-3 * f64::from(i);
            command(&mut s, t);
            s.advance_to(t + 5e-3).expect("finite");
            if i == 99 {
                before = s.state().stepping.counters.steps;
            }
        }
        let steps = s.state().stepping.counters.steps - before;
        assert!(steps <= 110, "{mode:?}: {steps}");
    }
}

/// B7 of the solver's test list: `q_d = c t`, `v_d = c`: zero lag.
#[test]
fn pd_control_follows_a_ramp_without_lag() {
    let mut b = slider(2.0, ActuatorMode::Pd, 50.0);
    b.model.actuators[0].kp = 400.0;
    b.model.actuators[0].kd = 40.0;
    let mut s = start(b.model, 1e-4);
    s.set_input(InputSlot::Velocity(COMMAND), 0.5);
    s.set_input_derivative(InputSlot::Position(COMMAND), 1, 0.5);
    s.advance_to(4.0).expect("finite");
    let lag = 2.0 - s.state().physical.q[0];
    assert!(lag.abs() < 1e-5, "{lag}");
}

/// A velocity motor far from its limit follows `u(t)` to within its elastic displacement, 1 mm
/// under full effort.
#[test]
fn a_velocity_motor_accelerates_along_a_ramp_within_one_step() {
    let mut s = start(slider(1.0, ActuatorMode::Velocity, 100.0).model, 1e-5);
    s.set_input_derivative(InputSlot::Velocity(COMMAND), 1, 3.0);
    s.advance_to(1.0).expect("finite");
    assert!(
        (s.state().physical.q[0] - 1.5).abs() < 1e-3,
        "{}",
        s.state().physical.q[0]
    );
    assert!(
        (s.state().physical.v[0] - 3.0).abs() < 1e-3,
        "{}",
        s.state().physical.v[0]
    );
}

/// The same signal, cut into communication steps in several ways: differences stay within the
/// tolerance's reach.
#[test]
fn the_length_of_communication_steps_does_not_change_the_effect_of_a_varying_input() {
    let drive = |h: f64| {
        let mut b = slider(1.0, ActuatorMode::Velocity, 20.0);
        b.model.world.gravity = Vec3::new(0.0, 0.0, -G);
        let mut s = start(b.model, 1e-4);
        let slot = InputSlot::Velocity(COMMAND);
        let count = (2.0 / h).round() as u64;
        for i in 0..count {
            let t = 2.0 * i as f64 / count as f64;
            // u = 2 t − t²/2
            s.set_input(slot, 2.0 * t - 0.5 * t * t);
            s.set_input_derivative(slot, 1, 2.0 - t);
            s.set_input_derivative(slot, 2, -1.0);
            s.advance_to(2.0 * (i + 1) as f64 / count as f64)
                .expect("finite");
        }
        s.state().physical.q[0]
    };
    let whole = drive(2.0);
    for h in [0.5, 0.1, 0.01, 0.003] {
        let cut = drive(h);
        assert!((cut - whole).abs() < 1e-3, "{h}: {cut} {whole}");
    }
}

#[test]
fn a_released_motor_acts_again_when_its_effort_limit_grows() {
    let mut s = start(slider(1.0, ActuatorMode::Velocity, 10.0).model, 1e-4);
    s.set_input(InputSlot::Velocity(COMMAND), 100.0);
    s.set_input(InputSlot::MaxEffort(COMMAND), 0.0);
    s.set_input_derivative(InputSlot::MaxEffort(COMMAND), 1, 2.0);
    s.advance_to(1.0).expect("finite");
    // m v = ∫ 2 t dt = 1.
    assert!(
        (s.state().physical.v[0] - 1.0).abs() < 1e-3,
        "{}",
        s.state().physical.v[0]
    );
}

#[test]
fn derivatives_of_zero_change_no_bit() {
    let go = |derivative: bool| {
        let mut s = start(slider(1.0, ActuatorMode::Velocity, 10.0).model, 1e-3);
        s.set_input(InputSlot::Velocity(COMMAND), 1.0);
        if derivative {
            s.set_input_derivative(InputSlot::Velocity(COMMAND), 1, 1.0);
            s.set_input_derivative(InputSlot::Velocity(COMMAND), 1, 0.0);
        }
        run(&mut s, 0.5, 0.01);
        s.state().clone()
    };
    assert_eq!(go(true), go(false));
}

#[test]
fn a_state_saved_with_derivatives_continues_bit_for_bit() {
    let mut b = block(1.0, 0.5);
    b.model.outputs.external_wrenches = vec![LinkId(0)];
    let mut s = start(b.model, 1e-3);
    let slot = InputSlot::ExternalForce(LinkId(0), 0);
    s.set_input_derivative(slot, 1, 20.0);
    s.advance_to(0.3).expect("finite");
    s.set_input_derivative(slot, 2, 30.0);
    let bytes = s.save().to_bytes();
    let read = |s: &mut Simulation| {
        [
            s.output(OutputSlot::BaseLinearVelocity(RootId::ROBOT, 0)),
            s.output(OutputSlot::EnergyKinetic),
            s.input(slot),
        ]
        .map(f64::to_bits)
    };
    let then = read(&mut s);
    s.advance_to(0.7).expect("finite");
    let expected = (s.state().clone(), read(&mut s));
    let snapshot = crate::simulation::Snapshot::from_bytes(s.model(), &bytes).expect("own bytes");
    s.restore(&snapshot).expect("own state");
    assert_eq!(read(&mut s), then);
    s.advance_to(0.7).expect("finite");
    assert_eq!((s.state().clone(), read(&mut s)), expected);
}

/// Outputs have no direct feed-through: `ModelStructure` says `dependencies=""`.
#[test]
fn outputs_do_not_change_when_an_input_is_set_between_two_steps() {
    let mut s = start(slider(1.0, ActuatorMode::Effort, 10.0).model, 1e-3);
    s.set_input(InputSlot::Effort(COMMAND), 2.0);
    s.advance_to(0.1).expect("finite");
    let joint = crate::model::JointId(0);
    let read = |s: &mut Simulation| {
        [
            s.output(OutputSlot::JointEffort(joint)),
            s.output(OutputSlot::JointAcceleration(joint, 0)),
        ]
    };
    let before = read(&mut s);
    assert!((before[0] - 2.0).abs() < 1e-15 && (before[1] - 2.0).abs() < 1e-12);
    s.set_input(InputSlot::Effort(COMMAND), 5.0);
    s.set_input_derivative(InputSlot::Effort(COMMAND), 1, 5.0);
    assert_eq!(read(&mut s).map(f64::to_bits), before.map(f64::to_bits));
}

/// 1e300 N/s² for 1e10 s is not finite: it is refused before the state changes.
#[test]
fn an_input_polynomial_that_becomes_infinite_is_an_error_that_changes_nothing() {
    let mut s = start(slider(1.0, ActuatorMode::Effort, 10.0).model, 1e-3);
    s.set_input_derivative(InputSlot::Effort(COMMAND), 2, 1e300);
    let before = s.state().clone();
    assert!(s.advance_to(1e10).is_err());
    assert_eq!(s.state(), &before);
}

/// `v = a t`, `x = a t²/2` less what the motor yields, 1 mm under its effort: the ramp is no jump,
/// whatever it rises by within a step.
#[test]
fn a_velocity_motor_follows_a_ramp_in_long_steps() {
    let (a, effort) = (4.0, 10.0);
    for step_size in [0.0, 0.01] {
        for h in [1.0_f64, 0.1, 0.01] {
            let mut model = slider(1.0, ActuatorMode::Velocity, effort).model;
            model.solver.step_size = step_size;
            let mut s = start(model, 1e-3);
            for i in 0..(1.0 / h).round() as u32 {
                s.set_input(InputSlot::Velocity(COMMAND), a * h * f64::from(i));
                s.set_input_derivative(InputSlot::Velocity(COMMAND), 1, a);
                s.advance_to(h * f64::from(i + 1)).expect("finite");
            }
            let yielded = 1e-3 * a / effort;
            let error = s.state().physical.q[0] - (0.5 * a - yielded);
            // Fixed steps move with the speed of their ends.
            let allowed = 1e-3 + 0.5 * a * step_size;
            assert!(error.abs() < allowed, "{error} m, {step_size} s, {h} s");
        }
    }
}

/// A servo whose command nobody has set holds the joint where it begins, wherever that is.
#[test]
fn a_position_that_is_not_set_is_the_one_in_which_the_joint_begins() {
    use crate::simulation::{ParameterSlot, Snapshot};
    let joint = crate::model::JointId(0);
    let (place, slot) = (
        ParameterSlot::InitialJointPosition(joint),
        InputSlot::Position(COMMAND),
    );
    let begin = |order: &[&str]| {
        let mut b = slider(1.0, ActuatorMode::Position, 10.0);
        b.model.initial.joint_positions[0] = 0.25;
        let mut s = Simulation::new(std::sync::Arc::new(b.model));
        for what in order {
            match *what {
                "place" => s.set_parameter(place, 1.0),
                "command" => s.set_input(slot, 0.5),
                "the same" => s.set_input(slot, 0.25),
                "reset" => s.reset(),
                "read" => assert!(s.output(OutputSlot::JointPosition(joint, 0)).is_finite()),
                "save" => {
                    let bytes = s.save().to_bytes();
                    s.reset();
                    let saved = Snapshot::from_bytes(s.model(), &bytes).expect("own bytes");
                    s.restore(&saved).expect("own state");
                    assert_eq!(s.save().to_bytes(), bytes);
                }
                _ => s.initialize(0.0).expect("a legal start"),
            }
        }
        s
    };
    for (order, command) in [
        (&["start"][..], 0.25),
        (&["place", "start"], 1.0),
        (&["place", "read", "start"], 1.0),
        (&["place", "command", "start"], 0.5),
        (&["command", "place", "start"], 0.5),
        // What is set to its start value is set.
        (&["the same", "place", "start"], 0.25),
        (&["place", "reset", "start"], 0.25),
        (&["command", "reset", "place", "start"], 1.0),
        (&["place", "save", "start"], 1.0),
        (&["save", "place", "start"], 1.0),
        (&["the same", "save", "place", "start"], 0.25),
        (&["place", "start", "save"], 1.0),
        (&["place", "start", "command", "save"], 0.5),
    ] {
        let mut s = begin(order);
        assert_eq!(s.input(slot).to_bits(), f64::to_bits(command), "{order:?}");
        if command > 0.9 {
            run(&mut s, 1.0, 0.01);
            assert_eq!(
                s.state().physical.q[0].to_bits(),
                f64::to_bits(1.0),
                "{order:?}"
            );
        }
    }
}
