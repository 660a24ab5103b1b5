//! What moves far faster together than any joint or spring alone.

use super::worlds::world;
use super::*;
use crate::closure::testing::anchor;
use crate::model::Spring;

const STEPS: [(f64, f64); 4] = [
    (1e-3, 0.0),
    (1e-3, 1.0 / 240.0),
    (1e-3, 1.0 / 500.0),
    (1e-3, 1e-3),
];

/// Rods that hang on each other on parallel hinges, each with the mass and length, turned by so
/// much against the one before.
fn chain(count: usize, [mass, length, turned]: [f64; 3]) -> (Builder, Vec<LinkId>) {
    let mut b = Builder::new(false, RigidInertia::ZERO);
    let own = mass * length * length / 12.0;
    let (mut links, mut parent, mut place) = (Vec::new(), LinkId(0), Pose::IDENTITY);
    for _ in 0..count {
        let rod = inertia(mass, Vec3::z() * (-0.5 * length), [own; 3]);
        parent = b.link(parent, place, Motion::Revolute(Vec3::y()), rod);
        place = at(0.0, 0.0, -length);
        links.push(parent);
    }
    b.model.initial.joint_positions = vec![turned; count];
    (b, links)
}

/// Six rods of 3 kg in space, whose laws are critically damped at 20 rad/s for all that hangs on
/// each joint while the joints do not move against each other. Where they do, damping is 2000/s and
/// more. No joint turns by more than the energy allows that they begin with, and all end where
/// they are held. Explicit steps that looked at each joint alone
/// came to 3 rad, and took 39,000 steps in 3 s under error control.
#[test]
fn a_chain_that_pd_laws_hold_is_still_in_steps_of_any_length() {
    let (count, mass, length) = (6, 3.0, 0.25);
    for (tolerance, step) in STEPS {
        let (mut b, links) = chain(count, [mass, length, 0.0]);
        b.model.initial.joint_velocities = vec![0.02; count];
        b.model.world.gravity = Vec3::zeros();
        b.model.solver.step_size = step;
        let mut stiff = Vec::new();
        for (k, link) in links.iter().enumerate() {
            // What hangs on the joint, stretched: a rod of n masses and lengths about its end.
            let n = (count - k) as f64;
            let behind = n * mass * (n * length) * (n * length) / 3.0;
            b.actuator(*link, ActuatorMode::Pd, 1e6);
            b.model.actuators[k].kp = 400.0 * behind;
            b.model.actuators[k].kd = 40.0 * behind;
            stiff.push(400.0 * behind);
        }
        let mut s = start(b.model, tolerance);
        let given = s.output(OutputSlot::EnergyKinetic);
        for _ in 0..960 {
            let now = s.time();
            run(&mut s, now + 1.0 / 240.0, 1.0 / 240.0);
            for (q, kp) in s.state().physical.q.iter().zip(&stiff) {
                assert!(0.5 * kp * q * q < given, "{step}: {q} rad");
            }
        }
        let far = s
            .state()
            .physical
            .q
            .iter()
            .fold(0.0_f64, |far, q| far.max(q.abs()));
        assert!(far < 1e-6, "{step}: {far:e} rad");
        let steps = s.state().stepping.counters.steps;
        assert!(step > 0.0 || steps < 500, "{steps} steps");
    }
}

/// Twelve rods of 0.1 kg hang on hinges with so much damping that what moves joints against each
/// other is stopped within less than a step. Damping makes no energy.
#[test]
fn a_damped_chain_stays_where_it_hangs_in_fixed_steps() {
    for damping in [0.01, 0.05, 0.2] {
        for (tolerance, step) in STEPS {
            let (mut b, _) = chain(12, [0.1, 0.1, 1e-4]);
            for joint in &mut b.model.joints {
                joint.damping = damping;
            }
            b.model.solver.step_size = step;
            let mut s = start(b.model, tolerance);
            let whole = |s: &mut Simulation| {
                s.output(OutputSlot::EnergyKinetic) + s.output(OutputSlot::EnergyPotential)
            };
            let before = whole(&mut s);
            for _ in 0..240 {
                let now = s.time();
                run(&mut s, now + 1.0 / 240.0, 1.0 / 240.0);
                let gained = whole(&mut s) - before;
                assert!(gained < 1e-9, "{damping} N·m·s, step {step}: {gained:e} J");
            }
        }
    }
}

/// A ball on sixty springs swings as on one that is sixty times as stiff: `x = v₀/ω sin ω t`. What
/// steps do not resolve they may damp, but not swing up.
#[test]
fn a_ball_on_many_springs_swings_as_on_their_sum() {
    let count = 60;
    for (tolerance, step) in STEPS {
        for angle in [0.1, 0.5, 1.7, 5.0] {
            // The angle of a step of 1/240 s.
            let omega: f64 = 240.0 * angle;
            let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [1e-3; 3]));
            b.model.roots[0].position = X;
            b.model.roots[0].linear_velocity = X * 1e-2;
            b.model.world.gravity = Vec3::zeros();
            let mut model = world([b.model]);
            for _ in 0..count {
                model.springs.push(Spring {
                    name: "spring".into(),
                    ends: [Some(LinkId(0)), None].map(|link| anchor(link, Pose::IDENTITY)),
                    length: 1.0,
                    stiffness: omega * omega / f64::from(count),
                    damping: 0.0,
                    shown: true,
                });
            }
            model.solver.step_size = step;
            let mut s = start(model, tolerance);
            let mut most = 0.0_f64;
            for _ in 0..480 {
                let now = s.time();
                run(&mut s, now + 1.0 / 240.0, 1.0 / 240.0);
                most = most.max((s.output(OutputSlot::BasePosition(RootId(0), 0)) - 1.0).abs());
            }
            let amplitude = 1e-2 / omega;
            let at = format!("angle {angle}, step {step}: {most:e} of {amplitude:e} m");
            assert!(most < 1.001 * amplitude, "{at}");
            let length = if step > 0.0 { step } else { 0.0 };
            assert!(omega * length > 0.5 || most > 0.95 * amplitude, "{at}");
        }
    }
}
