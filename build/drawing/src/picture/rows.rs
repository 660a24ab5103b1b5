//! Rows of triangles → which samples of each row are inside, and how near they are.
//!
//! Most triangles have one or two rows, and which of their sides is where cannot be foretold. So
//! rows wait until there are some, and are then computed together, without a branch: compilers make
//! one instruction of the same step for several of them.

use std::ops::Range;

/// Rows that are computed together.
const LANES: usize = 16;

/// Column, row and nearness of three corners.
pub(super) type Corners = [[f32; 3]; 3];

/// The greatest whole number that is not greater; what is beyond four million is only near it.
#[inline]
fn whole(x: f32) -> f32 {
    /// Numbers this large have no digits behind the point.
    const LARGE: f32 = 12_582_912.0;
    let nearest = (x + LARGE) - LARGE;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// The lesser of a number and of another one, which may be no number: one instruction, unlike that
/// of the standard library, where either may be none.
#[inline]
pub(super) fn least(x: f32, other: f32) -> f32 {
    if other < x { other } else { x }
}

/// The greater one, likewise.
#[inline]
pub(super) fn greatest(x: f32, other: f32) -> f32 {
    if other > x { other } else { x }
}

/// Rows of triangles that wait. They are drawn in the order in which they came.
pub(super) struct Rows {
    count: usize,
    /// Column, row and nearness of the three corners, each of all triangles.
    corners: [[[f32; LANES]; 3]; 3],
    /// Middles of the rows.
    center: [f32; LANES],
    /// Of each its triangle, as the caller numbers it, and the row.
    known: [(u32, usize); LANES],
}

/// Which columns are inside, as whole numbers, and how near they are.
struct Spans {
    first: [f32; LANES],
    last: [f32; LANES],
    /// Nearness of the first.
    near: [f32; LANES],
    /// What is added from column to column.
    slope: [f32; LANES],
}

impl Rows {
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            corners: [[[0.0; LANES]; 3]; 3],
            center: [0.0; LANES],
            known: [(0, 0); LANES],
        }
    }

    /// Adds a row; whether all must be drawn before there is room for another one.
    #[inline]
    #[allow(clippy::cast_precision_loss, reason = "a row of a picture")]
    pub(super) fn add(&mut self, corners: &Corners, triangle: u32, row: usize) -> bool {
        // A place that is there, as compilers see.
        let l = self.count % LANES;
        for (all, corner) in self.corners.iter_mut().zip(corners) {
            for (all, x) in all.iter_mut().zip(corner) {
                all[l] = *x;
            }
        }
        self.center[l] = row as f32 + 0.5;
        self.known[l] = (triangle, row);
        self.count = l + 1;
        self.count == LANES
    }

    /// Shows each row that has samples in a picture: its triangle and its number, its samples from
    /// the first to the last, the nearness at the first, and what is added from sample to sample.
    #[inline]
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "clamped to the picture"
    )]
    pub(super) fn draw(
        &mut self,
        width: usize,
        mut show: impl FnMut(u32, usize, Range<usize>, f32, f32),
    ) {
        let spans = self.spans(width as f32 - 1.0);
        for l in 0..self.count.min(LANES) {
            let (first, last) = (spans.first[l], spans.last[l]);
            if first <= last {
                let (triangle, row) = self.known[l];
                let columns = first as usize..last as usize + 1;
                show(triangle, row, columns, spans.near[l], spans.slope[l]);
            }
        }
        self.count = 0;
    }

    /// - `end`: the last column of the picture
    #[inline(never)]
    fn spans(&self, end: f32) -> Spans {
        let mut spans = Spans {
            first: [0.0; LANES],
            last: [0.0; LANES],
            near: [0.0; LANES],
            slope: [0.0; LANES],
        };
        for l in 0..LANES {
            let corner = |k: usize| [0, 1, 2].map(|i| self.corners[k][i][l]);
            let (a, b, c) = (corner(0), corner(1), corner(2));
            let center = self.center[l];
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            // Nearness = near_a + (x − xa) slope_x + (y − ya) slope_y.
            let (u, v) = (b[2] - a[2], c[2] - a[2]);
            let slope_x = (u * (c[1] - a[1]) - v * (b[1] - a[1])) / area;
            let slope_y = (v * (b[0] - a[0]) - u * (c[0] - a[0])) / area;
            let mut last = end;
            // The first column with the other sign.
            let mut first = 0.0;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let [right, left] = side(from, to, area > 0.0, center);
                last = least(last, right);
                first = least(first, left);
            }
            let first = 0.0 - first;
            let x = first + 0.5;
            spans.near[l] = a[2] + (x - a[0]) * slope_x + (center - a[1]) * slope_y;
            spans.slope[l] = slope_x;
            spans.first[l] = first;
            // What has no area has no sample.
            let inside = area != 0.0 && area.abs() < f32::INFINITY;
            spans.last[l] = if inside { last } else { -1.0 };
        }
        spans
    }
}

/// The last column to the left of a side that ends a triangle, or the first to the right of one
/// that begins it with the other sign; the other one of both, and that of a side along the row, is
/// infinite. Both triangles at a side compute it from its upper end.
///
/// - `right`: whether the inside lies to the right of a side that goes down, in a picture whose
///   rows go down
#[inline]
fn side(from: [f32; 3], to: [f32; 3], right: bool, center: f32) -> [f32; 2] {
    let down = to[1] - from[1];
    let up = from[1] > to[1];
    let x = if up { to[0] } else { from[0] };
    let y = if up { to[1] } else { from[1] };
    // The same from either end.
    let slope = (to[0] - from[0]) / down;
    let at = x + (center - y) * slope - 0.5;
    let ends = right != up;
    let column = whole(if ends { at } else { -at });
    let column = if down == 0.0 { f32::INFINITY } else { column };
    if ends {
        [column, f32::INFINITY]
    } else {
        [f32::INFINITY, column]
    }
}

#[cfg(test)]
mod tests {
    use super::super::raster::floor;
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "whole numbers")]
    fn whole_numbers_as_floats_are_the_same_within_any_picture() {
        for i in i16::MIN..=i16::MAX {
            let x = f32::from(i) * 0.37;
            assert_eq!(f64::from(whole(x)), f64::from(floor(x)), "{x}");
            assert_eq!(f64::from(whole(x.round())), f64::from(x.round()), "{x}");
        }
        assert!(whole(1e30) > 4e6 && whole(-1e30) < -4e6);
    }
}
