//! Time of a lidar's rays in a world of shapes.
//!
//! `cargo bench -p urdf2fmu-core --bench lidar` prints a Markdown table: microseconds of all rays
//! of one read-out, poses included, the fastest of some rounds. A fifth of the shapes are balls,
//! capsules, cylinders, boxes and hulls of 32 corners each, 0.1 m to 0.6 m large, within 10 m. The
//! last lines are with hills of 100,352 triangles, which two thirds of the rays meet.
//!
//! With `-- --dump=FILE` it writes the world of 100 shapes with the rays and what they measure, as
//! JSON: `benches/peers/lidar.py` compares other programs with it.

#![expect(clippy::print_stdout, reason = "the table goes to standard output")]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "support/clock.rs"]
mod clock;
#[path = "support/ground.rs"]
mod ground;
#[path = "../src/testing/random.rs"]
mod random;

use random::Random;
use std::fmt::Write as _;
use std::hint::black_box;
use std::sync::Arc;
use urdf2fmu_core::assemble;
use urdf2fmu_core::geometry::{Shape, bounded_hull};
use urdf2fmu_core::model::{Model, SensorId, SensorKind};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{OutputSlot, Sensed, Simulation};
use urdf2fmu_core::spatial::{Pose, Vec3};

const ROUNDS: usize = 200;

/// A shape and where it is.
struct Placed {
    shape: Shape,
    xyz: Vec3,
    rpy: Vec3,
}

fn shapes(count: usize) -> Vec<Placed> {
    let random = &mut Random(1);
    let mut all = Vec::new();
    for i in 0..count {
        let mut size = || random.uniform(0.1, 0.3);
        let (radius, half_length) = (size(), size());
        let half = Vec3::new(size(), size(), size());
        let shape = match i % 5 {
            0 => Shape::Sphere { radius },
            1 => Shape::Capsule {
                radius,
                half_length,
            },
            2 => Shape::Cylinder {
                radius,
                half_length,
            },
            3 => Shape::Box { half },
            _ => {
                let mut point = || Vec3::from_fn(|_, _| random.uniform(-1.0, 1.0));
                let points: Vec<Vec3> = (0..400).map(|_| point().normalize() * radius).collect();
                let vertices = bounded_hull(&points, 32).expect("a hull").vertices;
                Shape::Hull { vertices }
            }
        };
        let (angle, far) = (
            random.uniform(0.0, std::f64::consts::TAU),
            random.uniform(1.0, 10.0),
        );
        let height = random.uniform(0.3, 1.3);
        let mut turn = || random.uniform(-3.0, 3.0);
        all.push(Placed {
            shape,
            xyz: Vec3::new(far * libm::cos(angle), far * libm::sin(angle), height),
            rpy: Vec3::new(turn(), turn(), turn()),
        });
    }
    all
}

/// A lidar at 0.8 m height among static shapes.
fn world(shapes: &[Placed], [columns, rows]: [u32; 2]) -> Model {
    let more = match rows {
        1 => String::new(),
        _ => format!("rows = {rows}\nvertical_fov = 0.5\n"),
    };
    let text = format!(
        "robot.base = \"fixed\"\ninitial.xyz = [0, 0, 0.8]\n[[sensor]]\ntype = \"ray\"\nlink = \"eye\"\n\
         rays = {columns}\nfov = 6.28\nrange = 20\n{more}"
    );
    let settings = Settings::parse(&text, "lidar.toml").expect("legal settings");
    let eye = assemble::solid("eye", &Shape::Sphere { radius: 0.05 }, 1.0);
    let guest = |(i, placed): (usize, &Placed)| {
        let Placed { shape, xyz, rpy } = placed;
        ground::still(&format!("s{i}"), shape, [*xyz, *rpy], &settings)
    };
    let guests: Vec<_> = shapes.iter().enumerate().map(guest).collect();
    let assembled = assemble::world(&eye, &settings, &guests);
    assembled.expect("a world").model
}

/// Hills of 2 m that rise from the lidar on, over 20 m.
fn hills() -> Placed {
    let height = |x: f64, y: f64| {
        let rise = 1.0 - libm::cos(0.3 * libm::hypot(x, y));
        rise * (0.7 + 0.3 * libm::sin(2.0 * x) * libm::cos(3.0 * y))
    };
    Placed {
        shape: ground::triangles(20.0, 224, height),
        xyz: Vec3::zeros(),
        rpy: Vec3::zeros(),
    }
}

fn rays(model: &Model) -> &[Vec3] {
    match &model.outputs.sensors[0].kind {
        SensorKind::Ray { directions, .. } => directions,
        _ => &[],
    }
}

fn read(simulation: &mut Simulation, rays: usize) -> Vec<f64> {
    (0..)
        .take(rays)
        .map(|ray| simulation.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(ray))))
        .collect()
}

/// Microseconds of a read-out of all rays.
fn time(model: &Model) -> f64 {
    let rays = rays(model).len();
    let mut simulation = Simulation::new(Arc::new(model.clone()));
    simulation.initialize(0.0).expect("a sound model");
    let snapshot = simulation.save();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        // Forgets what has been read.
        simulation.restore(&snapshot).expect("its own state");
        let start = clock::now();
        for ray in (0..).take(rays) {
            black_box(simulation.output(OutputSlot::Sensor(SensorId(0), Sensed::Distance(ray))));
        }
        best = best.min(clock::now() - start);
    }
    best * 1e6
}

fn numbers<'a>(list: impl IntoIterator<Item = &'a f64>) -> String {
    let list: Vec<String> = list.into_iter().map(|x| format!("{x:?}")).collect();
    format!("[{}]", list.join(", "))
}

/// The world, its rays and what they measure, as JSON.
fn dump(shapes: &[Placed], model: &Model) -> String {
    let mut text = String::from("{\"origin\": [0, 0, 0.8], \"range\": 20, \"shapes\": [\n");
    for (i, Placed { shape, xyz, rpy }) in shapes.iter().enumerate() {
        let (kind, size) = match shape {
            Shape::Sphere { radius } => ("sphere", vec![*radius]),
            Shape::Capsule {
                radius,
                half_length,
            } => ("capsule", vec![*radius, *half_length]),
            Shape::Cylinder {
                radius,
                half_length,
            } => ("cylinder", vec![*radius, *half_length]),
            Shape::Box { half } => ("box", half.iter().copied().collect()),
            Shape::Hull { vertices } => ("hull", vertices.iter().flatten().copied().collect()),
            _ => continue,
        };
        let R = Pose::from_xyz_rpy(Vec3::zeros(), *rpy).R;
        let q = urdf2fmu_core::spatial::quaternion_from_rotation(&R);
        _ = writeln!(
            text,
            "{}{{\"kind\": \"{kind}\", \"size\": {}, \"xyz\": {}, \"wxyz\": {}}}",
            if i == 0 { "" } else { "," },
            numbers(&size),
            numbers(xyz.iter()),
            numbers(&[q.w, q.i, q.j, q.k]),
        );
    }
    let mut simulation = Simulation::new(Arc::new(model.clone()));
    simulation.initialize(0.0).expect("a sound model");
    let rays = rays(model);
    let found = read(&mut simulation, rays.len());
    _ = write!(
        text,
        "], \"microseconds\": {:?}, \"rays\": {}, \"distances\": {}}}",
        time(model),
        numbers(rays.iter().flatten()),
        numbers(&found),
    );
    text
}

fn main() {
    let dumped = std::env::args().find_map(|a| a.strip_prefix("--dump=").map(str::to_owned));
    if let Some(path) = dumped {
        let shapes = shapes(100);
        let model = world(&shapes, [360, 1]);
        std::fs::write(&path, dump(&shapes, &model)).expect("a file to write");
        return;
    }
    println!("| shapes | rays | µs | ns a ray |");
    println!("|---|---|---|---|");
    let line = |name: &str, shapes: &[Placed]| {
        for [columns, rows] in [[360, 1], [360, 16]] {
            let us = time(&world(shapes, [columns, rows]));
            let each = us * 1e3 / f64::from(columns * rows);
            println!("| {name} | {columns} × {rows} | {us:.1} | {each:.0} |");
        }
    };
    for count in [10, 100, 1000] {
        line(&count.to_string(), &shapes(count));
    }
    let mut all = shapes(100);
    all.push(hills());
    line("100 and hills", &all);
}
