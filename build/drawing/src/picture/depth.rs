//! How near the robot is to a lamp, at each pixel of the lamp's picture.

use super::raster::{Places, within};
use super::rows::{Rows, greatest};
use std::ops::Range;

/// Columns up to which a row of a triangle is compared with what is known before it is drawn.
const SMALL: usize = 3;

/// How near the nearest triangle is, in a square picture.
pub(super) struct Depth {
    pub(super) side: usize,
    pub(super) near: Vec<f32>,
    tiles: Tiles,
}

/// The nearest in each of the squares that a picture is cut into, and a little beyond them to the
/// right and below: what is nearer than this is not hidden, and needs no look at pixels.
struct Tiles {
    /// A square has two to the power of this pixels along each side.
    shift: u32,
    across: usize,
    nearest: Vec<f32>,
}

impl Tiles {
    /// - `more`: pixels beyond each square
    fn new(near: &[f32], side: usize, shift: u32, more: usize) -> Self {
        let length = 1 << shift;
        let across = side.div_ceil(length);
        let mut nearest = Vec::with_capacity(across * across);
        let mut columns = vec![0.0; side];
        for first in (0..side).step_by(length) {
            columns.fill(f32::NEG_INFINITY);
            let rows = near.chunks_exact(side).skip(first);
            for row in rows.take(length + more) {
                for (column, near) in columns.iter_mut().zip(row) {
                    *column = greatest(*column, *near);
                }
            }
            nearest.extend((0..side).step_by(length).map(|first| {
                let own = &columns[first..side.min(first + length + more)];
                own.iter().copied().fold(f32::NEG_INFINITY, greatest)
            }));
        }
        Self {
            shift,
            across,
            nearest,
        }
    }
}

/// Whether all that is known of a row's few pixels is nearer: what lies behind changes nothing.
#[inline]
pub(super) fn hidden(
    near: &[f32],
    side: usize,
    row: usize,
    columns: &Range<usize>,
    nearest: f32,
) -> bool {
    let pixels = || near.get(row * side + columns.start..row * side + columns.end);
    columns.len() <= SMALL
        && pixels().is_none_or(|pixels| pixels.iter().all(|known| *known >= nearest))
}

/// Draws rows that wait.
pub(super) fn draw(waiting: &mut Rows, near: &mut [f32], side: usize) {
    waiting.draw(side, |_, y, xs, start, slope| {
        let mut depth = start;
        for place in &mut near[y * side + xs.start..y * side + xs.end] {
            *place = greatest(*place, depth);
            depth += slope;
        }
    });
}

impl Depth {
    /// - `places`: those of the corners of `faces`
    /// - `tiles`: see [`Depth::of`]
    pub(super) fn new(
        places: &Places,
        faces: impl Iterator<Item = [u32; 3]>,
        side: usize,
        tiles: [u8; 2],
    ) -> Self {
        let mut near = vec![f32::NEG_INFINITY; side * side];
        let picture = 0..side;
        let mut waiting = Rows::new();
        for placed in faces.filter_map(|face| places.triangle(face)) {
            let columns = within(placed.columns, &picture);
            let [a, b, c] = placed.corners.map(|corner| corner[2]);
            let nearest = a.max(b).max(c);
            for y in within(placed.rows, &picture) {
                if !hidden(&near, side, y, &columns, nearest) && waiting.add(&placed.corners, 0, y)
                {
                    draw(&mut waiting, &mut near, side);
                }
            }
        }
        draw(&mut waiting, &mut near, side);
        Self::of(near, side, tiles)
    }

    /// - `near`: that of each pixel
    /// - `shift`, `more`: see [`Tiles`]
    pub(super) fn of(near: Vec<f32>, side: usize, [shift, more]: [u8; 2]) -> Self {
        let tiles = Tiles::new(&near, side, shift.into(), more.into());
        Self { side, near, tiles }
    }

    /// The nearest that can be in a square's pixels and those beyond it; where there is no square,
    /// nothing is known.
    #[inline]
    pub(super) fn nearest_about(&self, x: usize, y: usize) -> f32 {
        let Tiles {
            shift,
            across,
            nearest,
        } = &self.tiles;
        let place = (y >> shift) * across + (x >> shift);
        nearest.get(place).copied().unwrap_or(f32::INFINITY)
    }
}
