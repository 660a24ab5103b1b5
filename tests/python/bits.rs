//! Compares every bit of all results with a recording, for changes that are meant to keep results.
//!
//! Ten robots, each in every actuator mode, under error control and in fixed steps: commands that
//! stay, that change at each communication step and that follow ramps; communication steps of equal
//! and of random length; pushes from outside; a saved state that another instance continues.
//! `bits.txt` holds one hash a run. A change of the method records it anew, with its reason in
//! `docs/design.md`:
//!
//! ```text
//! URDF2FMU_RECORD=1 cargo test --test bits
//! ```

#[path = "environment.rs"]
#[allow(dead_code, reason = "shared with tests that run Python")]
mod environment;
#[allow(dead_code, reason = "shared with other tests")]
mod reader;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use urdf2fmu_core::hash::Fnv;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, LinkId, Model};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation, Snapshot};
use urdf2fmu_core::variables::{Slot, table};

#[path = "../../src/testing/random.rs"]
#[allow(missing_docs, reason = "shared with the unit tests")]
mod random;
use random::Random;

/// Every kind of output, a push on every link, and laws that are off by default.
const SETTINGS: &str = r#"
[outputs]
links = ["*"]
contact_points = true
[[external_wrench]]
link = "*"
[link."*"]
friction = 0.6
static_friction = 0.7
"#;

/// Bounces, rolls and drills against friction.
const LIVELY: &str = "restitution = 0.3\nrolling_friction = 0.004\ntorsional_friction = 0.005\n";

/// URDF files, those of PyBullet below its data folder, and whether the lively laws act, too.
const ROBOTS: [(&str, bool); 10] = [
    ("examples/rover.urdf", false),
    ("examples/quadruped.urdf", true),
    ("examples/arm.urdf", false),
    ("tests/robots/humanoid.urdf", false),
    ("tests/robots/every_joint.urdf", true),
    ("pybullet/r2d2.urdf", false),
    ("pybullet/laikago/laikago_toes.urdf", false),
    ("pybullet/husky/husky.urdf", true),
    ("pybullet/kuka_iiwa/model.urdf", false),
    ("pybullet/franka_panda/panda.urdf", false),
];

const MODES: [ActuatorMode; 4] = [
    ActuatorMode::Velocity,
    ActuatorMode::Position,
    ActuatorMode::Pd,
    ActuatorMode::Effort,
];

/// A robot under way, and what it has gone through.
struct Run {
    simulation: Simulation,
    outputs: Vec<OutputSlot>,
    random: Random,
    hash: Fnv,
}

impl Run {
    fn new(model: &Arc<Model>, step: f64) -> Self {
        let rows = table(model).expect("distinct names");
        let outputs = rows.iter().filter_map(|row| match row.slot {
            Slot::Output(slot) => Some(slot),
            _ => None,
        });
        let mut simulation = Simulation::new(Arc::clone(model));
        simulation.set_parameter(ParameterSlot::StepSize, step);
        simulation.initialize(0.0).expect("a sound robot");
        Self {
            simulation,
            outputs: outputs.collect(),
            random: Random(7),
            hash: Fnv::default(),
        }
    }

    /// New commands for all actuators; ramps where `varies`.
    fn command(&mut self, varies: bool) {
        let Self {
            simulation, random, ..
        } = self;
        for a in (0..simulation.model().actuators.len()).map(ActuatorId::from) {
            simulation.set_input(InputSlot::Velocity(a), random.uniform(-6.0, 6.0));
            simulation.set_input(InputSlot::Position(a), random.uniform(-0.5, 0.5));
            simulation.set_input(InputSlot::Effort(a), random.uniform(-2.0, 2.0));
            simulation.set_input(InputSlot::MaxEffort(a), random.uniform(1.0, 20.0));
            if varies {
                for slot in [InputSlot::Velocity(a), InputSlot::Position(a)] {
                    simulation.set_input_derivative(slot, 1, random.uniform(-2.0, 2.0));
                }
            }
        }
    }

    fn push(&mut self) {
        let last = LinkId::from(self.simulation.model().links.len() - 1);
        for axis in 0..3 {
            let force = self.random.uniform(-3.0, 3.0);
            self.simulation
                .set_input(InputSlot::ExternalForce(last, axis), force);
        }
    }

    fn step(&mut self, h: f64) {
        let end = self.simulation.time() + h;
        self.simulation.advance_to(end).expect("finite");
        let state = self.simulation.state();
        for x in state.physical.q.iter().chain(&state.physical.v) {
            self.hash.add(&x.to_le_bytes());
        }
    }

    fn read(&mut self) {
        for slot in &self.outputs {
            self.hash.add(&self.simulation.output(*slot).to_le_bytes());
            let rate = self.simulation.output_derivative(*slot);
            self.hash.add(&rate.unwrap_or(0.5).to_le_bytes());
        }
    }

    /// The second half, which a restored run repeats.
    fn go_on(&mut self) {
        for _ in 0..40 {
            self.command(true);
            let h = self.random.uniform(1e-4, 0.02);
            self.step(h);
        }
        self.read();
        self.push();
        self.command(false);
        (0..60).for_each(|_| self.step(1.0 / 240.0));
        self.read();
    }
}

/// Hashes of the first half and of the second.
fn hashes(model: &Arc<Model>, step: f64) -> [u64; 2] {
    let mut run = Run::new(model, step);
    run.read();
    (0..60).for_each(|_| run.step(1.0 / 240.0));
    run.read();
    run.command(false);
    (0..60).for_each(|_| run.step(1.0 / 240.0));
    run.read();
    for _ in 0..60 {
        run.command(false);
        run.step(1.0 / 240.0);
    }
    run.read();
    let first = run.hash;
    let bytes = run.simulation.save().to_bytes();
    let mut other = Run::new(model, step);
    let saved = Snapshot::from_bytes(model, &bytes).expect("what was written");
    other.simulation.restore(&saved).expect("the same model");
    (other.random.0, other.hash) = (run.random.0, first);
    run.go_on();
    other.go_on();
    assert_eq!(run.hash, other.hash, "{}: restored", model.name);
    [first.value(), run.hash.value()]
}

/// One line for each mode and kind of step of a robot.
fn record(name: &str, path: &Path, settings: &Settings) -> String {
    let mut text = String::new();
    for mode in MODES {
        for step in [0.0, 1.0 / 240.0] {
            let mut model = reader::model(path, settings);
            for actuator in &mut model.actuators {
                actuator.mode = mode;
            }
            let [first, second] = hashes(&Arc::new(model), step);
            let kind = if step > 0.0 { "fixed" } else { "controlled" };
            writeln!(text, "{name} {mode:?} {kind} {first:016x} {second:016x}").expect("room");
        }
    }
    text
}

/// The lines of all robots, each robot on a thread of its own.
fn record_all(root: &Path, pybullet: &Path) -> String {
    std::thread::scope(|scope| {
        let robots = ROBOTS.map(|(name, lively)| {
            let path: PathBuf = match name.strip_prefix("pybullet/") {
                Some(rest) => pybullet.join(rest),
                None => root.join(name),
            };
            let settings = format!("{SETTINGS}{}", if lively { LIVELY } else { "" });
            let settings = Settings::parse(&settings, "bits.toml").expect("legal");
            scope.spawn(move || record(name, &path, &settings))
        });
        robots.map(|robot| robot.join().expect("no panic")).concat()
    })
}

#[test]
fn every_bit_of_ten_robots_is_as_recorded() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let place = root.join("tests/python/bits.txt");
    let Some(environment) = environment::make() else {
        return;
    };
    let text = record_all(root, &environment.pybullet_data);
    if std::env::var_os("URDF2FMU_RECORD").is_some() {
        std::fs::write(&place, &text).expect("a writable checkout");
    }
    let recorded = std::fs::read_to_string(&place).expect("bits.txt is part of the checkout");
    assert_eq!(recorded.lines().count(), text.lines().count(), "runs");
    let pairs = recorded.lines().zip(text.lines());
    let differing: Vec<_> = pairs.filter(|(recorded, now)| recorded != now).collect();
    assert!(differing.is_empty(), "recorded, now: {differing:#?}");
}
