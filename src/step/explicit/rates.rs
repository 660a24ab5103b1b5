//! How fast pd laws and springs swing what a step works on, and how fast dampers stop it.
//!
//! Beside the mass matrix `M`, the laws along joints and the springs between points add up to a
//! stiffness `K` and a damping `D`. The fastest of their motions have the squared angular frequency
//! `λ(M⁻¹K)` and the rate `λ(M⁻¹D)`, the largest eigenvalues. One joint alone tells little of them:
//! in an arm whose links move against each other they are tens of times `K_kk/M_kk`, and a body on
//! many springs feels their sum.
//!
//! From `x₀`, with `yᵢ = K xᵢ` and `xᵢ₊₁ = M⁻¹ yᵢ`, the quotient `xᵢ·yᵢ/(xᵢ·yᵢ₋₁)` is a mean of the
//! eigenvalues, each weighted by its `2i`-th power and its share of `x₀`. It comes to the largest
//! one from below.
//!
//! Source: Golub & Van Loan 2013, section 8.2 (power iteration).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::aba::Articulated;
use crate::force::{Drive, JointTerm, SpringTerm, pull_back};
use crate::kinematics::forward;
use crate::spatial::Vec6;
use crate::step::point::Point;
use crate::tree::Tree;
use crate::tuning::{RATE_ROUNDS, SWINGING};

/// The fastest motions, as far as the explicit method asks for them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rates {
    /// Of all pd laws and springs, rad²/s².
    pub stiff: f64,
    /// Of pd laws that swing or are at their effort limit, and of all springs, rad²/s².
    pub swinging: f64,
    /// Of joint damping and of pd laws, which a step may take implicitly, 1/s.
    pub damped: f64,
    /// Of torque–speed lines and of dampers between points, which no explicit step takes so, 1/s.
    pub braked: f64,
}

/// Scratch of the search.
#[derive(Clone, Debug)]
pub(super) struct Search {
    factor: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Accelerations without the forces sought for, if the tree is long.
    still: Vec<f64>,
    articulated: Articulated,
    V: Vec<Vec6>,
    F: Vec<Vec6>,
}

#[cfg(test)]
crate::spoil::spoil!(Search: factor x y still articulated V F;);

/// A symmetric matrix as the sum of what joints and springs contribute, N·m/rad and N/m; or of
/// their dampers.
struct Sum<J, S> {
    joint: J,
    spring: S,
}

/// What a search looks at.
#[derive(Clone, Copy)]
struct Scene<'a> {
    tree: &'a Tree,
    here: &'a Point,
    v: &'a [f64],
}

impl Search {
    pub(super) fn new(tree: &Tree) -> Self {
        let (n, bodies) = (tree.sparsity.len(), tree.bodies.len());
        Self {
            factor: vec![0.0; tree.sparsity.entries()],
            x: vec![0.0; n],
            y: vec![0.0; n],
            still: vec![0.0; n],
            articulated: Articulated::new(tree),
            V: vec![[0.0; 6]; bodies],
            F: vec![[0.0; 6]; bodies],
        }
    }

    /// The rates where `here` stands, with the velocities `v`.
    pub(super) fn rates(&mut self, tree: &Tree, here: &Point, v: &[f64]) -> Rates {
        let scene = Scene { tree, here, v };
        let (joints, springs) = (&here.terms.joints, &here.terms.springs);
        let swinging = |term: &JointTerm| {
            if swings(term, here, v) {
                stiffness(term)
            } else {
                0.0
            }
        };
        let braking = |term: &JointTerm| term.line.slope();
        let (sprung, dampers) = (
            !springs.is_empty(),
            springs.iter().any(|spring| spring.damping() > 0.0),
        );
        let is_stiff = sprung || joints.iter().any(|term| stiffness(term) > 0.0);
        let is_damped = joints.iter().any(|term| damping(term) > 0.0);
        let is_braked = dampers || joints.iter().any(|term| braking(term) > 0.0);
        let mut rates = Rates::default();
        if !(is_stiff || is_damped || is_braked) {
            return rates;
        }
        self.prepare(&scene);
        if is_stiff {
            let (joint, spring) = (stiffness, SpringTerm::stiffness);
            rates.stiff = self.fastest(&scene, &Sum { joint, spring });
            rates.swinging = rates.stiff;
        }
        if joints.iter().any(|term| swinging(term) < stiffness(term)) {
            let (joint, spring) = (swinging, SpringTerm::stiffness);
            rates.swinging = self.fastest(&scene, &Sum { joint, spring });
        }
        if is_damped {
            let (joint, spring) = (damping, |_: &SpringTerm| 0.0);
            rates.damped = self.fastest(&scene, &Sum { joint, spring });
        }
        if is_braked {
            let (joint, spring) = (braking, SpringTerm::damping);
            rates.braked = self.fastest(&scene, &Sum { joint, spring });
        }
        rates
    }

    fn prepare(&mut self, scene: &Scene) {
        let Scene { tree, here, .. } = *scene;
        if tree.long {
            self.y.fill(0.0);
            self.still.fill(0.0);
            self.solve(scene);
            self.still.copy_from_slice(&self.x);
        } else {
            self.factor.copy_from_slice(&here.kin.M);
            tree.sparsity.factor(&mut self.factor);
        }
    }

    /// The largest eigenvalue of `M⁻¹` times a matrix, or a little less.
    fn fastest<J, S>(&mut self, scene: &Scene, matrix: &Sum<J, S>) -> f64
    where
        J: Fn(&JointTerm) -> f64,
        S: Fn(&SpringTerm) -> f64,
    {
        let Scene { tree, here, .. } = *scene;
        // Neighbours move against each other, as they do in the fastest motion of a chain, and no
        // two by the same, so that no motion is left out by its symmetry.
        self.x.fill(0.0);
        let (mut share, mut sign) = (0.5, 1.0);
        for dof in tree.worked_dofs() {
            self.x[dof] = sign * share * here.kin.inverse_diagonal[dof].sqrt();
            sign = -sign;
            // The golden ratio, whose multiples lie evenly: between 0.5 and 1.5 here.
            share += 0.618;
            if share > 1.5 {
                share -= 1.0;
            }
        }
        let mut rate = 0.0;
        self.apply(scene, matrix);
        for _ in 0..RATE_ROUNDS {
            self.solve(scene);
            let below = self.product(tree);
            self.apply(scene, matrix);
            let next = self.product(tree) / below;
            if !(next > 0.0 && next.is_finite()) {
                break;
            }
            rate = next;
            // Neither grows nor fades in the rounds.
            self.x.iter_mut().for_each(|x| *x /= rate);
            self.y.iter_mut().for_each(|y| *y /= rate);
        }
        rate
    }

    fn product(&self, tree: &Tree) -> f64 {
        let worked = tree.worked_dofs();
        worked.map(|dof| self.x[dof] * self.y[dof]).sum()
    }

    /// `x = M⁻¹ y`.
    fn solve(&mut self, scene: &Scene) {
        let Scene { tree, here, v } = *scene;
        if !tree.long {
            self.x.copy_from_slice(&self.y);
            tree.sparsity.solve(&self.factor, &mut self.x);
            return;
        }
        let (kin, armature, y) = (&here.kin, &tree.dofs.armature, &self.y);
        let (none, x) = ((&[][..], 0.0), &mut self.x);
        self.articulated
            .accelerations_with(tree, kin, v, armature, y, none, x);
        for (x, still) in self.x.iter_mut().zip(&self.still) {
            *x -= still;
        }
    }

    /// `y` = the matrix times `x`.
    fn apply<J, S>(&mut self, scene: &Scene, matrix: &Sum<J, S>)
    where
        J: Fn(&JointTerm) -> f64,
        S: Fn(&SpringTerm) -> f64,
    {
        let Scene { tree, here, .. } = *scene;
        self.y.fill(0.0);
        for term in &here.terms.joints {
            self.y[term.dof] = (matrix.joint)(term) * self.x[term.dof];
        }
        let springs = &here.terms.springs;
        if springs.iter().all(|spring| (matrix.spring)(spring) <= 0.0) {
            return;
        }
        forward(tree, &here.kin.S, &self.x, &mut self.V);
        self.F.fill([0.0; 6]);
        for spring in springs {
            spring.act(
                &spring.along(&spring.relative(&self.V), (matrix.spring)(spring)),
                &mut self.F,
            );
        }
        pull_back(tree, &here.kin, &mut self.F, &mut self.y);
    }
}

fn stiffness(term: &JointTerm) -> f64 {
    match term.drive {
        Drive::Pd { kp, .. } => kp,
        _ => 0.0,
    }
}

fn damping(term: &JointTerm) -> f64 {
    let kd = match term.drive {
        Drive::Pd { kd, .. } => kd,
        _ => 0.0,
    };
    term.damping + kd
}

/// Whether a pd law swings or is at its effort limit.
pub(super) fn swings(term: &JointTerm, here: &Point, v: &[f64]) -> bool {
    let Drive::Pd {
        offset,
        kp,
        kd,
        cap,
    } = term.drive
    else {
        return false;
    };
    let damping = kd + term.damping;
    // ζ² = (kd/2)²/(kp M)
    let inverse = here.kin.inverse_diagonal[term.dof];
    let swings = damping * damping * inverse < 4.0 * SWINGING * SWINGING * kp;
    let limited = (offset - kd * v[term.dof]).abs() > cap;
    kp > 0.0 && (swings || limited)
}
