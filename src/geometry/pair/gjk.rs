//! Distance of two convex cores by the algorithm of Gilbert, Johnson and Keerthi.
//!
//! 1. The difference of two convex sets, all `a − b`, is convex; its point `v` nearest to 0 is the
//!    difference of the nearest points.
//! 2. Of any simplex of such differences the nearest point `v` is found, and what does not carry it
//!    is dropped. No point of the set reaches farther towards 0 than the support point `w` in the
//!    direction `−v`. If `v·w = |v|²`, nothing is nearer than `v`: done.
//! 3. Otherwise `w` joins the simplex, and `|v|` decreases. For polyhedra this ends, because a
//!    simplex never returns; for round cores `|v|² − v·w` falls below any bound.
//!
//! The simplex is kept as pairs of points, from which `nearest.rs` takes the features that
//! face each other and their direction to round-off. All tolerances are relative to what is
//! compared, so that parts of a millimetre are treated like those of a metre.
//!
//! Source: Gilbert, Johnson and Keerthi 1988; van den Bergen 1999.

use super::core::Core;
use super::placed::Placed;
use crate::spatial::Vec3;

/// Iterations, at most: three to eight are usual, a round core takes up to thirty.
const MOST_ITERATIONS: usize = 64;
/// Accuracy of `|v|² − v·w` relative to `|v|` and the size of the simplex.
const ACCURACY: f64 = 4e-16;
/// The same for round cores, whose nearest points are found from the features that these face each
/// other with.
const ROUND_ACCURACY: f64 = 1e-12;

/// Height of a tetrahedron, relative to its size, below which it is flat.
const FLAT: f64 = 1e-10;

/// A point of A, one of B, and their difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub(super) a: Vec3,
    pub(super) b: Vec3,
    pub(super) w: Vec3,
    /// The points in the axes of A and of B: from these short edges have all their digits.
    pub(super) local: [Vec3; 2],
}

/// The pairs whose hull has the nearest point, and the weights of them in it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Simplex {
    pub(super) pairs: [Pair; 4],
    pub(super) weights: [f64; 4],
    pub(super) count: usize,
}

impl Simplex {
    /// Nearest points of A and B.
    pub(super) fn nearest(&self) -> (Vec3, Vec3) {
        let (mut a, mut b) = (Vec3::zeros(), Vec3::zeros());
        for (pair, weight) in self.pairs[..self.count].iter().zip(self.weights) {
            a += pair.a * weight;
            b += pair.b * weight;
        }
        (a, b)
    }

    /// The nearest point to 0; drops the pairs that do not carry it. 0 if it is inside.
    fn reduce(&mut self) -> Vec3 {
        let w = |i: usize| self.pairs[i].w;
        let mut best = (f64::INFINITY, [0.0; 4], Vec3::zeros());
        let mut take = |weights: [f64; 4], v: Vec3| {
            let squared = v.norm_squared();
            if squared < best.0 {
                best = (squared, weights, v);
            }
        };
        for i in 0..self.count {
            let mut weights = [0.0; 4];
            weights[i] = 1.0;
            take(weights, w(i));
            for j in 0..i {
                let edge = w(i) - w(j);
                let t = -w(j).dot(&edge) / edge.norm_squared();
                if t > 0.0 && t < 1.0 {
                    let mut weights = [0.0; 4];
                    (weights[i], weights[j]) = (t, 1.0 - t);
                    take(weights, w(j) + edge * t);
                }
                for k in 0..j {
                    let (e, f) = (edge, w(k) - w(j));
                    let normal = e.cross(&f);
                    let square = normal.norm_squared();
                    let s = -w(j).cross(&f).dot(&normal) / square;
                    let t = -e.cross(&w(j)).dot(&normal) / square;
                    if s > 0.0 && t > 0.0 && s + t < 1.0 {
                        let mut weights = [0.0; 4];
                        (weights[i], weights[j], weights[k]) = (s, 1.0 - s - t, t);
                        take(weights, normal * (normal.dot(&w(j)) / square));
                    }
                }
            }
        }
        if self.count == 4 && self.encloses() {
            return Vec3::zeros();
        }
        let (_, weights, v) = best;
        let mut kept = Self::default();
        for (pair, weight) in self.pairs.iter().zip(weights) {
            if weight > 0.0 {
                kept.pairs[kept.count] = *pair;
                kept.weights[kept.count] = weight;
                kept.count += 1;
            }
        }
        *self = kept;
        v
    }

    /// Whether 0 is inside of the tetrahedron. One that is flat but for round-off holds nothing.
    fn encloses(&self) -> bool {
        let w = |i: usize| self.pairs[i].w;
        let size = (0..4).map(|i| w(i).norm()).fold(0.0, f64::max);
        (0..4).all(|i| {
            let (a, b, c, d) = (w((i + 1) % 4), w((i + 2) % 4), w((i + 3) % 4), w(i));
            let normal = (b - a).cross(&(c - a));
            let height = normal.dot(&(a - d));
            // 0 and the fourth corner on one side.
            height.abs() > FLAT * size * normal.norm() && normal.dot(&a) * height > 0.0
        })
    }
}

/// The simplex of the nearest points; `None` if the cores are nearer than `touch`, m. If they are
/// farther apart than `far`, m, it is one whose direction shows it.
pub(super) fn distance(a: &Placed, b: &Placed, [touch, far]: [f64; 2]) -> Option<Simplex> {
    let pair = |d: &Vec3| {
        let local = [a.support_local(&-d), b.support_local(d)];
        let (a, b) = (a.world(&local[0]), b.world(&local[1]));
        Pair {
            a,
            b,
            w: a - b,
            local,
        }
    };
    let round = [a, b]
        .iter()
        .any(|p| matches!(p.core, Core::Cylinder { .. }));
    let accuracy = if round { ROUND_ACCURACY } else { ACCURACY };
    let mut toward = a.p - b.p;
    if toward == Vec3::zeros() {
        toward = Vec3::z();
    }
    let mut simplex = Simplex {
        count: 1,
        weights: [1.0, 0.0, 0.0, 0.0],
        ..Simplex::default()
    };
    simplex.pairs[0] = pair(&toward);
    let mut v = simplex.pairs[0].w;
    let mut before = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let squared = v.norm_squared();
        if squared <= touch * touch {
            return None;
        }
        let next = pair(&v);
        if v.dot(&next.w) > far * squared.sqrt() {
            return Some(simplex);
        }
        let size = simplex.pairs[..simplex.count]
            .iter()
            .map(|p| p.w.norm())
            .fold(next.w.norm(), f64::max);
        let known = simplex.pairs[..simplex.count].iter().any(|p| p.w == next.w);
        if known || squared - v.dot(&next.w) <= accuracy * squared.sqrt() * size {
            return Some(simplex);
        }
        let last = simplex;
        simplex.pairs[simplex.count] = next;
        simplex.count += 1;
        v = simplex.reduce();
        let now = v.norm_squared();
        if now == 0.0 {
            return None;
        }
        // Round-off may not let it come nearer.
        if now >= before.min(squared) {
            return Some(last);
        }
        before = now;
    }
    Some(simplex)
}
