//! Triangles → which of them is nearest at each sample.
//!
//! A sample belongs to a triangle if its centre is inside or on an edge. An edge that two triangles
//! share is computed from the same end in both, so that no sample between them is missed. Of two
//! triangles that are equally near, the first counts.

use super::look::{SAMPLES, workers};
use super::solid::{Stage, Triangle};
use std::ops::Range;
use urdf2fmu_core::spatial::Vec3;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// Column, row and nearness of three corners.
pub(super) type Corners = [[f32; 3]; 3];

/// The corners of all triangles in a picture.
#[allow(clippy::cast_possible_truncation, reason = "places in a picture")]
pub(super) fn project(
    triangles: &[Triangle],
    place: impl Fn(&Vec3) -> [f64; 3] + Sync,
) -> Vec<Corners> {
    let corner = |p: &Vec3| {
        let [x, y, near] = place(p);
        [x as f32, y as f32, near as f32]
    };
    triangles
        .iter()
        .map(|t| {
            [
                corner(&t.corners[0]),
                corner(&t.corners[1]),
                corner(&t.corners[2]),
            ]
        })
        .collect()
}

/// The greatest whole number that is not greater. However far away `x` is, it has a negative.
#[inline]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "floats saturate"
)]
pub(super) fn floor(x: f32) -> i32 {
    let toward_zero = (x as i32).max(1 - i32::MAX);
    toward_zero - i32::from(toward_zero as f32 > x)
}

/// A side of a triangle.
#[derive(Clone, Copy)]
struct Edge {
    /// Whether the inside lies to its left, in a picture whose rows go down.
    right: bool,
    /// A point on it, and the columns that it goes to the right in a row.
    x: f32,
    y: f32,
    slope: f32,
}

impl Edge {
    /// `None` for one along a row. Both triangles at an edge compute it from its upper end.
    #[inline]
    fn new(from: &[f32; 3], to: &[f32; 3], sign: f32) -> Option<Self> {
        let down = sign * (to[1] - from[1]);
        if down == 0.0 {
            return None;
        }
        let (p, q) = if (from[1], from[0]) <= (to[1], to[0]) {
            (from, to)
        } else {
            (to, from)
        };
        Some(Self {
            right: down > 0.0,
            x: p[0],
            y: p[1],
            slope: (q[0] - p[0]) / (q[1] - p[1]),
        })
    }
}

/// Shows each row of a triangle within a picture: its number, its samples from the first to the
/// last, the nearness at the first, and what is added from sample to sample.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to the picture"
)]
pub(super) fn rows(
    corners: &Corners,
    width: usize,
    within: &Range<usize>,
    mut row: impl FnMut(usize, Range<usize>, f32, f32),
) {
    let [a, b, c] = corners;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let sign = if area > 0.0 { 1.0 } else { -1.0 };
    let top = -floor(0.5 - a[1].min(b[1]).min(c[1]));
    let bottom = floor(a[1].max(b[1]).max(c[1]) - 0.5);
    let first = usize::try_from(top).unwrap_or(0).max(within.start);
    let Ok(last) = usize::try_from(bottom) else {
        return;
    };
    let last = last.min(within.end - 1);
    if last < first {
        return;
    }
    // Nearness = near_a + (x − xa) slope_x + (y − ya) slope_y.
    let (u, v) = (b[2] - a[2], c[2] - a[2]);
    let slope_x = (u * (c[1] - a[1]) - v * (b[1] - a[1])) / area;
    let slope_y = (v * (b[0] - a[0]) - u * (c[0] - a[0])) / area;
    let edges = [
        Edge::new(a, b, sign),
        Edge::new(b, c, sign),
        Edge::new(c, a, sign),
    ];
    let end = i32::try_from(width).unwrap_or(i32::MAX) - 1;
    for y in first..=last {
        let center = y as f32 + 0.5;
        let (mut left, mut right) = (0, end);
        for edge in edges.iter().flatten() {
            let at = edge.x + (center - edge.y) * edge.slope - 0.5;
            if edge.right {
                right = right.min(floor(at));
            } else {
                left = left.max(-floor(-at));
            }
        }
        if left <= right {
            let x = left as f32 + 0.5;
            let near = a[2] + (x - a[0]) * slope_x + (center - a[1]) * slope_y;
            row(y, left as usize..right as usize + 1, near, slope_x);
        }
    }
}

/// The nearest triangle at each sample of a picture.
pub(super) struct Layer {
    pub(super) width: usize,
    /// Places in the list of triangles, or [`NONE`].
    pub(super) triangle: Vec<u32>,
}

/// Which of 16 samples a part of the light passes: their order spreads over the square.
const ORDER: [f32; 16] = [
    0.0, 8.0, 2.0, 10.0, 12.0, 4.0, 14.0, 6.0, 3.0, 11.0, 1.0, 9.0, 15.0, 7.0, 13.0, 5.0,
];

impl Layer {
    /// Of a glass wall, as many samples of each pixel show it as its alpha says.
    pub(super) fn new(
        stage: &Stage,
        triangles: &[Triangle],
        corners: &[Corners],
        width: usize,
        height: usize,
    ) -> Self {
        let mut triangle = vec![NONE; width * height];
        let band = height.div_ceil(workers()).next_multiple_of(SAMPLES);
        std::thread::scope(|scope| {
            for (i, band_triangle) in triangle.chunks_mut(band * width).enumerate() {
                let rows_here = i * band..(i * band + band_triangle.len() / width);
                scope.spawn(move || {
                    let mut near = vec![0.0_f32; band_triangle.len()];
                    for (t, (own, corners)) in (0..).zip(triangles.iter().zip(corners)) {
                        let alpha = stage.surfaces[own.surface].alpha;
                        rows(corners, width, &rows_here, |y, xs, start, slope| {
                            let offset = (y - rows_here.start) * width;
                            let mut depth = start;
                            for x in xs {
                                let place = offset + x;
                                let seen =
                                    alpha >= 1.0 || ORDER[(y % 4) * 4 + x % 4] < alpha * 16.0 - 0.5;
                                if depth > near[place] && seen {
                                    near[place] = depth;
                                    band_triangle[place] = t;
                                }
                                depth += slope;
                            }
                        });
                    }
                });
            }
        });
        Self { width, triangle }
    }
}

/// How near the nearest triangle is, in a square picture.
pub(super) struct Depth {
    pub(super) side: usize,
    pub(super) near: Vec<f32>,
}

impl Depth {
    pub(super) fn new(corners: impl Iterator<Item = Corners>, side: usize) -> Self {
        let mut near = vec![f32::NEG_INFINITY; side * side];
        for corners in corners {
            rows(&corners, side, &(0..side), |y, xs, start, slope| {
                let mut depth = start;
                for place in &mut near[y * side + xs.start..y * side + xs.end] {
                    *place = place.max(depth);
                    depth += slope;
                }
            });
        }
        Self { side, near }
    }
}

#[cfg(test)]
mod tests {
    use super::floor;

    #[test]
    fn whole_numbers_of_places_far_away_have_negatives() {
        let near = [(2.0, 2), (2.5, 2), (-0.5, -1), (-3.0, -3), (0.0, 0)];
        for (x, whole) in near {
            assert_eq!(floor(x), whole);
        }
        for x in [1e30, f32::INFINITY, -1e30, f32::NEG_INFINITY, f32::NAN] {
            let whole = floor(x);
            assert_eq!(whole.checked_neg().map(f64::from), Some(-f64::from(whole)));
        }
        assert!(floor(1e30) > 2_000_000_000 && floor(-1e30) < -2_000_000_000);
    }
}
