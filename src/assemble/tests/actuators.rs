//! Which joints have commands, and with which effort.

use super::*;

#[test]
fn limited_joints_are_commanded_by_position_others_by_velocity() {
    let description = cart().with(
        "chassis",
        "lift",
        Prismatic,
        at(0.0, 0.0, 0.0),
        mass("fork", 1.0),
    );
    let model = model(&description, "");
    let modes: Vec<_> = model.actuators.iter().map(|a| a.mode).collect();
    assert_eq!(
        modes,
        [
            ActuatorMode::Velocity,
            ActuatorMode::Velocity,
            ActuatorMode::Position
        ]
    );
    assert!(model.actuators.iter().all(|a| close(a.max_effort, 10.0)));
}

#[test]
fn later_actuator_entries_win_key_by_key() {
    let built = model(
        &cart(),
        "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 1\nkd = 2\nmax_effort = 3\n\
         [[actuator]]\njoint = \"right\"\nkp = 7\n",
    );
    let [left, right] = &built.actuators[..] else {
        panic!("two")
    };
    assert_eq!(
        (left.mode, right.mode),
        (ActuatorMode::Pd, ActuatorMode::Pd)
    );
    assert!(close(left.kp, 1.0) && close(right.kp, 7.0) && close(right.kd, 2.0));
    assert!(close(right.max_effort, 3.0) && close(right.reference_effort, 3.0));
    let passive = model(&cart(), "[[actuator]]\njoint = \"left\"\nmode = \"none\"");
    assert_eq!(passive.actuators.len(), 1);
    assert_eq!(passive.actuators[0].joint, JointId(1));
}

#[test]
fn missing_efforts_get_a_default_from_weight_and_reach() {
    let description = robot(mass("base", 1.0))
        .with(
            "base",
            "turn",
            Continuous,
            at(0.0, 0.0, 0.0),
            point("arm", 1.0, Vec3::new(2.0, 0.0, 0.0)),
        )
        .and(|j| j.effort = None)
        .with(
            "base",
            "slide",
            Prismatic,
            at(0.0, 0.0, 0.0),
            mass("fork", 1.0),
        )
        .and(|j| j.effort = Some(f64::NAN));
    let assembled = assembled(&description, "");
    // 3 kg and 2 m reach: 2 · 3 · 9.81 · 2 = 117.72; 10 · 3 · 9.81 = 294.3; three digits.
    assert!(close(assembled.model.actuators[0].max_effort, 118.0));
    assert!(close(assembled.model.actuators[0].reference_effort, 118.0));
    assert!(close(assembled.model.actuators[1].max_effort, 294.0));
    assert_eq!(assembled.model.joints[0].effort, None);
    let found = note(&assembled, "A113");
    assert!(found.message.contains("turn = 118") && found.message.contains("slide = 294"));
}

#[test]
fn commanded_efforts_without_a_limit_are_not_cut() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Continuous, at(0.0, 0.0, 0.0), mass("w", 1.0))
        .and(|j| j.effort = None);
    let most = |settings: &str| {
        let text = format!("[[actuator]]\njoint = \"j\"\nmode = \"effort\"\n{settings}");
        let built = assembled(&description, &text);
        (built.model.actuators[0].max_effort, has(&built, "A113"))
    };
    // The largest command is 1e12 N·m.
    let (free, told) = most("");
    assert!(free >= 1e12 && !told);
    assert_eq!(most("[joint.j]\neffort = 3"), (3.0, false));
    // A line of torque and speed begins with an effort, so one is chosen and told.
    let (stall, told) = most("no_load_speed = 4");
    assert!(stall < 10.0 && told);
}

#[test]
fn an_effort_limit_of_zero_stays_and_is_warned_about() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Continuous, at(0.0, 0.0, 0.0), mass("w", 1.0))
        .and(|j| j.effort = Some(0.0));
    let built = assembled(&description, "");
    assert_eq!(note(&built, "A114").severity, Severity::Warning);
    let motor = &built.model.actuators[0];
    assert!(close(motor.max_effort, 0.0) && motor.reference_effort > 1.0);
    // Asked for in the settings, it is what the user wants.
    assert!(!has(
        &assembled(&description, "[[actuator]]\njoint = \"j\"\nmax_effort = 0"),
        "A114"
    ));
}

#[test]
fn commands_of_ros2_control_are_suggested_but_not_adopted() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("arm", 1.0))
        .and(|j| j.interfaces = vec![ActuatorMode::Effort]);
    let built = assembled(&description, "");
    assert_eq!(built.model.actuators[0].mode, ActuatorMode::Position);
    let found = note(&built, "A126");
    assert!(found.message.contains("effort commands for 1 joint") && found.message.contains("'j'"));
    assert!(found.help.is_some_and(|h| h.contains("--mode effort")));
    let chosen = assembled(
        &description,
        "[[actuator]]\njoint = \"j\"\nmode = \"position\"",
    );
    assert!(!has(&chosen, "A126"));
    let both = description.and(|j| j.interfaces.push(ActuatorMode::Position));
    assert!(!has(&assembled(&both, ""), "A126"));
}
