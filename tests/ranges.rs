//! Every number that a user can give, at its extremes: it is either refused where it is given, or
//! the robot goes on with finite results within the work that a step may take.

#![allow(clippy::unwrap_used, reason = "a test may fail")]
#![allow(missing_docs, reason = "tests say it in their names")]

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::assemble;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::model::{Model, RootKind};
use urdf2fmu_core::range::Range;
use urdf2fmu_core::settings::keys::{KEYS, Key, Takes};
use urdf2fmu_core::settings::{ObjectSource, Settings};
use urdf2fmu_core::simulation::{InputSlot, Simulation, SimulationError};
use urdf2fmu_core::urdf::{self, ReadOptions};
use urdf2fmu_core::variables::{Slot, Variable, table};

#[path = "../src/testing/random.rs"]
#[allow(missing_docs, reason = "shared with the unit tests")]
mod random;
use random::Random;

/// Numbers that nobody means.
const EXTREMES: [f64; 22] = [
    0.0,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    1e-100,
    1e-18,
    1e-6,
    -1e-3,
    1e3,
    -1e3,
    1e4,
    -1e4,
    1e5,
    -1e5,
    1e6,
    -1e6,
    1e12,
    1e100,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NAN,
];

/// Communication steps that are taken.
const STEPS: i32 = 5;

fn rover() -> String {
    std::fs::read_to_string("examples/rover.urdf").unwrap()
}

/// The robot of a text, or what was found.
fn robot(urdf: &str, settings: &str) -> Result<Model, Vec<Diagnostic>> {
    let settings = Settings::parse(settings, "robot.toml")?;
    let options = assemble::read_options(&settings, ReadOptions::default());
    let description = urdf::read_str(urdf, "robot.urdf", Path::new("examples"), &options)?;
    let guests = settings.objects.iter().filter_map(|object| {
        let ObjectSource::Solid { shape, mass } = &object.source else {
            return None;
        };
        Some(assemble::Guest {
            name: "thing".to_owned(),
            kind: RootKind::Object,
            description: assemble::solid("thing", shape, *mass),
            settings: assemble::of_object(object, &settings),
        })
    });
    let guests: Vec<_> = guests.collect();
    Ok(assemble::world(&description, &settings, &guests)?.model)
}

/// What came of a robot that was accepted.
#[derive(Debug, PartialEq)]
enum Outcome {
    Finite,
    /// A step was given up and says so.
    Discarded(SimulationError),
    /// A number that is none came out without an error.
    NotFinite(String),
}

/// Takes steps and reads everything.
fn run(simulation: &mut Simulation, rows: &[Variable]) -> Outcome {
    for i in 1..=STEPS {
        if let Err(error) = simulation.advance_to(f64::from(i) / 240.0) {
            return Outcome::Discarded(error);
        }
        for row in rows {
            if let Slot::Output(slot) = row.slot
                && !simulation.output(slot).is_finite()
            {
                return Outcome::NotFinite(row.name.clone());
            }
        }
    }
    Outcome::Finite
}

fn run_model(model: Model) -> Outcome {
    let rows = table(&model).unwrap();
    let mut simulation = Simulation::new(Arc::new(model));
    match simulation.initialize(0.0) {
        Ok(()) => run(&mut simulation, &rows),
        Err(error) => Outcome::Discarded(error),
    }
}

/// What is refused must be told at a line, with what is legal; nobody is asked to report it.
fn check_findings(findings: &[Diagnostic], case: &str) {
    let errors: Vec<_> = findings
        .iter()
        .filter(|d| d.severity == Severity::Error)
        .collect();
    assert!(!errors.is_empty(), "{case}: {findings:?}");
    for error in errors {
        let text = format!(
            "{} {}",
            error.message,
            error.help.clone().unwrap_or_default()
        );
        assert!(!text.contains("report"), "{case}: {text}");
    }
}

/// A settings file that says `value` at `key`.
fn settings_with(key: &Key, value: f64) -> String {
    let number = if value.is_nan() {
        "nan".to_owned()
    } else if value.is_infinite() {
        if value > 0.0 {
            "inf".to_owned()
        } else {
            "-inf".to_owned()
        }
    } else {
        format!("{value:?}")
    };
    let value = match key.takes {
        Takes::Numbers(count, ..) => format!("[{}]", vec![number; count].join(", ")),
        Takes::Vectors(count, _) => {
            let vector = format!("[{}]", vec![number; 3].join(", "));
            format!("[{}]", vec![vector; count].join(", "))
        }
        _ => number,
    };
    let path = key.path;
    let name = path.rsplit('.').next().unwrap();
    if path.starts_with("actuator[]") {
        let mode = if name == "no_load_speed" {
            "velocity"
        } else {
            "pd"
        };
        return format!("[[actuator]]\njoint = \"*\"\nmode = \"{mode}\"\n{name} = {value}\n");
    }
    if let Some(key) = path.strip_prefix("world.object[].shape.") {
        return format!(
            "[[world.object]]\nname = \"thing\"\nmass = 1\nxyz = [5, 0]\nshape = {{ {key} = {value} }}\n"
        );
    }
    if path.starts_with("world.object[]") {
        let shape = "shape = { sphere = 0.1 }";
        let mass = if name == "mass" { "" } else { "mass = 1\n" };
        return format!("[[world.object]]\nname = \"thing\"\n{shape}\n{mass}{name} = {value}\n");
    }
    if let Some(key) = path.strip_prefix("loop[].") {
        let (kind, of) = match key {
            "ratio" => (
                "gear",
                "joints = [\"head_joint\", \"left_front_wheel_joint\"]",
            ),
            "factors" => ("coupler", "joints = [\"head_joint\"]"),
            "sum" => ("coupler", "joints = [\"head_joint\"]\nfactors = [1]"),
            "length" => ("distance", "links = [\"head\", \"left_front_wheel\"]"),
            "axes" => ("hinge", "links = [\"head\", \"left_front_wheel\"]"),
            _ => ("weld", "links = [\"head\", \"left_front_wheel\"]"),
        };
        return format!("[[loop]]\ntype = \"{kind}\"\n{of}\n{key} = {value}\n");
    }
    if path.starts_with("spring[]") {
        let stiffness = if name == "stiffness" {
            ""
        } else {
            "stiffness = 100\n"
        };
        return format!(
            "[[spring]]\nlinks = [\"head\", \"left_front_wheel\"]\n{stiffness}{name} = {value}\n"
        );
    }
    if let Some(key) = path.strip_prefix("world.terrain[].") {
        let kind = match key {
            "scale" => "type = \"mesh\"\nfile = \"a.stl\"",
            "size" => "type = \"heightfield\"\ngenerate = \"noise\"",
            _ => "type = \"heightfield\"\ngenerate = \"noise\"\nsize = [2, 2]",
        };
        return format!("[[world.terrain]]\nname = \"a\"\n{kind}\n{key} = {value}\n");
    }
    if path.starts_with("world.robot[]") {
        return format!("[[world.robot]]\nname = \"a\"\nurdf = \"a\"\n{name} = {value}\n");
    }
    if let Some(key) = path.strip_prefix("sensor[].") {
        let (kind, on) = match key.split('.').next().unwrap() {
            "angular_velocity" | "linear_acceleration" => ("imu", "link = \"head\""),
            "force" | "torque" => ("ft", "joint = \"head_joint\""),
            "counts" => ("encoder", "joint = \"head_joint\""),
            "size" => ("contact", "link = \"head\""),
            _ => ("ray", "link = \"head\"\nrays = 3\nrows = 3\nrange = 1e6"),
        };
        let on = match key {
            "range" => on.replace("\nrange = 1e6", ""),
            _ => on.to_owned(),
        };
        let rate = if key == "rate" { "" } else { "rate = 10\n" };
        return format!("[[sensor]]\ntype = \"{kind}\"\n{on}\n{rate}{key} = {value}\n");
    }
    if path.starts_with("joint.*.limits") {
        return format!("[joint.head_joint]\nlimits = {{ {name} = {value} }}\n");
    }
    if let Some(table) = path.strip_suffix(".*") {
        return format!("[{table}]\nhead_joint = {value}\n");
    }
    if path.contains(".*.") {
        let table = path.split('.').next().unwrap();
        return format!("[{table}.\"*\"]\n{name} = {value}\n");
    }
    format!("{path} = {value}\n")
}

/// Extremes, and the ends of what is legal.
fn values(range: Range) -> impl Iterator<Item = f64> {
    let (least, greatest) = range.bounds();
    EXTREMES.into_iter().chain([least, greatest])
}

fn show(failures: &[String]) -> String {
    let mut text = String::new();
    for failure in failures {
        writeln!(text, "{failure}").unwrap();
    }
    text
}

#[test]
fn each_setting_is_refused_or_gives_finite_results() {
    let urdf = rover();
    let mut failures = Vec::new();
    for key in KEYS {
        let Some(range) = key.takes.range() else {
            continue;
        };
        for value in values(range) {
            let case = format!("{} = {value:e}", key.path);
            match robot(&urdf, &settings_with(key, value)) {
                Err(findings) => {
                    check_findings(&findings, &case);
                    if !range.contains(value) {
                        let place = findings.iter().find(|d| d.code == "S104");
                        let place = place.and_then(|d| d.place.as_ref());
                        assert!(place.is_some_and(|p| p.file == "robot.toml"), "{case}");
                    }
                }
                Ok(model) => {
                    assert!(range.contains(value), "{case} is accepted");
                    match run_model(model) {
                        Outcome::Finite => {}
                        // A single try is what was asked for.
                        Outcome::Discarded(SimulationError::Work { .. })
                            if key.path == "solver.max_steps" => {}
                        other => failures.push(format!("{case}: {other:?}")),
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", show(&failures));
}

/// A rover whose joints take every kind of command, with forces from outside.
const COMMANDED: &str = "
[[actuator]]
joint = \"left_front_wheel_joint\"
mode = \"pd\"
kp = 5
kd = 0.5
[[actuator]]
joint = \"head_joint\"
mode = \"position\"
[[actuator]]
joint = \"right_front_wheel_joint\"
mode = \"effort\"
[[external_wrench]]
link = \"base_link\"
";

fn is_load(slot: InputSlot) -> bool {
    use InputSlot as I;
    matches!(
        slot,
        I::Effort(_) | I::ExternalForce(..) | I::ExternalTorque(..)
    )
}

/// Sets a variable before the first step as an importer does; whether it was legal.
fn set(simulation: &mut Simulation, slot: Slot, value: f64) -> bool {
    match slot {
        Slot::Input(slot) if simulation.check_input(slot, value).is_ok() => {
            simulation.set_input(slot, value);
        }
        Slot::Parameter(slot) if simulation.check_parameter(slot, value).is_ok() => {
            simulation.set_parameter(slot, value);
        }
        _ => return false,
    }
    true
}

#[test]
fn each_variable_is_refused_or_gives_finite_results() {
    let model = Arc::new(robot(&rover(), COMMANDED).unwrap());
    let rows = table(&model).unwrap();
    let mut failures = Vec::new();
    for row in &rows {
        for value in EXTREMES {
            let mut simulation = Simulation::new(Arc::clone(&model));
            if !set(&mut simulation, row.slot, value) {
                continue;
            }
            let case = format!("{} = {value:e}", row.name);
            let outcome = match simulation.initialize(0.0) {
                Ok(()) => run(&mut simulation, &rows),
                Err(error) => Outcome::Discarded(error),
            };
            // What a force does, depends on the masses: one that is too great is told at the step.
            let told = matches!(row.slot, Slot::Input(slot) if is_load(slot))
                && matches!(outcome, Outcome::Discarded(_));
            if outcome != Outcome::Finite && !told {
                failures.push(format!("{case}: {outcome:?}"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", show(&failures));
}

#[test]
fn pairs_of_variables_give_finite_results_or_are_told() {
    let model = Arc::new(robot(&rover(), COMMANDED).unwrap());
    let rows = table(&model).unwrap();
    let settable: Vec<_> = rows
        .iter()
        .filter(|row| !matches!(row.slot, Slot::Output(_)))
        .collect();
    let seed = 11;
    let mut random = Random(seed);
    let mut pick = |n: usize| {
        let place = random.uniform(0.0, 1.0) * f64::from(u32::try_from(n).unwrap());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small"
        )]
        let place = place as usize;
        place.min(n - 1)
    };
    for _ in 0..600 {
        let mut simulation = Simulation::new(Arc::clone(&model));
        // A slow pair is discarded soon.
        let mut case = format!("seed {seed}:");
        for _ in 0..2 {
            let row = settable[pick(settable.len())];
            let value = EXTREMES[pick(EXTREMES.len())];
            if set(&mut simulation, row.slot, value) {
                write!(case, " {} = {value:e}", row.name).unwrap();
            }
        }
        if simulation.initialize(0.0).is_ok() {
            let outcome = run(&mut simulation, &rows);
            assert!(
                !matches!(outcome, Outcome::NotFinite(_)),
                "{case}: {outcome:?}"
            );
        }
    }
}

/// Where the numbers of the text's attributes stand.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut list = Vec::new();
    let mut rest = 0;
    while let Some(begin) = text[rest..].find('"').map(|i| rest + i + 1) {
        let end = begin + text[begin..].find('"').unwrap();
        let mut at = begin;
        for word in text[begin..end].split(' ') {
            if word.parse::<f64>().is_ok() {
                list.push(at..at + word.len());
            }
            at += word.len() + 1;
        }
        rest = end + 1;
    }
    list
}

#[test]
fn each_number_of_a_urdf_is_refused_or_gives_finite_results() {
    let text = rover();
    let mut failures = Vec::new();
    for place in numbers(&text) {
        if text[..place.start].ends_with("version=\"") {
            continue;
        }
        for value in EXTREMES {
            let urdf = format!("{}{value:e}{}", &text[..place.start], &text[place.end..]);
            let line = text[..place.start].matches('\n').count() + 1;
            let case = format!(
                "line {line}, {} = {value:e}",
                &text[place.start - 12..place.end]
            );
            match robot(&urdf, "") {
                Err(findings) => check_findings(&findings, &case),
                Ok(model) => match run_model(model) {
                    Outcome::Finite => {}
                    other => failures.push(format!("{case}: {other:?}")),
                },
            }
        }
    }
    assert!(failures.is_empty(), "{}", show(&failures));
}
