//! From one communication point to the next: propose a step, cap it, try it, guard it, accept it.
//!
//! Only this file knows the methods: explicit steps where nothing stiff acts, else implicit steps;
//! steps of a length that the user fixes are in `fixed`. A try (`Attempt`) is accepted whole or
//! dropped. The last step of a way ends at the communication point to the last bit.

use crate::force::Memory;
use crate::model::Model;
use crate::spatial::Vec6;
use crate::state::State;
use crate::step::attempt::Attempt;
use crate::step::caps;
use crate::step::closing::Closing;
use crate::step::explicit::Explicit;
use crate::step::fixed::{self, Fixed, Methods, Outcome, Part};
use crate::step::flight::Flights;
use crate::step::implicit::Implicit;
use crate::step::islands::{Islands, is_moved};
use crate::step::point::{Context, Point};
use crate::step::size::{self, Standing, Tried, Verdict, Way, grown, implicit_factor, landing};
use crate::step::stages::Stages;
use crate::step::stages::finish::By;
use crate::tree::Tree;
use crate::tuning::{BALANCE, FIXED_ACCURACY, FLOOR_TOLERANCE, GUESS, GUESSES, MAX_STEP, MIN_STEP};

/// Why a communication step was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The state stopped being finite at the smallest step.
    NotFinite,
    /// A loop does not close at the smallest step: its index.
    Apart(usize),
    /// More steps were tried than [`Context::budget`] allows.
    Budget,
    /// A shape has gone farther than was guessed when the trees were parted, see
    /// [`super::islands`].
    Strayed,
}

/// All scratch of a communication step, sized once. Filling it with NaN between steps changes
/// nothing.
#[derive(Clone, Debug)]
pub struct Stepper {
    /// Where a step begins.
    pub here: Point,
    /// Where it ends.
    pub(super) there: Point,
    pub(super) implicit: Implicit,
    pub(super) stages: Box<Stages>,
    pub(super) explicit: Box<Explicit>,
    pub(super) fixed: Fixed,
    pub(super) attempt: Attempt,
    pub(super) closing: Closing,
    /// What flies from the last communication point on.
    flights: Flights,
    /// Which trees go together.
    pub islands: Islands,
    /// Memory and positions of a robot that is set down.
    pub(super) there_memory: Memory,
    pub(super) settled: Vec<f64>,
    /// Accelerations of bodies, see [`caps::find_pull`].
    pull: Vec<Vec6>,
    /// The state at the last communication point.
    pub(super) backup: State,
    /// Steps tried since then.
    pub(super) tried: u64,
}

#[cfg(test)]
crate::spoil::spoil!(Stepper: here there implicit stages explicit fixed attempt closing flights islands
    there_memory settled pull backup tried;);

impl Stepper {
    /// Room for a robot. On the heap: hosts call from threads with little stack.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, tree: &Tree) -> Box<Self> {
        Box::new(Self {
            here: Point::new(model, tree),
            there: Point::new(model, tree),
            implicit: Implicit::new(model, tree),
            stages: Stages::new(model, tree),
            explicit: Explicit::new(model, tree),
            fixed: Fixed::new(model),
            attempt: Attempt::new(model, tree),
            closing: Closing::new(model, tree),
            flights: Flights::new(tree),
            islands: Islands::new(tree, model.contact_room()[0]),
            there_memory: Memory::new(model),
            settled: vec![0.0; model.nq],
            pull: vec![[0.0; 6]; tree.bodies.len()],
            backup: State::new(model),
            tried: 0,
        })
    }

    /// Takes the trees that `ctx` works on up to exactly `end`.
    ///
    /// # Errors
    /// [`Stop`]; `state` is then to be left by [`Self::end`] or [`Self::begin_again`].
    pub fn advance(&mut self, ctx: &Context, state: &mut State, end: f64) -> Result<(), Stop> {
        for (index, _) in ctx.tree.moved() {
            state.stepping.rested[index] = 0.0;
        }
        let loads = &mut state.stepping.loads;
        loads.retain(|load| !is_moved(ctx, load.slot));
        let scratch = (&mut self.there.kin, &mut self.attempt.company);
        let flies = self.flights.begin(ctx, state, scratch);
        if ctx.fixed_step > 0.0 {
            self.advance_fixed(ctx, state, end)?;
        } else {
            self.advance_controlled(ctx, state, end, flies)?;
        }
        let (h, scratch) = (end - state.time, (&mut self.there.kin, &mut self.attempt));
        if self.flights.keep(ctx, state, h, scratch) {
            self.attempt.accept(state);
        }
        if !state.physical.is_finite() {
            return Err(self.failure());
        }
        if self.islands.are_limited() {
            self.here.pose(ctx, &state.physical);
            self.check_limits(ctx)?;
        }
        Ok(())
    }

    fn advance_controlled(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
        flies: bool,
    ) -> Result<(), Stop> {
        let (sizes, lead) = (&state.stepping.sizes, ctx.tree.island.lead);
        let mut way = Way::new(state.time, end, sizes.proposed[lead]);
        way.done = self.follow(ctx, state, end);
        if flies && way.done == 0.0 {
            way.standing = Standing::Posed;
        }
        self.walk(ctx, state, way)
    }

    /// Goes along the smooth step under way, at most to `end`; returns how far.
    fn follow(&mut self, ctx: &Context, state: &mut State, end: f64) -> f64 {
        let ahead = &state.stepping.ahead;
        if !ahead.is_under_way(ctx.tree) {
            return 0.0;
        }
        let (last, begin) = (ahead.end(ctx.tree), state.time);
        self.attempt.stay(state);
        let (q, v) = (&mut self.attempt.end.q, &mut self.attempt.end.v);
        ahead.evaluate(ctx.tree, end.min(last), q, v);
        let from = &state.physical;
        ctx.tree.carry_driven(
            (&from.q, &from.v),
            end.min(last) - begin,
            &mut self.attempt.end.q,
        );
        self.close(ctx, 0.0);
        self.attempt.accept(state);
        if end < last {
            return end - begin;
        }
        state.stepping.ahead.clear(ctx.tree);
        (last - begin).min(end - begin)
    }

    /// Goes from `begin` to `end` under error control in the midst of fixed steps.
    pub(super) fn advance_between(
        &mut self,
        ctx: &Context,
        state: &mut State,
        begin: f64,
        end: f64,
    ) -> Result<(), Stop> {
        // What error control takes may be as stiff as it is.
        let ctx = &Context {
            fixed_step: 0.0,
            ..*ctx
        };
        let proposed = state.stepping.sizes.proposed[ctx.tree.island.lead];
        self.walk(ctx, state, Way::new(begin, end, proposed))?;
        // The fixed steps go on from here.
        state.stepping.ahead.clear(ctx.tree);
        Ok(())
    }

    /// Takes steps as long as the error allows, to the end of the way.
    fn walk(&mut self, ctx: &Context, state: &mut State, mut way: Way) -> Result<(), Stop> {
        while way.remaining() > 0.0 {
            let ctx = &ctx.after(way.done);
            self.stand(ctx, state, &mut way);
            self.check_limits(ctx)?;
            size::lower_floor(ctx, &mut state.stepping.sizes, &state.physical.v);
            let lengths = [way.proposed, way.remaining()];
            if self.coast(ctx, state, &mut way)? {
                continue;
            }
            if let Some(plan) = self.explicit.plan(ctx, &mut self.here, state, lengths) {
                self.go_explicitly(ctx, state, &mut way, plan)?;
            } else {
                self.go_implicitly(ctx, state, &mut way)?;
            }
        }
        Ok(())
    }

    /// Brings `self.here` to the state, as far as an explicit step needs it.
    fn stand(&mut self, ctx: &Context, state: &State, way: &mut Way) {
        match way.standing {
            Standing::Current => return,
            Standing::Posed => std::mem::swap(&mut self.here.kin, &mut self.there.kin),
            Standing::Nowhere => self.here.pose(ctx, &state.physical),
        }
        self.take_kept();
        let h = landing(way.proposed.min(MAX_STEP), way.remaining());
        self.here.begin_smooth(ctx, &state.physical, h);
        self.explicit.integrator.restart();
        way.standing = Standing::Nowhere;
    }

    /// Takes what the last try has found of pairs at its end, where the next step may begin.
    fn take_kept(&mut self) {
        let there = &mut self.there.terms.contacts.pairs;
        self.here.terms.contacts.pairs.take_kept(there);
    }

    /// Takes an implicit step: as long as the error allows, or all the rest of the way where the
    /// robot stays.
    pub(super) fn go_implicitly(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
    ) -> Result<(), Stop> {
        // Propose.
        let remaining = way.remaining();
        let mut h = landing(way.proposed.min(MAX_STEP), remaining);
        if way.standing == Standing::Current || ctx.tree.long {
            self.here.begin(ctx, &state.physical, h);
        }
        way.standing = Standing::Nowhere;
        // Cap.
        h = h.min(landing(
            way.proposed.min(caps::longest(&self.here)),
            remaining,
        ));
        h = h.min(way.proposed);
        let long = way.proposed.min(MAX_STEP);
        if caps::may_look_ahead(ctx, &self.here, state, long) {
            h = long;
        }
        let (here, pull) = (&self.here, &mut self.pull);
        caps::find_pull(ctx, here, &state.stepping.trend, pull);
        h = caps::by_touchdown(ctx, here, (&state.physical, pull), h);
        let accuracy = (GUESS * ctx.tolerance).clamp(GUESSES.0, GUESSES.1);
        if self.rest(ctx, state, [h, remaining], BALANCE * accuracy) {
            way.arrive();
            return Ok(());
        }
        // Try, guard, accept.
        self.go_in_stages(ctx, state, way, [h, accuracy])
    }

    /// Takes an implicit step of at most `h` seconds in two stages, or by one solve where two
    /// stages have no solution within the digits, or would make a load oscillate.
    fn go_in_stages(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
        [mut h, accuracy]: [f64; 2],
    ) -> Result<(), Stop> {
        let remaining = way.remaining();
        way.before = None;
        loop {
            self.begin_try(ctx)?;
            let (from, trend) = (&state.physical, &state.stepping.trend);
            let stages = &mut self.stages;
            let staged = stages.solve(ctx, (&self.here, from), trend, [h, accuracy], false);
            if ctx.rules.bounce
                && h > MIN_STEP
                && let Some(time) = stages.touchdown(&self.here, h)
            {
                state.stepping.counters.rejected += 1;
                h = time.max(MIN_STEP);
                continue;
            }
            let mut error = if staged {
                stages.error(ctx, from, h)
            } else {
                let (here, trend) = (&mut self.here, &trend.whole);
                self.implicit
                    .solve_alone(ctx, (here, from), trend, [h, accuracy])
            };
            let mut by = if staged { By::Stages } else { By::OneSolve };
            let beyond = h > remaining;
            let mut first = None;
            if error <= 1.0 {
                error = self.complete(ctx, state, by, ([h, accuracy], error));
            } else if staged && !beyond {
                first = self.end_first(ctx, state, [h, accuracy]);
            }
            if beyond && !staged {
                // No polynomial leads there.
                h = remaining;
                continue;
            }
            if beyond && error <= 1.0 {
                let end = &self.attempt.end;
                let ends = (end.q.as_slice(), end.v.as_slice());
                if caps::meets_limit(ctx, &self.here, &state.physical, ends, h)
                    || self.stages.yields(&state.physical, h)
                {
                    // What happens at a limit, or where a motor yields, is no polynomial.
                    state.stepping.counters.rejected += 1;
                    h = remaining;
                    continue;
                }
            }
            let mut factor = implicit_factor([h, error], way.before);
            let mut next = grown(way.proposed, h, factor);
            if let Some(found) = first {
                by = By::FirstStage;
                (h, error) = (by.length(h), found);
                factor = implicit_factor([h, error], None);
                next = next.max(h * factor);
            }
            let tried = Tried {
                h,
                error,
                factor,
                ease: next,
                next,
                smooth: false,
            };
            match way.judge(ctx, &mut state.stepping, &tried) {
                Verdict::Accept => {}
                Verdict::Retry => {
                    h = way.proposed;
                    continue;
                }
                Verdict::Fail => return Err(self.failure()),
            }
            if error > 1.0 {
                // Taken at the shortest step. What that does not resolve two stages throw back; one
                // solve throws nothing back, but takes energy from what it does resolve.
                let lost = staged && !self.stages.has_solution;
                let unresolved = lost || error * ctx.tolerance > FLOOR_TOLERANCE;
                let (here, trend) = (&mut self.here, &state.stepping.trend.whole);
                let alone = staged && unresolved && {
                    let start = (here, &state.physical);
                    let error = self.implicit.solve_alone(ctx, start, trend, [h, accuracy]);
                    error.is_finite()
                };
                if lost && !alone {
                    return Err(self.failure());
                }
                by = if alone { By::OneSolve } else { by };
                self.finish(ctx, state, by, h);
                self.there.pose(ctx, &self.attempt.end);
            }
            way.standing = Standing::Posed;
            if beyond {
                way.standing = Standing::Nowhere;
                let from = &state.physical;
                let (times, end) = ([way.begin + way.done, h, way.end], &mut self.attempt.end);
                let ahead = &mut state.stepping.ahead;
                self.implicit.look_ahead(ctx.tree, from, times, ahead, end);
                self.close(ctx, 0.0);
                way.arrive();
            } else {
                way.go(h);
            }
            self.attempt.accept(state);
            return Ok(());
        }
    }

    /// Takes steps of the length that the user has fixed, or hardly shorter, up to `end`.
    fn advance_fixed(&mut self, ctx: &Context, state: &mut State, end: f64) -> Result<(), Stop> {
        let span = end - state.time;
        let count = fixed::fixed_count(ctx, span);
        let h = span / count;
        let balance = BALANCE * FIXED_ACCURACY[0];
        let mut done = 0.0;
        while done < count {
            let ctx = &ctx.after(done * h);
            self.take_kept();
            self.here.begin(ctx, &state.physical, h);
            self.check_limits(ctx)?;
            if self.rest(ctx, state, [h, span - done * h], balance) {
                return Ok(());
            }
            caps::find_pull(ctx, &self.here, &state.stepping.trend, &mut self.pull);
            if fixed::bounces(&self.here, &self.pull, h) {
                let begin = state.time + done * h;
                self.advance_between(ctx, state, begin, begin + h)?;
            } else {
                self.step_in_parts(ctx, state, h)?;
            }
            done += 1.0;
        }
        Ok(())
    }

    /// One fixed step of `h` seconds, from where `self.here` stands: in parts where something
    /// whirls.
    fn step_in_parts(&mut self, ctx: &Context, state: &mut State, h: f64) -> Result<(), Stop> {
        let mut parts = fixed::parts(ctx, &state.physical.v, h);
        let mut done = 0.0;
        let mut current = true;
        while parts > 0.0 {
            self.begin_try(ctx)?;
            let part = (h - done) / parts;
            let ctx = &ctx.after(done);
            if !current {
                self.take_kept();
                self.here.begin(ctx, &state.physical, part);
            }
            current = false;
            let mut methods = Methods {
                here: &mut self.here,
                there: &mut self.there,
                implicit: &mut self.implicit,
                stages: &mut self.stages,
                explicit: &mut self.explicit,
                closing: &mut self.closing,
            };
            let mut counters = state.stepping.counters;
            let lengths = Part { h: part, whole: h };
            let found = (&mut self.attempt, &mut counters);
            let outcome = self.fixed.attempt(ctx, &mut methods, state, lengths, found);
            state.stepping.counters = counters;
            match outcome {
                Outcome::Good => {
                    self.attempt.accept(state);
                    state.stepping.counters.steps += 1;
                    done += part;
                    parts -= 1.0;
                }
                Outcome::Bad if fixed::may_be_halved(part, h) => parts *= 2.0,
                Outcome::Bad | Outcome::Bounces => {
                    // No part is short enough: a limb of grams whirls between tonnes. Error control
                    // goes down to a tenth of a microsecond.
                    let begin = state.time + ctx.elapsed;
                    return self.advance_between(ctx, state, begin, begin + (h - done));
                }
            }
        }
        Ok(())
    }
}
