//! The convex step: the velocity at the end of a step minimises
//!
//! ```text
//! ℓ(v) = ½ (v − v0)ᵀ M (v − v0) + h k(q0, v0)ᵀ v + Σ ℓ_c(v_c)
//! ```
//!
//! over contacts, limits, friction and actuators `c`, each convex in its velocity `v_c` with
//! impulse `γ = −∂ℓ_c/∂v_c` and stiffness `G = ∂²ℓ_c/∂v_c²`. Newton with a safeguarded line search
//! converges from any guess:
//!
//! - gradient `g = M (v − v0) + h k − Jᵀγ`: impulses are summed up tip to base like forces, no
//!   Jacobian is formed. What is kept is the change of momentum `M (v − v0)`, small like the
//!   impulses, not `M v`, whose digits they would be lost in;
//! - Hessian `H = M + Jᵀ G J`: a contact's stiffness is a 6×6 matrix on its body, composed and
//!   projected like a composite rigid body, so `H` has the sparsity of `M`.
//!
//! Source: Castro et al. 2022 (SAP), Castro et al. 2023 (ICF); Featherstone 2008, chapter 6.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod balance;
mod cones;
mod factor;
mod hessian;
mod line_search;
mod problem;

use crate::closure::Rows;
use crate::force::{ContactSet, Growth, Response, Responses, Solved, Terms, Velocities};
use crate::kinematics::{Kinematics, forward};
use crate::spatial::{Vec6, add6, dot6};
use crate::tree::Tree;
use crate::tuning::MAX_ITERATIONS;

pub use factor::Factor;
pub use problem::{Frame, Problem, coarser};

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Newton iterations; 0 if the guess was good.
    pub iterations: usize,
    /// Whether the gradient is below the tolerance.
    pub converged: bool,
}

/// How far a solve has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run {
    /// Newton iterations.
    pub iterations: usize,
    /// Whether the round-off of each tree's momenta has been measured.
    rounded: bool,
}

/// Round-off in the balance of one tree.
#[derive(Clone, Copy, Debug, Default)]
struct RoundOff {
    /// Of its momenta, squared.
    momenta: f64,
    /// Of contact impulses of 1 N·s that cancel along every joint, squared.
    per_impulse: f64,
    /// Impulses of its contacts, (N·s)².
    impulses: f64,
}

#[cfg(test)]
crate::spoil::spoil!(RoundOff: momenta per_impulse impulses;);

/// The minimiser and its scratch.
#[derive(Clone, Debug)]
pub struct Newton {
    /// Solution, `nv`.
    pub v: Vec<f64>,
    /// Velocities of contacts at the solution.
    pub at: Velocities,
    /// Responses at the solution.
    pub responses: Responses,
    /// Change of momentum `M (v − v0)` at the solution.
    pub(super) change: Vec<f64>,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    direction_momentum: Vec<f64>,
    factor: Factor,
    /// Whether it holds the factor of the last solve's last Hessian.
    factored: bool,
    V: Vec<Vec6>,
    /// Velocities of contacts along `direction`.
    along: Velocities,
    F: Vec<Vec6>,
    G: Vec<[f64; 21]>,
    /// Bodies with contacts in their subtree, tips first.
    loaded: Vec<usize>,
    is_loaded: Vec<bool>,
    /// Impulses of closed loops, one a row, N·s; those against friction whose cones grow.
    forces: Vec<f64>,
    lagging: Vec<f64>,
    /// What the forces of loops leave of the gradient.
    left: Vec<f64>,
    /// Squared scale of the impulses of joints and of contacts along each degree of freedom.
    pushed: Vec<[f64; 2]>,
    round_off: Vec<RoundOff>,
    /// Impulses of friction whose cones grow along every degree of freedom, N·m·s, and what they
    /// change of the direction.
    pull: Vec<f64>,
    turned: Vec<f64>,
    /// By how much friction cones grow.
    growth: Vec<Growth>,
}

#[cfg(test)]
crate::spoil::spoil!(
    Newton: v at responses change gradient direction direction_momentum factor factored V
    along F G loaded is_loaded forces left pushed round_off lagging pull turned growth;
);

impl Newton {
    /// Buffers for a tree with at most so many contacts and contact points.
    #[cfg_attr(small, optimize(size))]
    pub fn new(tree: &Tree, contacts: [usize; 2]) -> Self {
        let (nb, nv) = (tree.bodies.len(), tree.sparsity.len());
        Self {
            v: vec![0.0; nv],
            at: Velocities::new(contacts).with(tree.springs.len()),
            responses: Responses::new(contacts, nv).with(tree.springs.len()),
            change: vec![0.0; nv],
            gradient: vec![0.0; nv],
            direction: vec![0.0; nv],
            direction_momentum: vec![0.0; nv],
            factor: Factor::new(tree),
            factored: false,
            V: vec![[0.0; 6]; nb],
            along: Velocities::new(contacts).with(tree.springs.len()),
            F: vec![[0.0; 6]; nb],
            G: vec![[0.0; 21]; nb],
            loaded: Vec::with_capacity(nb),
            is_loaded: vec![false; nb],
            forces: Vec::with_capacity(Rows::most(tree)),
            left: vec![0.0; nv],
            pushed: vec![[0.0; 2]; nv],
            round_off: vec![RoundOff::default(); tree.trees.len()],
            pull: vec![0.0; nv],
            turned: vec![0.0; nv],
            lagging: Vec::with_capacity(Rows::most(tree)),
            growth: Vec::with_capacity(contacts[0]),
        }
    }

    /// Takes the velocity at the start of the step as the guess.
    pub fn guess_start(&mut self, p: &Problem, v0: &[f64]) {
        self.v.copy_from_slice(v0);
        self.change.fill(0.0);
        if p.tree.driven().next().is_some() {
            return self.guess(p, v0, v0);
        }
        self.at.set(p.terms, &p.kin.V);
        self.respond(p, true);
    }

    /// Takes any velocity `v` as the guess, of a step that starts with `v0`.
    pub fn guess(&mut self, p: &Problem, v0: &[f64], v: &[f64]) {
        self.take(p, v0, v);
        self.stand(p);
    }

    /// The same, with the friction cones that the guess has.
    pub fn guess_with_cones(
        &mut self,
        (frame, terms): (&Frame, &mut Terms),
        v0: &[f64],
        v: &[f64],
    ) {
        let p = &frame.with(terms);
        self.take(p, v0, v);
        self.move_to(p);
        self.respond(p, false);
        self.carry_here(terms, frame.h);
    }

    /// Takes any velocity `v`, of a step that starts with `v0`, and its momentum.
    fn take(&mut self, p: &Problem, v0: &[f64], v: &[f64]) {
        for ((change, v), v0) in self.v.iter_mut().zip(v).zip(v0) {
            *change = v - v0;
        }
        // Of driven bases the end is known. Their gradient is then exactly 0, so that the large
        // mass by which nothing else moves them takes no digits from anything.
        for (_, first, acceleration) in p.tree.driven() {
            for (change, a) in self.v[first..].iter_mut().zip(acceleration) {
                *change = p.h * a;
            }
        }
        let pattern = &p.tree.sparsity;
        pattern.multiply(&p.kin.M, &self.v, &mut self.change);
        self.v.copy_from_slice(v);
        for (_, first, acceleration) in p.tree.driven() {
            for (k, a) in (first..).zip(acceleration) {
                self.v[k] = v0[k] + p.h * a;
                self.change[k] = -(p.h * p.bias[k]);
            }
        }
    }

    /// Finds the responses at `v`.
    fn stand(&mut self, p: &Problem) {
        self.move_to(p);
        self.respond(p, true);
    }

    /// Finds the velocities of contacts at `v`.
    fn move_to(&mut self, p: &Problem) {
        if !p.terms.is_free() {
            forward(p.tree, &p.kin.S, &self.v, &mut self.V);
        }
        self.at.set(p.terms, &self.V);
    }

    /// - `rubs`: whether friction of contacts is found, too
    fn respond(&mut self, p: &Problem, rubs: bool) {
        self.factored = false;
        self.mark_loaded(p.tree, p.terms);
        let at = (&self.at, rubs);
        p.terms.respond_with(&self.v, at, p.h, &mut self.responses);
    }

    /// Minimises from the guess.
    pub fn solve(&mut self, p: &Problem) -> Outcome {
        let mut run = Run::default();
        loop {
            if let Some(outcome) = self.iterate(p, &mut run, None) {
                return outcome;
            }
        }
    }

    /// The factor of the last Hessian of this solve, for another one of the same length: that of
    /// `p`, at its guess `next`. None unless the same points touch, press, stick and slip.
    ///
    /// - `contacts`: those of this solve
    pub fn factor_for(&self, contacts: &ContactSet, next: &Self, p: &Problem) -> Option<&Factor> {
        let regime = |r: &Response| (r.presses(), r.friction.around > 0.0, r.slips());
        let now = p.terms.contacts.iter().zip(&next.responses.contacts);
        let then = contacts.iter().zip(&self.responses.contacts);
        let alike = self.factored
            && contacts.len() == p.terms.contacts.len()
            && now
                .zip(then)
                .all(|((c, r), (d, s))| c.slot == d.slot && regime(r) == regime(s));
        alike.then_some(&self.factor)
    }

    /// Forces and bias times the length of the step at the solution, N·m·s.
    pub(super) fn forces_found(&self, out: &mut [f64]) {
        for (out, (change, gradient)) in out.iter_mut().zip(self.change.iter().zip(&self.gradient))
        {
            *out = change - gradient;
        }
    }

    /// Ends a run where the responses balance, or cannot be made to; else iterates once.
    ///
    /// - `factor`: does for that of the Hessian, if there is one
    pub fn iterate(
        &mut self,
        p: &Problem,
        run: &mut Run,
        factor: Option<&Factor>,
    ) -> Option<Outcome> {
        let ended = self.aim(p, run, factor);
        if ended.is_none() {
            self.walk(p);
        }
        ended
    }

    /// Ends a run where the responses balance, or cannot be made to; else finds Newton's direction.
    ///
    /// - `factor`: does for that of the Hessian, if there is one
    pub fn aim(&mut self, p: &Problem, run: &mut Run, factor: Option<&Factor>) -> Option<Outcome> {
        let Problem { tree, kin, .. } = *p;
        self.collect(p);
        let closed = !kin.loops.is_empty();
        let first = run.iterations == 0;
        if closed && !first {
            self.leave(p);
        }
        let accuracy = if first { p.accuracy } else { p.iterated };
        let [finite, good] = self.balance(p, run, accuracy, closed && !first);
        // Of a guess, the forces of loops are not known.
        let converged = finite && good && !(closed && first);
        if converged || run.iterations >= MAX_ITERATIONS || !finite {
            return Some(Outcome {
                iterations: run.iterations,
                converged,
            });
        }
        run.iterations += 1;
        if factor.is_none() {
            self.assemble(p);
            self.factor.factor(tree, &kin.loops);
            self.factored = true;
        }
        if closed && first {
            self.close(p, factor);
            self.collect(p);
        }
        for (x, g) in self.direction.iter_mut().zip(&self.gradient) {
            *x = -g;
        }
        let factor = factor.unwrap_or(&self.factor);
        factor.solve((tree, &kin.loops), &mut self.direction, &mut self.forces);
        None
    }

    /// Goes along the direction to the least cost.
    pub fn walk(&mut self, p: &Problem) {
        let alpha = self.line_search(p);
        for (v, w) in self.v.iter_mut().zip(&self.direction) {
            *v += alpha * w;
        }
        for (m, w) in self.change.iter_mut().zip(&self.direction_momentum) {
            *m += alpha * w;
        }
        self.at.combine(1.0, &self.along, alpha);
    }

    /// Minus the gradient at the velocity `v` of a step that begins with it, N·m·s: forces and bias
    /// times the length of the step. What stands here is lost.
    pub(super) fn forces_at(&mut self, p: &Problem, v: &[f64], out: &mut [f64]) {
        self.v.copy_from_slice(v);
        self.change.fill(0.0);
        self.stand(p);
        self.collect(p);
        for (out, gradient) in out.iter_mut().zip(&self.gradient) {
            *out = -gradient;
        }
    }

    /// The factor of the Hessian at the solution, or of one near it.
    pub(super) fn factor(&mut self, p: &Problem) -> &Factor {
        if !self.factored {
            self.mark_loaded(p.tree, p.terms);
            self.assemble(p);
            self.factor.factor(p.tree, &p.kin.loops);
            self.factored = true;
        }
        &self.factor
    }

    /// Velocities and responses at the solution.
    pub fn solved(&self) -> Solved<'_> {
        Solved {
            v: &self.v,
            at: &self.at,
            responses: &self.responses,
        }
    }

    /// Lists the bodies between the base and any contact or spring, tips first.
    fn mark_loaded(&mut self, tree: &Tree, terms: &Terms) {
        self.is_loaded.fill(false);
        let contacts = terms.contacts.iter().map(|c| (c.body, &c.other));
        let springs = terms.springs.iter().map(|s| (s.body, &s.other));
        for (body, other) in contacts.chain(springs) {
            self.is_loaded[body] = true;
            if let Some(other) = other {
                self.is_loaded[other.body] = true;
            }
        }
        self.loaded.clear();
        for (b, body) in tree.worked_bodies().rev() {
            if self.is_loaded[b] && !body.kind.is_base() {
                self.is_loaded[body.parent] = true;
                self.loaded.push(b);
            }
        }
    }

    /// Gradient from the responses, and the squared scale of the impulses.
    pub fn collect(&mut self, p: &Problem) {
        let Problem { tree, kin, .. } = *p;
        let D2 = &kin.inverse_diagonal;
        for ((g, change), bias) in self.gradient.iter_mut().zip(&self.change).zip(p.bias) {
            *g = change + p.h * bias;
        }
        self.pushed.fill([0.0; 2]);
        for (term, r) in p.terms.joints.iter().zip(&self.responses.joints) {
            self.gradient[term.dof] -= r.impulse;
            self.pushed[term.dof][0] += D2[term.dof] * r.effort * r.effort;
        }
        if p.terms.is_free() {
            return;
        }
        self.clear_forces(p.tree);
        for (contact, response) in p.terms.contacts.iter().zip(&self.responses.contacts) {
            let own = &self.responses.points[contact.points.clone()];
            let points = &p.terms.contacts.points;
            contact.push(points, (response, own), p.h, &mut self.F);
        }
        for (turn, response) in p.terms.turns.iter().zip(&self.responses.turns) {
            turn.act(&response.impulse, &mut self.F);
        }
        for (spring, impulse) in p.terms.springs.iter().zip(&self.responses.springs) {
            spring.act(impulse, &mut self.F);
        }
        let (gradient, pushed) = (&mut self.gradient, &mut self.pushed);
        project((tree, kin), &self.loaded, &mut self.F, |dof, projected| {
            gradient[dof] -= projected;
            pushed[dof][1] += D2[dof] * projected * projected;
        });
    }

    /// Clears the forces on all bodies that have any.
    fn clear_forces(&mut self, tree: &Tree) {
        for &b in &self.loaded {
            self.F[b] = [0.0; 6];
        }
        for (_, tree) in tree.moved() {
            self.F[tree.bodies.start] = [0.0; 6];
        }
    }
}

/// Passes forces on bodies on to their parents, from the tips of the trees to their bases, and what
/// they do along each degree of freedom to `take`.
#[inline]
fn project(
    (tree, kin): (&Tree, &Kinematics),
    loaded: &[usize],
    F: &mut [Vec6],
    mut take: impl FnMut(usize, f64),
) {
    for &b in loaded {
        let body = &tree.bodies[b];
        let own = F[b];
        for c in body.column..body.column + body.columns {
            take(tree.dof[c], dot6(&kin.S[c], &own));
        }
        add6(&mut F[body.parent], &own);
    }
    for (_, tree) in tree.moved().filter(|(_, tree)| tree.free) {
        for (dof, F) in tree.dofs.clone().zip(&F[tree.bodies.start]) {
            take(dof, *F);
        }
    }
}

/// `Σ D² x²`; two running sums, so that two lanes suffice.
#[inline]
fn scaled_square(x: &[f64], D2: &[f64]) -> f64 {
    let (pairs, scales) = (x.chunks_exact(2), D2.chunks_exact(2));
    let last = match (pairs.remainder(), scales.remainder()) {
        ([x], [d]) => d * x * x,
        _ => 0.0,
    };
    let (mut even, mut odd) = (0.0, 0.0);
    for (x, d) in pairs.zip(scales) {
        even += d[0] * x[0] * x[0];
        odd += d[1] * x[1] * x[1];
    }
    even + odd + last
}

#[cfg(test)]
mod tests;
