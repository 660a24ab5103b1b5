//! Axis of least overlap of two cores that meet.
//!
//! Two polyhedra overlap least along the normal of a face of one, or across an edge of each. Round
//! cores have their axis, and what is across it, towards the other's middle and its edges. The
//! direction jumps where two axes overlap alike; only cores that meet come here, and these overlap
//! by more than their rounding.

use super::placed::{Placed, separation};
use super::segments::segments;
use crate::spatial::Vec3;

/// Pairs of edges that are tried, at most: with more, faces alone decide.
const MOST_EDGE_PAIRS: usize = 1024;
/// Pairs of points by which directions are ruled out: enough for all sides of a shape. With 2 fails
/// `few_directions_need_a_look_at_all_corners`.
const WITNESSES: usize = 16;

/// The search for the direction in which two cores overlap least.
///
/// From any point `y` of `b` to any point `x` of `a`, the gap along `n` is at most `n·(x − y)`. So
/// a few such pairs, those that were farthest along directions before, rule out nearly all
/// directions of two hulls without a look at all corners.
#[derive(Debug)]
struct Search {
    /// The best direction so far, and the gap along it.
    best: (Vec3, f64),
    /// From a point of `b` to one of `a`.
    across: [Vec3; WITNESSES],
    /// Directions in which corners have been looked at.
    looks: usize,
}

impl Default for Search {
    fn default() -> Self {
        Self {
            best: (Vec3::z(), f64::NEG_INFINITY),
            across: [Vec3::zeros(); WITNESSES],
            looks: 0,
        }
    }
}

impl Search {
    /// Takes a direction and the opposite one if they are better.
    fn take(&mut self, (a, b): (&Placed, &Placed), direction: Vec3) {
        let Some(n) = direction.try_normalize(1e-12) else {
            return;
        };
        for n in [n, -n] {
            let known = &self.across[..self.looks.min(WITNESSES)];
            if known.iter().any(|across| n.dot(across) < self.best.1) {
                continue;
            }
            let across = a.support(&-n) - b.support(&n);
            let gap = n.dot(&across);
            self.across[self.looks % WITNESSES] = across;
            self.looks += 1;
            if gap > self.best.1 {
                self.best = (n, gap);
            }
        }
    }
}

/// Unit vector from `b` to `a` along which the cores overlap least, and the gap along it, negative.
pub(super) fn least_overlap(a: &Placed, b: &Placed) -> (Vec3, f64) {
    search(a, b).best
}

fn search(a: &Placed, b: &Placed) -> Search {
    let mut search = Search::default();
    let mut take = |direction: Vec3| search.take((a, b), direction);
    for p in [a, b] {
        for normal in &p.solid.mesh.normals {
            take(p.R * normal);
        }
    }
    let edges = |p: &Placed| p.solid.mesh.edges.len() + usize::from(p.solid.round.is_some());
    let edge = |p: &Placed, i: usize| -> Vec3 {
        p.solid
            .mesh
            .edges
            .get(i)
            .map_or_else(|| p.axis(), |e| p.R * e)
    };
    if edges(a) * edges(b) <= MOST_EDGE_PAIRS {
        for i in 0..edges(a) {
            let e = edge(a, i);
            for j in 0..edges(b) {
                take(e.cross(&edge(b, j)));
            }
        }
    }
    let between = a.p - b.p;
    for p in [a, b] {
        if p.solid.round.is_some() {
            let k = p.axis();
            take(between - k * k.dot(&between));
        }
    }
    take(between);
    take(Vec3::z());
    search
}

/// Of some directions, and those of the faces and ends of both cores, the one that `acts` in which
/// they overlap least, from `b` to `a`.
pub(super) fn least_overlap_along(
    (a, b): (&Placed, &Placed),
    more: [Vec3; 2],
    acts: impl Fn(&Vec3) -> bool,
) -> Option<Vec3> {
    let mut best: Option<(f64, Vec3)> = None;
    let mut take = |n: Vec3| {
        for n in [n, -n] {
            let gap = separation(a, b, &n);
            if best.is_none_or(|(most, _)| gap > most) && acts(&n) {
                best = Some((gap, n));
            }
        }
    };
    more.into_iter().for_each(&mut take);
    for p in [a, b] {
        let normals = p.solid.mesh.normals.iter().map(|n| p.R * n);
        let end = p.solid.round.is_some().then(|| p.axis());
        normals.chain(end).for_each(&mut take);
    }
    best.map(|(_, n)| n)
}

/// A point in the midst of the overlap: where their axes are nearest, of what has one.
pub(super) fn middle(a: &Placed, b: &Placed) -> Vec3 {
    let axis = |p: &Placed| {
        let half = p.solid.round.map_or(0.0, |round| round.half);
        (p.p, p.axis() * half)
    };
    let (x, y) = segments(axis(a), axis(b));
    (x + y) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::pair::tests::{any_rotation, at, cloud, cube, solid};
    use crate::testing::Random;

    /// The gap that is found is the largest of all faces' and pairs of edges' directions, which are
    /// all looked at here; the search looks at a tenth of them.
    #[test]
    fn few_directions_need_a_look_at_all_corners() {
        let mut random = Random(0x5DEE_CE66_D1CE_4E5B);
        let (mut all, mut looks) = (0, 0);
        for i in 0..40 {
            let hull = solid(&cloud(40, 0.1, &mut random));
            let other = solid(&if i % 2 == 0 {
                cube(0.05)
            } else {
                cloud(12, 0.08, &mut random)
            });
            let mut place = |by| at(random.vector(by), any_rotation(&mut random));
            let poses = [place(0.0), place(0.02)];
            let [a, b] = [(&hull, &poses[0]), (&other, &poses[1])]
                .map(|(solid, pose)| Placed::new(solid, pose, &Vec3::zeros()));
            let faces = |p: &Placed| -> Vec<Vec3> {
                p.solid.mesh.normals.iter().map(|n| p.R * n).collect()
            };
            let edges =
                |p: &Placed| -> Vec<Vec3> { p.solid.mesh.edges.iter().map(|e| p.R * e).collect() };
            let mut directions = [faces(&a), faces(&b)].concat();
            let pairs = edges(&a).len() * edges(&b).len();
            if pairs <= MOST_EDGE_PAIRS {
                for e in edges(&a) {
                    directions.extend(edges(&b).iter().map(|f| e.cross(f)));
                }
            }
            let gap = |n: Vec3| separation(&a, &b, &n).max(separation(&a, &b, &-n));
            let unit = directions.iter().filter_map(|n| n.try_normalize(1e-12));
            let expected = unit.map(gap).fold(f64::NEG_INFINITY, f64::max);
            let found = search(&a, &b);
            assert!(
                (found.best.1 - expected).abs() < 1e-15,
                "{expected} {found:?}"
            );
            all += 2 * directions.len();
            looks += found.looks;
        }
        assert!(10 * looks < all, "{looks} of {all}");
    }
}
