//! Observed orders of convergence, by steps of equal length through the parts of the stepper that
//! error control calls.

#[path = "../../../tests/acceptance/claim.rs"]
#[allow(dead_code, reason = "shared with the acceptance tests")]
mod claim;

use crate::dynamics::energy;
use crate::inputs::Inputs;
use crate::kinematics::Kinematics;
use crate::model::{Model, Motion};
use crate::parameters::Parameters;
use crate::simulation::Simulation;
use crate::spatial::{Pose, RigidInertia, Vec3};
use crate::state::{Counters, Physical};
use crate::step::driver::Stepper;
use crate::step::explicit::Plan;
use crate::step::explicit::tableau::{BOGACKI_SHAMPINE, DORMAND_PRINCE, KENNEDY_CARPENTER, Pair};
use crate::step::fixed::{Methods, Outcome, Part};
use crate::step::point::Context;
use crate::testing::{Builder, Random, inertia, random_tree};
use crate::tree::Tree;
use crate::tuning::Rules;
use claim::hold;
use std::sync::Arc;

/// How a step is taken.
#[derive(Clone, Copy, Debug)]
enum Method {
    Explicit(&'static Pair),
    Stages,
    Fixed,
}

/// Case A3: a free asymmetric body; A4: a pendulum from horizontal; A5: a double pendulum from
/// horizontal, and the same with damping.
fn motions() -> [(&'static str, Model); 4] {
    let mut top = Builder::new(true, inertia(1.0, Vec3::zeros(), [1.0, 2.0, 3.0]));
    top.model.world.gravity = Vec3::zeros();
    top.model.roots[0].angular_velocity = Vec3::new(1.0, 1.0, 1.0);
    let pendulum = |rods: usize| {
        let mut b = Builder::new(false, RigidInertia::ZERO);
        for rod in 0..rods {
            let X = Pose {
                p: Vec3::new(if rod == 0 { 0.0 } else { 1.0 }, 0.0, 0.0),
                ..Pose::IDENTITY
            };
            let bob = inertia(1.0, Vec3::new(1.0, 0.0, 0.0), [0.0; 3]);
            let axis = Motion::Revolute(Vec3::new(0.0, 1.0, 0.0));
            b.link(rod.into(), X, axis, bob);
        }
        b.model
    };
    let mut damped = pendulum(2);
    for joint in &mut damped.joints {
        joint.damping = 2.0;
    }
    [
        ("A3", top.model),
        ("A4", pendulum(1)),
        ("A5", pendulum(2)),
        ("A5 with damping", damped),
    ]
}

/// Positions and velocities after 1 s in `count` equal steps.
fn end(model: &Model, method: Method, count: u32) -> Vec<f64> {
    end_by(model, method, count, false)
}

/// The same, accelerations by mass matrix and factor or by the articulated-body algorithm.
fn end_by(model: &Model, method: Method, count: u32, articulated: bool) -> Vec<f64> {
    let simulation = Simulation::new(Arc::new(model.clone()));
    let mut tree = simulation.tree().clone();
    tree.long = articulated;
    let parameters = Parameters::new(model);
    let inputs = Inputs::new(model);
    let h = 1.0 / f64::from(count);
    let ctx = Context {
        model,
        tree: &tree,
        parameters: &parameters,
        inputs: &inputs,
        elapsed: 0.0,
        tolerance: 1e-3,
        fixed_step: if matches!(method, Method::Fixed) {
            h
        } else {
            0.0
        },
        budget: u64::MAX,
        exchanged: false,
        // Angles and energy may be what they are, and the method is on its own.
        rules: &Rules {
            coast: false,
            parts: false,
            energy: false,
            ..Rules::ALL
        },
    };
    let mut state = simulation.state().clone();
    let mut stepper = Stepper::new(model, ctx.tree);
    for _ in 0..count {
        let from = &state.physical;
        stepper.here.update(&ctx, from, h);
        stepper.attempt.begin(&state);
        match method {
            Method::Explicit(pair) => {
                let plan = Plan { pair, h };
                stepper.explicit.integrator.restart();
                stepper.explicit.attempt(&ctx, &stepper.here, from, plan);
                let (here, attempt) = (&stepper.here, &mut stepper.attempt);
                let step = (&state.physical, h);
                stepper
                    .explicit
                    .finish((ctx.tree, here), pair, step, attempt);
            }
            Method::Stages => {
                // Sharper than any tolerance asks: the iterations' end must not blur the order.
                let (stages, trend) = (&mut stepper.stages, &state.stepping.trend);
                assert!(stages.solve(&ctx, (&stepper.here, from), trend, [h, 1e-12], false));
                stages.finish(&ctx, (&stepper.here, from), h, &mut stepper.attempt);
            }
            Method::Fixed => {
                let mut methods = Methods {
                    here: &mut stepper.here,
                    there: &mut stepper.there,
                    stages: &mut stepper.stages,
                    implicit: &mut stepper.implicit,
                    explicit: &mut stepper.explicit,
                    closing: &mut stepper.closing,
                };
                let part = Part { h, whole: 1.0 };
                let mut counters = Counters::default();
                let found = (&mut stepper.attempt, &mut counters);
                let fixed = &mut stepper.fixed;
                let outcome = fixed.attempt_implicit(&ctx, &mut methods, &state, part, found);
                assert_eq!(outcome, Outcome::Good);
            }
        }
        stepper.attempt.accept(&mut state);
    }
    let Physical { q, v, .. } = &state.physical;
    q.iter().chain(v).copied().collect()
}

/// A6. The error falls with the order of the method: 5 and 3 for the explicit pairs, 4 for the one
/// that takes damping implicitly, 2 for the step of two stages, and for an implicit step of fixed
/// length that looks at its middle for the bias, 1 (its mass matrix is that of its start). Over
/// three halvings of the step.
#[test]
fn a6_errors_fall_with_the_order_of_the_method() {
    // Steps of the pairs: short enough for the order to show, long enough for the error to stay
    // above round-off.
    for ((case, model), steps) in motions().into_iter().zip([20, 40, 40, 80]) {
        let exact = end(&model, Method::Explicit(&DORMAND_PRINCE), 2000);
        let error = |method, count| {
            let at = end(&model, method, count);
            let pairs = at.iter().zip(&exact);
            pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
        };
        for (name, method, count, order) in [
            (
                "Dormand–Prince",
                Method::Explicit(&DORMAND_PRINCE),
                steps,
                5.0,
            ),
            (
                "Bogacki–Shampine",
                Method::Explicit(&BOGACKI_SHAMPINE),
                2 * steps,
                3.0,
            ),
            (
                "Kennedy–Carpenter",
                Method::Explicit(&KENNEDY_CARPENTER),
                steps,
                4.0,
            ),
            ("two-stage", Method::Stages, 100, 2.0),
            ("fixed", Method::Fixed, 100, 1.0),
        ] {
            let slope = libm::log2(error(method, count) / error(method, 8 * count)) / 3.0;
            let what = format!("order of the {name} step on {case}");
            let theory = format!("{order}: theory");
            // Another order is off by 0.5 or more.
            hold("A6", &what, &theory, slope - order, 0.2);
        }
    }
}

/// Two routes to the same step: what damping adds to the mass matrix' diagonal and to the
/// articulated inertias.
#[test]
fn implicit_damping_is_the_same_by_mass_matrix_and_by_articulated_bodies() {
    let mut random = Random(11);
    for floating in [false, true] {
        let mut model = random_tree(&mut random, 12, floating, false);
        for (i, joint) in (1u8..).zip(&mut model.joints) {
            joint.damping = 0.1 * f64::from(i);
            joint.limits = None;
        }
        let [a, b] =
            [false, true].map(|way| end_by(&model, Method::Explicit(&KENNEDY_CARPENTER), 200, way));
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}

/// Kinetic energy in a state, J.
fn kinetic(model: &Model, state: &[f64]) -> f64 {
    let tree = Tree::new(model, &Parameters::new(model));
    let (q, v) = state.split_at(model.nq);
    let mut kin = Kinematics::new(&tree);
    kin.update_poses(&tree, q);
    kin.update_velocities(&tree, v);
    energy::kinetic(&tree, &kin, v)
}

/// Limbs that whirl without gravity keep their energy. An implicit step of fixed length that looks
/// at its middle errs by the third order in it, so that many of them err by the second, although
/// positions are of the first.
#[test]
fn limbs_that_whirl_keep_their_energy_to_the_second_order_in_fixed_steps() {
    let [_, _, (_, mut model), _] = motions();
    model.world.gravity = Vec3::zeros();
    model.initial.joint_velocities = vec![5.0, -8.0];
    let begin = kinetic(&model, &end(&model, Method::Fixed, 0));
    let made = |count| (kinetic(&model, &end(&model, Method::Fixed, count)) - begin).abs();
    let order = libm::log2(made(100) / made(400)) / 2.0;
    // With another share of the change of velocity it is of the first order.
    assert!((order - 2.0).abs() < 0.2, "{order}");
}
