//! Steps of one solve, where a communication step cuts them short of what the error control proposes.
//!
//! A solve by itself is of first order. What it gets wrong is measured by every step that is solved in full and in halves,
//! and hardly changes until the next: it is taken off the solves that follow, which are then of second order as well. The
//! robot at hand tells whether it still holds: velocities are wrong by half the change of acceleration, positions by half
//! the change of velocity. Where nothing is known, and hardly anything happens, the solve does as it is.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::advance;
use crate::state::State;
use crate::step::control::{Stepper, worst_error};
use crate::step::doubled::{add_impulses, store};
use crate::step::energy::EXTRAPOLATION_GAIN;
use crate::step::point::Context;
use crate::tuning::{LAG_DOUBT, SINGLE_RATE};

impl Stepper {
    /// Takes the full solve over `h` seconds into the state if it does without the half steps; tells whether it was taken.
    pub(super) fn single_step(&mut self, ctx: &Context, state: &mut State, h: f64) -> bool {
        if self.cones_lag(ctx, h) {
            return false;
        }
        let known = ctx.rules.known_error && state.lag.is_known(h, self.full.pressing());
        if known && self.lag_doubt(ctx, state, h) <= LAG_DOUBT {
            for (way, lag) in self.difference.iter_mut().zip(&state.lag.positions) {
                *way = -h * h * lag;
            }
            let share = EXTRAPOLATION_GAIN * ctx.tolerance;
            if !self.may_gain_singly(ctx, state, h, share) {
                self.accept_corrected(ctx, state, h);
                return true;
            }
        }
        let good = self.single_error(ctx, state, h) <= SINGLE_RATE * h;
        if good {
            self.accept_single(ctx, state, h);
            state.lag.clear();
        }
        good
    }

    /// Error of the full solve by itself, relative to the tolerance: positions lag behind by half the change of
    /// velocity, velocities by half the change of acceleration since the last step (Milne's device).
    pub(super) fn single_error(&self, ctx: &Context, state: &State, h: f64) -> f64 {
        let changes = self.full.v.iter().zip(&state.v).zip(&state.trend);
        let errors = changes.map(|((v, v0), trend)| {
            let change = v - v0;
            (0.5 * h * change, 0.5 * (change - h * trend))
        });
        worst_error(errors, &ctx.tree.dofs.weight) / ctx.tolerance
    }

    /// Keeps where a step starts, before its result goes into `state`.
    pub(super) fn keep_start(&mut self, state: &State) {
        self.v_start.copy_from_slice(&state.v);
        self.q_start.copy_from_slice(&state.q);
    }

    /// The mean acceleration over the step of `h` seconds that led from what was kept to `state`.
    pub(super) fn end_trend(&self, state: &mut State, h: f64) {
        for ((trend, v), start) in state.trend.iter_mut().zip(&state.v).zip(&self.v_start) {
            *trend = (v - start) / h;
        }
    }

    /// Takes the full solve into the state as it is.
    pub(super) fn accept_single(&mut self, ctx: &Context, state: &mut State, h: f64) {
        self.keep_start(state);
        store(&self.start, &self.full, h, state);
        advance(ctx.tree, &self.q_start, &self.full.v, h, &mut state.q);
        add_impulses(
            &self.start.terms.contacts,
            &self.full,
            1.0,
            &mut state.impulse,
        );
        self.end_trend(state, h);
    }

    /// Measures the error of a solve by itself on the step of `h` seconds that has just been solved in full and in halves.
    pub(super) fn measure_lag(&self, state: &mut State, h: f64) {
        let lag = &mut state.lag;
        if self.cones.moved {
            // The next solve begins with other cones.
            lag.clear();
            return;
        }
        lag.measure(h, &self.difference, &self.full.v, &self.second.v);
        lag.pressing = self.full.pressing();
        let (share, impulses) = (2.0 / (h * h), &mut lag.impulses);
        impulses.fill([0.0; 3]);
        add_impulses(&self.start.terms.contacts, &self.full, share, impulses);
        add_impulses(&self.start.terms.contacts, &self.first, -share, impulses);
        add_impulses(&self.middle.terms.contacts, &self.second, -share, impulses);
    }

    /// How far the known error of the full solve is from half the changes of velocity and of acceleration, relative to the
    /// tolerance.
    fn lag_doubt(&self, ctx: &Context, state: &State, h: f64) -> f64 {
        let lag = &state.lag;
        let between = 0.5 * (h + lag.last);
        let changes = self.full.v.iter().zip(&state.v).zip(&state.trend);
        let errors = changes.zip(lag.positions.iter().zip(&lag.velocities)).map(
            |(((v, v0), trend), (position, velocity))| {
                let change = v - v0;
                let jerk = (change / h - h * velocity - trend) / between;
                let moved = h * (h * position - 0.5 * change);
                (moved, h * h * (velocity - 0.5 * jerk))
            },
        );
        worst_error(errors, &ctx.tree.dofs.weight) / ctx.tolerance
    }

    /// Takes the full solve into the state less its known error, which moves positions by `self.difference`, and bodies by what
    /// stands in `self.end.kin.V`.
    fn accept_corrected(&mut self, ctx: &Context, state: &mut State, h: f64) {
        self.accept_single(ctx, state, h);
        self.q_full.copy_from_slice(&state.q);
        advance(ctx.tree, &self.q_full, &self.difference, 1.0, &mut state.q);
        for ((v, trend), lag) in state
            .v
            .iter_mut()
            .zip(&mut state.trend)
            .zip(&state.lag.velocities)
        {
            *v -= h * h * lag;
            *trend -= h * lag;
        }
        let State { impulse, lag, .. } = state;
        for (sum, lag) in impulse.iter_mut().zip(&lag.impulses) {
            for (sum, lag) in sum.iter_mut().zip(lag) {
                *sum -= h * h * lag;
            }
        }
        let way = &self.end.kin.V;
        let terms = &self.start.terms;
        let solved = self.full.solved();
        terms.shift(&solved, (way, &self.difference), h, &mut state.memory);
        state.lag.last = h;
        state.lag.uses -= 1.0;
    }
}
