//! Standing robots stand still for an hour, with their weight on their feet.

use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::model::LinkId;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::{assemble, urdf};

/// An example robot with its settings, initialised.
fn example(name: &str) -> Simulation {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let settings = Settings::read(&folder.join(format!("{name}.toml"))).expect("an example");
    let options = assemble::read_options(&settings, urdf::ReadOptions::default());
    let description =
        urdf::read(&folder.join(format!("{name}.urdf")), &options).expect("an example");
    let model = assemble::build(&description, &settings)
        .expect("an example")
        .model;
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a sound model");
    simulation
}

/// Contact force in z over all links, N.
fn carried(simulation: &mut Simulation) -> f64 {
    let links = simulation.model().links.len();
    (0..links)
        .map(|l| simulation.output(OutputSlot::ContactForce(LinkId::from(l), 2)))
        .sum()
}

/// Peers: PyBullet's R2D2 turns by 0.7° an hour and walks millimetres (design, §6.1).
#[test]
fn a_rover_and_a_quadruped_stand_for_an_hour_without_moving() {
    for name in ["rover", "quadruped"] {
        let mut simulation = example(name);
        for step in 1..=2400_u32 {
            simulation
                .advance_to(f64::from(step) / 240.0)
                .expect("finite");
        }
        let settled = simulation.state().clone();
        assert!(
            settled.physical.v.iter().all(|v| v.abs() < 1e-9),
            "{name}: {:?}",
            settled.physical.v
        );
        for second in 11..=3610_u32 {
            simulation.advance_to(f64::from(second)).expect("finite");
        }
        for (before, after) in settled
            .physical
            .q
            .iter()
            .zip(&simulation.state().physical.q)
        {
            assert!((before - after).abs() < 1e-9, "{name}: {before} {after}");
        }
        let weight: f64 = simulation
            .model()
            .links
            .iter()
            .map(|l| l.inertia.mass)
            .sum::<f64>()
            * simulation.model().world.gravity.norm();
        let force = carried(&mut simulation);
        assert!(
            (force / weight - 1.0).abs() < 1e-6,
            "{name}: {force} N for {weight} N"
        );
    }
}

/// The same hour in fixed steps of 1/240 s.
#[test]
fn a_rover_and_a_quadruped_stand_for_an_hour_in_fixed_steps() {
    for name in ["rover", "quadruped"] {
        let mut simulation = example(name);
        simulation.set_parameter(ParameterSlot::StepSize, 1.0 / 240.0);
        simulation.initialize(0.0).expect("a sound model");
        for step in 1..=2400_u32 {
            simulation
                .advance_to(f64::from(step) / 240.0)
                .expect("finite");
        }
        let settled = simulation.state().physical.q.clone();
        for second in 11..=3610_u32 {
            simulation.advance_to(f64::from(second)).expect("finite");
        }
        for (before, after) in settled.iter().zip(&simulation.state().physical.q) {
            assert!((before - after).abs() < 1e-9, "{name}: {before} {after}");
        }
    }
}

/// What has come to rest takes no further steps, one step a look, whatever its steps are. A guess
/// that is taken as it is leaves forces out of balance by its accuracy, so that a robot that asked
/// for a better balance would be stirred for ever.
#[test]
fn robots_come_to_rest_in_steps_of_any_kind_and_accuracy() {
    for name in ["rover", "quadruped"] {
        for (step, tolerance) in [
            (1.0 / 240.0, 1e-3),
            (1e-3, 1e-3),
            (0.0, 1e-1),
            (0.0, 1e-2),
            (0.0, 1e-3),
            (0.0, 1e-5),
            (0.0, 1e-7),
        ] {
            let mut simulation = example(name);
            simulation.set_parameter(ParameterSlot::StepSize, step);
            simulation.set_parameter(ParameterSlot::Tolerance, tolerance);
            simulation.initialize(0.0).expect("a sound model");
            for tick in 1..=5 * 240_u32 {
                let end = f64::from(tick) / 240.0;
                simulation.advance_to(end).expect("finite");
            }
            let before = simulation.state().stepping.counters.steps;
            for second in 6..=15_u32 {
                simulation.advance_to(f64::from(second)).expect("finite");
            }
            let taken = simulation.state().stepping.counters.steps - before;
            assert!(taken <= 10, "{name}, {step} s, {tolerance}: {taken} steps");
            assert!(simulation.state().physical.v.iter().all(|v| *v == 0.0));
        }
    }
}
