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
//!    ξ = (17/15 + t²/5)(1 + q)/2,    ζ = 0.69 + q/5 + (1 + q) 0.095 t²/(5/4 − t²),
//!    ```
//!
//!    which for rectangles and ellipses up to 10:1 is right to 0.03; but `ζ` has the value with
//!    which the curve fits on the way from spinning to sliding, 0.02 more.
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

use super::limit::{Borne, Limit, Radial};
use crate::spatial::{Vec3, across};
use crate::tuning::{EVEN_BETWEEN, EVEN_SPIN, EVEN_TURN};

#[cfg(test)]
mod tests;

/// The set of a face with an even pressure, for a force along it and a moment about its normal over
/// the mean distance `ρ`; all lengths in caps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// Unit vector along its normal; zero for a point.
    normal: Vec3,
    /// `t cos 2β` and `t sin 2β`, where `β` is the angle of its longer axis with `across(normal)`.
    stretch: [f64; 2],
    /// A vector along the sliding that its set is for; zero where there is none.
    way: Vec3,
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
    /// Of a load about the normal `normal`, from sums over its points. It has no set until it is
    /// told the way of sliding, see [`Self::towards`].
    ///
    /// - `whole`: `Σ |r|²`; `turned`: `Σ (x² − y²)` and `Σ 2 x y`, where `x` and `y` are the
    ///   components of `r` along `across(normal)` and `normal × across(normal)`
    pub fn new(normal: &Vec3, (whole, turned): (f64, [f64; 2])) -> Self {
        if whole <= 0.0 {
            return Self::default();
        }
        Self {
            normal: *normal,
            stretch: turned.map(|x| x / whole),
            ..Self::default()
        }
    }

    /// The same with the set for sliding along `way`.
    #[must_use]
    pub fn towards(self, way: &Vec3) -> Self {
        let face = Self { way: *way, ..self };
        if self.is_point() {
            return face;
        }
        let [x, y] = self.stretch;
        let t = (x * x + y * y).min(1.0);
        let q = self.stretch_along(way);
        let slide = (17.0 / 15.0 + 0.2 * t) * 0.5 * (1.0 + q);
        let spin = EVEN_SPIN + 0.2 * q + (1.0 + q) * 0.095 * t / (1.25 - t);
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
            ends: [A, B],
            middle: (center, spin + s),
            borders: [[sin, cos], end],
            ..face
        }
    }

    /// The way of sliding that the set is for.
    #[inline]
    pub fn way(&self) -> &Vec3 {
        &self.way
    }

    /// `q`.
    fn stretch_along(&self, way: &Vec3) -> f64 {
        let first = across(&self.normal);
        let second = self.normal.cross(&first);
        let (x, y) = (first.dot(way), second.dot(way));
        let whole = x * x + y * y;
        if whole > 0.0 {
            let [a, b] = self.stretch;
            (a * ((x * x - y * y) / whole) + b * (2.0 * x * y / whole)).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }

    /// Whether it is that of a point, which is a ball.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.normal == Vec3::zeros()
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
}

impl Limit<Vec3> for Face {
    #[inline]
    fn holds(&self, y: &Vec3, cap: f64) -> bool {
        if self.is_point() {
            return Radial.holds(y, cap);
        }
        let n = self.normal.dot(y);
        let arc = self.arc([(y - self.normal * n).norm(), n.abs()], cap);
        let bound = arc.radius * cap;
        arc.squared <= bound * bound
    }

    #[inline]
    fn bear(&self, y: Vec3, cap: f64) -> Borne<Vec3> {
        if self.is_point() {
            return Radial.bear(y, cap);
        }
        let n = self.normal.dot(&y);
        let along = y - self.normal * n;
        let x = along.norm();
        let arc = self.arc([x, n.abs()], cap);
        let bound = arc.radius * cap;
        if arc.squared <= bound * bound || arc.squared.is_nan() {
            return Borne::all(y);
        }
        let distance = arc.squared.sqrt();
        let share = bound / distance;
        let slip = arc.apart.map(|x| x / distance);
        let [c, r] = [arc.center, [arc.radius; 2]];
        let force = [0, 1].map(|i| cap * (c[i] + r[i] * slip[i]));
        // `c + r ŝ`, whose direction changes with the cap, too.
        let rise = arc.radius + share * (slip[0] * c[0] + slip[1] * c[1]);
        let growth = [0, 1].map(|i| (1.0 - share) * c[i] + rise * slip[i]);
        let (along, around) = if x > 0.0 {
            (along * (1.0 / x), force[0] / x)
        } else {
            (Vec3::zeros(), share)
        };
        let normal = self.normal * n.signum();
        let vector = |[x, z]: [f64; 2]| along * x + normal * z;
        Borne {
            force: vector(force),
            share,
            around,
            slip: vector(slip),
            growth: vector(growth),
        }
    }

    #[inline]
    fn clip(&self, x: Vec3, cap: f64) -> Vec3 {
        self.bear(x, cap).force
    }
}
