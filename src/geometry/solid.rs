//! Volume and mass properties of uniform solids.
//!
//! Closed forms for the simple shapes; a hull is filled with simplices from one of its corners.

use super::Shape;
use super::hull::{self, Hull, Simplices};
use crate::spatial::{Mat3, RigidInertia, Vec3, point_inertia};
use std::f64::consts::PI;

/// Width of the square that is drawn of a plane, which has no end, m.
const PLANE_DRAWN: f64 = 20.0;

impl Shape {
    /// Mass properties of a uniform solid of this shape, about its centre of mass, in the shape's
    /// frame.
    ///
    /// Exact for every shape; a hull without volume counts as a plate or a rod of even thickness.
    ///
    /// - `mass`: kg
    pub fn solid_inertia(&self, mass: f64) -> RigidInertia {
        let about_origin = |x: f64, y: f64, z: f64| RigidInertia {
            mass,
            com: Vec3::zeros(),
            I_cm: Mat3::from_diagonal(&(Vec3::new(x, y, z) * mass)),
        };
        match self {
            Self::Sphere { radius } => {
                let i = 0.4 * radius * radius;
                about_origin(i, i, i)
            }
            Self::Cylinder {
                radius,
                half_length,
            } => {
                let (r2, h2) = (radius * radius, half_length * half_length);
                let across = r2 / 4.0 + h2 / 3.0;
                about_origin(across, across, r2 / 2.0)
            }
            Self::Capsule {
                radius: r,
                half_length: h,
            } => {
                // Shares of the cylinder and of the two half spheres. A half sphere's centre of
                // mass is 3r/8 above its base, and 2/5 r² = 83/320 r² + (3r/8)².
                let (cylinder, ends) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r * r * r);
                let (c, e) = (cylinder / (cylinder + ends), ends / (cylinder + ends));
                let across =
                    c * (r * r / 4.0 + h * h / 3.0) + e * (0.4 * r * r + h * h + 0.75 * h * r);
                about_origin(across, across, c * r * r / 2.0 + e * 0.4 * r * r)
            }
            Self::Box { half } => {
                let s = half.component_mul(half) / 3.0;
                about_origin(s.y + s.z, s.z + s.x, s.x + s.y)
            }
            Self::Hull { vertices } => hull_inertia(vertices, mass),
            Self::Plane | Self::Field { .. } | Self::Surface { .. } => about_origin(0.0, 0.0, 0.0),
        }
    }

    /// Volume, m³; 0 for a hull without volume.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius * radius * radius,
            Self::Capsule {
                radius,
                half_length,
            } => PI * radius * radius * (2.0 * half_length + 4.0 / 3.0 * radius),
            Self::Cylinder {
                radius,
                half_length,
            } => 2.0 * PI * radius * radius * half_length,
            Self::Box { half } => 8.0 * half.x * half.y * half.z,
            Self::Hull { vertices } => match hull::hull(vertices, usize::MAX) {
                Some(hull) if matches!(hull.simplices, Simplices::Faces(_)) => {
                    simplices(&hull).iter().map(|(size, _)| size).sum()
                }
                _ => 0.0,
            },
            Self::Plane | Self::Field { .. } | Self::Surface { .. } => 0.0,
        }
    }
}

impl Shape {
    /// Triangles to draw of a hull's surface or of terrain, seen counter-clockwise from outside; a
    /// plate has one side, a rod none, of a plane there is a square. Empty for other shapes.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let vertices = match self {
            Self::Hull { vertices } => vertices,
            Self::Field { field } => return field.triangles(),
            Self::Surface { surface } => {
                return surface.facets().iter().map(|f| f.corners).collect();
            }
            Self::Plane => {
                let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0) * (0.5 * PLANE_DRAWN);
                let [a, b] = [corner(-1.0, -1.0), corner(1.0, -1.0)];
                let [c, d] = [corner(1.0, 1.0), corner(-1.0, 1.0)];
                return vec![[a, b, c], [a, c, d]];
            }
            _ => return Vec::new(),
        };
        let Some(hull) = hull::hull(vertices, usize::MAX) else {
            return Vec::new();
        };
        let triangle = |[a, b, c]: [usize; 3]| [a, b, c].map(|i| hull.corners[i]);
        match &hull.simplices {
            Simplices::Faces(faces) => faces.iter().copied().map(triangle).collect(),
            Simplices::Polygon(corners) => (2..corners.len())
                .map(|i| triangle([corners[0], corners[i - 1], corners[i]]))
                .collect(),
            Simplices::Segment | Simplices::Point => Vec::new(),
        }
    }
}

/// Mass properties of the hull of `vertices`, filled evenly.
fn hull_inertia(vertices: &[Vec3], mass: f64) -> RigidInertia {
    let Some(hull) = hull::hull(vertices, usize::MAX) else {
        return RigidInertia {
            mass,
            ..RigidInertia::ZERO
        };
    };
    // About the mean of the corners: far from the origin, digits would be lost.
    let count = hull.corners.len().max(1);
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
    let center = hull.corners.iter().sum::<Vec3>() / count as f64;
    // A simplex of k + 1 corners c and size V has the first moment V/(k+1) s and the second moments
    // V/((k+1)(k+2)) (Σ c cᵀ + s sᵀ), with s = Σ c.
    let (mut size, mut first, mut second) = (0.0, Vec3::zeros(), Mat3::zeros());
    for (v, corners) in simplices(&hull) {
        #[expect(clippy::cast_precision_loss, reason = "at most 4 corners")]
        let n = corners.len() as f64;
        let corners = corners.iter().map(|c| c - center);
        let s: Vec3 = corners.clone().sum();
        let squares: Mat3 = corners.map(|c| c * c.transpose()).sum();
        size += v;
        first += s * (v / n);
        second += (squares + s * s.transpose()) * (v / (n * (n + 1.0)));
    }
    if size <= 0.0 {
        return RigidInertia {
            mass,
            com: center,
            I_cm: Mat3::zeros(),
        };
    }
    let (com, J) = (first / size, second * (mass / size));
    RigidInertia {
        mass,
        com: center + com,
        I_cm: Mat3::identity() * J.trace() - J - point_inertia(mass, &com),
    }
}

/// Simplices that fill a hull: volume, area or length, and corners.
fn simplices(hull: &Hull) -> Vec<(f64, Vec<Vec3>)> {
    let corner = |i: usize| hull.corners[i];
    match &hull.simplices {
        Simplices::Faces(faces) => {
            // Tetrahedra from one corner; those of its own faces are empty.
            let top = corner(faces[0][0]);
            faces
                .iter()
                .map(|face| {
                    let [a, b, c] = face.map(corner);
                    let volume = (a - top).cross(&(b - top)).dot(&(c - top)) / 6.0;
                    (volume, vec![top, a, b, c])
                })
                .collect()
        }
        Simplices::Polygon(order) => {
            let top = corner(order[0]);
            order
                .windows(2)
                .skip(1)
                .map(|pair| {
                    let (a, b) = (corner(pair[0]), corner(pair[1]));
                    ((a - top).cross(&(b - top)).norm() / 2.0, vec![top, a, b])
                })
                .collect()
        }
        Simplices::Segment => {
            let (a, b) = (corner(0), corner(1));
            vec![((b - a).norm(), vec![a, b])]
        }
        Simplices::Point => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::corners;
    use crate::spatial::Pose;

    fn assert_same(a: &RigidInertia, b: &RigidInertia, tolerance: f64) {
        assert!((a.mass - b.mass).abs() <= tolerance * b.mass, "{a:?} {b:?}");
        assert!((a.com - b.com).norm() <= tolerance, "{a:?} {b:?}");
        assert!(
            (a.I_cm - b.I_cm).norm() <= tolerance * b.I_cm.norm(),
            "{a:?} {b:?}"
        );
    }

    #[test]
    fn hull_of_a_moved_box_has_the_inertia_of_the_box() {
        let half = Vec3::new(0.1, 0.2, 0.3);
        let X = Pose::from_xyz_rpy(Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.3, -0.7, 1.1));
        let vertices = corners(&half).iter().map(|p| X.point(p)).collect();
        let hull = Shape::Hull { vertices };
        let expected = Shape::Box { half }.solid_inertia(2.5).transformed(&X);
        assert_same(&hull.solid_inertia(2.5), &expected, 1e-12);
        assert!((hull.volume() - 8.0 * 0.006).abs() < 1e-15);
    }

    /// Sums over a fine grid of points are the second route to the closed forms.
    #[test]
    fn solid_inertia_agrees_with_a_sum_over_small_cubes() {
        let (radius, half_length, half) = (0.3, 0.4, Vec3::new(0.3, 0.2, 0.5));
        let inside = |shape: &Shape, p: &Vec3| match shape {
            Shape::Sphere { radius } => p.norm() <= *radius,
            Shape::Cylinder {
                radius,
                half_length,
            } => p.xy().norm() <= *radius && p.z.abs() <= *half_length,
            Shape::Capsule {
                radius,
                half_length,
            } => {
                let z = p.z.clamp(-half_length, *half_length);
                (p - Vec3::new(0.0, 0.0, z)).norm() <= *radius
            }
            Shape::Box { half } => p.abs() <= *half,
            _ => false,
        };
        for shape in [
            Shape::Sphere { radius },
            Shape::Cylinder {
                radius,
                half_length,
            },
            Shape::Capsule {
                radius,
                half_length,
            },
            Shape::Box { half },
        ] {
            const N: i32 = 80;
            let step = 0.8 / f64::from(N);
            let at = |i: i32| (f64::from(i) + 0.5) * step;
            let (mut count, mut J) = (0.0, Mat3::zeros());
            for i in -N..N {
                for j in -N..N {
                    for k in -N..N {
                        let p = Vec3::new(at(i), at(j), at(k));
                        if inside(&shape, &p) {
                            count += 1.0;
                            J += p * p.transpose();
                        }
                    }
                }
            }
            J *= 1.7 / count;
            let I = Mat3::identity() * J.trace() - J;
            let found = shape.solid_inertia(1.7);
            // The grid has 0.01 m: below half a percent of a moment.
            assert!(
                (found.I_cm - I).norm() < 0.01 * I.norm(),
                "{shape:?} {I} {}",
                found.I_cm
            );
            let volume = count * step * step * step;
            assert!(
                (shape.volume() - volume).abs() < 0.01 * volume,
                "{shape:?} {volume}"
            );
        }
    }
}
