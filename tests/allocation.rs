//! Counts the allocations of a step, on each example robot and in every kind of step: there are
//! none.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;
use urdf2fmu_core::assemble::{self, Guest};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::geometry::field::{Field, Samples};
use urdf2fmu_core::geometry::pair::{Patch, Solid};
use urdf2fmu_core::geometry::surface::{Surface, Triangles};
use urdf2fmu_core::model::{ActuatorId, LoopId, Model, PairId, RootId, RootKind};
use urdf2fmu_core::settings::{ObjectSource, Settings};
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::spatial::{Pose, Vec3};
use urdf2fmu_core::urdf;
use urdf2fmu_core::urdf::ReadOptions;
use urdf2fmu_core::variables::{Slot, table};

#[path = "acceptance/claim.rs"]
mod claim;

use claim::hold;

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
fn the_counting_allocator_counts_allocations() {
    assert_eq!(counted(|| drop(std::hint::black_box(vec![1, 2, 3]))), 1);
}

/// Rough heights about z = 0.
fn hills() -> Shape {
    let heights = (0..400).map(|i| 0.01 * libm::sin(1.7 * f64::from(i)));
    let samples = Samples {
        size: [0.4, 0.4],
        counts: [20, 20],
        heights: heights.collect(),
    };
    Shape::Field {
        field: Arc::new(Field::try_from(samples).expect("a grid")),
    }
}

/// Many narrow triangles with a ridge each.
fn roof() -> Shape {
    let at = |i: i32, y: f64| {
        let x = f64::from(i) * 0.01 - 0.2;
        Vec3::new(x, y, if i % 2 == 0 { 0.0 } else { 0.003 })
    };
    let strips = (0..40).flat_map(|i| {
        let [a, b] = [at(i, -0.2), at(i + 1, -0.2)];
        let [c, d] = [at(i + 1, 0.2), at(i, 0.2)];
        [[a, b, c], [a, c, d]]
    });
    let triangles: Vec<_> = strips.collect();
    Shape::Surface {
        surface: Arc::new(Surface::try_from(Triangles::new(&triangles)).expect("triangles")),
    }
}

/// Every pairing of shapes, over each other in places from apart to deep.
#[test]
fn a_contact_of_two_shapes_does_not_allocate() {
    let (radius, half_length) = (0.03, 0.05);
    let vertices: Vec<Vec3> = (0..40)
        .map(|i| {
            let angle = 2.4 * f64::from(i);
            let z = f64::from(i) / 19.5 - 1.0;
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * libm::cos(angle), r * libm::sin(angle), z) * 0.05
        })
        .collect();
    let solids = [
        Solid::new(&Shape::Sphere { radius }, 3e-4),
        Solid::new(
            &Shape::Capsule {
                radius,
                half_length,
            },
            3e-4,
        ),
        Solid::new(
            &Shape::Cylinder {
                radius,
                half_length,
            },
            3e-4,
        ),
        Solid::new(
            &Shape::Box {
                half: Vec3::new(0.03, 0.04, 0.05),
            },
            3e-4,
        ),
        Solid::new(&Shape::Hull { vertices }, 3e-4),
        Solid::half_space(),
        Solid::new(&hills(), 3e-4),
        Solid::new(&roof(), 3e-4),
    ];
    let mut patch = Patch::new();
    let mut found = 0;
    let allocations = counted(|| {
        for a in &solids {
            for b in &solids {
                for i in 0..100 {
                    let t = f64::from(i) * 0.01;
                    let pose = Pose::from_xyz_rpy(
                        Vec3::new(0.02 * t, 0.01, 0.11 - 0.11 * t),
                        Vec3::new(t, 0.5 * t, 3.0 * t),
                    );
                    found += usize::from(patch.find((a, &pose), (b, &Pose::IDENTITY), 1e-3));
                }
            }
        }
    });
    assert_eq!(allocations, 0);
    assert!(found > 1500, "{found}");
}

/// Everything that contacts can have.
const ROUGH: &str = "[world.ground]\nrolling_friction = 1e-3\ntorsional_friction = 1e-3\nstatic_friction = 1\n\
     [[outputs.pair]]\nname = \"stand\"\nfirst = \"*_wheel\"\nsecond = \"ground\"\n";
/// Contacts that bounce, in steps of their own.
const BOUNCING: &str = "[world.ground]\nrestitution = 0.5\n";
/// Every joint under a position servo, under a pd law, and pushed.
const SERVO: &str = "[[actuator]]\njoint = \"*\"\nmode = \"position\"\n";
const PD: &str = "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 50\nkd = 2\n";
/// Sensors of every type, some of which err and hold.
const SENSED: &str = "[[sensor]]\ntype = \"imu\"\nlink = \"base_link\"\nrate = 100\n\
     angular_velocity.noise = [1e-3, 1e-3, 1e-3]\n[[sensor]]\ntype = \"ft\"\njoint = \"head_joint\"\n\
     [[sensor]]\ntype = \"ray\"\nname = \"lidar\"\nlink = \"head\"\nrays = 90\nfov = 6\nrows = 3\n\
     vertical_fov = 1\nhits = true\n[[sensor]]\ntype = \"encoder\"\nname = \"turn\"\njoint = \"head_joint\"\n\
     counts = 512\nrate = 50\n[[sensor]]\ntype = \"contact\"\nname = \"tyre\"\nlink = \"left_front_wheel\"\n";
const PUSHED: &str = "[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n";

#[test]
fn do_step_save_and_read_do_not_allocate() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let (mut steps, mut all) = (0, 0);
    for (name, settings) in [
        ("rover", Some("")),
        ("rover", Some(ROUGH)),
        ("rover", Some(BOUNCING)),
        ("rover", Some(SENSED)),
        ("arm", Some("")),
        ("arm", Some(SERVO)),
        ("arm", Some(PD)),
        ("arm", Some(PUSHED)),
        ("quadruped", Some("")),
        ("quadruped", Some(SERVO)),
        // Its own settings.
        ("quadruped", None),
    ] {
        let settings = match settings {
            Some(text) => Settings::parse(text, "settings").expect("legal settings"),
            None => Settings::read(&folder.join(format!("{name}.toml"))).expect("an example"),
        };
        let options = assemble::read_options(&settings, ReadOptions::default());
        let file = folder.join(format!("{name}.urdf"));
        let description = urdf::read(&file, &options).expect("an example");
        let model = assemble::build(&description, &settings)
            .expect("an example")
            .model;
        // Commands that stay between communication points, and commands that vary.
        for (fixed, slope) in [
            (0.0, 0.0),
            (0.0, 0.3),
            (1.0 / 240.0, 0.0),
            (1.0 / 240.0, 0.3),
        ] {
            let count = allocations(&model, (fixed, slope), STEPS);
            assert_eq!(count, 0, "{name}, step size {fixed}, slope {slope}");
            (steps, all) = (steps + STEPS, all + count);
        }
    }
    let what =
        format!("allocations in {steps} communication steps, with saving, restoring and outputs");
    hold(
        "G",
        &what,
        "0",
        f64::from(u32::try_from(all).expect("few")),
        0.0,
    );
}

/// The machines of `examples/worlds`, one of them on a spring, in explicit and implicit steps.
#[test]
fn closed_loops_and_springs_do_not_allocate() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/worlds");
    let spring = "\n[[spring]]\nlinks = [\"bucket\", \"world\"]\nstiffness = 500\ndamping = 20\n";
    let free = "\n[[actuator]]\njoint = \"*\"\nmode = \"effort\"\n";
    for (name, more) in [
        ("delta", ""),
        ("delta", free),
        ("excavator", ""),
        ("excavator", spring),
    ] {
        let text = std::fs::read_to_string(folder.join(format!("{name}.toml")));
        let text = text.expect("an example") + more;
        let settings = Settings::parse(&text, "settings").expect("legal settings");
        let file = folder.join(format!("{name}.urdf"));
        let options = assemble::read_options(&settings, ReadOptions::default());
        let description = urdf::read(&file, &options).expect("an example");
        let model = assemble::build(&description, &settings)
            .expect("an example")
            .model;
        for fixed in [0.0, 1.0 / 240.0] {
            let count = allocations(&model, (fixed, 0.0), STEPS);
            assert_eq!(count, 0, "{name}{more}, step size {fixed}");
        }
    }
}

/// The robot of a world of `examples/worlds` with all that is around it; what the file generates
/// as terrain is [`hills`] here.
fn surrounded(robot: &str, world: &str) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/worlds");
    let read = |file: &Path, settings: &Settings| {
        let options = assemble::read_options(settings, ReadOptions::default());
        urdf::read(file, &options).expect("an example")
    };
    let settings = Settings::read(&folder.join(world).with_extension("toml")).expect("an example");
    let robots = settings.robots.iter().map(|entry| {
        let own = entry
            .config
            .as_ref()
            .map(|file| Settings::read(file).expect("an example"));
        let own = assemble::of_robot(entry, own.unwrap_or_default(), &settings);
        let settings = own.expect("no contradiction");
        let description = read(&entry.urdf, &settings);
        (
            entry.name.text.clone(),
            RootKind::Robot,
            description,
            settings,
        )
    });
    let objects = settings.objects.iter().map(|entry| {
        let (name, own) = (entry.called(), assemble::of_object(entry, &settings));
        let description = match &entry.source {
            ObjectSource::Solid { shape, mass } => assemble::solid(name, shape, *mass),
            ObjectSource::Urdf(file) => read(file, &own),
            ObjectSource::Terrain(_) => assemble::solid(name, &hills(), 0.0),
        };
        (name.to_owned(), RootKind::Object, description, own)
    });
    let guests: Vec<Guest> = robots
        .chain(objects)
        .map(|(name, kind, description, settings)| Guest {
            name,
            kind,
            description,
            settings,
        })
        .collect();
    let description = read(&folder.join(robot), &settings);
    assemble::world(&description, &settings, &guests)
        .expect("an example")
        .model
}

/// Several trees that meet, part into islands, rest and are pushed: boxes of a pile, what a gripper
/// holds, a chair, dominoes, balls that bounce, terrain, links of one robot that touch.
#[test]
fn worlds_of_several_trees_do_not_allocate() {
    for (robot, world) in [
        ("gripper.urdf", "gripper_cup"),
        ("humanoid.urdf", "humanoid_chair"),
        ("cradle.urdf", "newtons_cradle"),
        ("pusher.urdf", "domino_row"),
        ("../quadruped.urdf", "rough_ground"),
        ("../rover.urdf", "rover_box_ramp"),
    ] {
        let mut model = surrounded(robot, world);
        model.roots[0].self_collision = true;
        // Long enough to fall, to meet and to be put back.
        for fixed in [0.0, 1.0 / 240.0] {
            let count = allocations(&model, (fixed, 0.0), 120);
            assert_eq!(count, 0, "{world}, step size {fixed}");
        }
    }
}

/// Communication steps of a run.
const STEPS: u32 = 720;

/// Allocations in a run of a robot that falls onto the ground under commands, stands, and is put
/// back now and then.
///
/// - `fixed`: fixed step, s; 0: error control
/// - `slope`: by how much commands rise between communication points, 1/s
/// - `steps`: how many communication steps
fn allocations(model: &Model, (fixed, slope): (f64, f64), steps: u32) -> usize {
    let actuators = model.actuators.len();
    let mut simulation = Simulation::new(Arc::new(model.clone()));
    simulation.set_parameter(ParameterSlot::StepSize, fixed);
    // From the air, so that explicit steps, the impact and rest all happen.
    let height = simulation.parameter(ParameterSlot::InitialBasePosition(RootId::ROBOT, 2));
    simulation.set_parameter(
        ParameterSlot::InitialBasePosition(RootId::ROBOT, 2),
        height + 0.3,
    );
    simulation.initialize(0.0).expect("a sound model");
    let mut saved = simulation.save();
    let pairs = model.outputs.pairs.len();
    let rows = table(model).expect("no clash").into_iter();
    let sensed: Vec<OutputSlot> = rows
        .filter(|row| row.name.starts_with("sensor."))
        .filter_map(|row| match row.slot {
            Slot::Output(slot) => Some(slot),
            _ => None,
        })
        .collect();
    counted(|| {
        for step in 1..=steps {
            for a in (0..actuators).map(ActuatorId::from) {
                let phase = f64::from(step) * 0.01;
                let target = if step < 480 { libm::sin(phase) } else { 0.0 };
                for slot in [
                    InputSlot::Velocity(a),
                    InputSlot::Position(a),
                    InputSlot::Effort(a),
                ] {
                    simulation.set_input(slot, 0.2 * target);
                    if slope != 0.0 && step < 480 {
                        simulation.set_input_derivative(slot, 1, slope);
                        simulation.set_input_derivative(slot, 2, -slope);
                    }
                }
            }
            simulation
                .advance_to(f64::from(step) / 240.0)
                .expect("finite");
            std::hint::black_box(simulation.output(OutputSlot::EnergyKinetic));
            for slot in &sensed {
                std::hint::black_box(simulation.output(*slot));
            }
            if !model.loops.is_empty() {
                let first = LoopId(0);
                std::hint::black_box(simulation.output(OutputSlot::LoopForce(first, 2)));
                std::hint::black_box(simulation.output(OutputSlot::LoopGap(first)));
            }
            for pair in (0..pairs).map(PairId::from) {
                for slot in [
                    OutputSlot::PairActive(pair),
                    OutputSlot::PairForce(pair, 2),
                    OutputSlot::PairPoint(pair, 0),
                    OutputSlot::PairNormal(pair, 2),
                    OutputSlot::PairDepth(pair),
                    OutputSlot::PairSlipSpeed(pair),
                ] {
                    std::hint::black_box(simulation.output(slot));
                }
            }
            if step % 100 == 0 {
                simulation.restore(&saved).expect("its own state");
                simulation.save_into(&mut saved);
                let time = f64::from(step) / 240.0;
                simulation.state_mut().time = time;
            }
        }
    })
}
