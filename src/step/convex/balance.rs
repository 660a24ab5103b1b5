//! Whether all impulses balance, to the round-off of what they come from; and closed loops in a
//! solve: its initial velocity, and the loops' forces.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Factor, Newton, Problem, scaled_square};
use crate::force::{Responses, Terms};
use crate::sparsity::inverse::Inverse;
use crate::spatial::Vec6;
use crate::tree::Tree;
use crate::tuning::ROUND_OFF;

impl Newton {
    /// Whether a robot that stands still stays: all impulses balance at `v = 0`.
    pub fn is_balanced(&mut self, p: &Problem) -> bool {
        self.v.fill(0.0);
        self.change.fill(0.0);
        self.V.fill([0.0; 6]);
        self.at.set(p.terms, &self.V);
        self.respond(p);
        let impulse_scale = self.collect(p);
        let D2 = &p.kin.inverse_diagonal;
        let [norm, loop_scale] = if p.kin.loops.is_empty() {
            [scaled_square(p.tree, &self.gradient, D2), 0.0]
        } else {
            self.balance_loops(p);
            self.closed_norm(p)
        };
        let scale = impulse_scale.max(p.h * p.h * scaled_square(p.tree, p.bias, D2));
        let scale = scale.max(loop_scale);
        scale.is_finite() && norm <= p.accuracy * p.accuracy * scale
    }

    /// Squared scale of what velocities' round-off does to momenta, at the velocity that stands in
    /// `v`.
    pub(super) fn round_off(&self, p: &Problem) -> f64 {
        let pattern = &p.tree.sparsity;
        let energy = |k: usize| {
            if p.kin.inverse_diagonal[k] == 0.0 {
                return 0.0;
            }
            p.kin.M[pattern.diagonal(k)] * self.v[k] * self.v[k]
        };
        let sum: f64 = p.tree.worked_dofs().map(energy).sum();
        ROUND_OFF * ROUND_OFF * sum
    }

    /// Squared impulses of all contacts, (N·s)².
    pub(super) fn impulses(&self, p: &Problem) -> f64 {
        let Responses {
            contacts, turns, ..
        } = &self.responses;
        let contacts = contacts.iter().map(|r| {
            let friction = p.h * p.h * r.friction.force.norm_squared();
            r.load * r.load + friction
        });
        let sum: f64 = turns.iter().map(|r| r.impulse.norm_squared()).sum();
        contacts.sum::<f64>() + sum
    }

    /// Squared scales of what the forces of loops leave of the gradient, and of these forces, in
    /// the scale of degrees of freedom.
    pub(super) fn closed_norm(&mut self, p: &Problem) -> [f64; 2] {
        let Problem { tree, kin, .. } = *p;
        self.left.copy_from_slice(&self.gradient);
        kin.loops.subtract(tree, &self.forces, &mut self.left);
        let D2 = &kin.inverse_diagonal;
        let norm = scaled_square(tree, &self.left, D2);
        for (left, gradient) in self.left.iter_mut().zip(&self.gradient) {
            *left = gradient - *left;
        }
        [norm, scaled_square(tree, &self.left, D2)]
    }

    /// Finds the forces of loops that leave the least of the gradient, in the scale of degrees of
    /// freedom.
    pub(super) fn balance_loops(&mut self, p: &Problem) {
        let Problem { tree, kin, .. } = *p;
        let (rows, D2) = (&kin.loops, &kin.inverse_diagonal);
        let inverse = Inverse::Diagonal(&tree.sparsity, D2);
        self.factor.closed.factor(tree, rows, &inverse);
        self.factored = false;
        self.forces.clear();
        for (left, (g, d)) in self.left.iter_mut().zip(self.gradient.iter().zip(D2)) {
            *left = g * d;
        }
        let along = (0..rows.len()).map(|row| rows.along(tree, row, &self.left));
        self.forces.extend(along);
        self.factor.closed.solve(&mut self.forces);
    }

    /// Power of what drives bases against contacts and springs at the solution, W: what these do to
    /// a base is taken from it. Their forces are those that [`Self::collect`] has found last.
    pub(in crate::step) fn driving_power(&self, p: (&Tree, &Terms), h: f64) -> f64 {
        let (tree, terms) = p;
        if terms.is_free() {
            return 0.0;
        }
        let power = |(body, first, _): (usize, usize, &Vec6)| {
            let v = &self.v[first..first + 6];
            let along: f64 = self.F[body].iter().zip(v).map(|(F, v)| F * v).sum();
            -along / h
        };
        tree.driven().map(power).sum()
    }

    /// Changes the velocity, by forces of loops alone, to one that fulfils the rows of loops at the
    /// end of the step; later changes of the solve keep them fulfilled.
    ///
    /// - `factor`: used in place of the Hessian's own, if there is one
    pub(super) fn close(&mut self, p: &Problem, factor: Option<&Factor>) {
        let Problem { tree, kin, .. } = *p;
        let rows = &kin.loops;
        let schur = factor.map_or(&self.factor.closed, |factor| &factor.closed);
        self.forces.clear();
        let missing = |row| -p.ahead * rows.bias[row] - rows.along(tree, row, &self.v);
        self.forces.extend((0..rows.len()).map(missing));
        schur.solve(&mut self.forces);
        tree.clear_velocities(&mut self.direction);
        schur.push(&self.forces, &mut self.direction);
        for k in tree.worked_dofs() {
            self.v[k] += self.direction[k];
        }
        tree.sparsity
            .multiply(&kin.M, &self.direction, &mut self.direction_momentum);
        for k in tree.worked_dofs() {
            self.change[k] += self.direction_momentum[k];
        }
        let factored = self.factored;
        self.stand(p);
        self.factored = factored;
    }

    /// Squared scale of the round-off that contact impulses of 1 N·s leave where they cancel along
    /// every joint.
    pub(super) fn impulse_round_off(p: &Problem) -> f64 {
        let D2 = &p.kin.inverse_diagonal;
        let dofs = p.tree.worked_dofs();
        let lightest = dofs.fold(0.0, |m: f64, k| m.max(D2[k]));
        let lever = 1.0 + p.tree.reach();
        ROUND_OFF * ROUND_OFF * lightest * lever * lever
    }
}
