//! Friction cones in a solve: what Newton's direction foresees of them, and the error that is left
//! because they lag behind the normal forces.
//!
//! With cones that are constant, Newton's direction `d` solves `H d = −g`. But friction that slips
//! changes with the load of its contact, and that load with `d`: with the rows `W` of what cones
//! grow by and the impulses `U` of friction at cones that grow, `(H − U W) d = −g`. `H − U W` is
//! not symmetric. Its solution is found from that of `H`: the growth `z = W d` of the cones solves
//! `z = W d₀ + C z` with `d₀ = −H⁻¹ g` and `C = W H⁻¹ U`, see [`Terms::foresee_next`]; then
//! `d = d₀ + H⁻¹ U z`. Taken before the line search, cones that have grown by `z` are those of a
//! convex cost again, whose gradient is `g − U z`, so that `d` is Newton's direction for it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Factor, Frame, Newton, Outcome, Problem, Run, project};
use crate::force::{Response, Terms};
use crate::kinematics::{Kinematics, forward};
use crate::tree::Tree;
use crate::tuning::MAX_CARRIES;

impl Newton {
    /// Minimises from the guess, with the friction cones that it finds itself, and returns how that
    /// went and what the cones still lag behind, see [`Self::lag`].
    ///
    /// - `bound`: what they may lag behind, rad/s; infinite where they stay as they are
    /// - `shared`: a factor that does for the first Hessian, if there is one
    pub fn solve_with_cones(
        &mut self,
        frame: &Frame,
        terms: &mut Terms,
        bound: f64,
        shared: Option<&Factor>,
    ) -> (Outcome, f64) {
        let (mut run, mut carried, mut last) = (Run::default(), 0, f64::INFINITY);
        let moves = bound < f64::INFINITY;
        let (mut factor, mut changed, mut lag) = (shared, true, 0.0);
        loop {
            let given = factor.take();
            let ended = self.aim(&frame.with(terms), &mut run, given);
            if ended.is_none() {
                if moves && carried < MAX_CARRIES {
                    self.foresee((frame.tree, frame.kin), (terms, frame.h), given, bound);
                }
                self.walk(&frame.with(terms));
            }
            // An iteration that ends the run moves nothing.
            if moves && (changed || ended.is_none()) {
                lag = self.lag(&frame.with(terms), shared);
            }
            changed = lag > bound && carried < MAX_CARRIES;
            if changed {
                // Those that halve what cones lag behind lead to an end by themselves.
                let halves = lag < 0.5 * last;
                carried += usize::from(!halves);
                last = lag;
                self.carry_here(terms, frame.h);
            } else if let Some(outcome) = ended {
                return (outcome, lag);
            }
        }
    }

    /// Sets the friction cones of `terms` to the normal forces of the responses over `h` seconds,
    /// where these act, and the friction of the responses to the new cones.
    pub fn carry(&mut self, (tree, kin): (&Tree, &Kinematics), terms: &mut Terms, h: f64) {
        forward(tree, &kin.S, &self.v, &mut self.V);
        self.carry_here(terms, h);
    }

    /// The same where the velocities of all bodies are known: of a guess, and after [`Self::lag`].
    pub fn carry_here(&mut self, terms: &mut Terms, h: f64) {
        terms.center(&self.responses);
        terms.carry(&self.responses, h);
        terms.rub(&self.V, &mut self.at, h, &mut self.responses);
    }

    /// Turns the direction to the one that foresees its own friction cones, and lets the cones of
    /// `terms` grow to these.
    ///
    /// - `factor`: that of the direction, where it is not this solve's own
    /// - `bound`: largest error of a velocity, weighted, that may be left to first order, rad/s
    pub fn foresee(
        &mut self,
        (tree, kin): (&Tree, &Kinematics),
        (terms, h): (&mut Terms, f64),
        factor: Option<&Factor>,
        bound: f64,
    ) {
        if !self.responses.contacts.iter().any(Response::slips) {
            return;
        }
        forward(tree, &kin.S, &self.direction, &mut self.V);
        let growth = &mut self.growth;
        if !terms.foresee(&self.V, &self.responses, h, growth) {
            return;
        }
        let most = self.follow((tree, kin), (terms, h, 0), factor);
        let mut shares = [1.0, 0.0];
        if most <= bound {
            self.turn(1.0);
        } else {
            forward(tree, &kin.S, &self.turned, &mut self.V);
            let [share, rest] = terms.foresee_next(&self.V, &self.responses, h, &mut self.growth);
            if most * rest <= bound {
                shares = [share, 0.0];
            } else {
                shares = [1.0, share];
                self.turn(1.0);
                self.follow((tree, kin), (terms, h, 1), factor);
            }
            self.turn(share);
        }
        let growth = (&self.growth[..], shares);
        terms.grow(&self.at, growth, h, &mut self.responses);
    }

    /// Finds what a part of the growth of the cones changes of the direction, and returns the
    /// largest of it, weighted, rad/s.
    fn follow(
        &mut self,
        (tree, kin): (&Tree, &Kinematics),
        (terms, h, part): (&Terms, f64, usize),
        factor: Option<&Factor>,
    ) -> f64 {
        self.clear_forces(tree);
        let growth = (&self.growth[..], part);
        terms.add_growth((&self.responses, h), growth, &mut self.F);
        self.answer((tree, kin), factor)
    }

    /// Finds what the impulses in `F` change of velocities, and returns the largest of it,
    /// weighted, rad/s.
    fn answer(&mut self, (tree, kin): (&Tree, &Kinematics), factor: Option<&Factor>) -> f64 {
        let Self { pull, turned, .. } = self;
        pull.fill(0.0);
        project((tree, kin), &self.loaded, &mut self.F, |dof, f| {
            pull[dof] += f;
        });
        turned.copy_from_slice(pull);
        let factor = factor.unwrap_or(&self.factor);
        factor.solve((tree, &kin.loops), turned, &mut self.lagging);
        tree.longest(|k| [turned[k]])
    }

    /// Adds a share of what [`Self::follow`] has found to the direction.
    fn turn(&mut self, share: f64) {
        for (d, x) in self.direction.iter_mut().zip(&self.turned) {
            *d += share * x;
        }
        for (g, f) in self.gradient.iter_mut().zip(&self.pull) {
            *g -= share * f;
        }
        for (sum, x) in self.forces.iter_mut().zip(&self.lagging) {
            *sum += share * x;
        }
    }

    /// Largest error of a velocity, weighted and to first order, rad/s, that comes from friction
    /// whose cones belong to other normal forces than those of the solution, or whose place is not
    /// where these act. Friction that sticks outside the cone of its load would slip: what it does
    /// too much moves a mass, not a spring.
    ///
    /// - `factor`: that of the Hessian, where the solve has not needed one of its own
    pub fn lag(&mut self, p: &Problem, factor: Option<&Factor>) -> f64 {
        if !p.terms.may_lag(&self.responses, p.h) {
            return 0.0;
        }
        self.clear_forces(p.tree);
        forward(p.tree, &p.kin.S, &self.v, &mut self.V);
        let at = (&self.V[..], &self.at);
        if !p.terms.add_lag(at, &self.responses, p.h, &mut self.F) {
            return 0.0;
        }
        let factor = factor.filter(|_| !self.factored);
        if factor.is_none() {
            self.factor(p);
        }
        let freed = p.terms.freed(&self.responses, p.h);
        self.answer((p.tree, p.kin), factor).max(freed)
    }
}
