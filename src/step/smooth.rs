//! When nothing stiff acts but damping, and how far a Runge–Kutta step may then reach.

use crate::force::{Drive, JointTerm, is_clear};
use crate::state::State;
use crate::step::control::{Stepper, grown, landing, worst_error};
use crate::step::point::Context;
use crate::step::runge_kutta::{
    BOGACKI_SHAMPINE, DORMAND_PRINCE, Explicit, KENNEDY_CARPENTER, Pair, Smooth,
};
use crate::tree::Tree;
use crate::tuning::{GROWTH, HIT, MAX_EXPLICIT_STEP, MAX_STEP, PAIR_EXPONENT, SHORT};

impl Stepper {
    /// Method and length of the next explicit step: beyond the communication point as long as inputs stay as they
    /// are, else up to it; none where something stiff acts.
    pub(super) fn smooth_step(
        &self,
        ctx: &Context,
        state: &State,
        proposed: f64,
        remaining: f64,
    ) -> Option<(&'static Pair, f64)> {
        if !ctx.rules.explicit || !self.nothing_stiff(ctx) {
            return None;
        }
        let long = proposed.min(MAX_EXPLICIT_STEP);
        if ctx.rules.look_ahead && state.ahead.changed == 0.0 {
            if self.is_free(ctx, state, long) {
                return Some(if self.resolves_damping(long) {
                    (&DORMAND_PRINCE, long)
                } else {
                    (&KENNEDY_CARPENTER, long.min(MAX_STEP))
                });
            }
            // Implicit steps reach farther than those that end at the communication point.
            if self.may_look_ahead(ctx, state, long) {
                return None;
            }
        }
        let h = landing(long, remaining);
        if !self.is_free(ctx, state, h) {
            return None;
        }
        let short = h < SHORT * proposed * libm::pow(ctx.tolerance, PAIR_EXPONENT);
        let pair = match (self.resolves_damping(h), short) {
            (true, true) => &BOGACKI_SHAMPINE,
            (true, false) => &DORMAND_PRINCE,
            (false, false) => &KENNEDY_CARPENTER,
            // Cut as short as this, one implicit solve may do.
            (false, true) => return None,
        };
        Some((pair, h))
    }

    /// Keeps what lies beyond the communication point at `end` of the step of `h` seconds by `pair` from time `start`.
    pub(super) fn look_ahead(
        &mut self,
        ctx: &Context,
        pair: &Pair,
        state: &mut State,
        start: f64,
        h: f64,
        end: f64,
    ) {
        self.explicit
            .extension(pair, &state.q, &state.v, h, &mut state.ahead.coefficients);
        state.ahead.start = start;
        state.ahead.length = h;
        accept_explicit(&mut self.explicit, pair, state);
        let State { ahead, q, v, .. } = state;
        ahead.evaluate(ctx.tree, end, q, v);
    }

    /// Whether no joint has anything but efforts and gentle damping.
    fn nothing_stiff(&self, ctx: &Context) -> bool {
        // A motor that is let go may take hold again within the step.
        let may_become_stiff = |term: &JointTerm| {
            ctx.inputs.varies()
                && term.actuator.is_some()
                && !matches!(term.drive, Drive::Effort(_))
        };
        self.start.terms.contacts.is_empty()
            && self
                .start
                .terms
                .joints
                .iter()
                .all(|term| !term.is_stiff() && !may_become_stiff(term) && term.damping >= 0.0)
    }

    /// Whether nothing comes near within `h` seconds, and a motor's torque–speed line is resolved.
    fn is_free(&self, ctx: &Context, state: &State, h: f64) -> bool {
        let kin = &self.start.kin;
        self.start.terms.joints.iter().all(|term| {
            !term.near_limit(state.v[term.dof], h)
                && h * term.line.slope() * kin.inverse_diagonal[term.dof] < 1.0
        }) && is_clear(ctx.tree, kin, h)
    }

    /// Whether damping is slower than a step of `h` seconds.
    fn resolves_damping(&self, h: f64) -> bool {
        let inverse = &self.start.kin.inverse_diagonal;
        let terms = &self.start.terms.joints;
        terms
            .iter()
            .all(|term| h * term.damping * inverse[term.dof] < 1.0)
    }

    /// Explicit step into `self.explicit`; returns its error relative to the tolerance.
    pub(super) fn explicit_step(
        &mut self,
        ctx: &Context,
        pair: &Pair,
        state: &State,
        h: f64,
    ) -> f64 {
        self.run_stages(ctx, pair, state, h, true);
        self.explicit.estimate(pair, ctx.tree, h);
        let [velocity, position] = &self.explicit.error;
        let errors = position.iter().copied().zip(velocity.iter().copied());
        let error = worst_error(errors, &ctx.tree.dofs.weight) / (pair.share * ctx.tolerance);
        if self.stays_free(ctx, state, h) {
            error
        } else {
            error.max(HIT)
        }
    }

    fn run_stages(&mut self, ctx: &Context, pair: &Pair, state: &State, h: f64, finish: bool) {
        let system = Smooth {
            ctx: *ctx,
            joints: &self.start.terms.joints,
        };
        let (start, end) = (&self.start.kin, &mut self.middle.kin);
        self.explicit
            .step(pair, &system, start, end, &state.q, &state.v, h, finish);
    }

    /// Takes an explicit step of `h` seconds, a fixed length, where nothing stiff acts, nothing is met and no energy is made
    /// beyond a `gain`, where one is given, as a share of kinetic energy and weight times reach; tells whether.
    pub(super) fn fixed_explicit_step(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        gain: Option<f64>,
    ) -> bool {
        if !(ctx.rules.explicit
            && self.nothing_stiff(ctx)
            && self.is_free(ctx, state, h)
            && self.resolves_damping(h))
        {
            return false;
        }
        self.explicit.restart();
        self.run_stages(ctx, &BOGACKI_SHAMPINE, state, h, false);
        let Explicit { q, v, .. } = &self.explicit;
        let finite = q.iter().chain(v).all(|x| x.is_finite());
        let gains = |gain: f64| {
            let books = self.open_books(ctx, state, gain);
            self.gains_explicitly(ctx, &books, state)
        };
        let taken = finite && self.stays_free(ctx, state, h) && !gain.is_some_and(gains);
        if taken {
            accept_explicit(&mut self.explicit, &BOGACKI_SHAMPINE, state);
        }
        taken
    }

    /// Whether the explicit step just taken from `state` has stayed within all limits, and has ended off the ground.
    fn stays_free(&self, ctx: &Context, state: &State, h: f64) -> bool {
        let within = self.start.terms.joints.iter().all(|term| {
            ctx.tree.dofs.limits[term.dof].is_none_or(|limits| {
                let (place, dof) = (term.coordinate, term.dof);
                let (q, v) = (&self.explicit.q, &self.explicit.v);
                let [low, high] = range([state.q[place], q[place]], [state.v[dof], v[dof]], h);
                low >= limits.lower && high <= limits.upper
            })
        });
        within && is_clear(ctx.tree, &self.middle.kin, 0.0)
    }
}

/// Least and greatest of the cubic with positions `q` and velocities `v` at its ends, `h` seconds apart: a joint may reach
/// its limit and turn back within a long step.
pub(super) fn range(q: [f64; 2], v: [f64; 2], h: f64) -> [f64; 2] {
    let (low, high) = (q[0].min(q[1]), q[0].max(q[1]));
    if v[0] * v[1] > 0.0 && (q[1] - q[0]) * v[0] > 0.0 {
        return [low, high];
    }
    // q(s) = q0 + a s + b s² + c s³ for s from 0 to 1; its slope is zero at the roots of a + 2 b s + 3 c s².
    let (a, end, way) = (h * v[0], h * v[1], q[1] - q[0]);
    let (b, c) = (3.0 * way - 2.0 * a - end, a + end - 2.0 * way);
    let root = (b * b - 3.0 * a * c).max(0.0).sqrt();
    // The stable forms of both: no difference of large numbers.
    let sum = -(b + root.copysign(b));
    let turns = [sum / (3.0 * c), a / sum];
    turns.into_iter().fold([low, high], |[low, high], s| {
        if s > 0.0 && s < 1.0 {
            let at = q[0] + s * (a + s * (b + s * c));
            [low.min(at), high.max(at)]
        } else {
            [low, high]
        }
    })
}

/// Goes along the smooth step under way, at most to `end`; returns how far.
pub(super) fn follow(tree: &Tree, state: &mut State, end: f64) -> f64 {
    if state.ahead.is_empty() {
        return 0.0;
    }
    let State { ahead, q, v, .. } = state;
    let last = ahead.end();
    if end < last {
        ahead.evaluate(tree, end, q, v);
        return end - state.time;
    }
    ahead.evaluate(tree, last, q, v);
    ahead.clear();
    (last - state.time).min(end - state.time)
}

/// The next proposal after an explicit step, in steps of the longer pair.
pub(super) fn next_proposal(
    proposed: f64,
    h: f64,
    pair: &Pair,
    factor: f64,
    tolerance: f64,
) -> f64 {
    if pair.order > BOGACKI_SHAMPINE.order {
        grown(proposed, h, factor)
    } else if factor >= GROWTH.1 {
        proposed
    } else {
        proposed.min(h * factor / (SHORT * libm::pow(tolerance, PAIR_EXPONENT)))
    }
}

/// Takes over an explicit step: nothing touches, so nothing is displaced.
pub(super) fn accept_explicit(explicit: &mut Explicit, pair: &Pair, state: &mut State) {
    state.q.copy_from_slice(&explicit.q);
    state.v.copy_from_slice(&explicit.v);
    state.memory.clear();
    state.trend.fill(0.0);
    explicit.accept(pair);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the cubic itself, looked at a thousand times.
    #[test]
    fn the_range_of_a_cubic_holds_its_turning_points() {
        for (q, v) in [
            ([0.0, 0.0], [1.0, -1.0]),
            ([0.0, 0.1], [2.0, 2.0]),
            ([0.0, 0.1], [-2.0, -2.0]),
            ([0.3, -0.2], [0.0, 0.5]),
            ([0.3, 0.3], [0.0, 0.0]),
            ([0.0, 1.0], [1.0, 1.0]),
            ([0.0, 0.01], [1.0, -0.3]),
        ] {
            let h = 0.3;
            let [low, high] = range(q, v, h);
            let way = q[1] - q[0];
            let (a, end) = (h * v[0], h * v[1]);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..=1000 {
                let s = f64::from(i) / 1000.0;
                let b = 3.0 * way - 2.0 * a - end;
                let at = q[0] + s * (a + s * (b + s * (a + end - 2.0 * way)));
                (least, most) = (least.min(at), most.max(at));
            }
            assert!(
                (low - least).abs() < 1e-5 && (high - most).abs() < 1e-5,
                "{q:?} {v:?}"
            );
        }
    }
}
