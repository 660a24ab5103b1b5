//! Rows against differences, and forces against the equations that they solve.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Schur;
use crate::closure::testing::{add, ends_at};
use crate::dynamics::{crba, rnea};
use crate::kinematics::{Kinematics, advance};
use crate::model::{LinkId, LoopKind, Model, Share};
use crate::parameters::Parameters;
use crate::sparsity::inverse::Inverse;
use crate::spatial::Pose;
use crate::state::State;
use crate::testing::{Random, random_tree};
use crate::tree::Tree;

struct Case {
    model: Model,
    tree: Tree,
    kin: Kinematics,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// A random tree at a random state, with a loop of each kind, all of which are closed there.
fn case(seed: u64, floating: bool, mimic: bool) -> Case {
    let mut random = Random(seed);
    let mut model = random_tree(&mut random, 9, floating, mimic);
    let tree = Tree::new(&model, &Parameters::new(&model));
    let far: Vec<f64> = (0..model.nv()).map(|_| random.uniform(-2.0, 2.0)).collect();
    let mut q = vec![0.0; model.nq];
    advance(&tree, &State::new(&model).physical.q, &far, 1.0, &mut q);
    for kind in 0..4 {
        let links = loop {
            let links = [0; 2].map(|_| LinkId::from(random.below(model.links.len())));
            if links[0] != links[1] {
                break links.map(Some);
            }
        };
        let links = if kind == 0 { [links[0], None] } else { links };
        let X = Pose::from_xyz_rpy(random.vector(0.3), random.vector(3.0));
        let mut ends = ends_at(&model, &q, links, X);
        let kind = match kind {
            0 => LoopKind::Ball(ends),
            1 => LoopKind::Hinge(ends),
            2 => LoopKind::Weld(ends),
            _ => {
                ends[1].X_LA.p += random.vector(0.3);
                let length = (ends[1].X_LA.p - ends_at(&model, &q, links, X)[1].X_LA.p).norm();
                LoopKind::Distance { ends, length }
            }
        };
        add(&mut model, kind);
    }
    let scalar = (0..model.joints.len()).map(Into::into);
    let scalar: Vec<_> = scalar.filter(|j| model.scalar_body(*j).is_some()).collect();
    let terms = [1.0, -0.7, 2.0].iter().zip(&scalar);
    let terms = terms.map(|(factor, joint)| Share {
        joint: *joint,
        factor: *factor,
    });
    let terms = terms.collect();
    add(&mut model, LoopKind::Coupler { terms, sum: None });
    let mut tree = Tree::new(&model, &Parameters::new(&model));
    tree.mesh(&q);
    let mut case = Case {
        v: (0..model.nv()).map(|_| random.uniform(-1.0, 1.0)).collect(),
        kin: Kinematics::new(&tree),
        model,
        tree,
        q,
    };
    case.update();
    case.project();
    case.update();
    case
}

impl Case {
    fn update(&mut self) {
        let Self {
            tree, kin, q, v, ..
        } = self;
        kin.update_poses(tree, q);
        kin.update_velocities(tree, v);
        crba::mass_matrix(tree, kin);
        rnea::bias(tree, kin, v, &[], 0.0);
        kin.loops.find_sums(tree, q);
    }

    /// The forces of loops for the mass matrix.
    fn schur(&self) -> Schur {
        let mut factor = self.kin.M.clone();
        self.tree.sparsity.factor(&mut factor);
        let mut schur = Schur::new(&self.tree);
        let inverse = Inverse::Packed(&self.tree.sparsity, &factor);
        schur.factor(&self.tree, &self.kin.loops, &inverse);
        schur
    }

    /// Takes the velocity out of the rows.
    fn project(&mut self) {
        let (schur, rows) = (self.schur(), &self.kin.loops);
        for _ in 0..3 {
            let mut forces: Vec<f64> = (0..rows.len())
                .map(|row| -rows.along(&self.tree, row, &self.v))
                .collect();
            schur.solve(&mut forces);
            schur.push(&forces, &mut self.v);
        }
    }

    /// The same after `h` seconds with its velocity.
    fn after(&self, h: f64) -> Self {
        let mut q = self.q.clone();
        advance(&self.tree, &self.q, &self.v, h, &mut q);
        let mut case = Self {
            model: self.model.clone(),
            tree: self.tree.clone(),
            kin: self.kin.clone(),
            q,
            v: self.v.clone(),
        };
        case.update();
        case
    }
}

fn cases() -> impl Iterator<Item = (u64, Case)> {
    (0..24).map(|seed| (seed, case(seed, seed % 2 == 0, seed % 4 > 1)))
}

#[test]
fn gaps_of_a_closed_loop_are_zero() {
    for (seed, case) in cases() {
        assert_eq!(case.kin.loops.len(), 16);
        let gap = case.kin.loops.largest();
        assert!(gap < 1e-13, "seed {seed}: {gap}");
    }
}

/// `dg/dt = J v`: with any velocity, and central differences.
#[test]
fn rows_are_the_rates_of_gaps() {
    for (seed, mut case) in cases() {
        let mut random = Random(seed + 99);
        case.v = (0..case.v.len())
            .map(|_| random.uniform(-1.0, 1.0))
            .collect();
        let h = 1e-5;
        let [ahead, behind] = [case.after(h), case.after(-h)];
        for row in 0..case.kin.loops.len() {
            let rate = case.kin.loops.along(&case.tree, row, &case.v);
            let gaps = [&ahead, &behind].map(|case| case.kin.loops.gap[row]);
            let difference = (gaps[0] - gaps[1]) / (2.0 * h);
            assert!(
                (rate - difference).abs() < 1e-8,
                "seed {seed} row {row}: {rate} {difference}"
            );
        }
    }
}

/// `J̇v` is what `J v` changes by while `v` stays.
#[test]
fn the_bias_is_the_rate_of_the_rows() {
    for (seed, case) in cases() {
        let h = 1e-5;
        let [ahead, behind] = [case.after(h), case.after(-h)];
        for row in 0..case.kin.loops.len() {
            let rates = [&ahead, &behind].map(|c| c.kin.loops.along(&c.tree, row, &c.v));
            let difference = (rates[0] - rates[1]) / (2.0 * h);
            let bias = case.kin.loops.bias[row];
            assert!(
                (bias - difference).abs() < 1e-7,
                "seed {seed} row {row}: {bias} {difference}"
            );
        }
    }
}

/// A ball and a coupler twice: the forces are shared, and do the same together.
#[test]
fn redundant_rows_share_their_force() {
    for (seed, mut case) in cases().filter(|(seed, _)| seed % 4 == 0) {
        case.model.loops.drain(1..4);
        case.tree = Tree::new(&case.model, &Parameters::new(&case.model));
        case.tree.mesh(&case.q);
        case.update();
        let mut twice = case.model.clone();
        for mut part in case.model.loops.clone() {
            part.name += " again";
            twice.loops.push(part);
        }
        let mut tree = Tree::new(&twice, &Parameters::new(&twice));
        tree.mesh(&case.q);
        let mut other = Case {
            model: twice,
            kin: Kinematics::new(&tree),
            tree,
            q: case.q.clone(),
            v: case.v.clone(),
        };
        other.update();
        let solve = |case: &Case| {
            let mut a: Vec<f64> = case.kin.bias.iter().map(|k| -k).collect();
            let mut factor = case.kin.M.clone();
            case.tree.sparsity.factor(&mut factor);
            case.tree.sparsity.solve(&factor, &mut a);
            let (rows, mut forces) = (&case.kin.loops, Vec::new());
            let asked = |row: usize| -rows.bias[row];
            case.schur()
                .close((&case.tree, rows), asked, &mut a, &mut forces);
            (a, forces)
        };
        let ((a, forces), (b, shared)) = (solve(&case), solve(&other));
        for (a, b) in a.iter().zip(&b) {
            assert!(
                (a - b).abs() < 1e-7 * (1.0 + a.abs()),
                "seed {seed}: {a} {b}"
            );
        }
        let (first, second) = shared.split_at(forces.len());
        for (force, (one, two)) in forces.iter().zip(first.iter().zip(second)) {
            let size = 1.0 + force.abs();
            assert!(
                (one - 0.5 * force).abs() < 1e-2 * size,
                "seed {seed}: {one} {force}"
            );
            assert!(
                (two - 0.5 * force).abs() < 1e-2 * size,
                "seed {seed}: {two} {force}"
            );
        }
    }
}
