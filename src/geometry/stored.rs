//! Shapes as a file has them: a type, and what that type needs.

use super::field::Field;
use super::surface::Surface;
use crate::spatial::Vec3;
use serde::Deserialize;
use std::sync::Arc;

/// All that a shape can have. What serde derives for an enum with its name among its fields keeps
/// every number of a shape in memory before it reads it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    #[serde(rename = "type")]
    pub kind: Kind,
    pub radius: Option<f64>,
    pub half_length: Option<f64>,
    pub half: Option<Vec3>,
    pub vertices: Option<Vec<Vec3>>,
    pub field: Option<Arc<Field>>,
    pub surface: Option<Arc<Surface>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Sphere,
    Capsule,
    Cylinder,
    Box,
    Hull,
    Plane,
    Field,
    Surface,
}
