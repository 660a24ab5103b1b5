//! What pairs of shapes had in common where a step ended.
//!
//! The energy that a step leads to asks all pairs at its end for their depths, and the next step
//! begins there by asking them again, within a reach of its own. Which points are within a reach
//! does not change what they are, so all of them are kept. That only saves time: a pair that does
//! not stand exactly where it was is looked at anew.

use super::pair::Pair;
use crate::geometry::pair::{Patch, PatchPoint};
use crate::spatial::{Pose, Vec3};
use std::ops::Range;

/// Looks at pairs, by ascending places.
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    looks: Vec<Look>,
    points: Vec<PatchPoint>,
}

/// A look at a pair: where both were, and what it found at any reach.
#[derive(Clone, Debug)]
struct Look {
    places: [usize; 2],
    poses: [Pose; 2],
    normal: Vec3,
    share: f64,
    /// See [`Patch::blended`] and [`Patch::deep`].
    blended: [bool; 2],
    points: Range<usize>,
}

impl Kept {
    /// Room for as many pairs and points; what finds no room is not kept.
    pub fn new([pairs, points]: [usize; 2]) -> Self {
        Self {
            looks: Vec::with_capacity(pairs),
            points: Vec::with_capacity(points),
        }
    }

    /// Begins with nothing.
    pub fn clear(&mut self) {
        self.looks.clear();
        self.points.clear();
    }

    /// Finds what a pair has in common within `reach`, m, as [`Pair::touch`] does, and keeps all
    /// that is found. Pairs come by ascending places.
    pub fn touch(
        &mut self,
        places: [usize; 2],
        pair: &Pair,
        patch: &mut Patch,
        reach: f64,
    ) -> bool {
        let whole = pair.touch_whole(patch, reach);
        let found = patch.points();
        let first = self.points.len();
        let room = self.points.capacity() - first >= found.len()
            && self.looks.len() < self.looks.capacity();
        if whole && room {
            self.points.extend_from_slice(found);
            self.looks.push(Look {
                places,
                poses: *pair.poses(),
                normal: patch.normal,
                share: patch.share,
                blended: [patch.blended, patch.deep],
                points: first..self.points.len(),
            });
        }
        match patch.limit(reach) {
            Some(touch) => touch,
            None => pair.touch(patch, reach, None),
        }
    }

    /// The same of a pair that has been looked at where it stands; none of others.
    pub fn recall(
        &self,
        places: [usize; 2],
        pair: &Pair,
        patch: &mut Patch,
        reach: f64,
    ) -> Option<bool> {
        let at = self.looks.binary_search_by(|look| look.places.cmp(&places));
        let look = &self.looks[at.ok()?];
        if look.poses != *pair.poses() {
            return None;
        }
        patch.take(
            (&look.normal, look.share),
            look.blended,
            &self.points[look.points.clone()],
        );
        patch.limit(reach)
    }
}
