//! Objects: what is driven, and what the meshes of a file become.

use super::world::{built, names, surrounded};
use super::*;
use crate::assemble::{build, of_object, read_options, solid};
use crate::settings::Settings;
use crate::variables;
use std::path::Path;

/// What is driven has inputs for the velocity of its origin, which begin with that of its start; a
/// model that others integrate has no steps at whose ends they could be reached.
#[test]
fn what_is_driven_has_inputs_of_its_velocity() {
    let text = "[[world.object]]\nname = \"table\"\nshape = { box = [1, 1, 0.1] }\n\
                xyz = [0, 3, 1]\nlinear_velocity = [0.5, 0, 0]\ndriven = true";
    let built_up = built(text, None);
    let model = &built_up.model;
    assert_eq!(model.outputs.driven, [crate::model::RootId(1)]);
    let table = variables::table(model).expect("a table");
    for (name, start) in [("linear_velocity.x", 0.5), ("angular_velocity.z", 0.0)] {
        let name = format!("object.table.cmd.{name}");
        let row = table.iter().find(|row| row.name == name).expect("an input");
        assert!(format!("{row:?}").contains("Input"), "{row:?}");
        let simulation = crate::simulation::Simulation::new(model.clone().into());
        let crate::variables::Slot::Input(slot) = row.slot else {
            panic!("{row:?}");
        };
        assert!((simulation.input(slot) - start).abs() < 1e-15);
    }
    assert!(
        names(model)
            .iter()
            .any(|name| name == "object.table.position.x")
    );
    // Once it is read back.
    let bytes = serde_json::to_string(model).expect("a model");
    let read: Model = serde_json::from_str(&bytes).expect("a model");
    assert_eq!(&read, model);
    let findings =
        surrounded(&format!("fmu.interface = \"me\"\n{text}"), None).expect_err("it has no steps");
    let told = findings.iter().find(|finding| finding.code == "A142");
    assert!(
        told.expect("a finding")
            .message
            .contains("'table' is driven")
    );
}

/// What is driven goes where its inputs say: it may come from a file without masses, and what could
/// only pull it elsewhere is refused.
#[test]
fn what_is_driven_needs_no_mass_and_takes_no_loop_to_what_stands() {
    let text = "[[world.object]]\nname = \"lift\"\nurdf = \"lift.urdf\"\nxyz = [2, 0, 0.5]\n\
                driven = true";
    let mut lift = solid(
        "deck",
        &Shape::Box {
            half: Vec3::new(0.5, 0.5, 0.05),
        },
        0.0,
    );
    lift.name = "lift".into();
    let built_up = built(text, Some(&lift));
    assert_eq!(built_up.model.outputs.driven, [crate::model::RootId(1)]);
    let table = "[[world.object]]\nname = \"table\"\nshape = { box = [1, 1, 0.1] }\n\
                 xyz = [0, 3, 1]\ndriven = true";
    let loops = [
        "links = [\"table\", \"world\"]\ntype = \"weld\"",
        "links = [\"lift\", \"table\"]\ntype = \"distance\"",
    ];
    for part in loops {
        let text = format!("{text}\n{table}\n[[loop]]\n{part}");
        let findings = surrounded(&text, Some(&lift)).expect_err("nothing gives way");
        let told = findings.iter().find(|finding| finding.code == "A140");
        let told = told.unwrap_or_else(|| panic!("{findings:?}"));
        assert!(told.message.contains("no force can move"), "{told:?}");
    }
    let pair =
        format!("{table}\n[[outputs.pair]]\nname = \"p\"\nfirst = \"table\"\nsecond = \"ground\"");
    let findings = surrounded(&pair, None).expect_err("they never touch");
    let told = findings.iter().find(|finding| finding.code == "A137");
    assert!(told.is_some(), "{findings:?}");
}

/// What the meshes of an object's file become is said at the object; links without meshes take its
/// friction all the same.
#[test]
fn an_object_says_what_the_meshes_of_its_file_become() {
    let text = r#"<robot name="r"><link name="gate"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><box size="1 1 1"/></geometry></collision></link>
        <link name="post"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><mesh filename="posts.obj"/></geometry></collision></link>
        <joint name="j" type="continuous"><parent link="gate"/><child link="post"/>
        <axis xyz="0 0 1"/></joint></robot>"#;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robots/meshes");
    let shapes = |how: &str| {
        let object =
            format!("[[world.object]]\nname = \"o\"\nurdf = \"o.urdf\"\nfriction = 0.3\n{how}");
        let settings = Settings::parse(&object, "s").expect("settings");
        let own = of_object(&settings.objects[0], &settings);
        let options = read_options(&own, crate::urdf::ReadOptions::default());
        let read = crate::urdf::read_str(text, "o.urdf", &folder, &options).expect("a robot");
        let model = build(&read, &own).expect("a model").model;
        assert!(
            model
                .links
                .iter()
                .all(|link| (link.friction - 0.3).abs() < 1e-15)
        );
        let round = |c: &&crate::model::Collider| matches!(c.shape, Shape::Cylinder { .. });
        [
            model.colliders.len(),
            model.colliders.iter().filter(round).count(),
        ]
    };
    assert_eq!(shapes(""), [2, 0]);
    assert_eq!(shapes("collision = \"objects\""), [3, 0]);
    assert_eq!(shapes("wheel_fit = \"cylinder\""), [2, 1]);
    let refused = "[[world.object]]\nname = \"o\"\nshape = { sphere = 1 }\nmass = 1\n\
                   collision = \"hull\"";
    let findings = Settings::parse(refused, "s").expect_err("a shape has no mesh");
    assert_eq!(findings[0].code, "S106");
}

/// An object that is called as a link is: a pair does not guess which is meant, and neither does a
/// loop or a spring.
#[test]
fn a_name_of_two_things_is_no_end_of_a_loop_or_a_spring() {
    for part in ["[[loop]]\ntype = \"ball\"", "[[spring]]\nstiffness = 100"] {
        let text = |name: &str| {
            format!(
                "[[world.object]]\nname = \"{name}\"\nshape = {{ box = [1, 1, 1] }}\nmass = 1\n\
                 xyz = [0, 3, 1]\n{part}\nlinks = [\"chassis\", \"world\"]\n\
                 origins = [[0, 0, 0], [0, 0, 1]]"
            )
        };
        let findings = surrounded(&text("chassis"), None).expect_err("two things");
        let told = findings.iter().find(|finding| finding.code == "A140");
        let told = told.unwrap_or_else(|| panic!("{findings:?}"));
        assert!(told.message.contains("a link and an object"), "{told:?}");
        assert!(told.place.is_some(), "{told:?}");
    }
}
