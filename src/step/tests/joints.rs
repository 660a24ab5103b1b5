//! Joints and motors.

use super::*;

/// Cart with a force-limited velocity motor: 5.5 kg in all, wheel 0.5 kg disc R = 0.1, 0.5 N·m, 10 rad/s:
/// a = F/R/(M + I/R²) = 0.8695652 until 1 m/s, so x(3) = 1.15²·a/2 + 1.85 = 2.425.
#[test]
fn a_velocity_motor_drives_a_cart_with_its_effort_and_then_holds_its_speed() {
    let mut b = Builder::new(true, inertia(5.0, Vec3::new(0.0, 0.0, 0.0), [0.1; 3]));
    let wheel = Shape::Cylinder {
        radius: 0.1,
        half_length: 0.05,
    };
    // Two free-running wheels ahead and behind would carry the cart; here a skid-free wide wheel does: the cart is
    // kept upright by a joint to the world instead.
    b.model.bodies[0].motion = Motion::Welded;
    b.model.nq = 0;
    b.model.dofs.clear();
    b.model.links[0].inertia = crate::spatial::RigidInertia::ZERO;
    let cart = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(5.0, Vec3::zeros(), [0.1; 3]),
    );
    let lift = b.link(
        cart,
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(1e-6, Vec3::zeros(), [1e-6; 3]),
    );
    let hub = b.link(
        lift,
        at(0.0, 0.0, 0.1),
        Motion::Revolute(Y),
        inertia(0.5, Vec3::zeros(), [0.0025, 0.0025, 0.0025]),
    );
    let turned = Pose::from_xyz_rpy(
        Vec3::zeros(),
        Vec3::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
    );
    b.shape(hub, wheel, turned);
    b.actuator(hub, ActuatorMode::Velocity, 0.5);
    // The wheel alone presses on the ground: enough friction to carry 5 N.
    b.model.links[hub.index()].friction = 3.0;
    b.model.world.ground = Some(crate::model::Ground {
        friction: 3.0,
        ..Default::default()
    });
    let mut s = start(b.model, 1e-4);
    run(&mut s, 0.2, 1.0 / 240.0);
    let (x0, t0) = (s.state().q[0], s.time());
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 10.0);
    run(&mut s, t0 + 3.0, 1.0 / 240.0);
    let x = s.state().q[0] - x0;
    assert!((x - 2.425).abs() < 5e-4, "{x}");
    let speed = s.state().v[0];
    assert!((speed - 1.0).abs() < 1e-4, "{speed}");
}

#[test]
fn a_position_servo_reaches_its_target_without_overshoot_and_holds_it_under_load() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let arm = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Revolute(Y),
        inertia(2.0, X * 0.5, [0.01, 0.1, 0.1]),
    );
    b.actuator(arm, ActuatorMode::Position, 20.0);
    b.model.joints[0].velocity = Some(2.0);
    for h in [1.0 / 1000.0, 1.0 / 240.0, 0.1] {
        let mut s = start(b.model.clone(), 1e-3);
        s.set_input(InputSlot::Position(ActuatorId(0)), 1.5);
        let (mut highest, mut fastest) = (0.0_f64, 0.0_f64);
        let count = (4.0 / h) as usize;
        for i in 1..=count {
            s.advance_to(i as f64 * h).expect("finite");
            highest = highest.max(s.state().q[0]);
            fastest = fastest.max(s.state().v[0].abs());
        }
        assert!(highest < 1.5 + 1e-3, "overshoot {}", highest - 1.5);
        assert!(fastest < 2.0 + 1e-2, "speed {fastest}");
        assert!((s.state().q[0] - 1.5).abs() < 1e-3);
        assert!(s.state().v[0].abs() < 1e-6);
    }
}

#[test]
fn a_stiff_pd_on_a_gram_is_stable_at_a_tenth_of_a_second() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(X),
        inertia(1e-3, Vec3::zeros(), [1e-6; 3]),
    );
    b.actuator(link, ActuatorMode::Pd, 1e9);
    b.model.actuators[0].kp = 1e6;
    b.model.actuators[0].kd = 1e3;
    let mut s = start(b.model, 1e-3);
    s.set_input(InputSlot::Position(ActuatorId(0)), 0.3);
    run(&mut s, 1.0, 0.1);
    assert!((s.state().q[0] - 0.3).abs() < 1e-3);
}

#[test]
fn a_joint_limit_carries_a_static_load_at_its_stiffness() {
    let mut b = Builder::new(false, crate::spatial::RigidInertia::ZERO);
    let link = b.link(
        0u32.into_link(),
        Pose::IDENTITY,
        Motion::Prismatic(Vec3::z()),
        inertia(2.0, Vec3::zeros(), [0.01; 3]),
    );
    b.limits(link, -0.1, 0.1);
    let mut s = start(b.model, 1e-4);
    run(&mut s, 3.0, 0.01);
    let expected = -0.1 - 2.0 * G / s.tree().limit_stiffness[0];
    assert!(
        (s.state().q[0] - expected).abs() < 1e-9,
        "{} {expected}",
        s.state().q[0]
    );
}

#[test]
fn a_mimic_joint_follows_exactly() {
    let mut random = Random(7);
    let model = random_tree(&mut random, 10, false, true);
    let mut s = start(model, 1e-4);
    run(&mut s, 1.0, 0.01);
    let model = s.model().clone();
    let mut followers = 0;
    for (id, joint) in (0..).map(crate::model::JointId).zip(&model.joints) {
        let Some(mimic) = &joint.mimic else { continue };
        let (q, source) = (
            s.output(OutputSlot::JointPosition(id, 0)),
            s.output(OutputSlot::JointPosition(mimic.joint, 0)),
        );
        assert!((q - mimic.multiplier * source - mimic.offset).abs() < 1e-15);
        followers += 1;
    }
    assert_eq!(followers, 2);
}
