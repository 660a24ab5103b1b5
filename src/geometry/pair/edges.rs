//! What lies along an edge.
//!
//! Of two lines that are parallel, all places are equally near, and by a tilt of a microradian the
//! nearest one is at the one end or at the other. So they lie on each other between two ends, as
//! parallel capsules do (`along_axes` in `trace.rs`): here an edge of a polyhedron, rounded as its
//! core is, and the axis of something round or an edge of another one.
//!
//! With the nearest point alone, a can along an edge of a finger rocked by a microradian, and its
//! load went to and fro by centimetres in each of a hundred steps: it never came to rest.

use super::core::Round;
use super::mesh::Bar;
use super::nearest::Apart;
use super::placed::Placed;
use super::points::{Points, point};
use super::polygon::Limits;
use crate::spatial::Vec3;

/// What two bars have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Common {
    /// How parallel they are: 1 where they are, 0 from 60° on.
    pub(super) parallel: f64,
    /// How long it is, m.
    pub(super) length: f64,
    /// Its two ends: places half way, and depths, m.
    pub(super) ends: [(Vec3, f64); 2],
}

impl Bar {
    /// The whole of a capsule, or a cylinder as if it were one.
    pub(super) fn axis(placed: &Placed, round: &Round) -> Self {
        Self {
            middle: placed.p,
            along: placed.axis(),
            half: round.half,
            radius: round.radius,
        }
    }

    /// Of a shape where it stands.
    fn of(&self, placed: &Placed) -> Self {
        Self {
            middle: placed.world(&self.middle),
            along: placed.R * self.along,
            ..*self
        }
    }

    /// What it has in common with another one, in the direction `n` from that to it.
    pub(super) fn common(&self, other: &Self, n: &Vec3) -> Option<Common> {
        let cosine = self.along.dot(&other.along);
        let k = if cosine < 0.0 {
            -other.along
        } else {
            other.along
        };
        let parallel = self.parallel(&other.along)?;
        let along = (self.along + k).normalize();
        let range = |p: &Vec3, k: &Vec3, half: f64| {
            let (middle, half) = (along.dot(p), along.dot(k) * half);
            (middle - half, middle + half)
        };
        let u = range(&self.middle, &self.along, self.half);
        let v = range(&other.middle, &k, other.half);
        let (low, high) = (u.0.max(v.0), u.1.min(v.1));
        (low < high).then(|| Common {
            parallel,
            length: high - low,
            ends: [low, high].map(|c| {
                let on = |p: &Vec3, k: &Vec3| p + k * ((c - along.dot(p)) / along.dot(k));
                let (x, y) = (on(&self.middle, &self.along), on(&other.middle, &k));
                let middle = ((x - n * self.radius) + (y + n * other.radius)) * 0.5;
                (middle, self.radius + other.radius - (x - y).norm())
            }),
        })
    }
}

impl Common {
    /// What part of a contact its ends have whose nearest point is `depth` deep: less as they rise
    /// above it, and where they are near each other.
    pub(super) fn part(&self, depth: f64, blend: f64) -> f64 {
        let [a, b] = self.ends.map(|(_, end)| (depth - end).abs());
        let long = (self.length / blend).clamp(0.0, 1.0);
        self.parallel * long * (1.0 - a.max(b) / blend).max(0.0)
    }
}

/// The edges of a polyhedron that reach up to `level` along `n`, in its own axes, in which most
/// edges are left out.
fn reaching<'a>(placed: &'a Placed, n: &Vec3, level: f64) -> impl Iterator<Item = &'a Bar> {
    let (up, level) = (placed.R.tr_mul(n), level - n.dot(&placed.p));
    placed
        .solid
        .bars
        .iter()
        .filter(move |bar| bar.height(&up) >= level)
}

/// Adds the ends of what lies along edges of `b`, the axis or the edges of `a`; returns how much of
/// the contact they have, see [`Common::part`], the mean by the weights `(∫ (ℓ − t)₊ ds)⁴` as of
/// faces. Shares sum up to that.
pub(super) fn along_edges(
    (a, b): (&Placed, &Placed),
    apart: &Apart,
    limits: Limits,
    points: &mut Points,
) -> f64 {
    let n = apart.normal;
    let depth = a.solid.radius + b.solid.radius - apart.distance;
    let first = points.count();
    // What is farther from the line of an edge than this has no weight. Everything within `reach`
    // of a place is at least as far as that place, less `reach`.
    let near = limits.level + a.solid.radius + b.solid.radius;
    let meets = |edge: &Bar, place: &Vec3, reach: f64| {
        edge.across(&b.R.tr_mul(&(place - b.p))) <= (near + reach) * (near + reach)
    };
    if !b.solid.bars.iter().any(|e| meets(e, &a.p, a.solid.reach)) {
        return 0.0;
    }
    let (mut sum, mut total) = (0.0, 0.0);
    let level = n.dot(&b.support(&n)) - limits.blend;
    let mut take = |bar: &Bar| {
        let along = b.R.tr_mul(&bar.along);
        for edge in reaching(b, &n, level) {
            if edge.parallel(&along).is_none() || !meets(edge, &bar.middle, bar.half) {
                continue;
            }
            let Some(common) = bar.common(&edge.of(b), &n) else {
                continue;
            };
            let over = common.ends.map(|(_, depth)| limits.level + depth);
            let area = common.length * ramp(over);
            let weight = (area * area) * (area * area);
            let share = weight * common.part(depth, limits.blend);
            total += weight;
            sum += share;
            if share <= 0.0 {
                continue;
            }
            for (x, end) in common.ends {
                // The end of a cylinder that leans is lower than that of a capsule.
                let end = end.min(depth);
                if end > -limits.reach {
                    points.add(first, point(x, end, 0.5 * share));
                }
            }
        }
    };
    if let Some(round) = &a.solid.round {
        take(&Bar::axis(a, round));
    } else {
        let down = -n;
        let level = down.dot(&a.support(&down)) - limits.blend;
        for bar in reaching(a, &down, level) {
            take(&bar.of(a));
        }
    }
    if total <= 0.0 {
        return 0.0;
    }
    // Where inner cores have a part in the direction, what is nearest is not along an edge.
    points.scale(first, apart.part / total);
    apart.part * sum / total
}

/// Mean of `x₊` where `x` goes evenly from `a` to `b`.
pub(super) fn ramp([a, b]: [f64; 2]) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    if high <= 0.0 {
        0.0
    } else if low >= 0.0 {
        0.5 * (low + high)
    } else {
        0.5 * high * high / (high - low)
    }
}
