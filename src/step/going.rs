//! Steps in which nothing touches: of bodies that are alone with gravity, and explicit ones.

use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::explicit::{self, Plan};
use crate::step::point::Context;
use crate::step::size::{Standing, Tried, Verdict, Way, grown, landing};
use crate::tuning::{EXPLICIT_SAFETY, GROWTH, HIT, LEAST_ERROR, MAX_STEP, MIN_STEP};

impl Stepper {
    /// Tries a step of bodies that are alone; tells whether they are.
    pub(super) fn coast(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
    ) -> Result<bool, Stop> {
        let h = landing(way.proposed.min(MAX_STEP), way.remaining());
        let (here, attempt) = (&self.here, &mut self.attempt);
        let Some(free) = self.explicit.coast(ctx, here, state, h, attempt) else {
            return Ok(false);
        };
        let floor = state.stepping.sizes.floor[ctx.tree.island.lead];
        if !free && h <= floor.max(MIN_STEP) {
            return Ok(false);
        }
        self.begin_try(ctx)?;
        way.standing = Standing::Current;
        let factor = if free { GROWTH.1 } else { 0.5 };
        let next = grown(way.proposed, h, factor);
        let tried = Tried {
            h,
            error: if free { 0.0 } else { HIT },
            factor,
            ease: next,
            next,
            smooth: false,
        };
        match way.judge(ctx, &mut state.stepping, &tried) {
            Verdict::Accept => {}
            Verdict::Retry => return Ok(true),
            Verdict::Fail => return Err(self.failure()),
        }
        self.attempt.accept(state);
        way.go(h);
        way.standing = Standing::Nowhere;
        Ok(true)
    }

    /// Tries an explicit step.
    pub(super) fn go_explicitly(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
        plan: Plan,
    ) -> Result<(), Stop> {
        self.begin_try(ctx)?;
        let (Plan { pair, h }, from) = (plan, &state.physical);
        let mut error = self.explicit.attempt(ctx, &self.here, from, plan);
        let closed = ctx.tree.is_closed();
        if closed {
            error = error.max(self.close_explicitly(ctx, state, h));
        }
        let power = -1.0 / f64::from(pair.order);
        let factor = EXPLICIT_SAFETY * libm::pow(error.max(LEAST_ERROR.1), power);
        let factor = factor.clamp(GROWTH.0, GROWTH.1);
        way.standing = Standing::Current;
        let floor = state.stepping.sizes.floor[ctx.tree.island.lead];
        if error > 1.0 && h <= floor.max(MIN_STEP) && !way.falls(h, error) {
            // It is not its length that it errs by. What is taken although it errs must be stable.
            return self.go_implicitly(ctx, state, way);
        }
        let tried = Tried {
            h,
            error,
            factor,
            ease: h * factor,
            next: explicit::next_proposal(ctx, way.proposed, plan, factor),
            smooth: true,
        };
        match way.judge(ctx, &mut state.stepping, &tried) {
            Verdict::Accept => {}
            Verdict::Retry => return Ok(()),
            Verdict::Fail => return Err(self.failure()),
        }
        self.attempt.begin(state);
        if h > way.remaining() {
            let times = [way.begin + way.done, way.end];
            let found = (&mut state.stepping.ahead, &mut self.attempt);
            self.explicit
                .finish_ahead((ctx.tree, &self.here), plan, &state.physical, times, found);
            self.close(ctx, 0.0);
            self.attempt.accept(state);
            way.arrive();
            return Ok(());
        }
        if closed {
            self.close_explicitly(ctx, state, h);
        } else {
            self.explicit
                .finish((ctx.tree, &self.here), pair, (from, h), &mut self.attempt);
        }
        self.attempt.accept(state);
        way.go(h);
        if pair.is_explicit() && !closed {
            // The last stage stands at the new state: it tells whether the next step may be
            // explicit, too.
            std::mem::swap(&mut self.here.kin, &mut self.explicit.end);
            let next = landing(way.proposed.min(MAX_STEP), way.remaining());
            self.here.find_smooth(&ctx.after(h), &state.physical, next);
        } else {
            way.standing = Standing::Nowhere;
        }
        Ok(())
    }
}
