//! Terrain that goes on in other terrain, as regions of different friction do.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Tree, TreeCollider};
use crate::geometry::Shape;
use crate::geometry::pair::Solid;
use crate::model::Model;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{EVEN_EDGE, SEAM};
use std::sync::Arc;

impl Tree {
    /// Lets meshes and heights go on in the ground, in other terrain and in boxes and hulls that do
    /// not move and begin where they end. Each of them has a crest there, at which what slides
    /// across would stumble. Where all of these stand as they stood, they are joined already.
    ///
    /// - `before`: poses of the bases with which the shapes were joined, or none
    #[cfg_attr(small, optimize(size))]
    pub(super) fn join_terrain(&mut self, model: &Model, before: &[Pose]) {
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
        let still = |collider: &&TreeCollider| !collider.moves;
        let stood = |collider: &TreeCollider| {
            let base = before.get(collider.tree);
            base.is_some_and(|base| *base == self.trees[collider.tree].base)
        };
        let mut all_still = self.contact.colliders.iter().filter(still);
        if terrain.is_empty() || all_still.all(stood) {
            return;
        }
        let solids: Vec<(Pose, Arc<Solid>)> = (self.contact.colliders.iter())
            .filter(still)
            .filter_map(|collider| {
                let base = &self.trees[collider.tree].base;
                Some((base.compose(&collider.X), collider.solid.clone()?))
            })
            .collect();
        let ground = (usize::MAX, Pose::IDENTITY, &Shape::Plane);
        let has_ground = self.contact.has_ground;
        let mut joined = Vec::new();
        for (place, X, shape) in &terrain {
            let carried = |ends: [Vec3; 2], n: &Vec3, parts: &mut Vec<[f64; 2]>| {
                let (ends, n) = (ends.map(|p| X.point(&p)), X.R * n);
                let others = terrain.iter().filter(|(other, ..)| other != place);
                for (_, X, shape) in others.chain(has_ground.then_some(&ground)) {
                    let ends = ends.map(|p| X.inverse().point(&p));
                    carry(shape, ends, &X.R.tr_mul(&n), parts);
                }
                for (X, solid) in &solids {
                    let ends = ends.map(|p| X.inverse().point(&p));
                    parts.extend(solid.carried(ends, &X.R.tr_mul(&n)));
                }
            };
            // Also where there is no seam: other parameters may have moved it there before.
            let shape = match shape {
                Shape::Surface { surface } => Shape::Surface {
                    surface: surface
                        .beside(carried)
                        .map_or_else(|| surface.clone(), Arc::new),
                },
                Shape::Field { field } => Shape::Field {
                    field: field
                        .beside(carried)
                        .map_or_else(|| field.clone(), Arc::new),
                },
                _ => continue,
            };
            let solid = Solid::new(&shape, 0.0);
            joined.push((*place, Arc::new(solid)));
        }
        for (place, solid) in joined {
            self.contact.colliders[place].solid = Some(solid);
        }
    }
}

/// Adds the parts of a segment, from 0 to 1, that lie on terrain, with about that normal.
fn carry(shape: &Shape, [a, b]: [Vec3; 2], n: &Vec3, parts: &mut Vec<[f64; 2]>) {
    let near = |p: &Vec3, height: f64, normal: &Vec3| {
        (p.z - height).abs() <= SEAM && (normal - n).norm() < EVEN_EDGE
    };
    match shape {
        Shape::Plane if [a, b].iter().all(|p| near(p, 0.0, &Vec3::z())) => parts.push([0.0, 1.0]),
        Shape::Field { field } => {
            // Looked at in each cell.
            let (cell, way) = (
                field.cell().into_iter().fold(f64::INFINITY, f64::min),
                b - a,
            );
            let looks = libm::ceil(way.norm() / cell).max(1.0);
            let slack = (SEAM / way.norm()).min(0.5);
            let is_near = |k: f64| {
                let p = a + way * (k / looks).clamp(slack, 1.0 - slack);
                let tangent = field.tangent(p.x, p.y);
                tangent.is_some_and(|(height, normal)| near(&p, height, &normal))
            };
            let (mut k, mut last) = (0.0, is_near(0.0));
            while k < looks {
                let next = is_near(k + 1.0);
                if last && next {
                    parts.push([k / looks, (k + 1.0) / looks]);
                }
                (k, last) = (k + 1.0, next);
            }
        }
        Shape::Surface { surface } => surface.carried([a, b], n, parts),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::Shape;
    use crate::geometry::surface::{Surface, Triangles};
    use crate::model::{LinkId, Model, RootId, RootKind};
    use crate::parameters::Parameters;
    use crate::slots::ParameterSlot;
    use crate::spatial::{Pose, RigidInertia, Vec3};
    use crate::testing::{Builder, inertia};
    use crate::tree::Tree;
    use std::sync::Arc;

    /// A level square of 2 m about a place.
    fn square(x: f64) -> Model {
        let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let [a, b, c, d] =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
        let given = Triangles::new(&[[a, b, c], [a, c, d]]);
        let surface = Arc::new(Surface::try_from(given).expect("two triangles"));
        let mut b = Builder::new(false, RigidInertia::ZERO);
        b.shape(LinkId(0), Shape::Surface { surface }, Pose::IDENTITY);
        b.model.roots[0].position.x = x;
        b.model
    }

    /// To join two meshes of 100,000 triangles takes 67 ms, which each change of a parameter before
    /// the start did again.
    #[test]
    fn terrain_is_joined_once_as_long_as_it_stands_where_it_stood() {
        let mut b = Builder::new(true, inertia(1.0, Vec3::zeros(), [0.1; 3]));
        b.shape(LinkId(0), Shape::Sphere { radius: 0.1 }, Pose::IDENTITY);
        let mut model = b.model;
        model.join(square(0.0), "one", RootKind::Object);
        model.join(square(2.0), "other", RootKind::Object);
        model.world.ground = None;
        let mut parameters = Parameters::new(&model);
        let mut tree = Tree::new(&model, &parameters);
        let mut renew = |slot, value| {
            let solids = |tree: &Tree| -> Vec<_> {
                let solids = tree.contact.colliders.iter().map(|c| c.solid.clone());
                solids.map(|solid| solid.expect("a shape")).collect()
            };
            let before = solids(&tree);
            parameters.set(slot, value);
            tree.renew(&model, &parameters);
            let after = solids(&tree);
            let mut both = before.iter().zip(&after);
            both.all(|(before, after)| Arc::ptr_eq(before, after))
        };
        assert!(renew(ParameterSlot::LinkMass(LinkId(0)), 2.0));
        let away = ParameterSlot::InitialBasePosition(RootId(2), 0);
        assert!(!renew(away, 3.0), "a seam that is none any more");
        assert!(renew(ParameterSlot::LinkMass(LinkId(0)), 3.0));
    }
}
