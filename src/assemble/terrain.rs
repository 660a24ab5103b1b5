//! Robots and objects that are to stand on terrain.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::initial::poses;
use crate::geometry::pair::Patch;
use crate::model::{Collider, LinkId, Model};
use crate::spatial::Vec3;
use crate::tree::TreeCollider;

/// Halvings by which the height is found where something stands: to round-off.
const HALVINGS: usize = 60;

/// Parts of the way down to a mesh at most.
const MOST_PARTS: f64 = 20_000.0;

/// Whether a model has terrain.
pub(super) fn has_terrain(model: &Model) -> bool {
    model.colliders.iter().any(|c| c.shape.is_terrain())
}

/// Sets the base of a tree to where the deepest of its shapes touches terrain, if there is any
/// below; `above`: only where it begins inside. Gives the link that touches and the name of the
/// terrain.
pub(super) fn set_down(model: &mut Model, tree: usize, above: bool) -> Option<(LinkId, String)> {
    let poses = poses(model);
    let colliders = &poses.tree.contact.colliders;
    let terrain = |index: usize| model.colliders[index].shape.is_terrain();
    let own: Vec<_> = colliders
        .iter()
        .filter(|c| c.tree == tree && !terrain(c.index))
        .collect();
    let grounds: Vec<_> = colliders.iter().filter(|c| terrain(c.index)).collect();
    let mut patch = Patch::new();
    let size = model
        .colliders
        .iter()
        .filter(|c: &&Collider| !matches!(c.shape, crate::geometry::Shape::Plane))
        .map(|c| c.X_BG.p.norm() + c.shape.bounding_radius())
        .fold(0.0, f64::max);
    let far = 1e3 + 10.0 * size;
    // The deepest point with the base lifted by so much.
    let mut deepest = |lift: f64| {
        let mut most: Option<(f64, LinkId, usize)> = None;
        for a in &own {
            for b in &grounds {
                let (Some(first), Some(second)) = (&a.solid, &b.solid) else {
                    continue;
                };
                let mut X = poses.pair([a, b]);
                X[0].p += Vec3::z() * lift;
                patch.find((first, &X[0]), (second, &X[1]), 0.0);
                for point in patch.points() {
                    if most.is_none_or(|(depth, ..)| point.depth > depth) {
                        most = Some((point.depth, LinkId::from(a.link), b.link));
                    }
                }
            }
        }
        most
    };
    let touches = |found: &Option<(f64, LinkId, usize)>| found.is_some_and(|f| f.0 > 0.0);
    if above && !touches(&deepest(0.0)) {
        return None;
    }
    let (mut low, mut high) = (if above { 0.0 } else { -far }, far);
    if touches(&deepest(high)) {
        return None;
    }
    if !touches(&deepest(low)) {
        // Behind a mesh there is nothing: down from above it, by parts of the smallest shape.
        let radius = |c: &&&TreeCollider| model.colliders[c.index].shape.bounding_radius();
        let smallest = own.iter().map(|c| radius(&c)).fold(size, f64::min);
        let base = model.roots[tree].position.z;
        let top = 2.0 * size - base;
        let part = (0.25 * smallest).max(2.0 * top.abs() / MOST_PARTS);
        low = top;
        while !touches(&deepest(low)) {
            high = low;
            low -= part;
            if low < -2.0 * size - base {
                return None;
            }
        }
    }
    let mut last = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let found = deepest(middle);
        if touches(&found) {
            (low, last) = (middle, found);
        } else {
            high = middle;
        }
    }
    let (_, link, ground) = last?;
    model.roots[tree].position.z += high;
    Some((link, model.links[ground].name.clone()))
}
