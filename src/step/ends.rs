//! Beginning and end of a try: the solution is written into it, and its loops are closed.

use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::guards;
use crate::step::point::Context;
use crate::step::stages::finish::By;
use crate::step::stages::secants::Ending;
use crate::tuning::{CONTROLLED_GAIN, HIT};

impl Stepper {
    /// Enters a try, and refuses it where there have been too many.
    pub(super) fn begin_try(&mut self, ctx: &Context) -> Result<(), Stop> {
        self.tried += 1;
        self.closing.apart = None;
        if self.tried > ctx.budget {
            Err(Stop::Budget)
        } else {
            Ok(())
        }
    }

    /// Why the last try has failed, at the smallest step.
    pub(super) fn failure(&self) -> Stop {
        self.closing.apart.map_or(Stop::NotFinite, Stop::Apart)
    }

    /// Closes the loops at the end of the try; returns how far this has moved it, relative to the
    /// tolerance.
    ///
    /// - `h`: length of the step, s
    pub(super) fn close(&mut self, ctx: &Context, h: f64) -> f64 {
        let end = &mut self.attempt.end;
        let moved = self.closing.close(ctx.tree, &mut self.there.kin, end, h);
        moved / ctx.tolerance
    }

    /// Puts the step of `h` seconds that has been solved, as `by` says, into `self.attempt`;
    /// returns what closing its loops adds to its error.
    pub(super) fn finish(&mut self, ctx: &Context, state: &State, by: By, h: f64) -> f64 {
        self.attempt.begin(state);
        let (from, attempt) = (&state.physical, &mut self.attempt);
        match by {
            By::Stages => self.stages.finish(ctx, (&self.here, from), h, attempt),
            By::FirstStage => self.stages.finish_first(ctx, from, h, attempt),
            By::OneSolve => self.implicit.take_full(ctx, &self.here, from, h, attempt),
        }
        self.close(ctx, by.length(h))
    }

    /// Puts a step that has been solved, as `by` says, into `self.attempt`; returns its
    /// error with that of its end: what closing its loops moves, energy out of nothing, and shapes
    /// that have met unnoticed.
    ///
    /// - `h`, `accuracy`: its length, s, and that of its solves
    /// - `error`: its error before
    pub(super) fn complete(
        &mut self,
        ctx: &Context,
        state: &State,
        by: By,
        ([h, accuracy], mut error): ([f64; 2], f64),
    ) -> f64 {
        let from = &state.physical;
        let allowed = CONTROLLED_GAIN * ctx.tolerance;
        let books = guards::open_books(ctx, &self.here, from, allowed);
        let gain = if by == By::Stages {
            let Self {
                here,
                there,
                stages,
                closing,
                attempt,
                ..
            } = self;
            let step = Ending {
                here,
                from,
                books: &books,
                lengths: [h, accuracy],
                alike: false,
            };
            let ended = stages.end(ctx, &step, (there, attempt), |stages, there, attempt| {
                attempt.begin(state);
                stages.finish(ctx, (here, from), h, attempt);
                closing.close(ctx.tree, &mut there.kin, &mut attempt.end, h) / ctx.tolerance
            });
            let Some(ended) = ended else { return HIT };
            if ended.again {
                error = stages.error(ctx, from, h);
            }
            error = error.max(ended.added);
            ended.gain
        } else {
            error = error.max(self.finish(ctx, state, by, h));
            let work = if by == By::FirstStage {
                self.stages.first_work(ctx, h)
            } else {
                let parts = (&self.here.terms, &self.implicit.full);
                guards::work(ctx, &self.here.kin, parts, [h, ctx.elapsed])
            };
            let (points, end) = ((&self.here, &mut self.there), &self.attempt.end);
            guards::gain(ctx, &books, points, end, work)
        };
        if gain.is_nan() {
            return f64::INFINITY;
        }
        if guards::has_missed(ctx, (&self.here, &mut self.there), by.length(h)) {
            error = error.max(HIT);
        }
        error.max(gain)
    }

    /// Ends a step of `h` seconds whose two stages err by too much with the first of them, and puts
    /// that into `self.attempt`; returns its error if that is good. The second stage throws back
    /// what has met something in the first: its spring does not pull.
    ///
    /// - `accuracy`: of its solves
    pub(super) fn end_first(
        &mut self,
        ctx: &Context,
        state: &State,
        [h, accuracy]: [f64; 2],
    ) -> Option<f64> {
        if !ctx.rules.first_stage {
            return None;
        }
        let mut error = self.stages.first_error(ctx, &state.physical, h);
        if error <= 1.0 {
            error = self.complete(ctx, state, By::FirstStage, ([h, accuracy], error));
        }
        (error <= 1.0).then_some(error)
    }

    /// Puts the explicit step of `h` seconds that has been tried into `self.attempt`, closes its
    /// loops, and returns what that adds to its error. The rates at its end are not those at the
    /// start of the next step.
    pub(super) fn close_explicitly(&mut self, ctx: &Context, state: &State, h: f64) -> f64 {
        self.attempt.begin(state);
        self.explicit.put(
            ctx.tree,
            &self.here,
            (&state.physical, h),
            &mut self.attempt,
        );
        let from = &state.physical;
        ctx.tree
            .carry_driven((&from.q, &from.v), h, &mut self.attempt.end.q);
        self.close(ctx, h)
    }
}
