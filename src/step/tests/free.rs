//! No contact: flight, spin, pendulums.

use super::*;

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
