//! Which rules a pair of shapes follows, and how they take over from each other.

use super::core::{Core, Placed, Round};
use super::nearest::{Apart, nearest};
use super::points::{PatchPoint, Points, Side};
use super::polygon::{Cover, Limits, Polygons, cover};
use super::trace::{Trace, along_axes};
use super::view::{Frame, Seen};
use crate::spatial::Vec3;

/// How many times the part of a flat end that is cut off counts.
const CUT: f64 = 4.0;
/// Share of the square, or of the cube, of the blend from which on an area below the level, or what
/// is between it and the level, decides alone. Any real contact of faces has hundreds of times it.
const LEAST: f64 = 0.125;

/// Memory of a query.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    seen: [Seen; 2],
    work: Polygons,
}

impl Default for Meeting {
    fn default() -> Self {
        Self {
            seen: [Seen::NONE, Seen::NONE],
            work: Polygons::NONE,
        }
    }
}

impl Meeting {
    /// Adds the points of a pair, in the order of their rank; returns normal and whether the cores
    /// meet.
    pub(super) fn find(
        &mut self,
        (a, b): (&Placed, &Placed),
        reach: f64,
        points: &mut Points,
    ) -> (Vec3, bool) {
        if matches!(b.solid.core, Core::HalfSpace) {
            let n = b.axis();
            if !matches!(a.solid.core, Core::HalfSpace) {
                on_plane(a, &n, n.dot(&b.p), reach, points);
            }
            return (n, false);
        }
        let apart = nearest(a, b);
        let n = apart.normal;
        let gap = apart.distance - a.solid.radius - b.solid.radius;
        // Sharp corners are nearer than rounded ones.
        let sharp = a.solid.rounding() + b.solid.rounding();
        if gap > reach + sharp {
            return (n, apart.deep);
        }
        let limits = Limits {
            level: gap + a.solid.blend + b.solid.blend,
            reach,
        };
        let faces = |p: &Placed| p.solid.round.is_none() && !p.solid.mesh.normals.is_empty();
        match (a.solid.round, b.solid.round) {
            (Some(round), Some(other)) => {
                self.two_round((a, &round), (b, &other), &apart, limits, points);
            }
            (Some(round), None) if faces(b) => {
                self.round_on_faces((a, &round), b, (&n, limits), points);
            }
            (None, None) if faces(a) && faces(b) => {
                let all = self.cover((a, b), (&n, limits), points);
                let by = if all.weight > 0.0 {
                    1.0 / all.weight
                } else {
                    0.0
                };
                points.scale(0, by);
            }
            _ => {}
        }
        if points.count() == 0 && gap <= reach {
            let x = apart.at - n * (a.solid.radius + 0.5 * gap);
            points.add(0, point(x, -gap, 1.0));
        }
        (n, apart.deep)
    }

    /// What the faces of both have in common.
    fn cover(
        &mut self,
        (a, b): (&Placed, &Placed),
        (n, limits): (&Vec3, Limits),
        points: &mut Points,
    ) -> Cover {
        let frame = Frame::new(*n);
        let [upper, lower] = &mut self.seen;
        upper.look(a, &frame);
        lower.look(b, &frame);
        upper.face(a, &frame, -1.0, lower.heights.1 + limits.level);
        lower.face(b, &frame, 1.0, upper.heights.0 - limits.level);
        let pair = ((&*upper, &a.solid.mesh), (&*lower, &b.solid.mesh));
        cover(pair.0, pair.1, &frame, limits, &mut self.work, points)
    }

    /// What the line of `a` has in common with the faces of `b`.
    fn line(
        &mut self,
        (a, round): (&Placed, &Round),
        b: &Placed,
        (n, limits, side): (&Vec3, Limits, Side),
        points: &mut Points,
    ) -> f64 {
        let trace = Trace::new(a, round, n, side);
        let frame = Frame::new(*n);
        let lower = &mut self.seen[1];
        lower.look(b, &frame);
        lower.face(b, &frame, 1.0, trace.lowest(n) - limits.level);
        trace.cover((lower, &b.solid.mesh), &frame, limits, points)
    }

    /// A capsule or a cylinder on a polyhedron.
    fn round_on_faces(
        &mut self,
        (a, round): (&Placed, &Round),
        b: &Placed,
        (n, limits): (&Vec3, Limits),
        points: &mut Points,
    ) {
        let blend = a.solid.blend + b.solid.blend;
        let mut cut = 0.0;
        if round.flat {
            let all = self.cover((a, b), (n, limits), points);
            cut = cut_off(a, n, &all, blend);
            points.scale(0, if cut > 0.0 { cut / all.weight } else { 0.0 });
        }
        if cut == 1.0 {
            return;
        }
        let first = points.count();
        let line = self.line((a, round), b, (n, limits, Side::First), points);
        if line > 0.0 {
            points.scale(first, (1.0 - cut) / line);
        } else if cut > 0.0 {
            points.scale(0, 1.0 / cut);
        }
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
        let (n, blend) = (apart.normal, a.solid.blend + b.solid.blend);
        let (mut cut_a, mut cut_b, mut taken) = (0.0, 0.0, 0.0);
        if ra.flat && rb.flat {
            // How much of each end the other cuts off: once from each side, with what each would
            // cover of the plane of the other.
            let back = self.cover((b, a), (&-n, limits), points);
            points.scale(0, 0.0);
            let all = self.cover((a, b), (&n, limits), points);
            (cut_a, cut_b) = (cut_off(a, &n, &all, blend), cut_off(b, &n, &back, blend));
            let share = (all.weight / (LEAST * blend * blend * blend)).min(1.0) * cut_a * cut_b;
            points.scale(0, if share > 0.0 { share / all.weight } else { 0.0 });
            taken += share;
        }
        let mut lie = |(p, round): (&Placed, &Round), q: &Placed, n: &Vec3, side, cut: f64| {
            let first = points.count();
            let line = self.line((p, round), q, (n, limits, side), points);
            let share = (line / (LEAST * blend * blend)).min(1.0) * (1.0 - cut);
            points.scale(first, if share > 0.0 { share / line } else { 0.0 });
            share
        };
        if rb.flat {
            taken += lie((a, ra), b, &n, Side::First, cut_a);
        }
        if ra.flat {
            taken += lie((b, rb), a, &-n, Side::Second, cut_b);
        }
        if taken < 1.0 {
            let first = points.count();
            along_axes((a, ra), (b, rb), apart, limits.reach, points);
            points.scale(first, 1.0 - taken);
        } else {
            points.scale(0, 1.0 / taken);
        }
    }
}

/// How far a polygon takes over from the law of a rim: where the end of the cylinder `p` faces the
/// other shape and has something cut off within the blend of the deepest place. An end that leans
/// is round.
fn cut_off(p: &Placed, n: &Vec3, all: &Cover, blend: f64) -> f64 {
    let facing = p.axis().dot(n);
    let squared = facing * facing;
    let there = (all.area / (LEAST * blend * blend)).min(1.0);
    squared * squared * there * (CUT * all.cut).min(1.0)
}

/// A point without a rim.
pub(super) fn point(x: Vec3, depth: f64, share: f64) -> PatchPoint {
    PatchPoint {
        x,
        depth,
        share,
        rim: None,
    }
}

/// The points of a shape on the plane `n·x = offset`.
fn on_plane(a: &Placed, n: &Vec3, offset: f64, reach: f64, points: &mut Points) {
    if let Some(round) = &a.solid.round {
        Trace::new(a, round, n, Side::First).on_plane(n, offset, reach, points);
        return;
    }
    let mut take = |x: Vec3, share: f64| {
        let depth = offset - n.dot(&x);
        if depth > -reach {
            points.add(0, point(x + n * (0.5 * depth), depth, share));
        }
    };
    match &a.solid.core {
        Core::Point => take(a.p - n * a.solid.radius, 1.0),
        Core::Box { .. } => {
            for corner in &a.solid.mesh.corners {
                take(a.p + a.R * corner, 0.25);
            }
        }
        _ => {
            let down = a.R.tr_mul(&-n);
            for (i, corner) in a.solid.mesh.corners.iter().enumerate() {
                take(a.p + a.R * corner, a.solid.shares.share(i, &down));
            }
        }
    }
}
