//! Joints that follow others.

use super::*;

#[test]
fn mimic_chains_lead_to_the_independent_joint() {
    let description = robot(mass("world", 0.0))
        .with("world", "c", Revolute, at(0.0, 0.0, 0.0), mass("lc", 1.0))
        .mimicking("b", 3.0, 0.25)
        .with("world", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", -2.0, 0.5)
        .with("world", "a", Continuous, at(0.0, 0.0, 0.0), mass("la", 1.0));
    let model = model(&description, "");
    assert_eq!((model.nq, model.nv()), (1, 1));
    let c = model.joints[0].mimic.expect("mimic");
    // c = 3 b + 0.25 = 3 (−2 a + 0.5) + 0.25 = −6 a + 1.75
    assert_eq!(c.joint, JointId(2));
    assert!(close(c.multiplier, -6.0) && close(c.offset, 1.75));
    assert!(close(model.bodies[1].ratio, -6.0) && close(model.bodies[1].offset, 1.75));
    assert_eq!(model.dofs[0].body, BodyId(3));
    // −1 ≤ b ≤ 2 gives −0.75 ≤ a ≤ 0.75; −1 ≤ c ≤ 2 gives −1/24 ≤ a ≤ 11/24.
    let limits = model.dofs[0].limits.expect("limits");
    assert!(
        close(limits.lower, -0.25 / 6.0) && close(limits.upper, 2.75 / 6.0),
        "{limits:?}"
    );
    // One actuator, on the independent joint.
    assert_eq!(model.actuators.len(), 1);
    assert_eq!(model.actuators[0].joint, JointId(2));
}

#[test]
fn wrong_mimics_are_errors_that_name_the_joints() {
    let two = |target: &str| {
        robot(mass("base", 1.0))
            .with("base", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
            .mimicking(target, 1.0, 0.0)
            .with("base", "bee", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
            .with("base", "fix", Fixed, at(0.0, 0.0, 0.0), mass("lf", 1.0))
    };
    let found = error(&two("beee"), "");
    assert_eq!(found.code, "A103");
    assert!(
        found.help.as_deref().is_some_and(|h| h.contains("'bee'")),
        "{found:?}"
    );
    assert_eq!(found.place.map(|p| p.line), Some(9));
    assert!(error(&two("a"), "").message.contains("itself"));
    assert!(error(&two("fix"), "").message.contains("is fixed"));
    let circle = robot(mass("base", 1.0))
        .with("base", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
        .mimicking("b", 1.0, 0.0)
        .with("base", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", 1.0, 0.0);
    assert_eq!(errors(&circle, "").len(), 2);
}

#[test]
fn limits_that_exclude_each_other_keep_the_leader_s() {
    let description = robot(mass("world", 0.0))
        .with("world", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
        .with("world", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", 1.0, 100.0);
    let assembled = assembled(&description, "");
    let warning = note(&assembled, "A118");
    assert_eq!(warning.severity, Severity::Warning);
    assert_eq!(
        assembled.model.dofs[0].limits,
        Some(Limits {
            lower: -1.0,
            upper: 2.0
        })
    );
}

/// Two fingers of which one turns the other way, with the limits of the first: so are those of
/// public grippers.
#[test]
fn limits_that_leave_no_room_to_move_keep_the_leader_s() {
    let upwards = Limits {
        lower: 0.0,
        upper: 0.8,
    };
    let mut description = robot(mass("world", 0.0))
        .with("world", "a", Revolute, at(0.0, 0.0, 0.0), mass("la", 1.0))
        .with("world", "b", Revolute, at(0.0, 0.0, 0.0), mass("lb", 1.0))
        .mimicking("a", -1.0, 0.0);
    for joint in &mut description.joints {
        joint.limits = Some(upwards);
    }
    let assembled = assembled(&description, "");
    let warning = note(&assembled, "A118");
    assert_eq!(warning.severity, Severity::Warning);
    assert!(
        warning.message.contains("no room to move"),
        "{}",
        warning.message
    );
    assert_eq!(assembled.model.dofs[0].limits, Some(upwards));
}
