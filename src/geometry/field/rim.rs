//! How sharp a surface of heights is, and where it ends or goes on in other terrain.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Field, Rim};
use crate::geometry::segment::cover;
use crate::spatial::Vec3;
use crate::tuning::{EVEN_EDGE, RIDGE, RIDGE_LEAST, SEAM};

/// Along which axis a side of the surface is the lowest or the highest place: 0, 1, and −1, 1.
const SIDES: [(usize, f64); 4] = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)];

impl Field {
    /// How much of the sharpness of a point a sample has: the share with which it carries a shape
    /// that lies on it alone. 0 where the surface is even or hollow, 1 where it turns down by
    /// [`RIDGE`] from one cell to the next, or ends.
    pub(super) fn ridge(&self, i: usize, j: usize) -> f64 {
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

    /// How sharp the surface is at a place, 0 … 1: as its samples are, interpolated between them; 0
    /// beyond the end.
    pub fn sharp(&self, x: f64, y: f64) -> f64 {
        let (Some((i, u)), Some((j, v))) = (self.cell_at(x, 0), self.cell_at(y, 1)) else {
            return 0.0;
        };
        let first = j * self.samples.counts[0] + i;
        let row = |k: usize| self.ridges[k] * (1.0 - u) + self.ridges[k + 1] * u;
        row(first) * (1.0 - v) + row(first + self.samples.counts[0]) * v
    }

    /// How a sample lies to the end of the surface.
    pub fn rim(&self, i: usize, j: usize) -> Rim {
        let counts = self.samples.counts;
        let (mut out, mut seam) = (Vec3::zeros(), false);
        for (side, (axis, sign)) in SIDES.into_iter().enumerate() {
            let [at, along] = if axis == 0 { [i, j] } else { [j, i] };
            let last = if sign > 0.0 { counts[axis] - 1 } else { 0 };
            if at != last {
                continue;
            }
            // All cells of that side at the sample.
            let cells = &self.seams[side];
            let own = along.saturating_sub(1)..(along + 1).min(cells.len());
            if !cells.is_empty() && cells[own].iter().all(|seam| *seam) {
                seam = true;
            } else {
                out[axis] = sign;
            }
        }
        let (_, n, _) = self.sample(i, j);
        match (out - n * n.dot(&out)).try_normalize(0.0) {
            Some(away) => Rim::End([n, away]),
            None if seam => Rim::Seam,
            None => Rim::Inside,
        }
    }

    /// Whether a place lies over the surface or under it, and not beside.
    pub fn is_over(&self, p: &Vec3) -> bool {
        let half = self.grid.half;
        p.x.abs() <= half[0] && p.y.abs() <= half[1]
    }

    /// Whether the surface is below all of a square of half the width `around` about a place.
    pub fn covers(&self, p: &Vec3, around: f64) -> bool {
        let half = self.grid.half;
        p.x.abs() + around <= half[0] && p.y.abs() + around <= half[1]
    }

    /// Whether it goes on anywhere in other terrain.
    #[inline]
    pub fn has_seams(&self) -> bool {
        self.seams.iter().any(|side| !side.is_empty())
    }

    /// Whether a place lies beyond a part of the end where the surface goes on in other terrain,
    /// which then carries what is there.
    pub fn goes_on(&self, [x, y]: [f64; 2]) -> bool {
        let place = [x, y];
        SIDES.into_iter().enumerate().any(|(side, (axis, sign))| {
            let cells = &self.seams[side];
            let half = self.grid.half[1 - axis];
            !cells.is_empty()
                && sign * place[axis] > self.grid.half[axis]
                && self
                    .cell_at(place[1 - axis].clamp(-half, half), 1 - axis)
                    .is_some_and(|(cell, _)| cells[cell])
        })
    }

    /// The nearest place over the surface.
    pub fn within(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.grid.half;
        [x.clamp(-a, a), y.clamp(-b, b)]
    }

    /// The same where it ends beside other terrain in which it goes on, if there is such an end:
    /// nothing can lie on it or run against it then. A cell that goes on in part stays an end.
    ///
    /// - `carried`: adds the parts of a segment, from 0 to 1, that other terrain carries with about
    ///   the given normal
    pub fn beside(&self, carried: impl Fn([Vec3; 2], &Vec3, &mut Vec<[f64; 2]>)) -> Option<Self> {
        let [nx, ny] = self.samples.counts;
        let mut parts = Vec::new();
        let mut is_seam = |axis: usize, sign: f64, cell: usize| {
            let place = |along: usize| match (axis, sign > 0.0) {
                (0, false) => [0, along],
                (0, true) => [nx - 1, along],
                (_, false) => [along, 0],
                (_, true) => [along, ny - 1],
            };
            let ends = [cell, cell + 1].map(|along| {
                let [i, j] = place(along);
                let (x, n, _) = self.sample(i, j);
                (x, n)
            });
            let n = (ends[0].1 + ends[1].1).normalize();
            if ends.iter().any(|(_, own)| (own - n).norm() >= EVEN_EDGE) {
                return false;
            }
            let mut out = Vec3::zeros();
            out[axis] = sign;
            let away = (out - n * n.dot(&out)).normalize();
            let ends = ends.map(|(x, _)| x + away * SEAM);
            parts.clear();
            carried(ends, &n, &mut parts);
            cover(&mut parts, SEAM / (ends[1] - ends[0]).norm())
        };
        let seams = SIDES.map(|(axis, sign)| {
            let cells = [ny - 1, nx - 1][axis];
            let cells: Vec<bool> = (0..cells).map(|cell| is_seam(axis, sign, cell)).collect();
            if cells.contains(&true) {
                cells
            } else {
                Vec::new()
            }
        });
        seams.iter().any(|side| !side.is_empty()).then(|| Self {
            seams,
            ..self.clone()
        })
    }
}
