//! Hollows: where the surface bends up so much that a ball may touch it in several places at once,
//! as at the foot of a step.
//!
//! The squared distance of a place of the surface from a point `c` has the second derivatives
//! `1 + ∇H ∇Hᵀ + (H − c_z) ∇²H`. Over a ball of the radius `R` that touches the surface,
//! `c_z − H = R √(1 + |∇H|²)`. So there is one nearest place alone where
//! `R √(1 + |∇H|²) ∇²H < 1`; elsewhere all of them are looked for.

use super::{Field, count};
use crate::spatial::Vec3;
use crate::tuning::{HOLLOW_LOOKS, ROUND_OFF};

/// Room for the samples that are looked at along x or y.
const ROOM: usize = HOLLOW_LOOKS + 3;

/// A place of the surface, along x and y, m, and the square of its distance from a point.
type Foot = (f64, [f64; 2]);

const NOWHERE: Foot = (f64::INFINITY, [0.0; 2]);

/// The place of a line between two samples that is nearest to a point.
fn foot(c: &Vec3, a: &Vec3, b: &Vec3) -> Foot {
    let way = b - a;
    let share = ((c - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    let p = a + way * share;
    ((p - c).norm_squared(), [p.x, p.y])
}

fn nearer(a: Foot, b: Foot) -> Foot {
    if b.0 < a.0 { b } else { a }
}

impl Field {
    /// What `∇²H`, or `−∇²H` with the sign −1, does not exceed over a cell, 1/m: differences of its
    /// Bézier points bound those of the slopes.
    pub(super) fn bend(&self, points: &[[f64; 4]; 4], sign: f64) -> f64 {
        let [px, py] = self.grid.per_metre;
        let (mut along, mut both) = (0.0_f64, 0.0_f64);
        for k in 0..4 {
            for l in 1..3 {
                let bend = |at: fn(&[[f64; 4]; 4], usize, usize) -> f64| {
                    6.0 * sign
                        * (at(points, k, l - 1) - 2.0 * at(points, k, l) + at(points, k, l + 1))
                };
                along = along.max(bend(|p, k, l| p[k][l]) * px * px);
                along = along.max(bend(|p, k, l| p[l][k]) * py * py);
            }
        }
        for (a, b) in points.iter().zip(&points[1..]) {
            for k in 0..3 {
                both = both.max(9.0 * (b[k + 1] - b[k] - a[k + 1] + a[k]).abs() * px * py);
            }
        }
        along + both
    }

    /// Whether a ball about a point may touch the surface in several places within `around`, m.
    #[inline]
    pub fn is_hollow(&self, c: &Vec3, radius: f64, around: f64) -> bool {
        if self.hollows.top() * radius < 1.0 {
            return false;
        }
        self.hollows.highest(self.square(c.x, c.y, around)) * radius >= 1.0
    }

    /// Whether the surface may bend up or down by as much as `bend`, 1/m, within a square of half
    /// the width `around` about a point.
    #[inline]
    pub fn bends_by(&self, c: &Vec3, around: f64, bend: f64) -> bool {
        let square = self.square(c.x, c.y, around);
        [&self.hollows, &self.humps]
            .into_iter()
            .any(|bends| bends.top() >= bend && bends.highest(square) >= bend)
    }

    /// The most by which the surface bends down anywhere, 1/m, or more.
    pub fn humps(&self) -> f64 {
        self.humps.top().max(0.0)
    }

    /// The most by which the surface bends down within a square of half the width `around` about a
    /// place, 1/m, or more.
    pub fn hump(&self, x: f64, y: f64, around: f64) -> f64 {
        if self.humps.top() <= 0.0 {
            return 0.0;
        }
        self.humps.highest(self.square(x, y, around)).max(0.0)
    }

    /// How far places within `around`, m, of a point lie from each other if they are told apart, m.
    pub fn looks_apart(around: f64) -> f64 {
        2.0 * around / count(HOLLOW_LOOKS)
    }

    /// Calls `take` with places, along x and y, near which the surface is nearer to a point than
    /// around them, and nearer than `around`, m: of lines between samples, or, with many samples
    /// around, of every second, third … of them.
    pub fn each_nearest(&self, c: &Vec3, around: f64, mut take: impl FnMut([f64; 2])) {
        let counts = self.samples.counts;
        let mut places = [[0_usize; ROOM]; 2];
        let mut number = [0_usize; 2];
        for k in 0..2 {
            let across = Self::looks_apart(around) * self.grid.per_metre[k];
            let [first, last] = self.around(c[k] - around, c[k] + around, k, counts[k]);
            // At most one in a cell of the field; a field has few samples enough for this.
            let step = (1..counts[k]).find(|n| count(*n) >= across);
            let step = step.unwrap_or(counts[k]);
            let mut at = first / step * step;
            while number[k] < ROOM {
                places[k][number[k]] = at.min(counts[k] - 1);
                number[k] += 1;
                if at >= last {
                    break;
                }
                at += step;
            }
        }
        let [nx, ny] = number;
        let sample = |i: usize, j: usize| {
            let (i, j) = (places[0][i], places[1][j]);
            let [x, y] = self.place(i, j);
            Vec3::new(x, y, self.samples.heights[j * counts[0] + i])
        };
        let mut feet = [[NOWHERE; ROOM]; ROOM];
        for j in 0..ny {
            for i in 0..nx {
                let here = sample(i, j);
                if i + 1 < nx && places[0][i] < places[0][i + 1] {
                    let found = foot(c, &here, &sample(i + 1, j));
                    feet[j][i] = nearer(feet[j][i], found);
                    if j > 0 {
                        feet[j - 1][i] = nearer(feet[j - 1][i], found);
                    }
                }
                if j + 1 < ny && places[1][j] < places[1][j + 1] {
                    let found = foot(c, &here, &sample(i, j + 1));
                    feet[j][i] = nearer(feet[j][i], found);
                    if i > 0 {
                        feet[j][i - 1] = nearer(feet[j][i - 1], found);
                    }
                }
            }
        }
        // The next place of the same dip is within a cell of those that are looked at.
        let apart = [0, 1].map(|k| {
            let cells = places[k][..number[k]].windows(2).map(|two| two[1] - two[0]);
            count(cells.max().unwrap_or(1)) * self.grid.cell[k] * (1.0 + ROUND_OFF)
        });
        for j in 0..ny {
            for i in 0..nx {
                let (least, place) = feet[j][i];
                if least > around * around {
                    continue;
                }
                let rows = j.saturating_sub(1)..(j + 2).min(ny);
                let others = rows.flat_map(|l| {
                    let columns = i.saturating_sub(1)..(i + 2).min(nx);
                    columns.map(move |k| (l, k))
                });
                // Of cells whose common side is nearest, the first one.
                let mut nearer = others.filter(|&(l, k)| {
                    let (distance, other) = feet[l][k];
                    let by_distance = distance.total_cmp(&least);
                    let beside = [0, 1].map(|a| (other[a] - place[a]).abs() <= apart[a]);
                    beside == [true; 2] && by_distance.then((l, k).cmp(&(j, i))).is_lt()
                });
                if nearer.next().is_none() {
                    take(place);
                }
            }
        }
    }
}
