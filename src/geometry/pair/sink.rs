//! Where points of a shape on terrain go.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::placed::Placed;
use super::points::{PatchPoint, Points};
use super::shut::Among;
use crate::spatial::Vec3;
use crate::tuning::EVEN_EDGE;

/// Where points go, given in the axes of the terrain.
pub(super) struct Sink<'a> {
    ground: &'a Placed<'a>,
    /// Gap from which on a point is left out, m.
    pub(super) reach: f64,
    points: &'a mut Points,
    others: Option<&'a Among<'a>>,
}

impl<'a> Sink<'a> {
    /// Into `points`, those on the terrain `ground` that are nearer than `reach`, m; `others`: what
    /// stands beside it.
    pub(super) fn new(
        ground: &'a Placed<'a>,
        reach: f64,
        points: &'a mut Points,
        others: Option<&'a Among<'a>>,
    ) -> Self {
        Self {
            ground,
            reach,
            points,
            others,
        }
    }

    /// Whether something stands against one side of an edge at a place of it and goes on level with
    /// the other one, so that there is no edge; `sides`: unit normals.
    pub(super) fn goes_on(&self, x: &Vec3, sides: &[Vec3; 2]) -> bool {
        self.others.is_some_and(|others| {
            let sides = sides.map(|n| self.ground.R * n);
            others.go_on(&self.ground.world(x), &sides)
        })
    }

    /// Adds a point with the normal `n`.
    pub(super) fn add(&mut self, n: &Vec3, found: PatchPoint) {
        if found.depth <= -self.reach {
            return;
        }
        let R = &self.ground.R;
        let mut placed = PatchPoint {
            x: self.ground.world(&found.x),
            normal: R * n,
            part: part_of(n),
            ..found
        };
        if let Some(rim) = &mut placed.rim {
            rim.center = self.ground.world(&rim.center);
            (rim.axis, rim.a) = (R * rim.axis, R * rim.a);
        }
        self.points.add_deeper(placed);
    }
}

/// Which patch a normal belongs to: on the edge between two of them, where walls at 45° lie, to one
/// whatever round-off says.
fn part_of(n: &Vec3) -> usize {
    let side = n.x.abs().max(n.y.abs());
    if n.z.abs() > side - EVEN_EDGE {
        if n.z >= 0.0 { 0 } else { 5 }
    } else if n.x.abs() > n.y.abs() - EVEN_EDGE {
        if n.x > 0.0 { 1 } else { 2 }
    } else if n.y > 0.0 {
        3
    } else {
        4
    }
}
