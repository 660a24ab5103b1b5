//! Which rules apply to a pair of shapes, and the transitions between them.

use super::core::{Core, Round};
use super::edges::along_edges;
use super::flush;
use super::nearest::{Apart, nearest};
use super::placed::{Placed, separation};
use super::points::{Points, Side, point};
use super::polygon::{Asked, Cover, Limits, Polygons, cover};
use super::share::share;
use super::shut::Among;
use super::trace::{Trace, along_axes};
use super::view::{Frame, Seen};
use crate::spatial::Vec3;

/// How many times the part of a flat end that is cut off counts.
const CUT: f64 = 4.0;
/// Share of the blends from which on what lies over a face decides alone, as wide as that or as far
/// inside. Any real contact of faces has dozens of times it.
const LEAST: f64 = 0.06;

/// Memory of a query.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    upper: Seen,
    lower: Seen,
    work: Polygons,
    /// Whether walls that nothing can come between had a part in the last query.
    pub(super) flush: bool,
    /// Up to which gap places counted in it, m.
    level: f64,
}

impl Default for Meeting {
    fn default() -> Self {
        Self {
            upper: Seen::new(),
            lower: Seen::new(),
            work: Polygons::NONE,
            flush: false,
            level: 0.0,
        }
    }
}

/// How two shapes lie to each other, the gap between their rounded surfaces, and by how much sharp
/// corners may be nearer than these, m; only roughly where that is farther than `reach`.
fn gap(a: &Placed, b: &Placed, reach: f64) -> (Apart, f64, f64) {
    let sharp = a.solid.sharp + b.solid.sharp;
    let radii = a.solid.radius + b.solid.radius;
    let apart = nearest(a, b, reach + sharp + radii);
    (apart, apart.distance - radii, sharp)
}

impl Meeting {
    /// Whether a pair, in the order of their rank, is nearer than `reach`, m; corners count as
    /// sharp. Terrain is near everything.
    pub(super) fn are_near(a: &Placed, b: &Placed, reach: f64) -> bool {
        if b.solid.is_terrain() {
            return true;
        }
        let (_, gap, sharp) = gap(a, b, reach);
        gap <= reach + sharp
    }

    /// Adds the points of a pair, in the order of their rank; returns the normal, whether inner
    /// cores have a part in it, and whether these meet.
    pub(super) fn find(
        &mut self,
        pair: (&Placed, &Placed),
        others: Option<&Among>,
        reaches: [f64; 2],
        points: &mut Points,
    ) -> (Vec3, bool, bool) {
        self.find_along((pair, others), reaches, |apart| Some(apart.normal), points)
    }

    /// The same, of a pair that acts only with some normals: no points with others.
    ///
    /// - `along`: with which normal the pair acts where it lies so, if it does
    /// - `others`: what stands beside both
    /// - `near`, `reach`: how near the shapes and, once they are, their points have to be, m
    pub(super) fn find_along(
        &mut self,
        ((a, b), others): ((&Placed, &Placed), Option<&Among>),
        [near, reach]: [f64; 2],
        along: impl Fn(&Apart) -> Option<Vec3>,
        points: &mut Points,
    ) -> (Vec3, bool, bool) {
        if b.solid.is_terrain() {
            let n = b.axis();
            if !a.solid.is_terrain() {
                on_plane(a, &n, n.dot(&b.p), reach, points);
            }
            return (n, false, false);
        }
        self.flush = false;
        let (mut apart, mut gap, sharp) = gap(a, b, near);
        let acts = (gap <= near + sharp).then(|| along(&apart)).flatten();
        let Some(normal) = acts else {
            return (apart.normal, apart.part < 1.0, apart.deep);
        };
        if normal != apart.normal {
            let distance = separation(a, b, &normal);
            gap += distance - apart.distance;
            (apart.normal, apart.distance) = (normal, distance);
        }
        let kept = flush::between((a, b), &apart.normal, &apart, others);
        self.flush = kept.is_some();
        if let Some(kept) = &kept {
            apart.normal = if kept.first {
                -kept.outward
            } else {
                kept.outward
            };
            gap += kept.distance - apart.distance;
        }
        let n = apart.normal;
        let blend = a.solid.blend + b.solid.blend;
        let mut limits = Limits {
            level: gap + blend,
            blend,
            wide: 2.0 * LEAST * a.solid.blend.min(b.solid.blend),
            reach,
            asked: Asked::All,
        };
        let faces = |p: &Placed| p.solid.round.is_none() && !p.solid.mesh.normals.is_empty();
        let blended = apart.part < 1.0;
        if blended && faces(b) {
            // Along a direction between two, the farthest points need not lie over each other. What
            // lies below a level is all that is looked at: it rises until there is something.
            let most = a.solid.reach + b.solid.reach;
            let (mut rise, mut least) = (0.5 * blend, f64::INFINITY);
            while least > gap + rise && rise < 8.0 * most {
                rise *= 8.0;
                let all = Limits {
                    level: gap + rise,
                    asked: Asked::Least,
                    ..limits
                };
                least = self.least((a, b), (&n, all), points);
            }
            points.clear();
            if least.is_finite() {
                let part = (1.0 - 4.0 * (1.0 - apart.part)).max(0.0);
                limits.level = part * gap + (1.0 - part) * least + blend;
            }
        }
        self.level = limits.level;
        let mut left = 1.0;
        match (a.solid.round, b.solid.round) {
            (Some(round), Some(other)) => {
                self.two_round((a, &round), (b, &other), &apart, limits, points);
                left = 0.0;
            }
            (Some(round), None) if faces(b) => {
                left -= self.round_on_faces((a, &round), b, (&n, limits), points);
            }
            (None, None) if faces(a) && faces(b) => {
                limits.asked = Asked::Points;
                let all = self.cover((a, b), (&n, limits), points);
                points.scale(0, per(all.part, all.weight));
                left -= all.part;
            }
            _ => {}
        }
        if let Some(kept) = kept {
            if left > 0.0 && gap <= near {
                flush::lowest(((a, b), others), &kept, (gap, left), blend, points);
            }
            return (n, blended, apart.deep);
        }
        if left > 0.0 && gap <= reach && faces(b) && (a.solid.round.is_some() || faces(a)) {
            let first = points.count();
            let along = along_edges((a, b), &apart, limits, points);
            points.scale(first, left);
            left *= 1.0 - along;
        }
        // Of the nearest points is what nothing else has.
        if left > 0.0 && gap <= reach {
            points.add(0, point(apart.middle, -gap, left));
        }
        (n, blended, apart.deep)
    }

    /// Share of the spring of a contact that the last query has found, see `share.rs`.
    ///
    /// - `pair`: what yields, and what carries it
    /// - `n`: unit vector from that to this
    pub(super) fn share(&mut self, pair: [&Placed; 2], n: &Vec3, others: &Among) -> f64 {
        let Self {
            upper, lower, work, ..
        } = self;
        share(pair, n, self.level, others, ([upper, lower], work))
    }

    /// What the faces of both have in common.
    fn cover(
        &mut self,
        (a, b): (&Placed, &Placed),
        (n, limits): (&Vec3, Limits),
        points: &mut Points,
    ) -> Cover {
        let frame = Frame::new(*n);
        let Self {
            upper, lower, work, ..
        } = self;
        upper.look(a, &frame);
        lower.look(b, &frame);
        upper.face(a, &frame, -1.0, lower.heights.1 + limits.level);
        lower.face(b, &frame, 1.0, upper.heights.0 - limits.level);
        let pair = ((&*upper, &a.solid.mesh), (&*lower, &b.solid.mesh));
        let mut all = cover(pair.0, pair.1, &frame, limits, work, points);
        if self.flush && all.weight > 0.0 {
            // However little of a face is over one side of a joint, it lies there as it does on the
            // other side.
            all.part = 1.0;
        }
        all
    }

    /// How high the lowest of `a` that lies over faces of `b` is above these, m.
    fn least(
        &mut self,
        (a, b): (&Placed, &Placed),
        (n, all): (&Vec3, Limits),
        points: &mut Points,
    ) -> f64 {
        let least = self.cover((a, b), (n, all), points).least;
        let Some(round) = a.solid.round else {
            return least;
        };
        let on = self.line((a, &round), b, (n, all, Side::First), points).2;
        if on.is_finite() {
            // An end that is seen from its side is a sliver, which is over a face or not by
            // round-off (`the_depth_of_a_thin_wheel_on_an_edge_has_a_slope`).
            on + (on.min(least) - on) * facing(a, n)
        } else {
            least
        }
    }

    /// What the line of `a` has in common with the faces of `b`.
    fn line(
        &mut self,
        (a, round): (&Placed, &Round),
        b: &Placed,
        (n, limits, side): (&Vec3, Limits, Side),
        points: &mut Points,
    ) -> (f64, f64, f64) {
        let trace = Trace::new(a, round, n, side);
        let frame = Frame::new(*n);
        let lower = &mut self.lower;
        lower.look(b, &frame);
        lower.face(b, &frame, 1.0, trace.lowest(n) - limits.level);
        lower.round(b.solid.radius);
        trace.cover((lower, &b.solid.mesh), &frame, limits, points)
    }

    /// A capsule or a cylinder on a polyhedron; returns the shares of all points together, 0 … 1.
    fn round_on_faces(
        &mut self,
        (a, round): (&Placed, &Round),
        b: &Placed,
        (n, limits): (&Vec3, Limits),
        points: &mut Points,
    ) -> f64 {
        let mut all = Cover::default();
        if round.flat {
            all = self.cover((a, b), (n, limits), points);
        }
        let first = points.count();
        let (part, weight, _) = self.line((a, round), b, (n, limits, Side::First), points);
        let there = part * (1.0 - cut_off(a, n, &all));
        // What the line does not have, the end has, as far as it takes part.
        let other = all.part * (1.0 - there);
        points.scale_range(0, first, per(other, all.weight));
        points.scale_range(first, points.count(), per(there, weight));
        points.drop_empty();
        there + other
    }

    /// Two capsules or cylinders.
    fn two_round(
        &mut self,
        (a, ra): (&Placed, &Round),
        (b, rb): (&Placed, &Round),
        apart: &Apart,
        limits: Limits,
        points: &mut Points,
    ) {
        let n = apart.normal;
        let (mut cut_a, mut cut_b, mut all) = (0.0, 0.0, Cover::default());
        if ra.flat && rb.flat {
            // How much of each end the other cuts off: once from each side, with what each would
            // cover of the plane of the other.
            let back = self.cover((b, a), (&-n, limits), points);
            points.scale(0, 0.0);
            all = self.cover((a, b), (&n, limits), points);
            (cut_a, cut_b) = (cut_off(a, &n, &all), cut_off(b, &n, &back));
        }
        let ends = points.count();
        let mut lie = |(p, round): (&Placed, &Round), q: &Placed, n: &Vec3, side, cut: f64| {
            let first = points.count();
            let (part, weight, _) = self.line((p, round), q, (n, limits, side), points);
            let share = part * (1.0 - cut);
            points.scale(first, per(share, weight));
            share
        };
        let (mut line_a, mut line_b) = (0.0, 0.0);
        if rb.flat {
            line_a = lie((a, ra), b, &n, Side::First, cut_a);
        }
        if ra.flat {
            line_b = lie((b, rb), a, &-n, Side::Second, cut_b);
        }
        // What neither line has, the ends have, as far as they face each other.
        let share = all.part * (facing(a, &n) * facing(b, &n)) * ((1.0 - line_a) * (1.0 - line_b));
        points.scale_range(0, ends, per(share, all.weight));
        points.drop_empty();
        let taken = share + line_a + line_b;
        if taken < 1.0 {
            let first = points.count();
            along_axes((a, ra), (b, rb), apart, limits.reach, points);
            points.scale(first, 1.0 - taken);
        } else {
            points.scale(0, 1.0 / taken);
        }
    }
}

/// By what points with the sum `weight` are multiplied, so that they have `share` of a contact.
fn per(share: f64, weight: f64) -> f64 {
    if share > 0.0 { share / weight } else { 0.0 }
}

/// How far a polygon takes over from the law of a rim: where the end of the cylinder `p` faces the
/// other shape and has something cut off within the blend of the deepest place. An end that leans
/// is round.
fn cut_off(p: &Placed, n: &Vec3, all: &Cover) -> f64 {
    facing(p, n) * all.part * (CUT * all.cut).min(1.0)
}

/// How much an end of the cylinder `p` faces along `n`, 0 … 1.
fn facing(p: &Placed, n: &Vec3) -> f64 {
    let cosine = p.axis().dot(n);
    let squared = cosine * cosine;
    squared * squared
}

/// The points of a shape on the plane `n·x = offset`.
fn on_plane(a: &Placed, n: &Vec3, offset: f64, reach: f64, points: &mut Points) {
    if n.dot(&a.p) - offset > a.solid.reach + reach {
        return;
    }
    if let Some(round) = &a.solid.round {
        Trace::new(a, round, n, Side::First).on_plane(n, offset, reach, points);
        return;
    }
    // The share of a corner of a hull takes much longer to find than its depth.
    let mut take = |x: Vec3, share: &dyn Fn() -> f64| {
        let depth = offset - n.dot(&x);
        if depth > -reach {
            points.add(0, point(x + n * (0.5 * depth), depth, share()));
        }
    };
    match &a.solid.core {
        Core::Point => take(a.p - n * a.solid.radius, &|| 1.0),
        Core::Box { .. } => {
            for corner in &a.solid.mesh.corners {
                take(a.p + a.R * corner, &|| 0.25);
            }
        }
        _ => {
            let down = a.R.tr_mul(&-n);
            for (i, corner) in a.solid.mesh.corners.iter().enumerate() {
                take(a.p + a.R * corner, &|| a.solid.shares.share(i, &down));
            }
        }
    }
}
