//! Convex hull of points, with a bound on its corners.
//!
//! Quickhull, the furthest outside point first. Stopping early leaves the points that matter most,
//! and how far the rest reach out is known; no library offers that. Parry's hull panics on some
//! inputs and takes plates below a relative thickness of 3e-4 for flat; the tests use it as the
//! second route to volumes.
//!
//! In: any finite points. Out: corners, the simplices between them (tetrahedra's faces, triangles
//! of a plate, the segment of a rod), and the largest distance of an input point from the result.
//!
//! Source: Barber, Dobkin and Huhdanpaa 1996, The Quickhull Algorithm for Convex Hulls.

use super::nearest::{on_segment, on_triangle};
use crate::spatial::Vec3;
use std::collections::{BTreeMap, BinaryHeap};

/// Part of the size (half the longest edge of the bounding box) below which a point counts as on
/// the hull. Mesh files hold seven digits.
const ON_HULL: f64 = 1e-7;

/// Part of the size below which points count as in one plane or on one line: a metre-long plate
/// thinner than a thousandth of a millimetre.
const FLAT: f64 = 1e-6;

/// Part of the size by which distances count as equal: of a face's points the outermost is taken,
/// never one from its middle.
const TIE: f64 = 1e-6;

/// The least distance that counts as equal to `most`.
fn tied(most: f64) -> f64 {
    most - TIE.min(0.1 * most)
}

/// What the points span.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Simplices {
    /// Faces of a solid, seen counter-clockwise from outside.
    Faces(Vec<[usize; 3]>),
    /// A plate: its corners in order.
    Polygon(Vec<usize>),
    /// A rod: its ends are corners 0 and 1.
    Segment,
    /// All points are corner 0.
    Point,
}

/// A convex hull.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hull {
    /// Corners, taken from the input.
    pub(super) corners: Vec<Vec3>,
    /// What lies between them.
    pub(super) simplices: Simplices,
    /// Largest distance of an input point from the hull of the corners, m.
    pub(super) error: f64,
}

/// The hull of finite points with at most `most` (4 or more) corners; `None` if there are no
/// points.
#[cfg_attr(small, optimize(size))]
pub(super) fn hull(points: &[Vec3], most: usize) -> Option<Hull> {
    let first = points.first()?;
    let (low, high) = points
        .iter()
        .fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
    let (center, size) = ((low + high) * 0.5, (high - low).max() * 0.5);
    if size <= f64::MIN_POSITIVE {
        return Some(Hull {
            corners: vec![*first],
            simplices: Simplices::Point,
            error: 0.0,
        });
    }
    // All lengths below are in units of `size`, about `center`.
    let scaled: Vec<Vec3> = points.iter().map(|p| (p - center) / size).collect();
    let a = extreme(&scaled, |p| p.x);
    let b = furthest(&scaled, &scaled[a]);
    let a = furthest(&scaled, &scaled[b]);
    let along = (scaled[b] - scaled[a]).normalize();
    let off_line = |p: &Vec3| {
        let r = p - scaled[a];
        r - along * along.dot(&r)
    };
    let out = off_line(&scaled[extreme(&scaled, |p| off_line(p).norm_squared())]);
    let (indices, simplices, error) = if out.norm() < FLAT {
        (vec![a, b], Simplices::Segment, out.norm())
    } else {
        let side = out.normalize();
        let c = outermost(&scaled, &scaled[a], |p| side.dot(&(p - scaled[a])));
        let normal = along.cross(&side);
        let height = |p: &Vec3| normal.dot(&(p - scaled[a]));
        let d = outermost(&scaled, &scaled[a], |p| height(p).abs());
        let thickness = height(&scaled[d]).abs();
        let solid = (thickness >= FLAT).then(|| Solid::new(&scaled, [a, b, c, d]));
        if let Some(solid) = solid.flatten() {
            let (indices, faces, error) = solid.grow(most);
            (indices, Simplices::Faces(faces), error)
        } else {
            let (indices, error) = polygon(&scaled, [a, b], &normal, most);
            let order = (0..indices.len()).collect();
            (indices, Simplices::Polygon(order), error + thickness)
        }
    };
    Some(Hull {
        corners: indices.iter().map(|&i| points[i]).collect(),
        simplices,
        error: error * size,
    })
}

/// Index of the point with the largest value.
fn extreme(points: &[Vec3], value: impl Fn(&Vec3) -> f64) -> usize {
    let mut best = (f64::NEG_INFINITY, 0);
    for (i, p) in points.iter().enumerate() {
        let v = value(p);
        if v > best.0 {
            best = (v, i);
        }
    }
    best.1
}

fn furthest(points: &[Vec3], from: &Vec3) -> usize {
    extreme(points, |p| (p - from).norm_squared())
}

/// Of the points whose value is largest but for [`TIE`], the one furthest from `from`: a corner.
fn outermost(points: &[Vec3], from: &Vec3, value: impl Fn(&Vec3) -> f64) -> usize {
    let most = value(&points[extreme(points, &value)]);
    extreme(points, |p| {
        if value(p) >= tied(most) {
            (p - from).norm_squared()
        } else {
            f64::NEG_INFINITY
        }
    })
}

/// Quickhull in a plane: corners in order, and the largest distance of a point from them.
#[cfg_attr(small, optimize(size))]
fn polygon(points: &[Vec3], ends: [usize; 2], normal: &Vec3, most: usize) -> (Vec<usize>, f64) {
    struct Edge {
        start: usize,
        end: usize,
        outside: Vec<usize>,
        furthest: Option<(f64, usize)>,
    }
    let edge = |start: usize, end: usize, candidates: &[usize]| {
        let out = (points[end] - points[start]).cross(normal).normalize();
        let distance = |i: usize| out.dot(&(points[i] - points[start]));
        let outside: Vec<usize> = candidates
            .iter()
            .copied()
            .filter(|&i| distance(i) > ON_HULL)
            .collect();
        let middle = (points[start] + points[end]) * 0.5;
        let furthest = pick(points, &outside, &middle, distance);
        Edge {
            start,
            end,
            outside,
            furthest,
        }
    };
    let all: Vec<usize> = (0..points.len()).collect();
    let [a, b] = ends;
    let mut edges = vec![edge(a, b, &all), edge(b, a, &all)];
    while edges.len() < most {
        let by_distance = |(_, e): &(usize, &Edge)| e.furthest.map_or(0, |(d, _)| d.to_bits());
        let Some((at, worst)) = edges.iter().enumerate().max_by_key(by_distance) else {
            break;
        };
        let Some((_, apex)) = worst.furthest else {
            break;
        };
        let (first, second) = (
            edge(worst.start, apex, &worst.outside),
            edge(apex, worst.end, &worst.outside),
        );
        edges.splice(at..=at, [first, second]);
    }
    let error = edges
        .iter()
        .flat_map(|e| e.outside.iter().map(move |&i| (e, i)))
        .map(|(e, i)| (points[i] - on_segment(&points[i], &points[e.start], &points[e.end])).norm())
        .fold(0.0, f64::max);
    (edges.iter().map(|e| e.start).collect(), error)
}

/// The furthest of `outside` and its distance; of those as far but for [`TIE`], the outermost from
/// `middle`.
fn pick(
    points: &[Vec3],
    outside: &[usize],
    middle: &Vec3,
    distance: impl Fn(usize) -> f64,
) -> Option<(f64, usize)> {
    let most = outside
        .iter()
        .map(|&i| distance(i))
        .fold(f64::NEG_INFINITY, f64::max);
    let mut best: Option<(f64, usize)> = None;
    for &i in outside {
        if distance(i) < tied(most) {
            continue;
        }
        let reach = (points[i] - middle).norm_squared();
        if best.is_none_or(|(r, _)| reach > r) {
            best = Some((reach, i));
        }
    }
    best.map(|(_, i)| (most, i))
}

struct Facet {
    corners: [usize; 3],
    /// The facet across the edge from corner `i` to corner `i + 1`.
    across: [usize; 3],
    normal: Vec3,
    offset: f64,
    outside: Vec<usize>,
    furthest: Option<(f64, usize)>,
    alive: bool,
}

impl Facet {
    fn distance(&self, p: &Vec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}

struct Solid<'p> {
    points: &'p [Vec3],
    facets: Vec<Facet>,
    /// Facets with points outside, the furthest point on top; dead ones are skipped.
    queue: BinaryHeap<(u64, usize)>,
    /// Points that could not be added for round-off.
    skipped: Vec<usize>,
}

impl<'p> Solid<'p> {
    /// A tetrahedron of four points; `None` if they are in a plane.
    fn new(points: &'p [Vec3], [a, b, c, d]: [usize; 4]) -> Option<Self> {
        let inward = (points[b] - points[a])
            .cross(&(points[c] - points[a]))
            .dot(&(points[d] - points[a]));
        // Seen from outside, `a b c` must run counter-clockwise: away from `d`.
        let (b, c) = if inward > 0.0 { (c, b) } else { (b, c) };
        let mut solid = Self {
            points,
            facets: Vec::new(),
            queue: BinaryHeap::new(),
            skipped: Vec::new(),
        };
        let faces = [
            ([a, b, c], [1, 2, 3]),
            ([b, a, d], [0, 3, 2]),
            ([c, b, d], [0, 1, 3]),
            ([a, c, d], [0, 2, 1]),
        ];
        let all: Vec<usize> = (0..points.len()).collect();
        for (corners, across) in faces {
            let facet = solid.facet(corners, across)?;
            solid.facets.push(facet);
        }
        solid.distribute(&all, 0);
        Some(solid)
    }

    /// `None` if the corners are in line.
    #[cfg_attr(small, optimize(size))]
    fn facet(&self, corners: [usize; 3], across: [usize; 3]) -> Option<Facet> {
        let [a, b, c] = corners.map(|i| self.points[i]);
        // From the corner opposite the longest edge round-off is least.
        let edges = [(a, b, c), (b, c, a), (c, a, b)];
        let (p, q, r) = edges.into_iter().min_by(|x, y| {
            let length = |(p, q, r): &(Vec3, Vec3, Vec3)| (q - p).norm() + (r - p).norm();
            length(x).total_cmp(&length(y))
        })?;
        let normal = (q - p).cross(&(r - p)).try_normalize(1e-14)?;
        Some(Facet {
            corners,
            across,
            normal,
            offset: normal.dot(&((a + b + c) / 3.0)),
            outside: Vec::new(),
            furthest: None,
            alive: true,
        })
    }

    /// Gives each point to the facet from `from` on that it is furthest outside of; points inside
    /// are dropped.
    #[cfg_attr(small, optimize(size))]
    fn distribute(&mut self, candidates: &[usize], from: usize) {
        for &i in candidates {
            let mut best = (ON_HULL, None);
            for (f, facet) in self.facets.iter().enumerate().skip(from) {
                let distance = facet.distance(&self.points[i]);
                if distance > best.0 {
                    best = (distance, Some(f));
                }
            }
            if let (_, Some(f)) = best {
                self.facets[f].outside.push(i);
            }
        }
        for f in from..self.facets.len() {
            self.rank(f);
        }
    }

    /// Finds the furthest point of a facet and queues it.
    #[cfg_attr(small, optimize(size))]
    fn rank(&mut self, f: usize) {
        let facet = &self.facets[f];
        let [a, b, c] = facet.corners.map(|i| self.points[i]);
        let middle = (a + b + c) / 3.0;
        let furthest = pick(self.points, &facet.outside, &middle, |i| {
            facet.distance(&self.points[i])
        });
        if let Some((distance, _)) = furthest {
            // Positive numbers are ordered like their bits.
            self.queue.push((distance.to_bits(), f));
        }
        self.facets[f].furthest = furthest;
    }

    /// Adds the furthest points until none is outside or there are `most` corners.
    fn grow(mut self, most: usize) -> (Vec<usize>, Vec<[usize; 3]>, f64) {
        let mut corners = 4;
        while let Some((_, f)) = self.queue.pop() {
            let Some((_, apex)) = self.facets[f].furthest.filter(|_| self.facets[f].alive) else {
                continue;
            };
            if corners >= most {
                // A point may have covered others: count before giving up.
                corners = self.corners().len();
                if corners >= most {
                    break;
                }
            }
            if self.add(f, apex) {
                corners += 1;
            } else {
                self.facets[f].outside.retain(|&i| i != apex);
                self.skipped.push(apex);
                self.rank(f);
            }
        }
        self.finish()
    }

    /// Replaces the facets that `apex` sees by a cone; `false` and no change if round-off forbids
    /// it.
    fn add(&mut self, seen_by: usize, apex: usize) -> bool {
        let p = self.points[apex];
        let mut visible = vec![seen_by];
        let mut is_visible: BTreeMap<usize, bool> = BTreeMap::from([(seen_by, true)]);
        // Edges of the rim by their start: end, facet beyond.
        let mut rim: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        let mut edges = 0;
        let mut next = 0;
        while let Some(&f) = visible.get(next) {
            next += 1;
            for side in 0..3 {
                let other = self.facets[f].across[side];
                let known = is_visible.get(&other).copied();
                let sees = known.unwrap_or_else(|| self.facets[other].distance(&p) > ON_HULL);
                if known.is_none() {
                    is_visible.insert(other, sees);
                    if sees {
                        visible.push(other);
                    }
                }
                if !sees {
                    let [start, end] = [side, (side + 1) % 3].map(|c| self.facets[f].corners[c]);
                    rim.insert(start, (end, other));
                    edges += 1;
                }
            }
        }
        // The rim must be one loop that passes each corner once.
        let Some(&start) = rim.keys().min() else {
            return false;
        };
        let mut order = Vec::with_capacity(rim.len());
        let mut at = start;
        while let Some(&(end, beyond)) = rim.get(&at) {
            order.push((at, end, beyond));
            at = end;
            if at == start || order.len() > edges {
                break;
            }
        }
        if at != start || order.len() != edges || edges < 3 {
            return false;
        }
        let base = self.facets.len();
        let mut cone = Vec::with_capacity(edges);
        for (k, &(a, b, beyond)) in order.iter().enumerate() {
            let (after, before) = (base + (k + 1) % edges, base + (k + edges - 1) % edges);
            match self.facet([a, b, apex], [beyond, after, before]) {
                Some(facet) => cone.push(facet),
                None => return false,
            }
        }
        for (k, &(a, b, beyond)) in order.iter().enumerate() {
            let facet = &mut self.facets[beyond];
            for side in 0..3 {
                if facet.corners[side] == b && facet.corners[(side + 1) % 3] == a {
                    facet.across[side] = base + k;
                }
            }
        }
        let mut orphans = Vec::new();
        for f in visible {
            let facet = &mut self.facets[f];
            facet.alive = false;
            facet.furthest = None;
            orphans.extend(facet.outside.drain(..).filter(|&i| i != apex));
        }
        self.facets.extend(cone);
        self.distribute(&orphans, base);
        true
    }

    fn alive(&self) -> impl Iterator<Item = &Facet> {
        self.facets.iter().filter(|f| f.alive)
    }

    /// Corners in use, ascending.
    #[cfg_attr(small, optimize(size))]
    fn corners(&self) -> Vec<usize> {
        let mut list: Vec<usize> = self.alive().flat_map(|f| f.corners).collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    fn finish(self) -> (Vec<usize>, Vec<[usize; 3]>, f64) {
        let faces: Vec<[usize; 3]> = self.alive().map(|f| f.corners).collect();
        let error = self.error(&faces);
        let corners = self.corners();
        let place: BTreeMap<usize, usize> =
            corners.iter().enumerate().map(|(k, &i)| (i, k)).collect();
        let faces = faces.iter().map(|f| f.map(|i| place[&i])).collect();
        (corners, faces, error)
    }

    /// Largest distance of a point from the solid.
    fn error(&self, faces: &[[usize; 3]]) -> f64 {
        let own = self
            .alive()
            .flat_map(|f| f.outside.iter().map(move |&i| (f, i)));
        let skipped = self.skipped.iter().filter_map(|&i| {
            let height = |f: &Facet| f.distance(&self.points[i]);
            let facet = self.alive().max_by(|a, b| height(a).total_cmp(&height(b)));
            facet.map(|f| (f, i))
        });
        let left = own.chain(skipped);
        let mut left: Vec<_> = left
            .map(|(f, i)| (f.distance(&self.points[i]), f, i))
            .collect();
        // What is likely to be the furthest comes first. Most others can then be left out: a point
        // is no further from the solid than from any one of its faces.
        left.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut error = 0.0;
        for (_, own, i) in left.into_iter().filter(|(height, ..)| *height > 0.0) {
            let p = &self.points[i];
            let mut least = f64::INFINITY;
            for face in std::iter::once(&own.corners).chain(faces) {
                least = (p - on_triangle(p, face.map(|i| self.points[i])))
                    .norm()
                    .min(least);
                if least <= error {
                    break;
                }
            }
            error = least.max(error);
        }
        error
    }
}
