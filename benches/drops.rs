//! Random drops: robots thrown onto the ground in every attitude, limp or with their motors on.
//!
//! `cargo bench --bench drops -- [count] robot.urdf…` prints a Markdown table, a row a robot: failed steps, the largest
//! energy that a limp robot gained from one communication step to the next (relative to what it fell with),
//! steps accepted at the floor, time per communication step of 1/240 s. Two seconds each; every second drop is limp
//! and every fourth takes fixed steps.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use urdf2fmu_core::model::{ActuatorId, JointId, Model};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::{assemble, urdf};

const H: f64 = 1.0 / 240.0;
const STEPS: u32 = 480;

/// `SplitMix64`, so that a seed means the same everywhere.
struct Random(u64);

impl Random {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (z >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * share
    }
}

/// What came of the drops of a robot.
#[derive(Default)]
struct Tally {
    failed: u32,
    gained: f64,
    floor: u64,
    slowest: f64,
    seconds: f64,
}

#[expect(clippy::print_stdout, reason = "the table is the result")]
fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let count: u64 = arguments.first().and_then(|a| a.parse().ok()).unwrap_or(20);
    println!(
        "| robot | degrees of freedom | drops | failed | energy gained, limp | steps at the floor | µs per 1/240 s, mean | slowest drop |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for file in arguments.iter().filter(|a| a.parse::<u64>().is_err()) {
        let settings = Settings::default();
        let options = settings.read_options(urdf::ReadOptions::from_environment());
        let description = match urdf::read(Path::new(file), &options) {
            Ok(description) => description,
            Err(findings) => {
                println!("| {file} | refused: {} |", findings[0].message);
                continue;
            }
        };
        let model = match assemble::build(&description, &settings) {
            Ok(assembled) => Arc::new(assembled.model),
            Err(findings) => {
                println!("| {file} | refused: {} |", findings[0].message);
                continue;
            }
        };
        let mut tally = Tally::default();
        for seed in 0..count {
            drop_once(&model, seed, &mut tally);
        }
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let mean = tally.seconds / count as f64 / f64::from(STEPS) * 1e6;
        println!(
            "| {} | {} | {count} | {} | {:.1e} | {} | {mean:.0} | {:.0} |",
            Path::new(file)
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy(),
            model.nv(),
            tally.failed,
            tally.gained,
            tally.floor,
            tally.slowest * 1e6 / f64::from(STEPS),
        );
    }
}

/// Throws the robot once and adds to the tally.
fn drop_once(model: &Arc<Model>, seed: u64, tally: &mut Tally) {
    let mut random = Random(seed);
    let limp = seed.is_multiple_of(2);
    let mut s = Simulation::new(Arc::clone(model));
    let base = model.bodies[0].motion == urdf2fmu_core::model::Motion::Free;
    for axis in 0..3 {
        s.set_parameter(
            ParameterSlot::InitialBaseRpy(axis),
            random.uniform(-3.0, 3.0),
        );
        if base {
            let spin = random.uniform(-3.0, 3.0);
            s.set_parameter(ParameterSlot::InitialBaseAngularVelocity(axis), spin);
            let speed = random.uniform(-1.0, 1.0);
            s.set_parameter(ParameterSlot::InitialBaseLinearVelocity(axis), speed);
        }
    }
    for (id, joint) in (0..).map(JointId).zip(&model.joints) {
        if let Some(limits) = joint.limits {
            let (low, high) = (limits.lower.max(-3.0), limits.upper.min(3.0));
            if low <= high {
                s.set_parameter(
                    ParameterSlot::InitialJointPosition(id),
                    random.uniform(low, high),
                );
            }
        }
    }
    s.set_parameter(
        ParameterSlot::InitialBasePosition(2),
        s.tree().reach + random.uniform(0.2, 1.0),
    );
    if seed % 4 == 3 {
        s.set_parameter(ParameterSlot::StepSize, H);
    }
    if limp {
        for a in 0..model.actuators.len() {
            s.set_input(InputSlot::MaxEffort(ActuatorId::from(a)), 0.0);
        }
    }
    if s.initialize(0.0).is_err() {
        tally.failed += 1;
        return;
    }
    let energy = |s: &mut Simulation| {
        s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
    };
    let first = energy(&mut s);
    let mut lowest = first;
    let start = Instant::now();
    for step in 1..=STEPS {
        if s.advance_to(f64::from(step) * H).is_err() {
            tally.failed += 1;
            break;
        }
        if limp {
            let now = energy(&mut s);
            tally.gained = tally.gained.max((now - lowest) / first.abs().max(1e-9));
            lowest = lowest.min(now);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    tally.seconds += seconds;
    tally.slowest = tally.slowest.max(seconds);
    tally.floor += s.state().counters[3];
}
