//! What the table says of variables beside their values.

use super::*;

/// The cart has 7.1 kg, which weigh 69.6 N.
#[test]
fn variables_say_whose_they_are_how_large_and_what_people_read_them_in() {
    let table = table_of(&cart(), "");
    let of = |name: &str| {
        let v = get(&table, name);
        (v.causality(), v.display, v.nominal)
    };
    let (output, turns) = (Causality::Output, Some(Display::TurnPerMinute));
    assert_eq!(of("solver.steps"), (Causality::Local, None, None));
    assert_eq!(of("energy.kinetic"), (output, None, Some(70.0)));
    assert_eq!(of("joint.lift.effort"), (output, None, Some(70.0)));
    assert_eq!(of("joint.left_wheel.velocity"), (output, turns, None));
    assert_eq!(of("joint.grip.velocity").1, Some(Display::DegreePerSecond));
}

/// Robots of `SolidWorks` and others have the names of their parts, in any alphabet.
#[test]
fn names_in_other_alphabets_stay_apart() {
    let description = robot(body("底座", 5.0))
        .with(
            "底座",
            "关节",
            Continuous,
            at(0.0, 0.2, 0.0),
            body("手臂", 1.0),
        )
        .with(
            "手臂",
            "手腕",
            Continuous,
            at(0.0, 0.2, 0.0),
            body("手掌", 1.0),
        );
    let table = table_of(&description, "");
    assert!(find(&table, "cmd._5173_8282.velocity").is_some());
    assert!(find(&table, "contact._624b_81c2.active").is_some());
}
