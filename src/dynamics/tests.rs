//! Two routes to one number: mass matrix, bias and accelerations on random trees.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{aba::Articulated, crba, energy, rnea};
use crate::kinematics::{Kinematics, advance};
use crate::model::{Model, Motion};
use crate::parameters::Parameters;
use crate::spatial::{Pose, RigidInertia, Vec3, Vec6, angular};
use crate::state::State;
use crate::testing::{Builder, Random, inertia, random_tree};
use crate::tree::Tree;

struct Case {
    tree: Tree,
    kin: Kinematics,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// A random tree at a random state.
fn case(seed: u64, n: usize, floating: bool, mimic: bool) -> Case {
    let mut random = Random(seed);
    let model = random_tree(&mut random, n, floating, mimic);
    case_of(&model, random)
}

/// A model at a random state.
fn case_of(model: &Model, mut random: Random) -> Case {
    let floating = model.is_floating();
    let mut tree = Tree::new(model, &Parameters::new(model));
    for k in 0..model.nv() {
        tree.dofs.armature[k] = if k < 6 && floating { 0.0 } else { 0.01 };
    }
    let v: Vec<f64> = (0..model.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
    let far: Vec<f64> = (0..model.nv()).map(|_| random.uniform(-3.0, 3.0)).collect();
    let mut q = vec![0.0; model.nq];
    advance(&tree, &State::new(model).physical.q, &far, 1.0, &mut q);
    let mut case = Case {
        kin: Kinematics::new(&tree),
        tree,
        q,
        v,
    };
    case.update();
    case
}

impl Case {
    fn update(&mut self) {
        self.kin.update_poses(&self.tree, &self.q);
        self.kin.update_velocities(&self.tree, &self.v);
        crba::mass_matrix(&self.tree, &mut self.kin);
        rnea::bias(&self.tree, &mut self.kin, &self.v, &[], 0.0);
    }

    /// `M⁻¹ (tau − k)`.
    fn accelerations(&self, tau: &[f64]) -> Vec<f64> {
        let mut M = self.kin.M.clone();
        self.tree.sparsity.factor(&mut M);
        let mut a: Vec<f64> = tau.iter().zip(&self.kin.bias).map(|(t, k)| t - k).collect();
        self.tree.sparsity.solve(&M, &mut a);
        a
    }

    /// Momentum about the world's origin.
    fn momentum(&self) -> Vec6 {
        let mut P = energy::momentum(&self.kin, 0..self.kin.V.len());
        let shift = self.kin.origins[0].cross(&Vec3::new(P[3], P[4], P[5]));
        for i in 0..3 {
            P[i] += shift[i];
        }
        P
    }
}

fn close(a: &[f64], b: &[f64], tolerance: f64) {
    let scale = a.iter().chain(b).fold(1e-3, |m: f64, x| m.max(x.abs()));
    for (a, b) in a.iter().zip(b) {
        assert!(
            (a - b).abs() <= tolerance * scale,
            "{a} {b} (scale {scale})"
        );
    }
}

#[test]
fn aba_agrees_with_crba_and_rnea_on_random_trees() {
    for seed in 0..40 {
        let floating = seed % 2 == 0;
        let case = case(seed, 3 + seed as usize, floating, false);
        let mut random = Random(seed + 1000);
        let tau: Vec<f64> = case.v.iter().map(|_| random.uniform(-5.0, 5.0)).collect();
        let mut vdot = vec![0.0; case.v.len()];
        let mut aba = Articulated::new(&case.tree);
        aba.accelerations(&case.tree, &case.kin, &case.v, &tau, (&[], 0.0), &mut vdot);
        close(&vdot, &case.accelerations(&tau), 1e-11);
    }
}

/// The rows of such a chain's matrix are as long as those of a floating base, but mean something
/// else.
#[test]
fn aba_agrees_with_crba_and_rnea_on_a_fixed_serial_arm() {
    for n in 5..10 {
        let mut random = Random(n);
        let mut b = Builder::new(false, RigidInertia::ZERO);
        for i in 0..n as usize {
            let X = Pose::from_xyz_rpy(random.vector(0.4), random.vector(3.0));
            let body = inertia(1.0, random.vector(0.2), [0.02, 0.025, 0.03]);
            b.link(i.into(), X, Motion::Revolute(random.unit()), body);
        }
        let case = case_of(&b.model, random);
        let tau = vec![1.0; case.v.len()];
        let mut vdot = vec![0.0; case.v.len()];
        let mut aba = Articulated::new(&case.tree);
        aba.accelerations(&case.tree, &case.kin, &case.v, &tau, (&[], 0.0), &mut vdot);
        close(&vdot, &case.accelerations(&tau), 1e-11);
    }
}

#[test]
fn mass_matrix_gives_the_kinetic_energy_of_the_bodies() {
    for seed in 0..40 {
        let case = case(seed, 3 + seed as usize, seed % 2 == 0, seed % 3 == 0);
        let mut p = vec![0.0; case.v.len()];
        case.tree.sparsity.multiply(&case.kin.M, &case.v, &mut p);
        let from_matrix: f64 = 0.5 * p.iter().zip(&case.v).map(|(p, v)| p * v).sum::<f64>();
        let from_bodies = energy::kinetic(&case.tree, &case.kin, &case.v);
        assert!((from_matrix - from_bodies).abs() < 1e-12 * from_bodies);
    }
}

/// `d/dt(E) = τ·v`: the bias, gravity and the mass matrix together, mimic joints included.
#[test]
fn power_of_the_joint_forces_is_the_rate_of_the_energy() {
    for seed in 0..40 {
        let mut case = case(seed, 2 + seed as usize / 2, seed % 2 == 0, seed % 3 == 0);
        let mut random = Random(seed + 1000);
        let tau: Vec<f64> = case.v.iter().map(|_| random.uniform(-5.0, 5.0)).collect();
        let vdot = case.accelerations(&tau);
        let power: f64 = tau.iter().zip(&case.v).map(|(t, v)| t * v).sum();
        let (q, v) = (case.q.clone(), case.v.clone());
        let mut energy_at = |h: f64| {
            // Second order in h along the motion; the central difference removes the h² term.
            let middle: Vec<f64> = v.iter().zip(&vdot).map(|(v, a)| v + 0.5 * h * a).collect();
            advance(&case.tree, &q, &middle, h, &mut case.q);
            for i in 0..v.len() {
                case.v[i] = v[i] + h * vdot[i];
            }
            case.update();
            energy::kinetic(&case.tree, &case.kin, &case.v)
                + energy::potential(&case.tree, &case.kin)
        };
        let h = 1e-5;
        let rate = (energy_at(h) - energy_at(-h)) / (2.0 * h);
        let scale = energy_at(0.0).abs().max(1.0) / 1e-2;
        assert!(
            (rate - power).abs() < 1e-6 * scale,
            "seed {seed}: {rate} {power}"
        );
    }
}

/// Without gravity the momentum about a fixed point keeps its value whatever the joints do.
#[test]
fn joint_forces_do_not_change_the_momentum_of_a_free_robot() {
    for seed in 0..20 {
        let mut case = case(seed, 8, true, seed % 2 == 0);
        case.tree.world.gravity = Vec3::zeros();
        case.update();
        case.tree.dofs.armature.fill(0.0);
        case.update();
        let mut random = Random(seed + 1000);
        let mut tau: Vec<f64> = case.v.iter().map(|_| random.uniform(-5.0, 5.0)).collect();
        tau[..6].fill(0.0);
        let vdot = case.accelerations(&tau);
        let (q, v) = (case.q.clone(), case.v.clone());
        let mut momentum_at = |h: f64| {
            let middle: Vec<f64> = v.iter().zip(&vdot).map(|(v, a)| v + 0.5 * h * a).collect();
            advance(&case.tree, &q, &middle, h, &mut case.q);
            for i in 0..v.len() {
                case.v[i] = v[i] + h * vdot[i];
            }
            case.update();
            case.momentum()
        };
        let (a, b) = (momentum_at(1e-5), momentum_at(-1e-5));
        let size = angular(&a).norm() + 1.0;
        for i in 0..6 {
            assert!(
                ((a[i] - b[i]) / 2e-5).abs() < 1e-4 * size * 10.0,
                "seed {seed} {a:?} {b:?}"
            );
        }
    }
}
