//! Terrain given by heights over a grid.
//!
//! Between the samples the surface is bicubic and smooth, so that a wheel does not hit edges of
//! triangles. The slope at a sample is the mean of those of the two cells beside it, but at most
//! `STEEPEST` times the smaller one, so that beside a step the surface overshoots by less than 5 %
//! of it. Where all heights are the same the surface is a plane to the last bit.
//!
//! Source of the slopes: Catmull & Rom 1974, with the limit of Fritsch & Carlson 1980.

mod cubic;
mod hollow;
mod pyramid;
mod rim;
mod samples;

use self::cubic::Cell;
use self::pyramid::Pyramid;
pub use self::samples::{MOST_SAMPLES, Samples};
use super::error::GeometryError;
use crate::spatial::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How a sample lies to the end of the surface.
#[derive(Clone, Copy, Debug)]
pub enum Rim {
    /// The surface goes on around it.
    Inside,
    /// The surface ends there, but other terrain goes on.
    Seam,
    /// What bounds the directions in which it carries: the normal there and, in the plane of the
    /// surface, the direction out of it, unit vectors.
    End([Vec3; 2]),
}

/// A surface `z = H(x, y)` over a rectangle about the origin. What is below is solid; beyond the
/// rectangle there is nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Samples", into = "Samples")]
pub struct Field {
    samples: Arc<Samples>,
    grid: Grid,
    /// At each sample the height, m, and the slopes of the surface in m per cell: along x, along y,
    /// and of both.
    nodes: Arc<[[f64; 4]]>,
    /// How sharp the surface is at each sample, 0 … 1, see [`Field::ridge`].
    ridges: Arc<[f64]>,
    /// No point of the surface over a cell is higher.
    cells: Arc<Pyramid>,
    /// The lowest sample, m.
    lowest: f64,
    /// No point of the surface is lower, m.
    bottom: f64,
    /// No normal of the surface has a smaller z.
    upright: f64,
    /// Heights of the samples that are sharp.
    peaks: Arc<Pyramid>,
    /// How much the surface bends up over each cell: what `√(1 + |∇H|²) ∇²H` does not exceed, 1/m.
    hollows: Arc<Pyramid>,
    /// How much the surface bends down over each cell: what `−∇²H` does not exceed, 1/m.
    humps: Arc<Pyramid>,
    /// Whether it goes on in other terrain at each cell of its sides: of the lowest x, the highest
    /// x, the lowest y, the highest y; empty where it does nowhere, see [`Field::beside`].
    seams: [Vec<bool>; 4],
}

/// Along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// Half of the extent, m.
    half: [f64; 2],
    /// Cells, and the index of the last one.
    cells: [f64; 2],
    last: [usize; 2],
    /// Extent of a cell, m, and cells a metre.
    cell: [f64; 2],
    per_metre: [f64; 2],
}

impl Grid {
    fn new(samples: &Samples) -> Self {
        let last = samples.counts.map(|n| n - 2);
        let cells = last.map(|n| count(n + 1));
        let size = samples.size;
        Self {
            half: size.map(|s| 0.5 * s),
            cells,
            last,
            cell: [0, 1].map(|k| size[k] / cells[k]),
            per_metre: [0, 1].map(|k| cells[k] / size[k]),
        }
    }
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
        normal(self.slope)
    }
}

/// Unit vector out of ground that rises by so much along x and y, m/m.
#[inline]
pub fn normal([x, y]: [f64; 2]) -> Vec3 {
    let up = 1.0 / (1.0 + x * x + y * y).sqrt();
    Vec3::new(-x * up, -y * up, up)
}

impl TryFrom<Samples> for Field {
    type Error = GeometryError;

    #[cfg_attr(small, optimize(size))]
    fn try_from(samples: Samples) -> Result<Self, GeometryError> {
        samples.check()?;
        Ok(Self::of(samples))
    }
}

impl From<Field> for Samples {
    fn from(field: Field) -> Self {
        Arc::unwrap_or_clone(field.samples)
    }
}

impl Field {
    fn of(samples: Samples) -> Self {
        let [nx, ny] = samples.counts;
        let nodes = samples.nodes();
        let lowest = samples
            .heights
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let mut field = Self {
            grid: Grid::new(&samples),
            samples: Arc::new(samples),
            lowest,
            bottom: lowest,
            upright: 0.0,
            nodes: nodes.into(),
            ridges: Arc::new([]),
            cells: Arc::default(),
            peaks: Arc::default(),
            hollows: Arc::default(),
            humps: Arc::default(),
            seams: [const { Vec::new() }; 4],
        };
        field.ridges = (0..nx * ny).map(|k| field.ridge(k % nx, k / nx)).collect();
        let cells = [nx - 1, ny - 1];
        let [mut bounds, mut hollows, mut humps] =
            [(); 3].map(|()| Vec::with_capacity(cells[0] * cells[1]));
        let mut steepest = 0.0_f64;
        for k in 0..cells[0] * cells[1] {
            let points = field.bezier(k % cells[0], k / cells[0]);
            let heights = || points.as_flattened().iter().copied();
            // The surface exceeds none of its Bézier points, and comes below none.
            bounds.push(heights().fold(f64::NEG_INFINITY, f64::max));
            field.bottom = heights().fold(field.bottom, f64::min);
            let slope = field.steepest(&points);
            steepest = steepest.max(slope);
            hollows.push(field.bend(&points, 1.0) * (1.0 + slope).sqrt());
            humps.push(field.bend(&points, -1.0));
        }
        field.cells = Arc::new(Pyramid::new(cells, bounds));
        field.hollows = Arc::new(Pyramid::new(cells, hollows));
        field.humps = Arc::new(Pyramid::new(cells, humps));
        field.upright = 1.0 / (1.0 + steepest).sqrt();
        let peaks = field.ridges.iter().zip(&field.samples.heights);
        let peak = |(ridge, height): (&f64, &f64)| {
            if *ridge > 0.0 {
                *height
            } else {
                f64::NEG_INFINITY
            }
        };
        let peaks = peaks.map(peak).collect();
        field.peaks = Arc::new(Pyramid::new([nx, ny], peaks));
        field
    }

    /// The samples.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Extent of a cell, m.
    pub fn cell(&self) -> [f64; 2] {
        self.grid.cell
    }

    /// Largest distance of one of its points from its origin, m.
    pub fn reach(&self) -> f64 {
        let [x, y] = self.grid.half;
        let z = self.top().max(-self.lowest);
        (x * x + y * y + z * z).sqrt()
    }

    /// A height that no point of the surface exceeds, m.
    pub fn top(&self) -> f64 {
        self.cells.top()
    }

    /// A height that no point of the surface is below, m.
    pub fn bottom(&self) -> f64 {
        self.bottom
    }

    /// The sixteen Bézier points of a cell, m: first along x, row by row.
    fn bezier(&self, i: usize, j: usize) -> [[f64; 4]; 4] {
        let nx = self.samples.counts[0];
        let mut points = [[0.0; 4]; 4];
        for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let [h, sx, sy, sxy] = self.nodes[(j + dj) * nx + i + di];
            let inward = |d: usize| if d == 0 { 1.0 / 3.0 } else { -1.0 / 3.0 };
            let (u, v) = (inward(di), inward(dj));
            let next = |d: usize| if d == 0 { [0, 1] } else { [3, 2] };
            let ([near_x, far_x], [near_y, far_y]) = (next(di), next(dj));
            points[near_y][near_x] = h;
            points[near_y][far_x] = h + u * sx;
            points[far_y][near_x] = h + v * sy;
            points[far_y][far_x] = h + u * sx + v * sy + u * v * sxy;
        }
        points
    }

    /// What the square of the slope over a cell does not exceed: three times the differences of
    /// its Bézier points are those of the slopes per cell.
    fn steepest(&self, points: &[[f64; 4]; 4]) -> f64 {
        let along_x = points
            .iter()
            .flat_map(|row| [0, 1, 2].map(|k| row[k + 1] - row[k]));
        let rows = points.iter().zip(&points[1..]);
        let along_y = rows.flat_map(|(a, b)| [0, 1, 2, 3].map(|k| b[k] - a[k]));
        let along_x = along_x.fold(0.0, |most: f64, x| most.max(x.abs()));
        let along_y = along_y.fold(0.0, |most: f64, y| most.max(y.abs()));
        let [x, y] = [along_x, along_y].map(|difference| 3.0 * difference);
        let [px, py] = self.grid.per_metre;
        (x * px) * (x * px) + (y * py) * (y * py)
    }

    /// What the z of no normal of the surface is below.
    pub fn upright(&self) -> f64 {
        self.upright
    }

    /// Where a place lies: cell, and how far in it, 0 … 1.
    #[inline]
    fn cell_at(&self, x: f64, along: usize) -> Option<(usize, f64)> {
        let Grid {
            half,
            per_metre,
            last,
            ..
        } = &self.grid;
        if x.is_nan() || x.abs() > half[along] {
            return None;
        }
        let place = (x + half[along]) * per_metre[along];
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid"
        )]
        let cell = (place as usize).min(last[along]);
        Some((cell, place - count(cell)))
    }

    /// The place in its cell, and the nodes about it.
    #[inline]
    fn cell_about(&self, x: f64, y: f64) -> Option<Cell<'_>> {
        let ((i, u), (j, v)) = (self.cell_at(x, 0)?, self.cell_at(y, 1)?);
        let nx = self.samples.counts[0];
        let first = j * nx + i;
        let (near, far) = (
            &self.nodes[first..first + 2],
            &self.nodes[first + nx..first + nx + 2],
        );
        let rows = [[&near[0], &near[1]], [&far[0], &far[1]]];
        Some(Cell { u, v, rows })
    }

    /// The surface over a place; none beyond the rectangle.
    pub fn at(&self, x: f64, y: f64) -> Option<Local> {
        let cell = self.cell_about(x, y)?;
        let [dx, dy] = self.grid.cell;
        let (height, [sx, sy]) = cell.tangent();
        let [bxx, bxy, byy] = cell.bend();
        Some(Local {
            height,
            slope: [sx / dx, sy / dy],
            bend: [bxx / (dx * dx), bxy / (dx * dy), byy / (dy * dy)],
        })
    }

    /// The tangent plane of the surface over a place: height, m, and unit vector out of the ground.
    #[inline]
    pub fn tangent(&self, x: f64, y: f64) -> Option<(f64, Vec3)> {
        let (height, slope) = self.slopes(x, y)?;
        Some((height, normal(slope)))
    }

    /// The height of the surface over a place, m, and its slopes along x and y.
    #[inline]
    pub fn slopes(&self, x: f64, y: f64) -> Option<(f64, [f64; 2])> {
        let cell = self.cell_about(x, y)?;
        let [px, py] = self.grid.per_metre;
        let (height, [sx, sy]) = cell.tangent();
        Some((height, [sx * px, sy * py]))
    }

    /// The tangent plane of the surface below a point: its normal, and how deep the point is in it,
    /// m; none beyond the rectangle.
    #[inline]
    pub fn below(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        let (height, n) = self.tangent(x.x, x.y)?;
        Some((n, (height - x.z) * n.z))
    }

    /// The same, with the tangent plane at the nearest place of the end for a point beyond it.
    pub fn below_or_end(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        let [a, b] = self.within([x.x, x.y]);
        let (height, n) = self.tangent(a, b)?;
        Some((n, n.dot(&(Vec3::new(a, b, height) - x))))
    }

    /// The sample `(i, j)`: its place, the surface's normal there, how sharp it is.
    pub fn sample(&self, i: usize, j: usize) -> (Vec3, Vec3, f64) {
        let [nx, _] = self.samples.counts;
        let ([dx, dy], k) = (self.cell(), j * nx + i);
        let [height, sx, sy, _] = self.nodes[k];
        let [x, y] = self.place(i, j);
        (
            Vec3::new(x, y, height),
            normal([sx / dx, sy / dy]),
            self.ridges[k],
        )
    }

    /// Whether the line along the surface's normal at a sample passes a ball about `p`.
    #[inline]
    pub fn passes(&self, [i, j]: [usize; 2], p: &Vec3, radius: f64) -> bool {
        let Grid {
            half,
            cell,
            per_metre,
            ..
        } = &self.grid;
        let [height, sx, sy, _] = self.nodes[j * self.samples.counts[0] + i];
        let (x, y) = (count(i) * cell[0] - half[0], count(j) * cell[1] - half[1]);
        let along = Vec3::new(-sx * per_metre[0], -sy * per_metre[1], 1.0);
        let apart = Vec3::new(x, y, height) - p;
        // More than round-off: what nearly passes is looked at.
        let radius = radius * (1.0 + 1e-6) + 1e-12 * half[0].max(half[1]);
        apart.cross(&along).norm_squared() > radius * radius * along.norm_squared()
    }

    /// Where a sample is, m.
    pub fn place(&self, i: usize, j: usize) -> [f64; 2] {
        let Samples { size, counts, .. } = &*self.samples;
        let along = |k: usize, i: usize| (count(i) / count(counts[k] - 1) - 0.5) * size[k];
        [along(0, i), along(1, j)]
    }

    /// Samples from the last one at or before `low` to the first one at or after `high`, both
    /// included, as far as there are any; along x or y.
    fn around(&self, low: f64, high: f64, along: usize, count_of: usize) -> [usize; 2] {
        let (half, cells) = (self.grid.half[along], self.grid.cells[along]);
        let place = |x: f64| ((x + half) * self.grid.per_metre[along]).clamp(0.0, cells);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid"
        )]
        let whole = |x: f64| x as usize;
        let (low, high) = (place(low), place(high));
        // Rounded down, and rounded up.
        let (first, last) = (whole(low), whole(high));
        let last = if count(last) < high { last + 1 } else { last };
        [first.min(count_of - 1), last.min(count_of - 1)]
    }

    /// The cells within a square of half the width `around` about a place: columns and rows.
    #[inline]
    fn square(&self, x: f64, y: f64, around: f64) -> [[usize; 2]; 2] {
        let [nx, ny] = self.samples.counts;
        let columns = self.around(x - around, x + around, 0, nx - 1);
        let rows = self.around(y - around, y + around, 1, ny - 1);
        [columns, rows]
    }

    /// A height that the surface does not exceed within a square of half the width `around` about a
    /// place, m; of blocks of cells that are up to twice as wide as the square.
    pub fn highest(&self, x: f64, y: f64, around: f64) -> f64 {
        self.cells.highest(self.square(x, y, around))
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
pub(super) fn count(n: usize) -> f64 {
    n as f64
}

#[cfg(test)]
mod tests;
