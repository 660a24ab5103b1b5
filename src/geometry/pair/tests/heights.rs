//! Shapes on terrain of heights.

use super::*;
use crate::geometry::field::{Field, Samples};
use std::sync::Arc;

/// Heights over a square of 2 m about the origin, `cells` along each side.
fn heights(cells: usize, height: impl Fn(f64, f64) -> f64) -> Arc<Field> {
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let place = |i: usize| 2.0 * (i as f64 / cells as f64) - 1.0;
    let rows = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
    let samples = Samples {
        size: [2.0; 2],
        counts: [cells + 1; 2],
        heights: rows.map(|(i, j)| height(place(i), place(j))).collect(),
    };
    Arc::new(Field::try_from(samples).expect("a grid"))
}

/// Least distance of a place from the surface, by a look at ever smaller squares about the nearest
/// place so far.
fn distance(field: &Field, c: &Vec3) -> f64 {
    let (mut x, mut y, mut around) = (c.x, c.y, 0.1);
    let mut least = f64::INFINITY;
    for _ in 0..14 {
        let (middle_x, middle_y) = (x, y);
        for i in -10..=10 {
            for j in -10..=10 {
                let u = middle_x + 0.1 * around * f64::from(i);
                let v = middle_y + 0.1 * around * f64::from(j);
                let height = field.at(u, v).expect("inside").height;
                let apart = (Vec3::new(u, v, height) - c).norm();
                if apart < least {
                    (least, x, y) = (apart, u, v);
                }
            }
        }
        around *= 0.3;
    }
    least
}

/// A ball on smooth hills touches them in one point, at the place nearest to its middle: samples of
/// a surface that turns by less than a degree from one cell to the next are no spikes.
#[test]
fn a_ball_touches_smooth_hills_at_the_nearest_place_alone() {
    let seed = 12;
    let mut random = Random(seed);
    let field = heights(80, |x, y| 0.04 * libm::sin(4.0 * x) * libm::cos(3.0 * y));
    let radius = 0.1;
    let hills = Shape::Field {
        field: field.clone(),
    };
    let ball = Shape::Sphere { radius };
    for case in 0..100 {
        // Every second one above a sample on a crest.
        let (x, y) = if case % 2 == 0 {
            (random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8))
        } else {
            (0.4, 0.025 * f64::from(case % 20 - 10))
        };
        let local = field.at(x, y).expect("inside");
        let touching = Vec3::new(x, y, local.height) + local.normal() * (radius - 1e-3);
        let patch = find(
            (&ball, at(touching, Mat3::identity())),
            (&hills, Pose::IDENTITY),
            1e-3,
        );
        let expected = radius - distance(&field, &touching);
        let points = patch.points();
        assert_eq!(points.len(), 1, "seed {seed}, case {case}");
        assert!(
            (points[0].depth - expected).abs() < 1e-12,
            "seed {seed}, case {case}: {:e} {expected:e}",
            points[0].depth
        );
    }
}

/// The middle of a ball that is `d` deep in both the floor before a slope and the slope is at the
/// height `R − d` and at as much from the slope, so `(R − d) tan(θ/2)` before its foot. A wheel
/// across the slope and a capsule touch it likewise, with both ends.
#[test]
fn a_ball_at_the_foot_of_a_slope_touches_both() {
    use std::f64::consts::FRAC_PI_2;
    let (radius, half_length, deep) = (0.1, 0.03, 1e-4);
    let lying = *nalgebra::Rotation3::from_euler_angles(FRAC_PI_2, 0.0, 0.0).matrix();
    let ball = Shape::Sphere { radius };
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    let wheel = Shape::Cylinder {
        radius,
        half_length,
    };
    for (cells, cell) in [(80, 0.025), (400, 0.005)] {
        for angle in [0.35, FRAC_PI_2 / 2.0, 1.3] {
            let slope = libm::tan(angle);
            let field = heights(cells, |x, _| slope * (x - 0.2).max(0.0));
            let hills = Shape::Field { field };
            for (name, shape, R, count) in [
                ("ball", &ball, Mat3::identity(), 1),
                ("capsule", &capsule, lying, 2),
                ("wheel", &wheel, lying, 2),
            ] {
                let ahead = (radius - deep) * libm::tan(0.5 * angle);
                let middle = Vec3::new(0.2 - ahead, 0.013, radius - deep);
                if ahead * libm::cos(angle) < 1.1 * cell {
                    // It touches the cell in which the surface turns.
                    continue;
                }
                let patch = find((shape, at(middle, R)), (&hills, Pose::IDENTITY), 1e-3);
                let normals = [
                    Vec3::z(),
                    Vec3::new(-libm::sin(angle), 0.0, libm::cos(angle)),
                ];
                for normal in normals {
                    let points = patch.points().iter();
                    let own = points.filter(|p| (p.normal - normal).norm() < 1e-6);
                    let depths: Vec<f64> = own.map(|p| p.depth).collect();
                    assert!(
                        depths.len() == count && depths.iter().all(|d| (d - deep).abs() < 1e-6),
                        "{name}, {angle}, {cells} cells, {normal}: {depths:?}"
                    );
                }
                assert_eq!(
                    patch.points().len(),
                    2 * count,
                    "{name}, {angle}, {cells} cells"
                );
            }
        }
    }
}

/// Height of the middle of a circle of the radius `r` that rolls over heights which change along x
/// alone, where its middle is at `x`: the highest at which it touches; and the normal there.
fn rolled(field: &Field, x: f64, r: f64) -> (f64, Vec3) {
    let height = |u: f64| {
        let ground = field.at(u, 0.013).expect("inside").height;
        ground + (r * r - (u - x) * (u - x)).max(0.0).sqrt()
    };
    let (mut middle, mut around) = (x, r);
    for _ in 0..14 {
        let near = (-100..=100).map(|k| middle + around * f64::from(k) / 100.0);
        let within = near.filter(|u| (u - x).abs() <= r);
        let higher = |best: f64, u| if height(u) > height(best) { u } else { best };
        middle = within.fold(middle, higher);
        around *= 0.1;
    }
    let z = height(middle);
    let ground = z - (r * r - (middle - x) * (middle - x)).max(0.0).sqrt();
    (z, Vec3::new(x - middle, 0.0, z - ground) / r)
}

/// What is round and rolls over a step of heights touches its edge all the way, as deep and in the
/// same direction as a search over the whole circle says. Such an edge is much sharper than a wheel
/// and bends within a cell, so Newton's method goes beyond it, and the place on the floor in the
/// next cell is as near. A wheel of 10 cm met nothing there at one of six places.
#[test]
fn what_rolls_over_a_step_of_heights_touches_it_all_the_way() {
    use std::f64::consts::FRAC_PI_2;
    let (radius, half_length, deep) = (0.1, 0.03, 1e-4);
    let lying = *nalgebra::Rotation3::from_euler_angles(FRAC_PI_2, 0.0, 0.0).matrix();
    let capsule = Shape::Capsule {
        radius,
        half_length,
    };
    let wheel = Shape::Cylinder {
        radius,
        half_length,
    };
    let shapes = [
        ("ball", Shape::Sphere { radius }, Mat3::identity()),
        ("capsule", capsule, lying),
        ("wheel", wheel, lying),
    ];
    for (cells, step) in [
        (80, 0.01),
        (80, 0.03),
        (200, 0.01),
        (200, 0.03),
        (400, 0.03),
    ] {
        let field = heights(cells, |x, _| if x > 0.201 { step } else { 0.0 });
        let hills = Shape::Field {
            field: field.clone(),
        };
        for k in 0..200 {
            let x = 0.05 + 0.25 * f64::from(k) / 200.0;
            let (z, normal) = rolled(&field, x, radius - deep);
            for (name, shape, R) in &shapes {
                let middle = at(Vec3::new(x, 0.013, z), *R);
                let patch = find((shape, middle), (&hills, Pose::IDENTITY), 1e-3);
                let mut points = patch.points().iter();
                let touches = points
                    .any(|p| (p.depth - deep).abs() < 1e-9 && (p.normal - normal).norm() < 1e-5);
                let depths = patch.points().iter().map(|p| p.depth);
                let deepest = depths.fold(f64::NEG_INFINITY, f64::max);
                assert!(
                    touches && deepest < deep + 1e-9,
                    "{name}, {cells} cells, step of {step} m, at {x}: {deepest:e}"
                );
            }
        }
    }
}

/// A point of a rim comes deeper as fast as the rim moves against the normal there, whichever way a
/// cylinder stands, leans or lies on rough heights: else the work of its force is not what the
/// depth stores. Where the ground is nearest to the middle of the rim it did by a seventh of that.
#[test]
fn a_cylinder_on_rough_heights_moves_as_its_rows_say() {
    let seed = 13;
    let mut random = Random(seed);
    let rough: Vec<f64> = (0..121).map(|_| random.uniform(-0.03, 0.03)).collect();
    let field = heights(10, |x, y| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a sample of the grid"
        )]
        let index = |x: f64| (5.0 * (x + 1.0)).round() as usize;
        rough[11 * index(y) + index(x)]
    });
    let hills = Shape::Field { field };
    let wheel = Shape::Cylinder {
        radius: 0.15,
        half_length: 0.04,
    };
    let rims = |pose: Pose| {
        let patch = find((&wheel, pose), (&hills, Pose::IDENTITY), 1e-2);
        let own = patch.points().iter().filter(|p| p.rim.is_some());
        // Those between the ends have less.
        let own = own.filter(|p| p.share > 0.2);
        own.copied().collect::<Vec<_>>()
    };
    let mut seen = 0;
    for case in 0..1000 {
        let R = any_rotation(&mut random);
        let (x, y) = (random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7));
        let (mut low, mut high) = (-0.1, 0.4);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let found = rims(at(Vec3::new(x, y, middle), R));
            if found.iter().any(|p| p.depth > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let p = Vec3::new(x, y, high);
        let (v, w) = (random.unit(), random.unit() * 5.0);
        let time = 1e-6;
        let moved = |t: f64| rims(at(p + v * t, turned(w, w.norm() * t) * R));
        let (before, after) = (moved(-time), moved(time));
        for point in rims(at(p, R)).iter().filter(|p| p.depth.abs() < 1e-5) {
            let same = |found: &[PatchPoint]| {
                let near = |q: &&PatchPoint| (q.x - point.x).norm() < 1e-3;
                found.iter().find(near).map(|q| q.depth)
            };
            let (Some(first), Some(last)) = (same(&before), same(&after)) else {
                continue;
            };
            let found = (last - first) / (2.0 * time);
            let row = -point.normal.dot(&(v + w.cross(&(point.x - p))));
            seen += 1;
            assert!(
                (found - row).abs() < 0.01,
                "seed {seed}, case {case}: {found} {row}, {point:?}"
            );
        }
    }
    assert!(seen > 800, "{seen}");
}

/// A log across a ridge lies on its crest, at a sample, where both of its ends hang over rough
/// ground far below.
#[test]
fn a_log_across_a_ridge_lies_on_it_with_its_ends_over_rough_ground() {
    use std::f64::consts::FRAC_PI_2;
    let along = *nalgebra::Rotation3::from_euler_angles(0.0, FRAC_PI_2, 0.0).matrix();
    let (radius, deep) = (0.05, 1e-3);
    let field = heights(800, |x, y| {
        let rough = 0.005 * libm::cos(40.0 * x) * libm::cos(40.0 * y);
        0.2 * libm::exp(-(x * x) / 0.02) + rough
    });
    let crest = 0.205;
    let log = Shape::Cylinder {
        radius,
        half_length: 0.8,
    };
    let hills = Shape::Field { field };
    let middle = Vec3::new(0.0, 0.0, crest + radius - deep);
    let patch = find((&log, at(middle, along)), (&hills, Pose::IDENTITY), 1e-3);
    // Samples on the crest, which bends by little from one to the next, act with a small share.
    let own = patch.points().iter().filter(|p| p.rim.is_some());
    let deepest = own.map(|p| p.depth).fold(f64::NEG_INFINITY, f64::max);
    // One of the places along the log that are looked at is its middle.
    assert!((deepest - deep).abs() < 1e-9, "{deepest:e}");
}
