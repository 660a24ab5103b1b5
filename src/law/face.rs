//! Which forces dry friction of a face can bear. A face with an even pressure resists sliding and
//! turning at once: each of its points slides in its own direction, so that a face which spins
//! fast hardly resists sliding, and one that slides fast hardly resists turning.
//!
//! With the velocity `w = w_t + w_n n̂`, where `w_n` is the angular velocity times the mean
//! distance `ρ` of the points from their middle, friction dissipates
//!
//! ```text
//! F̄ H(w),    H = mean |w_t + w_n n̂ × r/ρ|,
//! ```
//!
//! with the force `F̄ ∇H(w)`. `H` is a norm; of a point it is `|w|`. Friction that took `|w|` for
//! a face, too (Howe & Cutkosky 1996), would brake a disc that spins fast 1.5 times as much as
//! its points do.
//!
//! # The norm of a face
//!
//! The mean of two points at `±p` is `½ Σ |w_t ± w_n c|` with `c = n̂ × p/ρ`. Of a round face all
//! directions of `p` count: with the mean square of `c·w_t` in place of the square,
//!
//! ```text
//! h(w) = ½ (√(S + 2 X) + √(S − 2 X)) = √((S + D)/2),
//! D = √(S² − 4 X²),    S = |w|²,    X² = w_n² w_tᵀ C w_t.
//! ```
//!
//! `h` is convex, and rises with the seminorms `√(w_tᵀ C w_t)`, `|w_n|` and what else there is of
//! `|w|`, so it is a norm; with `C` below one it is smooth. A long face is cut into two across its
//! longer axis `x`, each with the norm of its own, about its own middle at `±p x̂` from that of
//! the face:
//!
//! ```text
//! H(w) = ½ Σ h(w_x, w_y ± p w_n, ε w_n),
//! ```
//!
//! where `ε` is such that what only spins has `H = |w_n|`. With the mean squares `a² ≥ b²` of the
//! places of an even pressure along both axes over `ρ²`, and `t = (a² − b²)/(a² + b²)`, which is
//! 0 for a disc and a square and 1 for a line,
//!
//! ```text
//! a² + b² = 4/3 − √(1 − t²)/5,     p² = f² a² (1 − (1 − t)⁴),
//! C = κ diag(b², a² − p²)/(a² + b² − p²),    ε² = (1 − p²)/(1 − C_y p²).
//! ```
//!
//! The first is right to 2 % for rectangles and ellipses; `p` goes to nothing where no axis is the
//! longer one. `f` is [`EVEN_CUT`] and `κ` is [`EVEN_SPREAD`]. Against sums over areas `H` is
//! right to 1 % for a disc and a square and to 3 % for boards and lines.
//!
//! # The force of a face
//!
//! Spring and damper of an element give `y`. While it is short it is the force, and where it is
//! long the force is `F̄ ∇H(y)`. It is the gradient of the convex function
//!
//! ```text
//! φ(y) = max over s in 0 … 1 of  (1 − s) A(y) + s F̄ H(y) − s θ (1 − θ/2) F̄² − ½ s² (1 − θ)² F̄²,
//! A(y) = ½ |y|² for |y| ≤ θ F̄, else θ F̄ |y| − ½ θ² F̄²,
//! ```
//!
//! that is `(1 − s) ∇A + s F̄ ∇H`, with `θ` from [`EVEN_HELD`]. Where `H = |y|`, of what only
//! slides or only spins, `φ` is that of a point: `½ |y|²` up to the cap. The element slips where
//! `s = 1`, which is where `G = (H − θ |y|)/(1 − θ)` has reached `F̄`: it keeps the part `F̄/G` of
//! `y`, with the same force.
//!
//! Source: Goyal, Ruina & Papadopoulos 1991 (limit surfaces).

#![allow(non_snake_case, reason = "the letters of the derivation above")]

use super::limit::{Borne, Limit, Radial};
use crate::spatial::Vec3;
use crate::tuning::{EVEN_CUT, EVEN_HELD, EVEN_SHORT, EVEN_SPREAD};

#[cfg(test)]
mod tests;

/// The norm of a face with an even pressure, for a force along it and a moment about its normal
/// over the mean distance `ρ`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// Unit vectors along its longer axis, its shorter one and its normal; zero for a point.
    axes: [Vec3; 3],
    /// `p` and `ε`.
    cut: [f64; 2],
    /// The diagonal of `C`.
    spread: [f64; 2],
}

/// A norm in a direction, its gradient and its second derivatives, along the axes of the face:
/// `xx`, `xy`, `yy`, `xz`, `yz`, `zz`.
struct Norm {
    value: f64,
    gradient: [f64; 3],
    second: [f64; 6],
}

/// How an element bears a force.
enum Hold {
    /// As a spring does.
    Spring,
    /// Between spring and slip: `s`, and whether it is longer than `θ F̄`.
    Between(f64, bool),
    /// It slips, and keeps this share.
    Slip(f64),
}

/// Shares of the derivative of a force with that of spring and damper.
struct Shares {
    /// Of the second derivatives of `H`.
    bent: f64,
    /// Of the unit matrix.
    unit: f64,
    /// Of what is along the force, taken off.
    line: f64,
    /// Of what is along the difference of both forces, which are those of slip and of a spring.
    pull: f64,
    /// Length of the latter, in caps.
    held: f64,
}

impl Face {
    /// The norm for a load about the normal `normal`, from sums over its points.
    ///
    /// - `whole`: `Σ |r|²`; `turned`: `Σ (x² − y²)` and `Σ 2 x y`, where `x` and `y` are the
    ///   components of `r` along two unit vectors `first` and `normal × first` across the normal
    pub fn new(normal: &Vec3, first: &Vec3, (whole, turned): (f64, [f64; 2])) -> Self {
        if whole <= 0.0 {
            return Self::default();
        }
        let (x, y) = (turned[0] / whole, turned[1] / whole);
        let long = (x * x + y * y).sqrt().min(1.0);
        // Half of the angle of `turned`.
        let (cos, sin) = if long <= 0.0 {
            (1.0, 0.0)
        } else if x >= 0.0 {
            let cos = (0.5 * (1.0 + x / long)).sqrt();
            (cos, 0.5 * y / (long * cos))
        } else {
            let sin = (0.5 * (1.0 - x / long)).sqrt();
            (0.5 * y / (long * sin), sin)
        };
        let second = normal.cross(first);
        let along = first * cos + second * sin;
        let round = 1.0 - long * long;
        let squares = 4.0 / 3.0 - round.sqrt() / 5.0;
        let (a, b) = (0.5 * squares * (1.0 + long), 0.5 * squares * (1.0 - long));
        let nearly = (1.0 - long) * (1.0 - long);
        let p = EVEN_CUT * EVEN_CUT * a * (1.0 - nearly * nearly);
        let [line, even] = EVEN_SPREAD;
        let share = (line + (even - line) * round) / (squares - p);
        let spread = [share * b, share * (a - p)];
        let turn = (1.0 - p) / (1.0 - spread[1] * p);
        Self {
            axes: [along, normal.cross(&along), *normal],
            cut: [p.sqrt(), turn.sqrt()],
            spread,
        }
    }

    /// Whether it is that of a point, whose norm is the length.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.cut[1] <= 0.0
    }

    /// Whether a force is as short as those that are borne as by a spring in all directions.
    #[inline]
    pub fn is_short(y: &Vec3, cap: f64) -> bool {
        let most = EVEN_SHORT * cap;
        y.norm_squared() <= most * most
    }

    /// `h` of a vector along the axes.
    #[inline]
    fn half(&self, w: &[f64; 3], bends: bool) -> Norm {
        let [x, y, z] = *w;
        let (cx, cy) = (self.spread[0] * x, self.spread[1] * y);
        let (N, Q) = (z * z, cx * x + cy * y);
        let S = x * x + y * y + N;
        let D = (S * S - 4.0 * N * Q).sqrt();
        let value = (0.5 * (S + D)).sqrt();
        let inverse = 1.0 / D;
        // Half of the gradient of `D`.
        let d = [
            (x * S - 2.0 * N * cx) * inverse,
            (y * S - 2.0 * N * cy) * inverse,
            z * (S - 2.0 * Q) * inverse,
        ];
        let over = 0.5 / value;
        let g = [(x + d[0]) * over, (y + d[1]) * over, (z + d[2]) * over];
        let mut second = [0.0; 6];
        if bends {
            let (twice, of_D) = (2.0 * over, 2.0 * over * inverse);
            let unit = over + over * inverse * S;
            let (n, q) = (N * of_D, 2.0 * z * of_D);
            second = [
                (x * x - d[0] * d[0]) * of_D - g[0] * g[0] * twice + unit - n * self.spread[0],
                (x * y - d[0] * d[1]) * of_D - g[0] * g[1] * twice,
                (y * y - d[1] * d[1]) * of_D - g[1] * g[1] * twice + unit - n * self.spread[1],
                (x * z - d[0] * d[2]) * of_D - g[0] * g[2] * twice - q * cx,
                (y * z - d[1] * d[2]) * of_D - g[1] * g[2] * twice - q * cy,
                (N - d[2] * d[2]) * of_D - g[2] * g[2] * twice + unit - Q * of_D,
            ];
        }
        Norm {
            value,
            gradient: g,
            second,
        }
    }

    /// `H` of a vector along the axes; without its second derivatives unless it `bends`.
    #[inline]
    fn norm(&self, [x, y, z]: &[f64; 3], bends: bool) -> Norm {
        let [p, e] = self.cut;
        let one = self.half(&[*x, y + p * z, e * z], bends);
        let two = self.half(&[*x, y - p * z, e * z], bends);
        let (a, b) = (&one.gradient, &two.gradient);
        let mut norm = Norm {
            value: 0.5 * (one.value + two.value),
            gradient: [
                0.5 * (a[0] + b[0]),
                0.5 * (a[1] + b[1]),
                0.5 * (e * (a[2] + b[2]) + p * (a[1] - b[1])),
            ],
            second: [0.0; 6],
        };
        if bends {
            let (a, b) = (&one.second, &two.second);
            let yy = a[2] + b[2];
            norm.second = [
                0.5 * (a[0] + b[0]),
                0.5 * (a[1] + b[1]),
                0.5 * yy,
                0.5 * (e * (a[3] + b[3]) + p * (a[1] - b[1])),
                0.5 * (e * (a[4] + b[4]) + p * (a[2] - b[2])),
                0.5 * (e * (e * (a[5] + b[5]) + 2.0 * p * (a[4] - b[4])) + p * p * yy),
            ];
        }
        norm
    }

    /// How a force of the direction with the norm `H` is borne that is `m` caps long.
    #[inline]
    fn hold(H: f64, m: f64) -> Hold {
        let rest = 1.0 - EVEN_HELD;
        let long = m >= EVEN_HELD;
        let s = if long {
            let reached = m * (H - EVEN_HELD) / rest;
            if reached >= 1.0 {
                return Hold::Slip(1.0 / reached);
            }
            (reached - EVEN_HELD) / rest
        } else {
            (m * (H - 0.5 * m) - EVEN_HELD * (1.0 - 0.5 * EVEN_HELD)) / (rest * rest)
        };
        if s > 0.0 || long {
            Hold::Between(s.max(0.0), long)
        } else {
            Hold::Spring
        }
    }

    /// The components of a vector along the axes.
    #[inline]
    pub fn along(&self, x: &Vec3) -> [f64; 3] {
        let [a, b, c] = &self.axes;
        [
            a.x * x.x + a.y * x.y + a.z * x.z,
            b.x * x.x + b.y * x.y + b.z * x.z,
            c.x * x.x + c.y * x.y + c.z * x.z,
        ]
    }

    /// A vector of these components along the axes.
    #[inline]
    fn vector(&self, x: &[f64; 3]) -> Vec3 {
        let [a, b, c] = &self.axes;
        Vec3::new(
            a.x * x[0] + b.x * x[1] + c.x * x[2],
            a.y * x[0] + b.y * x[1] + c.y * x[2],
            a.z * x[0] + b.z * x[1] + c.z * x[2],
        )
    }

    /// The axes: unit vectors, across each other.
    #[inline]
    pub fn axes(&self) -> &[Vec3; 3] {
        &self.axes
    }

    /// `uᵀ K u` of [`Self::slope`].
    #[inline]
    pub fn curvature(&self, (left, slip): (&Vec3, &Vec3), cap: f64, u: &Vec3) -> f64 {
        let slips = *slip != Vec3::zeros();
        if self.is_point() || (!slips && Self::is_short(left, cap)) {
            let along = slip.dot(u);
            return u.norm_squared() - along * along;
        }
        let length = left.norm();
        let (y, u) = (self.along(&(left / length)), self.along(u));
        let [p, e] = self.cut;
        let (ey, eu) = (e * y[2], e * u[2]);
        let (py, pu) = (p * y[2], p * u[2]);
        let one = self.half_along(&[y[0], y[1] + py, ey], &[u[0], u[1] + pu, eu]);
        let two = self.half_along(&[y[0], y[1] - py, ey], &[u[0], u[1] - pu, eu]);
        let shares = Self::shares(0.5 * (one[0] + two[0]), length / cap, slips);
        let along = dot(&y, &u);
        let apart = 0.5 * (one[1] + two[1]) - shares.held * along;
        0.5 * shares.bent * (one[2] + two[2]) + shares.unit * dot(&u, &u)
            - shares.line * along * along
            + shares.pull * apart * apart
    }

    /// `h` at `w`, and its first and second derivative along `v`.
    #[inline]
    fn half_along(&self, w: &[f64; 3], v: &[f64; 3]) -> [f64; 3] {
        let (cx, cy) = (self.spread[0] * w[0], self.spread[1] * w[1]);
        let (N, Q) = (w[2] * w[2], cx * w[0] + cy * w[1]);
        let (S, along, square) = (dot(w, w), dot(w, v), dot(v, v));
        let D = (S * S - 4.0 * N * Q).sqrt();
        let value = (0.5 * (S + D)).sqrt();
        let (over, inverse) = (0.5 / value, 1.0 / D);
        let across = cx * v[0] + cy * v[1];
        let turned = w[2] * v[2];
        // Half of the derivative of `D`, and that of its second derivative.
        let d = (S * along - 2.0 * (N * across + Q * turned)) * inverse;
        let own = self.spread[0] * v[0] * v[0] + self.spread[1] * v[1] * v[1];
        let bend = S * square + 2.0 * (along * along - d * d - Q * v[2] * v[2] - N * own)
            - 8.0 * turned * across;
        let rise = (along + d) * over;
        let bend = (square + bend * inverse - 2.0 * rise * rise) * over;
        [value, rise, bend]
    }

    /// Shares of the slope of a force of the direction with the norm `H` that is `m` caps long.
    #[inline]
    fn shares(H: f64, m: f64, slips: bool) -> Shares {
        let rest = 1.0 - EVEN_HELD;
        let hold = if slips {
            Hold::Slip(1.0)
        } else {
            Self::hold(H, m)
        };
        let (bent, unit, pull) = match hold {
            Hold::Spring => (0.0, 1.0, 0.0),
            Hold::Slip(_) => (1.0 / m, 0.0, 0.0),
            Hold::Between(s, long) => {
                let unit = if long { EVEN_HELD / m } else { 1.0 };
                let pull = if s > 0.0 { 1.0 / (rest * rest) } else { 0.0 };
                (s / m, (1.0 - s) * unit, pull)
            }
        };
        Shares {
            bent,
            unit,
            line: if m >= EVEN_HELD { unit } else { 0.0 },
            pull,
            held: m.min(EVEN_HELD),
        }
    }

    /// Derivative of the force with that of spring and damper where that leaves `left`, which is
    /// not zero, as a share, along the axes: symmetric.
    pub fn slope(&self, left: &Vec3, cap: f64, slips: bool) -> [[f64; 3]; 3] {
        let length = left.norm();
        let m = length / cap;
        let y = self.along(&(left / length));
        let norm = self.norm(&y, true);
        let shares = Self::shares(norm.value, m, slips);
        let Shares {
            bent,
            unit,
            line,
            pull,
            held,
        } = shares;
        let of_H = &norm.gradient;
        let g = [
            of_H[0] - held * y[0],
            of_H[1] - held * y[1],
            of_H[2] - held * y[2],
        ];
        let at = |i: usize, j: usize, second: f64| {
            bent * second + pull * g[i] * g[j] - line * y[i] * y[j]
        };
        let [xx, xy, yy, xz, yz, zz] = norm.second;
        let (xy, xz, yz) = (at(0, 1, xy), at(0, 2, xz), at(1, 2, yz));
        [
            [at(0, 0, xx) + unit, xy, xz],
            [xy, at(1, 1, yy) + unit, yz],
            [xz, yz, at(2, 2, zz) + unit],
        ]
    }
}

/// Inner product.
#[inline]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Limit<Vec3> for Face {
    #[inline]
    fn holds(&self, y: &Vec3, cap: f64) -> bool {
        if self.is_point() {
            return Radial.holds(y, cap);
        }
        if Self::is_short(y, cap) {
            return true;
        }
        let length = y.norm();
        let H = self.norm(&self.along(&(y / length)), false).value;
        !matches!(Self::hold(H, length / cap), Hold::Slip(_))
    }

    #[inline]
    fn springs(&self, y: &Vec3, cap: f64) -> bool {
        if self.is_point() {
            return Radial.holds(y, cap);
        }
        if Self::is_short(y, cap) {
            return true;
        }
        let length = y.norm();
        let H = self.norm(&self.along(&(y / length)), false).value;
        matches!(Self::hold(H, length / cap), Hold::Spring)
    }

    #[inline]
    fn bear(&self, y: Vec3, cap: f64) -> Borne<Vec3> {
        if self.is_point() {
            return Radial.bear(y, cap);
        }
        let springs = Borne {
            force: y,
            left: y,
            share: 1.0,
            slip: Vec3::zeros(),
            growth: Vec3::zeros(),
        };
        let squared = y.norm_squared();
        if Self::is_short(&y, cap) || squared.is_nan() {
            return springs;
        }
        let length = squared.sqrt();
        let slip = y / length;
        let norm = self.norm(&self.along(&slip), false);
        let gradient = self.vector(&norm.gradient);
        let m = length / cap;
        match Self::hold(norm.value, m) {
            Hold::Spring => springs,
            Hold::Slip(share) => Borne {
                force: gradient * cap,
                left: y * share,
                share,
                slip,
                growth: gradient,
            },
            Hold::Between(s, _) => Borne {
                force: (slip * (m.min(EVEN_HELD) * (1.0 - s)) + gradient * s) * cap,
                ..springs
            },
        }
    }

    #[inline]
    fn twice_held(&self, y: &Vec3, cap: f64) -> f64 {
        if self.is_point() || Self::is_short(y, cap) {
            return y.norm_squared();
        }
        let length = y.norm();
        let m = length / cap;
        let H = self.norm(&self.along(&(y / length)), false).value;
        let held = m.min(EVEN_HELD);
        let spring = held * (2.0 * m - held);
        let shares = match Self::hold(H, m) {
            Hold::Spring => spring,
            Hold::Between(s, _) => {
                let more = s * (1.0 - EVEN_HELD);
                spring + more * more
            }
            Hold::Slip(_) => 2.0 * m * H - 1.0,
        };
        shares * cap * cap
    }
}
