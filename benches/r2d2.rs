//! Time per 1/240 s of PyBullet's R2D2 driving. `benches/peers/r2d2.py` runs this program beside
//! other simulators.
//!
//! Argument: path of r2d2.urdf. Then one run per line of standard input, which names the solver: an
//! error tolerance (`1e-3`) or a fixed step (`1/240`). Each answers with one line of JSON: wall
//! time of the loop, result, step counts. The scenario is that of `benches/peers/scenario.py`:
//! settle, turn on the spot, drive forward, 10 rad/s.

#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the answers go to standard output, the usage to standard error"
)]

use std::io::BufRead;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use urdf2fmu_core::model::{ActuatorId, Model, RootId};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{
    InputSlot, OutputSlot, ParameterSlot, Simulation, SimulationError,
};
use urdf2fmu_core::{assemble, urdf};

const SETTINGS: &str = r#"
[robot]
inertia = "collision"
[world]
gravity = [0, 0, -9.8]
ground = { type = "plane", friction = 0.5 }
[link."*"]
friction = 0.5
"#;

/// Steps of 1/240 s, velocity of the right and the left wheels, rad/s, most effort, N·m.
const PHASES: [(u32, f64, f64, f64); 3] = [
    (240, 0.0, 0.0, 100.0),
    (240, -10.0, 10.0, 50.0),
    (500, -10.0, -10.0, 10.0),
];

fn read(path: &Path) -> Result<Model, Vec<urdf2fmu_core::diagnostic::Diagnostic>> {
    let settings = Settings::parse(SETTINGS, "r2d2.toml")?;
    let description = urdf::read(
        path,
        &assemble::read_options(&settings, urdf::ReadOptions::from_environment()),
    )?;
    Ok(assemble::build(&description, &settings)?.model)
}

/// Position, m, and heading, rad.
fn pose(simulation: &mut Simulation) -> [f64; 4] {
    [
        simulation.output(OutputSlot::BasePosition(RootId::ROBOT, 0)),
        simulation.output(OutputSlot::BasePosition(RootId::ROBOT, 1)),
        simulation.output(OutputSlot::BasePosition(RootId::ROBOT, 2)),
        simulation.output(OutputSlot::BaseRpy(RootId::ROBOT, 2)),
    ]
}

/// One drive; seconds of wall time, poses at the ends of the phases.
fn drive(
    simulation: &mut Simulation,
    wheels: &[(ActuatorId, bool)],
) -> Result<(f64, [[f64; 4]; 3]), SimulationError> {
    let mut poses = [[0.0; 4]; 3];
    let start = Instant::now();
    let mut count = 0;
    for ((steps, right, left, effort), end) in PHASES.into_iter().zip(&mut poses) {
        for &(wheel, is_right) in wheels {
            simulation.set_input(
                InputSlot::Velocity(wheel),
                if is_right { right } else { left },
            );
            simulation.set_input(InputSlot::MaxEffort(wheel), effort);
        }
        for _ in 0..steps {
            count += 1;
            simulation.advance_to(f64::from(count) / 240.0)?;
        }
        *end = pose(simulation);
    }
    Ok((start.elapsed().as_secs_f64(), poses))
}

fn main() {
    let Some(path) = std::env::args().nth(1).filter(|a| !a.starts_with('-')) else {
        eprintln!(
            "usage: r2d2 PATH/r2d2.urdf; python benches/peers/r2d2.py runs it beside its peers"
        );
        return;
    };
    let model = read(Path::new(&path)).unwrap_or_else(|findings| panic!("{findings:#?}"));
    let wheels: Vec<_> = (0..model.actuators.len())
        .map(ActuatorId::from)
        .filter_map(|a| {
            let joint = model.actuators[a.index()].joint;
            let name = &model.joints[joint.index()].name;
            name.contains("wheel")
                .then(|| (a, name.starts_with("right")))
        })
        .collect();
    assert_eq!(wheels.len(), 4, "R2D2 has four wheels");
    let mut simulation = Simulation::new(Arc::new(model));
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let fixed = line.strip_prefix("1/").and_then(|n| n.parse::<f64>().ok());
        simulation.reset();
        simulation.set_parameter(ParameterSlot::StepSize, fixed.map_or(0.0, |n| 1.0 / n));
        if fixed.is_none() {
            let tolerance = line.parse().expect("a tolerance or 1/n");
            simulation.set_parameter(ParameterSlot::Tolerance, tolerance);
        }
        let result = simulation
            .initialize(0.0)
            .and_then(|()| drive(&mut simulation, &wheels));
        let (seconds, [settled, turned, end]) =
            result.unwrap_or_else(|error| panic!("the run ends with: {error}"));
        println!(
            "{{\"seconds\": {seconds}, \"yaw\": {}, \"forward\": {}, \"z\": {}, \"steps\": {}, \"rejected\": {}}}",
            turned[3] - settled[3],
            (end[0] - turned[0]).hypot(end[1] - turned[1]),
            end[2],
            simulation.output(OutputSlot::Steps),
            simulation.output(OutputSlot::Rejected),
        );
    }
}
