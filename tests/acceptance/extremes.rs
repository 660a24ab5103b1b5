//! A sample of the campaign of docs/robustness.md: nothing fails, and nothing passive gains energy.

use super::campaign::{Drop, Extreme, Ledger, Tally, drop_once};
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
    hold_gains(extreme.name(), &tally, [1e-3, 1e-3]);
}

/// Holds what limp robots have gained under error control and in fixed steps to shares of what they fell with.
fn hold_gains(who: &str, tally: &Tally, allowed: [f64; 2]) {
    let kinds = ["error control", "fixed steps"].iter().zip(&tally.limp);
    for ((steps, gain), allowed) in kinds.zip(allowed) {
        let what = |what: &str| format!("{what}, {} limp drops, {who}, {steps}", gain.drops);
        let share = gain.gained.share;
        hold("D8", &what("energy gained in all"), "none", share, allowed);
        let share = gain.risen.share;
        let risen = what("energy over the lowest before");
        hold("D8", &risen, "none", share, allowed);
        // In fixed steps an impact may leave in friction what nobody has paid for; nothing of it comes back.
        if *steps == "error control" {
            let raw = what("the same with all that friction has in store");
            hold("D8", &raw, "none", gain.raw.share, allowed);
        }
    }
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
        // The tolerance is one of places and speeds: where the tip weighs a thousand times what the rest does, an error of its
        // speed within the tolerance is that much more energy.
        let controlled = if extreme == Extreme::MassRatio {
            1e-2
        } else {
            1e-3
        };
        let who = format!("{}, {}", model.name, extreme.name());
        hold_gains(&who, &tally, [controlled, 1e-3]);
    }
}

/// The ledger can fail at any time: what a limp quadruped is given after any communication step, about a thousandth of what it
/// falls with, is entered but for what friction elements hold just then.
#[test]
fn the_ledger_enters_what_is_given_at_any_time_of_a_drop() {
    let model = robot("examples/quadruped.urdf", |_| {});
    for extreme in [Extreme::None, Extreme::NoFriction, Extreme::HugeFriction] {
        let (mut given, mut entered) = (0.0, 0.0);
        for seed in (0..16).step_by(2) {
            let mut drop = Drop::new(&model, extreme, seed).expect("a drop");
            let mut ledger = Ledger::new(&mut drop.s);
            while drop.goes_on() {
                assert!(drop.advance());
                let s = &mut drop.s;
                ledger.add(s);
                let mut with = ledger.clone();
                let (kept, before) = (s.save(), s.output(OutputSlot::EnergyKinetic));
                // Up or down, whichever makes it faster.
                let kick = (2e-3 * ledger.scale / s.tree().moving_mass()).sqrt();
                s.state_mut().v[5] += kick;
                if s.output(OutputSlot::EnergyKinetic) < before {
                    s.state_mut().v[5] -= 2.0 * kick;
                }
                given += (s.output(OutputSlot::EnergyKinetic) - before) / ledger.scale;
                with.add(s);
                s.restore(&kept).expect("its own state");
                entered += with.gained - ledger.gained;
            }
        }
        let what = format!(
            "what is given to a limp quadruped but not entered as a gain, share, {}",
            extreme.name()
        );
        hold("D8", &what, "few", 1.0 - entered / given, 5e-2);
    }
}
