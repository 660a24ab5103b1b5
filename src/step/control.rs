//! From one communication point to the next: error control, exact landing, rest.
//!
//! An error-controlled step is solved once over `h` and twice over `h/2`; the difference of the two results is the
//! error estimate, positions and velocities together, and twice the second minus the first is the solution that goes
//! on: second order in smooth motion at the price of the estimate. Steps end at touch-down rather than across it.
//! Where nothing is stiff, explicit steps of fifth order take over (see `smooth.rs`); as long as no input changes
//! they are as long as the motion allows, and communication points are read off inside them (see [`crate::state::ahead`]).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::Memory;
use crate::model::Model;
use crate::state::State;
use crate::step::cones::Cones;
use crate::step::convex::Newton;
use crate::step::doubled::add_impulses;
use crate::step::point::{Context, Point};
use crate::step::runge_kutta::{Explicit, Pair};
use crate::step::smooth::{accept_explicit, follow, next_proposal};
use crate::tree::Tree;
use crate::tuning::{
    BALANCE, BALANCES, BOUNCE_SHARE, COMMAND_STEP, CREEP, EXPLICIT_SAFETY, FLOOR_FALL, FLOOR_REACH,
    FLOOR_RISE, FLOOR_TOLERANCE, GROWTH, GUESS, GUESSES, IMPLICIT_SAFETY, LANDING, LEAST_ERROR,
    MAX_FLOOR, MAX_STEP, MIN_STEP, REST_SPEED, SHORT_SHARE, VELOCITY_WEIGHT,
};

/// The state stopped being finite at the smallest step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite;

/// All scratch of a communication step, sized once. Filling it with NaN between steps changes nothing.
#[derive(Clone, Debug)]
pub struct Stepper {
    /// Start of the step.
    pub start: Point,
    pub(super) middle: Point,
    pub(super) end: Point,
    pub(super) full: Newton,
    pub(super) first: Newton,
    pub(super) second: Newton,
    pub(super) cones: Cones,
    pub(super) half: State,
    /// What the force terms remember after the full solve.
    pub(super) full_memory: Memory,
    pub(super) backup: State,
    pub(super) explicit: Explicit,
    pub(super) guess: Vec<f64>,
    pub(super) difference: Vec<f64>,
    pub(super) q_start: Vec<f64>,
    pub(super) v_start: Vec<f64>,
    pub(super) q_full: Vec<f64>,
    pub(super) q_halves: Vec<f64>,
}

impl Stepper {
    /// Buffers for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let slots = model.contact_slots();
        // Not clones of one: a clone has no room beyond its length.
        let newton = || Newton::new(tree, slots);
        Self {
            start: Point::new(model, tree),
            middle: Point::new(model, tree),
            end: Point::new(model, tree),
            full: newton(),
            first: newton(),
            second: newton(),
            cones: Cones::new(slots),
            half: State::new(model),
            full_memory: Memory::new(model),
            backup: State::new(model),
            explicit: Explicit::new(tree, model.nq),
            guess: vec![0.0; model.nv()],
            difference: vec![0.0; model.nv()],
            q_start: vec![0.0; model.nq],
            v_start: vec![0.0; model.nv()],
            q_full: vec![0.0; model.nq],
            q_halves: vec![0.0; model.nq],
        }
    }

    /// Simulates `state` up to exactly `end`.
    ///
    /// # Errors
    /// [`NotFinite`]; `state` is then what it was.
    pub fn advance(&mut self, ctx: &Context, state: &mut State, end: f64) -> Result<(), NotFinite> {
        self.backup.copy_from(state);
        state.last_step = end - state.time;
        state.impulse.fill([0.0; 3]);
        let result = if ctx.fixed_step > 0.0 {
            self.advance_fixed(ctx, state, end)
        } else {
            self.advance_controlled(ctx, state, end)
        };
        if result.is_ok() && state.moves_finitely() {
            state.time = end;
            state.ahead.changed = 0.0;
            for (index, last) in state.commands.iter_mut().enumerate() {
                *last = ctx.inputs.values(index, state.last_step);
            }
            Ok(())
        } else {
            state.copy_from(&self.backup);
            Err(NotFinite)
        }
    }

    fn advance_controlled(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
    ) -> Result<(), NotFinite> {
        let flight = self.flight(ctx, state);
        let mut way = Way::new(state.time, end, state.step[0]);
        way.jumped = state.ahead.changed != 0.0;
        if way.jumped {
            // Begin with what was good after the last jump.
            way.proposed = way.proposed.min(state.step[1]);
        }
        way.done = follow(ctx.tree, state, end);
        way.posed = flight.is_some() && way.done == 0.0;
        self.walk(ctx, state, way)?;
        if let Some(flight) = &flight {
            self.keep_momentum(ctx, state, flight, end - state.time);
        }
        Ok(())
    }

    /// Goes from `begin` to `end` under error control in the midst of fixed steps.
    pub(super) fn advance_between(
        &mut self,
        ctx: &Context,
        state: &mut State,
        begin: f64,
        end: f64,
    ) -> Result<(), NotFinite> {
        // What error control takes may be as stiff as it is.
        let ctx = &Context {
            fixed_step: 0.0,
            ..*ctx
        };
        self.walk(ctx, state, Way::new(begin, end, state.step[0]))?;
        // The fixed steps go on from here.
        state.ahead.clear();
        state.lag.clear();
        Ok(())
    }

    /// Takes steps as long as the error allows until the way is gone.
    fn walk(&mut self, ctx: &Context, state: &mut State, mut way: Way) -> Result<(), NotFinite> {
        while way.remaining() > 0.0 {
            let ctx = &ctx.after(way.done);
            if !way.current {
                let h = landing(way.proposed.min(MAX_STEP), way.remaining());
                if way.posed {
                    std::mem::swap(&mut self.start.kin, &mut self.end.kin);
                } else {
                    self.start.pose(ctx, state);
                }
                self.start.update_smooth(ctx, state, h);
                way.posed = false;
                self.explicit.restart();
            }
            if let Some((pair, h)) = self.smooth_step(ctx, state, way.proposed, way.remaining()) {
                self.go_explicitly(ctx, state, &mut way, pair, h)?;
            } else {
                self.go_implicitly(ctx, state, &mut way)?;
            }
        }
        Ok(())
    }

    /// Tries an explicit step of `h` seconds.
    fn go_explicitly(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
        pair: &'static Pair,
        h: f64,
    ) -> Result<(), NotFinite> {
        let remaining = way.remaining();
        let error = self.explicit_step(ctx, pair, state, h);
        let power = -1.0 / f64::from(pair.order);
        let factor = EXPLICIT_SAFETY * libm::pow(error.max(LEAST_ERROR.1), power);
        let factor = factor.clamp(GROWTH.0, GROWTH.1);
        let good = (error <= 1.0).then_some(h * factor);
        let floor = patience(ctx, state, [h, remaining], good);
        way.current = true;
        if error <= 1.0 || (h <= floor && error.is_finite()) {
            if error > 1.0 {
                state.counters[3] += 1;
            }
            way.proposed = next_proposal(way.proposed, h, pair, factor, ctx.tolerance).max(floor);
            way.book(state, h);
            state.lag.clear();
            if h > remaining {
                self.look_ahead(ctx, pair, state, way.begin + way.done, h, way.end);
                way.arrive();
                return Ok(());
            }
            accept_explicit(&mut self.explicit, pair, state);
            way.go(h);
            way.current = pair.is_explicit();
            if !way.current {
                return Ok(());
            }
            // The last stage stands at the new state: it tells whether the next step may be explicit, too.
            std::mem::swap(&mut self.start.kin, &mut self.middle.kin);
            let next = landing(way.proposed.min(MAX_STEP), way.remaining());
            self.start.find_terms(&ctx.after(h), state, next);
        } else if error.is_finite() || h > MIN_STEP {
            state.counters[1] += 1;
            way.proposed = (h * factor).max(if error.is_finite() { floor } else { MIN_STEP });
        } else {
            return Err(NotFinite);
        }
        Ok(())
    }

    /// Takes an implicit step: as long as the error allows, or all the rest of the way where the robot stays.
    fn go_implicitly(
        &mut self,
        ctx: &Context,
        state: &mut State,
        way: &mut Way,
    ) -> Result<(), NotFinite> {
        let accuracy = (GUESS * ctx.tolerance).clamp(GUESSES.0, GUESSES.1);
        let remaining = way.remaining();
        let mut h = landing(way.proposed.min(MAX_STEP), remaining);
        if way.current || ctx.tree.long {
            self.start.update(ctx, state, h);
        }
        way.current = false;
        self.cones.moved = false;
        if way.jumped && ctx.rules.command {
            way.proposed = self.cap_by_command(ctx, state, way.proposed, remaining);
        }
        h = h.min(way.proposed);
        if self.may_look_ahead(ctx, state, way.proposed.min(MAX_STEP)) {
            h = way.proposed.min(MAX_STEP);
        }
        let asked = h;
        h = self.cap_by_touchdown(ctx, state, h);
        let uncut = h >= asked;
        let balance = (BALANCE * ctx.tolerance).clamp(BALANCES.0, BALANCES.1);
        if self.rest(ctx, state, h, remaining, balance) {
            way.arrive();
            return Ok(());
        }
        loop {
            let solved = self.full_solve(ctx, state, h, accuracy);
            // Cut short by the communication step: the one solve may do.
            let short = ctx.rules.single
                && uncut
                && !way.jumped
                && h <= SHORT_SHARE * way.proposed
                && !ctx.inputs.varies();
            if solved && short && self.single_step(ctx, state, h) {
                patience(ctx, state, [h, remaining], Some(way.proposed));
                way.book(state, h);
                way.go(h);
                return Ok(());
            }
            let error = if solved {
                self.doubled_step(ctx, state, h, accuracy)
            } else {
                f64::INFINITY
            };
            let beyond = h > remaining;
            if beyond && error <= 1.0 && self.meets_limit(ctx, state, h) {
                // What happens at a limit is no polynomial.
                state.counters[1] += 1;
                h = remaining;
                continue;
            }
            let factor =
                (IMPLICIT_SAFETY / error.max(LEAST_ERROR.0).sqrt()).clamp(GROWTH.0, GROWTH.1);
            let next = grown(way.proposed, h, factor);
            let good = (error <= 1.0).then_some(next);
            let floor = patience(ctx, state, [h, remaining], good);
            if error <= 1.0 || (h <= floor && error.is_finite()) {
                if error > 1.0 {
                    state.counters[3] += 1;
                }
                way.proposed = next.max(floor);
                let jumped = way.jumped;
                way.book(state, h);
                self.keep_start(state);
                way.posed =
                    self.accept_doubled(ctx, state, h, error <= 1.0 && ctx.rules.extrapolation);
                self.end_trend(state, h);
                if jumped || !uncut {
                    // What a jump or a touch-down ends is not what follows.
                    state.lag.clear();
                }
                if beyond {
                    self.interpolate(ctx, state, way.begin + way.done, h, way.end);
                    way.arrive();
                } else {
                    way.go(h);
                }
                return Ok(());
            }
            if h <= MIN_STEP {
                return Err(NotFinite);
            }
            state.counters[1] += 1;
            h = (h * factor).max(if error.is_finite() { floor } else { MIN_STEP });
            way.proposed = h;
        }
    }

    /// A step must not jump over what a changed command sets going: full and half steps would both arrive at the
    /// target and agree.
    fn cap_by_command(&self, ctx: &Context, state: &State, proposed: f64, remaining: f64) -> f64 {
        let mut capped = proposed;
        for term in &self.start.terms.joints {
            let Some(index) = term.actuator else { continue };
            let command = ctx.inputs.values(index, 0.0);
            #[expect(clippy::float_cmp, reason = "any change counts")]
            let unchanged = command == state.commands[index];
            if unchanged && !ctx.inputs.varies() {
                continue;
            }
            let (cap, error) = term.drive.velocity_error(state.v[term.dof]);
            let time = ctx.tree.dofs.inertia[term.dof] * error / cap;
            let moved = error * capped.min(remaining) * ctx.tree.dofs.weight[term.dof];
            if moved > ctx.tolerance && time < capped {
                capped = time.max(COMMAND_STEP);
            }
        }
        capped
    }

    /// Ends the step where the first point touches down or the first joint reaches its limit; takes a bounce in parts of
    /// its own time.
    fn cap_by_touchdown(&self, ctx: &Context, state: &State, h: f64) -> f64 {
        let (mass, rules) = (ctx.tree.moving_mass(), ctx.rules);
        let mut capped = h;
        for contact in &self.start.terms.contacts {
            if contact.gap > 0.0 {
                let approach = -contact.normal_velocity(&self.start.kin.V);
                let time = contact.gap / approach;
                if rules.touchdown && approach > 0.0 && time < capped && time > MIN_STEP {
                    capped = time;
                }
            } else if rules.bounce && contact.touchdown > 0.0 {
                let time = BOUNCE_SHARE * (mass / contact.spring.stiffness).sqrt();
                capped = capped.min(time.max(MIN_STEP));
            }
        }
        for term in &self.start.terms.joints {
            let v = state.v[term.dof];
            let time = term.gap[usize::from(v > 0.0)] / v.abs();
            if rules.touchdown && time < capped && time > CREEP * h {
                capped = time;
            }
        }
        capped
    }

    /// If the robot stands still and all forces balance, it stays: nothing moves until `remaining` has passed. The
    /// test does not depend on `h`, so it does not depend on the communication step either.
    pub(super) fn rest(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        remaining: f64,
        accuracy: f64,
    ) -> bool {
        let speed = state.v.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // Forces that balance now need not balance later if a command changes.
        if !ctx.rules.rest || speed >= REST_SPEED || ctx.inputs.varies() {
            return false;
        }
        if speed > 0.0 {
            self.guess.copy_from_slice(&state.v);
            state.v.fill(0.0);
            self.start.update_motion(ctx, state, h);
        }
        let balanced = self
            .full
            .is_balanced(&self.start.problem(ctx.tree, h, accuracy));
        if balanced {
            state.trend.fill(0.0);
            state.lag.clear();
            state.counters[0] += 1;
            self.start.terms.drop_unloaded(&mut state.memory);
            add_impulses(
                &self.start.terms.contacts,
                &self.full,
                remaining / h,
                &mut state.impulse,
            );
        } else if speed > 0.0 {
            state.v.copy_from_slice(&self.guess);
            self.start.update_motion(ctx, state, h);
        }
        balanced
    }
}

/// The way from one communication point to the next.
struct Way {
    /// Time at which it begins and ends, s.
    begin: f64,
    end: f64,
    /// How far it has been gone, s.
    done: f64,
    /// Step that the error control proposes, s.
    proposed: f64,
    /// Whether inputs have jumped at its beginning and no step has been taken since: the first one is shorter than
    /// those after it.
    jumped: bool,
    /// Whether [`Stepper::start`] stands at the state already, after an explicit step.
    current: bool,
    /// Whether poses and velocities of [`Stepper::end`] stand at the state, after an implicit step.
    posed: bool,
}

impl Way {
    /// All of it, to be begun with a step of `proposed` seconds.
    fn new(begin: f64, end: f64, proposed: f64) -> Self {
        Self {
            begin,
            end,
            done: 0.0,
            proposed,
            jumped: false,
            current: false,
            posed: false,
        }
    }

    fn remaining(&self) -> f64 {
        self.end - self.begin - self.done
    }

    /// Takes a step of `h` seconds off the way; the last one ends it to the bit.
    fn go(&mut self, h: f64) {
        if h >= self.remaining() {
            self.arrive();
        } else {
            self.done += h;
        }
    }

    /// Ends the way.
    fn arrive(&mut self) {
        self.done = self.end - self.begin;
    }

    /// Books an accepted step of `h` seconds and what the controller proposes next.
    fn book(&mut self, state: &mut State, h: f64) {
        state.counters[0] += 1;
        state.step[0] = self.proposed;
        if self.jumped {
            let h = h.min(self.remaining()).min(self.proposed);
            state.step[1] = self.proposed.min(2.0 * state.step[1]).max(h);
        }
        self.jumped = false;
    }
}

/// Shortest step that error control may ask for now; books that a step of `h` seconds was tried.
///
/// Some contacts of very light bodies on heavy robots oscillate in nanoseconds between normal force and friction
/// (Painlevé's problem), and a joint may be told to spin at any speed: resolving that buys nothing and stalls the host.
/// A run of steps near the floor therefore raises it, slowly enough that an impact passes unhindered. Steps that go well lower
/// it again if they take ten times as long, or would but for the communication step; those that it cuts do not raise it.
///
/// - `next`: length of the next step if this one went well, s
fn patience(ctx: &Context, state: &mut State, [h, remaining]: [f64; 2], next: Option<f64>) -> f64 {
    let floor = &mut state.step[2];
    *floor = floor.max(MIN_STEP);
    let cut = h >= remaining;
    let taken = next.map_or(0.0, |next| if cut { next.max(h) } else { h });
    if taken >= FLOOR_REACH * *floor {
        *floor *= FLOOR_FALL;
    } else if ctx.rules.floor && !cut && h < FLOOR_REACH * *floor {
        // Like the steps that the tolerance asks for.
        let scale = (ctx.tolerance / FLOOR_TOLERANCE).sqrt().min(1.0);
        *floor = (*floor * (1.0 + FLOOR_RISE * scale)).min(scale * MAX_FLOOR);
    }
    floor.max(MIN_STEP)
}

/// Length of the next step on the way to a communication point: no crumb is left over.
pub(super) fn landing(h: f64, remaining: f64) -> f64 {
    if h >= remaining {
        remaining
    } else if LANDING * h > remaining {
        0.5 * remaining
    } else {
        h
    }
}

/// The next proposal: a step that was cut short and went well does not shrink it.
pub(super) fn grown(proposed: f64, h: f64, factor: f64) -> f64 {
    let next = h * factor;
    if h < proposed && factor >= GROWTH.1 {
        proposed.max(next)
    } else {
        next
    }
}

/// The largest of the weighted errors of positions and velocities; infinite if one is not a number.
pub(super) fn worst_error(errors: impl Iterator<Item = (f64, f64)>, weights: &[f64]) -> f64 {
    errors
        .zip(weights)
        .fold(0.0, |worst: f64, ((position, velocity), weight)| {
            let error = weight * position.abs().max(VELOCITY_WEIGHT * velocity.abs());
            // `f64::max` would drop a NaN.
            if error.is_nan() || position.is_nan() || velocity.is_nan() {
                f64::INFINITY
            } else {
                worst.max(error)
            }
        })
}

/// Counts the iterations of a solve.
pub(super) fn count(state: &mut State, iterations: usize) {
    state.counters[2] = state.counters[2].max(iterations as u64);
}
