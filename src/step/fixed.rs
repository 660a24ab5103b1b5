//! Steps of a length that the user fixes.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::{crba, rnea};
use crate::force::{detect, seek};
use crate::kinematics::{advance, forward};
use crate::range::SHORTEST_FIXED_STEP;
use crate::state::State;
use crate::step::control::{NotFinite, Stepper, count};
use crate::step::convex::Problem;
use crate::step::energy::{GAIN, work};
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use crate::tuning::{
    AHEAD, CALM, FIXED_ACCURACY, FIXED_BALANCE, MAX_PARTS, STEP_ROUND_OFF, TURN, WHIRL,
};

impl Stepper {
    pub(super) fn advance_fixed(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
    ) -> Result<(), NotFinite> {
        state.lag.clear();
        let span = end - state.time;
        // Importers' steps carry round-off: a millionth more than a whole number of steps is that number.
        let count = libm::ceil(span / ctx.fixed_step - STEP_ROUND_OFF).max(1.0);
        let h = span / count;
        let mut done = 0.0;
        while done < count {
            let ctx = &ctx.after(done * h);
            self.start.update(ctx, state, h);
            if self.rest(
                ctx,
                state,
                h,
                span - done * h,
                FIXED_BALANCE * FIXED_ACCURACY[0],
            ) {
                return Ok(());
            }
            if self.bounces(h) {
                let begin = state.time + done * h;
                self.advance_between(ctx, state, begin, begin + h)?;
                done += 1.0;
                continue;
            }
            self.step_in_parts(ctx, state, h)?;
            done += 1.0;
        }
        Ok(())
    }

    /// Whether a point that has restitution touches down within `h` seconds, or has done so and not left yet. A bounce is
    /// over in less than a fixed step, which would swallow it: it is taken under error control.
    fn bounces(&self, h: f64) -> bool {
        self.start.terms.contacts.iter().any(|contact| {
            let approach = -contact.normal_velocity(&self.start.kin.V);
            contact.touchdown > 0.0 && contact.gap < (approach * h).max(f64::MIN_POSITIVE)
        })
    }

    /// One fixed step of `h` seconds, from where `self.start` stands: in parts where something whirls.
    fn step_in_parts(&mut self, ctx: &Context, state: &mut State, h: f64) -> Result<(), NotFinite> {
        let turn = fastest(ctx, &state.v) * h;
        // Parts are not shorter than a fixed step may be.
        let most = (h / SHORTEST_FIXED_STEP).clamp(1.0, MAX_PARTS);
        let mut parts =
            libm::ceil(turn / WHIRL - 1e-9).clamp(1.0, if ctx.rules.parts { most } else { 1.0 });
        let mut done = 0.0;
        let mut current = true;
        while parts > 0.0 {
            let part = (h - done) / parts;
            let ctx = &ctx.after(done);
            if !current {
                self.start.update(ctx, state, part);
            }
            current = false;
            if self.fixed_step(ctx, state, part, h)? {
                done += part;
                parts -= 1.0;
            } else if part > (1.5 * h / MAX_PARTS).max(2.0 * SHORTEST_FIXED_STEP) {
                parts *= 2.0;
            } else {
                // No part is short enough: a limb of grams whirls between tonnes. Error control goes down to a tenth of a
                // microsecond.
                let begin = state.time + ctx.elapsed;
                return self.advance_between(ctx, state, begin, begin + (h - done));
            }
        }
        Ok(())
    }

    /// A step of `h` seconds, part of one of `whole`, explicit where nothing stiff acts, else implicit; tells whether it was
    /// taken.
    fn fixed_step(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        whole: f64,
    ) -> Result<bool, NotFinite> {
        let turning = fastest(ctx, &state.v) * whole > TURN;
        let gain = turning.then(|| GAIN * h / whole);
        if self.fixed_explicit_step(ctx, state, h, gain) {
            state.counters[0] += 1;
            return Ok(true);
        }
        self.fixed_implicit_step(ctx, state, [h, whole], true)
    }

    /// One solve with the friction cone and the bias of the start, one with those of the middle unless that changes
    /// nothing. If it is `watched` and something turns too far, gains energy or leaves the numbers, it is not taken; tells
    /// whether it was.
    pub(super) fn fixed_implicit_step(
        &mut self,
        ctx: &Context,
        state: &mut State,
        [h, whole]: [f64; 2],
        watched: bool,
    ) -> Result<bool, NotFinite> {
        let tree = ctx.tree;
        self.start.expect_commands(ctx, state, h);
        let problem = fixed_problem(&self.start, tree, h);
        self.full.guess_start(&problem, &state.v);
        let outcome = self.full.solve(&problem);
        count(state, outcome.iterations);
        // Where hardly anything happens the middle is as the start.
        if outcome.converged && self.single_error(ctx, state, h) <= CALM * h * h {
            self.accept_single(ctx, state, h);
            state.counters[0] += 1;
            return Ok(true);
        }
        let turn = fastest(ctx, &state.v).max(fastest(ctx, &self.full.v));
        if watched && ctx.rules.parts && turn * h > WHIRL {
            return Ok(false);
        }
        for (contact, response) in self
            .start
            .terms
            .contacts
            .iter_mut()
            .zip(&self.full.responses.contacts)
        {
            contact.friction.cap = contact.mu * contact.normal.dot(&response.impulse) / h;
        }
        for turn in &mut self.start.terms.turns {
            let response = &self.full.responses.contacts[turn.contact];
            turn.carry(turn.normal.dot(&response.impulse) / h);
        }
        let turning = turn * whole > TURN;
        let books = (turning && watched).then(|| {
            self.half.copy_from(state);
            self.open_books(ctx, state, GAIN * h / whole)
        });
        let share = if turning { AHEAD } else { 0.5 };
        for ((g, a), b) in self.guess.iter_mut().zip(&state.v).zip(&self.full.v) {
            *g = a + share * (b - a);
        }
        if turning {
            self.go_to_middle(ctx, state, h);
        }
        forward(tree, &self.start.kin.S, &self.guess, &mut self.start.kin.V);
        let (wrenches, middle) = (&ctx.inputs.wrenches, ctx.elapsed + 0.5 * h);
        rnea::bias(tree, &mut self.start.kin, &self.guess, wrenches, middle);
        let problem = fixed_problem(&self.start, tree, h);
        if turning {
            self.full.guess(&problem, &state.v, &self.difference);
        }
        let outcome = self.full.solve(&problem);
        count(state, outcome.iterations);
        if !outcome.converged {
            state.counters[1] += 1;
        }
        if !self.full.v.iter().all(|v| v.is_finite()) {
            return if watched { Ok(false) } else { Err(NotFinite) };
        }
        let work = books.map(|_| work(ctx, &self.start, &self.full, h));
        self.accept_single(ctx, state, h);
        let gains = books.zip(work);
        if gains.is_some_and(|(books, work)| self.gains(ctx, &books, state, h, work)) {
            let rejected = state.counters[1] + 1;
            state.copy_from(&self.half);
            state.counters[1] = rejected;
            return Ok(false);
        }
        state.counters[0] += 1;
        Ok(true)
    }

    /// Puts mass matrix, joint motions and lever arms to where the robot is half way to what `self.full` has found, which
    /// is kept in `self.difference`. Gaps stay those of the start, for lever arms of the middle.
    fn go_to_middle(&mut self, ctx: &Context, state: &State, h: f64) {
        let tree = ctx.tree;
        self.difference.copy_from_slice(&self.full.v);
        advance(
            tree,
            &state.q,
            &self.difference,
            0.5 * h,
            &mut self.q_halves,
        );
        let kin = &mut self.start.kin;
        kin.update_poses(tree, &self.q_halves);
        crba::mass_matrix(tree, kin);
        kin.update_velocities(tree, &self.difference);
        let found = &mut self.middle.terms.contacts;
        detect(
            ctx.model,
            tree,
            &state.memory.touches,
            kin,
            h,
            f64::INFINITY,
            found,
        );
        let mut found = found.iter().peekable();
        for contact in &mut self.start.terms.contacts {
            if let Some(f) = seek(&mut found, contact.slot, |f| f.slot) {
                contact.x = f.x;
                contact.gap = f.gap - 0.5 * h * f.normal_velocity(&kin.V);
            }
        }
    }
}

/// What is solved for a step of `h` seconds from `start`.
fn fixed_problem<'a>(start: &'a Point, tree: &'a Tree, h: f64) -> Problem<'a> {
    let [accuracy, iterated] = FIXED_ACCURACY;
    Problem {
        iterated,
        ..start.problem(tree, h, accuracy)
    }
}

/// How fast anything turns that is not a wheel, rad/s.
fn fastest(ctx: &Context, v: &[f64]) -> f64 {
    let mut fastest = 0.0;
    for body in &ctx.tree.bodies {
        let rate = body.kind.turn_rate(body.ratio, &v[body.dof..]);
        if rate > fastest && !body.wheel {
            fastest = rate;
        }
    }
    fastest
}
