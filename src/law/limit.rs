//! Which forces dry friction can bear: of a point, and about an axis, those that are no longer
//! than the cap `F̄`. A face with an even pressure resists sliding and turning at once: each of
//! its points slides in its own direction, so that a face which spins fast hardly resists
//! sliding, and one that slides fast hardly resists turning.
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
//! its points do. The mean is taken here as that of two halves: at the points `±p` it would be `½
//! Σ |w_t ± w_n c|` with `c = n̂ × p/ρ` of unit length, where `|w_t ± w_n c|² = |w|² ± 2 w_n
//! c·w_t`. With the root mean square of `c·w_t` over the face in its place,
//!
//! ```text
//! H = ½ (√(S + 2 X) + √(S − 2 X)) = √((S + D)/2),
//! D = √(S² − 4 X²),    S = |w|²,    X² = w_n² wᵀ C w,    C = κ Σ (n̂ × r)(n̂ × r)ᵀ/Σ |r|²
//! ```
//!
//! `H` is convex, and rises with the seminorms `√(wᵀ C w)`, `|w_n|` and what else there is of
//! `|w|`, so it is a norm; with `κ < 1` it is smooth. `κ` is [`EVEN_SPREAD`]. Against sums over
//! areas `H` is right to 1 % for a disc and a square, 4 % for a board of 4:1 and 5 % for a line.
//!
//! What spring and damper of an element give, `y`, is the force where `H = |y|`. In general the
//! force is the gradient of the convex function `½ H²(y)` while `H(y) ≤ F̄`, and of `F̄ H(y)`
//! beyond: what slips keeps the part `F̄/H` of `y`, and its force is that of its direction. For
//! `½ H²` a face that carries a load along itself is softer against turning, by the factor `1 −
//! C` at most.
//!
//! Source: Goyal, Ruina & Papadopoulos 1991 (limit surfaces).

#![allow(non_snake_case, reason = "the letters of the derivation above")]

use crate::spatial::{Mat3, Vec3};
use crate::tuning::EVEN_SPREAD;
use std::ops::{Add, Div, Mul, Sub};

/// A displacement, velocity or force along a line ([`f64`]) or in a plane or in space ([`Vec3`]).
pub trait Vector:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Inner product.
    fn dot(&self, other: &Self) -> f64;

    /// Direction of a vector that is longer than `length`, and one over its own length; zero
    /// instead of the latter along a line, which has no directions but its own. None for a vector
    /// that is not longer.
    fn beyond(&self, length: f64) -> Option<(Self, f64)>;
}

impl Vector for f64 {
    #[inline]
    fn dot(&self, other: &Self) -> f64 {
        self * other
    }

    #[inline]
    fn beyond(&self, length: f64) -> Option<(Self, f64)> {
        if self.abs() <= length {
            None
        } else {
            Some((self.signum(), 0.0))
        }
    }
}

impl Vector for Vec3 {
    #[inline]
    fn dot(&self, other: &Self) -> f64 {
        Self::dot(self, other)
    }

    #[inline]
    fn beyond(&self, length: f64) -> Option<(Self, f64)> {
        let squared = self.norm_squared();
        if squared <= length * length {
            None
        } else {
            let inverse = 1.0 / squared.sqrt();
            Some((self * inverse, inverse))
        }
    }
}

/// The norm `H` of an element: it slips where the norm of what spring and damper give is more than
/// the cap.
pub trait Limit<X>: Copy + Default {
    /// Whether the element sticks.
    fn holds(&self, y: &X, cap: f64) -> bool;

    /// What becomes of the force `y` of spring and damper.
    fn bear(&self, y: X, cap: f64) -> Borne<X>;
}

/// What an element makes of the force of its spring and damper.
#[derive(Clone, Copy, Debug)]
pub struct Borne<X> {
    /// The force.
    pub force: X,
    /// What is left of that of spring and damper.
    pub left: X,
    /// That as a share.
    pub share: f64,
    /// Unit vector along it; zero while the element sticks.
    pub slip: X,
    /// Derivative of the force with the cap; zero while the element sticks.
    pub growth: X,
}

/// The length of a vector.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radial;

impl<X: Vector> Limit<X> for Radial {
    #[inline]
    fn holds(&self, y: &X, cap: f64) -> bool {
        y.dot(y) <= cap * cap
    }

    #[inline]
    fn bear(&self, y: X, cap: f64) -> Borne<X> {
        match y.beyond(cap) {
            None => Borne {
                force: y,
                left: y,
                share: 1.0,
                slip: X::default(),
                growth: X::default(),
            },
            Some((slip, inverse)) => Borne {
                force: slip * cap,
                left: slip * cap,
                share: cap * inverse,
                slip,
                growth: slip,
            },
        }
    }
}

/// The norm of a face with an even pressure, for a force along it and a moment about its normal
/// over the mean distance `ρ`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// The unit normal `n̂`.
    normal: Vec3,
    /// `C`; zero for a point.
    spread: Mat3,
}

/// `H²`, with `½ ∇H²` and what its derivative needs.
struct Square {
    value: f64,
    half_gradient: Vec3,
    D: f64,
    /// `½ ∇D`.
    half_of_D: Vec3,
    /// `w_n`.
    along: f64,
    Cw: Vec3,
    /// `wᵀ C w`.
    Q: f64,
}

impl Face {
    /// The norm for a load about the normal `normal`, from sums over its points.
    ///
    /// - `whole`: `Σ |r|²`; `turned`: `Σ (x² − y²)` and `Σ 2 x y`, where `x` and `y` are the
    ///   components of `r` along two unit vectors `first` and `normal × first` across the normal
    pub fn new(normal: &Vec3, first: &Vec3, (whole, turned): (f64, [f64; 2])) -> Self {
        let normal = *normal;
        if whole <= 0.0 {
            return Self {
                normal,
                spread: Mat3::zeros(),
            };
        }
        let second = normal.cross(first);
        let [a, b] = turned.map(|x| x / whole);
        // `n̂ × r` is `r`, turned by a right angle.
        let spread = first * first.transpose() * (1.0 - a)
            + second * second.transpose() * (1.0 + a)
            - (first * second.transpose() + second * first.transpose()) * b;
        let [line, round] = EVEN_SPREAD;
        let share = line + (round - line) * (1.0 - a * a - b * b).max(0.0);
        Self {
            normal,
            spread: spread * (0.5 * share),
        }
    }

    /// Whether it is that of a point, whose norm is the length.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.spread.trace() <= 0.0
    }

    #[inline]
    fn square(&self, w: &Vec3) -> Square {
        let n = &self.normal;
        let (S, along, Cw) = (w.norm_squared(), n.dot(w), self.spread * w);
        let (N, Q) = (along * along, w.dot(&Cw));
        // `C` has no more than `κ` along any direction.
        let least = (1.0 - EVEN_SPREAD[1]) * S * S;
        let D = (S * S - 4.0 * N * Q).max(least).sqrt();
        let half_of_D = (w * S - Cw * (2.0 * N) - n * (2.0 * Q * along)) / D;
        Square {
            value: 0.5 * (S + D),
            half_gradient: (w + half_of_D) * 0.5,
            D,
            half_of_D,
            along,
            Cw,
            Q,
        }
    }

    /// `uᵀ K u` of [`Self::slope`].
    #[inline]
    pub fn curvature(&self, left: &Vec3, growth: &Vec3, u: &Vec3) -> f64 {
        if self.is_point() {
            let along = growth.dot(u);
            return u.norm_squared() - along * along;
        }
        u.dot(&(self.slope(left, growth) * u))
    }

    /// Derivative of the force with that of spring and damper where that leaves `left`, as a share:
    /// symmetric, `½ ∇²H²` while the element sticks.
    ///
    /// - `growth`: see [`Borne`]
    pub fn slope(&self, left: &Vec3, growth: &Vec3) -> Mat3 {
        let slipped = growth * growth.transpose();
        let Some(w) = left.try_normalize(0.0).filter(|_| !self.is_point()) else {
            return Mat3::identity() - slipped;
        };
        let (n, at) = (&self.normal, self.square(&w));
        // `½ ∇²D²/2 = ∇(D ∇D)/2`.
        let nCw = n * at.Cw.transpose();
        let halves = Mat3::identity() + w * w.transpose() * 2.0
            - self.spread * (2.0 * at.along * at.along)
            - (nCw + nCw.transpose()) * (4.0 * at.along)
            - n * n.transpose() * (2.0 * at.Q);
        let of_D = (halves - at.half_of_D * at.half_of_D.transpose() * 2.0) / at.D;
        (Mat3::identity() + of_D) * 0.5 - slipped
    }
}

impl Limit<Vec3> for Face {
    #[inline]
    fn holds(&self, y: &Vec3, cap: f64) -> bool {
        // No norm is more than the length.
        y.norm_squared() <= cap * cap || self.square(y).value <= cap * cap
    }

    #[inline]
    fn bear(&self, y: Vec3, cap: f64) -> Borne<Vec3> {
        let squared = y.norm_squared();
        // Too short to have a fourth power, or not a number.
        if self.is_point() || squared * squared <= 0.0 || squared.is_nan() {
            return Radial.bear(y, cap);
        }
        let at = self.square(&y);
        if at.value <= cap * cap {
            return Borne {
                force: at.half_gradient,
                left: y,
                share: 1.0,
                slip: Vec3::zeros(),
                growth: Vec3::zeros(),
            };
        }
        let inverse = 1.0 / at.value.sqrt();
        let (growth, share) = (at.half_gradient * inverse, cap * inverse);
        Borne {
            force: growth * cap,
            left: y * share,
            share,
            slip: y / squared.sqrt(),
            growth,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::ElastoPlastic;
    use crate::spatial::across;
    use crate::testing::Random;

    /// Points of an even pressure on a rectangle with these half lengths, or on the ellipse in it,
    /// and their mean distance from the middle.
    fn area(half: [f64; 2], oval: bool) -> (Vec<[f64; 2]>, f64) {
        let count = 80;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(count) * 2.0 - 1.0;
        let cells = (0..count).flat_map(|i| (0..count).map(move |j| [at(i), at(j)]));
        let inside = cells.filter(|[x, y]| !oval || x * x + y * y < 1.0);
        let points: Vec<_> = inside.map(|[x, y]| [x * half[0], y * half[1]]).collect();
        let mean = points.iter().map(|[x, y]| x.hypot(*y)).sum::<f64>();
        let all: f64 = points.iter().map(|_| 1.0).sum();
        (points, mean / all)
    }

    /// The limit of such points about z.
    fn face(points: &[[f64; 2]]) -> Face {
        let (mut whole, mut turned) = (0.0, [0.0; 2]);
        for [x, y] in points {
            whole += x * x + y * y;
            turned[0] += x * x - y * y;
            turned[1] += 2.0 * x * y;
        }
        Face::new(&Vec3::z(), &Vec3::x(), (whole, turned))
    }

    /// A face of any shape and direction.
    fn any_face(random: &mut Random) -> Face {
        let normal = random.unit();
        let angle = random.uniform(0.0, 7.0);
        let long = random.uniform(0.0, 1.0);
        let (sin, cos) = libm::sincos(angle);
        Face::new(&normal, &across(&normal), (1.0, [long * cos, long * sin]))
    }

    /// `H` and `∇H`.
    fn norm(face: &Face, w: &Vec3) -> (f64, Vec3) {
        let cap = 1e-3 * w.norm();
        let found = face.bear(*w, cap);
        (cap / found.share, found.growth)
    }

    /// Against sums of Coulomb friction over the area: what a face dissipates, and the force along
    /// it, in shares of the cap, in eight directions with all ratios of sliding and spinning. With
    /// the length for both the force on a disc is off by 0.15, on a square by 0.17 and on a board
    /// of 4:1 by 0.34.
    #[test]
    fn a_face_resists_as_its_points_do_together() {
        for (half, oval, most) in [
            ([1.0, 1.0], true, [0.008, 0.037]),
            ([1.0, 1.0], false, [0.011, 0.041]),
            ([2.0, 1.0], false, [0.024, 0.107]),
            ([4.0, 1.0], false, [0.036, 0.146]),
            ([4.0, 1e-3], false, [0.051, 0.19]),
        ] {
            let (points, radius) = area(half, oval);
            let face = face(&points);
            let all: f64 = points.iter().map(|_| 1.0).sum();
            let mut worst = [0.0_f64; 2];
            for way in 0..8 {
                for ratio in 1..16 {
                    let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_8 * f64::from(way));
                    let (spin, slide) = libm::sincos(0.1 * f64::from(ratio));
                    let w = Vec3::new(slide * cos, slide * sin, spin);
                    let (mut sum, mut force) = (0.0, [0.0; 2]);
                    for [x, y] in &points {
                        let v = [w.x - spin * y / radius, w.y + spin * x / radius];
                        let speed = v[0].hypot(v[1]);
                        sum += speed / all;
                        force = [0, 1].map(|i| force[i] + v[i] / speed / all);
                    }
                    let (H, gradient) = norm(&face, &w);
                    let apart = (gradient.x - force[0]).hypot(gradient.y - force[1]);
                    worst[0] = worst[0].max((H / sum - 1.0).abs());
                    worst[1] = worst[1].max(apart);
                }
            }
            assert!(
                worst[0] < most[0] && worst[1] < most[1],
                "{half:?}: {worst:?}"
            );
        }
    }

    /// Where it slips the force is on the surface of the set, `f·ŵ = F̄ H(ŵ)`, and as it is the
    /// gradient of a norm no other force of the set does more; its derivatives are those of central
    /// differences, while it sticks, too.
    #[test]
    fn a_face_slips_along_the_normal_of_the_forces_that_it_bears() {
        let mut random = Random(31);
        let (mut slips, mut sticks) = (0, 0);
        for _ in 0..4000 {
            let face = any_face(&mut random);
            let cap = random.uniform(0.5, 2.0);
            let size = libm::pow(10.0, random.uniform(-0.5, 0.5));
            let y = random.unit() * (cap * size);
            let found = face.bear(y, cap);
            let (H, _) = norm(&face, &y);
            assert_eq!(face.holds(&y, cap), H <= cap);
            let most = |w: &Vec3| cap * norm(&face, w).0;
            for _ in 0..20 {
                let w = random.unit();
                assert!(found.force.dot(&w) < most(&w) * (1.0 + 1e-12));
            }
            if H > cap {
                slips += 1;
                let gain = found.force.dot(&found.slip);
                assert!((gain - most(&found.slip)).abs() < 1e-12 * cap);
                assert!((norm(&face, &found.left).0 - cap).abs() < 1e-12 * cap);
            } else {
                sticks += 1;
                assert!((found.left - y).norm() <= 0.0);
            }
            let by = 1e-5 * cap;
            if (H - cap).abs() < 3.0 * by {
                continue;
            }
            let along = random.unit();
            let difference = |a: Borne<Vec3>, b: Borne<Vec3>| (a.force - b.force) / (2.0 * by);
            let [ahead, behind] = [by, -by].map(|by| face.bear(y + along * by, cap));
            let expected = face.slope(&found.left, &found.growth) * along * found.share;
            let found_by = difference(ahead, behind);
            assert!((found_by - expected).norm() < 1e-7, "{found_by} {expected}");
            let [ahead, behind] = [by, -by].map(|by| face.bear(y, cap + by));
            assert!((difference(ahead, behind) - found.growth).norm() < 1e-7);
        }
        assert!(slips > 1000 && sticks > 1000, "{slips} {sticks}");
    }

    /// As for [`crate::law::friction`]: `h F·u ≥ Δ(½ k H²(ς))`.
    #[test]
    fn a_face_gives_back_no_more_than_it_was_paid() {
        let mut random = Random(32);
        for _ in 0..20_000 {
            let h = libm::pow(10.0, random.uniform(-7.0, -1.0));
            let u = random.unit() * libm::pow(10.0, random.uniform(-5.0, 1.0));
            let element = ElastoPlastic {
                cap: 2.0,
                stiffness: 2e4,
                damping: 30.0,
                displacement: random.unit() * random.uniform(0.0, 1.5e-4),
                limit: any_face(&mut random),
            };
            let element = ElastoPlastic {
                displacement: element.clipped(element.displacement),
                ..element
            };
            let paid = h * u.dot(&element.respond(u, h).force);
            let (before, after) = (element.displacement, element.next(u, h));
            let held = |displacement: Vec3| {
                let element = ElastoPlastic {
                    displacement,
                    ..element
                };
                0.5 * element.twice_stored()
            };
            let more = held(after) - held(before);
            assert!(more <= paid + 1e-16, "{h} {u} {before}: {more} {paid}");
        }
    }

    /// Of a point, and of what only slides or only spins.
    #[test]
    fn without_a_face_or_a_spin_the_norm_is_the_length() {
        let mut random = Random(33);
        for _ in 0..500 {
            let face = any_face(&mut random);
            let way = random.unit();
            let along = (way - face.normal * face.normal.dot(&way)).normalize();
            let point = Face::new(&face.normal, &across(&face.normal), (0.0, [0.0; 2]));
            for (limit, y) in [
                (face, along * 3.0),
                (face, face.normal * 3.0),
                (point, way * 3.0),
            ] {
                let found = limit.bear(y, 1.0);
                let unit = y.normalize();
                assert!((found.force - unit).norm() < 1e-12);
                assert!((found.slip - unit).norm() < 1e-12);
            }
        }
    }
}
