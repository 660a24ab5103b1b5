//! The bicubic surface over one cell of a grid.

/// A place in a cell, and the samples about it.
pub(super) struct Cell {
    /// How far in the cell, 0 … 1, along x and y.
    pub(super) u: f64,
    pub(super) v: f64,
    /// m
    pub(super) base: f64,
    /// See `Field::cell_about`.
    pub(super) rows: [[[f64; 4]; 2]; 2],
}

impl Cell {
    /// Height, m, and slopes along x and y, m per cell.
    #[inline]
    pub(super) fn tangent(&self) -> (f64, [f64; 2]) {
        let (x, y) = (value(self.u), value(self.v));
        let (dx, dy) = (slope(self.u), slope(self.v));
        let across = self.across(&x);
        let height = self.base + dot(&y, &across);
        (height, [dot(&y, &self.across(&dx)), dot(&dy, &across)])
    }

    /// Second derivatives: along x, of both, along y, m per cell and cell.
    pub(super) fn bend(&self) -> [f64; 3] {
        let along_x = dot(&value(self.v), &self.across(&bend(self.u)));
        let both = dot(&slope(self.v), &self.across(&slope(self.u)));
        let along_y = dot(&bend(self.v), &self.across(&value(self.u)));
        [along_x, both, along_y]
    }

    /// What a polynomial along x makes of both rows: values, and slopes along y.
    #[inline]
    fn across(&self, x: &[f64; 4]) -> [f64; 4] {
        let [[h0, s0], [h1, s1]] = &self.rows;
        [dot(x, h0), dot(x, h1), dot(x, s0), dot(x, s1)]
    }
}

/// Cubic Hermite polynomials at a place in a cell: of the values at both ends, and of the slopes
/// there.
#[inline]
fn value(u: f64) -> [f64; 4] {
    let (s, t) = (u * u, u * u * u);
    let end = 3.0 * s - 2.0 * t;
    [1.0 - end, end, u - 2.0 * s + t, t - s]
}

/// Their first derivatives.
#[inline]
fn slope(u: f64) -> [f64; 4] {
    let s = u * u;
    let end = 6.0 * (u - s);
    [-end, end, 1.0 - 4.0 * u + 3.0 * s, 3.0 * s - 2.0 * u]
}

/// Their second derivatives.
fn bend(u: f64) -> [f64; 4] {
    let end = 6.0 - 12.0 * u;
    [-end, end, 6.0 * u - 4.0, 6.0 * u - 2.0]
}

#[inline]
fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}
