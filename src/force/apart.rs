//! Directions along which pairs of shapes were apart when they were looked at last.
//!
//! The shapes of a robot that lie beside each other and do not touch are looked at in every step.
//! Along the direction in which they were farthest apart they mostly still are, which two support
//! points show, where the search for their nearest points takes ten times as many. That only saves
//! time: a pair that a direction holds apart by more than is asked for has nothing in common.

use super::pair::Pair;
use crate::geometry::pair::Patch;
use crate::spatial::Vec3;

/// One direction for each pair of shapes.
#[derive(Clone, Debug, Default)]
pub(super) struct Apart {
    /// In the axes of the shape that is the first one of its pair; 0 where none is known.
    directions: Vec<Vec3>,
}

impl Apart {
    /// Room for all pairs.
    pub fn new(shapes: usize) -> Self {
        Self {
            directions: vec![Vec3::zeros(); shapes * shapes.saturating_sub(1) / 2],
        }
    }

    /// Finds what a pair has in common within `reach`, m, by `look`, as [`Pair::touch`] does,
    /// unless it is known to be apart. Places: the lower one first.
    pub fn touch(
        &mut self,
        [a, b]: [usize; 2],
        (pair, patch): (&Pair, &mut Patch),
        reach: f64,
        look: impl FnOnce(&mut Patch) -> bool,
    ) -> bool {
        let known = &mut self.directions[b * (b - 1) / 2 + a];
        if *known != Vec3::zeros() && pair.is_apart_along(known, reach) {
            return false;
        }
        let touch = look(patch);
        if !touch {
            *known = pair.seen_from_first(&patch.normal);
        }
        touch
    }
}
