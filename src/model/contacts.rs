//! How many contacts the shapes of a world have, and where these are remembered.

use super::Model;
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

    /// The trees of the shapes whose contact has a slot; one with the ground.
    pub fn touches_of(&self, slot: usize) -> [Option<usize>; 2] {
        let tree = |shape: usize| {
            let collider = self.colliders.get(shape)?;
            Some(self.root_of(collider.body).index())
        };
        match self.colliders.len() {
            0 => [None; 2],
            shapes if slot < shapes => [tree(slot), None],
            shapes => [tree(slot / shapes - 1), tree(slot % shapes)],
        }
    }
}
