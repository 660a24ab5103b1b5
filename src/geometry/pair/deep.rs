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

/// Unit vector from `b` to `a` along which the cores overlap least, and the gap along it, negative.
pub(super) fn least_overlap(a: &Placed, b: &Placed) -> (Vec3, f64) {
    let mut best = (Vec3::z(), f64::NEG_INFINITY);
    let mut take = |direction: Vec3| {
        let Some(n) = direction.try_normalize(1e-12) else {
            return;
        };
        for n in [n, -n] {
            let gap = separation(a, b, &n);
            if gap > best.1 {
                best = (n, gap);
            }
        }
    };
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
    best
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
