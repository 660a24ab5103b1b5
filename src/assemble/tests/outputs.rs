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
            group("a.b", "\"left\"") + &group("a_b", "\"right\""),
            "groups 'a.b' and 'a_b'",
        ),
        (
            group("a", "\"left\"") + &group("b", "\"left\", \"right\""),
            "in group 'a' already",
        ),
        (group("a", "\"left\", \"pan\""), "different commands"),
        (group("a", "\"lift\", \"pan\""), "one turns and one slides"),
        (
            // One mode would not do.
            "[[actuator]]\njoint = \"lift\"\nmode = \"velocity\"\n".to_owned()
                + &group("a", "\"lift\", \"pan\""),
            "one turns and one slides",
        ),
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
    let imu =
        |name: &str| format!("[[sensor]]\ntype = \"imu\"\nlink = \"chassis\"\nname = \"{name}\"\n");
    let found = error(&lifted(), &(imu("a.b") + &imu("a_b")));
    assert_eq!(found.code, "A131");
    assert!(
        found.message.contains("sensors 'a.b' and 'a_b'"),
        "{}",
        found.message
    );
}

#[test]
fn a_joint_that_stands_twice_in_a_group_is_told() {
    let told = |joints: &str| {
        let settings =
            format!("robot.base = \"fixed\"\n[[group]]\nname = \"drive\"\njoints = [{joints}]\n");
        has(&assembled(&cart(), &settings), "A144")
    };
    assert!(told("\"left\", \"left\""));
    assert!(!told("\"left\", \"right\""));
    // A glob beside a name is a choice.
    assert!(!told("\"left\", \"*\""));
}

/// 360 rays over a whole turn are 1.0028° apart, and the last one is where the first one is; over
/// 359° they are 1° apart, all around.
#[test]
fn rays_all_around_whose_last_one_is_the_first_are_told() {
    let told = |rays: u32, fov: f64| {
        let settings =
            format!("[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nrays = {rays}\nfov = {fov}\n");
        let built = assembled(&cart(), &settings);
        let mut found = built.diagnostics.into_iter().filter(|d| d.code == "A131");
        found.next().map(|d| d.help.unwrap_or_default())
    };
    let help = told(360, 2.0 * PI).expect("doubled");
    let fov: f64 = help
        .rsplit(' ')
        .next()
        .expect("a word")
        .parse()
        .expect("a number");
    assert!((fov - 359.0_f64.to_radians()).abs() < 1e-12, "{help}");
    assert!(told(360, 2.0 * PI - 0.003).is_some());
    assert_eq!(told(360, fov), None);
    assert_eq!(told(270, 1.5 * PI), None);
    assert_eq!(told(2, PI), None);
    // To the right and to the left, at the same place behind.
    assert!(told(3, 2.0 * PI).is_some());
}
