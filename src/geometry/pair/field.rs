//! A shape on uneven terrain.
//!
//! Points of the shape against the surface, and points of the surface against the shape, each with
//! the normal of the surface that it meets:
//!
//! 1. What carries the shape on a plane, see `on_plane` in `meet.rs`: corners, the lowest point of
//!    each rim, the ends of a capsule, the lowest point of a ball. A corner is deep by its distance
//!    from the tangent plane below it; what is round meets the surface where both have the same
//!    normal, in a hollow that bends more than itself in each such place. With the shares that they
//!    have on a plane, so that even terrain is a plane.
//! 2. Places between these where the surface bulges towards the shape, see `bulge.rs`.
//! 3. Sharp samples of the surface (spikes, crests, its rim) against the surface of the shape, with
//!    the share [`crate::geometry::field::Field::sample`] gives them. Where the terrain is smooth
//!    they have none.
//!
//! All belong to one patch: it is as stiff as one on a plane.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::bulge::{End, bulges};
use super::core::{Core, Round, Solid};
use super::deepest::Deepest;
use super::foot::{Nearest, Place, nearest_from};
use super::placed::Placed;
use super::points::{PatchPoint, Side, point};
use super::ring::{Lows, below_or_beyond};
use super::sink::Sink;
use super::surface::part_between;
use super::trace::Trace;
use crate::geometry::field::{Field, Rim};
use crate::spatial::Vec3;
use crate::tuning::{BESIDE, CROWN, MOST_PEAKS, NEAREST_ON_FIELD};

/// Adds the points of a shape, given in the axes of the terrain.
pub(super) fn on_field(shape: &Placed, field: &Field, sink: &mut Sink) {
    let around = shape.solid.reach + sink.reach;
    // The lowest points of rims are beyond a cylinder by less than its crown.
    let top = field.highest(shape.p.x, shape.p.y, around * (1.0 + 2.0 * CROWN));
    if shape.p.z - around > top {
        return;
    }
    // A place so far above is at least `sink.reach` before every tangent plane around.
    let clear = top + sink.reach / field.upright() + CROWN * around;
    let mut on = OnField {
        shape,
        field,
        clear,
        sink,
    };
    let low = shape.support(&-Vec3::z()).z - shape.solid.radius;
    let is_sharp = matches!(shape.core, Core::Box { .. } | Core::Cylinder { .. });
    if !is_sharp || low - BEYOND * shape.solid.rounding() < clear {
        let ends = on.own_points();
        bulges(shape, field, ends, on.sink);
    }
    if low - on.sink.reach < top {
        on.peaks(around, low);
    }
}

/// How far edges and corners of a box or a cylinder are beyond its rounding, in terms of it: less
/// than `√3 − 1`.
const BEYOND: f64 = 0.733;

/// What is being found.
struct OnField<'a, 's> {
    shape: &'a Placed<'a>,
    field: &'a Field,
    /// A height above which no corner and no lowest point of a rim has a part, m.
    clear: f64,
    sink: &'a mut Sink<'s>,
}

impl OnField<'_, '_> {
    /// What carries the shape on a plane; gives back both ends of what is round.
    fn own_points(&mut self) -> Option<[End; 2]> {
        let shape = self.shape;
        if let Some(round) = &shape.solid.round {
            let ends = if round.flat {
                self.rims(round)
            } else {
                [1.0, -1.0].map(|s| {
                    let end = shape.p + shape.axis() * (s * round.half);
                    self.ball(&end, round.radius, 0.5)
                })
            };
            let [Some(first), Some(last)] = ends else {
                return None;
            };
            return Some([first, last]);
        }
        match shape.core {
            Core::Point => {
                self.ball(&shape.p, shape.solid.radius, 1.0);
            }
            Core::Box { .. } => {
                for i in 0..shape.solid.mesh.corners.len() {
                    self.corner(i, |_| 0.25);
                }
            }
            _ => {
                let shares = &shape.solid.shares;
                for i in 0..shape.solid.mesh.corners.len() {
                    self.corner(i, |n| shares.share(i, &shape.R.tr_mul(&-n)));
                }
            }
        }
        None
    }

    /// The place that says on which terrain an end of a cylinder lies: the lowest one of the rim of
    /// its core, as on a mesh.
    fn over(&self, round: &Round, s: f64, n: &Vec3) -> [f64; 2] {
        let r = self.shape.solid.radius;
        let core = Round {
            radius: round.radius - r,
            half: round.half - r,
            ..*round
        };
        let (x, _) = Trace::new(self.shape, &core, n, Side::First).end(s);
        [x.x, x.y]
    }

    /// A corner of the shape; beyond the end of the surface as long as the corner of its core is
    /// not.
    fn corner(&mut self, index: usize, share: impl Fn(&Vec3) -> f64) {
        let shape = self.shape;
        let x = shape.world(&shape.solid.mesh.corners[index]);
        if x.z >= self.clear {
            return;
        }
        if self.field.has_seams() {
            let core = shape.world(&shape.solid.core_corners[index]);
            if self.field.goes_on([core.x, core.y]) {
                return;
            }
        }
        let below = self.field.below(&x).or_else(|| {
            let core = shape.world(&shape.solid.core_corners[index]);
            let (height, n) = self.field.tangent(core.x, core.y)?;
            Some((n, n.dot(&(Vec3::new(core.x, core.y, height) - x))))
        });
        if let Some((n, depth)) = below {
            let share = share(&n);
            self.sink
                .add(&n, point(x + n * (0.5 * depth), depth, share));
        }
    }

    /// A ball about `c`, against the tangent plane of each place of the surface that is nearest to
    /// it; gives back the deepest.
    fn ball(&mut self, c: &Vec3, radius: f64, share: f64) -> Option<End> {
        let mut nearest = Nearest::in_hollow(self.field, c, radius, self.sink.reach);
        if nearest.count == 0
            && let Some((place, _)) =
                nearest_from(self.field, c, [c.x, c.y], (NEAREST_ON_FIELD, f64::INFINITY))
        {
            nearest.add(place);
        }
        let mut deepest = None;
        for Place { at, n } in nearest.found() {
            let depth = radius - n.dot(&(c - at));
            self.sink
                .add(n, point(c - n * (radius - 0.5 * depth), depth, share));
            deepest = Some(deeper(deepest, End { n: *n, depth }));
        }
        deepest
    }

    /// Both ends of a cylinder: the lowest point of each rim along the normal of the surface below
    /// that point. The ends take turns, because none of them waits for the other. Gives back both.
    fn rims(&mut self, round: &Round) -> [Option<End>; 2] {
        let shape = self.shape;
        let mut given = [None; 2];
        let mut ends = [0, 1].map(|k| {
            let s = [1.0, -1.0][k];
            let center = shape.p + shape.axis() * (s * round.half);
            let lows = Lows::find(shape, round, s, (self.field, self.sink.reach));
            if let Some(lows) = &lows
                && !lows.found().is_empty()
            {
                given[k] = self.lows(round, s, lows);
                return None;
            }
            let (n, _) = below_or_beyond(self.field, &center)?;
            Some(Lowest { s, n, found: None })
        });
        for _ in 0..NEAREST_ON_FIELD {
            let mut changes = false;
            for slot in &mut ends {
                let Some(end) = slot else { continue };
                if end.found.is_some_and(|(n, ..)| n == end.n) {
                    continue;
                }
                let (x, _) = Trace::new(shape, round, &end.n, Side::First).end(end.s);
                if let Some((next, depth)) = below_or_beyond(self.field, &x)
                    && !self.field.goes_on(self.over(round, end.s, &end.n))
                {
                    end.found = Some((end.n, depth, x));
                    changes |= end.n != next;
                    end.n = next;
                } else {
                    *slot = None;
                }
            }
            if !changes {
                break;
            }
        }
        for (end, given) in ends.into_iter().zip(&mut given) {
            let Some(end) = end else { continue };
            let Some((n, depth, x)) = end.found else {
                continue;
            };
            *given = Some(End { n, depth });
            if depth > -self.sink.reach {
                let (_, rim) = Trace::new(shape, round, &n, Side::First).end(end.s);
                let halfway = point(x + n * (0.5 * depth), depth, 0.5);
                self.sink.add(&n, PatchPoint { rim, ..halfway });
            }
        }
        given
    }

    /// An end of a cylinder where the ground is not even: each place of its rim that is deeper than
    /// those beside it; gives back the deepest.
    fn lows(&mut self, round: &Round, s: f64, lows: &Lows) -> Option<End> {
        let mut deepest = None;
        for low in lows.found() {
            let (n, depth) = (low.n, low.depth);
            if self.field.has_seams() && self.field.goes_on(self.over(round, s, &n)) {
                continue;
            }
            let halfway = point(low.x + n * (0.5 * depth), depth, 0.5 * low.part);
            let rim = low.rim;
            self.sink.add(&n, PatchPoint { rim, ..halfway });
            deepest = Some(deeper(deepest, End { n, depth }));
        }
        deepest
    }

    /// Sharp samples of the surface.
    ///
    /// - `low`: the lowest point of the shape, but for the rounding of its edges, m
    fn peaks(&mut self, around: f64, low: f64) {
        let (shape, field, reach) = (self.shape, self.field, self.sink.reach);
        let mut best = Deepest::<[(f64, Peak); MOST_PEAKS]>::new();
        field.each_peak((shape.p.x, shape.p.y, around), low - reach, |i, j| {
            if field.passes([i, j], &shape.p, shape.solid.reach + reach) {
                return f64::NEG_INFINITY;
            }
            let (x, n, mut share) = field.sample(i, j);
            if let Some((normal, depth, part, place)) = against(shape, &x, &n)
                && depth > -reach
                && {
                    share *= part * part_over(field, shape, &place);
                    share *= match field.rim(i, j) {
                        Rim::Inside => 1.0,
                        Rim::Seam => 0.0,
                        Rim::End(sides) => part_at_end(&normal, &sides, (shape, &x)),
                    };
                    share > 0.0
                }
            {
                let peak = Peak { x, normal, share };
                best.add(depth, peak);
            }
            f64::NEG_INFINITY
        });
        for (depth, peak) in best.found() {
            let halfway = peak.x - peak.normal * (0.5 * depth);
            let found = point(halfway, *depth, peak.share);
            self.sink.add(&peak.normal, found);
        }
    }
}

/// How much of a place `x` of a shape in the ground counts: nothing where it is beside the ground
/// by the rounding of the shape. What falls there is passed by lines along normals, too.
fn part_over(field: &Field, shape: &Placed, x: &Vec3) -> f64 {
    let [a, b] = field.within([x.x, x.y]);
    let beside = (x.x - a).abs().max((x.y - b).abs());
    // A shape without a rounding, a capsule, has to be over the ground.
    if beside > 0.0 {
        (1.0 - beside / shape.solid.rounding()).max(0.0)
    } else {
        1.0
    }
}

/// What of a sample at the end of the surface acts in a direction, see [`part_between`]. A ball
/// finds the end itself.
fn part_at_end(n: &Vec3, sides: &[Vec3; 2], at: (&Placed, &Vec3)) -> f64 {
    if let Core::Point = at.0.core {
        return 0.0;
    }
    part_between(n, sides, at)
}

/// The deeper of two ends.
fn deeper(known: Option<End>, end: End) -> End {
    match known {
        Some(known) if known.depth >= end.depth => known,
        _ => end,
    }
}

/// An end of a cylinder while the lowest point of its rim is being found.
#[derive(Clone, Copy)]
struct Lowest {
    /// Which one, 1 or −1.
    s: f64,
    /// The normal of the surface below the point that was found last.
    n: Vec3,
    /// The normal along which this point is lowest, its depth, and the point.
    found: Option<(Vec3, f64, Vec3)>,
}

/// A sharp sample in a shape.
#[derive(Clone, Copy, Default)]
struct Peak {
    x: Vec3,
    /// Into the shape.
    normal: Vec3,
    share: f64,
}

/// How a point `x` of the surface, which has the normal `n` there, lies to the surface of a shape:
/// the direction into the shape, how deep in it the point is, how much of it counts, and the place
/// below the point along `n` where the shape begins, or the point itself. It counts 0 where the
/// edge of the shape passes it and 1 from the rounding of that edge on: what slides over a sample
/// does not come upon it at once. None where the shape is not over the point.
fn against(shape: &Placed, x: &Vec3, n: &Vec3) -> Option<(Vec3, f64, f64, Vec3)> {
    let solid = shape.solid;
    if let Core::Point | Core::Segment { .. } = shape.core {
        let half = match shape.core {
            Core::Segment { half } => *half,
            _ => 0.0,
        };
        let axis = shape.axis();
        let along = axis.dot(&(x - shape.p)).clamp(-half, half);
        let apart = shape.p + axis * along - x;
        let distance = apart.norm();
        let normal = if distance > 0.0 { apart / distance } else { *n };
        return Some((normal, solid.radius - distance, 1.0, *x));
    }
    // Where the line along `n` through the point enters the shape, and where it leaves.
    let (x, d) = (shape.R.tr_mul(&(x - shape.p)), shape.R.tr_mul(n));
    let mut enter = (f64::NEG_INFINITY, Vec3::zeros());
    let mut leave = f64::INFINITY;
    let mut cut = |normal: Vec3, height: f64| {
        let (rate, over) = (normal.dot(&d), height - normal.dot(&x));
        if rate == 0.0 {
            return over >= 0.0;
        }
        let t = over / rate;
        if rate > 0.0 {
            leave = leave.min(t);
        } else if t > enter.0 {
            enter = (t, normal);
        }
        true
    };
    if let Some(round) = &solid.round {
        let flat = [Vec3::z(), -Vec3::z()];
        if !flat.into_iter().all(|z| cut(z, round.half)) {
            return None;
        }
        let (a, b) = (d.x * d.x + d.y * d.y, d.x * x.x + d.y * x.y);
        let c = x.x * x.x + x.y * x.y - round.radius * round.radius;
        if a <= 0.0 {
            if c > 0.0 {
                return None;
            }
        } else {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let root = root.sqrt();
            leave = leave.min((root - b) / a);
            let t = (-b - root) / a;
            if t > enter.0 {
                let side = Vec3::new(x.x + t * d.x, x.y + t * d.y, 0.0);
                enter = (t, side / round.radius);
            }
        }
    } else {
        let mesh = &solid.mesh;
        for (face, normal) in mesh.normals.iter().enumerate() {
            let height = normal.dot(&mesh.corners[mesh.face(face)[0]]);
            if !cut(*normal, height) {
                return None;
            }
        }
        if mesh.normals.is_empty() {
            return None;
        }
    }
    let (t, normal) = enter;
    if t > leave || !t.is_finite() {
        return None;
    }
    let part = (inside(solid, &(x + d * t), (&normal, &d)) / solid.rounding()).clamp(0.0, 1.0);
    let place = shape.world(&(x + d * t.min(0.0)));
    Some((-(shape.R * normal), t * normal.dot(&d), part, place))
}

/// How far a place on the surface of a shape is from the faces around that do not look where the
/// face does that it lies on, m; infinite without any.
///
/// - `normal`: of that face
/// - `d`: the direction in which the shape is looked at
fn inside(solid: &Solid, x: &Vec3, (normal, d): (&Vec3, &Vec3)) -> f64 {
    let mut least = f64::INFINITY;
    let mut cut = |face: &Vec3, height: f64| {
        if face != normal && face.dot(d) > -BESIDE {
            least = least.min(height - face.dot(x));
        }
    };
    if let Some(round) = &solid.round {
        cut(&Vec3::z(), round.half);
        cut(&-Vec3::z(), round.half);
        let across = Vec3::new(x.x, x.y, 0.0);
        if let Some(side) = across.try_normalize(0.0)
            && normal.z != 0.0
        {
            cut(&side, round.radius);
        }
        return least;
    }
    let mesh = &solid.mesh;
    for (face, normal) in mesh.normals.iter().enumerate() {
        cut(normal, normal.dot(&mesh.corners[mesh.face(face)[0]]));
    }
    least
}
