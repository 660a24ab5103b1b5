//! Shapes as a file has them: a type, and what that type needs.

use super::Shape;
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
    kind: Kind,
    radius: Option<f64>,
    half_length: Option<f64>,
    half: Option<Vec3>,
    vertices: Option<Vec<Vec3>>,
    field: Option<Arc<Field>>,
    surface: Option<Arc<Surface>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Sphere,
    Capsule,
    Cylinder,
    Box,
    Hull,
    Plane,
    Field,
    Surface,
}

impl TryFrom<Stored> for Shape {
    type Error = &'static str;

    fn try_from(stored: Stored) -> Result<Self, Self::Error> {
        let radius = stored.radius.ok_or("missing field `radius`");
        let half_length = stored.half_length.ok_or("missing field `half_length`");
        Ok(match stored.kind {
            Kind::Sphere => Self::Sphere { radius: radius? },
            Kind::Capsule => Self::Capsule {
                radius: radius?,
                half_length: half_length?,
            },
            Kind::Cylinder => Self::Cylinder {
                radius: radius?,
                half_length: half_length?,
            },
            Kind::Box => Self::Box {
                half: stored.half.ok_or("missing field `half`")?,
            },
            Kind::Hull => Self::Hull {
                vertices: stored.vertices.ok_or("missing field `vertices`")?,
            },
            Kind::Plane => Self::Plane,
            Kind::Field => Self::Field {
                field: stored.field.ok_or("missing field `field`")?,
            },
            Kind::Surface => Self::Surface {
                surface: stored.surface.ok_or("missing field `surface`")?,
            },
        })
    }
}
