//! No contact: flight, spin, pendulums.

use super::*;
use crate::snapshot::Snapshot;
use crate::state::State;

#[test]
fn a_thrown_body_follows_the_parabola_while_it_spins() {
    let mut b = Builder::new(true, inertia(2.0, Vec3::new(0.1, 0.0, 0.0), [0.02; 3]));
    b.model.initial.angular_velocity = Vec3::new(1.0, 2.0, 3.0);
    let mut s = start(b.model, 1e-8);
    // Centre of mass: starts with ω × r.
    let v0 = Vec3::new(1.0, 2.0, 3.0).cross(&Vec3::new(0.1, 0.0, 0.0));
    run(&mut s, 10.0, 0.01);
    let R = crate::spatial::rotation_from_quaternion(&[
        s.state().q[3],
        s.state().q[4],
        s.state().q[5],
        s.state().q[6],
    ]);
    let com = Vec3::new(s.state().q[0], s.state().q[1], s.state().q[2]) + R * X * 0.1;
    let expected = X * 0.1 + v0 * 10.0 + Vec3::new(0.0, 0.0, -0.5 * G * 100.0);
    assert!(
        (com - expected).norm() < 1e-5,
        "{}",
        (com - expected).norm()
    );
}

/// Torque-free body I = (1, 2, 3), ω = (1, 1, 1): ω has the period 4 K(k² = 1/2) / √(8/6) (Landau & Lifshitz §37).
#[test]
fn a_free_asymmetric_body_has_the_period_of_jacobis_functions() {
    let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1.0, 2.0, 3.0]));
    b.model.world.gravity = Vec3::zeros();
    b.model.initial.angular_velocity = Vec3::new(1.0, 1.0, 1.0);
    let mut s = start(b.model, 1e-8);
    run(&mut s, 6.422_703_1, 0.1);
    let R = crate::spatial::rotation_from_quaternion(&[
        s.state().q[3],
        s.state().q[4],
        s.state().q[5],
        s.state().q[6],
    ]);
    let w = R.transpose() * Vec3::new(s.state().v[0], s.state().v[1], s.state().v[2]);
    assert!((w - Vec3::new(1.0, 1.0, 1.0)).norm() < 1e-6, "{w}");
}

/// A point-like mass on a massless rod of 1 m, released from horizontal: T = 4 K(1/√2)/√(g) (`IFToMM` A01).
#[test]
fn a_pendulum_released_from_horizontal_has_the_exact_period() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(1.0, X, [0.0; 3]),
    );
    let mut s = start(b.model, 1e-9);
    let energy = |s: &mut Simulation| {
        s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
    };
    let before = energy(&mut s);
    run(&mut s, 2.367_841_95, 0.01);
    assert!(s.state().q[0].abs() < 2e-7, "{}", s.state().q[0]);
    run(&mut s, 10.0, 0.01);
    assert!((energy(&mut s) - before).abs() < 1e-6 * G);
}

/// Two point masses, two rods of 1 m, from (π/2, π/2) at rest; values at t = 2 s of the design's case A5
/// (an independent high-order integration).
#[test]
fn a_double_pendulum_ends_where_the_reference_says() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let down = Vec3::new(0.0, 0.0, -1.0);
    let first = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(-Y),
        inertia(1.0, down, [0.0; 3]),
    );
    b.link(
        first,
        at(0.0, 0.0, -1.0),
        Motion::Revolute(-Y),
        inertia(1.0, down, [0.0; 3]),
    );
    // The second angle is measured from the vertical, the joint's from the first rod.
    b.model.initial.joint_positions = vec![std::f64::consts::FRAC_PI_2, 0.0];
    for (tolerance, allowed) in [(1e-4, 2e-4), (1e-6, 2e-6)] {
        let mut s = start(b.model.clone(), tolerance);
        run(&mut s, 2.0, 0.1);
        let q = &s.state().q;
        let (a, b) = (q[0], q[0] + q[1]);
        let error = (a + 0.482_971_53).abs().max((b + 1.324_048_71).abs());
        assert!(error < allowed, "{tolerance}: {error} ({a}, {b})");
    }
}

/// A mass on a rail, a pendulum on the mass.
fn swing() -> Builder {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
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
    let ends: Vec<State> = [1.0 / 1000.0, 1.0 / 240.0, 0.125]
        .into_iter()
        .map(|h| {
            let mut s = start(swing().model, 1e-3);
            run(&mut s, 3.0, h);
            s.state().clone()
        })
        .collect();
    for end in &ends[1..] {
        assert_eq!(end.counters, ends[0].counters);
        for (a, b) in end.q.iter().zip(&ends[0].q) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}

/// 1 N on 1 kg from t = 0.5 s on: x = ½ (t − ½)², whatever had been foreseen.
#[test]
fn an_effort_acts_from_the_communication_point_at_which_it_is_set() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
    b.actuator(cart, ActuatorMode::Effort, 10.0);
    let mut s = start(b.model, 1e-3);
    run(&mut s, 0.5, 0.01);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 1.0);
    run(&mut s, 1.0, 0.01);
    assert!((s.state().q[0] - 0.125).abs() < 1e-12, "{}", s.state().q[0]);
}

/// Saved in the middle of a step that reaches beyond the communication point.
#[test]
fn a_state_saved_within_a_long_step_continues_bit_for_bit() {
    let mut s = start(swing().model, 1e-3);
    run(&mut s, 0.5, 0.01);
    assert!(!s.state().ahead.is_empty());
    let bytes = s.save().to_bytes();
    let mut other = start(swing().model, 1e-3);
    let saved = Snapshot::from_bytes(other.model(), &bytes).expect("its own bytes");
    other.restore(&saved).expect("its own state");
    run(&mut s, 2.0, 0.01);
    run(&mut other, 2.0, 0.01);
    assert_eq!(s.state(), other.state());
}

/// A joint pushed towards its limit from rest: nothing tells the first step that it will get there.
#[test]
fn a_long_step_does_not_jump_over_a_limit() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1.0, Vec3::zeros(), [0.01; 3]),
    );
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
