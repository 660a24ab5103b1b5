//! What of a mesh a shape may lie on wherever it goes from where it is, as far as that is not far.
//!
//! A step looks at a pair several times, and a shape moves by little between two looks. What is
//! left out here could have no part in any of them, and what is kept is tested as it is without
//! this memory: a look finds the same bits whatever is remembered.
//!
//! The ways that are compared are those by which any point of a shape moves, at most. A shape that
//! is round moves by as much as its axis does. The lowest point of a rim goes farther: it is
//! `R (k·n) k'/|k'| − R |k'| n` from the middle of the rim, with the axis `k` and what of it is
//! along the plane, `k' = k − (k·n) n`. Where `|k'| ≥ ½`, it moves by less than `4 R |Δk|`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::Core;
use super::own::{OwnPoints, is_far};
use super::placed::Placed;
use crate::geometry::surface::{Facet, Surface};
use crate::spatial::{Mat3, Vec3};
use crate::tuning::CROWN;

/// How far a shape may go before it is looked for anew, as a share of its size, if it is not twice
/// as fast. With more, what is kept is more; with less, it is looked for more often.
const AHEAD: f64 = 0.125;

/// Most triangles that are kept; with more around, none are.
const MOST: usize = 128;

/// By how much a point of a shape may move when its axis turns, in terms of the shape's size and of
/// the change of the axis: 4 for the lowest point of a rim, and 1 for its middle.
const TURN: f64 = 5.0;

/// A triangle that may have a part.
#[derive(Clone, Copy, Debug, Default)]
struct Candidate {
    /// Of the tree of boxes.
    leaf: u32,
    facet: u32,
    part: Parts,
}

/// Which parts of a triangle may carry a shape.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts {
    /// Itself.
    pub(super) face: bool,
    /// The crests that belong to it.
    pub(super) crests: [bool; 3],
}

impl Parts {
    /// All of them.
    pub(super) const ALL: Self = Self {
        face: true,
        crests: [true; 3],
    };
}

/// What of a mesh a shape may lie on.
#[derive(Clone, Debug)]
pub struct Nearby {
    /// In the order in which a search finds them.
    list: Box<[Candidate; MOST]>,
    /// How many there are; none if there is no room for all.
    count: Option<usize>,
    /// Where the shape was in the axes of the mesh, and how far it was looked, m.
    R: Mat3,
    p: Vec3,
    reach: f64,
    /// How far it may go, m; negative where nothing is known.
    way: f64,
}

impl Nearby {
    /// Room for one shape on one mesh.
    pub fn new() -> Self {
        Self {
            list: Box::new([Candidate::default(); MOST]),
            count: None,
            R: Mat3::identity(),
            p: Vec3::zeros(),
            reach: 0.0,
            way: -1.0,
        }
    }

    /// Knows nothing.
    pub fn forget(&mut self) {
        self.way = -1.0;
    }

    /// Whether it still holds for a shape.
    fn holds(&self, shape: &Placed, reach: f64) -> bool {
        let turned = match (&shape.solid.round, shape.core) {
            (Some(_), _) => TURN * (shape.axis() - self.R.column(2)).norm(),
            (None, Core::Point) => 0.0,
            _ => (shape.R - self.R).norm(),
        };
        let moved = (shape.p - self.p).norm() + turned * shape.solid.reach;
        moved + (reach - self.reach).max(0.0) <= self.way
    }

    /// Calls `take` with the triangles that may have a part in what a shape has in common with a
    /// mesh within `reach`, m.
    pub(super) fn each<'a>(
        &mut self,
        (shape, surface): (&Placed, &'a Surface),
        own: &mut OwnPoints,
        reach: f64,
        mut take: impl FnMut(&mut OwnPoints, usize, &'a Facet, Parts),
    ) {
        let around = shape.solid.reach + reach;
        if !self.holds(shape, reach) {
            self.find((shape, surface), own, reach);
        }
        let Some(count) = self.count else {
            surface.each_near(&shape.p, around, |index, facet| {
                take(own, index, facet, Parts::ALL);
            });
            return;
        };
        let mut last = (u32::MAX, false);
        for candidate in &self.list[..count] {
            if candidate.leaf != last.0 {
                let near = surface.is_leaf_near(candidate.leaf as usize, &shape.p, around);
                last = (candidate.leaf, near);
            }
            if last.1 {
                let index = candidate.facet as usize;
                take(own, index, &surface.facets()[index], candidate.part);
            }
        }
    }

    /// Looks for what may have a part.
    fn find(&mut self, (shape, surface): (&Placed, &Surface), own: &mut OwnPoints, reach: f64) {
        let way = (AHEAD * shape.solid.reach).max(2.0 * reach);
        let search = Search {
            shape,
            surface,
            reach,
            // More than round-off can make of a way.
            way: way * (1.0 + 1e-6),
        };
        let around = shape.solid.reach + reach + search.way;
        let (list, mut count) = (&mut self.list, 0);
        let full = surface.any_leaf(&shape.p, around, |leaf| {
            for (index, facet) in surface.leaf(leaf) {
                let part = search.parts(own, facet);
                if !part.face && !part.crests.contains(&true) {
                    continue;
                }
                if count >= MOST {
                    return true;
                }
                let [Ok(leaf), Ok(facet)] = [leaf, index].map(u32::try_from) else {
                    return true;
                };
                list[count] = Candidate { leaf, facet, part };
                count += 1;
            }
            false
        });
        self.count = (!full).then_some(count);
        (self.R, self.p, self.reach, self.way) = (shape.R, shape.p, reach, way);
    }
}

impl Default for Nearby {
    fn default() -> Self {
        Self::new()
    }
}

/// What decides whether a triangle may have a part.
struct Search<'a> {
    shape: &'a Placed<'a>,
    surface: &'a Surface,
    reach: f64,
    way: f64,
}

impl Search<'_> {
    fn parts(&self, own: &mut OwnPoints, facet: &Facet) -> Parts {
        let near = |crest: &Option<usize>| {
            crest.is_some_and(|index| {
                let crest = self.surface.crest(index);
                let apart = crest.apart(&self.shape.p);
                let rounding = self.shape.solid.rounding();
                !is_far(self.shape, crest, &apart, self.reach + rounding + self.way)
            })
        };
        Parts {
            face: self.may_carry(own, facet),
            crests: facet.crests.each_ref().map(near),
        }
    }

    /// Whether a point of the shape may lie on a triangle.
    fn may_carry(&self, own: &mut OwnPoints, facet: &Facet) -> bool {
        let Self {
            shape, reach, way, ..
        } = self;
        let (solid, n) = (shape.solid, &facet.normal);
        let height = facet.height(&shape.p);
        let low = height - self.extent(n) - 2.0 * CROWN * solid.reach;
        if height <= -way
            || height > solid.reach + reach + way
            || low > reach + way
            || facet.is_beside(&shape.p, solid.reach + way)
        {
            return false;
        }
        if let Some(round) = &solid.round {
            let up = n.dot(&shape.axis());
            let along = (1.0 - up * up).max(0.0).sqrt();
            if round.flat && along - way / (TURN * solid.reach) < 0.5 {
                // The lowest point of a rim goes anywhere about it.
                return true;
            }
        }
        own.places(shape, n).any(|(x, over)| {
            let slack = (-facet.height(x)).max(0.0) + solid.rounding() + way;
            facet.may_be_below(over, slack, *way)
        })
    }

    /// How far the shape reaches along a direction, m.
    fn extent(&self, n: &Vec3) -> f64 {
        let (shape, solid) = (self.shape, self.shape.solid);
        if let Some(round) = &solid.round {
            let up = n.dot(&shape.axis());
            let across = if round.flat {
                (1.0 - up * up).max(0.0).sqrt()
            } else {
                1.0
            };
            return round.half * up.abs() + round.radius * across;
        }
        if let Core::Point = shape.core {
            return solid.radius;
        }
        let down = shape.R.tr_mul(&-n);
        let corners = solid.mesh.corners.iter().map(|corner| down.dot(corner));
        corners.fold(0.0, f64::max)
    }
}
