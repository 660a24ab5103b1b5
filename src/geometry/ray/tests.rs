//! Rays against two independent ways: the roots of an implicit function of each shape, found by
//! halving intervals, or the triangles of a hull one by one; and against parry.

use super::*;
use crate::testing::Random;

/// Rays on every shape.
const RAYS: usize = 100_000;

/// Below 0 inside, above outside; convex, and steeper than 1e-3 near the surface.
fn outside(shape: &Shape, p: &Vec3) -> f64 {
    match shape {
        Shape::Sphere { radius } => p.norm() - radius,
        Shape::Capsule {
            radius,
            half_length,
        } => {
            let z = p.z.clamp(-half_length, *half_length);
            (p - Vec3::new(0.0, 0.0, z)).norm() - radius
        }
        Shape::Cylinder {
            radius,
            half_length,
        } => {
            (p.x * p.x + p.y * p.y)
                .sqrt()
                .max(p.z.abs() - half_length + radius)
                - radius
        }
        Shape::Box { half } => (p.abs() - half).max(),
        _ => panic!("a hull has triangles"),
    }
}

/// The lowest point of a convex function between `low` and `high`, and its value.
fn lowest(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    for _ in 0..120 {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if of(a) < of(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let t = 0.5 * (low + high);
    (t, of(t))
}

/// A ray that is closer to a miss than is asked for, either way: there the root is worse than the
/// numbers.
struct Grazes;

/// Where the implicit function is zero first, for rays that pass by `margin`, m, or more.
fn by_halving(shape: &Shape, ray: &Ray, far: f64, margin: f64) -> Result<Option<f64>, Grazes> {
    let of = |t: f64| outside(shape, &(ray.origin + ray.along * t));
    if of(0.0) <= 0.0 {
        return Ok(Some(0.0));
    }
    let (mut inside, least) = lowest(of, 0.0, far);
    if least.abs() < margin {
        return Err(Grazes);
    }
    if least > 0.0 {
        return Ok(None);
    }
    let mut before = 0.0;
    while {
        let middle = 0.5 * (before + inside);
        middle > before && middle < inside
    } {
        let middle = 0.5 * (before + inside);
        if of(middle) > 0.0 {
            before = middle;
        } else {
            inside = middle;
        }
    }
    Ok(Some(inside))
}

/// Möller and Trumbore 1997, on each triangle.
fn by_triangles(triangles: &[[Vec3; 3]], ray: &Ray) -> Option<f64> {
    let on = |[a, b, c]: &[Vec3; 3]| {
        let (e, f) = (b - a, c - a);
        let p = ray.along.cross(&f);
        let size = e.dot(&p);
        let s = ray.origin - a;
        let u = s.dot(&p) / size;
        let q = s.cross(&e);
        let v = ray.along.dot(&q) / size;
        let t = f.dot(&q) / size;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
    };
    triangles.iter().filter_map(on).reduce(f64::min)
}

fn shapes() -> Vec<Shape> {
    let mut random = Random(5);
    let vertices: Vec<Vec3> = (0..60).map(|_| random.unit() * 0.5).collect();
    vec![
        Shape::Sphere { radius: 0.4 },
        Shape::Capsule {
            radius: 0.2,
            half_length: 0.3,
        },
        Shape::Cylinder {
            radius: 0.3,
            half_length: 0.2,
        },
        Shape::Box {
            half: Vec3::new(0.2, 0.3, 0.4),
        },
        Shape::Hull { vertices },
    ]
}

/// From up to 3 m away towards somewhere near the shape.
fn random_ray(random: &mut Random) -> Ray {
    let origin = random.vector(3.0);
    let aim = random.vector(0.6) - origin;
    Ray {
        origin,
        along: aim.try_normalize(1e-3).unwrap_or_else(Vec3::x),
    }
}

#[test]
fn rays_meet_every_shape_where_brute_force_does() {
    for (number, shape) in (0..).zip(shapes()) {
        let (target, mut random) = (Target::new(&shape), Random(1000 + number));
        let triangles = shape.triangles();
        let (mut hits, mut skipped, mut worst) = (0, 0, 0.0_f64);
        for i in 0..RAYS {
            let ray = random_ray(&mut random);
            let found = target.first(&ray, 0.0);
            let is_hull = matches!(shape, Shape::Hull { .. });
            let expected = if is_hull {
                Ok(by_triangles(&triangles, &ray))
            } else {
                by_halving(&shape, &ray, 10.0, 1e-7)
            };
            let Ok(expected) = expected else {
                skipped += 1;
                continue;
            };
            match (found, expected) {
                (Some(found), Some(expected)) => {
                    // Within a hull the triangles see the way out.
                    if !(is_hull && found == 0.0) {
                        worst = worst.max((found - expected).abs());
                    }
                    hits += 1;
                }
                (None, None) => {}
                _ => panic!("{shape:?}, ray {i} {ray:?}: {found:?} {expected:?}"),
            }
        }
        assert!(
            hits > RAYS / 10 && skipped < RAYS / 1000,
            "{hits} {skipped}"
        );
        assert!(worst < 1e-12, "{shape:?}: {worst:e} m");
    }
}

/// Parry is an independent program. Its cylinder is found by iteration, to 1e-5 m.
#[test]
fn rays_meet_shapes_where_those_of_parry_do() {
    use parry3d_f64::math::{Pose, Vector};
    use parry3d_f64::query::{Ray as Theirs, RayCast};
    use parry3d_f64::shape;
    let vector = |v: &Vec3| Vector::new(v.x, v.y, v.z);
    for (number, own) in (0..).zip(shapes()) {
        // Cylinders and capsules of parry stand along y: x, y, z is our y, z, x.
        let swap = |v: &Vec3| Vector::new(v.y, v.z, v.x);
        let (other, turned, tolerance): (Box<dyn RayCast>, bool, f64) = match &own {
            Shape::Sphere { radius } => (Box::new(shape::Ball::new(*radius)), false, 1e-12),
            Shape::Capsule {
                radius,
                half_length,
            } => (
                Box::new(shape::Capsule::new_y(*half_length, *radius)),
                true,
                1e-12,
            ),
            Shape::Cylinder {
                radius,
                half_length,
            } => (
                Box::new(shape::Cylinder::new(*half_length, *radius)),
                true,
                1e-5,
            ),
            Shape::Box { half } => (Box::new(shape::Cuboid::new(vector(half))), false, 1e-12),
            Shape::Hull { .. } => {
                let corners: Vec<Vector> = own.triangles().iter().flatten().map(vector).collect();
                let faces = (0..u32::try_from(corners.len() / 3).expect("few"))
                    .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                    .collect();
                let mesh = shape::TriMesh::new(corners, faces).expect("a mesh");
                (Box::new(mesh), false, 1e-12)
            }
            _ => panic!("terrain has its own referees"),
        };
        let (target, mut random, mut hits) = (Target::new(&own), Random(2000 + number), 0);
        for i in 0..20_000 {
            let ray = random_ray(&mut random);
            let found = target.first(&ray, 0.0);
            if found == Some(0.0) {
                continue;
            }
            let map = |v: &Vec3| if turned { swap(v) } else { vector(v) };
            let theirs = Theirs::new(map(&ray.origin), map(&ray.along));
            let expected = other.cast_ray(&Pose::IDENTITY, &theirs, 100.0, true);
            let near = |other: f64| found.is_some_and(|found| (found - other).abs() < tolerance);
            // Iteration also loses rays that graze.
            let grazes = matches!(own, Shape::Cylinder { .. })
                && target.first(&ray, 0.0).is_some() != expected.is_some();
            hits += usize::from(found.is_some());
            assert!(
                grazes || expected.map_or(found.is_none(), near),
                "{own:?}, ray {i} {ray:?}: {found:?} {expected:?}"
            );
        }
        assert!(hits > 1000, "{hits}");
    }
}

#[test]
fn a_ray_begins_where_it_is_told_to() {
    let target = Target::new(&Shape::Sphere { radius: 1.0 });
    let ray = Ray {
        origin: Vec3::new(-3.0, 0.0, 0.0),
        along: Vec3::x(),
    };
    // In front, in it, behind it.
    assert_eq!(target.first(&ray, 0.0), Some(2.0));
    assert_eq!(target.first(&ray, 3.0), Some(3.0));
    assert_eq!(target.first(&ray, 4.5), None);
}

#[test]
fn a_ray_along_a_side_or_the_axis_is_told_apart() {
    let ray = |origin: [f64; 3], along: Vec3| Ray {
        origin: Vec3::from(origin),
        along,
    };
    let cylinder = Target::new(&Shape::Cylinder {
        radius: 0.5,
        half_length: 1.0,
    });
    let cube = Target::new(&Shape::Box {
        half: Vec3::new(1.0, 1.0, 1.0),
    });
    for target in [&cylinder, &cube] {
        let down = |x: f64| target.first(&ray([x, 0.0, 4.0], -Vec3::z()), 0.0);
        assert_eq!(
            (down(0.0), down(0.25), down(2.0)),
            (Some(3.0), Some(3.0), None)
        );
        assert_eq!(target.first(&ray([-4.0, 0.0, 1.5], Vec3::x()), 0.0), None);
    }
}

#[test]
fn a_plate_without_thickness_is_hit_and_a_rod_is_not() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let vertices = corners.map(|[x, y]| Vec3::new(x, y, 0.5)).to_vec();
    let plate = Target::new(&Shape::Hull { vertices });
    let down = |x: f64, y: f64| Ray {
        origin: Vec3::new(x, y, 3.0),
        along: -Vec3::z(),
    };
    for ((x, y), expected) in [
        ((1.9, 0.9), Some(2.5)),
        ((0.1, 0.1), Some(2.5)),
        ((2.1, 0.5), None),
        ((1.0, -0.1), None),
    ] {
        assert_eq!(plate.first(&down(x, y), 0.0), expected, "{x} {y}");
    }
    let vertices = vec![Vec3::zeros(), Vec3::x()];
    let rod = Target::new(&Shape::Hull { vertices });
    assert_eq!(rod.first(&down(0.5, 0.0), 0.0), None);
}

/// The ball is 2e6 m away, where squares of distances would leave a tenth of a millimetre.
#[test]
fn a_ball_far_away_is_met_to_the_last_digits() {
    let target = Target::new(&Shape::Sphere { radius: 0.5 });
    let ray = Ray {
        origin: Vec3::new(-2e6, 0.3, 0.0),
        along: Vec3::x(),
    };
    let found = target.first(&ray, 0.0).expect("in the way");
    assert!((found - (2e6 - 0.4)).abs() < 1e-9, "{found}");
}
