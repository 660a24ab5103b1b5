//! Time of the tree algorithms, and of a step of long chains.
//!
//! `cargo bench -p urdf2fmu-core --bench dynamics -- robot.urdf… --fixed robot.urdf…` answers with
//! one line of JSON a robot: nanoseconds of the articulated-body algorithm, of the
//! composite-rigid-body algorithm and of the recursive Newton–Euler algorithm (`k(q, v)`),
//! kinematics included each time, as they are in Pinocchio's functions of these names. Without a
//! robot it prints a Markdown table of chains of 10 to 500 links that swing freely: time per
//! accepted step. `benches/peers/pinocchio_compare.py` runs it beside Pinocchio.

#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the table goes to standard output, findings to standard error"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

#[path = "support/clock.rs"]
mod clock;
#[path = "../src/testing/random.rs"]
mod random;

use random::Random;
use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::dynamics::{aba::Articulated, crba, rnea};
use urdf2fmu_core::kinematics::{Kinematics, advance};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::parameters::Parameters;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::state::State;
use urdf2fmu_core::tree::Tree;
use urdf2fmu_core::{assemble, urdf};

/// States that are visited in turn, so that no branch is learnt by heart.
const STATES: usize = 64;
/// Calls per measurement, and measurements, of which the fastest counts.
const CALLS: usize = 512;
const ROUNDS: usize = 200;

/// Uniform in `[-1, 1)`.
fn vector(random: &mut Random, n: usize) -> Vec<f64> {
    (0..n).map(|_| random.uniform(-1.0, 1.0)).collect()
}

/// Nanoseconds per call, the least of some measurements.
fn time(mut call: impl FnMut(usize)) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = clock::now();
        for i in 0..CALLS {
            call(i % STATES);
        }
        best = best.min(clock::now() - start);
    }
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let calls = CALLS as f64;
    best / calls * 1e9
}

/// Nanoseconds of the three algorithms.
fn algorithms(model: &Model) -> [f64; 3] {
    let tree = Tree::new(model, &Parameters::new(model));
    let mut random = Random(1);
    let zero = State::new(model).physical.q;
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for _ in 0..STATES {
        let mut turned = zero.clone();
        advance(
            &tree,
            &zero,
            &vector(&mut random, model.nv()),
            1.0,
            &mut turned,
        );
        q.push(turned);
        v.push(vector(&mut random, model.nv()));
    }
    let tau = vector(&mut random, model.nv());
    let mut vdot = vec![0.0; model.nv()];
    let mut kin = Kinematics::new(&tree);
    let mut articulated = Articulated::new(&tree);
    let aba = if tree.pure {
        time(|i| {
            kin.update_poses(&tree, &q[i]);
            kin.update_velocities(&tree, &v[i]);
            articulated.accelerations(&tree, &kin, &v[i], &tau, (&[], 0.0), &mut vdot);
            black_box(&vdot);
        })
    } else {
        f64::NAN
    };
    let crba = time(|i| {
        kin.update_poses(&tree, &q[i]);
        crba::mass_matrix(&tree, &mut kin);
        black_box(&kin.M);
    });
    let rnea = time(|i| {
        kin.update_poses(&tree, &q[i]);
        kin.update_velocities(&tree, &v[i]);
        rnea::bias(&tree, &mut kin, &v[i], &[], 0.0);
        black_box(&kin.bias);
    });
    [aba, crba, rnea]
}

fn read(path: &Path, settings: &str) -> Result<Model, Vec<urdf2fmu_core::diagnostic::Diagnostic>> {
    let settings = Settings::parse(settings, "dynamics.toml")?;
    let options = assemble::read_options(&settings, urdf::ReadOptions::from_environment());
    Ok(assemble::build(&urdf::read(path, &options)?, &settings)?.model)
}

/// A chain of rods of 0.1 m, hanging from the world, whose axes alternate between x and y.
fn chain(links: usize) -> Model {
    let mut text = String::from("<robot name=\"chain\"><link name=\"world\"/>");
    for i in 0..links {
        let (parent, axis) = (
            i.checked_sub(1).map_or("world".into(), |p| format!("l{p}")),
            if i % 2 == 0 { "1 0 0" } else { "0 1 0" },
        );
        let drop = if i == 0 { 0.0 } else { -0.1 };
        write!(
            text,
            r#"<link name="l{i}"><inertial><origin xyz="0 0 -0.05"/><mass value="0.1"/>
            <inertia ixx="8.4e-5" iyy="8.4e-5" izz="2e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
            <joint name="j{i}" type="continuous"><parent link="{parent}"/><child link="l{i}"/>
            <origin xyz="0 0 {drop}"/><axis xyz="{axis}"/></joint>"#
        )
        .expect("text grows");
    }
    text.push_str("</robot>");
    let settings = Settings::parse(
        "[world]\nground = { type = \"none\" }\n[[actuator]]\njoint = \"*\"\nmode = \"none\"\n[initial]\njoints = { \"j0\" = 0.5, \"j1\" = 0.5 }",
        "chain.toml",
    )
    .expect("settings");
    let options = assemble::read_options(&settings, urdf::ReadOptions::default());
    let description =
        urdf::read_str(&text, "chain.urdf", Path::new("."), &options).expect("a chain");
    assemble::build(&description, &settings)
        .expect("a chain")
        .model
}

fn chains() {
    println!("| links | steps in 0.2 s | µs per step | µs per step and link |");
    println!("|---|---|---|---|");
    for links in [10_u32, 20, 50, 100, 200, 500] {
        let mut simulation = Simulation::new(Arc::new(chain(links as usize)));
        let (mut best, mut steps) = (f64::INFINITY, 0.0);
        for _ in 0..20 {
            simulation.reset();
            simulation.set_parameter(ParameterSlot::Tolerance, 1e-4);
            simulation
                .initialize(0.0)
                .and_then(|()| {
                    let start = clock::now();
                    simulation.advance_to(0.2)?;
                    best = best.min(clock::now() - start);
                    Ok(())
                })
                .expect("a chain swings");
            steps = simulation.output(OutputSlot::Steps) + simulation.output(OutputSlot::Rejected);
        }
        let each = best / steps * 1e6;
        println!(
            "| {links} | {steps} | {each:.1} | {:.3} |",
            each / f64::from(links)
        );
    }
}

fn main() {
    let files: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    if files.is_empty() {
        chains();
    }
    let mut settings = "";
    for file in files {
        if file == "--fixed" {
            settings = "[robot]\nbase = \"fixed\"";
            continue;
        }
        match read(Path::new(&file), settings) {
            Ok(model) => {
                let [aba, crba, rnea] = algorithms(&model);
                println!(
                    "{{\"nv\": {}, \"aba\": {aba}, \"crba\": {crba}, \"rnea\": {rnea}}}",
                    model.nv()
                );
            }
            Err(findings) => eprintln!("{file}: {}", findings[0].message),
        }
    }
}
