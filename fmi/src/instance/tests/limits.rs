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

/// Both versions share the rule. Times of steps are products here, and sums in the instance; stop
/// times are those of 240 and 1000 steps.
#[test]
fn steps_far_from_the_time_zero_are_as_legal_as_near_it() {
    for (start, count, step) in [
        (1.7e9, 240, 1.0 / 240.0),
        (1e6, 1000, 1e-3),
        (1e5, 1, 1e-4),
        (-1e10, 100, 0.01),
    ] {
        let stop = start + f64::from(count) * step;
        let mut instance = running_from(start, Some(stop));
        for k in 0..count {
            let point = start + f64::from(k) * step;
            assert_eq!(instance.do_step(point, step), Ok(Status::OK), "{start} {k}");
        }
        assert!(!instance.overshoot_logged, "{start}");
        assert!(matches!(
            instance.do_step(stop, step),
            Err(FmiError::StopTime { .. })
        ));
    }
}

#[test]
fn steps_far_from_the_time_zero_may_not_jump() {
    let mut instance = running_from(1.7e9, None);
    for point in [1.7e9 - 0.5, 1.7e9 - 1e-4, 1.7e9 + 1e-4, 1.7e9 + 0.5] {
        assert!(matches!(
            instance.do_step(point, 0.01),
            Err(FmiError::CommunicationPoint { .. })
        ));
    }
    assert_eq!(instance.do_step(1.7e9 + 5e-6, 0.01), Ok(Status::OK));
}

/// What is left to the stop time may be as short as round-off.
#[test]
fn a_step_that_ends_at_the_stop_time_is_legal_however_short() {
    let mut instance = running_from(0.0, Some(1.0));
    let almost = 1.0 - 2.0 * f64::EPSILON;
    assert_eq!(instance.do_step(0.0, almost), Ok(Status::OK));
    assert_eq!(instance.do_step(almost, 1.0 - almost), Ok(Status::OK));
    assert_eq!(instance.last_successful_time(), 1.0);
}

fn set_derivatives(instance: &mut Instance, references: &[u32], orders: &[i32], values: &[f64]) {
    #[allow(unsafe_code, reason = "slices are valid arrays")]
    // SAFETY: slices are valid arrays.
    let (references, orders, values) = unsafe {
        (
            In::new("vr", references.as_ptr(), references.len()).expect("an array"),
            In::new("order", orders.as_ptr(), orders.len()).expect("an array"),
            In::new("value", values.as_ptr(), values.len()).expect("an array"),
        )
    };
    let set = instance.set_input_derivatives(&references, &orders, &values);
    set.expect("legal");
}

/// `docs/interface.md`: commanded velocities are within ±1e5 rad/s.
#[test]
fn derivatives_take_no_input_out_of_its_range() {
    const ONE: &[u32] = &[WHEEL_VELOCITY];
    const TWO: &[u32] = &[WHEEL_VELOCITY; 2];
    for (references, orders, values) in [
        (ONE, [1, 0], [1e18, 0.0]),
        (ONE, [1, 0], [-1.01e7, 0.0]),
        // u = 4.1e7 t − 4.1e9 t² is 0 at the end, and 1.025e5 on the way.
        (TWO, [1, 2], [4.1e7, -8.2e9]),
        // u = 1.2e8 t − 1.2e12 t³ is 0 at the end, and 4.6e5 on the way.
        (TWO, [1, 3], [1.2e8, -7.2e12]),
    ] {
        let mut instance = running();
        let before = (instance.save(), bits(&mut instance));
        set_derivatives(
            &mut instance,
            references,
            &orders[..references.len()],
            &values[..references.len()],
        );
        assert_eq!(instance.do_step(0.0, 0.01), Ok(Status::Discard));
        assert_eq!(bits(&mut instance), before.1, "{values:?}");
        instance.restore(&before.0).expect("own state");
        assert!(set(&mut instance, &[WHEEL_VELOCITY], &[1e6]).is_err());
        assert_eq!(instance.do_step(0.0, 0.01), Ok(Status::OK));
    }
}

/// 0.1 · 3 is more than 0.3 by round-off, and 1e5 is the end of the range.
#[test]
fn a_ramp_may_end_at_the_end_of_its_range() {
    let mut instance = running();
    set(&mut instance, &[MAX_EFFORT], &[0.3]).expect("legal");
    let both = [MAX_EFFORT, WHEEL_VELOCITY];
    set_derivatives(&mut instance, &both, &[1, 1], &[-0.1 * 3.0 / 0.01, 1e7]);
    assert_eq!(instance.do_step(0.0, 0.01), Ok(Status::OK));
    let expected = vec![0.0, 1e5];
    assert_eq!(get(&mut instance, &both), Ok(expected));
    assert!(!instance.range_logged[MAX_EFFORT as usize]);
}

#[test]
fn a_limit_of_an_effort_stops_at_zero_with_a_warning() {
    let mut instance = running();
    set(&mut instance, &[MAX_EFFORT], &[1.0]).expect("legal");
    set_derivatives(&mut instance, &[MAX_EFFORT], &[1], &[-200.0]);
    assert_eq!(instance.do_step(0.0, 0.01), Ok(Status::OK));
    assert_eq!(get(&mut instance, &[MAX_EFFORT]), Ok(vec![0.0]));
    assert!(instance.range_logged[MAX_EFFORT as usize]);
    assert!(set(&mut instance, &[MAX_EFFORT], &[-1.0]).is_err());
}
