//! What stands beside a solid, against it or across a gap.

use crate::spatial::Vec3;

/// Outward unit normal of a flat face, and how far it is from the origin along that, m.
pub(super) type Face = (Vec3, f64);

/// Faces of a solid that stands beside another one, in the axes of that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside(Vec<Face>);

impl Beside {
    /// What has these faces.
    pub(super) fn new(faces: Vec<Face>) -> Self {
        Self(faces)
    }

    /// Whether a place is inside, or not farther from it than `slack`, m.
    pub(super) fn holds(&self, x: &Vec3, slack: f64) -> bool {
        self.0.iter().all(|(n, height)| n.dot(x) <= height + slack)
    }
}

/// A face of another solid, level with one of a solid, across a gap behind a wall of that; in the
/// axes of that.
#[derive(Clone, Debug, PartialEq)]
pub struct Across {
    /// Outward normal of the wall.
    pub(super) wall: Vec3,
    /// Normal of both level faces.
    pub(super) up: Vec3,
    /// All faces of the other one but that.
    pub(super) sides: Beside,
}
