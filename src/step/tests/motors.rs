//! Torque–speed lines, rotor inertia, speed limits and dry friction of joints, against closed
//! forms.

use super::*;
use crate::model::JointId;

/// Fixed steps or error control: step size and tolerance.
const MODES: [(f64, f64); 2] = [(0.0, 1e-5), (1.0 / 240.0, 1e-5)];

const INERTIA: f64 = 0.02;

/// A rotor of 0.02 kg·m² about the vertical.
fn rotor(mode: ActuatorMode, max_effort: f64) -> Builder {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(Vec3::z()),
        inertia(1.0, Vec3::zeros(), [0.1, 0.1, INERTIA]),
    );
    b.actuator(link, mode, max_effort);
    b
}

/// A lift of 2 kg on a vertical slide.
fn lift(max_effort: f64) -> Builder {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(2.0, Vec3::zeros(), [0.1; 3]),
    );
    b.actuator(link, ActuatorMode::Velocity, max_effort);
    b
}

fn started(mut b: Builder, (step, tolerance): (f64, f64)) -> Simulation {
    b.model.solver.step_size = step;
    start(b.model, tolerance)
}

/// J ω̇ = e0 (1 − ω/ω0): ω = ω0 (1 − exp(−t/τ)), τ = J ω0/e0; whatever mode asks for more than
/// there is.
#[test]
fn a_rotor_runs_up_along_its_torque_speed_line() {
    let (e0, w0) = (0.5, 40.0);
    let tau = INERTIA * w0 / e0;
    for mode in MODES {
        for command in [
            ActuatorMode::Effort,
            ActuatorMode::Velocity,
            ActuatorMode::Position,
            ActuatorMode::Pd,
        ] {
            let mut b = rotor(command, e0);
            b.model.actuators[0].no_load_speed = Some(w0);
            b.model.actuators[0].kp = 10.0;
            b.model.actuators[0].kd = 0.1;
            let mut s = started(b, mode);
            let a = ActuatorId(0);
            match command {
                ActuatorMode::Effort => s.set_input(InputSlot::Effort(a), 2.0),
                ActuatorMode::Velocity => s.set_input(InputSlot::Velocity(a), -100.0),
                ActuatorMode::Position | ActuatorMode::Pd => {
                    s.set_input(InputSlot::Position(a), 1e6);
                }
            }
            let sign = if command == ActuatorMode::Velocity {
                -1.0
            } else {
                1.0
            };
            for i in 1..=8 {
                let t = 0.5 * tau * f64::from(i);
                run(&mut s, t, 0.01);
                let expected = w0 * (1.0 - libm::exp(-t / tau));
                let found = sign * s.state().physical.v[0];
                // Implicit Euler is behind by at most h/(2 e τ).
                let allowed = if mode.0 > 0.0 {
                    mode.0 / tau / 5.0
                } else {
                    1e-5
                };
                assert!(
                    (found - expected).abs() < allowed * w0,
                    "{mode:?} {command:?} at {t}: {found} {expected}"
                );
                let effort = sign * s.output(OutputSlot::JointEffort(0u32.into_joint()));
                let line = e0 * (1.0 - found / w0);
                assert!((effort - line).abs() < 1e-9, "{effort} {line}");
            }
        }
    }
}

/// Up: stall effort twice the weight, so the line carries the weight at half the no-load speed.
/// Down: the weight drives, the motor brakes, and for that it has its whole effort and holds the
/// speed that it was told.
#[test]
fn a_loaded_motor_settles_where_its_line_meets_the_load_and_brakes_with_all_its_effort() {
    let weight = 2.0 * G;
    // Impulses are balanced to 1e-3 of the tolerance, here 1e-8 of the weight; the line turns that
    // into 2e-8 m/s.
    let exact = 3e-8;
    for mode in MODES {
        let mut b = lift(2.0 * weight);
        b.model.actuators[0].no_load_speed = Some(4.0);
        let mut s = started(b, mode);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), 10.0);
        run(&mut s, 10.0, 0.01);
        assert!(
            (s.state().physical.v[0] - 2.0).abs() < exact,
            "{mode:?}: {}",
            s.state().physical.v[0]
        );
        let steps = s.state().stepping.counters.steps;
        run(&mut s, 20.0, 0.05);
        assert!((s.state().physical.v[0] - 2.0).abs() < exact, "{mode:?}");
        // No chatter: nothing but steps of full length.
        let most = if mode.0 > 0.0 { 2400 } else { 400 };
        assert!(
            s.state().stepping.counters.steps - steps <= most,
            "{:?}",
            s.state().stepping.counters
        );
        s.set_input(InputSlot::Velocity(ActuatorId(0)), -10.0);
        run(&mut s, 30.0, 0.01);
        assert!(
            (s.state().physical.v[0] + 10.0).abs() < exact,
            "{mode:?}: {}",
            s.state().physical.v[0]
        );
        let effort = s.output(OutputSlot::JointEffort(0u32.into_joint()));
        assert!((effort - weight).abs() < 1e-6, "{mode:?}: {effort}");
        // Below its line it follows exactly.
        s.set_input(InputSlot::Velocity(ActuatorId(0)), 1.5);
        run(&mut s, 40.0, 0.01);
        assert!(
            (s.state().physical.v[0] - 1.5).abs() < exact,
            "{mode:?}: {}",
            s.state().physical.v[0]
        );
    }
}

/// With a gear of ratio n, a rotor of inertia `I_r` counts as n² `I_r`: ω = e t/(I + n² `I_r`),
/// exactly linear in time.
#[test]
fn a_geared_rotor_adds_its_inertia_times_the_ratio_squared() {
    let (n, rotor_inertia, e) = (100.0, 3e-5, 1.5);
    for mode in MODES {
        let mut b = rotor(ActuatorMode::Effort, 2.0);
        b.model.joints[0].armature = n * n * rotor_inertia;
        let mut s = started(b, mode);
        s.set_input(InputSlot::Effort(ActuatorId(0)), e);
        run(&mut s, 2.0, 0.01);
        let expected = 2.0 * e / (INERTIA + n * n * rotor_inertia);
        let found = s.state().physical.v[0];
        assert!((found / expected - 1.0).abs() < 1e-8, "{mode:?}: {found}");
    }
}

/// The damper's law: at the effort limit 1 % above the speed limit, at a tenth of it 0.1 %; off,
/// speed grows as e t/J.
#[test]
fn an_enforced_velocity_limit_is_exceeded_by_one_percent_under_the_effort_limit() {
    let limit = 3.0;
    for mode in MODES {
        // The last two have so much effort that one percent decides, not the millisecond.
        for (enforced, share, e) in [
            (true, 1.0, 0.5),
            (true, 0.1, 0.5),
            (false, 1.0, 0.5),
            (true, 1.0, 50.0),
            (true, 0.1, 50.0),
        ] {
            let mut b = rotor(ActuatorMode::Effort, e);
            b.model.joints[0].velocity = Some(limit);
            b.model.joints[0].effort = Some(e);
            b.model.joints[0].enforce_velocity = enforced;
            let mut s = started(b, mode);
            s.set_input(InputSlot::Effort(ActuatorId(0)), -share * e);
            run(&mut s, 4.0, 0.01);
            let expected = if enforced {
                // The damping is that or one that stops in a millisecond, whichever is more.
                let damping = (e / (0.01 * limit)).max(INERTIA / 1e-3);
                limit + share * e / damping
            } else {
                4.0 * e / INERTIA
            };
            let found = -s.state().physical.v[0];
            assert!(
                (found - expected).abs() < 1e-8 * expected,
                "{mode:?}: {found} {expected}"
            );
        }
    }
}

/// Dry friction 0.6 at rest and 0.4 in motion: holds 0.599, starts at 0.602 and then accelerates
/// with the rest. The effort rises in steps of 0.0012: the spring and the damper of friction answer
/// a jump with at most e⁻² of it too much.
#[test]
fn a_joint_breaks_away_at_its_static_friction_and_turns_with_its_dynamic_one() {
    for mode in MODES {
        for (effort, moves) in [(0.599, false), (0.602, true)] {
            let mut b = rotor(ActuatorMode::Effort, 2.0);
            b.model.joints[0].friction = 0.4;
            b.model.joints[0].static_excess = 0.5;
            let mut s = started(b, mode);
            for i in 1..=500 {
                s.set_input(
                    InputSlot::Effort(ActuatorId(0)),
                    effort * f64::from(i) / 500.0,
                );
                run(&mut s, 0.02 * f64::from(i), 0.01);
            }
            run(&mut s, 11.0, 0.01);
            let (q, v) = (s.state().physical.q[0], s.state().physical.v[0]);
            if moves {
                run(&mut s, 12.0, 0.01);
                let a = s.state().physical.v[0] - v;
                let expected = (effort - 0.4) / INERTIA;
                assert!(
                    (a - expected).abs() < 1e-4 * expected,
                    "{mode:?}: {a} {expected}"
                );
            } else {
                run(&mut s, 71.0, 0.1);
                assert!((s.state().physical.q[0] - q).abs() < 1e-12, "{mode:?}");
            }
        }
    }
}

/// A slider of 2 kg slows down from 0.3 to 0.1 m/s under dry friction that rises from 4 N to
/// 6 N as it does so. Of `m v̇ = −c(v)` this takes `∫ m/c dv`, here by the midpoint rule. A step
/// has the friction of its start: the lag is of first order, and one that errs by the tolerance in
/// 0.1 s is as long as the root of it. Nothing estimated this lag: the slider ended 4.5e-3 m/s too
/// fast at every tolerance.
#[test]
fn friction_that_falls_with_the_speed_is_followed_within_the_root_of_the_tolerance() {
    let friction = |v: f64| 4.0 + 2.0 * libm::exp(-(v / 0.1) * (v / 0.1));
    let dv = 0.2 / 1e4;
    let speeds = (0..10_000).map(|i| 0.1 + (f64::from(i) + 0.5) * dv);
    let time = speeds.map(|v| 2.0 * dv / friction(v)).sum();
    for tolerance in [1e-4, 1e-6, 1e-8] {
        let mut b = lift(1.0);
        b.model.actuators.clear();
        b.model.world.gravity = Vec3::zeros();
        let joint = &mut b.model.joints[0];
        (joint.friction, joint.static_excess) = (4.0, 0.5);
        joint.stribeck_velocity = 0.1;
        b.model.initial.joint_velocities = vec![0.3];
        let mut s = started(b, (0.0, tolerance));
        s.advance_to(time).expect("finite");
        let error = s.state().physical.v[0] - 0.1;
        assert!(
            error.abs() < 0.4 * tolerance.sqrt(),
            "{error} m/s at {tolerance}"
        );
    }
}

/// A velocity motor of 5 N presses its slider against a limit, under a command that changes 240
/// times a second between 0.01 and 0.09 m/s. Truth: it never has the speed that it is told to
/// reach, so it pulls with all of its effort. Before, a smaller command took away `d Δv` of it,
/// which came back as slowly as the command winds up a millimetre: grippers lost what they held.
#[test]
fn a_motor_that_presses_keeps_its_effort_when_its_command_falls() {
    for mode in MODES {
        let (mut b, cart) = cart();
        b.limits(cart, -0.1, 0.1);
        b.actuator(cart, ActuatorMode::Velocity, 5.0);
        let mut s = started(b, mode);
        for i in 0..480 {
            let command = if i < 240 {
                0.5
            } else {
                [0.01, 0.09, 0.03][i % 3]
            };
            s.set_input(InputSlot::Velocity(ActuatorId(0)), command);
            s.advance_to((i + 1) as f64 / 240.0).expect("finite");
            let effort = s.output(OutputSlot::JointEffort(JointId(0)));
            assert!(i < 200 || (effort - 5.0).abs() < 1e-6, "{effort} N at {i}");
        }
    }
}

/// Every mode with `max_effort` 0, on a joint that nothing loads: the motor lets go.
#[test]
fn a_released_motor_leaves_its_joint_alone() {
    for mode in [
        ActuatorMode::Velocity,
        ActuatorMode::Position,
        ActuatorMode::Pd,
    ] {
        let (mut b, cart) = cart();
        b.actuator(cart, mode, 5.0);
        b.model.actuators[0].kp = 100.0;
        b.model.joints[0].friction = 0.1;
        let mut s = start(b.model, 1e-3);
        s.set_input(InputSlot::MaxEffort(ActuatorId(0)), 0.0);
        s.set_input(InputSlot::Position(ActuatorId(0)), 1.0);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), 1.0);
        run(&mut s, 1.0, 0.01);
        assert_eq!(
            (s.state().physical.q[0], s.state().physical.v[0]),
            (0.0, 0.0),
            "{mode:?}"
        );
    }
}

/// A servo that pushes against a limit: two large forces balance and nothing else acts.
#[test]
fn a_servo_pressed_against_a_limit_rests() {
    let (mut b, cart) = cart();
    b.limits(cart, -0.1, 0.1);
    b.actuator(cart, ActuatorMode::Position, 500.0);
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Position(ActuatorId(0)), 1.0);
    run(&mut s, 2.0, 1.0 / 240.0);
    let expected = 0.1 + 500.0 / s.tree().dofs.limit_stiffness[0];
    assert!(
        (s.state().physical.q[0] - expected).abs() < 1e-8,
        "{} {expected}",
        s.state().physical.q[0]
    );
    let steps = s.state().stepping.counters.steps;
    run(&mut s, 3.0, 1.0);
    assert!(
        s.state().stepping.counters.steps < steps + 3,
        "{:?}",
        s.state().stepping.counters
    );
}

/// A pd law that swings at 3 million rad/s, 1 rad from its target: nobody sees that. It is taken
/// implicitly, in steps that grow, and comes to its target; steps that resolve it would be five
/// million a second.
#[test]
fn a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target() {
    let mut b = rotor(ActuatorMode::Pd, 1e9);
    b.model.links[1].inertia.I_cm[(2, 2)] = 1e-7;
    b.model.actuators[0].kp = 1e6;
    b.model.actuators[0].kd = 1e-3;
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Position(ActuatorId(0)), 1.0);
    run(&mut s, 0.1, 0.01);
    let state = s.state();
    assert!(
        (state.physical.q[0] - 1.0).abs() < 1e-3,
        "{:?}",
        state.physical
    );
    let steps = state.stepping.counters.steps;
    assert!(steps < 10_000, "{steps}");
}

/// A rotor of 2e-4 kg·m² whose velocity motor (5 N·m, 1 mrad, 5 N·m·s/rad) gets a new speed at each
/// communication step: `I v̇ = −k ς − d (v − w)`, `ς̇ = v − w`, with two real rates. The faster one
/// is over within 4e-5 s. A step that does not resolve it is right to a tenth of a tolerance, and
/// the estimate of its error must see that: nothing is to be taken in parts.
#[test]
fn a_stiff_motor_takes_one_step_for_each_new_speed() {
    let (i, k, d) = (2e-4, 5000.0, 5.0);
    let (h, count) = (1.0 / 240.0, 240);
    let mut b = rotor(ActuatorMode::Velocity, 5.0);
    b.model.links[1].inertia.I_cm[(2, 2)] = i;
    for tolerance in [1e-3, 1e-4] {
        let mut s = start(b.model.clone(), tolerance);
        let (mut q, mut stored, mut speed) = (0.0, 0.0, 0.0);
        let root = f64::sqrt(d * d - 4.0 * k * i);
        let [fast, slow] = [(-d - root) / (2.0 * i), (-d + root) / (2.0 * i)];
        for step in 1..=count {
            let w = 2.0 * libm::sin(12.0 * f64::from(step) * h);
            s.set_input(InputSlot::Velocity(ActuatorId(0)), w);
            s.advance_to(f64::from(step) * h).expect("finite");
            // ς = a e^(fast t) + b e^(slow t) with ς(0) stored and ς̇(0) = v − w.
            let a = (speed - w - slow * stored) / (fast - slow);
            let ends = [(fast, a), (slow, stored - a)].map(|(r, x)| (r, x * libm::exp(r * h)));
            let next: f64 = ends.iter().map(|(_, x)| x).sum();
            q += w * h + next - stored;
            speed = w + ends.iter().map(|(r, x)| r * x).sum::<f64>();
            stored = next;
        }
        let counters = s.state().stepping.counters;
        assert!(
            counters.steps <= count as u64 + 5 && counters.rejected <= 3,
            "{counters:?}"
        );
        let error = (s.state().physical.q[0] - q).abs();
        assert!(error < 0.1 * tolerance, "{error} at {tolerance}");
    }
}

/// A limp pendulum of 20 g and 60 mm hangs on a slide that a velocity motor (10 kN, 1 mm, 1 ms)
/// drives at a new speed in each communication step. Each jump `Δw` changes the pendulum's speed by
/// `−(m l/I) cos θ Δw` at once; between them `θ̈ = −(m g l/I) sin θ`. The motor's spring and damper
/// are over within a step, and what the error of the slide's place stretches in the spring takes
/// part in that: nothing is to be taken in parts. Were each step wrong by all of the tolerance,
/// 1 cm/s at 60 mm, the angle would be off by 0.17 rad.
#[test]
fn what_a_stiff_motor_pulls_along_takes_one_step_for_each_new_speed() {
    let (m, l, own) = (0.02, 0.06, 1e-5);
    let (h, count) = (1.0 / 240.0, 240);
    let about = own + m * l * l;
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let slide = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::x()),
        inertia(0.7, Vec3::zeros(), [1e-3; 3]),
    );
    let hangs = inertia(m, Vec3::new(0.0, 0.0, -l), [own; 3]);
    b.link(slide, Pose::IDENTITY, Motion::Revolute(-Vec3::y()), hangs);
    b.actuator(slide, ActuatorMode::Velocity, 1e4);
    let mut s = start(b.model, 1e-3);
    let (mut angle, mut rate, mut last) = (0.0_f64, 0.0, 0.0);
    for step in 1..=count {
        let w = 0.6 * libm::sin(30.0 * f64::from(step) * h);
        s.set_input(InputSlot::Velocity(ActuatorId(0)), w);
        s.advance_to(f64::from(step) * h).expect("finite");
        rate -= m * l / about * libm::cos(angle) * (w - last);
        last = w;
        for _ in 0..100 {
            // Leapfrog.
            angle += 0.005 * h * rate;
            rate -= 0.01 * h * m * G * l / about * libm::sin(angle);
            angle += 0.005 * h * rate;
        }
    }
    let counters = s.state().stepping.counters;
    let error = (s.state().physical.q[1] - angle).abs();
    let tries = counters.steps + counters.rejected;
    assert!(tries <= count as u64 + 10, "{counters:?}");
    assert!(error < 0.03, "{error}");
}
