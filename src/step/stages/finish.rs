//! What a step that has been solved leads to: its end, and the work that it takes.

use super::{GAMMA, Stages};
use crate::kinematics::{advance, wind};
use crate::state::Physical;
use crate::step::attempt::Attempt;
use crate::step::point::{Context, Point};
use crate::step::{coast, guards};
use std::f64::consts::SQRT_2;

/// What a step is taken by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::step) enum By {
    /// Both stages.
    Stages,
    /// The first of them, where it ends.
    FirstStage,
    /// One solve over all of it.
    OneSolve,
}

impl By {
    /// Length of the step, s, of one of `h` seconds that has been solved.
    pub(in crate::step) fn length(self, h: f64) -> f64 {
        if self == Self::FirstStage {
            GAMMA * h
        } else {
            h
        }
    }
}

impl Stages {
    /// Work of motors and external wrenches over the step of `h` seconds, J.
    pub fn work(&self, ctx: &Context, h: f64) -> f64 {
        let eta = GAMMA * h;
        let mut work = 0.0;
        for ((terms, solved), [share, end]) in self
            .terms
            .iter()
            .zip(&self.solved)
            .zip([[(1.0 - GAMMA) * h, eta], [eta, h]])
        {
            let (parts, when) = ((terms, solved), ctx.elapsed + end);
            work += share / eta * guards::work(ctx, &self.middle.kin, parts, [eta, when]);
        }
        work
    }

    /// Puts the result of the step of `h` seconds into `attempt`.
    pub fn finish(
        &mut self,
        ctx: &Context,
        (here, from): (&Point, &Physical),
        h: f64,
        attempt: &mut Attempt,
    ) {
        let eta = GAMMA * h;
        let [first, second] = &self.solved;
        let [before, terms] = &self.terms;
        ctx.tree.copy_velocities(&second.v, &mut attempt.end.v);
        terms.remember(&second.solved(), eta, &mut attempt.end.memory);
        for (moved, (v1, v2)) in self.moved.iter_mut().zip(first.v.iter().zip(&second.v)) {
            *moved = (1.0 - GAMMA) * v1 + GAMMA * v2;
        }
        // What the second stage changes, as that of a whole step: an impact is over in the first.
        for (change, (v1, v2)) in self.guess.iter_mut().zip(first.v.iter().zip(&second.v)) {
            *change = (v2 - v1) / (1.0 - GAMMA);
        }
        wind(ctx.tree, &self.guess, h, &mut self.moved);
        advance(ctx.tree, &from.q, &self.moved, h, &mut attempt.end.q);
        let step = coast::Step {
            from,
            h,
            terms: &self.terms,
            solved: &self.solved,
        };
        coast::go_on(ctx, &here.kin, step, &mut attempt.end);
        ctx.tree
            .carry_driven((&from.q, &from.v), h, &mut attempt.end.q);
        attempt.add_impulses(before, first, [eta, 1.0 + SQRT_2]);
        attempt.add_impulses(terms, second, [eta, 1.0]);
        attempt.end_trend(ctx.tree, &from.v, h, (&first.v, eta));
    }

    /// Work of motors and external wrenches over the first stage of the step of `h` seconds, J.
    pub fn first_work(&self, ctx: &Context, h: f64) -> f64 {
        let (eta, parts) = (GAMMA * h, (&self.terms[0], &self.solved[0]));
        guards::work(ctx, &self.middle.kin, parts, [eta, ctx.elapsed + eta])
    }

    /// Puts the first stage of the step of `h` seconds into `attempt`, which ends there.
    pub fn finish_first(&self, ctx: &Context, from: &Physical, h: f64, attempt: &mut Attempt) {
        let (eta, terms, first) = (GAMMA * h, &self.terms[0], &self.solved[0]);
        ctx.tree.copy_velocities(&first.v, &mut attempt.end.v);
        terms.remember(&first.solved(), eta, &mut attempt.end.memory);
        advance(ctx.tree, &from.q, &first.v, eta, &mut attempt.end.q);
        ctx.tree
            .carry_driven((&from.q, &from.v), eta, &mut attempt.end.q);
        attempt.add_impulses(terms, first, [eta, 1.0]);
        attempt.end_plain_trend(ctx.tree, &from.v, eta);
    }
}
