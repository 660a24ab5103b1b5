//! What an instance tells the importer, word by word and how often.

use super::*;
use crate::instance::FINEST_TOLERANCE;
use std::ffi::{CStr, c_char, c_void};

/// A logger of an importer that keeps what it hears.
#[allow(unsafe_code, reason = "an importer's function")]
pub(super) unsafe extern "C" fn keep(
    heard: *mut c_void,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: `heard` is the list that `listened` keeps while the instance lives; both texts end
    // with a zero.
    let (heard, category, message) = unsafe {
        let heard = &mut *heard.cast::<Vec<String>>();
        (heard, CStr::from_ptr(category), CStr::from_ptr(message))
    };
    let [category, message] = [category, message].map(|text| text.to_string_lossy().into_owned());
    heard.push(format!("{status:?} {category} {message}"));
}

/// What an importer hears while `calls` are made, with debug logging off.
fn heard(calls: impl FnOnce(&mut Instance)) -> Vec<String> {
    let mut heard: Vec<String> = Vec::new();
    let mut instance = instance();
    let list = std::ptr::from_mut(&mut heard).cast();
    instance.logger = Logger::new(Sink::Fmi3(keep), list, false);
    calls(&mut instance);
    drop(instance);
    heard
}

/// The wheel of 0.1 m is 0.2 m below the base, so that its lowest point is 0.3 m below it. At 9500
/// times the penetration the law of docs/design.md gives, with its slope kept from 30 on,
/// `(30 (1 + 30³) + 9470 (1 + 4·30³)) 16/9` weights.
#[test]
fn a_start_in_the_ground_is_told_with_its_depth() {
    for (height, told) in [(1.35, None), (0.3, None), (-0.65, Some("950.000"))] {
        let said = heard(|instance| {
            instance.enter_initialization_mode();
            set(instance, &[START_HEIGHT], &[height]).expect("legal");
            instance.exit_initialization_mode().expect("legal");
            instance.do_step(0.0, 0.01).expect("finite");
        });
        let expected = told.map(|depth| {
            format!(
                "Warning logStatusWarning the start is {depth} mm inside the ground, with link \
                 'wheel': contacts will push it out, at first with 1819696889 times its weight; \
                 raise initial.base.position.z or set initial.joint.*.position"
            )
        });
        assert_eq!(said, Vec::from_iter(expected), "{height}");
    }
    // As a parameter of the joint may say it: a fall of half a metre more is told in full.
    let depth = |height: f64| {
        let mut instance = instance();
        instance.enter_initialization_mode();
        set(&mut instance, &[START_HEIGHT], &[height]).expect("legal");
        instance.exit_initialization_mode().expect("legal");
        let deepest = instance.simulation.deepest_in_ground();
        deepest.expect("in the ground").1[0]
    };
    assert!((depth(-0.65) - 0.95).abs() < 1e-12 && (depth(-1.15) - 1.45).abs() < 1e-12);
}

/// The model with the rover as an object whose height has another name.
#[test]
fn an_object_in_the_ground_is_told_with_its_own_height() {
    let mut instance = instance();
    let mut model = (*instance.model).clone();
    model.roots[0].kind = urdf2fmu_core::model::RootKind::Object;
    instance.model = std::sync::Arc::new(model);
    for row in &mut instance.variables {
        if row.name == "initial.base.position.z" {
            "initial.object.crate.position.z".clone_into(&mut row.name);
        }
    }
    assert_eq!(instance.way_up("wheel"), "initial.object.crate.position.z");
}

/// An importer's tolerance for all of its units costs ten times the steps for each decade.
#[test]
fn a_tolerance_finer_than_the_contacts_is_raised_and_said_once() {
    assert_eq!(FINEST_TOLERANCE.to_bits(), 1e-6_f64.to_bits());
    for (asked, taken, told) in [
        (1e-3, 1e-3, None),
        (1e-6, 1e-6, None),
        (1e-10, 1e-6, Some("the tolerance 1e-10 is taken as 1e-6")),
        (0.0, 0.0, None),
        (7.0, 1.0, Some("the tolerance 7e0 is taken as 1e0")),
    ] {
        let said = heard(|instance| {
            instance
                .setup_experiment(Some(asked), 0.0, None)
                .expect("legal");
            assert_eq!(
                instance.experiment.tolerance.to_bits(),
                f64::to_bits(taken),
                "{asked}"
            );
            instance.enter_initialization_mode();
            instance.exit_initialization_mode().expect("legal");
            for step in 0..3 {
                instance
                    .do_step(0.01 * f64::from(step), 0.01)
                    .expect("finite");
            }
        });
        let expected = told.map(|told| {
            format!(
                "Warning logStatusWarning fmi2SetupExperiment: {told}; the parameter \
                 solver.tolerance takes any down to 1e-12"
            )
        });
        assert_eq!(said, Vec::from_iter(expected), "{asked}");
    }
}

/// What the limit does with it is measured in `tests/python/test_package_careless.py`.
#[test]
fn a_start_beyond_a_limit_is_told_with_what_becomes_of_it() {
    for (slot, told) in [
        (ParameterSlot::InitialJointPosition(0.into()), true),
        (ParameterSlot::InitialBasePosition(RootId::ROBOT, 2), false),
    ] {
        let said = heard(|instance| {
            let row = &mut instance.variables[START_HEIGHT as usize];
            (row.slot, row.max) = (Slot::Parameter(slot), Some(1.0));
            instance.enter_initialization_mode();
            set(instance, &[START_HEIGHT], &[1.5]).expect("legal");
        });
        let [said] = &said[..] else {
            panic!("{said:?}")
        };
        assert!(said.contains("outside its range"), "{said}");
        assert_eq!(
            said.contains("back slowly, by 0.02 rad or m a second"),
            told,
            "{said}"
        );
    }
}
