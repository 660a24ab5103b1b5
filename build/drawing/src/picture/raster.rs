//! Triangles → which of them is nearest at each sample.
//!
//! A sample belongs to a triangle if its centre is inside or on an edge. An edge that two triangles
//! share is computed from the same end in both, so that no sample between them is missed. Of two
//! triangles that are equally near, the first counts.

use super::look::SAMPLES;
use super::rows::{Corners, Rows};
use super::solid::{self, Triangle, World};
use std::ops::Range;
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::Vec3;

/// Rows of samples that one thread draws at a time; they fit into a processor's own memory.
const BAND: usize = 16 * SAMPLES;

/// Triangles that one thread sorts into bands at a time.
const PART: usize = 1 << 15;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

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

/// Corners in a picture, and what tells quickly that a triangle has no sample.
pub(super) struct Places {
    corners: Vec<[f32; 3]>,
    /// Column in the lower half, row in the upper one: twice the last whose centre is not behind
    /// it, and one more where it is on that centre. A triangle whose corners have one even number
    /// lies between two centres.
    cells: Vec<u64>,
}

/// The bits that tell that a corner is on a centre.
const ON: u64 = 1 << 32 | 1;

/// First and last whole number of samples that three corners can have.
#[inline]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "the halves of a cell"
)]
fn between(cells: [u64; 3], shift: u32) -> (i32, i32) {
    let [a, b, c] = cells.map(|cell| (cell >> shift) as u32 as i32);
    let low = |cell: i32| (cell >> 1) + 1 - (cell & 1);
    (
        low(a).min(low(b)).min(low(c)),
        (a >> 1).max(b >> 1).max(c >> 1),
    )
}

impl Places {
    #[allow(
        clippy::cast_precision_loss,
        clippy::float_cmp,
        reason = "samples of a picture are few, and a corner is on a centre or is not"
    )]
    pub(super) fn new(corners: impl Iterator<Item = [f32; 3]>) -> Self {
        let corners: Vec<[f32; 3]> = corners.collect();
        let cell = |x: f32| {
            let last = floor(x - 0.5);
            let cell = 2 * last.clamp(-FAR, FAR) + i32::from(last as f32 == x - 0.5);
            u64::from(cell.cast_unsigned())
        };
        let cells = corners.iter().map(|[x, y, _]| cell(*x) | cell(*y) << 32);
        Self {
            cells: cells.collect(),
            corners,
        }
    }

    /// A triangle, if the centre of a sample can be in it. Most triangles are smaller than a
    /// sample.
    #[inline]
    #[allow(
        clippy::needless_bitwise_bool,
        clippy::cast_possible_truncation,
        reason = "one branch instead of two, and the halves of a cell"
    )]
    pub(super) fn triangle(&self, face: [u32; 3]) -> Option<Placed> {
        let cells = face.map(|i| self.cells[i as usize]);
        let [a, b, c] = cells;
        let apart = (a ^ b) | (a ^ c) | (a & ON);
        let some = (apart as u32 != 0) & (apart >> 32 != 0);
        some.then(|| Placed {
            corners: face.map(|i| self.corners[i as usize]),
            columns: between(cells, 0),
            rows: between(cells, 32),
        })
    }
}

/// A triangle in a picture, and the first and last columns and rows whose centres it can have.
pub(super) struct Placed {
    pub(super) corners: Corners,
    pub(super) columns: (i32, i32),
    pub(super) rows: (i32, i32),
}

/// Columns and rows beyond which a place is only known to be beyond any picture.
const FAR: i32 = 1 << 24;

/// The places within a picture; none for those beside it.
pub(super) fn within(range: (i32, i32), picture: &Range<usize>) -> Range<usize> {
    let start = usize::try_from(range.0).unwrap_or(0).max(picture.start);
    let end = usize::try_from(range.1).map_or(0, |last| last + 1);
    start..end.min(picture.end)
}

/// The nearest triangle at each sample of a picture.
pub(super) struct Layer {
    pub(super) width: usize,
    /// Of each sample, its place in the triangles of its band, or [`NONE`].
    pub(super) seen: Vec<u32>,
    /// Those that are seen somewhere in each band. One that is seen in two bands stands in both:
    /// so each thread lists them for its own rows, and none of them is moved in memory.
    triangles: Vec<Vec<Triangle>>,
}

/// Which of 16 samples a part of the light passes: their order spreads over the square.
const ORDER: [f32; 16] = [
    0.0, 8.0, 2.0, 10.0, 12.0, 4.0, 14.0, 6.0, 3.0, 11.0, 1.0, 9.0, 15.0, 7.0, 13.0, 5.0,
];

impl Layer {
    /// Of a glass wall, as many samples of each pixel show it as its alpha says.
    ///
    /// - `place`: column, row and nearness of a point
    pub(super) fn new(
        world: &World,
        place: impl Fn(&Vec3) -> [f64; 3],
        width: usize,
        height: usize,
    ) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "places in a picture")]
        let corners = world.positions.iter().map(|p| place(p).map(|x| x as f32));
        let places = Places::new(corners);
        let bands = Bands::new(world, &places, height);
        let mut seen = vec![0; width * height];
        let rows = seen.chunks_mut((BAND * width).max(1));
        let mut pieces: Vec<(&mut [u32], Vec<Triangle>)> =
            rows.map(|seen| (seen, Vec::new())).collect();
        parallel::for_pieces(&mut pieces, 1, |band, piece| {
            for (seen, triangles) in piece {
                let faces = bands.nearest(world, &places, seen, width, band);
                *triangles = faces.map(|face| world.triangle(face as usize)).collect();
            }
        });
        let triangles = pieces.into_iter().map(|(_, triangles)| triangles);
        let triangles = triangles.collect();
        Self {
            width,
            seen,
            triangles,
        }
    }

    /// What the numbers in `seen` mean in a row of samples.
    pub(super) fn triangles(&self, row: usize) -> &[Triangle] {
        &self.triangles[row / BAND]
    }
}

/// The faces that can be seen in each band of rows: most have no sample, or one or two, and are not
/// looked at again.
struct Bands {
    /// Faces in ascending order: of each part of the world, in each band.
    parts: Vec<Vec<Vec<u32>>>,
}

impl Bands {
    fn new(world: &World, places: &Places, height: usize) -> Self {
        let count = height.div_ceil(BAND);
        let firsts: Vec<usize> = (0..world.faces.len()).step_by(PART).collect();
        let parts = parallel::map(&firsts, |&first| {
            let mut bands = vec![Vec::new(); count];
            let end = world.faces.len().min(first + PART);
            for face in first..end {
                let Some(placed) = places.triangle(world.faces[face]) else {
                    continue;
                };
                let rows = within(placed.rows, &(0..height));
                if !rows.is_empty() {
                    for band in &mut bands[rows.start / BAND..rows.end.div_ceil(BAND)] {
                        band.push(solid::place(face));
                    }
                }
            }
            bands
        });
        Self { parts }
    }

    /// The faces that are seen in a band; writes which of these is nearest at each sample.
    fn nearest(
        &self,
        world: &World,
        places: &Places,
        seen: &mut [u32],
        width: usize,
        band: usize,
    ) -> impl Iterator<Item = u32> {
        let own = self.parts.iter().flat_map(|part| &part[band]);
        let own: Vec<u32> = own.copied().collect();
        seen.fill(NONE);
        let mut near = vec![0.0_f32; seen.len()];
        let start = band * BAND;
        let picture = start..start + seen.len() / width;
        let mut faces = (0..).zip(&own).peekable();
        let mut waiting = Rows::new();
        for (surface, of_surface) in world.surfaces() {
            let alpha = surface.alpha;
            let mut draw = |waiting: &mut Rows| {
                waiting.draw(width, |number, y, xs, first, slope| {
                    let offset = (y - start) * width;
                    let mut depth = first;
                    for x in xs {
                        let place = offset + x;
                        let part = || ORDER[(y % 4) * 4 + x % 4];
                        let passed = alpha >= 1.0 || part() < alpha * 16.0 - 0.5;
                        if depth > near[place] && passed {
                            near[place] = depth;
                            seen[place] = number;
                        }
                        depth += slope;
                    }
                });
            };
            while let Some((number, &face)) =
                faces.next_if(|(_, face)| (**face as usize) < of_surface.end)
            {
                let Some(placed) = places.triangle(world.faces[face as usize]) else {
                    continue;
                };
                for y in within(placed.rows, &picture) {
                    if waiting.add(&placed.corners, number, y) {
                        draw(&mut waiting);
                    }
                }
            }
            // The next surface may have another alpha.
            draw(&mut waiting);
        }
        // Most of them are hidden after all.
        let mut shown = Vec::new();
        let mut kept = vec![NONE; own.len()];
        for number in seen.iter_mut().filter(|number| **number != NONE) {
            let place = &mut kept[*number as usize];
            if *place == NONE {
                *place = solid::place(shown.len());
                shown.push(own[*number as usize]);
            }
            *number = *place;
        }
        shown.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::{Places, floor, within};

    /// Which samples a triangle can have, by its definition: centres between its outermost corners.
    #[test]
    fn a_triangle_has_the_samples_between_its_corners() {
        let places = [
            -1e9, -0.5, -0.2, 0.0, 0.3, 0.5, 0.6, 1.4, 1.5, 2.5, 2.6, 1e9,
        ];
        let all = |k: usize| [k % 12, k / 12 % 12, k / 144].map(|i| places[i]);
        for (k, other) in (0..1728).map(|k| (k, (k * 7 + 5) % 1728)) {
            let (x, y) = (all(k), all(other));
            let corners = [0, 1, 2].map(|i| [x[i], y[i], 0.0]);
            let found = Places::new(corners.into_iter()).triangle([0, 1, 2]);
            let centers = |x: [f32; 3]| -> Vec<usize> {
                let (low, high) = (x.map(|x| x - 0.5), x.map(|x| x - 0.5));
                let low = low.into_iter().fold(f32::INFINITY, f32::min);
                let high = high.into_iter().fold(f32::NEG_INFINITY, f32::max);
                (0..4_u8)
                    .filter(|i| (low..=high).contains(&f32::from(*i)))
                    .map(usize::from)
                    .collect()
            };
            let (columns, rows) = (centers(x), centers(y));
            let found = found.map(|placed| {
                [placed.columns, placed.rows].map(|range| within(range, &(0..4)).collect())
            });
            let [own_columns, own_rows]: [Vec<usize>; 2] = found.unwrap_or_default();
            if !columns.is_empty() && !rows.is_empty() {
                assert_eq!((own_columns, own_rows), (columns, rows), "{corners:?}");
            } else {
                assert!(own_columns.is_empty() || own_rows.is_empty(), "{corners:?}");
            }
        }
    }

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
