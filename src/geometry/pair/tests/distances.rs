//! Distances of cores against two others: a search over all pairs of triangles, and parry's, which
//! is independent of ours as long as the cores are apart. Parry's tolerances are absolute: it is
//! given all in units of the size of the parts.

use super::super::core::Core;
use super::super::nearest::nearest;
use super::super::placed::Placed;
use super::*;
use crate::geometry::hull::{Simplices, hull};
use parry3d_f64::math::{Pose as Place, Vector};
use parry3d_f64::query;
use parry3d_f64::shape as theirs;

/// Cases of each of the fifteen pairings; `PAIR_CASES` asks for others, and writes down the errors.
fn cases() -> usize {
    let asked = std::env::var("PAIR_CASES").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(3000)
}

pub(super) fn kinds(random: &mut Random, size: f64) -> [Shape; 5] {
    let mut length = || size * random.uniform(0.2, 1.0);
    let (radius, half_length, half) = (length(), length(), Vec3::new(length(), length(), length()));
    [
        Shape::Sphere { radius },
        Shape::Capsule {
            radius,
            half_length,
        },
        Shape::Cylinder {
            radius,
            half_length,
        },
        Shape::Box { half },
        if random.below(4) == 0 {
            dodecahedron(size)
        } else {
            cloud(12 + random.below(50), size, random)
        },
    ]
}

/// A shape of parry, and what turns its axis.
type Theirs = (std::boxed::Box<dyn theirs::Shape>, Mat3);

/// Poses of each pair of shapes.
const POSES: usize = 8;

/// The core as a shape of parry in units of `unit`, m, and what turns its axis.
fn their_core(solid: &Solid, unit: f64) -> Theirs {
    let upright = turned(Vec3::x(), std::f64::consts::FRAC_PI_2);
    let v = |x: &Vec3| Vector::new(x.x / unit, x.y / unit, x.z / unit);
    match &solid.core {
        Core::Point => (
            std::boxed::Box::new(theirs::Ball::new(0.0)),
            Mat3::identity(),
        ),
        Core::Segment { half } => (
            std::boxed::Box::new(theirs::Segment::new(
                v(&Vec3::new(0.0, 0.0, -half)),
                v(&Vec3::new(0.0, 0.0, *half)),
            )),
            Mat3::identity(),
        ),
        Core::Cylinder { radius, half } => (
            std::boxed::Box::new(theirs::Cylinder::new(half / unit, radius / unit)),
            upright,
        ),
        Core::Box { half } => (
            std::boxed::Box::new(theirs::Cuboid::new(v(half))),
            Mat3::identity(),
        ),
        Core::Corners(corners) => {
            let points: Vec<Vector> = corners.list().iter().map(v).collect();
            let hull = theirs::ConvexPolyhedron::from_convex_hull(&points).expect("a hull");
            (std::boxed::Box::new(hull), Mat3::identity())
        }
        Core::HalfSpace | Core::Field(_) | Core::Surface(_) => panic!("terrain has no core"),
    }
}

fn place(pose: &Pose, axis: &Mat3, unit: f64) -> Place {
    let p = pose.p / unit;
    let q = crate::spatial::quaternion_from_rotation(&(pose.R * axis));
    let rotation = parry3d_f64::math::Rotation::from_xyzw(q.i, q.j, q.k, q.w);
    Place::from_parts(Vector::new(p.x, p.y, p.z), rotation)
}

/// What parry finds in units of `unit`, m.
fn their_distance([a, b]: &[Theirs; 2], (X, Y): (&Pose, &Pose), unit: f64) -> f64 {
    let (x, y) = (place(X, &a.1, unit), place(Y, &b.1, unit));
    let found = query::distance(&x, &*a.0, &y, &*b.0);
    unit * found.expect("a distance").distance
}

/// Triangles, segments or the point of a core without curves.
fn simplices(placed: &Placed) -> Option<Vec<Vec<Vec3>>> {
    let world = |x: &Vec3| placed.p + placed.R * x;
    let list = match &placed.solid.core {
        Core::Point => return Some(vec![vec![placed.p]]),
        Core::Segment { half } => {
            let end = |z: f64| world(&Vec3::new(0.0, 0.0, z));
            return Some(vec![vec![end(-half), end(*half)]]);
        }
        Core::Box { half } => (0..8)
            .map(|i| {
                let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
                half.component_mul(&Vec3::new(sign(1), sign(2), sign(4)))
            })
            .collect(),
        Core::Corners(corners) => corners.list().to_vec(),
        _ => return None,
    };
    let found = hull(&list, list.len())?;
    let Simplices::Faces(faces) = &found.simplices else {
        return None;
    };
    let corner = |i: &usize| world(&found.corners[*i]);
    Some(
        faces
            .iter()
            .map(|f| f.iter().map(corner).collect())
            .collect(),
    )
}

fn on_segment(x: &Vec3, a: &Vec3, b: &Vec3) -> Vec3 {
    let u = b - a;
    a + u * ((x - a).dot(&u) / u.norm_squared()).clamp(0.0, 1.0)
}

/// Distance of simplices with up to three corners.
fn brute(s: &[Vec3], t: &[Vec3]) -> f64 {
    let mut best = f64::INFINITY;
    for (s, t) in [(s, t), (t, s)] {
        for x in s {
            for (i, a) in t.iter().enumerate() {
                best = best.min((x - a).norm());
                let b = &t[(i + 1) % t.len()];
                if t.len() > 1 {
                    best = best.min((x - on_segment(x, a, b)).norm());
                }
            }
            if let [a, b, c] = t {
                let n = (b - a).cross(&(c - a)).normalize();
                let inside = [(a, b), (b, c), (c, a)];
                if inside
                    .iter()
                    .all(|(a, b)| (*b - *a).cross(&(x - *a)).dot(&n) >= 0.0)
                {
                    best = best.min(n.dot(&(x - a)).abs());
                }
            }
        }
    }
    if s.len() > 1 && t.len() > 1 {
        for i in 0..s.len() {
            for j in 0..t.len() {
                let (a, b) = (s[i], s[(i + 1) % s.len()]);
                let (c, d) = (t[j], t[(j + 1) % t.len()]);
                let w = (b - a).cross(&(d - c));
                let square = w.norm_squared();
                let p = (c - a).cross(&(d - c)).dot(&w) / square;
                let q = (c - a).cross(&(b - a)).dot(&w) / square;
                if (0.0..=1.0).contains(&p) && (0.0..=1.0).contains(&q) {
                    best = best.min((c - a).dot(&w).abs() / square.sqrt());
                }
            }
        }
    }
    best
}

/// The gap along the normal is a lower bound of the distance, and any two points are an upper one:
/// where both agree, distance and normal are right.
#[test]
fn cores_are_as_far_apart_as_brute_force_and_parry_say() {
    let random = &mut Random(2024);
    let mut worst = [[[0.0_f64; 2]; 5]; 5];
    let mut checked = 0;
    for round in 0..cases() / POSES {
        // From parts of a millimetre to a metre.
        let size = [0.5e-3, 0.05, 0.05, 1.0][round % 4];
        let (first, second) = (kinds(random, size), kinds(random, size));
        for (i, a) in first.iter().enumerate() {
            for (j, b) in second.iter().enumerate().take(i + 1) {
                let (a, b) = (solid(a), solid(b));
                let theirs = [their_core(&a, size), their_core(&b, size)];
                for _ in 0..POSES {
                    let far = 0.7 * (a.reach + b.reach) * random.uniform(0.6, 1.5);
                    let first = at(random.unit() * far, any_rotation(random));
                    let second = at(Vec3::zeros(), any_rotation(random));
                    let place_of = |s, p| Placed::new(s, p, &Vec3::zeros());
                    let (p, q) = (place_of(&a, &first), place_of(&b, &second));
                    let apart = nearest(&p, &q, f64::INFINITY);
                    if apart.part < 1.0 {
                        let both = a.rounding() + b.rounding();
                        assert!(
                            their_distance(&theirs, (&first, &second), size) < both,
                            "round {round}"
                        );
                        continue;
                    }
                    let expected = their_distance(&theirs, (&first, &second), size);
                    checked += 1;
                    assert!((apart.normal.norm() - 1.0).abs() < 1e-14);
                    let error = (apart.distance - expected).abs() / size;
                    worst[i][j][0] = worst[i][j][0].max(error);
                    // Parry stops at 5e-8 of the distance, or somewhat later, from above.
                    assert!(error < 1e-5, "round {round} {i} {j}: {apart:?} {expected}");
                    let above = (apart.distance - expected) / size;
                    assert!(above < 1e-12, "round {round} {i} {j}: {apart:?} {expected}");
                    // Curved ones and rounds that have no time: only parry's.
                    if round % 16 < 2
                        && let (Some(s), Some(t)) = (simplices(&p), simplices(&q))
                    {
                        let exact = s
                            .iter()
                            .flat_map(|s| t.iter().map(move |t| brute(s, t)))
                            .fold(f64::INFINITY, f64::min);
                        let error = (apart.distance - exact).abs() / size;
                        worst[i][j][1] = worst[i][j][1].max(error);
                        // A hull of points leaves out what is nearer than 1e-7.
                        let fuzzy = if i == 4 { 2e-7 } else { 1e-12 };
                        assert!(error < fuzzy, "round {round} {i} {j}: {apart:?} {exact}");
                        let above = (apart.distance - exact) / size;
                        assert!(above < 1e-12, "round {round} {i} {j}: {apart:?} {exact}");
                    }
                }
            }
        }
    }
    assert!(checked > 5 * cases(), "{checked}");
    if std::env::var("PAIR_CASES").is_ok() {
        let text = format!("{checked} cases; errors against parry and brute force: {worst:?}");
        std::fs::write(std::env::temp_dir().join("pair_distances.txt"), text).expect("a file");
    }
}
