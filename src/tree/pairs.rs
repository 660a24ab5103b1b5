//! Which shapes may touch each other.

use super::parts::{Tree, TreeCollider};
use super::scenery::Scenery;
use crate::model::{LinkId, Model};
use std::collections::BTreeSet;

impl Tree {
    /// Whether each pair of colliders may touch, see [`super::Contacts::pairs`].
    ///
    /// Shapes of different trees touch, and those of one tree if it is to touch itself. Shapes that
    /// never move against each other do not, nor do those of a body and the one that it hangs on:
    /// at a joint they overlap in most robots.
    pub(super) fn pairs(&self, model: &Model) -> Vec<bool> {
        let apart: BTreeSet<[LinkId; 2]> = model.apart.iter().copied().collect();
        let colliders = &self.contact.colliders;
        let bare = self.bare();
        let n = colliders.len();
        let mut pairs = vec![false; n * n];
        for (i, a) in colliders.iter().enumerate() {
            for (j, b) in colliders.iter().enumerate().skip(i + 1) {
                let links = [a.link.min(b.link), a.link.max(b.link)].map(LinkId::from);
                let meet = if a.tree == b.tree {
                    model.roots[a.tree].self_collision && self.is_between(&bare, a, b)
                } else {
                    a.yields || b.yields
                };
                let joined = self.is_closed_between([a.body, b.body]);
                pairs[i * n + j] = meet && !joined && !apart.contains(&links);
            }
        }
        pairs
    }

    /// Which shapes never move and end somewhere, of bases that stand still.
    pub(super) fn scenery(&self) -> Scenery {
        let (mut movers, mut still) = (Vec::new(), Vec::new());
        for (place, collider) in self.contact.colliders.iter().enumerate() {
            let solid = collider.solid.as_ref();
            if collider.moves || solid.is_some_and(|solid| solid.is_terrain()) {
                movers.push(place);
            } else {
                let center = self.trees[collider.tree].base.compose(&collider.X).p;
                still.push((place, collider.tree, center, collider.radius));
            }
        }
        Scenery::new(movers, still)
    }

    /// Whether two shapes of one tree belong to bodies that move against each other and do not meet
    /// at a joint.
    fn is_between(&self, bare: &[bool], a: &TreeCollider, b: &TreeCollider) -> bool {
        let hangs_on = |child: usize, parent: usize| {
            let mut body = self.bodies[child].parent;
            // A joint of several bodies, or several joints with nothing between them.
            while bare[body] && !self.bodies[body].kind.is_base() {
                body = self.bodies[body].parent;
            }
            body == parent
        };
        a.body != b.body && !hangs_on(a.body, b.body) && !hangs_on(b.body, a.body)
    }

    /// Bodies that have neither mass nor shape.
    fn bare(&self) -> Vec<bool> {
        let mut bare: Vec<bool> = self.bodies.iter().map(|body| body.mass <= 0.0).collect();
        for collider in &self.contact.colliders {
            bare[collider.body] = false;
        }
        bare
    }
}
