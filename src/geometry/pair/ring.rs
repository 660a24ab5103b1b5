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
//!
//! Around the circle the ground is looked at straight below and above it, as its height over the
//! circle is a smooth function of the angle whose slope a look gives, too. Where that is highest
//! the deepest place is looked for along the normal, from there on: both are the same place where
//! the circle touches, and are off each other by the depth times the bend of the ground where it
//! does not. Arcs that are higher than all ground below them by so much that they have no part are
//! not looked at.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod turns;

use self::turns::{Turn, Turns, between, shares};
use super::core::Round;
use super::placed::Placed;
use super::points::{Rim, Side};
use super::trace::Trace;
use crate::geometry::field::{Field, Local, count, normal};
use crate::spatial::Vec3;
use crate::tuning::{
    CROWN, HOLLOW_LOOKS, MOST_NEAREST, NEAREST_ON_FIELD, RING_FLAT, RING_LEAN, RING_ROUGH,
    ROUND_OFF,
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

/// A place of a circle and the ground straight below or above it.
#[derive(Clone, Copy)]
struct Look {
    angle: f64,
    /// How far the ground is above the circle, m.
    over: f64,
    /// How `over` changes along the circle, m/m.
    rise: f64,
}

/// A place of a circle and the ground along its normal.
struct Spot {
    /// Outwards from the middle.
    out: Vec3,
    x: Vec3,
    n: Vec3,
    /// How the depth changes along the circle, m/m.
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

/// The surface straight below or above a place: its height, m, and its slopes along x and y; with
/// the surface continued where other terrain goes on beyond its end.
fn height_or_beyond(field: &Field, x: &Vec3) -> Option<(f64, [f64; 2])> {
    field.slopes(x.x, x.y).or_else(|| {
        if !field.goes_on([x.x, x.y]) {
            return None;
        }
        let [a, b] = field.within([x.x, x.y]);
        let (height, [dx, dy]) = field.slopes(a, b)?;
        Some((height + dx * (x.x - a) + dy * (x.y - b), [dx, dy]))
    })
}

/// The tangent plane there: its normal, and how deep the place is in it, m.
pub(super) fn below_or_beyond(field: &Field, x: &Vec3) -> Option<(Vec3, f64)> {
    let (height, slope) = height_or_beyond(field, x)?;
    let n = normal(slope);
    Some((n, (height - x.z) * n.z))
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
        // The least of `over` that matters: where it is below `reach` nothing touches, and a blend
        // below that it changes no share either.
        let far = -(reach / field.upright() + ring.blend);
        let mut turns = ring.turns(far);
        let turns = turns.close();
        let mut lows = Self::default();
        let shares = shares(turns, ring.blend);
        for (turn, part) in turns.iter().zip(shares) {
            if part <= 0.0 || turn.over <= far {
                continue;
            }
            let low = ring.settle(turn).and_then(|spot| {
                let trace = Trace::new(shape, round, &spot.n, Side::First);
                ring.low(&spot, trace.end(s), &middle)
            });
            if let Some(low) = low {
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

impl Ring<'_> {
    /// The place at an angle, and the directions outwards and along the circle there.
    fn place(&self, angle: f64) -> (Vec3, [Vec3; 2]) {
        let (sin, cos) = libm::sincos(angle);
        let [a, b] = &self.across;
        let out = a * cos + b * sin;
        (self.center + out * self.radius, [out, b * cos - a * sin])
    }

    /// The ground straight below or above an angle. None beyond the end of the ground.
    fn look(&self, angle: f64) -> Option<Look> {
        let (x, [_, along]) = self.place(angle);
        let (height, [dx, dy]) = height_or_beyond(self.field, &x)?;
        Some(Look {
            angle,
            over: height - x.z,
            rise: dx * along.x + dy * along.y - along.z,
        })
    }

    /// The tangent plane of the ground at the place nearest to `x`: its normal, and how deep `x` is
    /// in it, m. That of the place straight below or above is off by the square of the depth where
    /// the ground is steep and bends. What is above the ground by two blends and more has no part,
    /// and is looked at straight from above.
    fn under(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        let (mut n, mut depth) = below_or_beyond(self.field, x)?;
        // Each look multiplies what is left by the depth over the radius of the hill. By how much
        // the next one would turn the normal follows from the last two.
        let mut before = 0.0;
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
            if turned * turned <= ROUND_OFF * turned.max(before) {
                break;
            }
            before = turned;
        }
        Some((n, depth))
    }

    /// The ground along its normal at an angle.
    fn spot(&self, angle: f64) -> Option<Spot> {
        let (x, [out, along]) = self.place(angle);
        let (n, _) = self.under(&x)?;
        let rise = -n.dot(&along);
        Some(Spot { out, x, n, rise })
    }

    /// On which arcs of the angle `step` the ground may be above the circle by more than `far`, m;
    /// on the others it certainly is not. Points at even angles follow from two of them:
    /// `p₊ = 2 cos(step) p − p₋`.
    fn near(&self, step: f64, far: f64) -> [bool; LOOKS] {
        let c = &self.center;
        let (sin, cos) = libm::sincos(step);
        let [a, b] = self.across.map(|across| across * self.radius);
        // What a circle goes beyond its chords by.
        let bow = self.radius * (1.0 - libm::cos(0.5 * step));
        let least = self.field.highest(c.x, c.y, self.radius + bow) - far - c.z + bow;
        let (mut before, mut first) = (a * cos - b * sin, a);
        let mut near = [false; LOOKS];
        for near in &mut near {
            let last = first * (2.0 * cos) - before;
            let low = first.z.min(last.z);
            *near = low < least && {
                let middle = c + (first + last) * 0.5;
                let chord = last - first;
                let around = 0.5 * chord.x.abs().max(chord.y.abs()) + bow;
                // Beyond a seam the ground goes on as its end does.
                let beyond = || self.field.has_seams() && !self.field.covers(&middle, around);
                let top = self.field.highest(middle.x, middle.y, around);
                low + c.z < top - far + bow || beyond()
            };
            (before, first) = (first, last);
        }
        near
    }

    /// The turns around the circle.
    ///
    /// - `far`: the least of `over` that matters, m
    fn turns(&self, far: f64) -> Turns {
        let step = TAU / count(LOOKS);
        // As many looks between two as cells of the ground are beside each other there.
        let [dx, dy] = self.field.cell();
        let cells = 2.0 * self.radius * step / dx.min(dy);
        let parts = (1..LOOKS).find(|n| count(*n) >= cells).unwrap_or(LOOKS);
        let near = self.near(step, far);
        let mut found = Turns::new();
        let mut last = None;
        for (k, near) in near.into_iter().enumerate() {
            if !near {
                found.pass(far);
                last = None;
                continue;
            }
            let mut before = last.unwrap_or_else(|| self.look(step * count(k)));
            for part in 1..=parts {
                let after = if k + 1 == LOOKS && part == parts {
                    // To the last bit where the circle begins: no sign is missed there.
                    self.look(0.0).map(|look| Look { angle: TAU, ..look })
                } else {
                    self.look(step * (count(k) + count(part) / count(parts)))
                };
                if let (Some(a), Some(b)) = (before, after) {
                    found.pass(a.over);
                    self.turn(a, b, &mut found);
                } else {
                    // Nothing is beyond the end of the ground.
                    found.pass(f64::NEG_INFINITY);
                }
                before = after;
            }
            last = Some(before);
        }
        found
    }

    /// Adds what is highest or lowest between two places.
    fn turn(&self, a: Look, b: Look, found: &mut Turns) {
        if (a.rise > 0.0) == (b.rise > 0.0) {
            return;
        }
        // The square of the rise is what the height is off by, but for a factor.
        let ends = [a, b].map(|look| (look.angle, look.rise));
        let at = |angle| self.look(angle).map(|look| (look.rise, look));
        let Some(Look { angle, over, .. }) = between(ends, ROUND_OFF.sqrt(), at) else {
            return;
        };
        if a.rise > 0.0 {
            found.add(Turn {
                angle,
                between: b.angle - a.angle,
                over,
                least_after: f64::INFINITY,
            });
        } else {
            found.pass(over);
        }
    }

    /// How the rise changes at an angle, 1/rad: the direction along the circle turns inwards there.
    fn bend(&self, angle: f64) -> Option<f64> {
        let (x, [out, along]) = self.place(angle);
        let [a, b] = self.field.within([x.x, x.y]);
        let Local { slope, bend, .. } = self.field.at(a, b)?;
        let across = bend[0] * along.x * along.x
            + 2.0 * bend[1] * along.x * along.y
            + bend[2] * along.y * along.y;
        Some(self.radius * across - (slope[0] * out.x + slope[1] * out.y - out.z))
    }

    /// The deepest place near a turn. Newton's step from there tells about where; where twice as
    /// far is not beyond it, four times as far, and so on, but not farther than the next look.
    fn settle(&self, turn: &Turn) -> Option<Spot> {
        let mut spot = self.spot(turn.angle)?;
        if spot.rise.abs() <= ROUND_OFF {
            return Some(spot);
        }
        let bend = self.bend(turn.angle)? * spot.n.z;
        let way = if bend < 0.0 {
            -spot.rise / bend
        } else {
            spot.rise.signum() * turn.between
        };
        let (mut far, mut last) = (2.0 * way, (turn.angle, spot.rise));
        loop {
            far = far.clamp(-turn.between, turn.between);
            let angle = turn.angle + far;
            let found = self.spot(angle)?;
            let here = (angle, found.rise);
            if (found.rise > 0.0) != (last.1 > 0.0) {
                let at = |angle| self.spot(angle).map(|spot| (spot.rise, spot));
                return between([last, here], ROUND_OFF, at);
            }
            if far.abs() >= turn.between {
                return Some(spot);
            }
            (spot, last, far) = (found, here, 2.0 * far);
        }
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
