//! Time of robots on terrain beside that on the plane, and of a look at large terrain.
//!
//! `cargo bench -p urdf2fmu-core --bench terrain -- [WORD]` prints Markdown tables, of the lines
//! that contain the word: microseconds of CPU time
//! a second of simulation under commands that change at 240 Hz, the fastest of some rounds, and
//! how many times that of the plane; then microseconds of one look by a box at fields of up to
//! 1000 x 1000 cells and meshes of up to 500,000 triangles, and of 360 rays among 100 shapes and a
//! mesh.

#![expect(clippy::print_stdout, reason = "the tables go to standard output")]
#![allow(clippy::cast_precision_loss, reason = "small counts")]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "support/clock.rs"]
mod clock;
#[path = "support/ground.rs"]
mod ground;

use ground::triangles;
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::assemble;
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::pair::{Patch, Solid};
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, Model};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_core::urdf;

const ROUNDS: usize = 5;
/// Communication steps a second.
const RATE: u32 = 240;

fn heights(extent: f64, cells: usize, height: impl Fn(f64, f64) -> f64) -> Shape {
    let place = |i: usize| (i as f64 / cells as f64 - 0.5) * extent;
    let rows = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
    let samples = Samples {
        size: [extent; 2],
        counts: [cells + 1; 2],
        heights: rows.map(|(i, j)| height(place(i), place(j))).collect(),
    };
    let field = Arc::new(Field::try_from(samples).expect("a grid"));
    Shape::Field { field }
}

fn hills(x: f64, y: f64) -> f64 {
    0.03 * (libm::sin(3.0 * x) * libm::cos(2.0 * y) - 1.0)
}

/// A robot of the examples on terrain; without terrain on the plane.
fn model(robot: &str, more: &str, terrain: Option<&Shape>) -> Model {
    let ground = if terrain.is_some() { "none" } else { "plane" };
    let text = format!("world.ground.type = \"{ground}\"\n{more}");
    let settings = Settings::parse(&text, "terrain.toml").expect("legal settings");
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(robot);
    let options = assemble::read_options(&settings, urdf::ReadOptions::from_environment());
    let robot = urdf::read(&file, &options).expect("an example");
    let guest = |shape| ground::still("terrain", shape, [Vec3::zeros(); 2], &settings);
    let guests: Vec<_> = terrain.map(guest).into_iter().collect();
    let world = assemble::world(&robot, &settings, &guests).expect("a world");
    world.model
}

/// Steps and microseconds of CPU time a second of simulation, one second after the start.
fn drive(model: &Model, tolerance: f64, command: &impl Fn(usize, f64) -> f64) -> (u64, f64) {
    let mut best = (0, f64::INFINITY);
    for _ in 0..ROUNDS {
        let mut s = Simulation::new(Arc::new(model.clone()));
        s.set_importer_tolerance(tolerance);
        s.initialize(0.0).expect("a sound model");
        let mut run = |from: u32, to: u32| {
            for k in from..to {
                let t = f64::from(k) / f64::from(RATE);
                for (i, actuator) in model.actuators.iter().enumerate() {
                    let id = ActuatorId::from(i);
                    let slot = match actuator.mode {
                        ActuatorMode::Velocity => InputSlot::Velocity(id),
                        _ => InputSlot::Position(id),
                    };
                    s.set_input(slot, command(i, t));
                }
                s.advance_to(f64::from(k + 1) / f64::from(RATE))
                    .expect("a step");
            }
            s.state().stepping.counters.steps
        };
        let before = run(0, RATE);
        let start = clock::now();
        let after = run(RATE, 3 * RATE);
        let us = (clock::now() - start) * 0.5e6;
        if us < best.1 {
            best = ((after - before) / 2, us);
        }
    }
    best
}

/// The grounds to compare: even ones, and hills.
fn grounds() -> Vec<(&'static str, Option<Shape>)> {
    vec![
        ("plane", None),
        ("plane as terrain", Some(Shape::Plane)),
        (
            "even heights, 200 × 200",
            Some(heights(20.0, 200, |_, _| 0.0)),
        ),
        (
            "even mesh, 20,000 triangles",
            Some(triangles(20.0, 100, |_, _| 0.0)),
        ),
        (
            "hills as heights, 200 × 200",
            Some(heights(20.0, 200, hills)),
        ),
        (
            "hills as mesh, 20,000 triangles",
            Some(triangles(20.0, 100, hills)),
        ),
    ]
}

fn robots(tolerance: f64, word: &str) {
    println!("| tolerance {tolerance:e} | steps | µs | times the plane | µs a step, times |");
    println!("|---|---|---|---|---|");
    let rover = |i: usize, t: f64| 6.0 + 2.0 * libm::sin(5.0 * t + i as f64);
    let legs =
        |i: usize, t: f64| [0.0, 0.8, -1.6][i % 3] + 0.1 * libm::sin(5.0 * t + (i / 3) as f64);
    let pose = "initial.xyz = [0.31, 0.22, 0.45]\n\
        initial.joints = { \"*_thigh_joint\" = 0.8, \"*_calf_joint\" = -1.6 }\n\
        [[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 120\nkd = 3";
    let start = "initial.xyz = [0.31, 0.22, 0.12]";
    for (robot, more, command) in [
        ("rover.urdf", start, &rover as &dyn Fn(usize, f64) -> f64),
        ("quadruped.urdf", pose, &legs),
    ] {
        let mut plane = (0, f64::NAN);
        for (name, terrain) in grounds() {
            if !format!("{robot}, {name}").contains(word) {
                continue;
            }
            let (steps, us) = drive(&model(robot, more, terrain.as_ref()), tolerance, &command);
            if terrain.is_none() {
                plane = (steps, us);
            }
            let each = us / steps as f64 / (plane.1 / plane.0 as f64);
            println!(
                "| {robot}, {name} | {steps} | {us:.0} | {:.2} | {each:.2} |",
                us / plane.1
            );
        }
    }
}

/// Nanoseconds of one look by a box of 20 cm at different heights over terrain.
fn look(shape: &Shape, height: f64) -> f64 {
    const CALLS: u32 = 2000;
    let (thing, ground) = (
        Shape::Box {
            half: Vec3::repeat(0.1),
        },
        shape,
    );
    let [a, b] = [&thing, ground].map(|s| Solid::new(s, 0.0));
    let mut patch = Patch::new();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = clock::now();
        for k in 0..CALLS {
            let p = Vec3::new(0.004 * f64::from(k), 1.0 - 0.003 * f64::from(k), height);
            let pose = Pose {
                p,
                ..Pose::IDENTITY
            };
            black_box(patch.find((&a, &pose), (&b, &Pose::IDENTITY), 0.0));
        }
        best = best.min((clock::now() - start) / f64::from(CALLS));
    }
    best * 1e9
}

fn looks(word: &str) {
    println!("\n| terrain | ns a look far above | near above | on it |");
    println!("|---|---|---|---|");
    for (name, shape) in [
        ("heights, 100 × 100", heights(20.0, 100, hills)),
        ("heights, 1000 × 1000", heights(20.0, 1000, hills)),
        ("mesh, 20,000 triangles", triangles(20.0, 100, hills)),
        ("mesh, 500,000 triangles", triangles(20.0, 500, hills)),
    ] {
        if !name.contains(word) {
            continue;
        }
        let [far, near, on] = [3.0, 0.2, 0.08].map(|height| look(&shape, height));
        println!("| {name} | {far:.0} | {near:.0} | {on:.0} |");
    }
}

fn main() {
    let word = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let word = word.unwrap_or_default();
    for tolerance in [1e-3, 1e-4] {
        robots(tolerance, &word);
    }
    looks(&word);
}
