//! A rover with one driven wheel on the ground, and what an instance of it must do.
//!
//! Over 500 lines because it is a list of calls, each with what is answered.

#![allow(
    clippy::float_cmp,
    clippy::too_many_lines,
    reason = "times are exact; a model is long"
)]

mod limits;
mod messages;
mod partial;
mod start;

use super::*;
use crate::common::{Interface, Status};
use crate::logger::Sink;
use crate::pointers::{In, Out};
use urdf2fmu_core::geometry::Shape;
use urdf2fmu_core::model::{
    Actuator, ActuatorMode, Body, Collider, Combination, ContactDefaults, Dof, DofId, Ground,
    Group, Initial, Joint, JointId, JointKind, Link, LinkId, Motion, OutputSelection, Root, RootId,
    SolverDefaults, World,
};
use urdf2fmu_core::prepared::PreparedModel;
use urdf2fmu_core::simulation::{InputSlot, OutputSlot, ParameterSlot};
use urdf2fmu_core::spatial::{Mat3, Pose, RigidInertia, Vec3};
use urdf2fmu_core::variables::{Kind, Unit};

const WHEEL_VELOCITY: u32 = 0;
const MAX_EFFORT: u32 = 1;
const HEIGHT: u32 = 2;
const STEPS: u32 = 3;
const GRAVITY: u32 = 4;
const START_HEIGHT: u32 = 5;
const WHEEL_SPEED: u32 = 6;
const MAX_STEPS: u32 = 7;
const KINETIC_ENERGY: u32 = 8;

/// A freshly instantiated one that logs nowhere.
pub(crate) fn instance() -> Instance {
    instance_of(Version::V2)
}

/// One that speaks a version of FMI. All rows are scalars.
pub(crate) fn instance_of(version: Version) -> Instance {
    instance_with(version, rows())
}

fn instance_with(version: Version, rows: Vec<Variable>) -> Instance {
    let logger = Logger::new(Sink::None, std::ptr::null_mut(), false);
    let model = rover();
    let layout = Layout::new(version, &model, &rows).expect("no clash");
    let guid = GuidHash::new("{test}");
    let prepared = PreparedModel::new(String::new(), model);
    Instance::new(
        logger,
        (version, Interface::CoSimulation),
        guid,
        (Arc::new(prepared.model), prepared.hash),
        rows,
        layout,
    )
}

/// Initialised at 0 s, without a call of fmi2SetupExperiment.
fn running() -> Instance {
    initialised(instance())
}

/// Initialised at a start time, s, with or without a stop time.
fn running_from(start: f64, stop: Option<f64>) -> Instance {
    let mut instance = instance();
    let set_up = instance.setup_experiment(None, start, stop);
    set_up.expect("legal times");
    initialised(instance)
}

fn initialised(mut instance: Instance) -> Instance {
    instance.enter_initialization_mode();
    instance.exit_initialization_mode().expect("a legal rover");
    instance
}

fn rover() -> Model {
    let ball = |mass: f64, radius: f64| RigidInertia {
        mass,
        com: Vec3::zeros(),
        I_cm: Mat3::identity() * (0.4 * mass * radius * radius),
    };
    let axis = Vec3::new(0.0, 1.0, 0.0);
    let link = |name: &str, index: usize, inertia| Link {
        name: name.into(),
        joint: (index > 0).then(|| JointId::from(index - 1)),
        body: index.into(),
        X_BL: Pose::IDENTITY,
        inertia,
        friction: 0.8,
        restitution: 0.0,
        static_excess: 0.0,
        rolling_friction: 0.0,
        torsional_friction: 0.0,
        stiffness: None,
        dissipation: None,
    };
    let below = Pose {
        p: Vec3::new(0.0, 0.0, -0.2),
        ..Pose::IDENTITY
    };
    let body = |link: usize, motion, coordinate, dof| Body {
        link: link.into(),
        parent: (link > 0).then(|| 0.into()),
        joint: (link > 0).then(|| 0.into()),
        motion,
        X_PB: if link > 0 { below } else { Pose::IDENTITY },
        coordinate,
        dof: DofId(dof),
        ratio: 1.0,
        offset: 0.0,
    };
    let collider = |index: usize, radius| Collider {
        link: index.into(),
        body: index.into(),
        X_BG: Pose::IDENTITY,
        shape: Shape::Sphere { radius },
    };
    Model {
        name: "rover".into(),
        links: vec![
            link("base", 0, ball(4.0, 0.2)),
            link("wheel", 1, ball(1.0, 0.1)),
        ],
        joints: vec![Joint {
            name: "axle".into(),
            kind: JointKind::Continuous,
            parent: LinkId(0),
            child: LinkId(1),
            X_PJ: below,
            axis,
            bodies: vec![1.into()],
            limits: None,
            effort: None,
            velocity: None,
            damping: 0.0,
            friction: 0.0,
            armature: 0.0,
            static_excess: 0.0,
            stribeck_velocity: 0.01,
            enforce_velocity: false,
            mimic: None,
        }],
        bodies: vec![
            body(0, Motion::Free, 0, 0),
            body(1, Motion::Revolute(axis), 7, 6),
        ],
        dofs: (0..7)
            .map(|dof| Dof {
                body: usize::from(dof == 6).into(),
                limits: None,
            })
            .collect(),
        roots: vec![Root {
            position: Vec3::new(0.0, 0.0, 0.35),
            ..Root::new(String::new(), 0.into())
        }],
        nq: 8,
        apart: Vec::new(),
        loops: Vec::new(),
        springs: Vec::new(),
        colliders: vec![collider(0, 0.2), collider(1, 0.1)],
        actuators: vec![Actuator {
            joint: JointId(0),
            dof: DofId(6),
            mode: ActuatorMode::Velocity,
            max_effort: 5.0,
            reference_effort: 5.0,
            kp: 0.0,
            kd: 0.0,
            no_load_speed: None,
        }],
        initial: Initial {
            joint_positions: vec![0.0],
            joint_velocities: vec![0.0],
        },
        solver: SolverDefaults {
            step_size: 0.0,
            tolerance: 0.0,
            max_steps: urdf2fmu_core::range::MOST_STEPS,
        },
        contact: ContactDefaults {
            penetration: 1e-4,
            stiffness: None,
            dissipation: 51.0,
            stribeck_velocity: 0.01,
        },
        world: World {
            gravity: Vec3::new(0.0, 0.0, -9.81),
            combination: Combination::Mean,
            drag: 0.0,
            ground: Some(Ground {
                friction: 0.8,
                ..Default::default()
            }),
        },
        outputs: OutputSelection::default(),
    }
}

/// A few rows of each causality and type; the real table is the core's business.
fn rows() -> Vec<Variable> {
    let slots = [
        (
            "cmd.axle.velocity",
            Slot::Input(InputSlot::Velocity(0.into())),
            Kind::Real,
        ),
        (
            "cmd.axle.max_effort",
            Slot::Input(InputSlot::MaxEffort(0.into())),
            Kind::Real,
        ),
        (
            "base.position.z",
            Slot::Output(OutputSlot::BasePosition(RootId::ROBOT, 2)),
            Kind::Real,
        ),
        (
            "solver.steps",
            Slot::Output(OutputSlot::Steps),
            Kind::Integer,
        ),
        (
            "world.gravity.z",
            Slot::Parameter(ParameterSlot::Gravity(2)),
            Kind::Real,
        ),
        (
            "initial.base.position.z",
            Slot::Parameter(ParameterSlot::InitialBasePosition(RootId::ROBOT, 2)),
            Kind::Real,
        ),
        (
            "joint.axle.velocity",
            Slot::Output(OutputSlot::JointVelocity(0.into(), 0)),
            Kind::Real,
        ),
        (
            "solver.max_steps",
            Slot::Parameter(ParameterSlot::MaxSteps),
            Kind::Real,
        ),
        (
            "energy.kinetic",
            Slot::Output(OutputSlot::EnergyKinetic),
            Kind::Real,
        ),
    ];
    let row = |(index, (name, slot, kind)): (usize, (&str, Slot, Kind))| Variable {
        name: name.into(),
        value_reference: u32::try_from(index).expect("few"),
        description: String::new(),
        slot,
        kind,
        stepped: false,
        start: None,
        min: None,
        max: (name == "cmd.axle.velocity").then_some(100.0),
        unit: Unit::One,
        part: None,
        state: None,
        display: None,
        nominal: None,
    };
    slots.into_iter().enumerate().map(row).collect()
}

fn set(instance: &mut Instance, references: &[u32], values: &[f64]) -> Result<(), FmiError> {
    assert_eq!(references.len(), values.len());
    #[allow(unsafe_code, reason = "slices are valid arrays")]
    // SAFETY: slices are valid arrays.
    let (references, values) = unsafe {
        (
            In::new("vr", references.as_ptr(), references.len())?,
            In::new("value", values.as_ptr(), values.len())?,
        )
    };
    instance.set(Kind::Real, &references, &values, |x| x)
}

fn get(instance: &mut Instance, references: &[u32]) -> Result<Vec<f64>, FmiError> {
    let mut values = vec![0.0; references.len()];
    #[allow(unsafe_code, reason = "slices are valid arrays")]
    // SAFETY: slices are valid arrays.
    let (references, mut place) = unsafe {
        (
            In::new("vr", references.as_ptr(), references.len())?,
            Out::new("value", values.as_mut_ptr(), references.len())?,
        )
    };
    instance.get(Kind::Real, &references, &mut place, |x| x)?;
    Ok(values)
}

fn bits(instance: &mut Instance) -> Vec<u64> {
    let all = [
        WHEEL_VELOCITY,
        MAX_EFFORT,
        HEIGHT,
        GRAVITY,
        START_HEIGHT,
        WHEEL_SPEED,
    ];
    get(instance, &all)
        .expect("known")
        .into_iter()
        .map(f64::to_bits)
        .collect()
}

#[test]
fn a_set_call_with_one_bad_part_changes_nothing() {
    let mut instance = running();
    let before = bits(&mut instance);
    for (references, values) in [
        (vec![WHEEL_VELOCITY, 99], vec![3.0, 0.0]),
        (vec![WHEEL_VELOCITY, HEIGHT], vec![3.0, 0.0]),
        (vec![WHEEL_VELOCITY, STEPS], vec![3.0, 0.0]),
        (vec![WHEEL_VELOCITY, GRAVITY], vec![3.0, f64::NAN]),
        (vec![WHEEL_VELOCITY, MAX_EFFORT], vec![3.0, f64::INFINITY]),
        (vec![WHEEL_VELOCITY, MAX_EFFORT], vec![3.0, -1.0]),
        (vec![WHEEL_VELOCITY, START_HEIGHT], vec![3.0, 1.0]),
    ] {
        assert!(
            set(&mut instance, &references, &values).is_err(),
            "{references:?} {values:?}"
        );
        assert_eq!(bits(&mut instance), before, "{references:?} {values:?}");
    }
}

#[test]
fn messages_name_the_variable_and_what_is_legal() {
    let mut instance = running();
    let mut message = |reference, value| {
        set(&mut instance, &[reference], &[value])
            .expect_err("illegal")
            .to_string()
    };
    assert_eq!(
        message(MAX_EFFORT, -1.0),
        "variable 'cmd.axle.max_effort' must be a number from 0.0 to 1e30, not -1"
    );
    assert_eq!(
        message(STEPS, 1.0),
        "variable 'solver.steps' (value reference 3) is Integer, not Real"
    );
    assert_eq!(
        message(9, 1.0),
        "no variable has value reference 9; they run from 0 to 8"
    );
    assert_eq!(
        message(HEIGHT, 1.0),
        "output 'base.position.z' cannot be set"
    );
}

#[test]
fn fixed_parameters_can_be_set_until_initialisation_ends() {
    let mut instance = instance();
    set(&mut instance, &[START_HEIGHT], &[0.5]).expect("instantiated");
    assert_eq!(get(&mut instance, &[HEIGHT]), Ok(vec![0.5]));
    instance.enter_initialization_mode();
    set(&mut instance, &[START_HEIGHT], &[0.75]).expect("initialization mode");
    instance.exit_initialization_mode().expect("legal");
    assert_eq!(get(&mut instance, &[HEIGHT]), Ok(vec![0.75]));
    assert_eq!(
        set(&mut instance, &[START_HEIGHT], &[1.0]),
        Err(FmiError::Fixed {
            name: "initial.base.position.z".into(),
            fmi: Version::V2,
        })
    );
    set(&mut instance, &[GRAVITY], &[-1.62]).expect("tunable");
}

#[test]
fn values_outside_the_range_are_used() {
    let mut instance = running();
    // An importer's round-off is not worth a word.
    set(&mut instance, &[WHEEL_VELOCITY], &[100.0 + 2e-14]).expect("max is 100");
    assert!(!instance.range_logged[WHEEL_VELOCITY as usize]);
    set(&mut instance, &[WHEEL_VELOCITY], &[250.0]).expect("max is 100");
    assert_eq!(get(&mut instance, &[WHEEL_VELOCITY]), Ok(vec![250.0]));
    assert!(instance.range_logged[WHEEL_VELOCITY as usize]);
}

#[test]
fn steps_land_exactly_whatever_their_size() {
    let mut instance = running();
    for step in [1e-3, 1e-12, 1.0 / 3.0, 1e-9, 0.1] {
        let point = instance.last_successful_time();
        assert_eq!(instance.do_step(point, step), Ok(Status::OK));
        assert_eq!(instance.last_successful_time(), point + step);
    }
}

#[test]
fn a_step_below_the_resolution_of_time_succeeds_without_work() {
    let mut instance = running_from(1e6, None);
    // Doubles near 1e6 are 1.2e-10 apart.
    assert_eq!(instance.do_step(1e6, 1e-12), Ok(Status::OK));
    assert_eq!(instance.last_successful_time(), 1e6);
}

/// The independent variable begins at the start time.
#[test]
fn time_stands_at_the_start_from_the_beginning_of_the_initialisation_on() {
    const TIME: u32 = 9;
    let mut instance = instance_of(Version::V3);
    instance.setup_experiment(None, 3.0, None).expect("legal");
    instance.enter_initialization_mode();
    assert_eq!(get(&mut instance, &[TIME]), Ok(vec![3.0]));
    assert_eq!(instance.last_successful_time(), 3.0);
    set(&mut instance, &[START_HEIGHT], &[0.5]).expect("initialization mode");
    assert_eq!(get(&mut instance, &[TIME, HEIGHT]), Ok(vec![3.0, 0.5]));
    instance.exit_initialization_mode().expect("legal");
    assert_eq!(get(&mut instance, &[TIME]), Ok(vec![3.0]));
}

#[test]
fn the_beginning_of_a_step_may_jitter_but_not_jump() {
    let mut instance = running();
    instance.do_step(0.0, 1.0).expect("legal");
    for (point, legal) in [
        (1.0 + 1e-16, true),
        (1.0 + 0.9e-6, true),
        (1.0 - 0.9e-6, true),
        (1.0 + 1.2e-6, false),
        (0.0, false),
        (f64::NAN, false),
        (f64::INFINITY, false),
    ] {
        let state = instance.save();
        let result = instance.do_step(point, 1e-3);
        assert_eq!(result.is_ok(), legal, "{point}");
        if legal {
            assert_eq!(instance.last_successful_time(), point + 1e-3);
        }
        instance.restore(&state).expect("own state");
    }
}

#[test]
fn the_last_step_may_end_past_the_stop_time_but_none_begins_there() {
    let mut instance = running_from(0.0, Some(1.0));
    assert_eq!(instance.do_step(0.0, 0.7), Ok(Status::OK));
    assert_eq!(instance.do_step(0.7, 0.7), Ok(Status::OK));
    assert!(instance.overshoot_logged);
    assert!(matches!(
        instance.do_step(1.4, 0.7),
        Err(FmiError::StopTime { .. })
    ));
}

/// The rover falls 5 cm and drives off; nearer to a run at 1e-8 the smaller the tolerance, and at
/// the price of steps.
#[test]
fn the_tolerance_of_the_experiment_decides_accuracy_and_steps() {
    let drive = |tolerance: Option<f64>| {
        let mut instance = instance();
        instance
            .setup_experiment(tolerance, 0.0, None)
            .expect("legal");
        // Finer than what is taken from an importer, as the parameter would be.
        if let Some(finest) = tolerance.filter(|&tolerance| tolerance < 1e-6) {
            instance.simulation.set_importer_tolerance(finest);
        }
        instance.enter_initialization_mode();
        instance.exit_initialization_mode().expect("a legal rover");
        set(&mut instance, &[WHEEL_VELOCITY], &[5.0]).expect("legal");
        instance.do_step(0.0, 0.5).expect("finite");
        let state = instance.simulation.state();
        (state.physical.q.clone(), state.stepping.counters.steps)
    };
    let (reference, _) = drive(Some(1e-8));
    let off = |q: &[f64]| {
        let pairs = q[..3].iter().zip(&reference);
        pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
    };
    let runs = [1e-2, 1e-4, 1e-6].map(|tolerance| drive(Some(tolerance)));
    for ((coarse, few), (fine, many)) in runs.iter().zip(&runs[1..]) {
        assert!(off(fine) < off(coarse), "{:e} {:e}", off(fine), off(coarse));
        assert!(many > few, "{many} {few}");
    }
    let [coarsest, _, finest] = runs.map(|(q, _)| off(&q));
    assert!(
        finest < 0.01 * coarsest && finest < 1e-5,
        "{finest:e} {coarsest:e}"
    );
    // Without one, or with 0, it is 1e-3.
    assert_eq!(drive(None), drive(Some(1e-3)));
    assert_eq!(drive(Some(0.0)), drive(Some(1e-3)));
}

#[test]
fn a_saved_state_continues_bit_for_bit_in_another_instance() {
    let mut first = running();
    set(&mut first, &[WHEEL_VELOCITY, GRAVITY], &[5.0, -3.7]).expect("legal");
    first.do_step(0.0, 0.25).expect("legal");
    let bytes = first.save().to_bytes();
    first.do_step(0.25, 0.25).expect("legal");

    let mut second = instance();
    let state = SavedState::from_bytes(second.guid(), Version::V2, second.simulation(), &bytes)
        .expect("same FMU");
    second.restore(&state).expect("same FMU");
    second.do_step(0.25, 0.25).expect("legal");
    assert_eq!(bits(&mut second), bits(&mut first));
    assert!(get(&mut first, &[WHEEL_SPEED]).expect("known")[0] > 4.0);
}

#[test]
fn reset_gives_the_bits_of_a_new_instance() {
    let run = |instance: &mut Instance| {
        instance.enter_initialization_mode();
        instance.exit_initialization_mode().expect("legal");
        set(instance, &[WHEEL_VELOCITY], &[2.0]).expect("legal");
        instance.do_step(0.0, 0.5).expect("legal");
        bits(instance)
    };
    let fresh = run(&mut instance());
    let mut used = instance();
    used.setup_experiment(Some(1e-2), 3.0, Some(9.0))
        .expect("legal");
    set(&mut used, &[START_HEIGHT, GRAVITY], &[1.0, -1.0]).expect("legal");
    used.enter_initialization_mode();
    used.exit_initialization_mode().expect("legal");
    used.do_step(3.0, 0.5).expect("legal");
    used.reset();
    assert_eq!(run(&mut used), fresh);
}
