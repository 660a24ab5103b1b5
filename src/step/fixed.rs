//! Steps of a length that the user fixes.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::rnea;
use crate::kinematics::forward;
use crate::simulation::SHORTEST_FIXED_STEP;
use crate::spatial::velocity_at;
use crate::state::State;
use crate::step::control::{NotFinite, Stepper, count};
use crate::step::point::Context;
use crate::tree::Move;

/// Error of one solve by itself, relative to the tolerance and to the square of the step, s⁻², up to which the second is left
/// out: like the error it falls with the square of the step, so that short steps converge as before. 0.004 at 1/240 s.
const CALM: f64 = 240.0;
/// Relative accuracy of the impulses in fixed-step mode.
const FIXED_ACCURACY: f64 = 1e-8;
/// Angle, rad, that a limb may turn in a step: one that whirls faster has the step taken in parts. A step takes mass matrix
/// and lever arms as they are at its start, and a radian on they are others: such limbs gained energy without bound.
const WHIRL: f64 = 0.2;
/// Most parts of a step.
const MAX_PARTS: f64 = 32.0;

impl Stepper {
    pub(super) fn advance_fixed(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
    ) -> Result<(), NotFinite> {
        let span = end - state.time;
        // Importers' steps carry round-off: a millionth more than a whole number of steps is that number.
        let count = libm::ceil(span / ctx.fixed_step - 1e-6).max(1.0);
        let h = span / count;
        let mut done = 0.0;
        while done < count {
            let ctx = &ctx.after(done * h);
            self.start.update(ctx, state, h);
            if self.rest(ctx, state, h, span - done * h, FIXED_ACCURACY) {
                return Ok(());
            }
            if self.bounces(h) {
                let begin = state.time + done * h;
                self.advance_between(ctx, state, begin, begin + h)?;
                done += 1.0;
                continue;
            }
            let parts = parts(ctx, state, h);
            let part = h / parts;
            self.fixed_step(ctx, state, part)?;
            let mut taken = 1.0;
            while taken < parts {
                let ctx = &ctx.after(taken * part);
                self.start.update(ctx, state, part);
                self.fixed_step(ctx, state, part)?;
                taken += 1.0;
            }
            done += 1.0;
        }
        Ok(())
    }

    /// Whether a point that has restitution touches down within `h` seconds, or has done so and not left yet. A bounce is
    /// over in less than a fixed step, which would swallow it: it is taken under error control.
    fn bounces(&self, h: f64) -> bool {
        self.start.contacts.iter().any(|contact| {
            let V = &self.start.kin.V[contact.body];
            let approach = -contact.normal.dot(&velocity_at(V, &contact.x));
            contact.touchdown > 0.0 && contact.gap < (approach * h).max(f64::MIN_POSITIVE)
        })
    }

    /// Explicit where nothing stiff acts, else implicit.
    fn fixed_step(&mut self, ctx: &Context, state: &mut State, h: f64) -> Result<(), NotFinite> {
        if self.fixed_explicit_step(ctx, state, h) {
            state.counters[0] += 1;
            return Ok(());
        }
        self.fixed_implicit_step(ctx, state, h)
    }

    /// One solve with the friction cone and the bias of the start, one with those of the middle unless that changes nothing.
    pub(super) fn fixed_implicit_step(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
    ) -> Result<(), NotFinite> {
        let tree = ctx.tree;
        self.start.expect_commands(ctx, state, h);
        let problem = self.start.problem(tree, h, FIXED_ACCURACY);
        self.full.guess_start(&problem, &state.v);
        let outcome = self.full.solve(&problem);
        count(state, outcome.iterations);
        // Where hardly anything happens the middle is as the start.
        if outcome.converged && self.single_error(ctx, state, h) <= CALM * h * h {
            self.accept_single(ctx, state, h);
            state.counters[0] += 1;
            return Ok(());
        }
        for (contact, response) in self.start.contacts.iter_mut().zip(&self.full.responses) {
            contact.cap = contact.mu * contact.normal.dot(&response.impulse) / h;
        }
        for turn in &mut self.start.turns {
            let response = &self.full.responses[turn.contact];
            turn.carry(turn.normal.dot(&response.impulse) / h);
        }
        for ((g, a), b) in self.guess.iter_mut().zip(&state.v).zip(&self.full.v) {
            *g = 0.5 * (a + b);
        }
        forward(tree, &self.start.kin.S, &self.guess, &mut self.start.kin.V);
        let (wrenches, middle) = (&ctx.inputs.wrenches, ctx.elapsed + 0.5 * h);
        rnea::bias(tree, &mut self.start.kin, &self.guess, wrenches, middle);
        let outcome = self
            .full
            .solve(&self.start.problem(tree, h, FIXED_ACCURACY));
        count(state, outcome.iterations);
        if !outcome.converged {
            state.counters[1] += 1;
        }
        if !self.full.v.iter().all(|v| v.is_finite()) {
            return Err(NotFinite);
        }
        self.accept_single(ctx, state, h);
        state.counters[0] += 1;
        Ok(())
    }
}

/// In how many parts to take a step of `h` seconds, for the sake of what turns fast and is not a wheel.
fn parts(ctx: &Context, state: &State, h: f64) -> f64 {
    let mut fastest = WHIRL / h;
    for (index, body) in ctx.tree.bodies.iter().enumerate() {
        let dofs = &ctx.tree.dof[body.column..body.column + body.columns];
        let rate = match body.motion {
            Move::Turn => (body.ratio * state.v[dofs[0]]).abs(),
            Move::Free | Move::Ball => {
                let [x, y, z] = [state.v[dofs[0]], state.v[dofs[1]], state.v[dofs[2]]];
                (x * x + y * y + z * z).sqrt()
            }
            Move::Welded | Move::Slide => continue,
        };
        if rate > fastest && (body.motion != Move::Turn || !ctx.tree.is_wheel(index)) {
            fastest = rate;
        }
    }
    // Parts are not shorter than a fixed step may be.
    let most = (h / SHORTEST_FIXED_STEP).clamp(1.0, MAX_PARTS);
    libm::ceil(fastest * h / WHIRL - 1e-9).clamp(1.0, most)
}
