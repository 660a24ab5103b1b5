//! A sample of the campaign of docs/robustness.md: no drop fails, and no passive robot gains
//! energy.

use super::campaign::{DRY_DEFLECTION, Drop, Extreme, Ledger, Tally, drop_once, stored};
use super::robots::robot;
use super::*;

/// Drops each of our robots with everything about it driven to its extreme.
fn sample(extreme: Extreme, seeds: u64, allowed: Option<[[f64; 3]; 2]>) {
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
    if let Some(allowed) = allowed {
        hold_gains(extreme.name(), &tally, allowed);
    }
}

/// Holds what limp robots have gained under error control and in fixed steps to shares of what they
/// fell with: in all, over the lowest before, and that with all that friction has in store.
fn hold_gains(who: &str, tally: &Tally, allowed: [[f64; 3]; 2]) {
    let kinds = ["error control", "fixed steps"].iter().zip(&tally.limp);
    // A kind without a drop shows nothing.
    let kinds = kinds.zip(allowed).filter(|((_, gain), _)| gain.drops > 0);
    for ((steps, gain), allowed) in kinds {
        let what = |what: &str| format!("{what}, {} limp drops, {who}, {steps}", gain.drops);
        let share = gain.gained.share;
        hold(
            "D8",
            &what("energy gained in all"),
            "none",
            share,
            allowed[0],
        );
        let share = gain.risen.share;
        let risen = what("energy over the lowest before");
        hold("D8", &risen, "none", share, allowed[1]);
        // In fixed steps an impact may leave energy in friction that was not paid for; none of it
        // comes back.
        if *steps == "error control" {
            let raw = what("the same with all that friction has in store");
            hold("D8", &raw, "none", gain.raw.share, allowed[2]);
        }
    }
}

macro_rules! samples {
    ($($(#[$doc:meta])* $name:ident: $extreme:ident, $seeds:expr, $allowed:expr;)*) => {$(
        $(#[$doc])*
        #[test]
        fn $name() {
            sample(Extreme::$extreme, $seeds, $allowed);
        }
    )*};
}

// Of a limp robot, motors without limit and stiff gains are switched off: its drops are those of
// the robot as it is.
samples! {
    unmodified_robots_fall_without_a_failure: None, 8, Some([[5e-10, 5e-10, 5e-9], [0.0, 0.0, 0.0]]);
    robots_with_masses_over_six_decades_fall_without_a_failure: MassRatio, 8, Some([[2e-4, 1.5e-4, 1.5e-4], [0.0, 0.0, 0.0]]);
    robots_with_stiff_unlimited_gains_fall_without_a_failure: StiffGains, 8, None;
    robots_that_begin_in_the_ground_move_without_a_failure: Overlap, 8, Some([[1e-12, 1e-12, 1e-9], [1e-9, 1e-9, 1e-9]]);
    robots_with_shapes_without_size_fall_without_a_failure: Points, 8, Some([[2e-6, 2e-6, 2e-6], [5e-5, 5e-5, 0.0]]);
    robots_with_shapes_a_thousand_times_as_large_fall_without_a_failure: Huge, 8, Some([[6e-11, 6e-11, 6e-11], [0.0, 0.0, 0.0]]);
    robots_without_gravity_move_without_a_failure: NoGravity, 8, Some([[9e-10, 9e-10, 4e-8], [1e-4, 1e-4, 0.0]]);
    robots_with_motors_without_limit_fall_without_a_failure: LimitlessEffort, 8, None;
    robots_without_friction_fall_without_a_failure: NoFriction, 8, Some([[4e-6, 4e-6, 4e-6], [0.0, 0.0, 0.0]]);
    robots_with_friction_of_a_million_fall_without_a_failure: HugeFriction, 8, Some([[7e-6, 7e-6, 2e-4], [0.0, 0.0, 0.0]]);
    robots_with_restitution_1_bounce_without_a_failure: Bouncing, 2, Some([[5e-10, 5e-10, 9e-10], [3e-5, 3e-5, 0.0]]);
    robots_fall_without_a_failure_at_any_communication_step: AnyStep, 8, Some([[9e-9, 9e-9, 3e-7], [0.0, 0.0, 0.0]]);
}

/// D8. Robots that fall limp and whirl, many times over, in fixed steps and under error control:
/// impacts on limits, legs that slide and spin without friction, links of grams on links of tonnes.
#[test]
fn limp_robots_gain_no_energy_in_many_falls() {
    for (path, extreme, allowed) in [
        (
            "examples/arm.urdf",
            Extreme::None,
            [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        ),
        (
            "examples/arm.urdf",
            Extreme::MassRatio,
            [[2e-4, 1.5e-4, 1.5e-4], [1.5e-4, 7e-5, 0.0]],
        ),
        (
            "examples/quadruped.urdf",
            Extreme::None,
            [[0.0, 0.0, 7e-9], [0.0, 0.0, 0.0]],
        ),
        (
            "examples/quadruped.urdf",
            Extreme::NoFriction,
            [[8e-6, 8e-6, 8e-6], [2e-6, 2e-6, 0.0]],
        ),
        (
            "examples/quadruped.urdf",
            Extreme::MassRatio,
            [[2e-4, 2e-4, 2e-4], [6e-4, 6e-4, 0.0]],
        ),
    ] {
        let model = robot(path, |_| {});
        let mut tally = Tally::default();
        for seed in (0..96).step_by(2) {
            drop_once(&model, extreme, seed, &mut tally);
        }
        assert!(tally.failures.is_empty(), "{:?}", tally.failures);
        let who = format!("{}, {}", model.name, extreme.name());
        hold_gains(&who, &tally, allowed);
    }
}

/// What begins in the ground is thrown out of it so fast that some contacts push no more within a
/// step, while their load of its start still damps how they rock. The step is convex: Newton finds
/// its minimum, and does not give up, at 50 iterations, on a solve that it takes to and fro.
#[test]
fn no_solve_gives_up_where_robots_begin_in_the_ground() {
    for (path, seed) in [("rover", 1), ("quadruped", 1), ("quadruped", 8)] {
        let model = robot(&format!("examples/{path}.urdf"), |_| {});
        let mut drop = Drop::new(&model, Extreme::Overlap, seed).expect("a drop");
        while drop.goes_on() {
            assert!(drop.advance());
        }
        let most = drop.s.state().stepping.counters.newton_max;
        assert!(most < 50, "{path}, seed {seed}: {most} iterations");
    }
}

/// The ledger can fail at any time: what a limp quadruped is given after any communication step,
/// about a thousandth of what it falls with, is entered but for what friction elements hold just
/// then.
#[test]
fn the_ledger_records_energy_added_at_any_time_of_a_drop() {
    let model = robot("examples/quadruped.urdf", |_| {});
    for (extreme, allowed) in [
        (Extreme::None, 4e-3),
        (Extreme::NoFriction, 7e-6),
        (Extreme::HugeFriction, 5e-2),
    ] {
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
                s.state_mut().physical.v[5] += kick;
                if s.output(OutputSlot::EnergyKinetic) < before {
                    s.state_mut().physical.v[5] -= 2.0 * kick;
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
        hold("D8", &what, "few", 1.0 - entered / given, allowed);
    }
}

/// What the ledger takes for the energy of springs is what a bounce without losses borrows and
/// gives back: kinetic energy, height and springs together stay what they were, whatever the shape
/// and however it is tilted.
#[test]
fn what_springs_hold_is_what_a_lossless_bounce_gives_back() {
    let cylinder = |half_length| Shape::Cylinder {
        radius: 0.1,
        half_length,
    };
    let half = Vec3::new(0.1, 0.1, 0.1);
    let capsule = Shape::Capsule {
        radius: 0.05,
        half_length: 0.1,
    };
    for (name, shape, tilt, allowed) in [
        ("a ball", Shape::Sphere { radius: 0.1 }, 0.0, 4e-4),
        ("a tilted box", Shape::Box { half }, 0.1, 2e-4),
        ("a lying capsule", capsule, 1.5, 1e-4),
        ("a can on its edge", cylinder(0.15), 0.5, 3e-4),
        ("a can between edge and end", cylinder(0.15), 0.1, 1e-4),
        ("a lying can", cylinder(0.15), 1.55, 5e-5),
    ] {
        let mut b = single(1.0, [4e-3; 3], shape, 0.0);
        b.model.contact.dissipation = 0.0;
        b.model.roots[0].rpy.x = tilt;
        b.model.roots[0].position.z = 0.3;
        let mut s = start(b.model, 1e-6);
        let mut ledger = Ledger::new(&mut s);
        let before = ledger.moving();
        let (mut off, mut springs) = (0.0_f64, 0.0_f64);
        for i in 1..=5000 {
            s.advance_to(1e-4 * f64::from(i)).expect("finite");
            ledger.add(&mut s);
            off = off.max((ledger.moving() - before).abs() / ledger.scale);
            springs = springs.max(stored(&s)[0] / ledger.scale);
        }
        assert!(springs > 0.1, "{name} does not bounce: {springs}");
        let what = format!("energy of {name} that bounces without losses, relative, tol 1e-6");
        hold("D8", &what, "constant", off, allowed);
    }
}

/// The deflection of dry friction that the ledger takes for granted: half the effort, half the
/// deflection.
#[test]
fn dry_friction_is_a_spring_until_it_slips() {
    let mut b = fixed();
    let body = inertia(1.0, Vec3::zeros(), [1e-3; 3]);
    let link = b.link(BASE, Pose::IDENTITY, Motion::Prismatic(X), body);
    b.actuator(link, ActuatorMode::Effort, 10.0);
    b.model.joints[0].friction = 2.0;
    let mut s = start(b.model, 1e-4);
    s.set_input(InputSlot::Effort(ActuatorId(0)), 1.0);
    run(&mut s, 2.0, 0.01);
    let error = s.state().physical.q[0] / (0.5 * DRY_DEFLECTION) - 1.0;
    let what = "deflection of dry friction of 2 N under 1 N, relative";
    hold("D8", what, "half of 0.1 mm", error, 3e-8);
}
