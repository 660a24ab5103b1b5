//! `[[world.object]]` and `[[world.robot]]`.

use super::*;
use crate::geometry::Shape;
use std::path::Path;

/// The one object of a settings file in a folder.
fn object(text: &str) -> ObjectSettings {
    let text = format!("[[world.object]]\nname = \"thing\"\n{text}");
    let settings = Settings::parse(&text, "folder/robot.toml");
    let mut settings = settings.unwrap_or_else(|findings| panic!("{findings:?}"));
    assert_eq!(settings.objects.len(), 1);
    settings.objects.remove(0)
}

fn message(text: &str) -> (&'static str, usize, String) {
    let found = finding(text);
    let line = place(&found).0;
    let help = found.help.unwrap_or_default();
    (found.code, line, format!("{} {help}", found.message))
}

#[test]
fn an_object_is_a_file_or_a_shape_at_a_place() {
    let cup = object("urdf = \"cup.urdf\"\nxyz = [1, 2, 3]\nrpy = [0, 0, 1]\nstatic = true");
    let file = Path::new("folder").join("cup.urdf");
    assert_eq!(cup.source, ObjectSource::Urdf(file));
    assert_eq!((cup.initial.xy, cup.initial.z), ([1.0, 2.0], Some(3.0)));
    assert_eq!(cup.initial.rpy, Vec3::z());
    assert!(cup.fixed);
    let solid = |text: &str| match object(&format!("shape = {text}\nmass = 2")).source {
        ObjectSource::Solid { shape, mass: 2.0 } => shape,
        other => panic!("{other:?}"),
    };
    let half = Vec3::new(0.5, 1.0, 1.5);
    assert_eq!(solid("{ box = [1, 2, 3] }"), Shape::Box { half });
    assert_eq!(solid("{ sphere = 0.5 }"), Shape::Sphere { radius: 0.5 });
    let (radius, half_length) = (0.5, 1.0);
    let cylinder = Shape::Cylinder {
        radius,
        half_length,
    };
    assert_eq!(solid("{ cylinder = [0.5, 2] }"), cylinder);
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    assert_eq!(solid("{ capsule = [0.5, 2] }"), capsule);
    let ball = object(
        "shape = { sphere = 0.1 }\nmass = 1\nxyz = [1, 2]\nlinear_velocity = [0, 0, 3]\n\
         angular_velocity = [4, 0, 0]\nfriction = 0.3\nrestitution = 0.5",
    );
    // Without z it stands on the ground.
    assert_eq!((ball.initial.xy, ball.initial.z), ([1.0, 2.0], None));
    assert_eq!(ball.initial.linear_velocity, Vec3::new(0.0, 0.0, 3.0));
    assert_eq!(ball.initial.angular_velocity, Vec3::new(4.0, 0.0, 0.0));
    let surface = &ball.surface;
    assert_eq!(
        (surface.friction, surface.restitution),
        (Some(0.3), Some(0.5))
    );
}

#[test]
fn a_further_robot_has_a_name_a_file_and_settings_of_its_own() {
    let text = "[[world.robot]]\nname = \"left\"\nurdf = \"arm.urdf\"\nconfig = \"/a/arm.toml\"\n\
                xyz = [0, 1, 2]\nfixed_base = true";
    let mut settings = Settings::parse(text, "folder/robot.toml").expect("legal settings");
    let robot = settings.robots.remove(0);
    assert_eq!(robot.name.text, "left");
    assert_eq!(robot.urdf, Path::new("folder").join("arm.urdf"));
    assert_eq!(robot.config.as_deref(), Some(Path::new("/a/arm.toml")));
    assert_eq!((robot.xy, robot.z), (Some([0.0, 1.0]), Some(2.0)));
    assert_eq!((robot.rpy, robot.fixed_base), (None, Some(true)));
}

#[test]
fn objects_that_say_too_little_or_too_much_are_errors_at_their_line() {
    let start = "[[world.object]]\nname = \"a\"\n";
    for (text, code, line, word) in [
        ("", "S107", 1, "'urdf' or 'shape'"),
        ("urdf = \"a\"\nshape = { sphere = 1 }", "S106", 4, "twice"),
        ("urdf = \"a\"\nmass = 1", "S106", 4, "'mass'"),
        ("shape = { sphere = 1 }", "S107", 1, "static = true"),
        ("shape = { sphere = -1 }\nmass = 1", "S104", 3, "'sphere'"),
        ("shape = { box = [1, 2] }\nmass = 1", "S103", 3, "3 numbers"),
        ("shape = { cone = 1 }\nmass = 1", "S102", 3, "'cone'"),
        ("shape = {}\nmass = 1", "S106", 3, "one of box"),
        ("shape = { sphere = 1 }\nmass = -1", "S104", 4, "'mass'"),
        (
            "shape = { sphere = 1 }\nmass = 1\ncolor = 1",
            "S102",
            5,
            "'color'",
        ),
        (
            "shape = { sphere = 1, box = [1, 1, 1] }\nmass = 1",
            "S106",
            3,
            "one of box",
        ),
        (
            "urdf = \"a\"\nstatic = true\nangular_velocity = [1, 0, 0]",
            "S106",
            5,
            "static",
        ),
    ] {
        let (found, at, words) = message(&format!("{start}{text}"));
        assert_eq!((found, at), (code, line), "{text}: {words}");
        assert!(words.contains(word), "{text}: {words}");
    }
    assert_eq!(message("[[world.object]]\nurdf = \"a\"").0, "S107");
    assert_eq!(message("[[world.robot]]\nname = \"a\"").0, "S107");
    assert_eq!(message("[[world.robot]]\nurdf = \"a\"").0, "S107");
    assert_eq!(message("[[world.robot]]\nname = \"a\"\nurdf = 1").0, "S103");
}

#[test]
fn names_that_hide_variables_or_that_two_have_are_errors_at_the_name() {
    let thing = |name: &str| format!("[[world.object]]\nname = \"{name}\"\nurdf = \"a\"\n");
    for name in ["cmd", "joint", "object", "pair", "base", "world"] {
        let (code, line, words) = message(&thing(name));
        assert_eq!((code, line), ("S106", 2), "{name}: {words}");
        assert!(words.contains("group of variables"), "{words}");
    }
    // Both become `a_b` in the names of variables.
    let (code, line, words) = message(&format!("{}{}", thing("a b"), thing("a-b")));
    assert_eq!((code, line), ("S106", 5), "{words}");
    assert!(words.contains("second thing"), "{words}");
    let robot = "[[world.robot]]\nname = \"a\"\nurdf = \"a\"\n";
    assert_eq!(message(&format!("{robot}{}", thing("a"))).1, 5);
}

/// What is driven needs no mass, and yields as little as what is static: it is one of the two.
#[test]
fn what_is_driven_has_no_need_of_a_mass() {
    let table = object("shape = { box = [1, 1, 0.1] }\ndriven = true\nlinear_velocity = [1, 0, 0]");
    assert!(table.driven && !table.fixed);
    assert!(matches!(table.source, ObjectSource::Solid { mass, .. } if mass > 0.0));
    assert!(!object("shape = { sphere = 1 }\nmass = 2").driven);
    for other in ["static", "conveyor"] {
        let text = format!(
            "[[world.object]]\nname = \"a\"\nshape = {{ sphere = 1 }}\n{other} = true\ndriven = true"
        );
        let (code, line, told) = message(&text);
        assert_eq!(code, "S106");
        assert_eq!(line, if other == "static" { 5 } else { 4 }, "{told}");
    }
    // No advice leads from one error to another one.
    for (keys, advice) in [
        (
            "conveyor = true\ndriven = true",
            "leave out conveyor or driven",
        ),
        (
            "static = true\nconveyor = true\ndriven = true",
            "leave out driven",
        ),
    ] {
        let text =
            format!("[[world.object]]\nname = \"a\"\nshape = {{ sphere = 1 }}\nmass = 1\n{keys}");
        let told = message(&text).2;
        assert!(told.contains(advice), "{keys}: {told}");
    }
    // What else is computed of a static object has nothing to say of its velocity.
    let text = "[[world.object]]\nname = \"a\"\nshape = { sphere = 1 }\nstatic = true\n\
                linear_velocity = [1, 0, 0]";
    assert_eq!(message(text).0, "S106");
    let (settings, _) = Settings::read_by(Reader::new("f", text), None);
    let initial = &settings.expect("the rest").objects[0].initial;
    assert_eq!(initial.linear_velocity, Vec3::zeros());
}
