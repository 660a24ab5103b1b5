//! The line on which a capsule or a cylinder comes nearest to a surface, and its rims.
//!
//! Seen along the normal `n`, every circle about the axis of a cylinder is lowest at one point, and
//! these are a line along the axis; a capsule has such a line, too. Against a face the gap is a
//! linear function on it, and the two ends of what lies over the face carry half each. Where the
//! line passes over several faces, each has the weight `(∫ (ℓ − t)₊ ds)⁴`, as in
//! `polygon.rs`.
//!
//! Each point of a cylinder's line is the lowest of a circle, whether of its rim or of a circle
//! between them, and follows the law of `force` for rims: with the axis `k`, the radius
//! `R`, `a = R (k − (k·n) n)` and the crown `s` it is `q − s` below the circle's centre, with
//! `q = √(|a|² + s²)`, and lies at `c + R (n·k) a/q` over it.

use super::core::Round;
use super::edges::ramp;
use super::mesh::{Bar, Mesh};
use super::nearest::Apart;
use super::placed::Placed;
use super::points::{PatchPoint, Points, Rim, Side, point};
use super::polygon::Limits;
use super::view::{Frame, Seen};
use crate::spatial::Vec3;
use crate::tuning::{CROWN, FACED};

/// Sine of 60°.
pub(super) const STANDING: f64 = 0.866;

/// The line of a solid along the normal of a frame, which points from what it lies on into it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trace {
    /// Middle of the axis, and half of it, m.
    center: Vec3,
    half: Vec3,
    /// From the axis to the line, m.
    low: Vec3,
    rim: Option<Rim>,
}

impl Trace {
    /// Of a solid that is a capsule or a cylinder.
    pub(super) fn new(placed: &Placed, round: &Round, n: &Vec3, side: Side) -> Self {
        let axis = placed.axis();
        let crown = CROWN * round.radius;
        let trace = Self {
            center: placed.p,
            half: axis * round.half,
            low: -n * round.radius,
            rim: round.flat.then(|| Rim {
                side,
                center: Vec3::zeros(),
                axis,
                a: Vec3::zeros(),
                // So that a lying cylinder, whose `q` is `√(R² + s²)`, reaches down by its own
                // radius.
                radius: (round.radius * (round.radius + 2.0 * crown)).sqrt(),
                crown,
            }),
        };
        trace.against(n)
    }

    /// The same of a cylinder along another direction, of any length; a capsule as it is.
    fn against(&self, direction: &Vec3) -> Self {
        let Some(rim) = self.rim else {
            return *self;
        };
        let n = direction.normalize();
        let up = n.dot(&rim.axis);
        let a = (rim.axis - n * up) * rim.radius;
        // Once more: over the crown, what is left along the normal counts.
        let a = a - n * n.dot(&a);
        let q = (a.norm_squared() + rim.crown * rim.crown).sqrt();
        Self {
            low: a * (rim.radius * up / q) - n * (q - rim.crown),
            rim: Some(Rim { a, ..rim }),
            ..*self
        }
    }

    /// The point at `s`, −1 … 1.
    fn at(&self, s: f64) -> Vec3 {
        self.center + self.half * s + self.low
    }

    /// The circle at `s`, with its axis outwards.
    fn rim(&self, s: f64) -> Option<Rim> {
        let out = if s < 0.0 { -1.0 } else { 1.0 };
        self.rim.map(|rim| Rim {
            center: self.center + self.half * s,
            axis: rim.axis * out,
            a: rim.a * out,
            ..rim
        })
    }

    /// The end at `s`, −1 or 1, and its circle.
    pub(super) fn end(&self, s: f64) -> (Vec3, Option<Rim>) {
        (self.at(s), self.rim(s))
    }

    /// Least height of its ends.
    pub(super) fn lowest(&self, n: &Vec3) -> f64 {
        n.dot(&self.at(1.0)).min(n.dot(&self.at(-1.0)))
    }

    /// Adds both ends against the plane `n·x = offset`.
    pub(super) fn on_plane(&self, n: &Vec3, offset: f64, reach: f64, points: &mut Points) {
        for s in [1.0, -1.0] {
            let (x, rim) = self.end(s);
            let depth = offset - n.dot(&x);
            if depth > -reach {
                points.add(
                    0,
                    PatchPoint {
                        rim,
                        ..point(x + n * (0.5 * depth), depth, 0.5)
                    },
                );
            }
        }
    }

    /// Adds the ends of what lies over each face of `lower`, with half of its weight each; returns
    /// how much of the contact it decides, see [`Limits::part`], by how far inside of a face its
    /// middle is, the mean by the weights; their sum, m⁸, and the least gap, m.
    ///
    /// Where a line that stands leaves a face, this is no end of a contact: the upper end counts
    /// fully up to 30° from lying, and no more from 60° on. And the rim of what stands is lowest
    /// against the face below it, whose normal may be another one than that of the contact: where
    /// an edge of one touches the face of the other, that is the normal of this face. Two cans that
    /// stand on each other askew touch with both edges by turns as they rock by microradians, which
    /// is a part of what the crown leans by. With the normal of the contact the place of the load
    /// jumped from the middle of an end to its rim each time, and they never came to rest.
    pub(super) fn cover(
        &self,
        (lower, mesh): (&Seen, &Mesh),
        frame: &Frame,
        limits: Limits,
        points: &mut Points,
    ) -> (f64, f64, f64) {
        let way = frame.see(&self.half);
        let length = self.half.norm().max(self.low.norm());
        let (mut sum, mut total, mut least) = (0.0, 0.0, f64::INFINITY);
        let up = (way.z / way.norm().max(f64::MIN_POSITIVE)).abs();
        let left = ((STANDING - up) / (STANDING - 0.5)).clamp(0.0, 1.0);
        let first = points.count();
        for g in lower.fronts() {
            let faces = (1.0 - left) * (1.0 - g.tilt / FACED).max(0.0);
            let trace = self.against(&frame.n.lerp(&g.normal(frame), faces));
            let middle = frame.see(&trace.at(0.0));
            let line = (&middle, &way);
            let (low, high, inside) = match lower.disc(g.index) {
                Some(disc) => disc.clip(g, line),
                None => clip(lower.outline(mesh, g.index), line),
            };
            if low >= high {
                continue;
            }
            let gap = |s: f64| {
                let x = middle + way * s;
                x.z - g.height(&x)
            };
            // `(ℓ − t)₊` at both ends, and its integral.
            let over = [low, high].map(|s| limits.level - gap(s));
            least = least.min(gap(low)).min(gap(high));
            let part = length * (high - low) * ramp(over);
            if part <= 0.0 {
                continue;
            }
            let weight = (part * part) * (part * part);
            sum += weight * limits.part(inside, gap(low).min(gap(high)));
            total += weight;
            for (s, is_high) in [(low, false), (high, true)] {
                let depth = -gap(s);
                let part = if is_high == (way.z > 0.0) { left } else { 1.0 };
                if depth > -limits.reach {
                    let x = trace.at(s) + frame.n * (0.5 * depth);
                    points.add(
                        first,
                        PatchPoint {
                            rim: trace.rim(s),
                            ..point(x, depth, 0.5 * part * weight)
                        },
                    );
                }
            }
        }
        let mean = if total > 0.0 { sum / total } else { 0.0 };
        (mean, total, least)
    }
}

/// Between which places, within −1 … 1, a line `(middle, way)` is over a convex outline, and how
/// far inside of it its middle there is, m, as seen.
fn clip(
    outline: impl Iterator<Item = Vec3> + Clone,
    (middle, way): (&Vec3, &Vec3),
) -> (f64, f64, f64) {
    let (mut low, mut high) = (-1.0_f64, 1.0_f64);
    let ends = outline.clone().cycle().skip(1);
    // Inside is where `inside + s rate ≥ 0`.
    let sides = outline.zip(ends).map(|(a, b)| {
        let (u, v) = (b - a, middle - a);
        let (inside, rate) = (u.x * v.y - u.y * v.x, u.x * way.y - u.y * way.x);
        (inside, rate, (u.x * u.x + u.y * u.y).sqrt())
    });
    for (inside, rate, _) in sides.clone() {
        if rate > 0.0 {
            low = low.max(-inside / rate);
        } else if rate < 0.0 {
            high = high.min(-inside / rate);
        } else if inside < 0.0 {
            high = f64::NEG_INFINITY;
        }
    }
    if low >= high {
        return (low, high, 0.0);
    }
    let half = 0.5 * (low + high);
    let depths = sides.map(|(inside, rate, width)| (inside + half * rate) / width);
    (low, high, depths.fold(f64::INFINITY, f64::min))
}

/// Adds what two round solids have in common along their axes, with shares that sum up to one.
///
/// Skew ones touch in one point. Parallel ones lie on each other between two ends, with half of the
/// load each. In between the shares of the ends fall from a half to nothing as these rise by the
/// blend `ε` above the nearest point: with `β = 1 − max(rise)/ε` the ends have `β/2`, the nearest
/// point `1 − β`. The same where they pass each other by less than the blend: by the length of that
/// over the blend.
pub(super) fn along_axes(
    (a, ra): (&Placed, &Round),
    (b, rb): (&Placed, &Round),
    apart: &Apart,
    reach: f64,
    points: &mut Points,
) {
    let n = apart.normal;
    let depth = a.solid.radius + b.solid.radius - apart.distance;
    let blend = a.solid.blend + b.solid.blend;
    let first = points.count();
    let mut take = |x: Vec3, depth: f64, share: f64| {
        if depth > -reach && share > 0.0 {
            points.add(first, point(x, depth, share));
        }
    };
    let mut beta = 0.0;
    if let Some(common) = Bar::axis(a, ra).common(&Bar::axis(b, rb), &n) {
        beta = common.part(depth, blend);
        for (x, depth) in common.ends {
            take(x, depth, 0.5 * beta);
        }
    }
    take(apart.middle, depth, 1.0 - beta);
}
