//! Contact outputs and groups.

use super::*;

#[test]
fn every_link_that_can_touch_the_ground_has_contact_outputs() {
    let names = |model: &Model| -> Vec<String> {
        let links = &model.outputs.contacts;
        links
            .iter()
            .map(|l| model.links[l.index()].name.clone())
            .collect()
    };
    // The mast has no shape.
    let touching = ["chassis", "left_wheel", "right_wheel"];
    assert_eq!(names(&model(&cart(), "")), touching);
    assert_eq!(names(&model(&robot(body("cube", 1.0)), "")), ["cube"]);
    assert!(names(&model(&cart(), "outputs.contacts = \"none\"")).is_empty());
    assert!(names(&model(&cart(), "world.ground = { type = \"none\" }")).is_empty());
    assert_eq!(
        names(&model(&cart(), "outputs.contacts = [\"*_wheel\"]")),
        ["left_wheel", "right_wheel"]
    );
    // A foot fixed to a shank has its own. The fixed base touches nothing.
    let leg = robot(body("world", 1.0))
        .with(
            "world",
            "knee",
            Revolute,
            at(0.0, 0.0, 1.0),
            body("shank", 1.0),
        )
        .with(
            "shank",
            "ankle",
            Fixed,
            at(0.0, 0.0, -0.5),
            body("foot", 1.0),
        );
    assert_eq!(names(&model(&leg, "")), ["shank", "foot"]);
}

#[test]
fn a_group_has_one_command_that_every_joint_of_it_follows() {
    let settings =
        "robot.base = \"fixed\"\n[[group]]\nname = \"drive\"\njoints = [\"left\", \"right\"]\n";
    let built = assembled(&cart(), settings);
    assert_eq!(built.model.outputs.groups.len(), 1);
    let mut s = Simulation::new(Arc::new(built.model));
    s.initialize(0.0).expect("a legal start");
    // The table shows the first one's input alone; either sets both.
    s.set_input(InputSlot::Velocity(ActuatorId(0)), 2.0);
    assert!(close(s.input(InputSlot::Velocity(ActuatorId(1))), 2.0));
    s.advance_to(1.0).expect("finite");
    for j in 0..2 {
        let rate = s.output(OutputSlot::JointVelocity(JointId(j), 0));
        assert!((rate - 2.0).abs() < 1e-3, "{rate}");
    }
}

#[test]
fn groups_that_cannot_share_a_command_are_errors_with_their_place() {
    let group =
        |name: &str, joints: &str| format!("[[group]]\nname = \"{name}\"\njoints = [{joints}]\n");
    let lifted = || {
        cart()
            .with(
                "chassis",
                "lift",
                Prismatic,
                at(0.0, 0.0, 0.0),
                mass("fork", 1.0),
            )
            .with(
                "chassis",
                "pan",
                Revolute,
                at(0.0, 0.0, 0.0),
                mass("eye", 1.0),
            )
            .with(
                "chassis",
                "tilt",
                Revolute,
                at(0.0, 0.0, 0.0),
                mass("ear", 1.0),
            )
    };
    for (settings, part) in [
        (group("left", "\"right\""), "has the name of joint 'left'"),
        (
            group("a", "\"left\"") + &group("a", "\"right\""),
            "second group",
        ),
        (
            group("a", "\"left\"") + &group("b", "\"left\", \"right\""),
            "in group 'a' already",
        ),
        (group("a", "\"left\", \"pan\""), "different commands"),
        (group("a", "\"lift\", \"pan\""), "one turns and one slides"),
        (
            "initial.joints = { pan = 0.5 }\n".to_owned() + &group("a", "\"pan\", \"tilt\""),
            "start at 0.5 and 0",
        ),
    ] {
        let found = error(&lifted(), &settings);
        assert_eq!(found.code, "A130", "{settings}");
        assert!(found.message.contains(part), "{}", found.message);
        assert!(found.place.is_some());
    }
    let found = error(&lifted(), &group("a", "\"lefd\""));
    assert_eq!(found.code, "A101");
    let passive = "[[actuator]]\njoint = \"left\"\nmode = \"none\"\n".to_owned();
    let found = error(&lifted(), &(passive + &group("a", "\"left\"")));
    assert_eq!(found.code, "A102");
    assert!(found.message.contains("not commanded"), "{}", found.message);
}
