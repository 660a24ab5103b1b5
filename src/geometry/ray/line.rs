//! Rays.

use crate::spatial::Vec3;

/// A ray, in the axes of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Its beginning, m.
    pub origin: Vec3,
    /// Unit vector.
    pub along: Vec3,
}
