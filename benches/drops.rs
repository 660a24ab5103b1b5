//! Random drops: robots dropped onto the ground in every attitude, limp or driven, and again with
//! one property at an extreme value.
//!
//! `cargo bench -p urdf2fmu-core --bench drops -- [drops] [drops per extreme] robot.urdf…` prints
//! the two tables of `docs/robustness.md`, and lists the worst drops. A robot whose meshes lie
//! elsewhere needs `ROS_PACKAGE_PATH`; with `--self-collision` its links touch each other. Every
//! second seed is limp, and seeds 6 and 7 of every eight take fixed steps: of eight drops three are
//! limp under error control and one in fixed steps.
//! `tests/acceptance/campaign.rs` defines a drop.

#[path = "../tests/acceptance/campaign.rs"]
#[allow(missing_docs, dead_code, reason = "shared with the tests")]
mod campaign;
#[path = "../src/testing/random.rs"]
mod random;

use campaign::{Extreme, Tally, Worst, drop_once};
use std::path::Path;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::{assemble, urdf};

/// Reads a robot with default settings, but for whether its links touch each other.
fn robot(file: &str, self_collision: bool) -> Result<Model, String> {
    let settings = Settings {
        self_collision,
        ..Settings::default()
    };
    let options = assemble::read_options(&settings, urdf::ReadOptions::from_environment());
    let first = |findings: Vec<urdf2fmu_core::diagnostic::Diagnostic>| findings[0].message.clone();
    let description = urdf::read(Path::new(file), &options).map_err(first)?;
    Ok(assemble::build(&description, &settings)
        .map_err(first)?
        .model)
}

/// Lets the links of each robot touch each other.
const SELF_COLLISION: &str = "--self-collision";

/// Most energy gained by limp robots under error control and in fixed steps: in all, over the
/// lowest before, and that with all that friction elements have in store; see `Ledger`.
fn gains(tally: &Tally) -> String {
    let [controlled, fixed] = &tally.limp;
    let pairs = [
        (&controlled.gained, &fixed.gained),
        (&controlled.risen, &fixed.risen),
        (&controlled.raw, &fixed.raw),
    ];
    let drops = format!("{}, {}", controlled.drops, fixed.drops);
    let cells = pairs.map(|(a, b)| format!("{:.1e}, {:.1e}", a.share, b.share));
    format!("{drops} | {}", cells.join(" | "))
}

/// Heads of the columns of [`gains`].
const GAINS: &str = "limp: error control, fixed steps | energy gained in all | most over the lowest before | \
                     with all that friction has in store";

#[expect(clippy::print_stdout, reason = "the tables are the result")]
#[expect(clippy::cast_precision_loss, reason = "counts")]
fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let mut counts = arguments.iter().filter_map(|a| a.parse::<u64>().ok());
    let (count, each) = (counts.next().unwrap_or(20), counts.next().unwrap_or(4));
    let touching = arguments.iter().any(|a| a == SELF_COLLISION);
    let (mut robots, mut notes) = (Vec::new(), Vec::new());
    println!(
        "| robot | degrees of freedom | drops | failed | {GAINS} | share of steps at the floor | µs per 1/240 s, mean | \
         slowest drop |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let files = arguments.iter().filter(|a| a.parse::<u64>().is_err());
    for file in files.filter(|a| *a != SELF_COLLISION) {
        let model = match robot(file, touching) {
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
        let name = Path::new(file).file_stem().unwrap_or_default();
        println!(
            "| {} | {} | {} | {} | {} | {:.1e} | {:.0} | {:.0} |",
            name.to_string_lossy(),
            model.nv(),
            tally.drops,
            tally.failed,
            gains(&tally),
            tally.steps[1] as f64 / tally.steps[0].max(1) as f64,
            tally.seconds[0] / count as f64 / 300.0 * 1e6,
            tally.seconds[1] / 300.0 * 1e6,
        );
        note(&mut notes, Extreme::None, tally);
        robots.push(model);
    }
    println!(
        "\n| extreme | drops | failed | {GAINS} | share of steps at the floor | slowest drop, s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for extreme in Extreme::ALL {
        let mut tally = Tally::default();
        for model in &robots {
            for seed in 0..each {
                drop_once(model, extreme, seed, &mut tally);
            }
        }
        println!(
            "| {} | {} | {} | {} | {:.1e} | {:.1} |",
            extreme.name(),
            tally.drops,
            tally.failed,
            gains(&tally),
            tally.steps[1] as f64 / tally.steps[0].max(1) as f64,
            tally.seconds[1],
        );
        note(&mut notes, extreme, tally);
    }
    for note in notes {
        println!("\n{note}");
    }
}

/// Which drops failed, and which gained most.
fn note(notes: &mut Vec<String>, extreme: Extreme, tally: Tally) {
    let name = extreme.name();
    for (robot, seed) in tally.failures {
        notes.push(format!("failed: {robot}, {name}, seed {seed}"));
    }
    for (steps, gain) in ["error control", "fixed steps"].iter().zip(tally.limp) {
        let worst = [
            ("gained in all", gain.gained),
            ("over the lowest before", gain.risen),
            ("with all in store", gain.raw),
        ];
        for (what, Worst { share, drop }) in worst {
            if let Some((robot, seed)) = drop {
                notes.push(format!(
                    "{what}: {share:.1e}, {robot}, {name}, {steps}, seed {seed}"
                ));
            }
        }
    }
}
