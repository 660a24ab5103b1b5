//! Simulates a scene and measures the time, for `benches/peers/speed.py` and
//! `benches/peers/precision.py`, which run this program.
//!
//! The first line of standard input is a scene, JSON: the paths of a URDF and a settings file, the
//! actuated joints and rows of commands. Every further line is one way to run it: solver,
//! communication step, length, how often to repeat. Each run answers with one line of JSON: the
//! least CPU time of the repetitions, the coordinates at every change of commands, step counts.

#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the answers go to standard output, the usage to standard error"
)]

#[path = "support/clock.rs"]
mod clock;

use serde::{Deserialize, Serialize};
use std::io::BufRead;
use std::path::PathBuf;
use std::sync::Arc;
use urdf2fmu_core::model::{ActuatorId, ActuatorMode, Model, RootId};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{
    InputSlot, OutputSlot, ParameterSlot, Simulation, SimulationError,
};
use urdf2fmu_core::{assemble, urdf};

/// What is played.
#[derive(Deserialize)]
struct Scene {
    urdf: PathBuf,
    settings: PathBuf,
    /// Joints in the order of the rows and of the answer's coordinates.
    joints: Vec<String>,
    /// The commanded ones among them, by place in `joints`.
    commanded: Vec<usize>,
    /// Commands (rad, rad/s or N·m by the mode of the actuator), one row a period.
    rows: Vec<Vec<f64>>,
    /// Rows per second.
    rate: u32,
}

/// How it is played.
#[derive(Deserialize)]
struct Run {
    /// s; 0: error control
    step: f64,
    tolerance: f64,
    /// Communication steps per row.
    per_row: u32,
    repeat: u32,
}

/// What came out.
#[derive(Serialize)]
struct Answer {
    /// Of CPU, the least of the repetitions.
    seconds: f64,
    /// Base position and quaternion (w, x, y, z) where there is one, then joints, at the start and
    /// after each row.
    samples: Vec<Vec<f64>>,
    steps: f64,
    rejected: f64,
    newton_max: f64,
}

fn read(scene: &Scene) -> Result<Model, Vec<urdf2fmu_core::diagnostic::Diagnostic>> {
    let text = std::fs::read_to_string(&scene.settings).unwrap_or_default();
    let settings = Settings::parse(&text, "scene.toml")?;
    let options = assemble::read_options(&settings, urdf::ReadOptions::from_environment());
    let description = urdf::read(&scene.urdf, &options)?;
    Ok(assemble::build(&description, &settings)?.model)
}

/// A scene, loaded.
struct Stage {
    scene: Scene,
    simulation: Simulation,
    /// One per commanded joint.
    slots: Vec<InputSlot>,
    /// Places in `q`, per joint.
    coordinates: Vec<usize>,
}

impl Stage {
    fn new(scene: Scene) -> Self {
        let model = read(&scene).unwrap_or_else(|findings| panic!("{findings:#?}"));
        let joint = |name: &String| {
            let place = model.joints.iter().position(|j| j.name == *name);
            place.unwrap_or_else(|| panic!("no joint '{name}'"))
        };
        let slots = scene
            .commanded
            .iter()
            .map(|&c| {
                let joint = joint(&scene.joints[c]);
                let a = model
                    .actuators
                    .iter()
                    .position(|a| a.joint.index() == joint);
                let a = a.unwrap_or_else(|| panic!("no actuator on '{}'", scene.joints[c]));
                let id = ActuatorId::from(a);
                match model.actuators[a].mode {
                    ActuatorMode::Velocity => InputSlot::Velocity(id),
                    ActuatorMode::Position | ActuatorMode::Pd => InputSlot::Position(id),
                    ActuatorMode::Effort => InputSlot::Effort(id),
                }
            })
            .collect();
        let coordinates = scene
            .joints
            .iter()
            .map(|name| {
                let body = model.joints[joint(name)].bodies[0];
                model.bodies[body.index()].coordinate
            })
            .collect();
        Self {
            slots,
            coordinates,
            simulation: Simulation::new(Arc::new(model)),
            scene,
        }
    }

    fn run(&mut self, run: &Run) -> Result<Answer, SimulationError> {
        let mut answer = Answer {
            seconds: f64::INFINITY,
            samples: Vec::new(),
            steps: 0.0,
            rejected: 0.0,
            newton_max: 0.0,
        };
        for _ in 0..run.repeat.max(1) {
            self.simulation.reset();
            self.simulation
                .set_parameter(ParameterSlot::StepSize, run.step);
            self.simulation
                .set_parameter(ParameterSlot::Tolerance, run.tolerance);
            self.simulation.initialize(0.0)?;
            answer.samples = vec![
                vec![0.0; self.simulation.state().physical.q.len()];
                self.scene.rows.len() + 1
            ];
            answer.samples[0].copy_from_slice(&self.simulation.state().physical.q);
            let start = clock::now();
            self.play(run, &mut answer.samples)?;
            answer.seconds = answer.seconds.min(clock::now() - start);
        }
        let base = if self.simulation.model().is_floating() {
            7
        } else {
            0
        };
        let frame = self.simulation.tree().base_frame(RootId::ROBOT);
        for sample in &mut answer.samples {
            if let Some(frame) = frame {
                let origin = frame.position(sample);
                sample[..3].copy_from_slice(origin.as_slice());
            }
            let joints = self.coordinates.iter().map(|&c| sample[c]);
            *sample = sample[..base].iter().copied().chain(joints).collect();
        }
        answer.steps = self.simulation.output(OutputSlot::Steps);
        answer.rejected = self.simulation.output(OutputSlot::Rejected);
        answer.newton_max = self.simulation.output(OutputSlot::NewtonMax);
        Ok(answer)
    }

    fn play(&mut self, run: &Run, samples: &mut [Vec<f64>]) -> Result<(), SimulationError> {
        let rate = f64::from(self.scene.rate * run.per_row);
        let mut count = 0;
        for (row, sample) in self.scene.rows.iter().zip(&mut samples[1..]) {
            for (&slot, &value) in self.slots.iter().zip(row) {
                self.simulation.set_input(slot, value);
            }
            for _ in 0..run.per_row {
                count += 1;
                self.simulation.advance_to(f64::from(count) / rate)?;
            }
            sample.copy_from_slice(&self.simulation.state().physical.q);
        }
        Ok(())
    }
}

fn main() {
    let mut lines = std::io::stdin().lock().lines().map_while(Result::ok);
    let Some(scene) = lines.next() else {
        eprintln!("usage: python benches/peers/speed.py or precision.py, which run this");
        return;
    };
    let scene = serde_json::from_str(&scene).unwrap_or_else(|e| panic!("not a scene: {e}"));
    let mut stage = Stage::new(scene);
    for line in lines {
        let run: Run = serde_json::from_str(&line).unwrap_or_else(|e| panic!("not a run: {e}"));
        let answer = stage
            .run(&run)
            .unwrap_or_else(|error| panic!("the run ends with: {error}"));
        let text = serde_json::to_string(&answer).expect("numbers");
        println!("{text}");
    }
}
