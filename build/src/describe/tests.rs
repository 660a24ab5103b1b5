//! The XML is read back by a reader that follows the specification and shares no code with the
//! writer.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

#[path = "../../../tests/export/model_description.rs"]
mod model_description;

use super::*;
use crate::units;
use model_description::{Element, problems};
use urdf2fmu_core::model::{
    ActuatorId, Combination, ContactDefaults, Initial, Joint, JointId, JointKind, LinkId, Mimic,
    OutputSelection, SolverDefaults, StateId, World,
};
use urdf2fmu_core::settings::FmuSettings;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot};
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_core::variables::{Kind, Part, Slot, Unit};

/// Two joints, the second mimics the first; nothing here looks at links or bodies.
fn model() -> Model {
    let joint = |name: &str, mimic| Joint {
        name: name.to_owned(),
        kind: JointKind::Revolute,
        parent: LinkId(0),
        child: LinkId(1),
        X_PJ: Pose::IDENTITY,
        axis: Vec3::x(),
        bodies: Vec::new(),
        limits: None,
        effort: None,
        velocity: None,
        damping: 0.0,
        friction: 0.0,
        armature: 0.0,
        static_excess: 0.0,
        stribeck_velocity: 0.01,
        enforce_velocity: false,
        mimic,
    };
    let mimic = Mimic {
        joint: JointId(0),
        multiplier: 1.0,
        offset: 0.0,
    };
    Model {
        name: "two".to_owned(),
        links: Vec::new(),
        joints: vec![joint("a", None), joint("b", Some(mimic))],
        bodies: Vec::new(),
        roots: Vec::new(),
        dofs: Vec::new(),
        nq: 0,
        apart: Vec::new(),
        loops: Vec::new(),
        springs: Vec::new(),
        colliders: Vec::new(),
        actuators: Vec::new(),
        initial: Initial {
            joint_positions: Vec::new(),
            joint_velocities: Vec::new(),
        },
        solver: SolverDefaults {
            step_size: 0.0,
            tolerance: 0.0,
            max_steps: urdf2fmu_core::range::MOST_STEPS,
        },
        contact: ContactDefaults {
            penetration: 1e-4,
            stiffness: None,
            dissipation: 51.0,
            stribeck_velocity: 0.01,
        },
        world: World {
            gravity: Vec3::zeros(),
            combination: Combination::Mean,
            drag: 0.0,
            ground: None,
        },
        outputs: OutputSelection::default(),
    }
}

fn row(value_reference: u32, slot: Slot, kind: Kind, unit: Unit, start: Option<f64>) -> Variable {
    Variable {
        name: format!("v{value_reference}"),
        value_reference,
        description: "a <b> & \"c\"\u{7}\n'd'".to_owned(),
        slot,
        kind,
        stepped: false,
        start,
        min: None,
        max: None,
        unit,
        part: None,
        state: None,
        display: unit.display(),
        nominal: None,
    }
}

/// Rows 1 … 7.
fn table() -> Vec<Variable> {
    let input = Slot::Input(InputSlot::Velocity(ActuatorId(0)));
    let position = |joint| Slot::Output(OutputSlot::JointPosition(JointId(joint), 0));
    let initial = |slot| Slot::Parameter(slot);
    let mut table = vec![
        row(0, input, Kind::Real, Unit::RadianPerSecond, Some(0.1 + 0.2)),
        row(1, position(0), Kind::Real, Unit::Radian, None),
        row(2, position(1), Kind::Real, Unit::Radian, None),
        row(
            3,
            Slot::Output(OutputSlot::JointEffort(JointId(0))),
            Kind::Real,
            Unit::NewtonMeter,
            None,
        ),
        row(
            4,
            Slot::Output(OutputSlot::ContactActive(LinkId(0))),
            Kind::Boolean,
            Unit::One,
            None,
        ),
        row(
            5,
            initial(ParameterSlot::InitialJointPosition(JointId(0))),
            Kind::Real,
            Unit::Radian,
            Some(-0.0),
        ),
        row(
            6,
            initial(ParameterSlot::Gravity(2)),
            Kind::Real,
            Unit::MeterPerSecondSquared,
            Some(-9.81),
        ),
        row(
            7,
            Slot::Output(OutputSlot::Steps),
            Kind::Integer,
            Unit::One,
            None,
        ),
    ];
    table[0].min = Some(-1e300);
    table[0].max = Some(7.0);
    table
}

fn xml(table: &[Variable]) -> Result<String, DescribeError> {
    let header = Header {
        model_name: "two & more",
        model_identifier: "two",
        guid: "{0}",
        date: "1980-01-01T00:00:00Z",
        description: "x",
        about: &FmuSettings::default(),
    };
    model_description(&header, &model(), table).map(|bytes| String::from_utf8(bytes).unwrap())
}

#[test]
fn description_keeps_every_rule_of_the_specification() {
    assert_eq!(problems(&xml(&table()).unwrap()), Vec::<String>::new());
}

/// Else the test above could not fail.
#[test]
fn the_test_s_reader_reports_broken_rules_of_the_specification() {
    let good = xml(&table()).unwrap();
    for (from, to) in [
        ("valueReference=\"1\"", "valueReference=\"2\""),
        ("start=\"-9.81\"", "start=\"NaN\""),
        ("max=\"7\"", "max=\"0.1\""),
        ("<Unit name=\"rad\"", "<Unit name=\"radian\""),
        ("<Unknown index=\"2\"", "<Unknown index=\"1\""),
        ("dependencies=\"6\"", "dependencies=\"2\""),
        ("dependencies=\"6\"", "dependencies=\"6 1\""),
        ("canGetAndSetFMUstate=\"true\"", ""),
        (
            "providesDirectionalDerivative=\"false\"",
            "providesDirectionalDerivative=\"true\"",
        ),
        ("name=\"v1\"", "name=\"v[2]\""),
        ("min=\"-1e300\"", "min=\"1\""),
        ("variability=\"tunable\"", "variability=\"continuous\""),
        ("modelIdentifier=\"two\"", "modelIdentifier=\"2\""),
        (
            "<Real declaredType=\"Torque\"",
            "<Real start=\"1\" declaredType=\"Torque\"",
        ),
    ] {
        assert!(good.contains(from), "{from} not in the text");
        assert!(
            !problems(&good.replacen(from, to, 1)).is_empty(),
            "{to} goes unnoticed"
        );
    }
}

#[test]
fn doubles_and_texts_read_back_exactly() {
    let text = xml(&table()).unwrap();
    let root = Element::read(&text);
    let variables = root.list("ModelVariables");
    let attribute = |i: usize, name: &str| variables[i].children[0].get(name).unwrap().to_owned();
    let start: f64 = attribute(0, "start").parse().unwrap();
    assert_eq!(start.to_bits(), (0.1_f64 + 0.2).to_bits());
    assert_eq!(attribute(0, "min"), "-1e300");
    assert_eq!(attribute(5, "start"), "0");
    assert_eq!(root.get("modelName"), Some("two & more"));
    assert_eq!(variables[0].get("description"), Some("a <b> & \"c\"  'd'"));
}

#[test]
fn initial_position_of_a_mimic_joint_follows_its_leader_and_forces_follow_everything() {
    let root = Element::read(&xml(&table()).unwrap());
    let unknowns: Vec<_> = root
        .child("ModelStructure")
        .unwrap()
        .list("InitialUnknowns")
        .iter()
        .map(|u| (u.get("index").unwrap(), u.get("dependencies")))
        .collect();
    let expected = [("2", Some("6")), ("3", Some("6")), ("4", None), ("5", None)];
    assert_eq!(unknowns, expected);
}

#[test]
fn angles_have_degrees_and_radians_are_a_base_unit() {
    let root = Element::read(&xml(&table()).unwrap());
    let unit = |name: &str| {
        root.list("UnitDefinitions")
            .iter()
            .find(|u| u.get("name") == Some(name))
            .unwrap()
    };
    assert_eq!(unit("rad").child("BaseUnit").unwrap().get("rad"), Some("1"));
    let degrees = unit("rad").child("DisplayUnit").unwrap();
    assert_eq!(degrees.get("name"), Some("deg"));
    // π rad are 180 degrees.
    let factor: f64 = degrees.get("factor").unwrap().parse().unwrap();
    assert!((factor * std::f64::consts::PI - 180.0).abs() < 1e-13);
    let torque = unit("N.m").child("BaseUnit").unwrap();
    assert_eq!(
        (torque.get("kg"), torque.get("m"), torque.get("s")),
        (Some("1"), Some("2"), Some("-2"))
    );
    assert_eq!(torque.get("rad"), None);
}

/// SI brochure: N = kg m/s², J = N m; a stiffness is per angle, a damping per angular velocity.
#[test]
fn derived_units_are_products_of_their_parts() {
    let exponents = |unit| units::facts(unit).exponents.map(|(_, n)| n);
    let minus = |a: [i8; 4], b: [i8; 4]| [0, 1, 2, 3].map(|i| a[i] - b[i]);
    let (force, torque) = (exponents(Unit::Newton), exponents(Unit::NewtonMeter));
    assert_eq!(force, [1, 1, -2, 0]);
    assert_eq!(exponents(Unit::Joule), minus(force, [0, -1, 0, 0]));
    for (quotient, above, below) in [
        (Unit::NewtonPerMeter, force, Unit::Meter),
        (Unit::NewtonSecondPerMeter, force, Unit::MeterPerSecond),
        (Unit::NewtonMeterPerRadian, torque, Unit::Radian),
        (
            Unit::NewtonMeterSecondPerRadian,
            torque,
            Unit::RadianPerSecond,
        ),
        (
            Unit::MeterPerSecondSquared,
            exponents(Unit::MeterPerSecond),
            Unit::Second,
        ),
        (
            Unit::RadianPerSecondSquared,
            exponents(Unit::RadianPerSecond),
            Unit::Second,
        ),
    ] {
        assert_eq!(
            exponents(quotient),
            minus(above, exponents(below)),
            "{quotient:?}"
        );
    }
}

#[test]
fn a_table_of_variables_that_fmi_forbids_is_refused() {
    let broken = |change: fn(&mut Vec<Variable>)| {
        let mut table = table();
        change(&mut table);
        xml(&table)
    };
    assert!(matches!(
        broken(|t| t[0].start = Some(f64::INFINITY)),
        Err(DescribeError::NotFinite {
            attribute: "start",
            ..
        })
    ));
    assert!(matches!(
        broken(|t| t[0].max = Some(0.0)),
        Err(DescribeError::Range { .. })
    ));
    assert!(matches!(
        broken(|t| t[1].name = "v0".into()),
        Err(DescribeError::Duplicate { .. })
    ));
    assert!(matches!(
        broken(|t| t[1].value_reference = 0),
        Err(DescribeError::Duplicate { .. })
    ));
    assert!(matches!(
        broken(|t| t[6].start = None),
        Err(DescribeError::NoStart { .. })
    ));
}

/// The table with rows 2 and 3 as a vector, in FMI 3.
fn xml_of_fmi_3() -> Element {
    xml_of_fmi_3_with(table())
}

fn xml_of_fmi_3_with(mut table: Vec<Variable>) -> Element {
    for (index, row) in (0..).zip(&mut table[1..3]) {
        row.part = Some(Part {
            whole: "v".to_owned(),
            description: "both".to_owned(),
            index,
            shape: vec![2],
        });
    }
    let about = FmuSettings {
        fmi: FmiVersion::V3,
        ..FmuSettings::default()
    };
    let header = Header {
        model_name: "two & more",
        model_identifier: "two",
        guid: "{0}",
        date: "1980-01-01T00:00:00Z",
        description: "x",
        about: &about,
    };
    let text = model_description(&header, &model(), &table).unwrap();
    Element::read(&String::from_utf8(text).unwrap())
}

#[test]
fn a_vector_of_fmi_3_has_dimension_elements_and_the_dependencies_of_all() {
    let root = xml_of_fmi_3();
    assert_eq!(root.get("fmiVersion"), Some("3.0"));
    assert_eq!(root.get("instantiationToken"), Some("{0}"));
    let variables = root.list("ModelVariables");
    let names: Vec<_> = variables.iter().map(|v| v.get("name").unwrap()).collect();
    assert_eq!(names, ["time", "v0", "v", "v3", "v4", "v5", "v6", "v7"]);
    let vector = &variables[2];
    assert_eq!(
        (vector.name.as_str(), vector.get("valueReference")),
        ("Float64", Some("1"))
    );
    assert_eq!(vector.child("Dimension").unwrap().get("start"), Some("2"));
    assert_eq!(vector.get("intermediateUpdate"), Some("true"));
    assert_eq!(variables[4].get("intermediateUpdate"), None);
    let structure = &root.child("ModelStructure").unwrap().children;
    let unknowns: Vec<_> = structure
        .iter()
        .map(|u| {
            let reference = u.get("valueReference").unwrap();
            (u.name.as_str(), reference, u.get("dependencies"))
        })
        .collect();
    let expected = [
        ("Output", "1", Some("")),
        ("Output", "3", Some("")),
        ("Output", "4", Some("")),
        ("InitialUnknown", "1", Some("5")),
        ("InitialUnknown", "3", None),
        ("InitialUnknown", "4", None),
    ];
    assert_eq!(unknowns, expected);
}

/// The library takes inputs and outputs there: a state of Model Exchange that is no output is none.
#[test]
fn what_is_local_is_not_offered_within_steps() {
    let mut table = table();
    let state = Slot::Output(OutputSlot::State(StateId(0)));
    table.push(row(8, state, Kind::Real, Unit::Meter, None));
    let root = xml_of_fmi_3_with(table);
    let of = |name| {
        let variables = root.list("ModelVariables");
        let found = variables.iter().find(|v| v.get("name") == Some(name));
        let attribute = |key| found.and_then(|v| v.get(key)).map(str::to_owned);
        (attribute("causality"), attribute("intermediateUpdate"))
    };
    let expected = |causality: &str, update: Option<&str>| {
        (Some(causality.to_owned()), update.map(str::to_owned))
    };
    assert_eq!(of("v8"), expected("local", None));
    assert_eq!(of("v0"), expected("input", Some("true")));
    assert_eq!(of("v3"), expected("output", Some("true")));
}
