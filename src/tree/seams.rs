//! Terrain that goes on in other terrain, as regions of different friction do.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Tree;
use crate::geometry::Shape;
use crate::geometry::pair::Solid;
use crate::model::Model;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{EVEN_EDGE, SEAM};
use std::sync::Arc;

impl Tree {
    /// Lets meshes go on in the ground and in other terrain that begins where they end. Each of
    /// them has a crest there, at which what slides across would stumble.
    pub(super) fn join_terrain(&mut self, model: &Model) {
        let is_fixed = |place: &usize| {
            let collider = &self.contact.colliders[*place];
            !collider.moves && model.colliders[collider.index].shape.is_terrain()
        };
        let count = self.contact.colliders.len();
        let terrain: Vec<(usize, Pose, &Shape)> = (0..count)
            .filter(is_fixed)
            .map(|place| {
                let collider = &self.contact.colliders[place];
                let base = &self.trees[collider.tree].base;
                let shape = &model.colliders[collider.index].shape;
                (place, base.compose(&collider.X), shape)
            })
            .collect();
        let ground = (usize::MAX, Pose::IDENTITY, &Shape::Plane);
        let has_ground = self.contact.has_ground;
        let mut joined = Vec::new();
        for (place, X, shape) in &terrain {
            let Shape::Surface { surface } = shape else {
                continue;
            };
            let goes_on = |p: &Vec3, n: &Vec3| {
                let (p, n) = (X.point(p), X.R * n);
                let others = terrain.iter().filter(|(other, ..)| other != place);
                let mut all = others.chain(has_ground.then_some(&ground));
                all.any(|(_, X, shape)| carries(shape, &X.inverse().point(&p), &X.R.tr_mul(&n)))
            };
            // Also where there is no seam: other parameters may have moved it there before.
            let surface = surface
                .beside(goes_on)
                .map_or_else(|| surface.clone(), Arc::new);
            let solid = Solid::new(&Shape::Surface { surface }, 0.0);
            joined.push((*place, Arc::new(solid)));
        }
        for (place, solid) in joined {
            self.contact.colliders[place].solid = Some(solid);
        }
    }
}

/// Whether a point lies on terrain, with about that normal.
fn carries(shape: &Shape, p: &Vec3, n: &Vec3) -> bool {
    let near = |height: f64, normal: &Vec3| {
        (p.z - height).abs() <= SEAM && (normal - n).norm() < EVEN_EDGE
    };
    match shape {
        Shape::Plane => near(0.0, &Vec3::z()),
        Shape::Field { field } => field
            .tangent(p.x, p.y)
            .is_some_and(|(height, normal)| near(height, &normal)),
        Shape::Surface { surface } => surface.carries(p, n),
        _ => false,
    }
}
