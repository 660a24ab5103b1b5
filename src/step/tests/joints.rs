//! Joints and motors.

use super::*;

#[test]
fn a_position_servo_reaches_its_target_without_overshoot_and_holds_it_under_load() {
    let mut b = Builder::new(false, RigidInertia::ZERO);
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
            highest = highest.max(s.state().physical.q[0]);
            fastest = fastest.max(s.state().physical.v[0].abs());
        }
        assert!(highest < 1.5 + 1e-3, "overshoot {}", highest - 1.5);
        assert!(fastest < 2.0 + 1e-2, "speed {fastest}");
        assert!((s.state().physical.q[0] - 1.5).abs() < 1e-3);
        assert!(s.state().physical.v[0].abs() < 1e-6);
    }
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
