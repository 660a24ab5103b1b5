//! Where a straight line meets a solid, in closed form.
//!
//! Ball, cylinder and box by their equations, a capsule as two balls and a cylinder, a hull by
//! clipping the line with the planes of its faces. Nothing is iterated, so that what is found is
//! exact but for round-off; terrain is in `terrain.rs`. A new kind of shape needs an arm in
//! [`Target::new`] and one in [`Target::first`].
//!
//! Source: Ericson 2005, Real-Time Collision Detection, chapter 5.3; the discriminants are written
//! as the distance of the line from a centre or an axis, which keeps their digits far away.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod line;
mod terrain;

pub use self::line::Ray;

use super::Shape;
use super::field::Field;
use super::hull::{Simplices, hull};
use super::surface::Surface;
use crate::spatial::Vec3;
use std::sync::Arc;

/// A shape as rays see it.
#[derive(Clone, Debug)]
pub enum Target {
    /// Ball about the origin.
    Ball {
        /// m
        radius: f64,
    },
    /// Cylinder along z, with half balls on its ends or flat.
    Round {
        /// m
        radius: f64,
        /// Of the cylinder alone, m.
        half_length: f64,
        /// Whether it has the half balls.
        capped: bool,
    },
    /// Box about the origin.
    Box {
        /// Half extents, m.
        half: Vec3,
    },
    /// What lies below all of some planes.
    Planes {
        /// Outward normal, and its product with a point of the plane, m.
        planes: Vec<(Vec3, f64)>,
    },
    /// A polygon without thickness.
    Plate {
        /// Normal, and its product with a point of the plane, m.
        plane: (Vec3, f64),
        /// Outward normal of each side in the plane, likewise.
        sides: Vec<(Vec3, f64)>,
    },
    /// A rod or a point without thickness, which no ray hits.
    Nothing,
    /// Everything below the plane z = 0.
    HalfSpace,
    /// Everything below a surface of heights.
    Field(Arc<Field>),
    /// The triangles of a mesh.
    Surface(Arc<Surface>),
}

/// From where to where a line is in a solid, m along it.
type Span = (f64, f64);

/// Normals closer than this are one face.
const SAME_FACE: f64 = 1e-14;

impl Target {
    /// Prepares a shape.
    pub fn new(shape: &Shape) -> Self {
        match shape {
            Shape::Sphere { radius } => Self::Ball { radius: *radius },
            Shape::Capsule {
                radius,
                half_length,
            } => Self::Round {
                radius: *radius,
                half_length: *half_length,
                capped: true,
            },
            Shape::Cylinder {
                radius,
                half_length,
            } => Self::Round {
                radius: *radius,
                half_length: *half_length,
                capped: false,
            },
            Shape::Box { half } => Self::Box { half: *half },
            Shape::Hull { vertices } => Self::of_hull(vertices),
            Shape::Plane => Self::HalfSpace,
            Shape::Field { field } => Self::Field(field.clone()),
            Shape::Surface { surface } => Self::Surface(surface.clone()),
        }
    }

    fn of_hull(vertices: &[Vec3]) -> Self {
        let Some(hull) = hull(vertices, vertices.len().max(4)) else {
            return Self::Nothing;
        };
        // Through the outermost of all corners, which a triangle need not have.
        let plane = |normal: Vec3| {
            let heights = hull.corners.iter().map(|corner| normal.dot(corner));
            (normal, heights.fold(f64::NEG_INFINITY, f64::max))
        };
        match &hull.simplices {
            Simplices::Faces(faces) => {
                let mut planes: Vec<(Vec3, f64)> = Vec::new();
                for face in faces {
                    let [a, b, c] = face.map(|i| hull.corners[i]);
                    let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else {
                        continue;
                    };
                    if !planes
                        .iter()
                        .any(|(known, _)| (known - normal).norm_squared() < SAME_FACE * SAME_FACE)
                    {
                        planes.push(plane(normal));
                    }
                }
                Self::Planes { planes }
            }
            Simplices::Polygon(order) => {
                let corner = |k: usize| hull.corners[order[k % order.len()]];
                let normal = (1..order.len()).fold(Vec3::zeros(), |sum, k| {
                    sum + (corner(k) - corner(0)).cross(&(corner(k + 1) - corner(0)))
                });
                let Some(normal) = normal.try_normalize(0.0) else {
                    return Self::Nothing;
                };
                let side = |k| {
                    (corner(k + 1) - corner(k))
                        .cross(&normal)
                        .try_normalize(0.0)
                };
                Self::Plate {
                    plane: (normal, normal.dot(&corner(0))),
                    sides: (0..order.len()).filter_map(side).map(plane).collect(),
                }
            }
            Simplices::Segment | Simplices::Point => Self::Nothing,
        }
    }

    /// The first point of the solid on a ray that is not nearer than `near`, m along it; `near`
    /// itself where the solid is there. None where the ray misses.
    pub fn first(&self, ray: &Ray, near: f64) -> Option<f64> {
        let (enter, exit) = match self {
            Self::Ball { radius } => ball(&ray.origin, &ray.along, *radius),
            Self::Round {
                radius,
                half_length,
                capped,
            } => round(ray, *radius, *half_length, *capped),
            Self::Box { half } => cuboid(ray, half),
            Self::Planes { planes } => below(planes, ray, (f64::NEG_INFINITY, f64::INFINITY)),
            Self::Plate { plane, sides } => plate(plane, sides, ray),
            Self::Nothing => None,
            Self::HalfSpace => return terrain::plane(ray, near),
            Self::Field(field) => return terrain::heights(field, ray, near),
            Self::Surface(surface) => return terrain::triangles(surface, ray, near),
        }?;
        (exit >= near).then(|| enter.max(near))
    }
}

/// Both of them.
fn within((a, b): Span, (c, d): Span) -> Option<Span> {
    let (enter, exit) = (a.max(c), b.min(d));
    (enter <= exit).then_some((enter, exit))
}

/// A ball about the origin: the line passes its centre at a distance.
fn ball(origin: &Vec3, along: &Vec3, radius: f64) -> Option<Span> {
    let middle = -origin.dot(along);
    let off = origin + along * middle;
    let square = radius * radius - off.norm_squared();
    (square >= 0.0).then(|| (middle - square.sqrt(), middle + square.sqrt()))
}

/// `|z| ≤ half` where only `z` changes along the line.
fn slab(z: f64, slope: f64, half: f64) -> Option<Span> {
    if slope == 0.0 {
        return (z.abs() <= half).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((-half - z) / slope, (half - z) / slope);
    Some((a.min(b), a.max(b)))
}

fn cuboid(ray: &Ray, half: &Vec3) -> Option<Span> {
    let mut span = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..3 {
        span = within(span, slab(ray.origin[i], ray.along[i], half[i])?)?;
    }
    Some(span)
}

/// The mantle of an endless cylinder along z: seen from above a circle that the line passes.
fn mantle(ray: &Ray, radius: f64) -> Option<Span> {
    let (o, d) = (ray.origin.xy(), ray.along.xy());
    let pace = d.norm();
    if pace == 0.0 {
        return (o.norm() <= radius).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let d = d / pace;
    let off = d.x * o.y - d.y * o.x;
    let square = radius * radius - off * off;
    let middle = -o.dot(&d);
    (square >= 0.0).then(|| {
        (
            (middle - square.sqrt()) / pace,
            (middle + square.sqrt()) / pace,
        )
    })
}

fn round(ray: &Ray, radius: f64, half_length: f64, capped: bool) -> Option<Span> {
    let middle = mantle(ray, radius)
        .and_then(|mantle| within(mantle, slab(ray.origin.z, ray.along.z, half_length)?));
    if !capped {
        return middle;
    }
    // All three are parts of a convex solid: the line is in it from the first to the last.
    let end = |z: f64| ball(&(ray.origin - Vec3::z() * z), &ray.along, radius);
    let parts = [middle, end(half_length), end(-half_length)];
    parts
        .into_iter()
        .flatten()
        .reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))
}

/// What of a span lies below all planes.
fn below(planes: &[(Vec3, f64)], ray: &Ray, span: Span) -> Option<Span> {
    let (mut enter, mut exit) = span;
    for (normal, height) in planes {
        let above = normal.dot(&ray.origin) - height;
        let slope = normal.dot(&ray.along);
        if slope < 0.0 {
            enter = enter.max(-above / slope);
        } else if slope > 0.0 {
            exit = exit.min(-above / slope);
        } else if above > 0.0 {
            return None;
        }
        if enter > exit {
            return None;
        }
    }
    Some((enter, exit))
}

/// A line in the plane of a polygon does not hit it.
fn plate((normal, height): &(Vec3, f64), sides: &[(Vec3, f64)], ray: &Ray) -> Option<Span> {
    let slope = normal.dot(&ray.along);
    if slope == 0.0 {
        return None;
    }
    let at = (height - normal.dot(&ray.origin)) / slope;
    let x = ray.origin + ray.along * at;
    let inside = sides.iter().all(|(side, edge)| side.dot(&x) <= *edge);
    inside.then_some((at, at))
}

#[cfg(test)]
mod tests;
