//! Steps of one solve, where a communication step cuts them short of what the error control
//! proposes.
//!
//! A single solve is of first order. What it gets wrong is measured by every step that is solved in
//! full and in halves, and hardly changes until the next: it is taken off the solves that follow,
//! which are then of second order as well. The robot at hand tells whether it still holds:
//! velocities are wrong by half the change of acceleration, positions by half the change of
//! velocity. Where nothing is known, and hardly anything happens, the solve does as it is.

use super::{Implicit, Single};
use crate::kinematics::advance;
use crate::state::lag::Lag;
use crate::state::{Physical, State, Stepping};
use crate::step::attempt::Attempt;
use crate::step::guards;
use crate::step::point::{Context, Point};
use crate::step::size::worst_error;
use crate::tuning::{EXTRAPOLATION_GAIN, LAG_DOUBT, SINGLE_RATE};

impl Implicit {
    /// Puts the full solve over `h` seconds from where `here` stands into `attempt`, if it does
    /// without the half steps.
    pub fn single(
        &mut self,
        ctx: &Context,
        here: &Point,
        state: &State,
        h: f64,
        attempt: &mut Attempt,
    ) -> Single {
        if self.cones_lag(ctx, here, h) {
            return Single::No;
        }
        let State {
            physical: from,
            stepping: Stepping { lag, trend, .. },
            ..
        } = state;
        let known = ctx.rules.known_error && lag.is_known(h, self.full.pressing());
        if known && self.doubt(ctx, from, (lag, trend), h) <= LAG_DOUBT {
            for (more, lag) in self.more.iter_mut().zip(&lag.positions) {
                *more = -h * h * lag;
            }
            let share = EXTRAPOLATION_GAIN * ctx.tolerance;
            if !self.may_gain_singly(ctx, here, (from, lag), [h, share]) {
                attempt.begin(state);
                self.take_full(ctx, here, from, h, attempt);
                self.correct(ctx, here, lag, h, attempt);
                return Single::Corrected;
            }
        }
        if self.single_error(ctx, from, trend, h) > SINGLE_RATE * h {
            return Single::No;
        }
        attempt.begin(state);
        self.take_full(ctx, here, from, h, attempt);
        Single::Plain
    }

    /// Error of the full solve by itself, relative to the tolerance: positions lag behind by half
    /// the change of velocity, velocities by half the change of acceleration since the last step
    /// (Milne's device).
    ///
    /// - `trend`: mean acceleration over the last step
    pub fn single_error(&self, ctx: &Context, from: &Physical, trend: &[f64], h: f64) -> f64 {
        let changes = self.full.v.iter().zip(&from.v).zip(trend);
        let errors = changes.map(|((v, v0), trend)| {
            let change = v - v0;
            (0.5 * h * change, 0.5 * (change - h * trend))
        });
        worst_error(errors, &ctx.tree.dofs.weight) / ctx.tolerance
    }

    /// Puts the full solve over `h` seconds from where `here` stands into `attempt` as it is.
    pub fn take_full(
        &mut self,
        ctx: &Context,
        here: &Point,
        from: &Physical,
        h: f64,
        attempt: &mut Attempt,
    ) {
        attempt.take_solved(here, &self.full, h);
        advance(ctx.tree, &from.q, &self.full.v, h, &mut attempt.end.q);
        attempt.add_impulses(here, &self.full, 1.0);
        attempt.end_trend(&from.v, h);
    }

    /// How far the known error of the full solve is from half the changes of velocity and of
    /// acceleration, relative to the tolerance.
    fn doubt(&self, ctx: &Context, from: &Physical, (lag, trend): (&Lag, &[f64]), h: f64) -> f64 {
        let between = 0.5 * (h + lag.last);
        let changes = self.full.v.iter().zip(&from.v).zip(trend);
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

    /// Whether taking the known error off the full solve may add more energy than allowed;
    /// `self.way` is then the displacement of the bodies.
    fn may_gain_singly(
        &mut self,
        ctx: &Context,
        here: &Point,
        (from, lag): (&Physical, &Lag),
        [h, share]: [f64; 2],
    ) -> bool {
        let (tree, lag) = (ctx.tree, &lag.velocities);
        let pattern = &tree.sparsity;
        pattern.multiply(&here.kin.M, lag, &mut self.momentum);
        let mut rise = 0.0;
        for ((momentum, v), lag) in self.momentum.iter().zip(&self.full.v).zip(lag) {
            rise -= h * h * momentum * (v - 0.5 * h * h * lag);
        }
        rise += guards::lifted(tree, here, &self.full, h, &self.more, &mut self.way);
        guards::exceeds(ctx, here, from, [rise, share])
    }

    /// Takes the known error off the full solve in `attempt`: it moves positions by `self.more`,
    /// and bodies by `self.way`.
    fn correct(&mut self, ctx: &Context, here: &Point, lag: &Lag, h: f64, attempt: &mut Attempt) {
        let Attempt {
            end,
            impulse,
            trend,
        } = attempt;
        self.q_full.copy_from_slice(&end.q);
        advance(ctx.tree, &self.q_full, &self.more, 1.0, &mut end.q);
        for ((v, trend), lag) in end.v.iter_mut().zip(trend).zip(&lag.velocities) {
            *v -= h * h * lag;
            *trend -= h * lag;
        }
        for (sum, lag) in impulse.iter_mut().zip(&lag.impulses) {
            for (sum, lag) in sum.iter_mut().zip(lag) {
                *sum -= h * h * lag;
            }
        }
        let (solved, moved) = (self.full.solved(), (&self.way[..], &self.more[..]));
        here.terms.shift(&solved, moved, h, &mut end.memory);
    }
}
