//! How many contacts the shapes of a world have, and where these are remembered.

use super::{LinkId, Model};
use crate::geometry::PAIR_POINTS;
use crate::geometry::pair::MOST_PARTS;

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

    /// How many slots the memory of contacts has: one for each shape with the ground, then
    /// [`MOST_PARTS`] for each pair of shapes `(a, b)` with `a < b`, from
    /// `shapes + (shapes · a + b) · MOST_PARTS` on.
    pub fn slots(&self) -> usize {
        let shapes = self.colliders.len();
        let others = if self.has_pairs() { shapes } else { 0 };
        shapes * (1 + others * MOST_PARTS)
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
            shapes => {
                let pair = (slot - shapes) / MOST_PARTS;
                [Some(pair / shapes), Some(pair % shapes)]
            }
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
