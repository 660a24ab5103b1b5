//! A step allocates nothing: counted, on each example robot, in every kind of step.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::model::ActuatorId;
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::urdf::ReadOptions;
use urdf2fmu_core::{assemble, urdf};

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting the calls of this thread.
struct Counting;

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations while `body` runs.
fn counted(body: impl FnOnce()) -> usize {
    let before = COUNT.with(Cell::get);
    body();
    COUNT.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert_eq!(counted(|| drop(std::hint::black_box(vec![1, 2, 3]))), 1);
}

#[test]
fn do_step_save_and_read_do_not_allocate() {
    // Once more with everything that contacts can have.
    let rough =
        "[world.ground]\nrolling_friction = 1e-3\ntorsional_friction = 1e-3\nstatic_friction = 1\n";
    for (name, settings) in [
        ("rover", ""),
        ("arm", ""),
        ("quadruped", ""),
        ("rover", rough),
    ] {
        let settings = Settings::parse(settings, "settings").expect("legal settings");
        let file = format!("{}/examples/{name}.urdf", env!("CARGO_MANIFEST_DIR"));
        let description =
            urdf::read(Path::new(&file), &ReadOptions::default()).expect("an example");
        let model = assemble::build(&description, &settings)
            .expect("an example")
            .model;
        let actuators = model.actuators.len();
        for fixed in [0.0, 1.0 / 240.0] {
            let mut simulation = Simulation::new(Arc::new(model.clone()));
            simulation.set_parameter(ParameterSlot::StepSize, fixed);
            // From the air, so that explicit steps, the impact and rest all happen.
            let height = simulation.parameter(ParameterSlot::InitialBasePosition(2));
            simulation.set_parameter(ParameterSlot::InitialBasePosition(2), height + 0.3);
            simulation.initialize(0.0).expect("a sound model");
            let mut saved = simulation.save();
            let count = counted(|| {
                for step in 1..=720_u32 {
                    for a in 0..actuators {
                        let phase = f64::from(step) * 0.01;
                        let target = if step < 480 { libm::sin(phase) } else { 0.0 };
                        simulation.set_input(InputSlot::Velocity(ActuatorId::from(a)), target);
                    }
                    simulation
                        .advance_to(f64::from(step) / 240.0)
                        .expect("finite");
                    std::hint::black_box(simulation.output(OutputSlot::EnergyKinetic));
                    if step % 100 == 0 {
                        simulation.restore(&saved).expect("its own state");
                        simulation.save_into(&mut saved);
                        let time = f64::from(step) / 240.0;
                        simulation.state_mut().time = time;
                    }
                }
            });
            assert_eq!(count, 0, "{name}, step size {fixed}");
        }
    }
}
