//! Where a circle about the axis of a cylinder meets uneven heights.
//!
//! A place of a circle that is deeper in the ground than those beside it is one where the normal
//! `n` of the ground has no part along the circle: the ground moves along `−n` against it, and the
//! depth changes as the row of a point with this normal says. Where the ground bends by much less
//! than the circle, as seen along its normal, there is one such place, and the normal leads to it,
//! see `rims` in `field.rs`. Elsewhere there may be several, and the normal leads away from
//! them: all are found by the signs of `n·t` around the circle, `t` along it.
//!
//! The place of the ground that is nearest to the middle of the circle is none of these where the
//! cylinder leans. While it was taken for one, the depth changed seven times more slowly than the
//! row of its point said, and a wheel that fell over on heights took steps down to the shortest.
//!
//! Two places join as the circle moves on, and the less deep one of them ends. So it has a share as
//! far as it is deeper than what is between it and a deeper one, see [`shares`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Round;
use super::placed::Placed;
use super::points::{Rim, Side};
use super::trace::Trace;
use crate::geometry::field::{Field, count};
use crate::spatial::Vec3;
use crate::tuning::{
    CROWN, HOLLOW_LOOKS, MOST_NEAREST, NEAREST_IN_HOLLOW, NEAREST_ON_FIELD, RING_FLAT, RING_LEAN,
    RING_ROUGH, ROUND_OFF,
};
use std::f64::consts::TAU;

/// Looks around a circle, but for more where cells are narrower: on each half as many as over the
/// width of a ball.
const LOOKS: usize = 2 * HOLLOW_LOOKS;

/// A place of a circle that is deeper than those beside it.
#[derive(Clone, Copy, Default)]
pub(super) struct Low {
    /// Normal of the ground.
    pub(super) n: Vec3,
    /// m
    pub(super) depth: f64,
    /// Where it is, m.
    pub(super) x: Vec3,
    pub(super) rim: Option<Rim>,
    /// How much of the share of a circle it has, 0 … 1.
    pub(super) part: f64,
}

/// Those of a circle.
#[derive(Default)]
pub(super) struct Lows {
    list: [Low; MOST_NEAREST],
    count: usize,
}

/// Where a circle is deeper in the ground than on either side.
#[derive(Clone, Copy, Default)]
struct Turn {
    angle: f64,
    /// How far the ground is above it there, m.
    over: f64,
    /// The least that the ground is above the circle from here to the next one, m.
    least_after: f64,
}

/// A place of a circle over the ground.
#[derive(Clone, Copy)]
struct Spot {
    angle: f64,
    /// Outwards from the middle.
    out: Vec3,
    x: Vec3,
    n: Vec3,
    /// Upwards, m.
    over: f64,
    /// How `over` changes along the circle, but for a factor.
    rise: f64,
}

/// A circle over heights.
struct Ring<'a> {
    field: &'a Field,
    center: Vec3,
    radius: f64,
    across: [Vec3; 2],
    /// Up to which depth the ground is looked at along its normal, m.
    blend: f64,
}

/// The tangent plane below a place: its normal, and how deep the place is in it; with the surface
/// continued where other terrain goes on beyond its end.
pub(super) fn below_or_beyond(field: &Field, x: &Vec3) -> Option<(Vec3, f64)> {
    field.below(x).or_else(|| {
        let on = field.goes_on([x.x, x.y]);
        on.then(|| field.below_or_end(x))?
    })
}

impl Lows {
    /// All such places of the circle at `s` of the axis, −1 … 1. None where the ground near it is
    /// so even that the normal leads to the only one.
    pub(super) fn find(
        shape: &Placed,
        round: &Round,
        s: f64,
        (field, reach): (&Field, f64),
    ) -> Option<Self> {
        let axis = shape.axis();
        let center = shape.p + axis * (s * round.half);
        let (middle, _) = field.below_or_end(&center)?;
        let lean = middle.cross(&axis).norm().max(RING_LEAN);
        if !field.bends_by(
            &center,
            round.radius + reach,
            RING_ROUGH * lean / round.radius,
        ) {
            return None;
        }
        let ring = Ring {
            field,
            center,
            radius: round.radius,
            across: [0, 1].map(|k| shape.R.column(k).into()),
            blend: shape.solid.blend,
        };
        let mut turns = [Turn::default(); MOST_NEAREST];
        let number = ring.turns(reach, &mut turns);
        let turns = &mut turns[..number];
        let mut lows = Self::default();
        let shares = shares(turns, shape.solid.blend);
        for (turn, part) in turns.iter().zip(shares) {
            let low = ring.at(turn.angle).and_then(|spot| {
                let trace = Trace::new(shape, round, &spot.n, Side::First);
                ring.low(&spot, trace.end(s), &middle)
            });
            if let Some(low) = low
                && part > 0.0
            {
                lows.list[lows.count] = Low { part, ..low };
                lows.count += 1;
            }
        }
        Some(lows)
    }

    pub(super) fn found(&self) -> &[Low] {
        &self.list[..self.count]
    }
}

/// What each of the highest turns, in their order around the circle, has of the share of a circle.
///
/// The highest has all of it, another one as much of it as it is above what is between it and a
/// higher one, in blends. Where two are as high as each other, they have the same: what both have
/// is divided evenly as far as they are nearer to each other than to what is between them.
fn shares(turns: &[Turn], blend: f64) -> [f64; MOST_NEAREST] {
    let mut shares = [0.0; MOST_NEAREST];
    let by_height = |a: &usize, b: &usize| turns[*a].over.total_cmp(&turns[*b].over);
    let Some(top) = (0..turns.len()).max_by(by_height) else {
        return shares;
    };
    shares[top] = 1.0;
    let number = turns.len();
    for i in (0..number).filter(|i| *i != top) {
        let is_higher = |k: usize| k == top || turns[k].over > turns[i].over;
        // What is lowest on the way to a higher one, forwards and backwards.
        let mut ways = [f64::INFINITY; 2];
        let mut k = i;
        while k == i || !is_higher(k) {
            ways[0] = ways[0].min(turns[k].least_after);
            k = (k + 1) % number;
        }
        k = i;
        while k == i || !is_higher(k) {
            k = (k + number - 1) % number;
            ways[1] = ways[1].min(turns[k].least_after);
        }
        let stands_out = turns[i].over - ways[0].max(ways[1]);
        if stands_out <= 0.0 {
            continue;
        }
        let own = (stands_out / blend).min(1.0);
        let alike = (1.0 - (turns[top].over - turns[i].over) / stands_out).max(0.0);
        let moved = 0.5 * (1.0 - own) * alike;
        shares[i] = own + moved;
        shares[top] = (shares[top] - moved).max(0.0);
    }
    shares
}

impl Ring<'_> {
    /// The tangent plane of the ground at the place nearest to `x`: its normal, and how deep `x` is
    /// in it, m. That of the place straight below or above is off by the square of the depth where
    /// the ground is steep and bends. What is above the ground by two blends and more has no part,
    /// and is looked at straight from above.
    fn under(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        let (mut n, mut depth) = below_or_beyond(self.field, x)?;
        // Each look multiplies what is left by the depth over the radius of the hill.
        for _ in 0..NEAREST_ON_FIELD {
            let least = -(2.0 * self.blend + depth).max(0.0);
            let along = depth.clamp(least, self.blend);
            if along == 0.0 {
                break;
            }
            let foot = x + n * along;
            let Some((next, left)) = below_or_beyond(self.field, &foot) else {
                break;
            };
            depth = next.dot(&(foot - x)) + left;
            let turned = (next - n).amax();
            n = next;
            if turned <= ROUND_OFF {
                break;
            }
        }
        Some((n, depth))
    }

    /// None beyond the end of the ground.
    fn at(&self, angle: f64) -> Option<Spot> {
        let (sin, cos) = libm::sincos(angle);
        let [a, b] = &self.across;
        let out = a * cos + b * sin;
        let x = self.center + out * self.radius;
        let (n, depth) = self.under(&x)?;
        Some(Spot {
            angle,
            out,
            x,
            n,
            over: depth / n.z,
            rise: n.dot(&(a * sin - b * cos)),
        })
    }

    /// Whether each of the looks around the circle, at angles of `step`, is above all ground near
    /// the circle by more than `−far` and a blend, so that it has no part. The heights of points at
    /// even angles follow from those of two: `h₊ = 2 cos(step) h − h₋`.
    fn are_far(&self, step: f64, far: f64) -> [bool; LOOKS] {
        let c = &self.center;
        // What round-off makes of the heights is far below a blend.
        let least = self.field.highest(c.x, c.y, self.radius) - far + self.blend - c.z;
        let (sin, cos) = libm::sincos(step);
        let [a, b] = self.across.map(|across| self.radius * across.z);
        let (mut before, mut height) = (a * cos - b * sin, a);
        let mut are_far = [false; LOOKS];
        for is_far in &mut are_far {
            *is_far = height >= least;
            (before, height) = (height, 2.0 * cos * height - before);
        }
        are_far
    }

    /// The highest turns in their order around the circle; returns how many there are.
    fn turns(&self, reach: f64, turns: &mut [Turn; MOST_NEAREST]) -> usize {
        let step = TAU / count(LOOKS);
        let width = self.radius * step;
        // As many looks between two as cells of the ground are beside each other there.
        let [dx, dy] = self.field.cell();
        let cells = 2.0 * width / dx.min(dy);
        let fine = (1..LOOKS).find(|n| count(*n) >= cells);
        let fine = fine.unwrap_or(LOOKS);
        let far = -(reach + width) / self.field.upright();
        let mut number = 0;
        // What is lowest before the first turn belongs behind the last.
        let mut first = f64::INFINITY;
        let mut note = |over: f64, turns: &mut [Turn; MOST_NEAREST], number: usize| {
            let least = match number {
                0 => &mut first,
                n => &mut turns[n - 1].least_after,
            };
            *least = least.min(over);
        };
        let are_far = self.are_far(step, far);
        let look = |k: usize| (!are_far[k % LOOKS]).then(|| self.at(step * count(k % LOOKS)));
        let start = look(0);
        let mut after = start;
        for k in 1..=LOOKS {
            let before = after;
            after = if k == LOOKS {
                start.map(|start| start.map(|spot| Spot { angle: TAU, ..spot }))
            } else {
                look(k)
            };
            if before.is_none() && after.is_none() {
                note(far, turns, number);
                continue;
            }
            let [mut last, next] = [(before, k - 1), (after, k)]
                .map(|(spot, k)| spot.unwrap_or_else(|| self.at(step * count(k))));
            let near = [&last, &next].map(|spot| spot.is_none_or(|spot| spot.over > far));
            let parts = if near == [false; 2] { 1 } else { fine };
            for part in 1..=parts {
                let then = if part == parts {
                    next
                } else {
                    self.at(step * (count(k - 1) + count(part) / count(parts)))
                };
                let before = std::mem::replace(&mut last, then);
                let (Some(a), Some(b)) = (before, then) else {
                    // Nothing is beyond the end of the ground.
                    note(f64::NEG_INFINITY, turns, number);
                    continue;
                };
                note(a.over, turns, number);
                // What is far above the ground between two looks has no part.
                let is_far = a.over.max(b.over) <= far;
                if is_far || (a.rise > 0.0) == (b.rise > 0.0) {
                    continue;
                }
                let Some(turn) = self.between(a, b) else {
                    continue;
                };
                if a.rise > 0.0 {
                    if number < MOST_NEAREST {
                        turns[number] = Turn {
                            angle: turn.angle,
                            over: turn.over,
                            least_after: f64::INFINITY,
                        };
                        number += 1;
                    }
                } else {
                    note(turn.over, turns, number);
                }
            }
        }
        if number > 0 {
            turns[number - 1].least_after = turns[number - 1].least_after.min(first);
        }
        number
    }

    /// Where the rise changes its sign between two places, by the Illinois method.
    fn between(&self, a: Spot, b: Spot) -> Option<Spot> {
        let (mut low, mut high) = ((a.angle, a.rise), (b.angle, b.rise));
        let (mut kept, mut here) = (0.0, a);
        for _ in 0..NEAREST_IN_HOLLOW {
            let angle = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
            here = self.at(angle)?;
            if here.rise.abs() <= ROUND_OFF || high.0 - low.0 <= ROUND_OFF {
                break;
            }
            if (here.rise > 0.0) == (low.1 > 0.0) {
                low = (angle, here.rise);
                high.1 *= if kept < 0.0 { 0.5 } else { 1.0 };
                kept = -1.0;
            } else {
                high = (angle, here.rise);
                low.1 *= if kept > 0.0 { 0.5 } else { 1.0 };
                kept = 1.0;
            }
        }
        Some(here)
    }

    /// The point at a place: what is lowest along the normal. A flat end nearly stands there where
    /// it leans against the normal by little; then the lowest point is in its midst on even ground
    /// and at the place itself on ground that is not.
    ///
    /// - `middle`: the normal below the middle of the circle
    fn low(&self, spot: &Spot, (x, rim): (Vec3, Option<Rim>), middle: &Vec3) -> Option<Low> {
        let mut rim = rim?;
        let lean = -spot.n.dot(&spot.out);
        let uneven = ((spot.n - middle).norm() / CROWN - 1.0).clamp(0.0, 1.0);
        let away = uneven * (2.0 - lean / RING_FLAT).clamp(0.0, 1.0);
        let mut x = x;
        if away > 0.0 {
            x += (spot.x + spot.n * rim.crown - x) * away;
            let up = rim.axis.dot(&spot.n);
            let turned = spot.out * (up.signum() * rim.radius * RING_FLAT);
            let turned = turned - spot.n * spot.n.dot(&turned);
            rim.a += (turned - rim.a) * away;
        }
        let (_, depth) = self.under(&x)?;
        Some(Low {
            n: spot.n,
            depth,
            x,
            rim: Some(rim),
            part: 1.0,
        })
    }
}
