//! Points of a shape on terrain, and into which patches they fall.
//!
//! Terrain has many normals. Those about the same direction belong together: one patch each for
//! what lies on the ground, leans against one of four walls, or touches a ceiling, each with a
//! friction of its own. The largest component of the normal, in the axes of the terrain, decides; a
//! slope of 45° counts as ground.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Core;
use super::meet::Meeting;
use super::nearby::Nearby;
use super::placed::Placed;
use super::points::Points;
use super::shut::Among;
use super::sink::Sink;
use super::{field, surface};
use crate::spatial::Vec3;
use std::ops::Range;

/// Most patches of a shape with terrain.
pub const MOST_PARTS: usize = 6;

/// Points that belong together.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// Which of the directions, 0 for upwards.
    pub index: usize,
    /// Unit vector into the first shape; of points with normals of their own that of the deepest.
    pub normal: Vec3,
    /// Whether its points have normals of their own.
    pub uneven: bool,
    /// Its points in those of the patch.
    pub points: Range<usize>,
}

/// Adds the points of `a` on the terrain `b`, if it is uneven; `others`: what stands beside it.
pub(super) fn on_terrain(
    (a, b): (&Placed, &Placed),
    others: Option<&Among>,
    reach: f64,
    (meeting, scratch): (&mut Meeting, &mut surface::Scratch),
    nearby: Option<&mut Nearby>,
    points: &mut Points,
) {
    let own = Placed {
        R: b.R.transpose() * a.R,
        p: b.R.tr_mul(&(a.p - b.p)),
        ..*a
    };
    let mut sink = Sink::new(b, reach, points, others);
    match b.core {
        Core::Field(field) => field::on_field(&own, field, &mut sink),
        Core::Surface(surface) => {
            surface::on_surface(&own, surface, (meeting, scratch), nearby, &mut sink);
        }
        _ => {}
    }
}

/// Puts points of one patch after each other, and lists the patches.
pub(super) fn parts(points: &mut Points, parts: &mut [Part; MOST_PARTS]) -> usize {
    let list = points.all();
    // Points of a patch stay in their order: what the standard library does with equals depends on
    // how it has been built, and results do on the order of points.
    for last in 1..list.len() {
        let mut at = last;
        while at > 0 && list[at - 1].part > list[at].part {
            list.swap(at - 1, at);
            at -= 1;
        }
    }
    let mut count = 0;
    let mut first = 0;
    while first < list.len() {
        let index = list[first].part;
        let own = list[first..].iter().take_while(|p| p.part == index).count();
        let all = &list[first..first + own];
        let deepest = all.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        let normal = deepest.map_or_else(Vec3::z, |p| p.normal);
        parts[count] = Part {
            index,
            normal,
            uneven: all.iter().any(|p| p.normal != normal),
            points: first..first + own,
        };
        count += 1;
        first += own;
    }
    count
}
