//! Lifts with which shapes touch triangles, against all places where polyhedra can touch.

use super::super::Lifted;
use super::*;

/// The height of a plane triangle above or below a place, m.
fn above(x: f64, y: f64, [a, b, c]: &[Vec3; 3]) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let area = u.x * v.y - u.y * v.x;
    let (dx, dy) = (x - a.x, y - a.y);
    let s = (dx * v.y - dy * v.x) / area;
    let t = (u.x * dy - u.y * dx) / area;
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then(|| a.z + s * u.z + t * v.z)
}

/// By how much the segment `p` is to be lifted so that it crosses the segment `q`, m.
fn crossing(p: [Vec3; 2], q: [Vec3; 2]) -> Option<f64> {
    let (u, v, w) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
    let area = u.x * v.y - u.y * v.x;
    let s = (w.x * v.y - w.y * v.x) / area;
    let t = (w.x * u.y - w.y * u.x) / area;
    let inside = |x: f64| (0.0..=1.0).contains(&x);
    (inside(s) && inside(t)).then(|| w.z + t * v.z - s * u.z)
}

/// The least and the greatest lift of the hull of `corners`, m: where it touches first, a corner
/// meets the triangle, a corner of the triangle the hull, or an edge an edge. All segments and
/// triangles between corners are in the hull, and its edges and faces are among them.
pub(crate) fn lifts(corners: &[Vec3], triangle: &[Vec3; 3]) -> Option<[f64; 2]> {
    let mut all = Vec::new();
    let [a, b, c] = *triangle;
    for (i, p) in corners.iter().enumerate() {
        all.extend(above(p.x, p.y, triangle).map(|z| z - p.z));
        for (j, q) in corners[..i].iter().enumerate() {
            let sides = [[a, b], [b, c], [c, a]];
            all.extend(sides.into_iter().filter_map(|s| crossing([*p, *q], s)));
            for r in &corners[..j] {
                let face = [*p, *q, *r];
                let heights = triangle.iter();
                all.extend(heights.filter_map(|x| Some(x.z - above(x.x, x.y, &face)?)));
            }
        }
    }
    let least = all.iter().copied().reduce(f64::min)?;
    Some([least, all.into_iter().reduce(f64::max)?])
}

/// Boxes, thin plates, hulls, polygons and rods at any attitude, at any height above or below
/// triangles of all sizes.
#[test]
fn polyhedra_touch_triangles_at_the_lifts_of_their_corners_and_edges() {
    let mut random = Random(0x51_7C_C1_B7);
    let mut met = 0;
    for round in 0..3000 {
        let thin = [1.0, 0.1, 1e-3, 0.0][round % 4];
        let sides = Vec3::new(1.0, random.uniform(0.2, 1.0), thin);
        let count = [8, 12, 4, 2][round / 4 % 4];
        let own: Vec<Vec3> = if count == 8 && thin > 0.0 {
            crate::geometry::tests::corners(&sides)
        } else {
            let places = (0..count).map(|_| random.vector(1.0).component_mul(&sides));
            places.collect()
        };
        let shape = if own.len() == 8 && thin > 0.0 {
            Shape::Box { half: sides }
        } else {
            Shape::Hull {
                vertices: own.clone(),
            }
        };
        let X = at(random.vector(2.0) * 5.0, any_rotation(&mut random));
        let place = X.p + Vec3::z() * random.uniform(-20.0, 20.0);
        let size = [0.1, 1.0, 10.0, 1000.0][round / 16 % 4];
        let triangle = [(); 3].map(|()| place + random.vector(size) + random.vector(1.0));
        let corners: Vec<Vec3> = own.iter().map(|c| X.point(c)).collect();
        let expected = lifts(&corners, &triangle);
        let lifted = Lifted::new(&shape, &X).expect("a convex shape");
        let found = lifted.touching(&triangle, f64::NEG_INFINITY);
        let tolerance = 1e-9 * (1.0 + size);
        match (expected, found) {
            (Some(expected), Some(found)) => {
                met += 1;
                for (found, expected) in found.into_iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(off < tolerance, "{round}: {found} {expected}");
                }
            }
            // What grazes it may be missed, or met.
            (Some([least, most]), None) | (None, Some([least, most])) => {
                assert!(
                    most - least < 1e-6 * size,
                    "{round}: {expected:?} {found:?}"
                );
            }
            (None, None) => {}
        }
    }
    assert!(met > 1000, "{met}");
}

/// A wheel is between the prisms with 32 sides in it and about it; balls and capsules touch a slope
/// and a point where Pythagoras says.
#[test]
fn round_shapes_touch_triangles_where_their_curves_do() {
    let mut random = Random(0x2545_F491);
    for _ in 0..30 {
        let (radius, half_length) = (random.uniform(0.1, 1.0), random.uniform(1e-3, 0.5));
        let X = at(random.vector(1.0), any_rotation(&mut random));
        let prism = |radius: f64| -> Vec<Vec3> {
            let angle = |i: i32| std::f64::consts::PI / 16.0 * f64::from(i % 32);
            let corner = |i: i32| {
                let (sin, cos) = libm::sincos(angle(i));
                let z = if i < 32 { half_length } else { -half_length };
                X.point(&Vec3::new(radius * cos, radius * sin, z))
            };
            (0..64).map(corner).collect()
        };
        let triangle = [(); 3].map(|()| X.p + random.vector(1.5));
        let shape = Shape::Cylinder {
            radius,
            half_length,
        };
        let found = Lifted::new(&shape, &X)
            .and_then(|lifted| lifted.touching(&triangle, f64::NEG_INFINITY));
        let inner = lifts(&prism(radius), &triangle);
        let outer = lifts(
            &prism(radius / libm::cos(std::f64::consts::PI / 32.0)),
            &triangle,
        );
        if let Some([least, most]) = inner {
            let [low, high] = found.expect("more than the prism in it");
            assert!(low < least + 1e-9 && high > most - 1e-9);
        }
        if let Some([low, high]) = found {
            let [least, most] = outer.expect("less than the prism about it");
            assert!(low > least - 1e-9 && high < most + 1e-9);
        }
    }
    // Up along x with a slope of 0.75: the normal is (-0.6, 0, 0.8).
    let slope = [[-9.0, -9.0], [9.0, -9.0], [0.0, 18.0]].map(|[x, y]| Vec3::new(x, y, 0.75 * x));
    let X = at(
        Vec3::new(0.4, 0.1, 7.0),
        turned(Vec3::y(), 0.5 * std::f64::consts::PI),
    );
    let shapes = [
        (Shape::Sphere { radius: 0.2 }, 0.3 + 0.2 / 0.8),
        (
            Shape::Capsule {
                radius: 0.2,
                half_length: 1.0,
            },
            1.05 + 0.2 / 0.8,
        ),
    ];
    let up = f64::NEG_INFINITY;
    for (shape, height) in &shapes {
        let lifted = Lifted::new(shape, &X).expect("a shape");
        let [_, most] = lifted.touching(&slope, up).expect("it is over the slope");
        assert!((7.0 + most - height).abs() < 1e-12, "{most} {height}");
    }
    // A small triangle whose highest corner is 0.12 m beside the middle: 0.16 m below it.
    let tip = Vec3::new(0.4, 0.22, -3.0);
    let low = [0.01, -0.01].map(|x| tip + Vec3::new(x, 0.0, -1.0));
    let lifted = Lifted::new(&shapes[0].0, &X).expect("a ball");
    let [_, most] = lifted.touching(&[tip, low[0], low[1]], up).expect("below");
    assert!((7.0 + most - (-3.0 + 0.16)).abs() < 1e-12, "{most}");
}
