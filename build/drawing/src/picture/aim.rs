//! Points in short numbers, and where a lamp's picture has them.

/// A point in short numbers.
pub(super) type Point = [f32; 3];

/// Factors of x, y, z and 1 that give column, row and nearness in a lamp's picture.
pub(super) type Aim = [[f32; 4]; 3];

/// Inner product.
pub(super) fn dot(a: &Point, b: &Point) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Column, row and nearness of a place.
#[inline]
pub(super) fn place(rows: &Aim, p: &[f32; 3]) -> [f32; 3] {
    let along = |row: &[f32; 4]| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    [along(&rows[0]), along(&rows[1]), along(&rows[2])]
}
