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
