//! How many contacts the shapes of a world have, and where these are remembered.

use super::{LinkId, Model};
use crate::geometry::PAIR_POINTS;

impl Model {
    /// Most contacts at a time, and most contact points of all together.
    pub fn contact_room(&self) -> [usize; 2] {
        let points: usize = self.colliders.iter().map(|c| c.shape.points()).sum();
        let (shapes, pairs) = (self.colliders.len(), self.pair_room());
        [shapes + pairs, points + PAIR_POINTS * pairs]
    }

    /// Whether shapes may touch each other.
    pub fn has_pairs(&self) -> bool {
        self.roots.len() > 1 || self.roots.iter().any(|root| root.self_collision)
    }

    /// Most contacts between two shapes at a time.
    fn pair_room(&self) -> usize {
        let shapes = self.colliders.len();
        if !self.has_pairs() {
            return 0;
        }
        (4 * shapes + 64).min(shapes * shapes.saturating_sub(1) / 2)
    }

    /// How many slots the memory of contacts has: one for each shape with the ground, then one for
    /// each pair of shapes `(a, b)` with `a < b`, at `shapes · (1 + a) + b`.
    pub fn slots(&self) -> usize {
        let shapes = self.colliders.len();
        let others = if self.has_pairs() { shapes } else { 0 };
        shapes * (1 + others)
    }

    /// The links of the shapes whose contact has a slot, that of the lower index first; none for
    /// the ground.
    pub fn links_of(&self, slot: usize) -> [Option<LinkId>; 2] {
        self.shapes_of(slot)
            .map(|shape| Some(self.colliders.get(shape?)?.link))
    }

    /// The shapes whose contact has a slot.
    fn shapes_of(&self, slot: usize) -> [Option<usize>; 2] {
        match self.colliders.len() {
            0 => [None; 2],
            shapes if slot < shapes => [Some(slot), None],
            shapes => [Some(slot / shapes - 1), Some(slot % shapes)],
        }
    }

    /// The trees of the shapes whose contact has a slot; one with the ground.
    pub fn touches_of(&self, slot: usize) -> [Option<usize>; 2] {
        self.shapes_of(slot).map(|shape| {
            let collider = self.colliders.get(shape?)?;
            Some(self.root_of(collider.body).index())
        })
    }
}
