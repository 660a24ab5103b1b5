//! Where a surface of heights ends.

use super::Field;
use crate::spatial::Vec3;

impl Field {
    /// What bounds the directions in which a sample at the end of the surface carries: the normal
    /// there and, in the plane of the surface, the direction out of it, unit vectors; none where
    /// the surface goes on.
    pub fn rim(&self, i: usize, j: usize) -> Option<[Vec3; 2]> {
        let [nx, ny] = self.samples.counts;
        let out = |k: usize, n: usize| f64::from(i8::from(k + 1 == n) - i8::from(k == 0));
        let out = Vec3::new(out(i, nx), out(j, ny), 0.0);
        let (_, n, _) = self.sample(i, j);
        let away = (out - n * n.dot(&out)).try_normalize(0.0)?;
        Some([n, away])
    }

    /// Whether a place lies over the surface or under it, and not beside.
    pub fn is_over(&self, p: &Vec3) -> bool {
        let half = self.samples.size.map(|s| 0.5 * s);
        p.x.abs() <= half[0] && p.y.abs() <= half[1]
    }
}
