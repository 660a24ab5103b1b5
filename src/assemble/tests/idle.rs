//! Settings that change nothing are told.

use super::*;
use crate::assemble::{Guest, of_object, solid, world};
use crate::settings::Settings;

/// The warnings and notes A144, with the lines that they mark.
fn told(settings: &str) -> Vec<(Severity, Option<usize>, String)> {
    let built = assembled(&cart(), settings);
    let found = built.diagnostics.into_iter().filter(|d| d.code == "A144");
    found
        .map(|d| (d.severity, d.place.map(|p| p.line), d.message))
        .collect()
}

#[test]
fn keys_without_the_one_that_they_belong_to_are_warned_of_at_their_place() {
    for (settings, line, word) in [
        (
            "[joint.left]\nstribeck_velocity = 0.1",
            Some(1),
            "stribeck_velocity",
        ),
        (
            "\n[joint.\"*\"]\nfriction = 1\nstribeck_velocity = 0.1\nstatic_friction = 1",
            Some(2),
            "[joint.\"*\"]",
        ),
        (
            "[link.chassis]\nrestitution = 0.5\ndissipation = 10",
            Some(1),
            "dissipation",
        ),
        (
            "[link.chassis]\ndissipation = 10\n[link.\"*\"]\nrestitution = 0.5",
            Some(1),
            "[link.\"chassis\"]",
        ),
        ("[contact]\nstribeck_velocity = 0.1", None, "[contact]"),
        (
            "[robot]\nself_collision = true\n[[ignore_contact]]\nlinks = [\"chassis\"]",
            Some(4),
            "'chassis' alone is no pair",
        ),
        (
            "[[ignore_contact]]\nlinks = [\"*\"]",
            Some(2),
            "without self_collision",
        ),
        (
            "[link.chassis]\nwheel_fit = \"cylinder\"",
            Some(1),
            "no collision shape there is a mesh",
        ),
        ("[fmu]\narrays = \"all\"", None, "FMI 2 has no arrays"),
        (
            "[outputs]\ncontact_points = true\n[world.ground]\ntype = \"none\"",
            None,
            "without a ground no link has contact outputs",
        ),
        (
            "[joint.left]\nvelocity = 0\nenforce_velocity = true",
            Some(1),
            "there is no velocity limit",
        ),
        (
            "[link.mast_link]\nrestitution = 0.5\n",
            Some(1),
            "'restitution' of [link.\"mast_link\"]",
        ),
        (
            "[link.\"*a*_link\"]\nstiffness = 1e4\n",
            Some(1),
            "there is no collision shape",
        ),
        (
            "[contact]\npenetration = 1e-5\n[link.\"*\"]\nstiffness = 1e5",
            None,
            "'penetration' of [contact]",
        ),
        (
            "[contact]\ndissipation = 9\n[link.\"*\"]\ndissipation = 8",
            None,
            "'dissipation' of [contact]",
        ),
        (
            "[[actuator]]\njoint = \"left\"\nmode = \"velocity\"\nmax_effort = 3\n\
             [[actuator]]\njoint = \"*\"\nmode = \"effort\"\n\
             [[actuator]]\njoint = \"*\"\nno_load_speed = 5\nmax_effort = 3",
            Some(2),
            "[[actuator]] of 'left' changes nothing",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nrays = 5",
            None,
            "its 5 rays have one direction",
        ),
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nrows = 3",
            None,
            "its 3 rows have one direction",
        ),
    ] {
        warns(settings, line, word);
    }
}

/// What the sensor, the importer or the lack of anything to touch makes idle.
#[test]
fn keys_of_sensors_solver_and_contacts_without_an_effect_are_warned_of() {
    for (settings, line, word) in [
        (
            "[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nignore = [\"camera_link\", \"left_wheel\"]",
            Some(4),
            "'camera_link' in 'ignore' of sensor 'chassis'",
        ),
        (
            "[[sensor]]\ntype = \"imu\"\nlink = \"chassis\"\nrate = 10\nseed = 5\n\
             angular_velocity = { noise = [0, 0, 0] }",
            Some(3),
            "'seed' of sensor 'chassis'",
        ),
        (
            "[solver]\nstep_size = 1e-3\n[fmu]\ninterface = \"me\"",
            None,
            "'step_size' of [solver]",
        ),
        (
            "[solver]\nmax_steps = 100\n[fmu]\ninterface = \"me\"",
            None,
            "the importer takes the steps",
        ),
        (
            "[contact]\nstiffness = 1e5\n[world.ground]\ntype = \"none\"",
            None,
            "'stiffness' of [contact] changes nothing: there is nothing that touches",
        ),
    ] {
        warns(settings, line, word);
    }
}

/// One warning at a line, and with some words.
fn warns(settings: &str, line: Option<usize>, word: &str) {
    let found = told(settings);
    let [(severity, place, message)] = &found[..] else {
        panic!("{settings}: {found:?}");
    };
    assert_eq!((*severity, *place), (Severity::Warning, line), "{settings}");
    assert!(message.contains(word), "{settings}: {message}");
}

#[test]
fn keys_that_have_an_effect_on_anything_are_not() {
    for settings in [
        // Another table gives the friction at rest, or leaves a link that does not bounce.
        "[joint.\"*\"]\nstribeck_velocity = 0.1\n[joint.left]\nfriction = 1\nstatic_friction = 2",
        "[link.\"*\"]\ndissipation = 10\n[link.chassis]\nrestitution = 0.5",
        "[contact]\nstribeck_velocity = 0.1\n[link.chassis]\nstatic_friction = 1",
        "[contact]\nstribeck_velocity = 0.1\n[world.ground]\nstatic_friction = 1",
        "[robot]\nself_collision = true\n[[ignore_contact]]\nlinks = [\"*\"]",
        "[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nignore = [\"*\"]",
        "[[sensor]]\ntype = \"imu\"\nlink = \"chassis\"\nrate = 10\nseed = 5\n\
         angular_velocity = { noise = [0, 0, 1] }",
        "[solver]\nstep_size = 1e-3\n[fmu]\ninterface = \"both\"",
        "[robot]\nself_collision = true\n[contact]\nstiffness = 1e5\n[world.ground]\ntype = \"none\"",
        "[link.\"*\"]\nwheel_fit = \"none\"",
        "[fmu]\narrays = \"all\"\nfmi = 3",
        "[outputs]\ncontact_points = true\ncontacts = [\"chassis\"]\n[world.ground]\ntype = \"none\"",
        "[joint.\"*\"]\nenforce_velocity = true\n[joint.left]\nvelocity = 5",
        "[link.\"*\"]\nfriction = 0.5",
        "[contact]\npenetration = 1e-5\n[link.chassis]\nstiffness = 1e5",
        // A key that later entries leave alone, and a joint that they do not mean.
        "[[actuator]]\njoint = \"left\"\nmax_effort = 3\n[[actuator]]\njoint = \"*\"\nmode = \"velocity\"",
        "[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n[[actuator]]\njoint = \"left\"\nmode = \"velocity\"",
        "[[sensor]]\ntype = \"ray\"\nlink = \"chassis\"\nrays = 5\nfov = 1",
        // As `init` writes it.
        "[contact]\nstribeck_velocity = 0.01",
        // The ground, which is not as bouncy, decides with the link.
        "[robot]\ncompat = \"pybullet\"\n[link.chassis]\nrestitution = 0.5\ndissipation = 10",
    ] {
        assert!(
            told(settings).is_empty(),
            "{settings}: {:?}",
            told(settings)
        );
    }
}

#[test]
fn sensors_of_a_file_without_any_are_noted() {
    let found = told("[robot]\nsensors = \"urdf\"");
    let [(Severity::Note, None, message)] = &found[..] else {
        panic!("{found:?}");
    };
    assert!(message.contains("changes nothing"), "{message}");
}

/// The chassis is a ball of 0.1 m about its frame, so that a box of 0.1 m touches it up to 0.15 m.
#[test]
fn a_contact_sensor_whose_box_lies_off_its_link_is_told() {
    for (keys, off) in [
        ("size = [0.1, 0.1, 0.1]\nxyz = [5, 0, 0]", true),
        ("size = [0.1, 0.1, 0.1]\nxyz = [0, 0.151, 0]", true),
        ("size = [0.1, 0.1, 0.1]\nxyz = [0, 0.149, 0]", false),
        // The border of a thousandth reaches what it is flush with.
        ("size = [0.1, 0.1, 0.1]\nxyz = [0, 0.15, 0]", false),
        // Turned by 45° a corner reaches 0.07 m.
        (
            "size = [0.1, 0.1, 0.1]\nxyz = [0, 0.169, 0]\nrpy = [0.785398, 0, 0]",
            false,
        ),
        ("size = [1, 1, 1]", false),
        ("size = [0.01, 0.01, 0.01]", false),
        ("xyz = [5, 0, 0]", false),
    ] {
        let text = format!("[[sensor]]\ntype = \"contact\"\nlink = \"chassis\"\n{keys}");
        let built = assembled(&cart(), &text);
        let found = built.diagnostics.iter().find(|d| d.code == "A131");
        assert_eq!(found.is_some(), off, "{keys}: {found:?}");
        let line = found.and_then(|d| Some(d.place.as_ref()?.line));
        assert_eq!(line, off.then_some(3), "{keys}");
    }
}

/// As U035 tells them of a URDF: 90 rad are 14 turns.
#[test]
fn limits_and_positions_in_degrees_are_told() {
    let arm = robot(mass("foot", 1.0))
        .with("foot", "j", Revolute, at(0.0, 0.0, 1.0), mass("a", 1.0))
        .with("a", "k", Continuous, at(0.0, 0.0, 1.0), mass("b", 1.0));
    for (settings, line) in [
        ("[joint.j]\nlimits = { lower = -90, upper = 90 }", Some(1)),
        ("[joint.k]\nlimits = { lower = -90, upper = 90 }", Some(1)),
        ("[joint.j]\nlimits = { lower = -2, upper = 166 }", Some(1)),
        ("[initial]\njoints = { k = 90 }", Some(2)),
        ("[joint.j]\nlimits = { lower = -1.57, upper = 1.57 }", None),
        ("[initial]\njoints = { k = 6.2 }", None),
    ] {
        let built = assembled(&arm, settings);
        let found = built.diagnostics.iter().find(|d| d.code == "S104");
        let place = found.and_then(|d| Some(d.place.as_ref()?.line));
        assert_eq!(place, line, "{settings}");
        assert!(found.is_none_or(|d| d.message.contains("looks like degrees")));
    }
}

#[test]
fn masses_that_no_link_needs_are_noted() {
    for key in ["density = 1000", "missing_mass = 0.1"] {
        let found = told(&format!("[robot]\n{key}"));
        let [(Severity::Note, None, message)] = &found[..] else {
            panic!("{key}: {found:?}");
        };
        assert!(message.contains("changes nothing"), "{message}");
    }
    let light = robot(mass("base", 1.0)).with(
        "base",
        "j",
        Continuous,
        at(0.0, 0.0, 0.0),
        LinkDescription {
            inertial: None,
            ..body("wheel", 1.0)
        },
    );
    for key in ["density = 1000", "missing_mass = 0.1"] {
        let built = assembled(&light, &format!("[robot]\n{key}"));
        assert!(has(&built, "A138") && !has(&built, "A144"), "{key}");
    }
}

/// The missing mass of the robot's settings is that of objects, too.
#[test]
fn a_missing_mass_that_only_an_object_needs_is_not_noted() {
    let settings = Settings::parse(
        "[robot]\nmissing_mass = 0.1\n[[world.object]]\nname = \"o\"\nurdf = \"o.urdf\"\n\
         xyz = [3, 0, 3]\n[[world.object]]\nname = \"p\"\nshape.sphere = 0.1\nmass = 1\n\
         xyz = [6, 0, 3]",
        "test.toml",
    )
    .expect("legal settings");
    let lamp =
        robot(mass("foot", 1.0)).with("foot", "j", Continuous, at(0.0, 0.0, 0.0), frame("shade"));
    let guest = |number: usize, name: &str, description: Description| Guest {
        name: name.into(),
        kind: crate::model::RootKind::Object,
        description,
        settings: of_object(&settings.objects[number], &settings),
    };
    let codes = |guests: &[Guest]| {
        let built = world(&cart(), &settings, guests).expect("a world");
        let told = built.diagnostics.iter().map(|d| d.code);
        told.filter(|code| ["A138", "A144"].contains(code))
            .collect::<Vec<_>>()
    };
    let ball = guest(1, "p", solid("p", &ball(), 1.0));
    assert_eq!(codes(std::slice::from_ref(&ball)), ["A144"]);
    assert_eq!(codes(&[ball, guest(0, "o", lamp)]), ["A138"]);
}

/// Links that are one body never touch each other.
#[test]
fn self_collision_of_one_body_is_told() {
    let one =
        robot(body("base", 1.0)).with("base", "j", Fixed, at(0.0, 0.0, 1.0), body("top", 1.0));
    let two =
        robot(body("base", 1.0)).with("base", "j", Continuous, at(0.0, 0.0, 1.0), body("top", 1.0));
    for (robot, idle) in [(one, true), (two, false)] {
        let found = assembled(&robot, "[robot]\nself_collision = true");
        assert_eq!(has(&found, "A144"), idle);
    }
}

/// A spring that pushes has no direction where both of its points are one.
#[test]
fn a_spring_between_points_that_are_one_is_told() {
    for (keys, idle) in [
        ("stiffness = 10\nlength = 0.2", true),
        ("stiffness = 10", false),
        ("damping = 10", false),
        (
            "stiffness = 10\nlength = 0.2\norigins = [[0, 0, 0.1], [0, 0, 0]]",
            false,
        ),
    ] {
        let text = format!(
            "[[spring]]\nlinks = [\"chassis\", \"world\"]\n{keys}\n[initial]\nxyz = [0, 0, 0]\n"
        );
        let found = assembled(&cart(), &text);
        assert_eq!(has(&found, "A140"), idle, "{keys}");
    }
}

/// What is mounted in the world does not move against the ground, and without self-collision no
/// link of its own touches it.
#[test]
fn a_contact_sensor_on_which_nothing_can_press_is_told() {
    let sensor = "[[sensor]]\ntype = \"contact\"\nlink = \"chassis\"\n";
    for (robot, idle) in [
        ("base = \"fixed\"", true),
        ("base = \"fixed\"\nself_collision = true", false),
        ("base = \"floating\"", false),
    ] {
        let found = told(&format!("[robot]\n{robot}\n{sensor}"));
        let found = found
            .iter()
            .find(|(.., text)| text.contains("contact sensor"));
        assert_eq!(found.is_some(), idle, "{robot}: {found:?}");
        let line = found.and_then(|(_, line, _)| *line);
        assert_eq!(line, idle.then_some(5), "{found:?}");
    }
    let wheel = sensor.replace("chassis", "left_wheel");
    assert_eq!(told(&format!("[robot]\nbase = \"fixed\"\n{wheel}")), []);
}
