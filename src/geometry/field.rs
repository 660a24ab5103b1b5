//! Terrain given by heights over a grid.
//!
//! Between the samples the surface is bicubic and smooth: a wheel feels no edges of triangles. The
//! slope at a sample is the mean of those of the two cells beside it, but at most `STEEPEST`
//! times the smaller one, so that beside a step the surface overshoots by less than 5 % of it.
//! Where all heights are the same the surface is a plane to the last bit.
//!
//! Source of the slopes: Catmull & Rom 1974, with the limit of Fritsch & Carlson 1980.

use super::error::GeometryError;
use crate::spatial::Vec3;
use crate::tuning::{RIDGE, RIDGE_LEAST};
use serde::{Deserialize, Serialize};

/// Most samples of a field.
pub const MOST_SAMPLES: usize = 4_000_000;

/// Slope at a sample over the smaller slope of the cells beside it, at most: with more a cubic
/// between two samples may leave the range of their heights.
const STEEPEST: f64 = 3.0;

/// A surface `z = H(x, y)` over a rectangle about the origin. What is below is solid; beyond the
/// rectangle there is nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Samples", into = "Samples")]
pub struct Field {
    samples: Samples,
    /// Height of the surface's derivatives at each sample: along x and y, and of both; per cell.
    slopes: Vec<[f64; 3]>,
    /// How sharp the surface is at each sample, 0 … 1, see [`Field::ridge`].
    ridges: Vec<f64>,
    /// No point of the surface over a cell is higher.
    cells: Pyramid,
    /// Heights of the samples that are sharp.
    peaks: Pyramid,
}

/// Heights over a grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Extent along x and y, m.
    pub size: [f64; 2],
    /// How many along x and y, at least two.
    pub counts: [usize; 2],
    /// m, row by row: along x first, from the lowest x and y.
    pub heights: Vec<f64>,
}

/// The surface at a place.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// m
    pub height: f64,
    /// `∂H/∂x`, `∂H/∂y`.
    pub slope: [f64; 2],
    /// `∂²H/∂x²`, `∂²H/∂x∂y`, `∂²H/∂y²`, 1/m.
    pub bend: [f64; 3],
}

impl Local {
    /// Unit vector out of the ground.
    pub fn normal(&self) -> Vec3 {
        let [x, y] = self.slope;
        let up = 1.0 / (1.0 + x * x + y * y).sqrt();
        Vec3::new(-x * up, -y * up, up)
    }
}

impl TryFrom<Samples> for Field {
    type Error = GeometryError;

    fn try_from(samples: Samples) -> Result<Self, GeometryError> {
        let [nx, ny] = samples.counts;
        let fits = nx.min(ny) >= 2
            && nx.saturating_mul(ny) <= MOST_SAMPLES
            && samples.heights.len() == nx * ny
            && samples.size.iter().all(|s| *s > 0.0 && *s < 1e6);
        if !fits {
            return Err(GeometryError::Grid);
        }
        for (index, height) in samples.heights.iter().enumerate() {
            if !height.is_finite() {
                return Err(GeometryError::NotFinite { index });
            }
            if height.abs() > 1e6 {
                let distance = height.abs();
                return Err(GeometryError::TooFar { index, distance });
            }
        }
        Ok(Self::of(samples))
    }
}

impl From<Field> for Samples {
    fn from(field: Field) -> Self {
        field.samples
    }
}

/// The mean of two slopes, limited, see the module.
fn limited(a: f64, b: f64) -> f64 {
    let most = STEEPEST * a.abs().min(b.abs());
    (0.5 * (a + b)).clamp(-most, most)
}

/// Slopes per cell of a row of values.
fn row_slopes(value: impl Fn(usize) -> f64, count: usize, mut take: impl FnMut(usize, f64)) {
    for i in 0..count {
        let before = (i > 0).then(|| value(i) - value(i - 1));
        let after = (i + 1 < count).then(|| value(i + 1) - value(i));
        let slope = match (before, after) {
            (Some(a), Some(b)) => limited(a, b),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => 0.0,
        };
        take(i, slope);
    }
}

impl Field {
    fn of(samples: Samples) -> Self {
        let [nx, ny] = samples.counts;
        let mut slopes = vec![[0.0; 3]; nx * ny];
        for j in 0..ny {
            let row = j * nx;
            row_slopes(
                |i| samples.heights[row + i],
                nx,
                |i, s| slopes[row + i][0] = s,
            );
        }
        for i in 0..nx {
            let place = |j: usize| j * nx + i;
            row_slopes(
                |j| samples.heights[place(j)],
                ny,
                |j, s| slopes[place(j)][1] = s,
            );
            let along: Vec<f64> = (0..ny).map(|j| slopes[place(j)][0]).collect();
            row_slopes(|j| along[j], ny, |j, s| slopes[place(j)][2] = s);
        }
        let mut field = Self {
            samples,
            slopes,
            ridges: Vec::new(),
            cells: Pyramid::default(),
            peaks: Pyramid::default(),
        };
        field.ridges = (0..nx * ny).map(|k| field.ridge(k % nx, k / nx)).collect();
        let bounds = (0..(nx - 1) * (ny - 1)).map(|k| field.bound(k % (nx - 1), k / (nx - 1)));
        field.cells = Pyramid::new([nx - 1, ny - 1], bounds.collect());
        let peaks = field.ridges.iter().zip(&field.samples.heights);
        let peak = |(ridge, height): (&f64, &f64)| {
            if *ridge > 0.0 {
                *height
            } else {
                f64::NEG_INFINITY
            }
        };
        field.peaks = Pyramid::new([nx, ny], peaks.map(peak).collect());
        field
    }

    /// The samples.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Extent of a cell, m.
    pub fn cell(&self) -> [f64; 2] {
        let Samples { size, counts, .. } = &self.samples;
        [0, 1].map(|k| size[k] / count(counts[k] - 1))
    }

    /// Largest distance of one of its points from its origin, m.
    pub fn reach(&self) -> f64 {
        let [x, y] = self.samples.size.map(|s| 0.5 * s);
        let low = self.samples.heights.iter().fold(0.0_f64, |a, &h| a.min(h));
        let z = self.cells.top().max(-low);
        (x * x + y * y + z * z).sqrt()
    }

    /// How much of the sharpness of a point a sample has: the share with which it carries a shape
    /// that lies on it alone. 0 where the surface is even or hollow, 1 where it turns down by
    /// [`RIDGE`] from one cell to the next, or ends.
    fn ridge(&self, i: usize, j: usize) -> f64 {
        let [nx, ny] = self.samples.counts;
        if i == 0 || j == 0 || i + 1 == nx || j + 1 == ny {
            return 1.0;
        }
        let [dx, dy] = self.cell();
        let height = |i: usize, j: usize| self.samples.heights[j * nx + i];
        let angle = |from: f64, to: f64, by: f64| libm::atan((to - from) / by);
        let h = height(i, j);
        let along_x = angle(height(i - 1, j), h, dx) - angle(h, height(i + 1, j), dx);
        let along_y = angle(height(i, j - 1), h, dy) - angle(h, height(i, j + 1), dy);
        let excess = (along_x.max(along_y) - RIDGE_LEAST).max(0.0) / (RIDGE - RIDGE_LEAST);
        (excess * excess).min(1.0)
    }

    /// A height that no point of the surface over a cell exceeds: the highest of its sixteen Bézier
    /// points.
    fn bound(&self, i: usize, j: usize) -> f64 {
        let nx = self.samples.counts[0];
        let mut top = f64::NEG_INFINITY;
        for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let k = (j + dj) * nx + i + di;
            let [sx, sy, sxy] = self.slopes[k];
            let inward = |d: usize| if d == 0 { 1.0 / 3.0 } else { -1.0 / 3.0 };
            let (u, v) = (inward(di), inward(dj));
            let h = self.samples.heights[k];
            for x in [h, h + u * sx, h + v * sy, h + u * sx + v * sy + u * v * sxy] {
                top = top.max(x);
            }
        }
        top
    }

    /// Where a place lies: cell, and how far in it, 0 … 1.
    fn cell_at(&self, x: f64, along: usize) -> Option<(usize, f64)> {
        let Samples { size, counts, .. } = &self.samples;
        let cells = counts[along] - 1;
        let place = (x / size[along] + 0.5) * count(cells);
        if !(0.0..=count(cells)).contains(&place) {
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid"
        )]
        let cell = (place as usize).min(cells - 1);
        Some((cell, place - count(cell)))
    }

    /// The surface over a place; none beyond the rectangle.
    pub fn at(&self, x: f64, y: f64) -> Option<Local> {
        let ((i, u), (j, v)) = (self.cell_at(x, 0)?, self.cell_at(y, 1)?);
        let (bx, by) = (Basis::new(u), Basis::new(v));
        let nx = self.samples.counts[0];
        let [dx, dy] = self.cell();
        // Differences from one corner keep an even surface even.
        let base = self.samples.heights[j * nx + i];
        let mut sum = [0.0; 6];
        for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let k = (j + dj) * nx + i + di;
            let [sx, sy, sxy] = self.slopes[k];
            let h = self.samples.heights[k] - base;
            let mut add = |place: usize, x: &[[f64; 2]; 2], y: &[[f64; 2]; 2]| {
                sum[place] += h * x[0][di] * y[0][dj]
                    + sx * x[1][di] * y[0][dj]
                    + sy * x[0][di] * y[1][dj]
                    + sxy * x[1][di] * y[1][dj];
            };
            add(0, &bx.value, &by.value);
            add(1, &bx.slope, &by.value);
            add(2, &bx.value, &by.slope);
            add(3, &bx.bend, &by.value);
            add(4, &bx.slope, &by.slope);
            add(5, &bx.value, &by.bend);
        }
        Some(Local {
            height: base + sum[0],
            slope: [sum[1] / dx, sum[2] / dy],
            bend: [sum[3] / (dx * dx), sum[4] / (dx * dy), sum[5] / (dy * dy)],
        })
    }

    /// The sample `(i, j)`: its place, the surface's normal there, how sharp it is.
    pub fn sample(&self, i: usize, j: usize) -> (Vec3, Vec3, f64) {
        let [nx, _] = self.samples.counts;
        let ([dx, dy], k) = (self.cell(), j * nx + i);
        let [sx, sy, _] = self.slopes[k];
        let local = Local {
            height: self.samples.heights[k],
            slope: [sx / dx, sy / dy],
            bend: [0.0; 3],
        };
        let [x, y] = self.place(i, j);
        (
            Vec3::new(x, y, local.height),
            local.normal(),
            self.ridges[k],
        )
    }

    /// Where a sample is, m.
    pub fn place(&self, i: usize, j: usize) -> [f64; 2] {
        let Samples { size, counts, .. } = &self.samples;
        let along = |k: usize, i: usize| (count(i) / count(counts[k] - 1) - 0.5) * size[k];
        [along(0, i), along(1, j)]
    }

    /// Samples from the last one at or before `low` to the first one at or after `high`, both
    /// included, as far as there are any; along x or y.
    fn around(&self, low: f64, high: f64, along: usize, count_of: usize) -> [usize; 2] {
        let size = self.samples.size[along];
        let cells = count(self.samples.counts[along] - 1);
        let place = |x: f64| ((x / size + 0.5) * cells).clamp(0.0, cells);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid"
        )]
        let [first, last] = [
            libm::floor(place(low)) as usize,
            libm::ceil(place(high)) as usize,
        ];
        [first.min(count_of - 1), last.min(count_of - 1)]
    }

    /// A height that the surface does not exceed within a square of half the width `around` about a
    /// place, m.
    pub fn highest(&self, x: f64, y: f64, around: f64) -> f64 {
        let [nx, ny] = self.samples.counts;
        let columns = self.around(x - around, x + around, 0, nx - 1);
        let rows = self.around(y - around, y + around, 1, ny - 1);
        let mut top = f64::NEG_INFINITY;
        self.cells.each([columns, rows], &mut |height, at| {
            if at.is_some() {
                top = top.max(height);
            }
            height > top
        });
        top
    }

    /// Calls `take` with each sharp sample within a square of half the width `around` about a place
    /// that is higher than the height that `take` gave back last; `low` is the first one, m.
    pub fn each_peak(
        &self,
        (x, y, around): (f64, f64, f64),
        low: f64,
        mut take: impl FnMut(usize, usize) -> f64,
    ) {
        let [nx, ny] = self.samples.counts;
        let columns = self.around(x - around, x + around, 0, nx);
        let rows = self.around(y - around, y + around, 1, ny);
        let mut low = low;
        self.peaks.each([columns, rows], &mut |height, at| {
            if let Some([i, j]) = at
                && height > low
            {
                low = low.max(take(i, j));
            }
            height > low
        });
    }

    /// Triangles of its surface, two a cell, seen counter-clockwise from above.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let [nx, ny] = self.samples.counts;
        let corner = |i: usize, j: usize| self.sample(i, j).0;
        let cells = (0..ny - 1).flat_map(|j| (0..nx - 1).map(move |i| (i, j)));
        cells
            .flat_map(|(i, j)| {
                let [a, b] = [corner(i, j), corner(i + 1, j)];
                let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of samples are small")]
fn count(n: usize) -> f64 {
    n as f64
}

/// Cubic Hermite polynomials at a place in a cell: of the values at both ends, and of the slopes
/// there.
struct Basis {
    value: [[f64; 2]; 2],
    slope: [[f64; 2]; 2],
    bend: [[f64; 2]; 2],
}

impl Basis {
    fn new(u: f64) -> Self {
        let (s, t) = (u * u, u * u * u);
        Self {
            value: [
                [1.0 - 3.0 * s + 2.0 * t, 3.0 * s - 2.0 * t],
                [u - 2.0 * s + t, t - s],
            ],
            slope: [
                [6.0 * (s - u), 6.0 * (u - s)],
                [1.0 - 4.0 * u + 3.0 * s, 3.0 * s - 2.0 * u],
            ],
            bend: [
                [12.0 * u - 6.0, 6.0 - 12.0 * u],
                [6.0 * u - 4.0, 6.0 * u - 2.0],
            ],
        }
    }
}

/// The largest value in each block of a grid: of 2 × 2 values, of 4 × 4, and so on.
#[derive(Clone, Debug, Default, PartialEq)]
struct Pyramid {
    levels: Vec<([usize; 2], Vec<f64>)>,
}

impl Pyramid {
    fn new(counts: [usize; 2], values: Vec<f64>) -> Self {
        let mut levels = vec![(counts, values)];
        while let Some(([nx, ny], below)) = levels.last()
            && nx * ny > 1
        {
            let [mx, my] = [nx.div_ceil(2), ny.div_ceil(2)];
            let mut values = vec![f64::NEG_INFINITY; mx * my];
            for (k, value) in below.iter().enumerate() {
                let at = (k / nx / 2) * mx + (k % nx) / 2;
                values[at] = values[at].max(*value);
            }
            levels.push(([mx, my], values));
        }
        Self { levels }
    }

    /// The largest of all.
    fn top(&self) -> f64 {
        self.levels.last().map_or(f64::NEG_INFINITY, |(_, v)| v[0])
    }

    /// Calls `open` with the largest value of each block that has a part in the columns and rows,
    /// both included; opens it where that says so. With a single value comes its place.
    fn each(
        &self,
        within: [[usize; 2]; 2],
        open: &mut impl FnMut(f64, Option<[usize; 2]>) -> bool,
    ) {
        self.visit(self.levels.len() - 1, [0, 0], within, open);
    }

    fn visit(
        &self,
        level: usize,
        [bi, bj]: [usize; 2],
        within: [[usize; 2]; 2],
        open: &mut impl FnMut(f64, Option<[usize; 2]>) -> bool,
    ) {
        let ([nx, ny], values) = &self.levels[level];
        let [columns, rows] = within;
        let outside = |b: usize, [first, last]: [usize; 2]| {
            ((b + 1) << level) <= first || (b << level) > last
        };
        if bi >= *nx || bj >= *ny || outside(bi, columns) || outside(bj, rows) {
            return;
        }
        let value = values[bj * nx + bi];
        if level == 0 {
            open(value, Some([bi, bj]));
        } else if open(value, None) {
            for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                self.visit(level - 1, [2 * bi + di, 2 * bj + dj], within, open);
            }
        }
    }
}

#[cfg(test)]
mod tests;
