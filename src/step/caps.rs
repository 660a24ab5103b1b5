//! Where a step must end, and whether it may reach beyond the communication point.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, Drive, is_clear};
use crate::kinematics::forward;
use crate::spatial::Vec6;
use crate::state::{Physical, State, Trend};
use crate::step::point::{Context, Point};
use crate::tuning::{
    BOUNCE_SHARE, BOUNCED, CONTACT_STEP, CONTROLLED_GAIN, CREEP, MAX_STEP, MIN_STEP,
    REFERENCE_GRAVITY,
};

/// Longest implicit step from where `here` stands, s.
pub(super) fn longest(here: &Point) -> f64 {
    if here.terms.contacts.iter().any(|c| c.depth > 0.0) {
        CONTACT_STEP
    } else {
        MAX_STEP
    }
}

/// Ends the step of `h` seconds where the first contact touches down or the first joint reaches its
/// limit; takes a bounce in parts of its own duration, of which the last one ends where it leaves.
///
/// - `pull`: see [`find_pull`]
pub(super) fn by_touchdown(
    ctx: &Context,
    here: &Point,
    (from, pull): (&Physical, &[Vec6]),
    h: f64,
) -> f64 {
    let rules = ctx.rules;
    let mut capped = h;
    let (points, V) = (&here.terms.contacts.points, &here.kin.V);
    for contact in here.terms.contacts.iter() {
        let time = if contact.depth < 0.0 {
            contact.time_to_touch(points, V)
        } else {
            0.0
        };
        let touches = time <= MIN_STEP;
        if rules.touchdown && time < capped && !touches {
            capped = time;
        }
        if contact.thickness < f64::INFINITY {
            let time = contact.longest_step(points, V, h);
            capped = capped.min(time.max(MIN_STEP));
        }
        if touches && rules.bounce && still_bounces(here, contact, pull) {
            let time = BOUNCE_SHARE * contact.duration;
            capped = capped.min(time.max(MIN_STEP));
            // Beyond the place where it leaves nothing would push, which two stages do not see.
            let leaving = contact.weights * contact.normal_velocity(points, V);
            let time = contact.depth / leaving;
            if leaving > 0.0 && time > MIN_STEP {
                capped = capped.min(time);
            }
        }
    }
    for term in &here.terms.joints {
        let v = from.v[term.dof];
        let time = term.gap[usize::from(v > 0.0)] / v.abs();
        if rules.touchdown && time < capped && time > CREEP * h {
            capped = time;
        }
    }
    capped
}

/// Accelerations of all bodies in the last step, if a contact has restitution: they tell whether it
/// still bounces.
///
/// - `trend`: accelerations of the degrees of freedom
pub(super) fn find_pull(ctx: &Context, here: &Point, trend: &Trend, pull: &mut [Vec6]) {
    if here.terms.contacts.iter().any(|c| c.bounce > 0.0) {
        forward(ctx.tree, &here.kin.S, &trend.whole, pull);
    }
}

/// Whether a contact with restitution still bounces. A body that has settled under its load, or
/// rolls on, keeps in touch without end; then nothing comes back that steps would have to resolve.
/// What swings on the contact's spring has the velocity `v` and the acceleration `v'`, and the
/// speed `√(v² + (T v')²)` on its way through the middle, where `T` is the time scale.
pub(super) fn still_bounces(here: &Point, contact: &Contact, pull: &[Vec6]) -> bool {
    contact.bounce > 0.0 && {
        let points = &here.terms.contacts.points;
        let speed = contact.normal_velocity(points, &here.kin.V);
        let change = contact.duration * contact.normal_velocity(points, pull);
        libm::hypot(speed, change) > BOUNCED
    }
}

/// Whether an implicit step of `h` seconds may reach beyond the communication point: inputs stay as
/// they are, nothing touches, and no term has a memory that would have to be read off in between,
/// too.
pub(super) fn may_look_ahead(ctx: &Context, here: &Point, state: &State, h: f64) -> bool {
    ctx.rules.look_ahead
        && !state.stepping.ahead.has_changed(ctx.tree)
        && here.terms.contacts.is_empty()
        && here.terms.joints.iter().all(|term| {
            // An impact on a limit is no polynomial.
            let speed = state.physical.v[term.dof].abs();
            let resting = term.gap[0].min(term.gap[1]) > 0.0
                || h * speed * ctx.tree.dofs.weight[term.dof] <= ctx.tolerance;
            resting && term.dry.cap <= 0.0 && !matches!(term.drive, Drive::Velocity { .. })
        })
        && is_clear(ctx.tree, &here.kin, h)
}

/// Whether a step of `h` seconds brings a joint to its limit or away from it, or deeper into it on
/// the way than at its ends: the polynomial that joins them knows nothing of the limit's spring.
///
/// - `q`, `v`: positions and velocities at its end
pub(super) fn meets_limit(
    ctx: &Context,
    here: &Point,
    from: &Physical,
    (q, v): (&[f64], &[f64]),
    h: f64,
) -> bool {
    let tree = ctx.tree;
    let weight = tree.moving_mass() * REFERENCE_GRAVITY;
    let allowed = CONTROLLED_GAIN * ctx.tolerance * weight * tree.reach();
    here.terms.joints.iter().any(|term| {
        let (place, dof) = (term.coordinate, term.dof);
        let ends = [from.q[place], q[place]];
        let moved = ends[1] - ends[0];
        let [low, high] = range(ends, [from.v[dof], v[dof]], h);
        let meets = |gap: f64, end: f64, least: f64| {
            let held = |gap: f64| gap.min(0.0) * gap.min(0.0);
            let more = held(least) - held(gap).max(held(end));
            (gap > 0.0) != (end > 0.0) || 0.5 * term.limit.stiffness * more > allowed
        };
        let [lower, upper] = term.gap;
        meets(lower, lower + moved, lower + low - ends[0])
            || meets(upper, upper - moved, upper + ends[0] - high)
    })
}

/// Least and greatest of the cubic with positions `q` and velocities `v` at its ends, `h` seconds
/// apart: a joint may reach its limit and turn back within a long step.
pub(super) fn range(q: [f64; 2], v: [f64; 2], h: f64) -> [f64; 2] {
    let (low, high) = (q[0].min(q[1]), q[0].max(q[1]));
    if v[0] * v[1] > 0.0 && (q[1] - q[0]) * v[0] > 0.0 {
        return [low, high];
    }
    // q(s) = q0 + a s + b s² + c s³ for s from 0 to 1; its slope is zero at the roots of
    // a + 2 b s + 3 c s².
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
