//! Direction and distance from one core to another.
//!
//! Closed forms where a point or a segment meets something simple. Otherwise `gjk.rs` finds
//! which features face each other, and the direction follows from these to round-off: normal of a
//! face, product of two edges, what is across an edge, or the nearest point of an edge to a round
//! core. Two cylinders are in `cylinders.rs`. Where cores meet, `deep.rs` takes the
//! axis of least overlap.
//!
//! For any unit vector `n` the gap along it, `σ(n) = min n·a − max n·b`, is no more than the
//! distance, and equal to it for the right one. Each result is checked by it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Core;
use super::gjk::{self, Pair, Simplex};
use super::placed::{Placed, separation};
use super::segments::segments;
use super::{cylinders, deep};
use crate::spatial::{Mat3, Vec3};

/// Share of the rounding within which cores count as meeting.
const TOUCH: f64 = 1e-6;
/// Accuracy of `σ` against the distance, relative to the size of the cores.
const OPTIMAL: f64 = 1e-13;
/// Share of a hull's reach within which what a cylinder faces is looked for first.
const NEARBY: f64 = 0.05;
/// How far a face's normal may be off the direction found from three of its corners.
const SNAP: f64 = 1e-6;

/// How two cores lie to each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    /// Unit vector from B to A.
    pub(super) normal: Vec3,
    /// Distance, m; where the cores meet by how much they overlap along the normal, negative.
    pub(super) distance: f64,
    /// Half way between the surfaces where the cores are nearest. To round-off only where it is
    /// needed: not where polyhedra have faces in common.
    pub(super) middle: Vec3,
    /// Part of the direction that is that of the cores, 1 where inner cores have none.
    pub(super) part: f64,
    /// Whether these meet, too.
    pub(super) deep: bool,
}

/// How the core of `a` lies to that of `b`; only roughly, but farther than `far`, m, where they are
/// that far from each other.
///
/// Where the shapes overlap by more than half of their roundings, the direction turns over to that
/// between the inner cores, and is it alone before the cores meet: with the distance `d` of the
/// cores and the sum `r` of the roundings, by `w = 2 d/r`. Inner cores that meet, too, have the
/// axis of least overlap.
pub(super) fn nearest(a: &Placed, b: &Placed, far: f64) -> Apart {
    let touch = TOUCH * (a.solid.blend + b.solid.blend);
    let half = 0.5 * (a.solid.rounding() + b.solid.rounding());
    let (apart, at) = between(a, b, [touch, far]).unwrap_or((Vec3::zeros(), a.p));
    let distance = apart.norm();
    let part = if distance <= 2.0 * touch {
        0.0
    } else if half > 0.0 {
        ((distance - 2.0 * touch) / half).min(1.0)
    } else {
        1.0
    };
    // What sweeps the cores leaves the nearest points along the direction.
    let halfway =
        |v: &Vec3, n: &Vec3, x: &Vec3, [r, s]: [f64; 2]| x - v * 0.5 + n * (0.5 * (s - r));
    let outer = apart.try_normalize(touch).map(|n| {
        let radii = [a.solid.radius, b.solid.radius];
        (n, halfway(&apart, &n, &at, radii))
    });
    let (normal, middle, deep) = match outer {
        Some((n, x)) if part >= 1.0 => (n, x, false),
        _ => {
            let (p, q) = (a.inner(), b.inner());
            let radii = [a.solid.inner_radius, b.solid.inner_radius];
            let inner = between(&p, &q, [touch, f64::INFINITY]).and_then(|(v, at)| {
                let n = v.try_normalize(touch)?;
                Some((n, halfway(&v, &n, &at, radii)))
            });
            let deep = inner.is_none();
            let (n, x) = inner.unwrap_or_else(|| {
                let (n, _) = deep::least_overlap(&p, &q);
                (n, deep::middle(a, b))
            });
            match outer {
                Some((m, y)) if part > 0.0 => (
                    (n * (1.0 - part) + m * part).normalize(),
                    x * (1.0 - part) + y * part,
                    deep,
                ),
                _ => (n, x, deep),
            }
        }
    };
    Apart {
        normal,
        distance: separation(a, b, &normal),
        middle,
        part,
        deep,
    }
}

/// From the core of `b` to that of `a`, and the nearest point of `a`; nothing, or 0, where they
/// are within `touch`; only roughly beyond `far`, see [`nearest`].
fn between(a: &Placed, b: &Placed, [touch, far]: [f64; 2]) -> Option<(Vec3, Vec3)> {
    use Core::{Box, Cylinder, Point, Segment};
    Some(match (a.core, b.core) {
        (Point, Point | Segment { .. } | Box { .. } | Cylinder { .. }) => {
            (from_point(&a.p, b), a.p)
        }
        (Segment { .. } | Box { .. } | Cylinder { .. }, Point) => {
            let apart = -from_point(&b.p, a);
            (apart, b.p + apart)
        }
        (Segment { half: u }, Segment { half: v }) => {
            let (x, y) = segments((a.p, a.axis() * *u), (b.p, b.axis() * *v));
            (x - y, x)
        }
        (Segment { half }, Cylinder { .. }) => {
            let u = a.axis() * *half;
            let (apart, s) = from_segment(&a.p, &u, b);
            (apart, a.p + u * s)
        }
        (Cylinder { .. }, Segment { half }) => {
            let u = b.axis() * *half;
            let (apart, s) = from_segment(&b.p, &u, a);
            (-apart, b.p + u * s - apart)
        }
        _ => {
            let simplex = gjk::distance(a, b, [touch, far])?;
            let (x, y) = simplex.nearest();
            if let Some(n) = (x - y).try_normalize(touch) {
                let gap = separation(a, b, &n);
                if gap > far {
                    return Some((n * gap, x));
                }
            }
            let (apart, at) = polished(a, b, &simplex);
            let normal = apart.try_normalize(touch)?;
            if separation(a, b, &normal) <= touch {
                return None;
            }
            (apart, at)
        }
    })
}

/// From the nearest point of the core of `b` to `x`; 0 inside.
pub(super) fn from_point(x: &Vec3, b: &Placed) -> Vec3 {
    let local = b.R.tr_mul(&(x - b.p));
    let apart = match b.core {
        Core::Segment { half } => Vec3::new(local.x, local.y, past(local.z, *half)),
        Core::Box { half } => local.zip_map(half, past),
        Core::Cylinder { radius, half } => {
            let off = (local.x * local.x + local.y * local.y).sqrt();
            let share = if off > *radius {
                1.0 - radius / off
            } else {
                0.0
            };
            Vec3::new(local.x * share, local.y * share, past(local.z, *half))
        }
        _ => local,
    };
    b.R * apart
}

/// What of `x` is beyond `−half … half`.
fn past(x: f64, half: f64) -> f64 {
    x - x.clamp(-half, half)
}

/// From the core of `b` to the nearest point of the segment `p ± u`, and where on it that is, from
/// −1 to 1.
///
/// The distance of a convex set is a convex function of the place on the segment: its derivative is
/// monotone. It bends sharply where the segment passes the plane of an end or a face of the core,
/// by eight powers of ten where an edge is nearly parallel to a cylinder, so the bracket of its
/// root is first made one between such places. Within it Illinois' false position finds it.
/// (`an_edge_along_a_thin_cylinder_has_its_direction_to_round_off`)
pub(super) fn from_segment(p: &Vec3, u: &Vec3, b: &Placed) -> (Vec3, f64) {
    let at = |s: f64| {
        let apart = from_point(&(p + u * s), b);
        (apart.dot(u), apart)
    };
    let ((mut low, first), (mut high, last)) = (at(-1.0), at(1.0));
    if low >= 0.0 {
        return (first, -1.0);
    }
    if high <= 0.0 {
        return (last, 1.0);
    }
    let (mut s, mut t) = (-1.0, 1.0);
    let mut best = if -low < high {
        (-low, first, -1.0)
    } else {
        (high, last, 1.0)
    };
    let mut keep = |value: f64, apart: Vec3, place: f64| {
        if value.abs() < best.0 {
            best = (value.abs(), apart, place);
        }
    };
    let extents = match b.core {
        Core::Segment { half } | Core::Cylinder { half, .. } => [None, None, Some(*half)],
        Core::Box { half } => [Some(half.x), Some(half.y), Some(half.z)],
        _ => [None; 3],
    };
    let (from, along) = (b.R.tr_mul(&(p - b.p)), b.R.tr_mul(u));
    for (axis, half) in extents.into_iter().enumerate() {
        for end in half.into_iter().flat_map(|half| [-half, half]) {
            let place = (end - from[axis]) / along[axis];
            // Also not where it is no number.
            if place > s && place < t {
                let (value, apart) = at(place);
                keep(value, apart, place);
                if value < 0.0 {
                    (s, low) = (place, value);
                } else {
                    (t, high) = (place, value);
                }
            }
        }
    }
    let mut side = 0;
    for i in 0..100 {
        let middle = if i % 4 == 3 {
            0.5 * (s + t)
        } else {
            (s * high - t * low) / (high - low)
        };
        if middle <= s || middle >= t {
            break;
        }
        let (value, apart) = at(middle);
        keep(value, apart, middle);
        if value == 0.0 {
            break;
        }
        if value < 0.0 {
            (s, low) = (middle, value);
            if side == -1 {
                high *= 0.5;
            }
            side = -1;
        } else {
            (t, high) = (middle, value);
            if side == 1 {
                low *= 0.5;
            }
            side = 1;
        }
    }
    // Between the ends it is across the segment: what round-off leaves along it would count by the
    // length of the segment.
    let (_, apart, place) = best;
    (apart - u * (apart.dot(u) / u.norm_squared()), place)
}

/// From the core of `b` to that of `a`, exact for the features that the simplex is made of; and the
/// nearest point of `a`.
fn polished(a: &Placed, b: &Placed, simplex: &Simplex) -> (Vec3, Vec3) {
    let (x, y) = simplex.nearest();
    let rough = x - y;
    let pairs = &simplex.pairs[..simplex.count];
    let (on_a, on_b) = (distinct(pairs, a, 0), distinct(pairs, b, 1));
    let round = |p: &Placed| matches!(p.core, Core::Cylinder { .. });
    let apart = match (round(a), round(b)) {
        (true, true) => return cylinders::apart(a, b, (&rough, &x)),
        (true, false) => -against_round(b, &on_b, a, &-rough),
        (false, true) => against_round(a, &on_a, b, &rough),
        (false, false) => from_features(a, b, (&on_a, &on_b), pairs, &rough),
    };
    let gap = |v: &Vec3| {
        let length = v.norm();
        if length > 0.0 {
            separation(a, b, &(v / length))
        } else {
            f64::NEG_INFINITY
        }
    };
    let best = gap(&apart);
    let size = pairs.iter().map(|p| p.w.norm()).fold(0.0, f64::max);
    let tolerance = OPTIMAL * size;
    if (apart.norm() - best).abs() <= tolerance && best >= gap(&rough) - tolerance {
        return (apart, x);
    }
    // The features were not the right ones: of all that can be, the one with the largest gap; first
    // among those near the direction found.
    let search = |share: f64| match (round(a), round(b)) {
        (true, false) => -search_round(b, a, (&-rough, share)),
        (false, true) => search_round(a, b, (&rough, share)),
        _ => rough,
    };
    let mut searched = search(NEARBY);
    if (searched.norm() - gap(&searched)).abs() > tolerance {
        searched = search(f64::INFINITY);
    }
    let better = |found: (f64, Vec3), v: Vec3| {
        let value = gap(&v);
        if value > found.0 { (value, v) } else { found }
    };
    let best = better((gap(&rough), rough), searched);
    (better(best, apart).1, x)
}

/// Different points of a simplex on one side.
#[derive(Clone, Copy, Debug)]
struct Distinct {
    at: [Vec3; 4],
    local: [Vec3; 4],
    count: usize,
    R: Mat3,
}

impl Distinct {
    /// From the first to the `i`th.
    fn edge(&self, i: usize) -> Vec3 {
        self.R * (self.local[i] - self.local[0])
    }

    /// Middle and half of the edge between two.
    fn halves(&self) -> (Vec3, Vec3) {
        ((self.at[0] + self.at[1]) * 0.5, self.edge(1) * 0.5)
    }
}

fn distinct(pairs: &[Pair], placed: &Placed, side: usize) -> Distinct {
    let mut list = Distinct {
        at: [Vec3::zeros(); 4],
        local: [Vec3::zeros(); 4],
        count: 0,
        R: placed.R,
    };
    for pair in pairs {
        let x = pair.local[side];
        if !list.local[..list.count].contains(&x) {
            list.at[list.count] = placed.world(&x);
            list.local[list.count] = x;
            list.count += 1;
        }
    }
    list
}

/// The length of `rough` along `direction`, in that direction.
fn along(direction: Vec3, rough: &Vec3) -> Option<Vec3> {
    let n = direction.try_normalize(0.0)?;
    Some(n * n.dot(rough))
}

/// The normal of the face through three of the corners of a core, times the length of `rough`
/// along it.
fn of_face(p: &Placed, corners: &Distinct, rough: &Vec3) -> Option<Vec3> {
    let found = along(corners.edge(1).cross(&corners.edge(2)), rough)?;
    let local = p.R.tr_mul(&found.normalize());
    let normals = &p.solid.mesh.normals;
    let same = |n: &&Vec3| n.dot(&local).abs() > 1.0 - SNAP;
    let snapped = normals
        .iter()
        .find(same)
        .and_then(|n| along(p.R * n, rough));
    Some(snapped.unwrap_or(found))
}

/// From an edge of B to an edge of A that it crosses: along their product, which loses digits by
/// the sine of their angle, or between their nearest points, which loses them by the distance.
fn across_edges(on_a: &Distinct, on_b: &Distinct, rough: &Vec3) -> Vec3 {
    let (e, f) = (on_a.halves(), on_b.halves());
    let product = e.1.cross(&f.1);
    let lengths = e.1.norm() * f.1.norm();
    let size = e.1.norm() + f.1.norm();
    if product.norm() * size > rough.norm() * lengths {
        along(product, rough).unwrap_or(*rough)
    } else {
        let (x, y) = segments(e, f);
        x - y
    }
}

/// Two polyhedra, or one and a segment.
fn from_features(
    a: &Placed,
    b: &Placed,
    (on_a, on_b): (&Distinct, &Distinct),
    pairs: &[Pair],
    rough: &Vec3,
) -> Vec3 {
    let found = match (pairs.len(), on_a.count, on_b.count) {
        (2, 2, 2) => {
            // An edge each, but only a diagonal of what they span.
            let (x, y) = segments(on_a.halves(), on_b.halves());
            Some(x - y)
        }
        (2, ..) => {
            let edge = pairs[1].w - pairs[0].w;
            let off = rough - edge * (edge.dot(rough) / edge.norm_squared());
            Some(off)
        }
        (3, 3, 1) => of_face(a, on_a, rough),
        (3, 1, 3) => of_face(b, on_b, rough),
        (3, 2, 2) => Some(across_edges(on_a, on_b, rough)),
        (3, ..) => along(
            (pairs[1].w - pairs[0].w).cross(&(pairs[2].w - pairs[0].w)),
            rough,
        ),
        _ => None,
    };
    found.unwrap_or(*rough)
}

/// From a cylinder to a polyhedron that faces it with the corners `on`.
fn against_round(p: &Placed, on: &Distinct, cylinder: &Placed, rough: &Vec3) -> Vec3 {
    match on.count {
        1 => from_point(&on.at[0], cylinder),
        2 => {
            let (middle, half) = on.halves();
            from_segment(&middle, &half, cylinder).0
        }
        _ => {
            let found = of_face(p, on, rough).unwrap_or(*rough);
            let n = found.normalize();
            n * separation(p, cylinder, &n)
        }
    }
}

/// The same by trying everything that a polyhedron can face it with; of a hull what lies within
/// `share` of its reach of what is farthest against `rough`.
fn search_round(p: &Placed, cylinder: &Placed, (rough, share): (&Vec3, f64)) -> Vec3 {
    let mut best = (f64::NEG_INFINITY, Vec3::zeros());
    let mut take = |v: Vec3| {
        let length = v.norm();
        if length > 0.0 {
            let value = separation(p, cylinder, &(v / length));
            if value > best.0 {
                best = (value, v);
            }
        }
    };
    for normal in &p.solid.mesh.normals {
        let n = -(p.R * normal);
        take(n * separation(p, cylinder, &n));
    }
    let mut edge = |x: Vec3, y: Vec3| {
        let (x, y) = (p.p + p.R * x, p.p + p.R * y);
        take(from_segment(&((x + y) * 0.5), &((y - x) * 0.5), cylinder).0);
    };
    match p.core {
        Core::Box { half } => {
            for i in 0..8 {
                let corner = |i: usize| {
                    let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
                    half.component_mul(&Vec3::new(sign(1), sign(2), sign(4)))
                };
                for bit in [1, 2, 4] {
                    if i & bit == 0 {
                        edge(corner(i), corner(i + bit));
                    }
                }
            }
        }
        Core::Corners(corners) => {
            let list = corners.list();
            // Segments within the core do no harm: nothing in it is nearer than its surface.
            let local = p.R.tr_mul(rough);
            let limit = p.support_local(&-rough).dot(&local) + share * p.solid.reach * local.norm();
            let faces = |x: &&Vec3| x.dot(&local) <= limit;
            for (i, x) in list.iter().enumerate().filter(|(_, x)| faces(x)) {
                for y in list[..i].iter().filter(faces) {
                    edge(*x, *y);
                }
            }
        }
        _ => {}
    }
    best.1
}
