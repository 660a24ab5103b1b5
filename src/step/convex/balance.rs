//! Whether all impulses balance, to the round-off of what they come from; and closed loops in a
//! solve: its initial velocity, and the loops' forces.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Factor, Newton, Problem, Run, scaled_square};
use crate::force::{Responses, Terms};
use crate::sparsity::inverse::Inverse;
use crate::spatial::Vec6;
use crate::tree::{Extent, Tree};
use crate::tuning::ROUND_OFF;

/// What is left of the balance of impulses, and what it is measured by; squares, in the scale of
/// degrees of freedom.
#[derive(Clone, Copy, Default)]
struct Balance {
    left: f64,
    bias: f64,
    joints: f64,
    contacts: f64,
    loops: f64,
}

impl Balance {
    /// Impulses set the scale, and not momenta: else free fall would stop accelerating in small
    /// steps.
    fn scale(&self) -> f64 {
        let pushes = self.joints.max(self.contacts);
        self.bias.max(pushes).max(self.loops)
    }

    /// An infinite scale would call anything balanced.
    fn is_finite(&self) -> bool {
        self.left.is_finite() && self.scale().is_finite()
    }

    fn holds(&self, accuracy: f64) -> bool {
        self.left <= accuracy * accuracy * self.scale()
    }
}

impl Newton {
    /// Whether all numbers are finite, and whether the impulses on each tree balance, to the
    /// round-off of what they come from.
    ///
    /// Each tree by itself: what is left of the balance of a house is more than the weight of a
    /// coin that lies on it.
    ///
    /// - `loops`: whether [`Self::leave`] has found what loops leave of the gradient
    pub(super) fn balance(
        &mut self,
        p: &Problem,
        run: &mut Run,
        accuracy: f64,
        loops: bool,
    ) -> [bool; 2] {
        let (mut finite, mut good, mut measured) = (true, true, false);
        for (index, extent) in p.tree.moved() {
            let balance = self.balance_of(p, extent, loops);
            finite &= balance.is_finite();
            if good && !balance.holds(accuracy) {
                if !measured {
                    self.measure(p, run);
                    measured = true;
                }
                let off = &self.round_off[index];
                let floor = off.momenta + off.per_impulse * off.impulses;
                good = balance.left <= floor && floor.is_finite();
            }
        }
        [finite, good]
    }

    /// The balance of one tree.
    fn balance_of(&self, p: &Problem, extent: &Extent, loops: bool) -> Balance {
        let places = extent.dofs.clone();
        let D2 = &p.kin.inverse_diagonal[places.clone()];
        let gradient = &self.gradient[places.clone()];
        let mut balance = Balance {
            bias: p.h * p.h * scaled_square(&p.bias[places.clone()], D2),
            ..Balance::default()
        };
        for [joint, contact] in &self.pushed[places.clone()] {
            balance.joints += joint;
            balance.contacts += contact;
        }
        if loops {
            let left = &self.left[places];
            let held = gradient.iter().zip(left).zip(D2);
            balance.loops = held.map(|((g, left), d)| d * (g - left) * (g - left)).sum();
            balance.left = scaled_square(left, D2);
        } else {
            balance.left = scaled_square(gradient, D2);
        }
        balance
    }

    /// Measures the round-off of each tree, of its velocities once in a run.
    fn measure(&mut self, p: &Problem, run: &mut Run) {
        let Problem { tree, kin, h, .. } = *p;
        for (index, extent) in tree.moved() {
            let off = &mut self.round_off[index];
            off.impulses = 0.0;
            if run.rounded {
                continue;
            }
            let (mut energy, mut lightest) = (0.0, 0.0_f64);
            for k in extent.dofs.clone() {
                let scale = kin.inverse_diagonal[k];
                if scale > 0.0 {
                    energy += kin.M[tree.sparsity.diagonal(k)] * self.v[k] * self.v[k];
                }
                lightest = lightest.max(scale);
            }
            let lever = 1.0 + extent.reach;
            off.momenta = ROUND_OFF * ROUND_OFF * energy;
            off.per_impulse = ROUND_OFF * ROUND_OFF * lightest * lever * lever;
        }
        run.rounded = true;
        for term in &p.terms.joints {
            let opposed = term.opposed(self.v[term.dof], h);
            let own = |(_, extent): &(usize, &Extent)| extent.dofs.contains(&term.dof);
            if let Some((index, _)) = tree.moved().find(own).filter(|_| opposed > 0.0) {
                self.round_off[index].impulses += opposed * opposed;
            }
        }
        let Responses {
            contacts, turns, ..
        } = &self.responses;
        let of_contacts = p.terms.contacts.iter().zip(contacts).map(|(contact, r)| {
            let friction = h * h * r.friction.force.norm_squared();
            let other = contact.other.as_ref().map(|other| other.body);
            (contact.body, other, r.load * r.load + friction)
        });
        let of_turns = p.terms.turns.iter().zip(turns);
        let of_turns = of_turns.map(|(t, r)| (t.body, t.other, r.impulse.norm_squared()));
        for (body, other, impulse) in of_contacts.chain(of_turns) {
            let tree_of = |body: usize| tree.bodies[body].tree;
            let (own, other) = (tree_of(body), other.map(tree_of));
            for index in std::iter::once(own).chain(other.filter(|other| *other != own)) {
                self.round_off[index].impulses += impulse;
            }
        }
    }

    /// Whether what stands still stays: the impulses on all trees together balance at `v = 0`.
    /// Those on each do not where a coin lies on the spring of a house, by less than the digits of
    /// a place.
    pub fn is_balanced(&mut self, p: &Problem) -> bool {
        self.v.fill(0.0);
        self.change.fill(0.0);
        self.V.fill([0.0; 6]);
        self.at.set(p.terms, &self.V);
        self.respond(p, true);
        self.collect(p);
        let closed = !p.kin.loops.is_empty();
        if closed {
            self.balance_loops(p);
            self.leave(p);
        }
        let mut all = Balance::default();
        for (_, extent) in p.tree.moved() {
            let one = self.balance_of(p, extent, closed);
            all.left += one.left;
            all.bias += one.bias;
            all.joints += one.joints;
            all.contacts += one.contacts;
            all.loops += one.loops;
        }
        all.is_finite() && all.holds(p.accuracy)
    }

    /// Finds what the forces of loops leave of the gradient.
    pub(super) fn leave(&mut self, p: &Problem) {
        self.left.copy_from_slice(&self.gradient);
        p.kin.loops.subtract(p.tree, &self.forces, &mut self.left);
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
}
