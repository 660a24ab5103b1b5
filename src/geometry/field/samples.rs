//! The samples of a terrain of heights, and the slopes of the surface at them.

use super::super::error::GeometryError;
use serde::{Deserialize, Serialize};

/// Most samples of a field.
pub const MOST_SAMPLES: usize = 4_000_000;

/// Slope at a sample over the smaller slope of the cells beside it, at most: with more a cubic
/// between two samples may leave the range of their heights.
const STEEPEST: f64 = 3.0;

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

impl Samples {
    /// That there are as many heights as told, finite ones, in a rectangle of a size.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn check(&self) -> Result<(), GeometryError> {
        let [nx, ny] = self.counts;
        let fits = nx.min(ny) >= 2
            && nx.saturating_mul(ny) <= MOST_SAMPLES
            && self.heights.len() == nx * ny
            && self.size.iter().all(|s| *s > 0.0 && *s <= 1e6);
        if !fits {
            return Err(GeometryError::Grid);
        }
        for (index, height) in self.heights.iter().enumerate() {
            if !height.is_finite() {
                return Err(GeometryError::NotFinite { index });
            }
            if height.abs() > 1e6 {
                let distance = height.abs();
                return Err(GeometryError::TooFar { index, distance });
            }
        }
        Ok(())
    }

    /// At each sample the height, m, and the slopes of the surface in m per cell: along x, along y,
    /// and of both.
    pub(super) fn nodes(&self) -> Vec<[f64; 4]> {
        let [nx, ny] = self.counts;
        let mut nodes: Vec<[f64; 4]> = self.heights.iter().map(|h| [*h, 0.0, 0.0, 0.0]).collect();
        for j in 0..ny {
            let row = j * nx;
            let height = |i: usize| self.heights[row + i];
            row_slopes(height, nx, |i, slope| nodes[row + i][1] = slope);
        }
        for i in 0..nx {
            let place = |j: usize| j * nx + i;
            let height = |j: usize| self.heights[place(j)];
            row_slopes(height, ny, |j, slope| nodes[place(j)][2] = slope);
            let along: Vec<f64> = (0..ny).map(|j| nodes[place(j)][1]).collect();
            row_slopes(|j| along[j], ny, |j, slope| nodes[place(j)][3] = slope);
        }
        nodes
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
