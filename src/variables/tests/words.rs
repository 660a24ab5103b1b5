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
