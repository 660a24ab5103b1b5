//! The assembled derivatives against differences, and the minimum against a step away from it.

use super::*;
use crate::dynamics::{crba, rnea};
use crate::force::tests::random_contact;
use crate::force::{Contact, ContactSet, Drive, JointTerm, Other, Turn};
use crate::law::{ElastoPlastic, Radial, SpeedLine};
use crate::model::RootKind;
use crate::parameters::Parameters;
use crate::spatial::Vec3;
use crate::testing::{Random, random_tree};

/// A random robot in motion with a contact on every body, each resisting turning, and a motor on
/// every joint.
struct Case {
    tree: Tree,
    kin: Kinematics,
    terms: Terms,
    v0: Vec<f64>,
    h: f64,
}

/// What of `x` lies across a normal.
fn across(normal: &Vec3, x: Vec3) -> Vec3 {
    x - normal * normal.dot(&x)
}

/// Takes the friction of some contacts, and leaves less of others than friction remembers.
fn hamper(contact: &mut Contact) {
    match contact.body % 4 {
        // What carried nothing in the last solve has no friction, but may be rocking.
        2 => contact.friction.cap = 0.0,
        // One point, where a face has been stretched by drilling before.
        3 => {
            contact.radius = 0.0;
            contact.friction.displacement = contact.normal * 1e-3;
        }
        _ => {}
    }
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let floating = seed.is_multiple_of(2);
        let mut model = random_tree(&mut random, 6, floating, seed.is_multiple_of(3));
        // Every fourth is a world of three robots, of which the others push the first.
        let worlds = seed % 4 == 3;
        if worlds {
            for name in ["b", "c"] {
                let other = random_tree(&mut random, 4, name == "b", seed.is_multiple_of(3));
                model.join(other, name, RootKind::Robot);
            }
        }
        let own = model
            .roots
            .get(1)
            .map_or(model.bodies.len(), |root| root.body.index());
        let mut tree = Tree::new(&model, &Parameters::new(&model));
        // Room for what couples.
        tree.contact.pairs = vec![true];
        let mut kin = Kinematics::new(&tree);
        let state = crate::state::State::new(&model);
        kin.update_poses(&tree, &state.physical.q);
        crba::mass_matrix(&tree, &mut kin);
        let v: Vec<f64> = (0..model.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
        kin.update_velocities(&tree, &v);
        rnea::bias(&tree, &mut kin, &v, &[], 0.0);
        let mut contacts = ContactSet::new([0, 0]);
        for body in 0..tree.bodies.len() {
            if !tree.bodies[body].kind.moves() {
                continue;
            }
            let mut contact = random_contact(&mut random, body, &mut contacts.points);
            hamper(&mut contact);
            // Of the others' the first robot's, of every second robot's its own.
            let other = if body >= own { body % own } else { body / 2 };
            let meets = body >= own || seed % 4 == 2 && other != body;
            if meets && tree.bodies[other].kind.moves() {
                let apart = tree.bodies[other].tree != tree.bodies[body].tree;
                contact.other = Some(Other {
                    body: other,
                    from: random.vector(if apart { 0.5 } else { 0.0 }),
                    axes: crate::spatial::Mat3::identity(),
                });
            }
            contacts.list.push(contact);
        }
        let turns = contacts
            .iter()
            .enumerate()
            .map(|of| random_turn(&mut random, of))
            .collect();
        let of_joint = |dof: &usize| model.bodies[model.dofs[*dof].body.index()].joint.is_some();
        let joints = (0..model.nv())
            .filter(of_joint)
            .map(|dof| JointTerm {
                dof,
                damping: 0.1,
                gap: [f64::INFINITY; 2],
                drive: Drive::Pd {
                    offset: random.uniform(-9.0, 9.0),
                    kp: 30.0,
                    kd: 1.0,
                    cap: 8.0,
                },
                line: SpeedLine {
                    stall: 8.0,
                    no_load: 1.5,
                },
                speed_limit: 0.5,
                speed_damping: 3.0,
                ..JointTerm::default()
            })
            .collect();
        Self {
            tree,
            kin,
            terms: Terms {
                contacts,
                turns,
                joints,
                springs: Vec::new(),
            },
            v0: v,
            h: 5e-3,
        }
    }

    fn room(&self) -> [usize; 2] {
        let contacts = &self.terms.contacts;
        [contacts.len(), contacts.points.len()]
    }

    fn problem(&self) -> Problem<'_> {
        Problem {
            tree: &self.tree,
            kin: &self.kin,
            bias: &self.kin.bias,
            terms: &self.terms,
            h: self.h,
            ahead: self.h,
            accuracy: 1e-10,
            iterated: 1e-8,
        }
    }

    /// The gradient at `v`.
    fn gradient(&self, newton: &mut Newton, v: &[f64]) -> Vec<f64> {
        let problem = self.problem();
        newton.guess(&problem, &self.v0, v);
        newton.mark_loaded(&self.tree, &self.terms);
        let out = &mut newton.responses;
        problem.terms.respond(&newton.v, &newton.at, problem.h, out);
        newton.collect(&problem);
        newton.gradient.clone()
    }
}

/// Friction against turning of a contact with its place in the list.
fn random_turn(random: &mut Random, (contact, c): (usize, &Contact)) -> Turn {
    Turn {
        contact,
        body: c.body,
        other: c.other.map(|other| other.body),
        slot: c.slot,
        normal: c.normal,
        coefficient: [0.1, 0.05],
        torsional: ElastoPlastic {
            cap: random.uniform(0.0, 4.0),
            stiffness: 50.0,
            damping: 2.0,
            displacement: random.uniform(-1e-2, 1e-2),
            limit: Radial,
        },
        rolling: ElastoPlastic {
            cap: random.uniform(0.0, 4.0),
            stiffness: 80.0,
            damping: 1.0,
            displacement: across(&c.normal, random.vector(1e-2)),
            limit: Radial,
        },
        ..Turn::default()
    }
}

/// Two routes to `H w`: the assembled matrix, and a central difference of the gradient along `w`.
#[test]
fn the_hessian_is_the_derivative_of_the_gradient() {
    let mut compared = 0;
    for seed in 0..60 {
        let case = Case::new(seed);
        let mut random = Random(1000 + seed);
        let mut newton = Newton::new(&case.tree, case.room());
        let n = newton.v.len();
        let mut draw =
            |size: f64| -> Vec<f64> { (0..n).map(|_| random.uniform(-size, size)).collect() };
        let (v, w) = (draw(1.0), draw(1.0));
        let shifted = |d: f64| -> Vec<f64> { v.iter().zip(&w).map(|(v, w)| v + d * w).collect() };
        let d = 1e-7;
        let ahead = case.gradient(&mut newton, &shifted(d));
        let behind = case.gradient(&mut newton, &shifted(-d));
        let middle = case.gradient(&mut newton, &v);
        newton.assemble(&case.problem());
        let mut product = vec![0.0; n];
        newton
            .factor
            .H
            .multiply(&case.tree.sparsity, &w, &mut product);
        let size = product.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        for i in 0..n {
            let difference = (ahead[i] - behind[i]) / (2.0 * d);
            // Where a kink lies within the difference, its two halves differ.
            let bend = (ahead[i] - 2.0 * middle[i] + behind[i]).abs() / d;
            if bend < 1e-5 * size {
                compared += 1;
                assert!(
                    (difference - product[i]).abs() < 1e-5 * size,
                    "seed {seed}, row {i}: {difference} {}",
                    product[i]
                );
            }
        }
    }
    assert!(compared > 400, "{compared}");
}

/// Convex: from any guess the same minimum, where every direction leads uphill.
#[test]
fn the_minimum_does_not_depend_on_the_guess() {
    for seed in 0..60 {
        let case = Case::new(seed);
        let problem = case.problem();
        let mut random = Random(2000 + seed);
        let mut newton = Newton::new(&case.tree, case.room());
        let n = newton.v.len();
        let mut found: Vec<Vec<f64>> = Vec::new();
        for size in [0.0, 1.0, 30.0] {
            let guess: Vec<f64> = (0..n).map(|_| random.uniform(-1.0, 1.0) * size).collect();
            newton.guess(&problem, &case.v0, &guess);
            let outcome = newton.solve(&problem);
            assert!(outcome.converged, "seed {seed}: {outcome:?}");
            found.push(newton.v.clone());
        }
        let speed = found[0].iter().fold(1.0, |m: f64, v| m.max(v.abs()));
        for other in &found[1..] {
            for (a, b) in found[0].iter().zip(other) {
                assert!((a - b).abs() < 1e-6 * speed, "seed {seed}: {a} {b}");
            }
        }
    }
}

/// Solves with the Hessian of another solve, of the same contacts, in the first iteration.
fn solve_after(newton: &mut Newton, problem: &Problem, before: &Newton) -> Outcome {
    let mut run = Run::default();
    let mut factor = before.factor_for(&problem.terms.contacts, newton, problem);
    loop {
        if let Some(outcome) = newton.iterate(problem, &mut run, factor.take()) {
            return outcome;
        }
    }
}

/// Whatever Hessian the first iteration takes: Newton's own lead to the minimum. That of a step a
/// fifth or five times as long is far off, that of a step as long but for a hundredth is close.
#[test]
fn the_minimum_does_not_depend_on_the_hessian_of_the_first_iteration() {
    let mut taken = 0;
    for seed in 0..60 {
        let mut case = Case::new(seed);
        let new = |case: &Case| Newton::new(&case.tree, case.room());
        let solved = |case: &Case| {
            let mut newton = new(case);
            newton.guess(&case.problem(), &case.v0, &case.v0);
            let outcome = newton.solve(&case.problem());
            assert!(outcome.converged, "seed {seed}: {outcome:?}");
            newton
        };
        let expected = solved(&case);
        let speed = expected.v.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
        for longer in [0.2, 0.99, 1.01, 5.0] {
            case.h = 5e-3 * longer;
            let before = solved(&case);
            case.h = 5e-3;
            let problem = case.problem();
            let mut newton = new(&case);
            newton.guess(&problem, &case.v0, &before.v);
            let outcome = solve_after(&mut newton, &problem, &before);
            assert!(outcome.converged, "seed {seed}: {outcome:?}");
            for (a, b) in expected.v.iter().zip(&newton.v) {
                assert!((a - b).abs() < 1e-6 * speed, "seed {seed}: {a} {b}");
            }
            let coarse = Problem {
                iterated: 1e-3,
                ..problem
            };
            newton.guess(&coarse, &case.v0, &before.v);
            let outcome = solve_after(&mut newton, &coarse, &before);
            taken += usize::from(outcome.converged && outcome.iterations == 1 && !newton.factored);
        }
    }
    // To the accuracy of an error-controlled step the first iteration often is enough, and nothing
    // has been factorised.
    assert!(taken > 60, "{taken}");
}

/// The same as [`Newton::carry`], but friction acts where it does.
fn carry(newton: &mut Newton, case: &mut Case) {
    case.terms.carry(&newton.responses, case.h);
    forward(&case.tree, &case.kin.S, &newton.v, &mut newton.V);
    let (at, responses) = (&mut newton.at, &mut newton.responses);
    case.terms.rub(&newton.V, at, case.h, responses);
}

/// Solves with friction cones that belong to their own normal forces.
fn solve_with_own_cones(newton: &mut Newton, case: &mut Case) -> bool {
    for _ in 0..60 {
        carry(newton, case);
        if !newton.solve(&case.problem()).converged {
            return false;
        }
    }
    true
}

/// From a guess that is off by `ε`, one iteration whose direction foresees its friction cones
/// leaves an error of the order of `ε²` if one contact slips, where one with constant cones leaves
/// a share of `ε`. Where several slip, it leaves a part of that share. The solution is that of
/// many solves, each with the cones of the last one.
#[test]
fn a_direction_that_foresees_its_cones_finds_them() {
    let (mut one, mut many) = ([0.0_f64; 2], Vec::new());
    for (seed, alone) in (0..60).flat_map(|seed| [(seed, true), (seed, false)]) {
        let mut case = Case::new(seed);
        let mut newton = Newton::new(&case.tree, case.room());
        case.terms.turns.clear();
        for (i, contact) in case.terms.contacts.list.iter_mut().enumerate() {
            contact.mu = if i == 0 || !alone { 0.4 } else { 0.0 };
        }
        let (h, v0) = (case.h, case.v0.clone());
        newton.guess(&case.problem(), &v0, &v0);
        if !solve_with_own_cones(&mut newton, &mut case) {
            continue;
        }
        let solution = newton.v.clone();
        let mut random = Random(3000 + seed);
        let epsilon = 1e-5;
        let guess: Vec<f64> = solution
            .iter()
            .map(|v| v + epsilon * random.uniform(-1.0, 1.0))
            .collect();
        let [constant, foreseen] = [false, true].map(|foresees| {
            newton.guess(&case.problem(), &v0, &guess);
            carry(&mut newton, &mut case);
            let before = case.terms.clone();
            assert!(
                newton
                    .aim(&case.problem(), &mut Run::default(), None)
                    .is_none()
            );
            if foresees {
                let parts = (&case.tree, &case.kin);
                newton.foresee(parts, (&mut case.terms, h), None, 0.0);
            }
            newton.walk(&case.problem());
            case.terms = before;
            let error = solution.iter().zip(&newton.v).map(|(a, b)| (a - b).abs());
            error.fold(0.0, f64::max) / epsilon
        });
        let slips = newton
            .responses
            .contacts
            .iter()
            .filter(|r| r.slips())
            .count();
        if alone && slips > 0 {
            one = [one[0].max(constant), one[1].max(foreseen)];
        } else if slips > 1 && constant > 1e-3 {
            many.push(foreseen / constant);
        }
    }
    assert!(one[0] > 1e-2 && one[1] < 1e-3, "{one:?}");
    many.sort_by(f64::total_cmp);
    assert!(many.len() > 20 && many[many.len() / 2] < 0.02, "{many:?}");
}
