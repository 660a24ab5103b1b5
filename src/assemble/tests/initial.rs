//! Where the robot starts.

use super::*;

#[test]
fn joint_zero_outside_the_limits_moves_to_the_nearest_limit() {
    let description = robot(mass("base", 1.0))
        .with(
            "base",
            "knee",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("shank", 1.0),
        )
        .and(|j| {
            j.limits = Some(Limits {
                lower: -2.7,
                upper: -0.9,
            });
        });
    let built = assembled(&description, "");
    assert!(close(built.model.initial.joint_positions[0], -0.9));
    let found = note(&built, "A110");
    assert!(found.message.contains("knee = -0.9"), "{}", found.message);

    let set = assembled(&description, "initial.joints = { knee = -2 }");
    assert!(close(set.model.initial.joint_positions[0], -2.0));
    assert!(!has(&set, "A110"));

    let found = error(&description, "initial.joints = { knee = 1 }");
    assert_eq!(found.code, "A106");
    assert_eq!(
        found.place.as_ref().map(|p| (p.line, p.column)),
        Some((1, 20))
    );
    let help = |value: &str| {
        let settings = format!("initial.joints = {{ knee = {value} }}");
        error(&description, &settings).help.unwrap_or_default()
    };
    assert_eq!(help("1"), "the nearest possible one is -0.9");
    let degrees = help("-90");
    assert!(degrees.contains("-90 degrees are -1.5708"), "{degrees}");
}

#[test]
fn a_floating_robot_starts_with_its_lowest_point_on_the_ground() {
    let built = assembled(&cart(), "");
    // The wheels' centres are 0.1 below the base's, their radius is 0.1.
    assert!(sunk(built.model.roots[0].position.z, 0.2));
    assert!(note(&built, "A111").message.contains("z = 0.1999"));
    // Turned by 90° about x, the right wheel's centre at y = −0.2 is lowest; the left one's after
    // −90°.
    let leaning = model(&cart(), &format!("initial.rpy = [{FRAC_PI_2}, 0, 0]"));
    assert!(sunk(leaning.roots[0].position.z, 0.3));
    // Upside down nothing but the mast's frames is lower than the chassis' ball.
    let over = model(
        &cart(),
        &format!("initial.rpy = [{PI}, 0, 0]\ninitial.xyz = [5, 6]"),
    );
    assert!((over.roots[0].position - Vec3::new(5.0, 6.0, 0.1)).norm() < 1.01e-4);
}

#[test]
fn joint_positions_count_for_the_initial_height() {
    let leg = robot(body("trunk", 1.0))
        .with(
            "trunk",
            "hip",
            Revolute,
            at(0.0, 0.0, 0.0),
            mass("thigh", 1.0),
        )
        .and(|j| j.axis = Vec3::y())
        .with(
            "thigh",
            "foot_joint",
            Fixed,
            at(0.0, 0.0, -1.0),
            body("foot", 1.0),
        );
    assert!(sunk(model(&leg, "").roots[0].position.z, 1.1));
    let bent = model(&leg, "initial.joints = { hip = 1.0471975511965976 }");
    // 60°: the foot's centre is cos 60° = 0.5 m below.
    assert!(sunk(bent.roots[0].position.z, 0.6));
}

#[test]
fn a_start_inside_the_ground_is_warned_about_with_its_depth() {
    let deep = assembled(&cart(), "initial.xyz = [0, 0, 0.1]");
    let found = note(&deep, "A112");
    assert!(found.message.contains("100.000 mm"), "{}", found.message);
    assert!(found.help.is_some_and(|h| h.contains("0.200000")));
    assert!(close(deep.model.roots[0].position.z, 0.1));
    for settings in [
        "initial.xyz = [0, 0, 0.2]",
        "initial.xyz = [0, 0, 5]",
        "initial.xyz = [0, 0, 0.1]\nworld.ground = { type = \"none\" }",
    ] {
        assert!(!has(&assembled(&cart(), settings), "A112"), "{settings}");
    }
    // A fixed base is where it is; only what moves is looked at.
    let arm = robot(body("pedestal", 1.0)).with(
        "pedestal",
        "j",
        Revolute,
        at(0.0, 0.0, 0.05),
        body("arm", 1.0),
    );
    let fixed = assembled(&arm, "robot.base = \"fixed\"");
    let told = note(&fixed, "A112");
    assert!(
        told.message
            .ends_with("50.000 mm inside the ground, with link 'arm'")
    );
    assert!(
        told.help
            .is_some_and(|help| help.starts_with("start in another pose"))
    );
    assert!(close(fixed.model.roots[0].position.z, 0.0));
    let longer = arm.with("arm", "k", Revolute, at(0.0, 0.0, 0.02), body("hand", 1.0));
    let told = note(&assembled(&longer, "robot.base = \"fixed\""), "A112").message;
    let both = "50.000 mm inside the ground, with link 'arm', and 1 other less deep ('hand')";
    assert!(told.ends_with(both), "{told}");
}

#[test]
fn gravity_of_another_sign_axis_or_unit_is_warned_about_with_what_was_meant() {
    for (gravity, meant) in [
        ("[0, 0, 9.81]", "gravity = [0, 0, -9.81]"),
        ("[1.5, 0, 9]", "gravity = [1.5, 0, -9]"),
        ("[0, -9.81, 0]", "gravity = [0, 0, -9.81]"),
        ("[0, 0, -9810]", "gravity = [0, 0, -9.81]"),
        ("[0, 0, -980.665]", "gravity = [0, 0, -9.81]"),
    ] {
        let found = assembled(&cart(), &format!("world.gravity = {gravity}"));
        let help = note(&found, "A143").help.expect("a remedy");
        assert!(help.contains(meant), "{help}");
    }
    // Weightless, on a wall, on one that leans over, on the moon, and in a centrifuge.
    for gravity in [
        "[0, 0, 0]",
        "[9.81, 0, 0]",
        "[0, -9, 3]",
        "[0, 0, -1.62]",
        "[0, 0, -500]",
    ] {
        let found = assembled(&cart(), &format!("world.gravity = {gravity}"));
        assert!(!has(&found, "A143"), "{gravity}");
    }
    // Seen from above, without a ground.
    let plan = "world.gravity = [0, -9.81, 0]\nworld.ground.type = \"none\"";
    assert!(!has(&assembled(&cart(), plan), "A143"));
}

#[test]
fn without_shapes_or_ground_the_base_starts_at_zero() {
    for (description, settings) in [
        (robot(mass("satellite", 1.0)), ""),
        (cart(), "world.ground = { type = \"none\" }"),
    ] {
        let assembled = assembled(&description, settings);
        assert!(close(assembled.model.roots[0].position.z, 0.0));
        assert!(note(&assembled, "A111").message.contains("z = 0"));
    }
}

#[test]
fn an_initial_velocity_of_a_fixed_base_is_an_error() {
    let found = error(
        &cart(),
        "robot.base = \"fixed\"\ninitial.linear_velocity = [1, 0, 0]",
    );
    assert_eq!(found.code, "A106");
    assert_eq!(found.place.map(|p| p.line), Some(2));
}
