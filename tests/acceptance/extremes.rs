//! A sample of the campaign of docs/robustness.md: nothing fails, and nothing passive gains energy.

use super::campaign::{Extreme, Tally, drop_once};
use super::robots::robot;
use super::*;

/// Drops each of our robots with everything about it driven to its extreme.
fn sample(extreme: Extreme, seeds: u64) {
    let mut tally = Tally::default();
    for (path, offset) in [
        ("examples/rover.urdf", 0),
        ("examples/quadruped.urdf", 1),
        ("examples/arm.urdf", 2),
        ("tests/robots/humanoid.urdf", 3),
    ] {
        let model = robot(path, |_| {});
        // The largest costs as much as the others together.
        let seeds = if model.nv() > 50 { seeds / 4 } else { seeds };
        for seed in 0..seeds {
            drop_once(&model, extreme, offset + seed, &mut tally);
        }
    }
    let drops = tally.drops;
    assert!(tally.failures.is_empty(), "{:?}", tally.failures);
    let what = |what: &str| format!("{what}, {drops} drops, {}", extreme.name());
    hold("D7", &what("failed"), "0", f64::from(tally.failed), 0.0);
    let [controlled, fixed] = tally.gained;
    hold(
        "D8",
        &what("energy gained by the limp ones"),
        "≤ ΣF̄²/2k_t",
        controlled,
        1e-3,
    );
    hold(
        "D8",
        &what("energy gained in fixed steps"),
        "≤ ΣF̄²/2k_t",
        fixed,
        1e-3,
    );
}

macro_rules! samples {
    ($($(#[$doc:meta])* $name:ident: $extreme:ident, $seeds:expr;)*) => {$(
        $(#[$doc])*
        #[test]
        fn $name() {
            sample(Extreme::$extreme, $seeds);
        }
    )*};
}

samples! {
    robots_as_they_are_fall_and_lie: None, 8;
    masses_over_six_decades_do_not_break_a_robot: MassRatio, 8;
    stiff_unlimited_gains_do_not_break_a_robot: StiffGains, 8;
    a_robot_that_begins_in_the_ground_comes_out_whole: Overlap, 8;
    shapes_without_size_are_points: Points, 8;
    shapes_a_thousand_times_as_large_are_shapes: Huge, 8;
    a_robot_lives_without_gravity: NoGravity, 8;
    a_motor_without_limit_is_one: LimitlessEffort, 8;
    a_robot_lives_without_friction: NoFriction, 8;
    any_friction_is_enough: HugeFriction, 8;
    a_robot_may_bounce_for_ever: Bouncing, 8;
    communication_steps_of_a_nanosecond_and_of_a_second_both_end: AnyStep, 8;
}

/// D8. Robots that fall limp and whirl, many times over, in fixed steps and under error control: impacts on limits, legs that
/// slide and spin without friction, links of grams on links of tonnes.
#[test]
fn limp_robots_make_no_energy_however_often_they_fall() {
    for (path, extreme) in [
        ("examples/arm.urdf", Extreme::None),
        ("examples/arm.urdf", Extreme::MassRatio),
        ("examples/quadruped.urdf", Extreme::None),
        ("examples/quadruped.urdf", Extreme::NoFriction),
        ("examples/quadruped.urdf", Extreme::MassRatio),
    ] {
        let model = robot(path, |_| {});
        let mut tally = Tally::default();
        for seed in (0..96).step_by(2) {
            drop_once(&model, extreme, seed, &mut tally);
        }
        assert!(tally.failures.is_empty(), "{:?}", tally.failures);
        for (steps, gained) in ["error control", "fixed steps"].iter().zip(tally.gained) {
            let (name, what) = (&model.name, extreme.name());
            // The tolerance is one of places and speeds: where the tip weighs a thousand times what the rest does, an error
            // of its speed within the tolerance is that much more energy.
            let heavy_tip = extreme == Extreme::MassRatio && *steps == "error control";
            let allowed = if heavy_tip { 1e-2 } else { 1e-3 };
            let quantity =
                format!("energy gained by {name}, limp, {what}, most of 48 drops, {steps}");
            hold("D8", &quantity, "≤ ΣF̄²/2k_t", gained, allowed);
        }
    }
}
