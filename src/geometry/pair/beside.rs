//! What stands beside a solid, and shuts its walls against what slides from one to the other.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::field::Field;
use crate::geometry::surface::Surface;
use crate::spatial::{Mat3, Pose, Vec3};
use std::sync::Arc;

/// Outward unit normal of a flat face, and how far it is from the origin along that, m.
pub type Face = (Vec3, f64);

/// A face in the axes in which its solid stands with the rotation `R` at `p`.
pub(super) fn face_at((n, height): Face, R: &Mat3, p: &Vec3) -> Face {
    let n = R * n;
    (n, height + n.dot(p))
}

/// What stands beside a solid, in the axes of that.
#[derive(Clone, Debug)]
pub enum Beside {
    /// A solid with these faces.
    Faces(Vec<Face>),
    /// Heights, as they stand.
    Field(Arc<Field>, Pose),
    /// A mesh, as it stands.
    Surface(Arc<Surface>, Pose),
}

impl Beside {
    /// Whether a place is inside, or not farther from it than `slack`, m.
    pub(super) fn holds(&self, x: &Vec3, slack: f64) -> bool {
        match self {
            Self::Faces(faces) => faces.iter().all(|(n, height)| n.dot(x) <= height + slack),
            Self::Field(field, X) => is_in(field, &X.inverse().point(x), slack),
            Self::Surface(surface, X) => is_on(surface, &X.inverse().point(x), slack),
        }
    }
}

impl PartialEq for Beside {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Faces(a), Self::Faces(b)) => a == b,
            (Self::Field(a, X), Self::Field(b, Y)) => X == Y && Arc::ptr_eq(a, b),
            (Self::Surface(a, X), Self::Surface(b, Y)) => X == Y && Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// Whether a place is below heights, or not farther above them than `slack`, m.
pub(super) fn is_in(field: &Field, x: &Vec3, slack: f64) -> bool {
    field.is_over(x) && field.below(x).is_some_and(|(_, depth)| -depth <= slack)
}

/// Whether a place is not farther from the triangles of a mesh than `slack`, m.
pub(super) fn is_on(surface: &Surface, x: &Vec3, slack: f64) -> bool {
    surface.is_any_near(x, slack, |facet| facet.apart(x).norm() <= slack)
}

/// A face of another solid that is level with one of a solid; in the axes of that.
#[derive(Clone, Debug, PartialEq)]
pub struct Across {
    /// Both level faces.
    pub(super) up: Face,
    /// Walls along the edges of that of the other one.
    pub(super) sides: Vec<Face>,
}
