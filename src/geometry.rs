//! Collision shapes: what they are, how large they are.
//!
//! Contact points of a shape against the ground are found in [`crate::contact`].

use crate::spatial::{Pose, Vec3};
use serde::{Deserialize, Serialize};

/// A convex solid about its own origin; cylinders and capsules stand along z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Shape {
    /// Ball.
    Sphere {
        /// m
        radius: f64,
    },
    /// Cylinder with half spheres on its ends; `half_length` is the cylinder's alone.
    Capsule {
        /// m
        radius: f64,
        /// m
        half_length: f64,
    },
    /// Flat-ended circular cylinder.
    Cylinder {
        /// m
        radius: f64,
        /// m
        half_length: f64,
    },
    /// Cuboid.
    Box {
        /// Half extents, m.
        half: Vec3,
    },
    /// Convex hull of a mesh.
    Hull {
        /// Corners, m; all of them extreme points.
        vertices: Vec<Vec3>,
    },
}

impl Shape {
    /// Largest distance of a point of the shape from its origin, m.
    pub fn bounding_radius(&self) -> f64 {
        match self {
            Self::Sphere { radius } => *radius,
            Self::Capsule {
                radius,
                half_length,
            } => radius + half_length,
            Self::Cylinder {
                radius,
                half_length,
            } => libm::hypot(*radius, *half_length),
            Self::Box { half } => half.norm(),
            Self::Hull { vertices } => vertices.iter().map(Vec3::norm).fold(0.0, f64::max),
        }
    }

    /// How far the shape reaches along `-direction` from the origin of the frame that `pose` is given in:
    /// the minimum of `direction·x` over its points. `direction` is a unit vector.
    pub fn lowest(&self, pose: &Pose, direction: &Vec3) -> f64 {
        let center = pose.p.dot(direction);
        // The direction seen from the shape.
        let d = pose.R.transpose() * direction;
        let depth = match self {
            Self::Sphere { radius } => *radius,
            Self::Capsule {
                radius,
                half_length,
            } => radius + half_length * d.z.abs(),
            Self::Cylinder {
                radius,
                half_length,
            } => half_length * d.z.abs() + radius * libm::hypot(d.x, d.y),
            Self::Box { half } => half.x * d.x.abs() + half.y * d.y.abs() + half.z * d.z.abs(),
            Self::Hull { vertices } => vertices
                .iter()
                .map(|v| -v.dot(&d))
                .fold(f64::NEG_INFINITY, f64::max),
        };
        center - depth
    }

    /// How many friction displacements the state keeps for this shape, see [`crate::contact`].
    pub fn slots(&self) -> usize {
        match self {
            Self::Sphere { .. } => 1,
            Self::Capsule { .. } => 2,
            // Three on the lowest generatrix, four on each rim for the end faces.
            Self::Cylinder { .. } => 3 + 2 * 4,
            Self::Box { .. } => 8,
            Self::Hull { vertices } => vertices.len(),
        }
    }
}
