//! What an instance refuses: numbers out of range, too much work, results that are no numbers.

use super::*;
use urdf2fmu_core::range::MOST_STEPS;

#[test]
fn a_step_that_takes_too_much_work_is_discarded_and_changes_nothing() {
    let run = |first_try: bool| {
        let mut instance = running();
        set(&mut instance, &[WHEEL_VELOCITY], &[3.0]).expect("legal");
        let before = (instance.save(), bits(&mut instance));
        if first_try {
            set(&mut instance, &[MAX_STEPS], &[3.0]).expect("tunable");
            assert_eq!(instance.do_step(0.0, 0.5), Ok(Status::Discard));
            assert_eq!(instance.do_step_status(), Status::Discard);
            assert_eq!(instance.last_successful_time(), 0.0);
            assert_eq!(bits(&mut instance), before.1);
            instance.restore(&before.0).expect("own state");
            assert_eq!(get(&mut instance, &[MAX_STEPS]), Ok(vec![MOST_STEPS]));
        }
        assert_eq!(instance.do_step(0.0, 0.5), Ok(Status::OK));
        bits(&mut instance)
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn a_step_that_takes_too_much_work_says_what_to_change() {
    let mut instance = running();
    set(&mut instance, &[MAX_STEPS], &[3.0]).expect("tunable");
    let error = instance.simulation.advance_to(0.5).expect_err("four tries");
    let message = error.to_string();
    assert!(
        message.contains("more than 3 tries") && message.contains("solver.max_steps"),
        "{message}"
    );
}

#[test]
fn an_output_that_is_not_finite_is_never_ok() {
    let mut instance = running();
    instance.simulation.state_mut().physical.v[0] = 1e200;
    let result = get(&mut instance, &[KINETIC_ENERGY]);
    let name = "energy.kinetic".into();
    assert_eq!(result, Err(FmiError::NotFinite { name }));
    assert_eq!(result.expect_err("above").status(), Status::Discard);
}

#[test]
fn numbers_out_of_range_are_refused_where_they_are_set() {
    let mut instance = instance();
    for (reference, value) in [
        (GRAVITY, -1e12),
        (GRAVITY, f64::MAX),
        (START_HEIGHT, 1e160),
        (WHEEL_VELOCITY, 1e160),
        (MAX_EFFORT, 1e300),
        (MAX_STEPS, 0.0),
    ] {
        let result = set(&mut instance, &[reference], &[value]);
        assert!(
            matches!(result, Err(FmiError::Value { .. })),
            "{reference} {value}"
        );
    }
    for start in [1e300, f64::INFINITY] {
        assert!(instance.setup_experiment(None, start, None).is_err());
    }
}

#[test]
fn illegal_step_sizes_are_refused() {
    let mut instance = running();
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        assert!(
            matches!(instance.do_step(0.0, step), Err(FmiError::Argument { .. })),
            "{step}"
        );
        assert_eq!(instance.last_successful_time(), 0.0);
    }
}

#[test]
fn illegal_arguments_of_setup_experiment_are_refused() {
    let mut instance = instance();
    assert!(instance.setup_experiment(None, f64::NAN, None).is_err());
    assert!(
        instance
            .setup_experiment(None, 0.0, Some(f64::NAN))
            .is_err()
    );
    assert!(instance.setup_experiment(None, 1.0, Some(0.5)).is_err());
    assert!(instance.setup_experiment(Some(-1.0), 0.0, None).is_err());
    assert!(
        instance
            .setup_experiment(Some(f64::NAN), 0.0, None)
            .is_err()
    );
    assert!(
        instance
            .setup_experiment(Some(1e-4), -5.0, Some(f64::INFINITY))
            .is_ok()
    );
}
