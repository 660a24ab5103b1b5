//! Which forces dry friction of a face can bear. A face with an even pressure resists sliding and
//! turning at once: each of its points slides in its own direction, so that a face which spins
//! fast hardly resists sliding, and one that slides fast hardly resists turning.
//!
//! With the velocity `w = w_t + w_n n̂`, where `w_n` is the angular velocity times the mean
//! distance `ρ` of the points from their middle, friction dissipates
//!
//! ```text
//! F̄ H(w),    H = mean |w_t + w_n n̂ × r/ρ|.
//! ```
//!
//! The forces that it can bear are those with `f·w ≤ F̄ H(w)` for all `w`: a convex set, of a point
//! the ball with the radius `F̄`. An element that is pulled by more gives the nearest one of them.
//! So it is linear while it sticks, dissipates as much as it can where it slips, and is the
//! gradient of a convex function. Friction that took the ball for a face, too (Howe & Cutkosky
//! 1996), would brake a disc that spins fast 1.5 times as much as its points do.
//!
//! # The set of a face
//!
//! It is taken to be round about the normal: a curve of `x = |f_t|/F̄` and `z = |f_n|/F̄` from
//! (0, 1) to (1, 0), of three arcs of circles that go on in each other smoothly. So the nearest
//! force is found in closed form.
//!
//! 1. The first and the last one have the curvature that `H` has for what spins with little
//!    sliding, and for what slides with little spin, by its second derivatives. With `r̂ = r/|r|`
//!    and the direction `ŵ` of the sliding the radii are
//!
//!    ```text
//!    ζ = mean (r̂·ŵ)² ρ/|r|,    ξ = mean (r·ŵ)²/ρ²,
//!    ```
//!
//!    about (0, B) with `B = 1 − ζ` and about (A, 0) with `A = 1 − ξ`. Both depend on the direction
//!    of the sliding: a line that spins and slides across itself has ½ and 0, along itself ∞ and
//!    4/3. With the mean squares `a² ≥ b²` along its axes, `t = (a² − b²)/(a² + b²)`, which is 0
//!    for a disc and a square and 1 for a line, and the angle `α` between `ŵ` and its longer axis,
//!    `q = t cos 2α`,
//!
//!    ```text
//!    ξ = (17/15 + t²/5)(1 + q)/2,    ζ = 0.69 + 0.188 q + (1 + q) 0.089 t²/(5/4 − t²),
//!    ```
//!
//!    which for rectangles and ellipses up to 4:1 is right to 0.03 and for 10:1 to 0.08; but `ζ`
//!    has the value with which the curve fits on the way from spinning to sliding, 0.02 more.
//! 2. The first arc ends where its normal is `(sin θ, cos θ)`, with `tan θ/2` from [`EVEN_TURN`].
//!    The one in the middle goes on there, with the radius `ζ + s` about
//!    `(−s sin θ, B − s cos θ)`, and ends on the last one: the centres of these two are as far
//!    apart as their radii differ, by `s + A − B`. Squared, that is linear in `s`,
//!
//!    ```text
//!    s = A B/(A (1 − sin θ) − B (1 − cos θ)).
//!    ```
//!
//! The direction of the sliding is that at the start of a step, constant while the step is solved:
//! a set that changed with the force would not be that of a convex function. A long face that
//! spins and slides askew has a force across the way that it slides, up to 0.2 of the cap, that
//! this set does not give; it turns with the face.
//!
//! Source: Goyal, Ruina & Papadopoulos 1991 (limit surfaces); Moreau 1970 (the nearest force).

#![allow(non_snake_case, reason = "the letters of the derivation above")]

use super::limit::{Limit, Radial, Resistance};
use crate::spatial::Vec3;
use crate::tuning::{EVEN_BETWEEN, EVEN_LEAST, EVEN_SPIN, EVEN_TURN};

#[cfg(test)]
mod tests;

#[cfg(test)]
crate::spoil::spoil!(Face: normal ends middle borders;);

/// The set of a face with an even pressure, for a force along it and a moment about its normal over
/// the mean distance `ρ`; all lengths in caps. By default that of a point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// Unit vector along its normal.
    normal: Vec3,
    /// `A` and `B`.
    ends: [f64; 2],
    /// Centre and radius of the arc in the middle.
    middle: ([f64; 2], f64),
    /// Unit vectors along the normals at its ends.
    borders: [[f64; 2]; 2],
}

/// The arc of the curve that is nearest to a force.
struct Arc {
    /// Its centre, in caps.
    center: [f64; 2],
    /// Its radius, in caps.
    radius: f64,
    /// The force from its centre.
    apart: [f64; 2],
    /// The distance of the force from its centre, squared.
    squared: f64,
}

impl Face {
    /// Of a load about the normal `normal`.
    ///
    /// - `q`: `Σ (x² − y²)` over its points as a share of `Σ (x² + y²)`, where `x` is the distance
    ///   from their middle along the direction of the sliding and `y` the one across it
    /// - `t`: the same share along the longest axis, squared
    pub fn new(normal: &Vec3, q: f64, t: f64) -> Self {
        let t = t.min(1.0);
        let slide = (17.0 / 15.0 + 0.2 * t) * 0.5 * (1.0 + q);
        let spin = EVEN_SPIN + 0.188 * q + (1.0 + q) * 0.089 * t / (1.25 - t);
        let B = 1.0 - spin;
        let [low, high] = EVEN_BETWEEN.map(|share| share * B);
        let A = (1.0 - slide).max(low.min(high)).min(low.max(high));
        let [least, more] = EVEN_TURN;
        // With the tangent `k` of half of the angle.
        let k = least + more * (A + B);
        let unit = 1.0 / (1.0 + k * k);
        let [sin, cos] = [2.0 * k * unit, (1.0 - k * k) * unit];
        let over = A * (1.0 - k) * (1.0 - k) - 2.0 * B * k * k;
        let s = if over == 0.0 {
            0.0
        } else {
            A * B / (unit * over)
        };
        let (center, last) = ([-s * sin, B - s * cos], s + A - B);
        let end = if last == 0.0 {
            [1.0, 0.0]
        } else {
            [(A - center[0]) / last, -center[1] / last]
        };
        Self {
            normal: *normal,
            ends: [A, B],
            middle: (center, spin + s),
            borders: [[sin, cos], end],
        }
    }

    /// Whether it is that of a point, which is a ball.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.middle.1 <= 0.0
    }

    /// Turns it to another normal, near its own.
    pub fn lean(&mut self, normal: &Vec3) {
        self.normal = *normal;
    }

    /// The arc that is nearest to a force, of which `x` is the length along the face and `z` that
    /// along the normal.
    #[inline]
    fn arc(&self, [x, z]: [f64; 2], cap: f64) -> Arc {
        let [A, B] = self.ends;
        let [one, two] = &self.borders;
        let (center, radius) = if x * one[1] < (z - cap * B) * one[0] {
            ([0.0, B], 1.0 - B)
        } else if (x - cap * A) * two[1] > z * two[0] {
            ([A, 0.0], 1.0 - A)
        } else {
            self.middle
        };
        let apart = [x - cap * center[0], z - cap * center[1]];
        Arc {
            center,
            radius,
            apart,
            squared: apart[0] * apart[0] + apart[1] * apart[1],
        }
    }

    /// The nearest force of the set to one that need not belong to it and changes with the velocity
    /// by `slope`.
    fn nearest(&self, y: Vec3, cap: f64, slope: f64) -> Resistance<Vec3> {
        let n = self.normal.dot(&y);
        let along = y - self.normal * n;
        let x = along.norm();
        let arc = self.arc([x, n.abs()], cap);
        let bound = arc.radius * cap;
        if arc.squared <= bound * bound || arc.squared.is_nan() {
            return Resistance::sticking(y, slope);
        }
        let inverse = 1.0 / arc.squared.sqrt();
        let share = bound * inverse;
        // Direction of the slip, and the force.
        let [a, c] = [arc.apart[0] * inverse, arc.apart[1] * inverse];
        let f = cap * arc.center[0] + bound * a;
        let g = cap * arc.center[1] + bound * c;
        // Both along the face as shares of what `y` has there.
        let (around, out) = if x > 0.0 {
            let inverse = 1.0 / x;
            (f * inverse, a * inverse)
        } else {
            (share, inverse)
        };
        let sign = n.signum();
        Resistance {
            force: y * around + self.normal * (sign * g - around * n),
            slope: slope * share,
            around: slope * around,
            slip: y * out + self.normal * (sign * c - out * n),
        }
    }
}

impl Limit<Vec3> for Face {
    #[inline]
    fn holds(&self, y: &Vec3, cap: f64) -> bool {
        if self.is_point() {
            return Radial.holds(y, cap);
        }
        let least = EVEN_LEAST * cap;
        if y.norm_squared() <= least * least {
            return true;
        }
        let n = self.normal.dot(y);
        let arc = self.arc([(y - self.normal * n).norm(), n.abs()], cap);
        let bound = arc.radius * cap;
        arc.squared <= bound * bound
    }

    #[inline]
    fn bear(&self, y: Vec3, cap: f64, slope: f64) -> Resistance<Vec3> {
        if self.is_point() {
            return Radial.bear(y, cap, slope);
        }
        let least = EVEN_LEAST * cap;
        if y.norm_squared() <= least * least {
            Resistance::sticking(y, slope)
        } else {
            self.nearest(y, cap, slope)
        }
    }

    #[inline]
    fn clip(&self, x: Vec3, cap: f64) -> Vec3 {
        self.bear(x, cap, 1.0).force
    }
}
