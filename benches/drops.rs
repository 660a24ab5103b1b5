//! Random drops: robots thrown onto the ground in every attitude, limp or driven, and again with something about them
//! driven to an extreme.
//!
//! `cargo bench --bench drops -- [drops] [drops per extreme] robot.urdf…` prints the two tables of `docs/robustness.md`;
//! a robot whose meshes lie elsewhere needs `ROS_PACKAGE_PATH`. What a drop is: `tests/acceptance/campaign.rs`.

#[path = "../tests/acceptance/campaign.rs"]
#[allow(missing_docs, dead_code, reason = "shared with the tests")]
mod campaign;
#[path = "../src/testing/random.rs"]
mod random;

use campaign::{Extreme, Tally, drop_once};
use std::path::Path;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::{assemble, urdf};

/// Reads a robot with default settings.
fn robot(file: &str) -> Result<Model, String> {
    let settings = Settings::default();
    let options = settings.read_options(urdf::ReadOptions::from_environment());
    let first = |findings: Vec<urdf::Diagnostic>| findings[0].message.clone();
    let description = urdf::read(Path::new(file), &options).map_err(first)?;
    Ok(assemble::build(&description, &settings)
        .map_err(first)?
        .model)
}

#[expect(clippy::print_stdout, reason = "the tables are the result")]
#[expect(clippy::cast_precision_loss, reason = "counts")]
fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let mut counts = arguments.iter().filter_map(|a| a.parse::<u64>().ok());
    let (count, each) = (counts.next().unwrap_or(20), counts.next().unwrap_or(4));
    let (mut robots, mut failures, mut worst) = (Vec::new(), Vec::new(), Vec::new());
    println!(
        "| robot | degrees of freedom | drops | failed | energy gained, limp: error control | fixed steps | share of \
         steps at the floor | µs per 1/240 s, mean | slowest drop |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for file in arguments.iter().filter(|a| a.parse::<u64>().is_err()) {
        let model = match robot(file) {
            Ok(model) => model,
            Err(message) => {
                println!("| {file} | refused: {message} |");
                continue;
            }
        };
        let mut tally = Tally::default();
        for seed in 0..count {
            drop_once(&model, Extreme::None, seed, &mut tally);
        }
        worst.extend(tally.worst.clone().map(|w| (Extreme::None, w)));
        failures.extend(tally.failures.drain(..).map(|f| (Extreme::None, f)));
        let name = Path::new(file).file_stem().unwrap_or_default();
        println!(
            "| {} | {} | {} | {} | {:.1e} | {:.1e} | {:.1e} | {:.0} | {:.0} |",
            name.to_string_lossy(),
            model.nv(),
            tally.drops,
            tally.failed,
            tally.gained[0],
            tally.gained[1],
            tally.steps[1] as f64 / tally.steps[0].max(1) as f64,
            tally.seconds[0] / count as f64 / 300.0 * 1e6,
            tally.seconds[1] / 300.0 * 1e6,
        );
        robots.push(model);
    }
    println!(
        "\n| extreme | drops | failed | energy gained, limp: error control | fixed steps | share of steps at the floor \
         | slowest drop, s |"
    );
    println!("|---|---|---|---|---|---|---|");
    for extreme in Extreme::ALL {
        let mut tally = Tally::default();
        for model in &robots {
            for seed in 0..each {
                drop_once(model, extreme, seed, &mut tally);
            }
        }
        println!(
            "| {} | {} | {} | {:.1e} | {:.1e} | {:.1e} | {:.1} |",
            extreme.name(),
            tally.drops,
            tally.failed,
            tally.gained[0],
            tally.gained[1],
            tally.steps[1] as f64 / tally.steps[0].max(1) as f64,
            tally.seconds[1],
        );
        worst.extend(tally.worst.map(|w| (extreme, w)));
        failures.extend(tally.failures.into_iter().map(|f| (extreme, f)));
    }
    for (extreme, (robot, seed)) in failures {
        println!("\nfailed: {robot}, {}, seed {seed}", extreme.name());
    }
    for (extreme, worst) in worst {
        if let Some((robot, seed)) = worst {
            println!(
                "\nmost energy gained: {robot}, {}, seed {seed}",
                extreme.name()
            );
        }
    }
}
