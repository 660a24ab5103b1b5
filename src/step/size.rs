//! Length of steps, and acceptance of tries, from one communication point to the next.

use crate::state::{Sizes, Stepping};
use crate::step::point::Context;
use crate::tree::Tree;
use crate::tuning::{
    FLOOR_FALL, FLOOR_REACH, FLOOR_RISE, FLOOR_TOLERANCE, FLOOR_TURN, GROWTH, IMPLICIT_SAFETY,
    LANDING, LEAST_ERROR, MAX_FLOOR, MIN_STEP, VELOCITY_WEIGHT,
};

/// What stands at the state already when a step begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// Nothing.
    Nowhere,
    /// Poses and velocities of the point where the last step ended.
    Posed,
    /// The point where the next step begins, whole.
    Current,
}

/// The way from one communication point to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Time at which it begins, s.
    pub begin: f64,
    /// Time at which it ends, s.
    pub end: f64,
    /// How far it has been gone, s.
    pub done: f64,
    /// Step that the error control proposes, s.
    pub proposed: f64,
    /// What need not be computed anew.
    pub standing: Standing,
    /// Length, s, and error of the last try from here, if there was one.
    pub before: Option<[f64; 2]>,
}

/// A step that has been tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tried {
    /// Its length, s.
    pub h: f64,
    /// Its error, relative to what is allowed; not finite if it failed.
    pub error: f64,
    /// Length that the next one should have, relative to this one's.
    pub factor: f64,
    /// Length that the error would allow the next one, if this one went well, s.
    pub ease: f64,
    /// What is proposed after it, if it is accepted, s.
    pub next: f64,
    /// Whether its error falls with its length: then a shorter one is tried, however short.
    pub smooth: bool,
}

/// What becomes of a try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is taken.
    Accept,
    /// A shorter one is tried, of the length that is proposed now.
    Retry,
    /// There is no shorter one.
    Fail,
}

impl Way {
    /// All of it, to be begun with a step of `proposed` seconds.
    pub fn new(begin: f64, end: f64, proposed: f64) -> Self {
        Self {
            begin,
            end,
            done: 0.0,
            proposed,
            standing: Standing::Nowhere,
            before: None,
        }
    }

    /// What is left of it, s.
    pub fn remaining(&self) -> f64 {
        self.end - self.begin - self.done
    }

    /// Takes a step of `h` seconds off the way; the last one ends it to the bit.
    pub fn go(&mut self, h: f64) {
        if h >= self.remaining() {
            self.arrive();
        } else {
            self.done += h;
        }
    }

    /// Ends the way.
    pub fn arrive(&mut self) {
        self.done = self.end - self.begin;
    }

    /// Whether the error of a try of `h` seconds has fallen with its length since the try before it
    /// from the same place, if there was one. At the shortest step, one without an error has not.
    pub fn falls(&self, h: f64, error: f64) -> bool {
        let falls = |[longer, worse]: [f64; 2]| error * longer <= worse * h;
        (error.is_finite() || h > MIN_STEP) && self.before.is_none_or(falls)
    }

    /// Decides on a try and proposes what comes next; enters it in the counters.
    pub fn judge(&mut self, ctx: &Context, stepping: &mut Stepping, tried: &Tried) -> Verdict {
        let &Tried { h, error, .. } = tried;
        let ease = (error <= 1.0).then_some(tried.ease);
        let floor = patience(ctx, &mut stepping.sizes, [h, self.remaining()], ease);
        let floor = if tried.smooth { 0.0 } else { floor };
        let finite = error.is_finite();
        if error <= 1.0 || (h <= floor && finite) {
            stepping.counters.forced += u64::from(error > 1.0);
            self.proposed = tried.next.max(floor);
            stepping.counters.steps += 1;
            stepping.sizes.proposed[ctx.tree.island.lead] = self.proposed;
            self.before = None;
            Verdict::Accept
        } else if finite || h > MIN_STEP {
            stepping.counters.rejected += 1;
            self.before = Some([h, error]);
            self.proposed = (h * tried.factor).max(if finite { floor } else { MIN_STEP });
            Verdict::Retry
        } else {
            Verdict::Fail
        }
    }
}

/// Shortest step that the error control may ask for now; takes note of a step of `h` seconds.
///
/// Some contacts of very light bodies on heavy robots oscillate in nanoseconds between normal force
/// and friction (Painlevé's problem), and a joint may be told to spin at any speed: resolving that
/// buys nothing and stalls the host. A run of steps near the floor therefore raises it, slowly
/// enough that an impact passes unhindered. Steps that go well lower it again if they take ten
/// times as long, or would but for the communication step; those that it cuts do not raise it.
///
/// - `ease`: length of the next step if this one went well, s
fn patience(ctx: &Context, sizes: &mut Sizes, [h, remaining]: [f64; 2], ease: Option<f64>) -> f64 {
    let floor = &mut sizes.floor[ctx.tree.island.lead];
    *floor = floor.max(MIN_STEP);
    let cut = h >= remaining;
    let taken = ease.map_or(0.0, |next| if cut { next.max(h) } else { h });
    if taken >= FLOOR_REACH * *floor {
        *floor *= FLOOR_FALL;
    } else if ctx.rules.floor && !cut && h < FLOOR_REACH * *floor {
        let scale = (ctx.tolerance / FLOOR_TOLERANCE).sqrt().min(1.0);
        *floor = (*floor * (1.0 + FLOOR_RISE * scale)).min(scale * MAX_FLOOR);
    }
    floor.max(MIN_STEP)
}

/// Lowers the floor where something whirls, with the velocities `v`. A step that is taken although
/// it errs makes energy there, and the next one all the more: however fast something turns, and
/// whatever has raised the floor before, it is resolved.
pub(super) fn lower_floor(ctx: &Context, sizes: &mut Sizes, v: &[f64]) {
    let floor = &mut sizes.floor[ctx.tree.island.lead];
    if *floor > MIN_STEP {
        *floor = floor.min(FLOOR_TURN / fastest(ctx.tree, v)).max(MIN_STEP);
    }
}

/// Length of the next step on the way to a communication point: no short rest is left over.
pub(super) fn landing(h: f64, remaining: f64) -> f64 {
    if h >= remaining {
        remaining
    } else if LANDING * h > remaining {
        0.5 * remaining
    } else {
        h
    }
}

/// Length of the next implicit step, relative to one of `h` seconds whose error is `error` times
/// what is allowed.
///
/// The error falls with the third power of the step where motion is smooth. In an impact it is the
/// change of velocity however short the step is, until one resolves the impact: there a shorter try
/// of the same step shows with which power it falls.
///
/// - `before`: length and error of the try before it from the same place, if there was one
pub(super) fn implicit_factor([h, error]: [f64; 2], before: Option<[f64; 2]>) -> f64 {
    let power = match before {
        Some([longer, worse]) if error > 1.0 && worse.is_finite() => {
            let seen = libm::log(worse / error) / libm::log(longer / h);
            seen.clamp(0.0, 3.0)
        }
        _ => 3.0,
    };
    let factor = IMPLICIT_SAFETY * libm::pow(error.max(LEAST_ERROR.0), -1.0 / power);
    factor.clamp(GROWTH.0, GROWTH.1)
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

/// The longest of the weighted errors of positions and velocities after a step of `h` seconds,
/// whose components `error` gives for each degree of freedom that a step works on; infinite if one
/// is not a number.
///
/// An error of a position is one of the mean velocity of the step, and counts as such. If it
/// counted as it is, a motion in short steps, as communication points make them, could go wrong by
/// one tolerance in each of them.
pub(super) fn worst_error(tree: &Tree, h: f64, error: impl Fn(usize) -> (f64, f64)) -> f64 {
    let velocities = |k: usize| {
        let (position, velocity) = error(k);
        [position / h, velocity]
    };
    VELOCITY_WEIGHT * tree.longest(velocities)
}

/// Largest rate at which the bias turns at the start or the end of a step, with their velocities,
/// rad/s.
pub(super) fn fastest_within(tree: &Tree, [start, end]: [&[f64]; 2]) -> f64 {
    fastest(tree, start).max(fastest(tree, end))
}

/// Largest rate at which the bias turns, rad/s: that of a body, or how a wheel makes what carries
/// it nutate.
pub(super) fn fastest(tree: &Tree, v: &[f64]) -> f64 {
    let mut fastest: f64 = 0.0;
    for span in &tree.island.spans {
        for (_, body) in tree.bodies_of(span) {
            let rate = body.kind.turn_rate(body.ratio, &v[body.dof..]);
            fastest = fastest.max(body.spinning * rate);
        }
    }
    fastest
}
