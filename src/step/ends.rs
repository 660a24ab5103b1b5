//! Beginning and end of a try: the solution is written into it, and its loops are closed.

use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::point::Context;

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

    /// Puts the explicit step of `h` seconds that has been tried into `self.attempt`, closes its
    /// loops, and returns what that adds to its error. The rates at its end are not those at the
    /// start of the next step.
    pub(super) fn close_explicitly(&mut self, ctx: &Context, state: &State, h: f64) -> f64 {
        self.attempt.begin(state);
        self.explicit.put(ctx.tree, &self.here, &mut self.attempt);
        self.close(ctx, h)
    }
}
