//! Collision shapes, their reach, and the convex hull of a mesh.
//!
//! Their volume and inertia are in `solid`, the algorithm of the hull in `hull`. Contact points of
//! a shape against the ground are found in [`crate::force`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod around;
mod error;
mod faces;
pub mod field;
mod hull;
mod nearest;
pub mod pair;
pub mod ray;
mod segment;
mod solid;
mod stored;
pub mod surface;

pub use self::error::GeometryError;
pub use self::faces::Faces;

use crate::spatial::{Pose, Vec3};
use field::Field;
use hull::Simplices;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stored::{Kind, Stored};
use surface::Surface;

/// Points of a contact between two shapes that there is room for, on average.
pub const PAIR_POINTS: usize = 24;

/// A convex solid about its own origin; cylinders and capsules stand along z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", try_from = "Stored")]
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
    /// Everything below the plane z = 0, without an end; it never moves.
    Plane,
    /// Everything below a surface of given heights; it never moves.
    Field {
        /// The surface.
        field: Arc<Field>,
    },
    /// What is behind the surface of a triangle mesh; it never moves.
    Surface {
        /// The surface.
        surface: Arc<Surface>,
    },
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

impl Shape {
    /// Largest distance of a point of the shape from its origin, m.
    #[cfg_attr(small, optimize(size))]
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
            Self::Plane => f64::INFINITY,
            Self::Field { field } => field.reach(),
            Self::Surface { surface } => surface.reach(),
        }
    }

    /// How far the shape reaches along `-direction` from the origin of the frame that `pose` is
    /// given in: the minimum of `direction·x` over its points. `direction` is a unit vector.
    pub fn lowest(&self, pose: &Pose, direction: &Vec3) -> f64 {
        pose.p.dot(direction) - self.depth(&(pose.R.transpose() * direction))
    }

    /// How far the shape reaches from its origin against the unit vector `d`, given in its own
    /// axes.
    pub fn depth(&self, d: &Vec3) -> f64 {
        match self {
            Self::Sphere { radius } => *radius,
            Self::Capsule {
                radius,
                half_length,
            } => radius + half_length * d.z.abs(),
            Self::Cylinder {
                radius,
                half_length,
            } => half_length * d.z.abs() + radius * (d.x * d.x + d.y * d.y).sqrt(),
            Self::Box { half } => half.x * d.x.abs() + half.y * d.y.abs() + half.z * d.z.abs(),
            Self::Hull { vertices } => vertices
                .iter()
                .map(|v| -v.dot(d))
                .fold(f64::NEG_INFINITY, f64::max),
            Self::Plane => f64::INFINITY,
            Self::Field { field } => field.reach(),
            Self::Surface { surface } => surface.reach(),
        }
    }

    /// How many points it can touch a plane with, see [`crate::force`].
    pub fn points(&self) -> usize {
        match self {
            Self::Sphere { .. } => 1,
            // Two ends, or two rims.
            Self::Capsule { .. } | Self::Cylinder { .. } => 2,
            Self::Box { .. } => 8,
            Self::Hull { vertices } => vertices.len(),
            Self::Plane | Self::Field { .. } | Self::Surface { .. } => 0,
        }
    }

    /// Whether it is terrain: a surface with everything below, which never moves.
    pub fn is_terrain(&self) -> bool {
        matches!(
            self,
            Self::Plane | Self::Field { .. } | Self::Surface { .. }
        )
    }
}

/// Corners that are kept of a hull: each is a possible contact point.
pub const MOST_CORNERS: usize = 64;

/// Farthest that a mesh may reach, m: beyond, its unit is wrong.
const FARTHEST: f64 = 1e6;

/// A hull with few corners.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedHull {
    /// Extreme points of the input, m.
    pub vertices: Vec<Vec3>,
    /// Largest distance by which an input point lies outside, m: no support of the hull is off by
    /// more. Up to 1e-7 of its size is not counted.
    pub error: f64,
    /// Whether it has no volume.
    pub flat: bool,
}

/// Extreme points of `points`, in the order of the input; what is closer than 1e-7 of the size to
/// the hull of others is left out. A plate or a rod without thickness is legal.
///
/// # Errors
/// [`GeometryError`] for no points, points that are not finite or beyond 1e6 m, or all in one
/// place.
pub fn convex_hull(points: &[Vec3]) -> Result<Vec<Vec3>, GeometryError> {
    Ok(bounded_hull(points, usize::MAX)?.vertices)
}

/// The hull of at most `most` extreme points (at least 4), chosen greedily: always the one furthest
/// outside.
///
/// # Errors
/// As [`convex_hull`].
pub fn bounded_hull(points: &[Vec3], most: usize) -> Result<BoundedHull, GeometryError> {
    for (index, p) in points.iter().enumerate() {
        if !p.iter().all(|x| x.is_finite()) {
            return Err(GeometryError::NotFinite { index });
        }
        let distance = p.norm();
        if distance > FARTHEST {
            return Err(GeometryError::TooFar { index, distance });
        }
    }
    let hull = hull::hull(points, most.max(4)).ok_or(GeometryError::NoPoints)?;
    if hull.simplices == Simplices::Point {
        return Err(GeometryError::OnePlace);
    }
    Ok(BoundedHull {
        flat: !matches!(hull.simplices, Simplices::Faces(_)),
        error: hull.error,
        vertices: hull.corners,
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::spatial::{Mat3, rotation_from_rpy};
    use crate::testing::Random;

    pub(crate) fn corners(half: &Vec3) -> Vec<Vec3> {
        let signs = [-1.0, 1.0];
        let of = |x: f64| signs.map(|y| signs.map(|z| Vec3::new(x, y, z).component_mul(half)));
        signs.iter().flat_map(|&x| of(x)).flatten().collect()
    }

    /// Support of points in a direction.
    fn support(points: &[Vec3], direction: &Vec3) -> f64 {
        points
            .iter()
            .map(|p| p.dot(direction))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Parry is an independent program: its hull and its mass properties.
    #[test]
    fn hulls_of_random_points_agree_with_parry() {
        use parry3d_f64::mass_properties::MassProperties;
        use parry3d_f64::math::Vector;
        let mut random = Random(0x9E37_79B9_7F4A_7C15);
        for count in [4, 5, 8, 20, 100, 1000] {
            for _ in 0..20 {
                let stretch = Vec3::new(
                    1.0,
                    0.1 + random.uniform(-1.0, 1.0).abs(),
                    0.05 + random.uniform(-1.0, 1.0).abs(),
                );
                // Large, because parry takes products of inertia below 1e-7 for zero.
                let center = Vec3::new(50.0, 0.0, -100.0);
                let points: Vec<Vec3> = (0..count)
                    .map(|_| random.vector(100.0).component_mul(&stretch) + center)
                    .collect();
                let theirs: Vec<Vector> =
                    points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
                let (vertices, faces) =
                    parry3d_f64::transformation::try_convex_hull(&theirs).expect("a hull");
                let expected = MassProperties::from_trimesh(1.0, &vertices, &faces);
                let ours = convex_hull(&points).expect("a hull");
                assert_eq!(ours.len(), vertices.len(), "{count} points");
                let hull = Shape::Hull { vertices: ours };
                let inertia = hull.solid_inertia(expected.mass());
                assert!((hull.volume() - expected.mass()).abs() < 1e-10 * expected.mass());
                let com = Vec3::new(
                    expected.local_com.x,
                    expected.local_com.y,
                    expected.local_com.z,
                );
                assert!((inertia.com - com).norm() < 1e-9 * center.norm());
                let I = expected.reconstruct_inertia_matrix();
                let I = Mat3::from_fn(|r, c| I.col(c)[r]);
                assert!(
                    (inertia.I_cm - I).norm() < 1e-8 * I.norm(),
                    "{I} {}",
                    inertia.I_cm
                );
            }
        }
    }

    #[test]
    fn a_tessellated_box_keeps_its_eight_corners() {
        // 21³ grid points, most of them on faces and edges, in single precision and turned.
        let R = rotation_from_rpy(&Vec3::new(0.2, 0.5, -1.0));
        for turn in [Mat3::identity(), R] {
            let mut points = Vec::new();
            for i in -10..=10 {
                for j in -10..=10 {
                    for k in -10..=10 {
                        let p =
                            turn * Vec3::new(f64::from(i), f64::from(j) * 0.5, f64::from(k) * 0.1);
                        #[expect(
                            clippy::cast_possible_truncation,
                            reason = "mesh files are in f32"
                        )]
                        points.push(p.map(|x| f64::from(x as f32)));
                    }
                }
            }
            let hull = bounded_hull(&points, 64).expect("a hull");
            assert_eq!(hull.vertices.len(), 8, "{:?}", hull.vertices);
            // f32 has 6e-8 of 11 m.
            assert!(hull.error < 2e-6, "{}", hull.error);
        }
    }

    #[test]
    fn a_bounded_hull_knows_its_support_error() {
        let mut random = Random(7);
        let ball: Vec<Vec3> = (0..5000)
            .map(|_| random.vector(1.0).normalize() * 0.2)
            .collect();
        let hull = bounded_hull(&ball, 64).expect("a hull");
        assert_eq!(hull.vertices.len(), 64);
        // 62 faces' worth of a sphere: sagging of a few percent of the radius, not more.
        assert!(
            hull.error > 1e-3 * 0.2 && hull.error < 0.15 * 0.2,
            "{}",
            hull.error
        );
        let mut worst: f64 = 0.0;
        for _ in 0..2000 {
            let d = random.vector(1.0).normalize();
            let lost = support(&ball, &d) - support(&hull.vertices, &d);
            assert!(
                (-1e-12..=hull.error + 1e-9).contains(&lost),
                "{lost} {}",
                hull.error
            );
            worst = worst.max(lost);
        }
        assert!(
            worst > 0.5 * hull.error,
            "the bound is far from sharp: {worst} {}",
            hull.error
        );
    }

    #[test]
    fn a_plate_and_a_rod_without_thickness_are_kept_and_weighed() {
        let plate: Vec<Vec3> = corners(&Vec3::new(0.3, 0.2, 0.0));
        let hull = bounded_hull(&plate, 64).expect("a plate");
        assert!(hull.flat && hull.vertices.len() == 4, "{hull:?}");
        // A thin plate a × b: m/12 (b², a², a² + b²).
        let found = Shape::Hull {
            vertices: hull.vertices,
        }
        .solid_inertia(3.0);
        let expected = Mat3::from_diagonal(&(Vec3::new(0.16, 0.36, 0.52) * (3.0 / 12.0)));
        assert!((found.I_cm - expected).norm() < 1e-12, "{found:?}");
        let rod = vec![
            Vec3::zeros(),
            Vec3::new(0.0, 0.0, 2.0),
            Vec3::new(0.0, 0.0, 1.0),
        ];
        let hull = bounded_hull(&rod, 64).expect("a rod");
        assert!(hull.flat && hull.vertices.len() == 2);
        // A thin rod of length l: m l²/12, its middle at 1 m.
        let found = Shape::Hull {
            vertices: hull.vertices,
        }
        .solid_inertia(3.0);
        assert!((found.I_cm - Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 0.0))).norm() < 1e-12);
        assert!((found.com - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-12);
    }

    /// Most points are left out of the search for the furthest one.
    #[test]
    fn the_error_of_a_bounded_hull_is_that_of_the_furthest_of_all_points() {
        let mut random = Random(11);
        for most in [4, 7, 20, 60] {
            let sides = Vec3::new(1.0, 0.3, 0.05);
            let direction = |p: Vec3| p.try_normalize(1e-3).unwrap_or_else(Vec3::x);
            let points: Vec<Vec3> = (0..300)
                .map(|_| direction(random.vector(1.0)).component_mul(&sides))
                .collect();
            let hull = hull::hull(&points, most).expect("points");
            let Simplices::Faces(faces) = &hull.simplices else {
                panic!("an ellipsoid is a solid");
            };
            let faces: Vec<[Vec3; 3]> = faces.iter().map(|f| f.map(|i| hull.corners[i])).collect();
            let distance = |p: &Vec3| {
                let above = |[a, b, c]: &[Vec3; 3]| (b - a).cross(&(c - a)).dot(&(p - a)) > 0.0;
                let to = |face: &[Vec3; 3]| (p - nearest::on_triangle(p, *face)).norm();
                if faces.iter().any(above) {
                    faces.iter().map(to).fold(f64::INFINITY, f64::min)
                } else {
                    0.0
                }
            };
            let furthest = points.iter().map(distance).fold(0.0, f64::max);
            assert!(
                (furthest - hull.error).abs() < 1e-12,
                "{most}: {furthest} {}",
                hull.error
            );
        }
    }

    #[test]
    fn points_without_a_hull_are_an_error() {
        let p = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(convex_hull(&[]), Err(GeometryError::NoPoints));
        assert_eq!(convex_hull(&[p]), Err(GeometryError::OnePlace));
        assert_eq!(convex_hull(&[p, p, p, p, p]), Err(GeometryError::OnePlace));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let points = [p, Vec3::new(bad, 0.0, 0.0)];
            assert_eq!(
                convex_hull(&points),
                Err(GeometryError::NotFinite { index: 1 })
            );
        }
        let points = [p, Vec3::new(0.0, 1e300, 0.0)];
        assert!(matches!(
            convex_hull(&points),
            Err(GeometryError::TooFar { index: 1, .. })
        ));
    }

    /// Grids, repeated and nearly equal points, slivers, stretched by up to 1e9: whatever comes out
    /// contains what went in, up to the error that it names.
    #[test]
    fn degenerate_points_give_a_hull_that_contains_them() {
        let mut random = Random(99);
        for round in 0..3000 {
            let count = 1 + round % 40;
            let stretch = random.vector(1.0).map(|x| (10.0 * x).exp2().min(1e3) * x);
            let noise = [0.0, 1e-16, 1e-12, 1e-9, 1e-7, 1e-5][round % 6];
            let points: Vec<Vec3> = (0..count)
                .map(|_| {
                    let grid = random.vector(1.0).map(|x| (x * 2.0).round());
                    (grid + random.vector(1.0) * noise).component_mul(&stretch)
                })
                .collect();
            let most = [4, 8, 64][round % 3];
            let Ok(hull) = bounded_hull(&points, most) else {
                continue;
            };
            assert!(hull.vertices.len() <= most, "round {round}");
            let size = points
                .iter()
                .map(|p| (p - points[0]).norm())
                .fold(0.0, f64::max);
            for _ in 0..20 {
                let d = random.vector(1.0).normalize();
                let lost = support(&points, &d) - support(&hull.vertices, &d);
                assert!(
                    lost <= hull.error + 3e-6 * size,
                    "round {round}: {lost} {hull:?}"
                );
            }
            let inertia = Shape::Hull {
                vertices: hull.vertices,
            }
            .solid_inertia(1.0);
            assert!(inertia.I_cm.iter().all(|x| x.is_finite()), "round {round}");
            let moments = inertia.I_cm.symmetric_eigen().eigenvalues;
            assert!(
                moments.min() >= -1e-9 * size * size,
                "round {round}: {moments}"
            );
        }
    }
}
