//! Direction and distance from one core to another.
//!
//! Closed forms where a point or a segment meets something simple. Otherwise [`super::gjk`] finds
//! which features face each other, and the direction follows from these to round-off: normal of a
//! face, product of two edges, what is across an edge, or the nearest point of an edge to a round
//! core. Two cylinders are in [`super::cylinders`]. Where cores meet, [`super::deep`] takes the
//! axis of least overlap.
//!
//! For any unit vector `n` the gap along it, `σ(n) = min n·a − max n·b`, is no more than the
//! distance, and equal to it for the right one. Each result is checked by it.

use super::core::{Core, Placed};
use super::gjk::{self, Pair, Simplex};
use super::{cylinders, deep};
use crate::spatial::Vec3;

/// Share of the rounding within which cores count as meeting.
const TOUCH: f64 = 1e-6;
/// Accuracy of `σ` against the distance, relative to the size of the cores.
const OPTIMAL: f64 = 1e-13;
/// How far a face's normal may be off the direction found from three of its corners.
const SNAP: f64 = 1e-6;

/// How two cores lie to each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    /// Unit vector from B to A.
    pub(super) normal: Vec3,
    /// Distance, m; where the cores meet by how much they overlap along the normal, negative.
    pub(super) distance: f64,
    /// Nearest point of the core of A, where it is needed: not between polyhedra.
    pub(super) at: Vec3,
    /// Whether the cores meet.
    pub(super) deep: bool,
}

/// `σ(n)`.
pub(super) fn separation(a: &Placed, b: &Placed, n: &Vec3) -> f64 {
    n.dot(&(a.support(&-n) - b.support(n)))
}

/// How the core of `a` lies to that of `b`.
pub(super) fn nearest(a: &Placed, b: &Placed) -> Apart {
    use Core::{Box, Cylinder, Point, Segment};
    let touch = TOUCH * (a.solid.blend + b.solid.blend);
    let (apart, at) = match (&a.solid.core, &b.solid.core) {
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
        _ => match gjk::distance(a, b, touch) {
            Some(simplex) => polished(a, b, &simplex),
            None => (Vec3::zeros(), a.p),
        },
    };
    let distance = apart.norm();
    if distance > touch {
        let normal = apart / distance;
        return Apart {
            normal,
            distance: separation(a, b, &normal),
            at,
            deep: false,
        };
    }
    let (normal, distance) = deep::least_overlap(a, b);
    Apart {
        normal,
        distance,
        at: deep::middle(a, b, &normal),
        deep: true,
    }
}

/// From the nearest point of the core of `b` to `x`; 0 inside.
pub(super) fn from_point(x: &Vec3, b: &Placed) -> Vec3 {
    let local = b.R.tr_mul(&(x - b.p));
    let apart = match &b.solid.core {
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
/// monotone, and its root is found by Illinois' false position within the bracket.
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
    let mut found = (first, -1.0);
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
        found = (apart, middle);
        if value == 0.0 || apart == Vec3::zeros() {
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
    found
}

/// Nearest points of the segments `p ± u` and `q ± v`.
///
/// The lines are nearest where `w = u × v` joins them: at `s = (r × v)·w/|w|²` of the first, with
/// `r = q − p`, and at `t = (r × u)·w/|w|²` of the second. As products these are exact to round-off
/// over the angle of the lines, by which a wrong place hardly moves the nearest points. If one is
/// not on its segment, the nearest points are at an end of one of the two.
pub(super) fn segments((p, u): (Vec3, Vec3), (q, v): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let (r, w) = (q - p, u.cross(&v));
    let square = w.norm_squared();
    if square > 0.0 {
        let s = r.cross(&v).dot(&w) / square;
        let t = r.cross(&u).dot(&w) / square;
        if s.abs() <= 1.0 && t.abs() <= 1.0 {
            return (p + u * s, q + v * t);
        }
    }
    let on = |x: Vec3, p: Vec3, u: Vec3| {
        let square = u.norm_squared();
        if square > 0.0 {
            p + u * ((x - p).dot(&u) / square).clamp(-1.0, 1.0)
        } else {
            p
        }
    };
    let mut best = (f64::INFINITY, p, q);
    let mut take = |x: Vec3, y: Vec3| {
        let distance = (x - y).norm_squared();
        if distance < best.0 {
            best = (distance, x, y);
        }
    };
    for sign in [1.0, -1.0] {
        take(p + u * sign, on(p + u * sign, q, v));
        take(on(q + v * sign, p, u), q + v * sign);
    }
    (best.1, best.2)
}

/// From the core of `b` to that of `a`, exact for the features that the simplex is made of; and the
/// nearest point of `a`.
fn polished(a: &Placed, b: &Placed, simplex: &Simplex) -> (Vec3, Vec3) {
    let (x, y) = simplex.nearest();
    let rough = x - y;
    let pairs = &simplex.pairs[..simplex.count];
    let (on_a, on_b) = (distinct(pairs, |p| p.a), distinct(pairs, |p| p.b));
    let round = |p: &Placed| matches!(p.solid.core, Core::Cylinder { .. });
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
    if (apart.norm() - best).abs() <= OPTIMAL * size {
        return (apart, x);
    }
    // The features were not the right ones: of all that can be, the one with the largest gap.
    let searched = match (round(a), round(b)) {
        (true, false) => -search_round(b, a),
        (false, true) => search_round(a, b),
        _ => rough,
    };
    let better = |found: (f64, Vec3), v: Vec3| {
        let value = gap(&v);
        if value > found.0 { (value, v) } else { found }
    };
    let best = better((gap(&rough), rough), searched);
    (better(best, apart).1, x)
}

/// Different points of a simplex.
#[derive(Clone, Copy, Debug)]
struct Distinct {
    at: [Vec3; 4],
    count: usize,
}

fn distinct(pairs: &[Pair], of: impl Fn(&Pair) -> Vec3) -> Distinct {
    let mut list = Distinct {
        at: [Vec3::zeros(); 4],
        count: 0,
    };
    for pair in pairs {
        let x = of(pair);
        if !list.at[..list.count].contains(&x) {
            list.at[list.count] = x;
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
    let [x, y, z, _] = corners.at;
    let found = along((y - x).cross(&(z - x)), rough)?;
    let local = p.R.tr_mul(&found.normalize());
    let normals = &p.solid.mesh.normals;
    let same = |n: &&Vec3| n.dot(&local).abs() > 1.0 - SNAP;
    let snapped = normals
        .iter()
        .find(same)
        .and_then(|n| along(p.R * n, rough));
    Some(snapped.unwrap_or(found))
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
        (2, ..) => {
            let edge = pairs[1].w - pairs[0].w;
            let off = rough - edge * (edge.dot(rough) / edge.norm_squared());
            Some(off)
        }
        (3, 3, 1) => of_face(a, on_a, rough),
        (3, 1, 3) => of_face(b, on_b, rough),
        (3, 2, 2) => along(
            (on_a.at[1] - on_a.at[0]).cross(&(on_b.at[1] - on_b.at[0])),
            rough,
        ),
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
            let (x, y) = (on.at[0], on.at[1]);
            from_segment(&((x + y) * 0.5), &((y - x) * 0.5), cylinder).0
        }
        _ => {
            let found = of_face(p, on, rough).unwrap_or(*rough);
            let n = found.normalize();
            n * separation(p, cylinder, &n)
        }
    }
}

/// The same by trying everything that a polyhedron can face it with.
fn search_round(p: &Placed, cylinder: &Placed) -> Vec3 {
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
    match &p.solid.core {
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
        Core::Corners(list) => {
            // Segments within the core do no harm: nothing in it is nearer than its surface.
            for (i, x) in list.iter().enumerate() {
                for y in &list[..i] {
                    edge(*x, *y);
                }
            }
        }
        _ => {}
    }
    best.1
}
