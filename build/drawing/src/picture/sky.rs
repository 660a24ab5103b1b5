//! The pictures of lamps of the sky, three at a time: most triangles lie between the samples of
//! most of them, and one look at its corners tells this for all three.

use super::aim::{Aim, Point, place};
use super::depth::{draw, hidden};
use super::rows::{Rows, greatest, least};
use std::ops::Range;

/// Lamps whose pictures are drawn together.
pub(super) const LAMPS: usize = 3;

/// Bits of a number in a cell: as many as a picture of 256 samples needs, and a free one above.
const BITS: u32 = 10;

/// The greatest such number.
const MOST: u64 = (1 << (BITS - 1)) - 1;

/// The lowest bit of each number of a cell.
const LOWEST: u64 =
    1 | 1 << BITS | 1 << (2 * BITS) | 1 << (3 * BITS) | 1 << (4 * BITS) | 1 << (5 * BITS);

/// From a column to a row.
const TO_ROW: u32 = 3 * BITS;

/// Twice the last sample whose centre is not behind a place, and one more where it is on that
/// centre, of a place within a picture.
#[inline]
#[allow(clippy::float_cmp, reason = "a place is on a centre or is not")]
fn cell(x: f32) -> u64 {
    /// A number this large has no digits behind the point, and the last ones before it are its
    /// lowest bits.
    const LARGE: f32 = 12_582_912.0;
    let x = x - 0.5;
    let large = x + LARGE;
    let nearest = large - LARGE;
    let on = u32::from(nearest == x);
    let behind = u32::from(nearest > x);
    u64::from(
        2_u32
            .wrapping_mul(large.to_bits().wrapping_sub(behind))
            .wrapping_add(on),
    ) & MOST
}

/// The cell of a point: three columns, and above them three rows.
#[inline]
fn cells(aims: &[Aim; LAMPS], point: &Point) -> u64 {
    let mut all = 0;
    for aim in aims.iter().rev() {
        let [x, y, _] = place(aim, point);
        all = all << BITS | cell(x) | cell(y) << TO_ROW;
    }
    all
}

/// Whole numbers of samples between three corners; there is one.
#[inline]
fn between(cells: [u64; 3], shift: u32) -> Range<usize> {
    #[allow(clippy::cast_possible_truncation, reason = "a few hundred")]
    let [a, b, c] = cells.map(|cell| (cell >> shift & MOST) as usize);
    let low = |cell: usize| cell / 2 + 1 - cell % 2;
    let end = a.max(b).max(c) / 2 + 1;
    low(a).min(low(b)).min(low(c))..end
}

/// How near the nearest triangle is at each pixel of some pictures, all points within them.
///
/// - `count`: pictures that are drawn, at most [`LAMPS`]
/// - `faces`: places in `points`
pub(super) fn nearest(
    aims: &[Aim; LAMPS],
    count: usize,
    points: &[Point],
    faces: &[[u32; 3]],
    side: usize,
) -> Vec<Vec<f32>> {
    /// What is added to each number so that its free bit tells whether it was zero.
    const FILL: u64 = LOWEST * MOST;
    let cells: Vec<u64> = points.iter().map(|point| cells(aims, point)).collect();
    let drawn = (LOWEST << (BITS - 1)) & ((1 << (BITS as usize * count)) - 1);
    let mut near = vec![vec![f32::NEG_INFINITY; side * side]; count];
    let mut waiting = [(); LAMPS].map(|()| Rows::new());
    for face in faces {
        let of = face.map(|i| cells[i as usize]);
        let [a, b, c] = of;
        // A triangle whose corners have one even number lies between two centres.
        let apart = ((a ^ b) | (a ^ c) | (a & LOWEST)) + FILL;
        let mut some = apart & apart >> TO_ROW & drawn;
        while some != 0 {
            let lamp = (some.trailing_zeros() / BITS) as usize;
            some &= some - 1;
            let (aim, near, waiting) = (&aims[lamp], &mut near[lamp], &mut waiting[lamp]);
            #[allow(clippy::cast_possible_truncation, reason = "one of three")]
            let shift = lamp as u32 * BITS;
            let columns = between(of, shift);
            let rows = between(of, shift + TO_ROW);
            let points = face.map(|i| &points[i as usize]);
            let corners = points.map(|point| place(aim, point));
            let [a, b, c] = corners.map(|corner| corner[2]);
            let nearest = greatest(greatest(a, b), c);
            // Of two rows and columns the outermost pixels are all: most triangles need no loop.
            let few = columns.len() <= 2 && rows.len() <= 2;
            if few {
                let known = |y: usize, x: usize| near.get(y * side + x).copied();
                let known = |y, x| known(y, x).unwrap_or(f32::INFINITY);
                let (left, right) = (columns.start, columns.end - 1);
                let [upper, lower] =
                    [rows.start, rows.end - 1].map(|y| least(known(y, left), known(y, right)));
                if least(upper, lower) >= nearest {
                    continue;
                }
            }
            for y in rows {
                if (few || !hidden(near, side, y, &columns, nearest)) && waiting.add(&corners, 0, y)
                {
                    draw(waiting, near, side);
                }
            }
        }
    }
    for (near, waiting) in near.iter_mut().zip(&mut waiting) {
        draw(waiting, near, side);
    }
    near
}

#[cfg(test)]
mod tests {
    use super::super::depth::Depth;
    use super::super::raster::Places;
    use super::*;

    /// Pictures drawn together are those that are drawn alone.
    #[test]
    fn pictures_drawn_together_are_those_drawn_alone() {
        let side = 40;
        let mut number = 1_u32;
        let mut random = |end: u16| {
            number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from(u16::try_from(number >> 16).unwrap_or(0) % (4 * end)) / 4.0
        };
        // Small triangles, many of which have corners on centres, and some large ones.
        let near_each_other = |i: u16| {
            let [x, y] = [i / 3 * 5 % 60, i / 3 * 11 % 56].map(|x| f32::from(x) / 4.0);
            [x + random(2), y + random(2), random(17)]
        };
        let points: Vec<Point> = (0..900).map(near_each_other).collect();
        let small = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let large = (0..30).map(|i| [i, 7 * i + 1, 11 * i + 2]);
        let faces: Vec<[u32; 3]> = small.chain(large).collect();
        let aims: [Aim; LAMPS] = [
            [
                [1.0, 0.0, 0.0, 5.0],
                [0.0, 1.0, 0.0, 5.0],
                [0.0, 0.0, 1.0, 0.0],
            ],
            [
                [0.0, 1.0, 0.5, 5.0],
                [1.0, 0.0, 0.25, 5.0],
                [0.3, 0.4, 0.5, 0.0],
            ],
            [
                [0.7, 0.0, 0.7, 5.2],
                [0.0, 0.9, 0.0, 5.1],
                [0.7, 0.0, -0.7, 0.0],
            ],
        ];
        for count in 1..=LAMPS {
            let together = nearest(&aims, count, &points, &faces, side);
            assert_eq!(together.len(), count);
            for (near, aim) in together.iter().zip(&aims) {
                let places = Places::new(points.iter().map(|point| place(aim, point)));
                let alone = Depth::new(&places, faces.iter().copied(), side, [2, 1]);
                assert!(near.iter().filter(|x| **x > f32::NEG_INFINITY).count() > 60);
                assert_eq!(*near, alone.near);
            }
        }
    }
}
