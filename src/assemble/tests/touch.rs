//! Which links of one robot touch each other: what the settings and an SRDF say, and links that
//! overlap before anything moves.

use super::world::surrounded;
use super::*;
use crate::assemble::build;
use crate::model::RootId;
use crate::settings::Settings;
use crate::testing::run;

/// Balls of 0.1 m on two slides along z in front of a frame that is mounted: the lower one's origin
/// is as high as `low`, the upper one's 0.5 m.
fn slides(low: f64) -> Description {
    robot(frame("post"))
        .with("post", "up", Prismatic, at(0.0, 0.0, low), body("low", 1.0))
        .with(
            "post",
            "down",
            Prismatic,
            at(0.0, 0.0, 0.5),
            body("high", 1.0),
        )
}

/// Without weight, pushed by their motors.
const PUSHED: &str = "[robot]\nbase = \"fixed\"\nself_collision = true\n[world]\n\
     gravity = [0, 0, 0]\nground.type = \"none\"\n[[actuator]]\njoint = \"*\"\n\
     mode = \"effort\"\n";

/// Two links whose motors press them on each other with 5 N feel these, unless the settings or an
/// SRDF keep them apart: then they pass each other, as fast as the motors accelerate them.
#[test]
fn links_that_are_kept_apart_do_not_push_each_other() {
    let ignored = "[[ignore_contact]]\nlinks = [\"low\", \"h*\"]\n";
    let pair = |a: &str, b: &str| vec![[a.to_owned(), b.to_owned()]];
    for (more, disabled, touch) in [
        ("", Vec::new(), true),
        (ignored, Vec::new(), false),
        ("", pair("high", "low"), false),
        ("", pair("high", "post"), true),
        ("robot.self_collision = false", Vec::new(), false),
    ] {
        let text = if more.starts_with("robot") {
            PUSHED.replace("self_collision = true", "self_collision = false")
        } else {
            PUSHED.to_owned() + more
        };
        let mut settings = Settings::parse(&text, "test.toml").expect("legal settings");
        settings.disabled_contacts = disabled;
        let model = build(&slides(0.0), &settings).expect("a robot").model;
        let mut simulation = Simulation::new(Arc::new(model));
        simulation.initialize(0.0).expect("a legal start");
        simulation.set_input(InputSlot::Effort(ActuatorId(0)), 5.0);
        simulation.set_input(InputSlot::Effort(ActuatorId(1)), -5.0);
        run(&mut simulation, 0.6, 0.01);
        // 0.3 m apart they meet after 0.24 s.
        let force = simulation.output(OutputSlot::ContactForce(LinkId(1), 2));
        let velocity = simulation.output(OutputSlot::JointVelocity(JointId(0), 0));
        let case = format!("{text} {:?}", settings.disabled_contacts);
        if touch {
            assert!((force + 5.0).abs() < 1e-5, "{case}: {force} N");
            assert!(velocity.abs() < 1e-6, "{case}: {velocity} m/s");
        } else {
            assert!(force.abs() <= 0.0, "{case}: {force} N");
            assert!((velocity - 3.0).abs() < 1e-9, "{case}: {velocity} m/s");
        }
    }
}

/// A136: links that overlap by more than a millimetre before anything moves, where they start or
/// where all joints are zero, are named with their depth, and do not touch each other.
#[test]
fn links_that_overlap_before_anything_moves_are_named_with_their_depth() {
    let told = |low: f64, more: &str| {
        let found = assembled(&slides(low), &(PUSHED.to_owned() + more));
        let warnings = found.diagnostics.iter().filter(|d| d.code == "A136");
        let words: Vec<String> = warnings.map(|d| d.message.clone()).collect();
        assert!(words.len() < 2, "{words:?}");
        assert_eq!(found.model.apart.len(), words.len());
        (words.first().cloned().unwrap_or_default(), found)
    };
    // The balls' middles are 0.2 m apart where they touch.
    let (words, found) = told(0.35, "");
    assert!(
        words.contains("'low' and 'high' overlap by 50.0 mm"),
        "{words}"
    );
    assert_eq!(note(&found, "A136").severity, Severity::Warning);

    assert!(told(0.3012, "").0.contains("1.2 mm"));
    // A millimetre is left to the contact.
    assert_eq!(told(0.3008, "").0, "");
    // They start apart, but are drawn with what overlaps, and the other way round.
    let away = "[initial.joints]\nup = -0.5\n";
    assert!(told(0.35, away).0.contains("50.0 mm"));
    let near = "[initial.joints]\nup = 0.33\n";
    assert!(told(0.0, near).0.contains("30.0 mm"));
    // The deeper of both counts.
    let deeper = "[initial.joints]\nup = 0.02\n";
    assert!(told(0.35, deeper).0.contains("70.0 mm"));
    // What the settings name is meant.
    let named = "[[ignore_contact]]\nlinks = [\"low\", \"high\"]\n";
    let found = assembled(&slides(0.35), &(PUSHED.to_owned() + named));
    assert!(!has(&found, "A136"));
    let alone = PUSHED.replace("self_collision = true", "self_collision = false");
    assert!(!has(&assembled(&slides(0.35), &alone), "A136"));
}

/// Six balls of 0.1 m on slides, 0, 1, 3, 6, 10 and 15 cm high, so that all 6 · 5/2 = 15 pairs
/// overlap: they are one warning, and its first are those that are 1 cm apart, by 20 − 1 cm.
#[test]
fn many_links_that_overlap_are_one_warning_with_the_deepest_first() {
    let mut drawn = robot(frame("post"));
    for (name, height) in [
        ("f", 0.15),
        ("a", 0.0),
        ("b", 0.01),
        ("c", 0.03),
        ("d", 0.06),
        ("e", 0.1),
    ] {
        let slide = format!("slide_{name}");
        let place = at(0.0, 0.0, height);
        drawn = drawn.with("post", &slide, Prismatic, place, body(name, 1.0));
    }
    let found = assembled(&drawn, PUSHED);
    let told: Vec<_> = found
        .diagnostics
        .iter()
        .filter(|d| d.code == "A136")
        .collect();
    assert_eq!((told.len(), found.model.apart.len()), (1, 15));
    let message = &told[0].message;
    assert!(
        message.starts_with("links 'a' and 'b' overlap by 190.0 mm"),
        "{message}"
    );
    assert!(
        message.ends_with("nor do those of 14 more pairs"),
        "{message}"
    );
    let help = told[0].help.as_deref().unwrap_or_default();
    assert_eq!(help.matches(" overlap by ").count(), 14, "{help}");
}

/// A cube that falls on the cart, and one that begins in it.
const FALLING: &str = "[[world.object]]\nname = \"cube\"\nshape = { box = [0.1, 0.1, 0.1] }\n\
     mass = 1\nxyz = [0, 0, 1]\n";

/// What is named with the links of the robot passes through them and lies on the ground after
/// `√(2 · 0.95/9.81)` = 0.44 s, 5 cm below its middle, and does not push what it begins in. Else it
/// lies on the chassis, a ball whose top is at 0.3 m.
#[test]
fn links_of_a_robot_and_an_object_are_kept_apart_by_their_names() {
    let height = |more: &str| {
        let built = surrounded(&format!("{FALLING}{more}"), None).expect("a world");
        assert!(!has(&built, "A144"), "{more}");
        let mut simulation = Simulation::new(Arc::new(built.model));
        simulation.initialize(0.0).expect("a legal start");
        run(&mut simulation, 0.5, 0.01);
        let base = OutputSlot::BasePosition(RootId(1), 2);
        simulation.output(base)
    };
    assert!(height("") > 0.2, "{}", height(""));
    for links in [
        "\"*\", \"cube\"",
        "\"cube.*\", \"*\"",
        "\"cube.cube\", \"*\"",
    ] {
        let apart = format!("[[ignore_contact]]\nlinks = [{links}]\n");
        let z = height(&apart);
        assert!((z - 0.05).abs() < 1e-4, "{links}: {z}");
        let inside = FALLING.replace("[0, 0, 1]", "[0, 0, 0.1]");
        let told = |more: &str| {
            let built = surrounded(&format!("{inside}{more}"), None).expect("a world");
            has(&built, "A135")
        };
        assert!(told("") && !told(&apart), "{links}");
    }
}

/// Nineteen cubes on the ground have too many states for Model Exchange; the advice is to leave out
/// pairs.
#[test]
fn objects_that_do_not_touch_each_other_have_no_states_of_their_pairs() {
    let cube = |i: usize| {
        FALLING
            .replace("\"cube\"", &format!("\"cube{i}\""))
            .replace("[0, 0, 1]", &format!("[{i}, 2]"))
    };
    let cubes: String = (0..19).map(cube).collect();
    let exchanged = format!("{cubes}[fmu]\ninterface = \"me\"\n");
    assert!(surrounded(&exchanged, None).is_err());
    let apart = "[[ignore_contact]]\nlinks = [\"*\", \"cube*.*\"]\n";
    assert!(surrounded(&format!("{exchanged}{apart}"), None).is_ok());
}

#[test]
fn what_cannot_be_kept_apart_in_a_world_is_told() {
    for (links, code, said) in [
        ("\"*\", \"cub\"", "A101", "the nearest is 'cube'"),
        ("\"*\", \"ground\"", "A102", "the ground is no link"),
        ("\"cube\"", "A144", "no two of these links touch"),
        (
            "\"cube\", \"cube.cube\"",
            "A144",
            "no two of these links touch",
        ),
    ] {
        let text = format!("{FALLING}[[ignore_contact]]\nlinks = [{links}]\n");
        let findings = match surrounded(&text, None) {
            Ok(built) => built.diagnostics,
            Err(findings) => findings,
        };
        let found: Vec<_> = findings.iter().filter(|d| d.code == code).collect();
        let [found] = found[..] else {
            panic!("{links}: {:?}", texts(&findings));
        };
        let help = found.help.clone().unwrap_or_default();
        assert!(
            found.message.contains(said) || help.contains(said),
            "{found:?}"
        );
        assert!(found.place.is_some(), "{found:?}");
    }
}
