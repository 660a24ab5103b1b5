//! Which trees a step moves.
//!
//! Trees that cannot meet before the next communication point go there one after the other, each
//! with steps of its own. What a step works on are the bodies of some of the trees: those that it
//! moves, and the scenery, which never moves and may be met by all.

use super::parts::{Extent, Span, Tree, TreeBody, TreeCollider};
use crate::tuning::ARTICULATED_COST;
use std::ops::Range;

impl Tree {
    /// Takes the trees that `takes` names and the scenery, until others are named. Allocates
    /// nothing once all trees have been taken.
    pub fn select(&mut self, takes: impl Fn(usize) -> bool) {
        let Self {
            trees,
            island,
            sparsity,
            ..
        } = self;
        island.spans.clear();
        island.takes.clear();
        sparsity.worked.clear();
        let (mut lead, mut pure, mut cost, mut bodies) = (None, true, 0, 0);
        let mut open = true;
        for (index, tree) in trees.iter().enumerate() {
            let taken = !tree.moves() || takes(index);
            island.takes.push(taken);
            if !taken {
                continue;
            }
            match island.spans.last_mut() {
                Some(span) if span.trees.end == index => {
                    span.trees.end = index + 1;
                    span.bodies.end = tree.bodies.end;
                    span.dofs.end = tree.dofs.end;
                    span.coordinates.end = tree.coordinates.end;
                }
                _ => island.spans.push(Span {
                    trees: index..index + 1,
                    bodies: tree.bodies.clone(),
                    dofs: tree.dofs.clone(),
                    coordinates: tree.coordinates.clone(),
                }),
            }
            if tree.moves() {
                lead = lead.or(Some(index));
                pure &= tree.pure;
                open &= !tree.closed;
                cost += sparsity.factor_cost(index);
                bodies += tree.bodies.len();
                sparsity.worked.push(index);
            }
        }
        island.lead = lead.unwrap_or_default();
        self.pure = pure;
        island.closed = !open;
        self.long = pure && open && cost > ARTICULATED_COST * bodies;
    }

    /// Takes all trees.
    pub fn select_all(&mut self) {
        self.select(|_| true);
    }

    /// Whether a step works on closed loops.
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.island.closed
    }

    /// Whether a step moves the tree, or it is scenery.
    #[inline]
    pub fn takes(&self, tree: usize) -> bool {
        self.island.takes[tree]
    }

    /// The trees that a step moves, with their indices.
    pub fn moved(&self) -> impl Iterator<Item = (usize, &Extent)> + '_ {
        let trees = self.trees.iter().enumerate();
        trees.filter(|(index, tree)| self.takes(*index) && tree.moves())
    }

    /// Mass of all bodies that a step moves, kg.
    pub fn moving_mass(&self) -> f64 {
        self.moved().map(|(_, tree)| tree.moving_mass).sum()
    }

    /// The bodies of a span, with their indices, parents before children.
    #[inline]
    pub fn bodies_of(
        &self,
        span: &Span,
    ) -> impl DoubleEndedIterator<Item = (usize, &TreeBody)> + use<'_> {
        span.bodies.clone().zip(&self.bodies[span.bodies.clone()])
    }

    /// All bodies that a step works on, with their indices, parents before children.
    pub fn worked_bodies(&self) -> impl DoubleEndedIterator<Item = (usize, &TreeBody)> + '_ {
        self.island
            .spans
            .iter()
            .flat_map(|span| self.bodies_of(span))
    }

    /// Places in `v` that a step works on.
    pub fn worked_dofs(&self) -> impl Iterator<Item = usize> + '_ {
        self.island.spans.iter().flat_map(|span| span.dofs.clone())
    }

    /// The same, by the vectors whose components they are: what depends on all components of one
    /// together does not depend on the direction of the world's axes.
    pub fn worked_vectors(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let vectors = self.worked_dofs().map(|k| k..k + self.dofs.components[k]);
        vectors.filter(|vector| !vector.is_empty())
    }

    /// The longest of the vectors with these components, of several fields of them, weighted;
    /// infinite if one is no number.
    pub fn longest<const N: usize>(&self, components: impl Fn(usize) -> [f64; N]) -> f64 {
        let mut longest: f64 = 0.0;
        for vector in self.worked_vectors() {
            let weight = self.dofs.weight[vector.start];
            let mut squares = [0.0; N];
            for k in vector {
                for (sum, x) in squares.iter_mut().zip(components(k)) {
                    *sum += x * x;
                }
            }
            for sum in squares {
                // `f64::max` would drop a NaN.
                if sum.is_nan() {
                    return f64::INFINITY;
                }
                longest = longest.max(weight * weight * sum);
            }
        }
        longest.sqrt()
    }

    /// Shapes of the trees that a step works on, with their places among all.
    pub fn worked_colliders(&self) -> impl Iterator<Item = (usize, &TreeCollider)> + '_ {
        let colliders = self.contact.colliders.iter().enumerate();
        colliders.filter(|(_, collider)| self.takes(collider.tree))
    }

    /// Those of them that are no scenery, or terrain, by ascending places.
    pub fn worked_movers(&self) -> impl Iterator<Item = (usize, &TreeCollider)> + '_ {
        let movers = self.contact.scenery.movers.iter();
        let colliders = movers.map(|&place| (place, &self.contact.colliders[place]));
        colliders.filter(|(_, collider)| self.takes(collider.tree))
    }

    /// Copies what a step works on of positions.
    pub fn copy_positions(&self, from: &[f64], to: &mut [f64]) {
        for span in &self.island.spans {
            let places = span.coordinates.clone();
            to[places.clone()].copy_from_slice(&from[places]);
        }
    }

    /// The same of what has one number for each degree of freedom.
    pub fn copy_velocities(&self, from: &[f64], to: &mut [f64]) {
        for span in &self.island.spans {
            let places = span.dofs.clone();
            to[places.clone()].copy_from_slice(&from[places]);
        }
    }

    /// Clears what a step works on of what has one number for each degree of freedom.
    pub fn clear_velocities(&self, v: &mut [f64]) {
        for span in &self.island.spans {
            v[span.dofs.clone()].fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Motion;
    use crate::parameters::Parameters;
    use crate::spatial::{Pose, RigidInertia, Vec3};
    use crate::testing::{Builder, inertia};
    use crate::tree::Tree;

    /// The cost of the mass matrix and its factor grows with the cube of the length of a chain,
    /// that of the articulated-body algorithm with its length: the one is for arms, the other for
    /// ropes.
    #[test]
    fn ropes_are_taken_by_articulated_bodies_and_arms_by_their_mass_matrix() {
        for (count, long) in [(1, false), (7, false), (100, true), (300, true)] {
            let mut b = Builder::new(false, RigidInertia::ZERO);
            for parent in 0..count {
                let rod = inertia(1.0, Vec3::x(), [0.1; 3]);
                let axis = Motion::Revolute(Vec3::y());
                b.link(parent.into(), Pose::IDENTITY, axis, rod);
            }
            let tree = Tree::new(&b.model, &Parameters::new(&b.model));
            assert_eq!(tree.long, long, "{count} bodies");
        }
    }
}
