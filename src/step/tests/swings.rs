//! What swings on a spring, and what comes to its limit.

use super::*;

/// Of a spring without damping, a step of the angle `y = ω h` multiplies the amplitude by `|R(iy)|`
/// with Dormand and Prince's `R(z) = 1 + z + … + z⁵/120 + z⁶/600`: 1.8e-5 is lost where `y² = 0.4`,
/// and a period takes ten such steps. An implicit step of the length that the tolerance allows
/// would lose all.
#[test]
fn a_spring_without_damping_swings_on_at_any_tolerance() {
    let (omega, periods, start_at): (f64, u32, f64) = (100.0, 50, 1e-3);
    let (mut b, cart) = cart();
    b.actuator(cart, ActuatorMode::Pd, 1e9);
    b.model.actuators[0].kp = omega * omega;
    b.model.initial.joint_velocities = vec![start_at * omega];
    let mut s = start(b.model, 1.0);
    let end = f64::from(periods) * std::f64::consts::TAU / omega;
    run(&mut s, end, 0.05);
    let physical = &s.state().physical;
    let amplitude = libm::hypot(physical.q[0], physical.v[0] / omega);
    let y2: f64 = 0.4;
    let (re, im) = (
        1.0 - y2 / 2.0 + y2 * y2 / 24.0 - y2 * y2 * y2 / 600.0,
        y2.sqrt() * (1.0 - y2 / 6.0 + y2 * y2 / 120.0),
    );
    let steps = f64::from(periods) * std::f64::consts::TAU / y2.sqrt();
    let least = start_at * libm::pow(libm::hypot(re, im), 1.1 * steps);
    assert!(
        amplitude > least && amplitude < start_at * (1.0 + 1e-9),
        "{amplitude}, at least {least}"
    );
    let counted = s.state().stepping.counters.steps as f64;
    assert!(counted < 1.5 * steps, "{counted} steps, {steps} in theory");
}

/// A pendulum hangs on a cart of 1 kg that a spring of 100 MN/m holds, with four times the critical
/// damping. Steps that resolved the spring would be 16,000 a second; implicit ones are as long as
/// the pendulum allows.
#[test]
fn a_stiff_spring_with_much_damping_is_not_resolved() {
    let omega: f64 = 1e4;
    let (mut b, cart) = cart_with_pendulum();
    b.actuator(cart, ActuatorMode::Pd, 1e9);
    b.model.actuators[0].kp = omega * omega;
    b.model.actuators[0].kd = 4.0 * 2.0 * omega;
    let mut s = start(b.model, 1e-3);
    run(&mut s, 2.0, 0.1);
    let held = s.state().physical.q[0];
    // It pulls with three times its weight at most.
    assert!(held.abs() < 3.0 * 0.5 * G / (omega * omega), "{held:e}");
    let steps = s.state().stepping.counters.steps;
    assert!((steps as f64) < 0.1 * 2.0 * omega, "{steps}");
}

/// A mass that falls from rest onto the limit of its slide presses it by `d` at most, where the
/// limit has taken up all of its energy: `m g (s + d) = k d²/2`. Steps that end beyond the limit do
/// not count.
#[test]
fn what_falls_onto_a_limit_presses_it_no_deeper_than_its_energy_can() {
    for tenths in 1..=80 {
        let way = 5e-4 * f64::from(tenths);
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let mass = b.link(
            LinkId(0),
            Pose::IDENTITY,
            Motion::Prismatic(Vec3::z()),
            inertia(1.0, Vec3::zeros(), [0.01; 3]),
        );
        b.limits(mass, -way, 1.0);
        let mut s = start(b.model, 1e-3);
        let k = s.tree().dofs.limit_stiffness[0];
        let deepest = (G + (G * G + 2.0 * k * G * way).sqrt()) / k;
        for i in 1..=150 {
            run(&mut s, 1e-3 * f64::from(i), 1e-3);
            let depth = -way - s.state().physical.q[0];
            assert!(depth < 1.01 * deepest, "{way} m: {depth:e}, {deepest:e}");
        }
    }
}

/// A pendulum that swings by half a radian, between limits at 1.2 rad and without limits.
#[test]
fn limits_that_are_far_away_change_no_bit() {
    let ends = [None, Some(1.2)].map(|limit| {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        let bob = inertia(1.0, -Vec3::z() * 0.4, [0.01; 3]);
        let arm = b.link(LinkId(0), Pose::IDENTITY, Motion::Revolute(Y), bob);
        if let Some(limit) = limit {
            b.limits(arm, -limit, limit);
        }
        b.model.initial.joint_positions = vec![0.5];
        let mut s = start(b.model, 1e-3);
        run(&mut s, 3.0, 0.01);
        (s.state().physical.clone(), s.state().stepping.counters)
    });
    assert_eq!(ends[0], ends[1]);
}

/// A mass that moves on at a constant speed is known to reach its limit within the next step. What
/// may be tried in vain there is one step that reaches beyond the communication point.
#[test]
fn what_comes_to_its_limit_at_a_constant_speed_tries_one_step_in_vain_at_most() {
    let (mut b, cart) = cart();
    b.limits(cart, -1.0, 1.0);
    b.model.initial.joint_velocities = vec![1.0];
    let mut s = start(b.model, 1e-3);
    run(&mut s, 1.0 - 1e-9, 0.1);
    let counters = s.state().stepping.counters;
    assert!(counters.rejected <= 1, "{counters:?}");
}
