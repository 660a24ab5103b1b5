//! Triangles of a mesh and their edges.

use crate::spatial::Vec3;
use crate::tuning::SEAM;

/// How the surface goes on beyond an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// In the same plane.
    Even,
    /// In the same plane, but the triangle there has other corners.
    Seam,
    /// Upwards.
    Hollow,
    /// Downwards, or not at all.
    Crest,
}

/// A triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// m
    pub corners: [Vec3; 3],
    /// Unit vector outwards.
    pub normal: Vec3,
    /// Unit vectors from each edge, that from a corner to the next, into the triangle.
    pub inward: [Vec3; 3],
    /// Beyond the edge from each corner to the next.
    pub beyond: [Beyond; 3],
    /// The crests that belong to it: each belongs to one of its triangles.
    pub crests: [Option<usize>; 3],
}

/// An edge that a shape can lie on.
#[derive(Clone, Debug, PartialEq)]
pub struct Crest {
    /// m
    pub ends: [Vec3; 2],
    /// m
    pub middle: Vec3,
    /// m
    pub half_length: f64,
    /// Unit vector.
    pub along: Vec3,
    /// Between these, unit vectors, lie the directions in which it pushes.
    pub sides: [Vec3; 2],
    /// Whether the surface ends there: nothing is behind it.
    pub is_free: bool,
}

impl Crest {
    pub(super) fn new(ends: [Vec3; 2], sides: [Vec3; 2]) -> Self {
        let [a, b] = ends;
        let half = (b - a) * 0.5;
        let half_length = half.norm();
        Self {
            ends,
            middle: (a + b) * 0.5,
            half_length,
            along: half / half_length,
            sides,
            is_free: false,
        }
    }
}

impl Crest {
    /// From its nearest place to a point.
    pub fn apart(&self, p: &Vec3) -> Vec3 {
        let from = p - self.middle;
        let place = self
            .along
            .dot(&from)
            .clamp(-self.half_length, self.half_length);
        from - self.along * place
    }
}

/// Along the normal of a triangle; its length is twice the area, m².
pub(super) fn area_of([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

impl Facet {
    /// A triangle without neighbours.
    pub(super) fn new(corners: [Vec3; 3]) -> Self {
        let normal = area_of(corners).try_normalize(0.0).unwrap_or_else(Vec3::z);
        let inward = [0, 1, 2].map(|edge: usize| {
            let along = corners[(edge + 1) % 3] - corners[edge];
            let across = normal.cross(&along);
            across.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
        });
        Self {
            corners,
            normal,
            inward,
            beyond: [Beyond::Crest; 3],
            crests: [None; 3],
        }
    }

    /// How far a point is inside of each edge, m; negative beyond it.
    pub(super) fn inside(&self, x: &Vec3, edge: usize) -> f64 {
        let (a, b) = (self.corners[edge], self.corners[(edge + 1) % 3]);
        // From the lower corner: both triangles of an edge find the same number.
        let from = if lower(&a, &b) { a } else { b };
        self.inward[edge].dot(&(x - from))
    }

    /// Whether a point lies on the triangle, as exactly as seams are known.
    pub(super) fn carries(&self, x: &Vec3) -> bool {
        self.height(x).abs() <= SEAM && (0..3).all(|edge| self.inside(x, edge) >= -0.5 * SEAM)
    }

    /// The part of a segment, from 0 to 1, that lies on the triangle, as exactly as seams are
    /// known.
    pub(super) fn carried(&self, [a, b]: [Vec3; 2]) -> Option<[f64; 2]> {
        let mut part = [0.0_f64, 1.0_f64];
        for edge in 0..3 {
            let [from, to] = [a, b].map(|x| self.inside(&x, edge) + 0.5 * SEAM);
            if from < 0.0 && to < 0.0 {
                return None;
            }
            let crossed = from / (from - to);
            if from < 0.0 {
                part[0] = part[0].max(crossed);
            } else if to < 0.0 {
                part[1] = part[1].min(crossed);
            }
        }
        let on = |t: f64| self.height(&(a + (b - a) * t)).abs() <= SEAM;
        (part[0] < part[1] && part.into_iter().all(on)).then_some(part)
    }

    /// Whether no point of a ball is over the triangle and its plane, but for what lies beyond
    /// hollow edges.
    pub fn is_beside(&self, center: &Vec3, radius: f64) -> bool {
        (0..3)
            .any(|edge| self.beyond[edge] != Beyond::Hollow && self.inside(center, edge) < -radius)
    }

    /// Whether a point is over the triangle; beyond hollow edges by up to `slack`, m. Of two even
    /// triangles a point on their edge is over one.
    pub fn is_below(&self, x: &Vec3, slack: f64) -> bool {
        (0..3).all(|edge| match self.beyond[edge] {
            Beyond::Hollow => self.inside(x, edge) >= -slack,
            _ => self.is_inside(x, edge),
        })
    }

    /// Whether a point is over the triangle itself. Of two triangles a point on their edge is over
    /// one, but where the other one has other corners.
    pub fn is_over(&self, x: &Vec3) -> bool {
        (0..3).all(|edge| self.is_inside(x, edge))
    }

    /// Whether a point is inside of an edge that is not hollow.
    fn is_inside(&self, x: &Vec3, edge: usize) -> bool {
        let inside = self.inside(x, edge);
        match self.beyond[edge] {
            Beyond::Seam => inside >= -SEAM,
            _ if inside == 0.0 => lower(&self.corners[edge], &self.corners[(edge + 1) % 3]),
            _ => inside > 0.0,
        }
    }

    /// Whether a point is over the triangle or no farther than `slack`, m, beside it, beyond hollow
    /// edges alone. What goes on beyond an edge ends where the edge does: above the corner at which
    /// two walls of a hole and the floor meet is neither wall.
    pub fn carries_over(&self, x: &Vec3, slack: impl FnOnce() -> f64) -> bool {
        if !self.is_below(x, f64::INFINITY) {
            return false;
        }
        let is_beyond =
            |edge: usize| self.beyond[edge] == Beyond::Hollow && self.inside(x, edge) < 0.0;
        !(0..3).any(is_beyond) || {
            let beside = self.apart(&(x - self.normal * self.height(x)));
            beside.norm() <= slack()
        }
    }

    /// Whether a place within `way`, m, of a point may be over the triangle, beyond hollow edges
    /// by up to `slack`, m, see [`Self::is_below`].
    pub fn may_be_below(&self, x: &Vec3, slack: f64, way: f64) -> bool {
        (0..3).all(|edge| {
            let beyond = match self.beyond[edge] {
                Beyond::Hollow => slack,
                _ => SEAM,
            };
            self.inside(x, edge) >= -(beyond + way)
        })
    }

    /// Height of a point over its plane, m.
    pub fn height(&self, x: &Vec3) -> f64 {
        self.normal.dot(&(x - self.corners[0]))
    }

    /// From its nearest place to a point.
    pub fn apart(&self, x: &Vec3) -> Vec3 {
        if (0..3).all(|edge| self.inside(x, edge) >= 0.0) {
            return self.normal * self.height(x);
        }
        let from = |edge: usize| {
            let [a, b] = self.ends(edge);
            let (along, from) = (b - a, x - a);
            let place = along.dot(&from) / along.norm_squared();
            from - along * place.clamp(0.0, 1.0)
        };
        let shorter = |a: Vec3, b: Vec3| if b.norm() < a.norm() { b } else { a };
        shorter(shorter(from(0), from(1)), from(2))
    }

    /// Both ends of an edge.
    pub(super) fn ends(&self, edge: usize) -> [Vec3; 2] {
        [self.corners[edge], self.corners[(edge + 1) % 3]]
    }

    /// Out of the triangle, across an edge and in its plane.
    pub(super) fn away(&self, edge: usize) -> Vec3 {
        -self.inward[edge]
    }

    /// Its middle.
    pub fn middle(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (a + b + c) / 3.0
    }
}

/// An order of points.
pub(super) fn lower(a: &Vec3, b: &Vec3) -> bool {
    (a.x, a.y, a.z) < (b.x, b.y, b.z)
}
