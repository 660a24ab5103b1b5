//! Names, limits, friction and damping: what the file says and what the settings put in its place.

use super::*;
use crate::assemble::read_options;
use crate::settings::Settings;
use crate::urdf::ReadOptions;

#[test]
fn names_and_globs_that_match_nothing_name_the_nearest() {
    for settings in [
        "[[actuator]]\njoint = \"lefft\"",
        "[joint.lefft]\ndamping = 1",
        "initial.joints = { lefft = 1 }",
        "initial.joint_velocities = { lefft = 1 }",
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A101", "{settings}");
        assert!(
            found.help.as_deref().is_some_and(|h| h.contains("'left'")),
            "{found:?}"
        );
        assert!(found.place.is_some(), "{settings}");
    }
    // What is like nothing has no nearest name.
    for (glob, told) in [
        ("l*fft*", "the nearest joint is 'left'"),
        ("*lefft", "the nearest joint is 'left'"),
        ("*toe*", "there are 'left', 'right', 'mast'"),
    ] {
        let found = error(&cart(), &format!("[joint.\"{glob}\"]\ndamping = 1"));
        let help = found.help.unwrap_or_default();
        assert!(
            found.code == "A101" && help.starts_with(told),
            "{glob}: {help}"
        );
    }
    let found = error(&cart(), "[[actuator]]\njoint = \"[lr]*\"");
    assert_eq!(found.code, "A101");
    assert!(
        found
            .help
            .as_deref()
            .is_some_and(|h| h.contains("brackets")),
        "{found:?}"
    );
    for settings in [
        "[link.chasis]\nfriction = 1",
        "outputs.links = [\"chasis\"]",
        "outputs.contacts = [\"chasis\"]",
        "[[external_wrench]]\nlink = \"chasis\"",
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A101", "{settings}");
        assert!(
            found
                .help
                .as_deref()
                .is_some_and(|h| h.contains("'chassis'")),
            "{found:?}"
        );
    }
}

#[test]
fn unsuitable_names_say_why_and_globs_pass_over_them() {
    for (settings, why) in [
        ("[[actuator]]\njoint = \"mast\"", "is fixed"),
        ("[joint.mast]\ndamping = 1", "is fixed"),
        ("initial.joints = { mast = 1 }", "is fixed"),
        ("[link.mast_link]\nmass = 2", "no <inertial>"),
        ("outputs.contacts = [\"camera_link\"]", "no collision shape"),
    ] {
        let found = error(&cart(), settings);
        assert_eq!(found.code, "A102", "{settings}");
        assert!(found.message.contains(why), "{}", found.message);
    }
    let model = model(
        &cart(),
        "[joint.\"*\"]\ndamping = 2\n[link.\"*\"]\nmass = 2\n",
    );
    assert!(close(model.joints[0].damping, 2.0) && close(model.joints[2].damping, 0.0));
    assert!(close(model.links[0].inertia.mass, 2.0) && close(model.links[3].inertia.mass, 0.0));
}

#[test]
fn settings_replace_the_file_s_joint_and_link_properties() {
    let model = model(
        &cart(),
        "[joint.\"*\"]\ndamping = 1\nfriction = 2\narmature = 3\n\
         [joint.left]\ndamping = 4\nlimits = { lower = -1, upper = 1 }\neffort = 5\nvelocity = 0\n\
         [link.chassis]\nmass = 10\nfriction = 0.3\nrestitution = 0.5\n",
    );
    let (left, right) = (&model.joints[0], &model.joints[1]);
    assert!(close(left.damping, 4.0) && close(right.damping, 1.0));
    assert!(close(left.friction, 2.0) && close(left.armature, 3.0));
    assert_eq!(
        left.limits,
        Some(Limits {
            lower: -1.0,
            upper: 1.0
        })
    );
    assert_eq!((left.effort, left.velocity), (Some(5.0), None));
    assert_eq!((right.effort, right.velocity), (Some(10.0), Some(5.0)));
    let chassis = &model.links[0];
    assert!(close(chassis.inertia.mass, 10.0) && close(chassis.friction, 0.3));
    // The inertia of the 5 kg ball doubles: 2 · (2/5) 5 0.1².
    assert!(close(chassis.inertia.I_cm[(0, 0)], 0.04));
    assert!(close(model.links[1].friction, 0.8));
}

/// TOML gives tables no order, so the order of a file must not decide between a name and a glob.
#[test]
fn plain_names_win_over_globs_wherever_they_stand() {
    let glob = "[joint.\"*\"]\ndamping = 1\nfriction = 2\n[link.\"*\"]\nfriction = 0.9\n\
                collision = \"hull\"\n";
    let name = "[joint.left]\ndamping = 4\n[link.chassis]\nfriction = 0.1\n\
                collision = \"objects\"\n";
    for text in [format!("{glob}{name}"), format!("{name}{glob}")] {
        let settings = Settings::parse(&text, "test.toml").expect("legal settings");
        let read = read_options(&settings, ReadOptions::default());
        let last = read.meshes.last().map(|(pattern, _)| pattern.text.as_str());
        assert_eq!(last, Some("chassis"), "{text}");
        // The robot has no meshes.
        let model = model(
            &cart(),
            &text
                .replace("collision = \"hull\"\n", "")
                .replace("collision = \"objects\"\n", ""),
        );
        assert!(close(model.joints[0].damping, 4.0) && close(model.joints[1].damping, 1.0));
        assert!(close(model.joints[0].friction, 2.0), "{text}");
        assert!(close(model.links[0].friction, 0.1) && close(model.links[1].friction, 0.9));
    }
    // Of two globs the later one counts.
    let model = model(
        &cart(),
        "[link.\"c*\"]\nfriction = 0.1\n[link.\"*\"]\nfriction = 0.9",
    );
    assert!(close(model.links[0].friction, 0.9));
}

#[test]
fn half_a_range_without_the_file_s_other_half_is_an_error() {
    let found = error(&cart(), "[joint.left]\nlimits = { lower = -1 }");
    assert_eq!(found.code, "A117");
    let arm =
        robot(mass("base", 1.0)).with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("t", 1.0));
    let set = model(&arm, "[joint.j]\nlimits = { lower = 0.5 }");
    assert_eq!(
        set.joints[0].limits,
        Some(Limits {
            lower: 0.5,
            upper: 2.0
        })
    );
    assert_eq!(
        error(&arm, "[joint.j]\nlimits = { lower = 3 }").code,
        "A117"
    );
}

#[test]
fn limits_that_are_no_range_are_ignored() {
    let description = robot(mass("base", 1.0))
        .with("base", "j", Revolute, at(0.0, 0.0, 0.0), mass("t", 1.0))
        .and(|j| {
            j.limits = Some(Limits {
                lower: 0.0,
                upper: -1.0,
            });
        });
    let assembled = assembled(&description, "");
    assert_eq!(assembled.model.joints[0].limits, None);
    assert_eq!(note(&assembled, "A117").severity, Severity::Warning);
}

#[test]
fn properties_of_planar_and_floating_joints_are_not_used() {
    let description = robot(frame("world"))
        .with("world", "p", Planar, at(0.0, 0.0, 0.0), mass("puck", 1.0))
        .and(|j| j.damping = 1.0);
    let assembled = assembled(&description, "");
    assert_eq!(note(&assembled, "A122").severity, Severity::Warning);
    assert!(close(assembled.model.joints[0].damping, 0.0));
}

#[test]
fn surfaces_and_rotors_of_foreign_tags_are_used_unless_the_settings_differ() {
    let mut wheel = body("wheel", 1.0);
    wheel.friction = Some(0.5);
    wheel.static_friction = Some(0.75);
    wheel.rolling_friction = Some(0.001);
    wheel.torsional_friction = Some(0.02);
    let description = robot(mass("base", 1.0))
        .with("base", "j", Continuous, at(0.0, 0.0, 0.0), wheel)
        .and(|j| j.armature = 0.25);
    let built = model(&description, "");
    let link = &built.links[1];
    assert!(close(link.friction, 0.5) && close(link.static_excess, 0.5));
    assert!(close(link.rolling_friction, 0.001) && close(link.torsional_friction, 0.02));
    assert!(close(built.joints[0].armature, 0.25));
    let set = "[link.wheel]\nrolling_friction = 0\nfriction = 0.9\n[joint.j]\narmature = 1";
    let built = model(&description, set);
    let link = &built.links[1];
    // The file's friction at rest goes with the file's sliding friction.
    assert!(close(link.friction, 0.9) && close(link.static_excess, 0.0));
    assert!(close(link.rolling_friction, 0.0) && close(link.torsional_friction, 0.02));
    assert!(close(built.joints[0].armature, 1.0));
}

#[test]
fn default_friction_is_reported_once_and_only_if_it_is_used() {
    assert!(
        note(&assembled(&cart(), ""), "A116")
            .message
            .contains("3 links")
    );
    let mut cube = body("cube", 1.0);
    cube.friction = Some(0.3);
    cube.restitution = Some(0.4);
    let built = assembled(&robot(cube), "");
    assert!(!has(&built, "A116"));
    assert!(
        close(built.model.links[0].friction, 0.3) && close(built.model.links[0].restitution, 0.4)
    );
}

#[test]
fn surfaces_take_their_friction_at_rest_and_against_turning_from_the_settings() {
    let settings = "[link.\"*_wheel\"]\nfriction = 0.5\nstatic_friction = 0.6\n\
                    rolling_friction = 2e-3\ntorsional_friction = 1e-3\n";
    let model = model(&cart(), settings);
    let wheel = model.links.iter().find(|l| l.name == "left_wheel");
    let wheel = wheel.expect("the wheel");
    // 0.6/0.5 − 1.
    assert!(close(wheel.static_excess, 0.2));
    assert!(close(wheel.rolling_friction, 2e-3) && close(wheel.torsional_friction, 1e-3));
    let chassis = &model.links[0];
    assert!(close(chassis.static_excess, 0.0) && close(chassis.rolling_friction, 0.0));
    let low = "[link.chassis]\nstatic_friction = 0.3\n";
    let refused = error(&cart(), low);
    assert_eq!(refused.code, "A125");
    assert!(refused.place.is_some());
}

#[test]
fn joints_and_motors_take_their_laws_from_the_settings() {
    let settings = "[joint.left]\nfriction = 0.2\nstatic_friction = 0.3\nstribeck_velocity = 0.05\n\
                    enforce_velocity = true\n[[actuator]]\njoint = \"left\"\nno_load_speed = 30\n";
    let assembled = assembled(&cart(), settings);
    let left = &assembled.model.joints[0];
    // 0.3/0.2 − 1.
    assert!(close(left.static_excess, 0.5) && close(left.stribeck_velocity, 0.05));
    assert!(left.enforce_velocity && !assembled.model.joints[1].enforce_velocity);
    let speeds: Vec<_> = assembled
        .model
        .actuators
        .iter()
        .map(|a| a.no_load_speed)
        .collect();
    assert_eq!(speeds, [Some(30.0), None]);
    // The other wheel has a velocity limit in the file and no position servo.
    let unbound = note(&assembled, "A124");
    assert!(unbound.message.contains("1 joint") && unbound.message.contains("'right'"));
    assert_eq!(
        error(&cart(), "[joint.left]\nstatic_friction = 0.3\n").code,
        "A125"
    );
}
