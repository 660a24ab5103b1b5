//! Steps of one solve, which communication steps cut short.

use super::*;

/// A double pendulum with dry friction, which neither explicit steps nor steps across communication
/// points take.
fn rubbing_pendulum() -> Model {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let rod = || inertia(1.0, Vec3::new(0.0, 0.0, -0.25), [0.02, 0.02, 1e-3]);
    let upper = b.link(
        0u32.into_link(),
        at(0.0, 0.0, 0.0),
        Motion::Revolute(Y),
        rod(),
    );
    b.link(upper, at(0.0, 0.0, -0.5), Motion::Revolute(Y), rod());
    for joint in &mut b.model.joints {
        joint.friction = 0.05;
    }
    b.model.world.gravity = Vec3::new(0.0, 0.0, -G);
    b.model.initial.joint_positions = vec![0.8, 0.3];
    b.model
}

/// Goes on from `saved` for 0.1 s with communication steps of `h`; angles, and which share of the
/// steps took one solve.
fn swung(saved: &crate::simulation::Snapshot, tolerance: f64, h: f64) -> ([f64; 2], f64) {
    let mut s = start(rubbing_pendulum(), TRUTH);
    s.restore(saved).expect("the same model");
    s.set_parameter(ParameterSlot::Tolerance, tolerance);
    let (begin, count) = (s.time(), (0.1 / h).round());
    let (mut singly, mut before) = (0.0, 0.0);
    for i in 1..=count as u32 {
        s.advance_to(begin + 0.1 * f64::from(i) / count)
            .expect("finite");
        let uses = s.state().stepping.lag.uses;
        singly += f64::from(u8::from(uses < before)) / count;
        before = uses;
    }
    ([s.state().physical.q[0], s.state().physical.q[1]], singly)
}

/// Tolerance of what the others are compared with.
const TRUTH: f64 = 1e-9;

/// Order 2: the local error of backward Euler, `h² a'/2`, is known up to its change over the few
/// steps that it serves. Both joints turn one way all the time, so that their friction is smooth.
#[test]
fn steps_whose_error_is_known_take_one_solve_and_are_of_second_order() {
    let mut s = start(rubbing_pendulum(), TRUTH);
    run(&mut s, 0.15, 0.05);
    let saved = s.save();
    let (truth, _) = swung(&saved, TRUTH, 0.05);
    let errors = [50.0, 70.0, 100.0].map(|count| 0.1 / count).map(|h| {
        let (angles, singly) = swung(&saved, 1e-3, h);
        let error = (angles[0] - truth[0])
            .abs()
            .max((angles[1] - truth[1]).abs());
        assert!(
            singly > 0.6,
            "{singly} of the steps of {h} s take one solve"
        );
        [h, error]
    });
    for pair in errors.windows(2) {
        let [[h, error], [shorter, less]] = [pair[0], pair[1]];
        let order = libm::log(error / less) / libm::log(h / shorter);
        assert!((order - 2.0).abs() < 0.2, "{errors:?}");
    }
}

/// A known error that is taken off three times amplifies no oscillation, however stiff and damped:
/// eigenvalues of the four steps together within the unit circle.
#[test]
fn a_load_held_by_a_motor_comes_to_rest_at_any_stiffness_and_communication_step() {
    for mass in [0.3, 3.0, 30.0] {
        for h in [3e-4, 1e-3, 4e-3] {
            let mut b = Builder::new(false, RigidInertia::ZERO);
            let arm = inertia(mass, Vec3::new(0.3, 0.0, 0.0), [0.01 * mass; 3]);
            let link = b.link(0u32.into_link(), Pose::IDENTITY, Motion::Revolute(Y), arm);
            b.actuator(link, ActuatorMode::Velocity, 200.0);
            b.model.world.gravity = Vec3::new(0.0, 0.0, -G);
            let mut s = start(b.model, 1e-3);
            let (mut before, mut singly) = (0.0, 0);
            for i in 1..=(3.0 / h) as u32 {
                s.advance_to(f64::from(i) * h).expect("finite");
                let uses = s.state().stepping.lag.uses;
                singly += u32::from(uses < before);
                before = uses;
            }
            assert!(
                s.state().physical.v[0].abs() < f64::MIN_POSITIVE,
                "{mass} kg, {h} s"
            );
            assert!(singly > 0, "{mass} kg, {h} s");
        }
    }
}

/// Newton's second law: contact impulse less weight is the change of momentum, in every
/// communication step, however the step was taken. A block on the ground lifts a load with a soft
/// pd motor; all moves along z alone.
#[test]
fn contact_impulses_change_the_momentum_whether_steps_take_one_solve_or_three() {
    let (mass, load) = (4.0, 2.0);
    let mut b = block(mass, 0.8);
    let body = inertia(load, Vec3::zeros(), [0.01; 3]);
    let lift = b.link(
        0u32.into_link(),
        at(0.0, 0.0, 0.3),
        Motion::Prismatic(Vec3::z()),
        body,
    );
    b.actuator(lift, ActuatorMode::Pd, 1e3);
    (b.model.actuators[0].kp, b.model.actuators[0].kd) = (2e3, 60.0);
    let mut s = start(b.model, 1e-3);
    let h = 1e-3;
    run(&mut s, 0.5, h);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.02);
    let momentum =
        |s: &Simulation| (mass + load) * s.state().physical.v[5] + load * s.state().physical.v[6];
    let weight = (mass + load) * G;
    let (mut before, mut singly, mut changed) = (momentum(&s), 0, 0.0_f64);
    for _ in 0..200 {
        let uses = s.state().stepping.lag.uses;
        let end = s.time() + h;
        s.advance_to(end).expect("finite");
        singly += u32::from(s.state().stepping.lag.uses < uses);
        let after = momentum(&s);
        let force: f64 = s.state().stepping.impulse.iter().map(|i| i[2]).sum::<f64>() / h;
        changed = changed.max((force - weight).abs());
        let off = force - weight - (after - before) / h;
        assert!(off.abs() < 1e-3 * weight, "{off} N after {} s", s.time());
        before = after;
    }
    assert!(singly > 50, "{singly} steps of one solve");
    assert!(changed > 0.1 * weight, "{changed} N");
}
