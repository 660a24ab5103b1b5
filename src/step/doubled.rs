//! An implicit step with its error: one solve over `h`, two over `h/2`, and what is made of them.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, Drive, is_clear};
use crate::kinematics::{advance, difference, position_rates};
use crate::state::State;
use crate::step::cones::Cones;
use crate::step::control::{Stepper, count, worst_error};
use crate::step::convex::Newton;
use crate::step::energy::{EXTRAPOLATION_GAIN, work};
use crate::step::point::{Context, Point};
use crate::step::smooth::range;
use crate::tuning::REFERENCE_GRAVITY;
use crate::tuning::{LAG_SHARE, MAX_ATTEMPTS, VELOCITY_WEIGHT};

impl Stepper {
    /// Solves over `h`; tells whether that went well.
    pub(super) fn full_solve(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        accuracy: f64,
    ) -> bool {
        if self.cones.moved {
            self.cones.set(&mut self.start, 0.0);
        }
        self.start.expect_commands(ctx, state, h);
        let problem = self.start.problem(ctx.tree, h, accuracy);
        self.full.guess_start(&problem, &state.v);
        let full = self.full.solve(&problem);
        count(state, full.iterations);
        full.converged
    }

    /// Whether the friction cones of the full solve over `h` seconds are too far off those that it has found.
    pub(super) fn cones_lag(&self, ctx: &Context, h: f64) -> bool {
        let mass = ctx.tree.moving_mass();
        let allowed = LAG_SHARE * ctx.tolerance * mass / VELOCITY_WEIGHT;
        ctx.rules.cones
            && h * Cones::lag(&self.start, &self.full, (mass, ctx.tolerance), h) > allowed
    }

    /// Repeats the full solve with the friction cones that it has found, and sets those of the first half, where the cones
    /// of the start are too far off; tells whether that went well.
    fn settle_cones(&mut self, ctx: &Context, state: &mut State, h: f64, accuracy: f64) -> bool {
        for attempt in 0..MAX_ATTEMPTS {
            if !self.cones_lag(ctx, h) {
                break;
            }
            if attempt == 0 {
                self.cones.begin(&self.start, &self.full, h);
            } else {
                self.cones.improve(&self.start, &self.full, h);
            }
            self.cones.set(&mut self.start, 1.0);
            let full = self.full.solve(&self.start.problem(ctx.tree, h, accuracy));
            count(state, full.iterations);
            if !full.converged {
                return false;
            }
        }
        if self.cones.moved {
            self.cones.set(&mut self.start, 0.5);
        }
        true
    }

    /// Solves twice over `h/2` beside the full solve; returns the error relative to the tolerance, infinite if a solve
    /// fails.
    pub(super) fn doubled_step(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        accuracy: f64,
    ) -> f64 {
        let tree = ctx.tree;
        if !self.settle_cones(ctx, state, h, accuracy) {
            return f64::INFINITY;
        }
        self.start.expect_commands(ctx, state, 0.5 * h);
        let problem = self.start.problem(tree, 0.5 * h, accuracy);
        self.first.guess_between(&problem, &state.v, &self.full);
        let first = self.first.solve(&problem);
        count(state, first.iterations);
        if !first.converged {
            return f64::INFINITY;
        }
        advance(tree, &state.q, &self.first.v, 0.5 * h, &mut self.half.q);
        store(&self.start, &self.first, 0.5 * h, &mut self.half);
        // As the full step saw them: `accept_doubled` asks again.
        self.start.expect_commands(ctx, state, h);
        let ctx = &ctx.after(0.5 * h);
        self.middle.update(ctx, &self.half, 0.5 * h);
        if self.cones.moved {
            self.cones.set(&mut self.start, 1.0);
            self.cones.carry(&self.start, &mut self.middle);
        }
        self.middle.expect_commands(ctx, &self.half, 0.5 * h);
        let problem = self.middle.problem(tree, 0.5 * h, accuracy);
        self.second.guess(&problem, &self.half.v, &self.full.v);
        let before = (&self.first, self.start.terms.contacts.as_slice());
        let second = self.second.solve_after(&problem, before);
        count(state, second.iterations);
        if !second.converged {
            return f64::INFINITY;
        }
        advance(tree, &state.q, &self.full.v, h, &mut self.q_full);
        advance(
            tree,
            &self.half.q,
            &self.second.v,
            0.5 * h,
            &mut self.q_halves,
        );
        difference(tree, &self.q_halves, &self.q_full, &mut self.difference);
        let velocities = self.second.v.iter().zip(&self.full.v).map(|(b, f)| b - f);
        let errors = self.difference.iter().copied().zip(velocities);
        worst_error(errors, &tree.dofs.weight) / ctx.tolerance
    }

    /// Whether a step of `h` seconds may reach beyond the communication point: inputs stay as they are, nothing touches, and
    /// no term has a memory that would have to be read off in between, too.
    pub(super) fn may_look_ahead(&self, ctx: &Context, state: &State, h: f64) -> bool {
        ctx.rules.look_ahead
            && state.ahead.changed == 0.0
            && self.start.terms.contacts.is_empty()
            && self.start.terms.joints.iter().all(|term| {
                // An impact on a limit is no polynomial.
                let resting = term.gap[0].min(term.gap[1]) > 0.0
                    || h * state.v[term.dof].abs() * ctx.tree.dofs.weight[term.dof]
                        <= ctx.tolerance;
                resting && term.dry.cap <= 0.0 && !matches!(term.drive, Drive::Velocity { .. })
            })
            && is_clear(ctx.tree, &self.start.kin, h)
    }

    /// Whether the step of `h` seconds just solved from `state` brings a joint to its limit or away from it, or deeper into it
    /// on the way than at its ends: the polynomial that joins them knows nothing of the limit's spring.
    pub(super) fn meets_limit(&self, ctx: &Context, state: &State, h: f64) -> bool {
        let tree = ctx.tree;
        let weight = tree.moving_mass() * REFERENCE_GRAVITY;
        let allowed = EXTRAPOLATION_GAIN * ctx.tolerance * weight * tree.reach();
        self.start.terms.joints.iter().any(|term| {
            let (place, dof) = (term.coordinate, term.dof);
            let q = [state.q[place], self.q_halves[place]];
            let moved = q[1] - q[0];
            let [low, high] = range(q, [state.v[dof], self.second.v[dof]], h);
            let meets = |gap: f64, end: f64, least: f64| {
                let held = |gap: f64| gap.min(0.0) * gap.min(0.0);
                let more = held(least) - held(gap).max(held(end));
                (gap > 0.0) != (end > 0.0) || 0.5 * term.limit.stiffness * more > allowed
            };
            let [lower, upper] = term.gap;
            meets(lower, lower + moved, lower + low - q[0])
                || meets(upper, upper - moved, upper + q[0] - high)
        })
    }

    /// Keeps what lies beyond the communication point at `end` of the implicit step of `h` seconds from time `start` that
    /// led from what was kept to `state`: cubic polynomials for positions, their derivatives' kind for
    /// velocities.
    pub(super) fn interpolate(
        &mut self,
        ctx: &Context,
        state: &mut State,
        start: f64,
        h: f64,
        end: f64,
    ) {
        let tree = ctx.tree;
        let (q0, v0) = (&self.q_start, &self.v_start);
        let [rate0, rate1] = self.explicit.rates();
        position_rates(tree, q0, v0, rate0);
        position_rates(tree, &state.q, &state.v, rate1);
        difference(tree, &state.q, q0, &mut self.difference);
        let State { ahead, q, v, .. } = state;
        ahead.start = start;
        ahead.length = h;
        ahead.coefficients.clear();
        for (i, (a, b)) in q0.iter().zip(q.iter()).enumerate() {
            let change = b - a;
            let bend = h * rate0[i] - change;
            let row = [*a, change, bend, change - h * rate1[i] - bend, 0.0];
            ahead.coefficients.extend(row);
        }
        for ((a, b), moved) in v0.iter().zip(v.iter()).zip(&self.difference) {
            let bend = 6.0 * moved / h - 3.0 * (a + b);
            ahead.coefficients.extend([*a, b - a, bend, 0.0, 0.0]);
        }
        ahead.evaluate(tree, end, q, v);
    }

    /// Takes the results of [`Self::doubled_step`] from where `self.start` stands into the state: extrapolated, or the half
    /// steps' as they are, which damp what the step does not resolve. Extrapolation goes where the laws would lead if the
    /// step resolved them; an impact that it does not, or the spring of a limit that is stiffer than the tolerance, may
    /// throw the robot back with more than it came with, and then the half steps' results are taken, too. Tells whether
    /// poses and velocities of `self.end` stand at the new state.
    pub(super) fn accept_doubled(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        extrapolate: bool,
    ) -> bool {
        let (mut extrapolated, mut posed) = (extrapolate, false);
        let allowed = EXTRAPOLATION_GAIN * ctx.tolerance;
        if extrapolate && self.may_gain(ctx, state, h, allowed) {
            let books = self.open_books(ctx, state, allowed);
            let halves = work(ctx, &self.start, &self.first, 0.5 * h)
                + work(ctx, &self.middle, &self.second, 0.5 * h);
            let work = 2.0 * halves - work(ctx, &self.start, &self.full, h);
            self.extrapolate(ctx, state, h);
            extrapolated = !self.gains(ctx, &books, state, h, work);
            posed = extrapolated;
        } else if extrapolate {
            self.extrapolate(ctx, state, h);
        }
        if extrapolated {
            add_impulses(
                &self.start.terms.contacts,
                &self.first,
                2.0,
                &mut state.impulse,
            );
            add_impulses(
                &self.middle.terms.contacts,
                &self.second,
                2.0,
                &mut state.impulse,
            );
            add_impulses(
                &self.start.terms.contacts,
                &self.full,
                -1.0,
                &mut state.impulse,
            );
        } else {
            state.lag.clear();
            store(&self.middle, &self.second, 0.5 * h, state);
            state.q.copy_from_slice(&self.q_halves);
            add_impulses(
                &self.start.terms.contacts,
                &self.first,
                1.0,
                &mut state.impulse,
            );
            add_impulses(
                &self.middle.terms.contacts,
                &self.second,
                1.0,
                &mut state.impulse,
            );
        }
        posed
    }

    /// Twice the half steps' results less the full step's, into the state; contact impulses are the caller's.
    fn extrapolate(&mut self, ctx: &Context, state: &mut State, h: f64) {
        let tree = ctx.tree;
        self.measure_lag(state, h);
        store(&self.middle, &self.second, 0.5 * h, state);
        advance(tree, &self.q_halves, &self.difference, 1.0, &mut state.q);
        let (start, middle) = (&self.start.terms, &self.middle.terms);
        let full = &mut self.full_memory;
        start.remember(&self.full.solved(), h, full);
        start.extrapolate(middle, full, &mut state.memory);
        for ((v, second), full) in state.v.iter_mut().zip(&self.second.v).zip(&self.full.v) {
            *v = 2.0 * second - full;
        }
    }
}

/// Velocity and memory after a solve; positions are the caller's.
pub(super) fn store(point: &Point, newton: &Newton, h: f64, state: &mut State) {
    state.v.copy_from_slice(&newton.v);
    let terms = &point.terms;
    terms.remember(&newton.solved(), h, &mut state.memory);
}

/// Adds `share` times the contact impulses to their links.
pub(super) fn add_impulses(
    contacts: &[Contact],
    newton: &Newton,
    share: f64,
    impulse: &mut [[f64; 3]],
) {
    for (contact, response) in contacts.iter().zip(&newton.responses.contacts) {
        let sum = &mut impulse[contact.link];
        for (sum, x) in sum.iter_mut().zip(response.impulse.iter()) {
            *sum += share * x;
        }
    }
}
