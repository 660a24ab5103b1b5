//! Beginning and end of a try: the solution is written into it, and its loops are closed.

use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::guards;
use crate::step::point::Context;
use crate::step::stages::secants::Ending;
use crate::tuning::{CONTROLLED_GAIN, HIT};

impl Stepper {
    /// Enters a try, and refuses it where there have been too many.
    pub(super) fn begin_try(&mut self, ctx: &Context) -> Result<(), Stop> {
        self.tried += 1;
        if self.tried > ctx.budget {
            Err(Stop::Budget)
        } else {
            Ok(())
        }
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

    /// Puts the step of `h` seconds that has been solved, in two stages or alone, into
    /// `self.attempt`; returns what closing its loops adds to its error.
    pub(super) fn finish(&mut self, ctx: &Context, state: &State, staged: bool, h: f64) -> f64 {
        self.attempt.begin(state);
        let (from, attempt) = (&state.physical, &mut self.attempt);
        if staged {
            self.stages.finish(ctx, (&self.here, from), h, attempt);
        } else {
            self.implicit.take_full(ctx, &self.here, from, h, attempt);
        }
        self.close(ctx, h)
    }

    /// Puts a step that has been solved, in two stages or alone, into `self.attempt`; returns its
    /// error with that of its end: what closing its loops moves, energy out of nothing, and shapes
    /// that have met unnoticed.
    ///
    /// - `h`, `accuracy`: its length, s, and that of its solves
    /// - `error`: its error before
    pub(super) fn complete(
        &mut self,
        ctx: &Context,
        state: &State,
        staged: bool,
        ([h, accuracy], mut error): ([f64; 2], f64),
    ) -> f64 {
        let from = &state.physical;
        let allowed = CONTROLLED_GAIN * ctx.tolerance;
        let books = guards::open_books(ctx, &self.here, from, allowed);
        let gain = if staged {
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
            error = error.max(self.finish(ctx, state, false, h));
            let parts = (&self.here.terms, &self.implicit.full);
            let work = guards::work(ctx, &self.here.kin, parts, [h, ctx.elapsed]);
            let (points, end) = ((&self.here, &mut self.there), &self.attempt.end);
            guards::gain(ctx, &books, points, end, work)
        };
        if gain.is_nan() {
            return f64::INFINITY;
        }
        if guards::has_missed(ctx, (&self.here, &mut self.there), h) {
            error = error.max(HIT);
        }
        error.max(gain)
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
        self.close(ctx, h)
    }
}
