//! Robots and objects in one world.

use super::*;
use crate::assemble::{Assembled, Guest, of_object, of_robot, solid, take_ground, world};
use crate::diagnostic::Diagnostic;
use crate::model::RootKind;
use crate::settings::{ObjectSettings, ObjectSource, Settings};
use crate::variables;

/// The cart with the objects of a settings file, which are solids, or the file of a test's own.
pub(super) fn surrounded(
    text: &str,
    file: Option<&Description>,
) -> Result<Assembled, Vec<Diagnostic>> {
    let settings = Settings::parse(text, "test.toml").expect("legal settings");
    let guests = guests(&settings, |name, source| match source {
        ObjectSource::Terrain(_) => solid(name, &Shape::Plane, 0.0),
        _ => file.expect("a file").clone(),
    });
    world(&cart(), &settings, &guests)
}

/// The objects of settings.
///
/// - `describe`: what is no solid
pub(super) fn guests(
    settings: &Settings,
    mut describe: impl FnMut(&str, &ObjectSource) -> Description,
) -> Vec<Guest> {
    let guest = |object: &ObjectSettings| {
        let name = object.name.as_ref().expect("a name").text.clone();
        let description = match &object.source {
            ObjectSource::Solid { shape, mass } => solid(&name, shape, *mass),
            source => describe(&name, source),
        };
        Guest {
            name,
            kind: RootKind::Object,
            description,
            settings: of_object(object, settings),
        }
    };
    settings.objects.iter().map(guest).collect()
}

pub(super) fn built(text: &str, file: Option<&Description>) -> Assembled {
    surrounded(text, file).unwrap_or_else(|findings| panic!("{}", texts(&findings).join("\n")))
}

pub(super) fn names(model: &Model) -> Vec<String> {
    let table = variables::table(model).expect("a table");
    table.into_iter().map(|variable| variable.name).collect()
}

#[test]
fn gravity_that_points_up_is_told_once_for_all_that_is_in_the_world() {
    let built = built(
        "world.gravity = [0, 0, 9.81]\n[[world.object]]\nname = \"cube\"\n\
         shape = { box = [0.2, 0.4, 0.6] }\nmass = 3\nxyz = [1, 2]",
        None,
    );
    let told = built.diagnostics.iter().filter(|d| d.code == "A143");
    assert_eq!(told.count(), 1);
}

#[test]
fn notes_that_are_alike_for_many_objects_are_told_once_with_their_number() {
    let notes = |count: u32| {
        let cubes = (0..count).map(|i| {
            format!(
                "[[world.object]]\nname = \"b{i}\"\nmass = 1\nxyz = [{}, 2]\n\
                 shape = {{ box = [0.1, 0.1, {}] }}\n",
                0.5 * f64::from(i),
                0.1 + 0.01 * f64::from(i)
            )
        });
        let text: String = cubes.collect();
        let starts = |d: &&Diagnostic| d.code == "A111" && d.message.contains("object");
        let built = built(&text, None);
        let told: Vec<String> = built
            .diagnostics
            .iter()
            .filter(starts)
            .map(|d| d.message.clone())
            .collect();
        told
    };
    assert_eq!(notes(3).len(), 3);
    let told = notes(20);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with("object 'b0': it starts"), "{told:?}");
    assert!(told[0].ends_with("(and alike for 19 others)"), "{told:?}");
}

/// What is told of a hundred objects beside an error is what is told without it, so that the error
/// is not behind it: of names, and of what makes no world.
#[test]
fn notes_that_are_alike_are_told_once_beside_errors_too() {
    let objects = |count: usize| -> String {
        let one = |i: usize| {
            format!(
                "[[world.object]]\nname = \"b{i}\"\nmass = 1\nxyz = [{i}, 2]\n\
                 shape = {{ box = [0.1, 0.1, 0.1] }}\n"
            )
        };
        (0..count).map(one).collect()
    };
    let hundred = objects(100);
    let sound = built(&hundred, None).diagnostics;
    assert!(sound.len() < 10, "{:?}", texts(&sound));
    for (slip, code) in [
        (
            "[[outputs.pair]]\nname = \"p\"\nfirst = \"nope\"\nsecond = \"b1\"\n",
            "A101",
        ),
        (
            "[[loop]]\ntype = \"ball\"\nlinks = [\"chassis\", \"nope\"]\n",
            "A101",
        ),
        ("[link.nope]\nfriction = 1\n", "A101"),
    ] {
        let found = surrounded(&format!("{hundred}{slip}"), None).expect_err(slip);
        let (errors, others): (Vec<_>, Vec<_>) = found
            .into_iter()
            .partition(|d| d.severity == Severity::Error);
        let codes: Vec<_> = errors.iter().map(|d| d.code).collect();
        assert_eq!(codes, [code], "{slip}");
        // Where things start is told once nothing is wrong.
        assert!(
            others.iter().all(|d| sound.contains(d)),
            "{slip}: {:?}",
            texts(&others)
        );
    }
    let found = surrounded(&objects(400), None).expect_err("2,400 degrees of freedom");
    let at = found.iter().position(|d| d.code == "A121");
    assert!(at.is_some_and(|at| at < 10), "{at:?} of {}", found.len());
}

#[test]
fn a_cube_beside_a_cart_has_its_own_variables_and_stands_on_the_ground() {
    let built = built(
        "[[world.object]]\nname = \"cube\"\nshape = { box = [0.2, 0.4, 0.6] }\nmass = 3\n\
         xyz = [1, 2]\nfriction = 0.3\nrestitution = 0.1",
        None,
    );
    let model = &built.model;
    assert_eq!(model.roots.len(), 2);
    let root = &model.roots[1];
    assert_eq!((root.name.as_str(), root.kind), ("cube", RootKind::Object));
    assert_eq!((root.position.x, root.position.y), (1.0, 2.0));
    assert!(root.set_down && sunk(root.position.z, 0.3), "{root:?}");
    let link = model.links.last().expect("a link");
    assert_eq!((link.friction, link.restitution), (0.3, 0.1));
    // A cuboid's: m (y² + z²) / 12 and so on.
    let moments = link.inertia.I_cm.diagonal();
    for (i, squares) in [0.16 + 0.36, 0.04 + 0.36, 0.04 + 0.16]
        .into_iter()
        .enumerate()
    {
        assert!(close(moments[i], 3.0 * squares / 12.0), "{moments}");
    }
    let all = names(model);
    for name in [
        "object.cube.position.x",
        "initial.object.cube.position.z",
        "object.cube.contact.cube.force.z",
        "base.position.x",
        "cmd.left.velocity",
    ] {
        assert!(all.iter().any(|n| n == name), "{name} of {all:#?}");
    }
    let note = built
        .diagnostics
        .iter()
        .find(|d| d.code == "A111" && d.message.contains("cube"));
    let note = note.expect("a note about its height");
    assert!(
        note.message.starts_with("object 'cube': it starts"),
        "{}",
        note.message
    );
}

#[test]
fn joints_of_objects_are_passive() {
    let door = robot(body("frame", 5.0)).with(
        "frame",
        "hinge",
        Revolute,
        at(0.5, 0.0, 0.0),
        mass("leaf", 1.0),
    );
    let text = "[[world.object]]\nname = \"door\"\nurdf = \"door.urdf\"\nxyz = [3, 0, 1]\n\
                static = true";
    let built = built(text, Some(&door));
    let alone = model(&cart(), "");
    assert_eq!(built.model.actuators, alone.actuators);
    assert!(!built.model.floats(crate::model::RootId::from(1)));
    let all = names(&built.model);
    assert!(
        all.iter().any(|n| n == "object.door.joint.hinge.position"),
        "{all:#?}"
    );
    assert!(
        all.iter()
            .any(|n| n == "initial.object.door.joint.hinge.position")
    );
    assert!(!all.iter().any(|n| n.contains("door.cmd")), "{all:#?}");
}

#[test]
fn a_static_object_without_a_height_stands_on_the_ground() {
    let built = built(
        "[[world.object]]\nname = \"wall\"\nshape = { box = [0.2, 4, 0.6] }\nstatic = true\n\
         xyz = [2, 0]",
        None,
    );
    let root = &built.model.roots[1];
    assert!(close(root.position.z, 0.3), "{root:?}");
    assert!(!root.set_down);
    assert_eq!(built.model.nv(), model(&cart(), "").nv());
}

#[test]
fn findings_in_an_object_say_whose_they_are() {
    let text = "[[world.object]]\nname = \"arm\"\nurdf = \"arm.urdf\"\nxyz = [3, 0, 1]";
    // A moving link without mass.
    let broken =
        robot(body("base", 5.0)).with("base", "elbow", Revolute, at(0.5, 0.0, 0.0), frame("hand"));
    let mut broken = broken;
    broken.sources = vec!["arm.urdf".into()];
    let findings = surrounded(text, Some(&broken)).expect_err("a hand without mass");
    let wrong = findings
        .iter()
        .find(|d| d.severity == Severity::Error)
        .expect("an error");
    let place = wrong.place.as_ref().map(|p| p.file.as_str());
    assert!(
        place == Some("arm.urdf") || wrong.message.starts_with("object 'arm': "),
        "{wrong:?}"
    );
}

#[test]
fn shapes_that_overlap_at_the_start_are_warned_of_with_their_depth() {
    // The chassis is a ball of 0.1 m at z = 0.5, the box reaches up to 0.45 below it.
    let text = |top: f64| {
        format!(
            "initial.xyz = [0, 0, 0.5]\n[[world.object]]\nname = \"box\"\nmass = 1\n\
             shape = {{ box = [0.2, 0.2, 0.2] }}\nxyz = [0, 0, {}]",
            top - 0.1
        )
    };
    let warned = note(&built(&text(0.45), None), "A135");
    assert_eq!(warned.severity, Severity::Warning);
    assert!(
        warned.message.contains("'chassis' and 'box.box'"),
        "{warned:?}"
    );
    assert!(warned.message.contains("50.0 mm"), "{warned:?}");
    assert!(!has(&built(&text(0.3999), None), "A135"));
    // 0.5 mm are left to the contact.
    assert!(!has(&built(&text(0.4005), None), "A135"));
}

#[test]
fn a_second_robot_keeps_its_commands_and_takes_the_world_of_the_first() {
    let text = "world.gravity = [0, 0, -1.62]\n[[world.robot]]\nname = \"left\"\n\
                urdf = \"a\"\nxyz = [0, 1]";
    let settings = Settings::parse(text, "test.toml").expect("legal settings");
    let own = Settings::parse(
        "[[actuator]]\njoint = \"left\"\nmode = \"effort\"",
        "own.toml",
    );
    let entry = &settings.robots[0];
    let own = of_robot(entry, own.expect("legal settings"), &settings).expect("no contradiction");
    let guests = [Guest {
        name: "left".to_owned(),
        kind: RootKind::Robot,
        description: cart(),
        settings: own,
    }];
    let built = world(&cart(), &settings, &guests).expect("a world");
    assert_eq!(built.model.roots[1].position.y.to_bits(), 1.0_f64.to_bits());
    assert_eq!(built.model.actuators.len(), 4);
    let all = names(&built.model);
    for name in [
        "left.cmd.left.effort",
        "cmd.left.velocity",
        "left.base.position.z",
    ] {
        assert!(all.iter().any(|n| n == name), "{name} of {all:#?}");
    }
    for wrong in [
        "world.gravity = [0, 0, -3]",
        "solver.step_size = 0.01",
        "contact.penetration = 1e-3",
        "fmu.naming = \"flat\"",
        "[[world.object]]\nname = \"a\"\nurdf = \"a\"",
    ] {
        let own = Settings::parse(wrong, "own.toml").expect("legal settings");
        let errors = of_robot(entry, own, &settings).expect_err(wrong);
        assert_eq!(errors.len(), 1, "{wrong}");
        assert_eq!(errors[0].code, "A133", "{wrong}");
        assert_eq!(errors[0].place.as_ref().map(|p| p.line), Some(2));
    }
}

#[test]
fn a_large_box_without_mass_below_zero_is_the_ground() {
    let text = "[[world.object]]\nname = \"plane\"\nurdf = \"plane.urdf\"";
    let plane = |size: f64, top: f64, mass: f64| {
        let half = Vec3::new(size / 2.0, size / 2.0, 5.0);
        let mut link = frame("planeLink");
        link.collisions = vec![collision(at(0.0, 0.0, top - 5.0), Shape::Box { half })];
        link.friction = Some(1.0);
        link.inertial = (mass > 0.0).then(|| ball().solid_inertia(mass));
        robot(link)
    };
    let taken = |text: &str, description: &Description| {
        let mut settings = Settings::parse(text, "test.toml").expect("legal settings");
        let object = settings.objects[0].clone();
        let note = take_ground("plane", &object, description, &mut settings);
        note.map(|note| (note, settings.world.ground.expect("a ground").friction))
    };
    let (note, friction) = taken(text, &plane(30.0, 0.0, 0.0)).expect("a ground");
    assert_eq!(friction.to_bits(), 1.0_f64.to_bits());
    assert_eq!((note.code, note.severity), ("A134", Severity::Note));
    assert!(note.message.contains("'plane'") && note.message.contains("friction 1"));
    // The settings win over the file.
    let own = format!("{text}\nfriction = 0.2");
    let (_, friction) = taken(&own, &plane(30.0, 0.0, 0.0)).expect("a ground");
    assert_eq!(friction.to_bits(), 0.2_f64.to_bits());
    // There is a ground even where the settings have none.
    let none = format!("world.ground = {{ type = \"none\" }}\n{text}");
    assert!(taken(&none, &plane(30.0, 0.0, 0.0)).is_some());
    for other in [
        plane(1.0, 0.0, 0.0),
        plane(30.0, 0.1, 0.0),
        plane(30.0, 0.0, 1.0),
    ] {
        assert!(taken(text, &other).is_none());
    }
    for place in ["xyz = [0, 0, 0.5]", "xyz = [1, 0]", "rpy = [0.1, 0, 0]"] {
        let moved = format!("{text}\n{place}");
        assert!(taken(&moved, &plane(30.0, 0.0, 0.0)).is_none(), "{place}");
    }
}

/// What Model Exchange has no equations for is told by its name, and in co-simulation nothing is.
#[test]
fn what_cannot_be_exchanged_is_refused() {
    let cube = "[[world.object]]\nname = \"cube\"\nshape = { box = [0.2, 0.4, 0.6] }\nmass = 3\n\
                xyz = [1, 2]\n";
    for (line, told) in [
        ("restitution = 0.1\n", "link 'cube.cube' has a restitution"),
        (
            "[[sensor]]\ntype = \"imu\"\nname = \"gyro\"\nlink = \"left_wheel\"\nrate = 100\n",
            "sensor 'gyro' takes samples or errs",
        ),
        (
            "[[sensor]]\ntype = \"imu\"\nname = \"drift\"\nlink = \"left_wheel\"\n\
             angular_velocity = { bias = [0.1, 0, 0] }\n",
            "sensor 'drift' takes samples or errs",
        ),
        (
            "[[loop]]\nname = \"pin\"\ntype = \"ball\"\nlinks = [\"left_wheel\", \"world\"]\n",
            "loop 'pin' closes a chain",
        ),
        ("[[sensor]]\ntype = \"imu\"\nlink = \"left_wheel\"\n", ""),
        ("", ""),
    ] {
        for interface in ["cs", "me", "both"] {
            let text = format!("{cube}{line}[fmu]\ninterface = \"{interface}\"\n");
            match surrounded(&text, None) {
                Ok(_) => assert!(told.is_empty() || interface == "cs", "{interface} {line}"),
                Err(findings) => {
                    assert!(interface != "cs", "{:?}", texts(&findings));
                    let codes: Vec<_> = findings.iter().filter(|f| f.code == "A142").collect();
                    assert_eq!(codes.len(), 1);
                    assert!(codes[0].message.contains(told), "{}", codes[0].message);
                }
            }
        }
    }
}

#[test]
fn a_model_of_too_many_states_is_refused() {
    let cube = |i: usize| {
        format!(
            "[[world.object]]\nname = \"cube{i}\"\nshape = {{ box = [0.1, 0.1, 0.1] }}\n\
             mass = 1\nxyz = [{i}, 2]\n"
        )
    };
    let cubes: Vec<String> = (0..19).map(cube).collect();
    let cubes = cubes.concat();
    let findings = surrounded(&format!("{cubes}[fmu]\ninterface = \"me\"\n"), None)
        .expect_err("171 pairs of cubes have three states each");
    let told = findings.iter().find(|finding| finding.code == "A142");
    assert!(told.is_some_and(|finding| finding.message.contains("continuous states")));
}

/// What an object's surface has beside its friction, of a shape, of a file and as the ground; and
/// friction at rest below that of sliding is an error at the object's line.
#[test]
fn objects_roll_turn_and_stick_as_their_settings_say() {
    let start = "[[world.object]]\nname = \"cube\"\n";
    let keys = "friction = 0.4\nstatic_friction = 0.6\nrolling_friction = 1e-3\n\
                torsional_friction = 2e-3\n";
    let shape = "shape = { box = [0.2, 0.4, 0.6] }\nmass = 3\nxyz = [3, 2]\n";
    let mut file = body("thing", 1.0);
    (file.friction, file.rolling_friction) = (Some(0.9), Some(0.1));
    for (source, file) in [
        (shape, None),
        ("urdf = \"a\"\nxyz = [3, 2, 1]\n", Some(robot(file))),
    ] {
        let model = built(&format!("{start}{source}{keys}"), file.as_ref()).model;
        let link = model.links.last().expect("a link");
        assert_eq!(link.friction.to_bits(), 0.4_f64.to_bits());
        assert!(close(link.static_excess, 0.5), "{link:?}");
        assert_eq!(
            (link.rolling_friction, link.torsional_friction),
            (1e-3, 2e-3)
        );
    }
    let wrong = format!("{start}{shape}friction = 0.4\nstatic_friction = 0.3");
    let findings = surrounded(&wrong, None).expect_err("less at rest than sliding");
    let told = findings
        .iter()
        .find(|d| d.code == "A125")
        .expect("an error");
    let place = told.place.as_ref().map(|place| place.line);
    assert_eq!(place, Some(1), "{told:?}");
    let half = Vec3::new(15.0, 15.0, 5.0);
    let mut plane = frame("planeLink");
    plane.collisions = vec![collision(at(0.0, 0.0, -5.0), Shape::Box { half })];
    let text = format!("[[world.object]]\nname = \"plane\"\nurdf = \"a\"\n{keys}");
    let mut settings = Settings::parse(&text, "test.toml").expect("legal settings");
    let object = settings.objects[0].clone();
    take_ground("plane", &object, &robot(plane.clone()), &mut settings).expect("a ground");
    let ground = settings.world.ground.clone().expect("a ground");
    assert!(close(ground.static_excess, 0.5), "{ground:?}");
    assert_eq!(
        (ground.rolling_friction, ground.torsional_friction),
        (1e-3, 2e-3)
    );
    let text = text.replace("0.6", "0.2");
    let mut settings = Settings::parse(&text, "test.toml").expect("legal settings");
    let object = settings.objects[0].clone();
    assert!(take_ground("plane", &object, &robot(plane), &mut settings).is_none());
}
