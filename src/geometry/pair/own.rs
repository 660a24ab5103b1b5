//! With which points a shape may lie on triangles of a mesh, and which crests are far from it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::core::{Core, Round};
use super::placed::Placed;
use super::points::{PatchPoint, Rim, Side, point};
use super::trace::{STANDING, Trace};
use crate::geometry::MOST_CORNERS;
use crate::geometry::surface::{Crest, Facet};
use crate::spatial::Vec3;

/// A point with which a shape may lie on a plane.
#[derive(Clone, Copy, Debug, Default)]
struct OwnPoint {
    x: Vec3,
    /// Of a hull not this one, but that of its faces.
    share: f64,
    /// What must be over a triangle for the point to lie on it: of what is round its axis, of what
    /// has edges the corner of its core. Where that leaves the triangle the crest of its edge
    /// begins to act, which the core comes nearest to in the direction of the normal there.
    over: Vec3,
    /// The middle of the flat end of a cylinder that stands.
    end: Option<Vec3>,
    /// The centre of a ball, or that of the end of a capsule.
    middle: Option<Vec3>,
    rim: Option<Rim>,
}

/// With which points a shape may lie on planes of one normal: triangles of even ground have the
/// same one.
#[derive(Clone, Debug)]
pub(super) struct OwnPoints {
    list: Box<[OwnPoint]>,
    count: usize,
    normal: Option<Vec3>,
    /// Whether the corners have been found.
    placed: bool,
}

impl Default for OwnPoints {
    fn default() -> Self {
        Self {
            list: vec![OwnPoint::default(); MOST_CORNERS].into(),
            count: 0,
            normal: None,
            placed: false,
        }
    }
}

impl OwnPoints {
    /// Knows nothing of a shape.
    pub(super) fn clear(&mut self) {
        (self.count, self.normal, self.placed) = (0, None, false);
    }

    /// Calls `take` with the points of a shape that are over a triangle, nearer than `reach`, m;
    /// with whether that is only the middle of an end, and the place that is over it.
    pub(super) fn each_on(
        &mut self,
        shape: &Placed,
        facet: &Facet,
        reach: f64,
        mut take: impl FnMut(usize, PatchPoint, bool, &Vec3),
    ) {
        let n = &facet.normal;
        self.update(shape, n);
        // Many corners of a hull are over no triangle: their shares are not asked for.
        let has_shares = matches!(shape.core, Core::Corners(_));
        for (own, p) in self.list[..self.count].iter().enumerate() {
            let depth = -facet.height(&p.x);
            if depth <= -reach {
                continue;
            }
            let carries =
                |over: &Vec3| facet.carries_over(over, || slack_of(shape, facet, over, depth));
            let over = carries(&p.over);
            let place = if over {
                Some(&p.over)
            } else {
                p.end.as_ref().filter(|end| carries(end))
            };
            if let Some(place) = place {
                let share = if has_shares {
                    shape.solid.shares.share(own, &shape.R.tr_mul(&-n))
                } else {
                    p.share
                };
                let halfway = point(p.x + n * (0.5 * depth), depth, share);
                take(
                    own,
                    PatchPoint {
                        rim: p.rim,
                        ..halfway
                    },
                    !over,
                    place,
                );
            }
        }
    }

    /// See `OwnPoint::middle`.
    pub(super) fn middle(&self, own: usize) -> Option<Vec3> {
        self.list[own].middle
    }

    /// Where the points of a shape are for a normal, and what must be over a triangle for each.
    pub(super) fn places(
        &mut self,
        shape: &Placed,
        n: &Vec3,
    ) -> impl Iterator<Item = (&Vec3, &Vec3)> {
        self.update(shape, n);
        self.list[..self.count]
            .iter()
            .map(|own| (&own.x, &own.over))
    }

    /// Finds the points for a normal, if they are those of another one.
    fn update(&mut self, shape: &Placed, n: &Vec3) {
        if self.normal != Some(*n) {
            self.find(shape, n);
            self.normal = Some(*n);
        }
    }

    /// Finds the points for a normal.
    fn find(&mut self, shape: &Placed, n: &Vec3) {
        let Self {
            list,
            count,
            placed,
            ..
        } = self;
        if let Some(round) = &shape.solid.round {
            let trace = Trace::new(shape, round, n, Side::First);
            let r = shape.solid.radius;
            let core = Round {
                radius: round.radius - r,
                half: round.half - r,
                ..*round
            };
            let within = Trace::new(shape, &core, n, Side::First);
            for (own, s) in list.iter_mut().zip([1.0, -1.0]) {
                let (x, over, rim) = if round.flat {
                    let (x, rim) = trace.end(s);
                    (x, within.end(s).0, rim)
                } else {
                    let c = shape.p + shape.axis() * (s * round.half);
                    (c - n * round.radius, c, None)
                };
                let end = shape.p + shape.axis() * (s * round.half);
                let stands = round.flat && n.dot(&shape.axis()).abs() > STANDING;
                *own = OwnPoint {
                    x,
                    share: 0.5,
                    over,
                    end: stands.then_some(end),
                    middle: (!round.flat).then_some(end),
                    rim,
                };
            }
            *count = 2;
            return;
        }
        if let Core::Point = shape.core {
            list[0] = OwnPoint {
                x: shape.p - n * shape.solid.radius,
                share: 1.0,
                over: shape.p,
                end: None,
                middle: Some(shape.p),
                rim: None,
            };
            *count = 1;
            return;
        }
        let corners = &shape.solid.mesh.corners;
        if !*placed {
            let inside = &shape.solid.core_corners;
            for (own, (corner, inside)) in list.iter_mut().zip(corners.iter().zip(inside)) {
                *own = OwnPoint {
                    x: shape.world(corner),
                    share: 0.25,
                    over: shape.world(inside),
                    end: None,
                    middle: None,
                    rim: None,
                };
            }
            (*count, *placed) = (corners.len().min(MOST_CORNERS), true);
        }
    }
}

/// How far beyond a hollow edge a triangle is continued below a point that is so deep behind its
/// plane, m. A ball is deep behind the plane of a wall that it is far above, too: it lies on what
/// goes on there no farther than it overlaps with the triangle itself.
fn slack_of(shape: &Placed, facet: &Facet, over: &Vec3, depth: f64) -> f64 {
    match shape.core {
        Core::Point | Core::Segment { .. } => shape.solid.radius - facet.apart(over).norm(),
        _ => depth.max(0.0) + shape.solid.rounding(),
    }
}

/// Whether a shape is certainly farther than `reach`, m, from an edge: its distance is at least the
/// gap along any direction. Asked are that from the nearest place of the edge to the middle of the
/// shape, `apart`, and that in which the edge pushes.
pub(super) fn is_far(shape: &Placed, crest: &Crest, apart: &Vec3, reach: f64) -> bool {
    let [a, b] = &crest.ends;
    let gap = |d: &Vec3| {
        let low = d.dot(&shape.support(&-d)) - d.dot(a).max(d.dot(b));
        low - (shape.solid.radius + reach) * d.norm()
    };
    let distance = apart.norm();
    distance > shape.solid.reach + reach
        || gap(&(crest.sides[0] + crest.sides[1])) > 0.0
        || gap(apart) > 0.0
}
