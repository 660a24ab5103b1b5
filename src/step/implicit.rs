//! One convex solve over a whole step: implicit Euler.
//!
//! Fixed steps fall back on it where an impact passes that two stages would throw back: it is the
//! one method here that never does. Error control falls back on it where a stage has no solution
//! within the digits. Rest, and setting a robot down, ask it for a balance.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::{advance, difference, position_rates};
use crate::model::Model;
use crate::state::Physical;
use crate::state::ahead::Ahead;
use crate::step::attempt::Attempt;
use crate::step::convex::Newton;
use crate::step::point::{Context, Point};
use crate::step::size::worst_error;
use crate::tree::Tree;

/// The method and its scratch.
#[derive(Clone, Debug)]
pub(super) struct Implicit {
    /// Solution over the whole step.
    pub full: Newton,
    /// Way of a step, `nv`.
    way: Vec<f64>,
    /// Rates of the positions at the start and at the end of a step.
    rates: [Vec<f64>; 2],
    /// Most Newton iterations in a solve since the communication step has begun.
    pub iterations: usize,
}

#[cfg(test)]
crate::spoil::spoil!(Implicit: full way rates iterations;);

impl Implicit {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            full: Newton::new(tree, model.contact_room()),
            way: vec![0.0; model.nv()],
            rates: [vec![0.0; model.nq], vec![0.0; model.nq]],
            iterations: 0,
        }
    }

    /// Solves over `h` seconds from where `here` stands; returns the error relative to the
    /// tolerance, infinite if that fails.
    pub fn solve_alone(
        &mut self,
        ctx: &Context,
        (here, from): (&mut Point, &Physical),
        trend: &[f64],
        [h, accuracy]: [f64; 2],
    ) -> f64 {
        here.complete(ctx, from);
        let problem = here.problem(ctx.tree, h, accuracy);
        self.full.guess_start(&problem, &from.v);
        let outcome = self.full.solve(&problem);
        self.iterations = self.iterations.max(outcome.iterations);
        if outcome.converged {
            self.single_error(ctx, from, trend, h)
        } else {
            f64::INFINITY
        }
    }

    /// Error of the solve by itself, relative to the tolerance: positions lag behind by half the
    /// change of velocity, velocities by half the change of acceleration since the last step
    /// (Milne's device).
    ///
    /// - `trend`: acceleration of the last step
    pub fn single_error(&self, ctx: &Context, from: &Physical, trend: &[f64], h: f64) -> f64 {
        let error = |k: usize| {
            let change = self.full.v[k] - from.v[k];
            (0.5 * h * change, 0.5 * (change - h * trend[k]))
        };
        worst_error(ctx.tree, h, error) / ctx.tolerance
    }

    /// Puts the solve over `h` seconds from where `here` stands into `attempt`.
    pub fn take_full(
        &mut self,
        ctx: &Context,
        here: &Point,
        from: &Physical,
        h: f64,
        attempt: &mut Attempt,
    ) {
        attempt.take_solved(ctx.tree, here, &self.full, h);
        advance(ctx.tree, &from.q, &self.full.v, h, &mut attempt.end.q);
        ctx.tree
            .carry_driven((&from.q, &from.v), h, &mut attempt.end.q);
        attempt.add_impulses(&here.terms, &self.full, [h, 1.0]);
        attempt.end_plain_trend(ctx.tree, &from.v, h);
    }

    /// Puts the step of `h` seconds that began at time `start` and reaches beyond the communication
    /// point at `end` into `ahead`: cubic polynomials for positions, their derivatives' kind for
    /// velocities. `attempt` is then where they stand at that point.
    pub fn look_ahead(
        &mut self,
        tree: &Tree,
        from: &Physical,
        [start, h, end]: [f64; 3],
        ahead: &mut Ahead,
        attempt: &mut Physical,
    ) {
        let (q0, v0) = (&from.q, &from.v);
        let Physical { q, v, .. } = attempt;
        let [rate0, rate1] = &mut self.rates;
        position_rates(tree, q0, v0, rate0);
        position_rates(tree, q, v, rate1);
        difference(tree, q, q0, &mut self.way);
        let way = &self.way;
        ahead.begin(
            tree,
            [start, h],
            |i| {
                let change = q[i] - q0[i];
                let bend = h * rate0[i] - change;
                [q0[i], change, bend, change - h * rate1[i] - bend, 0.0]
            },
            |k| {
                let (a, b) = (v0[k], v[k]);
                let bend = 6.0 * way[k] / h - 3.0 * (a + b);
                [a, b - a, bend, 0.0, 0.0]
            },
        );
        ahead.evaluate(tree, end, q, v);
        tree.carry_driven((q0, v0), end - start, q);
    }
}
