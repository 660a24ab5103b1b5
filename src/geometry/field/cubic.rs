//! The bicubic surface over one cell of a grid.

/// A place in a cell, and the samples about it.
pub(super) struct Cell<'a> {
    /// How far in the cell, 0 … 1, along x and y.
    pub(super) u: f64,
    pub(super) v: f64,
    /// The nodes of its corners, see [`Field`](super::Field): both along x of the first row, and of
    /// the second.
    pub(super) rows: [[&'a [f64; 4]; 2]; 2],
}

impl Cell<'_> {
    /// Height, m, and slopes along x and y, m per cell.
    #[inline]
    pub(super) fn tangent(&self) -> (f64, [f64; 2]) {
        let (x, y) = (value(self.u), value(self.v));
        let (dx, dy) = (slope(self.u), slope(self.v));
        let across = self.across(&x);
        let height = self.base() + dot(&y, &across);
        (height, [dot(&y, &self.across(&dx)), dot(&dy, &across)])
    }

    /// Second derivatives: along x, of both, along y, m per cell and cell.
    pub(super) fn bend(&self) -> [f64; 3] {
        let along_x = dot(&value(self.v), &self.across(&bend(self.u)));
        let both = dot(&slope(self.v), &self.across(&slope(self.u)));
        let along_y = dot(&bend(self.v), &self.across(&value(self.u)));
        [along_x, both, along_y]
    }

    /// Height of its first corner, m. Differences from one corner keep an even surface even.
    #[inline]
    fn base(&self) -> f64 {
        self.rows[0][0][0]
    }

    /// What a polynomial along x makes of both rows: heights over the base, and slopes along y.
    #[inline]
    fn across(&self, x: &[f64; 4]) -> [f64; 4] {
        let base = self.base();
        let [[a, b], [c, d]] = &self.rows;
        [
            dot(x, &[a[0] - base, b[0] - base, a[1], b[1]]),
            dot(x, &[c[0] - base, d[0] - base, c[1], d[1]]),
            dot(x, &[a[2], b[2], a[3], b[3]]),
            dot(x, &[c[2], d[2], c[3], d[3]]),
        ]
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
