//! No contact: flight, spin, pendulums.

use super::*;
use crate::snapshot::Snapshot;
use crate::state::State;

/// A mass on a rail, a pendulum on the mass.
fn swing() -> Builder {
    let (mut b, cart) = cart();
    b.link(
        cart,
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(0.5, X * 0.4, [0.01; 3]),
    );
    b.actuator(cart, ActuatorMode::Effort, 10.0);
    b
}

/// Smooth steps are as long as the motion allows: who looks how often changes nothing but round-off.
#[test]
fn communication_points_leave_a_smooth_motion_alone() {
    // Explicit steps; with damping that is stiff, implicit ones.
    for damping in [0.0, 500.0] {
        let ends: Vec<State> = [1.0 / 1000.0, 1.0 / 240.0, 0.125]
            .into_iter()
            .map(|h| {
                let mut b = swing();
                b.model.joints[0].damping = damping;
                let mut s = start(b.model, 1e-3);
                run(&mut s, 3.0, h);
                s.state().clone()
            })
            .collect();
        for end in &ends[1..] {
            assert_eq!(end.counters, ends[0].counters);
            for (a, b) in end.q.iter().zip(&ends[0].q) {
                assert!((a - b).abs() < 1e-12, "{damping}: {a} {b}");
            }
        }
    }
}

/// 1 N on 1 kg from t = 0.5 s on: x = ½ (t − ½)², whatever had been foreseen.
#[test]
fn an_effort_acts_from_the_communication_point_at_which_it_is_set() {
    let (mut b, cart) = cart();
    b.actuator(cart, ActuatorMode::Effort, 10.0);
    let mut s = start(b.model, 1e-3);
    run(&mut s, 0.5, 0.01);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 1.0);
    run(&mut s, 1.0, 0.01);
    assert!((s.state().q[0] - 0.125).abs() < 1e-12, "{}", s.state().q[0]);
}

/// 10 N on 1 kg with damping d: x = F/d (t − m/d (1 − exp(−d t/m))), whatever d. Damping that is a hundred thousand times
/// faster than the motion costs no more steps than damping as fast as it, and no look in between sees anything else.
#[test]
fn damping_of_any_strength_is_followed_in_few_steps() {
    for damping in [1.0, 1e2, 1e3, 1e5] {
        let (mut b, cart) = cart();
        b.actuator(cart, ActuatorMode::Effort, 10.0);
        b.model.joints[0].damping = damping;
        let mut s = start(b.model, 1e-3);
        s.set_input(InputSlot::Effort(ActuatorId(0)), 10.0);
        let mut worst = 0.0_f64;
        for i in 1..=1000 {
            let t = f64::from(i) * 1e-3;
            s.advance_to(t).expect("finite");
            let x = 10.0 / damping * (t - (1.0 - libm::exp(-damping * t)) / damping);
            worst = worst.max((s.state().q[0] - x).abs());
        }
        let tries = s.state().counters[0] + s.state().counters[1];
        assert!(
            worst < 1e-4 && tries < 60,
            "{damping}: {worst:e} m in {tries} steps"
        );
    }
}

/// Saved in the middle of a step that reaches beyond the communication point.
#[test]
fn a_state_saved_within_a_long_step_continues_bit_for_bit() {
    for damping in [0.0, 500.0] {
        let mut b = swing();
        b.model.joints[0].damping = damping;
        let mut s = start(b.model.clone(), 1e-3);
        run(&mut s, 0.5, 0.001);
        while s.state().ahead.is_empty() {
            assert!(s.time() < 3.0, "{damping} {:?}", s.state());
            let next = s.time() + 0.001;
            s.advance_to(next).expect("finite");
        }
        let bytes = s.save().to_bytes();
        let mut other = start(b.model, 1e-3);
        let saved = Snapshot::from_bytes(other.model(), &bytes).expect("its own bytes");
        other.restore(&saved).expect("its own state");
        for simulation in [&mut s, &mut other] {
            for step in 1..=100 {
                simulation
                    .advance_to(1.0 + 0.01 * f64::from(step))
                    .expect("finite");
            }
        }
        assert_eq!(s.state(), other.state());
    }
}

/// A joint pushed towards its limit from rest: nothing tells the first step that it will get there.
#[test]
fn a_long_step_does_not_jump_over_a_limit() {
    let (mut b, cart) = cart();
    b.limits(cart, -0.1, 0.1);
    b.actuator(cart, ActuatorMode::Effort, 200.0);
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 100.0);
    run(&mut s, 0.01, 0.01);
    // It arrives with 4.5 m/s; the limit's law takes that on within millimetres.
    let mut farthest = 0.0_f64;
    for i in 1..=100 {
        s.advance_to(0.01 + f64::from(i) * 0.01).expect("finite");
        farthest = farthest.max(s.state().q[0]);
    }
    let rest = 0.1 + 100.0 / s.tree().limit_stiffness[0];
    assert!((s.state().q[0] - rest).abs() < 1e-9);
    assert!(farthest < 0.1 + 0.01, "{farthest}");
}
