//! Partial derivatives: by what, along what, and at the ends of ranges.

use super::*;

const EFFORT: u32 = 9;

/// In initialization mode, with the effort of the wheel as one output more.
fn initializing() -> Instance {
    let mut rows = rows();
    rows.push(Variable {
        name: "joint.axle.effort".into(),
        value_reference: EFFORT,
        slot: Slot::Output(OutputSlot::JointEffort(0.into())),
        ..rows[HEIGHT as usize].clone()
    });
    let mut instance = instance_with(Version::V3, rows);
    instance.enter_initialization_mode();
    instance
}

fn derivative(
    instance: &mut Instance,
    unknown: u32,
    knowns: &[u32],
    seeds: &[f64],
) -> Result<f64, FmiError> {
    let mut found = [f64::NAN];
    #[allow(unsafe_code, reason = "slices are valid arrays")]
    // SAFETY: slices are valid arrays.
    let (unknowns, knowns, seeds, mut place) = unsafe {
        (
            In::new("unknowns", &raw const unknown, 1)?,
            In::new("knowns", knowns.as_ptr(), knowns.len())?,
            In::new("seed", seeds.as_ptr(), seeds.len())?,
            Out::new("sensitivity", found.as_mut_ptr(), 1)?,
        )
    };
    instance.directional_derivative(&unknowns, &knowns, &seeds, &mut place)?;
    Ok(found[0])
}

#[test]
fn in_initialization_mode_they_are_by_parameters_and_nothing_changes() {
    let mut instance = initializing();
    let before = bits(&mut instance);
    let found = derivative(&mut instance, HEIGHT, &[START_HEIGHT], &[2.0]).expect("a known");
    assert!((found - 2.0).abs() < 1e-8, "{found}");
    assert_eq!(bits(&mut instance), before);
    let mut instance = running();
    let error = derivative(&mut instance, HEIGHT, &[START_HEIGHT], &[1.0]);
    assert!(matches!(error, Err(FmiError::NotKnown { .. })), "{error:?}");
}

#[test]
fn a_known_that_is_named_twice_goes_by_both_seeds() {
    let mut instance = initializing();
    let knowns = [START_HEIGHT, WHEEL_VELOCITY, START_HEIGHT];
    let found = derivative(&mut instance, HEIGHT, &knowns, &[1.0, 0.0, 3.0]).expect("knowns");
    assert!((found - 4.0).abs() < 1e-8, "{found}");
    let found = derivative(&mut instance, HEIGHT, &knowns, &[1.0, 0.0, -1.0]).expect("knowns");
    assert_eq!(found, 0.0);
}

/// A motor that is to turn faster than it can drives with all that it has, and with nothing if it
/// has nothing: negative efforts are none.
#[test]
fn at_the_end_of_a_range_they_are_one_sided() {
    let mut instance = initializing();
    set(
        &mut instance,
        &[WHEEL_VELOCITY, MAX_EFFORT, START_HEIGHT],
        &[50.0, 0.0, 1.0],
    )
    .expect("legal");
    let before = bits(&mut instance);
    for (knowns, seeds, expected) in [
        (vec![MAX_EFFORT], vec![1.0], 1.0),
        (vec![MAX_EFFORT], vec![-2.0], -2.0),
        (vec![MAX_EFFORT, START_HEIGHT], vec![1.0, 1.0], 1.0),
    ] {
        let found = derivative(&mut instance, EFFORT, &knowns, &seeds).expect("knowns");
        assert!((found - expected).abs() < 1e-6, "{knowns:?}: {found}");
    }
    assert_eq!(bits(&mut instance), before);
}
