//! Where dry friction slips: the forces that it can bear are a convex set, and what spring and
//! damper give beyond it is cut down to the nearest force of the set.
//!
//! Of a point, and about an axis, the set is a ball. A face with an even pressure resists sliding
//! and turning at once: each of its points slides in its own direction, so that a face which spins
//! fast hardly resists sliding, and one that slides fast hardly resists turning. With the velocity
//! `w = w_t + w_n n̂`, where `w_n` is the angular velocity times the mean distance `ρ` of the points
//! from their middle, friction of the cap `F̄` dissipates
//!
//! ```text
//! F̄ H(w),    H = mean |w_t + w_n n̂ × r/ρ|
//! ```
//!
//! which is convex, and the forces that it can bear are those with `f·w ≤ F̄ H(w)` for every `w`.
//! With `H = |w|` they are a ball (Howe & Cutkosky 1996), whose friction against a disc that spins
//! fast is 1.5 times as high as it should be. The mean is taken here as that of two halves: at the
//! points `±p` it would be `½ Σ |w_t ± w_n n̂ × p|`, and with `|w_t ± w_n c|² = |w|² ± 2 w_n c·w_t`
//! for `c` of unit length, with the root mean square of `c·w_t` over the face in its place,
//!
//! ```text
//! H = ½ (√(S + 2 X) + √(S − 2 X)) = √((S + √(S² − 4 X²))/2),    S = |w|²,  X² = w_n² wᵀ C w,
//! C = κ Σ (n̂ × r)(n̂ × r)ᵀ/Σ |r|²
//! ```
//!
//! `H` is a convex function that rises with the seminorms `√(wᵀ C w)`, `|w_n|` and the rest of
//! `|w|`, so it is convex; with `κ < 1` it is smooth. `κ` is [`EVEN_SPREAD`]. Against the mean over
//! the area `H` is right to 1.1 % for a disc, 1.4 % for a square, 4 % for a board of 4:1.
//!
//! The nearest force `f` to `y` is that where `y − f = t ŵ` with `f = F̄ ∇H(ŵ)` and `t ≥ 0`; `y` is
//! in the set where `t` is negative. Newton's method for the direction `ŵ`, where `t = (y − f)·ŵ`:
//!
//! ```text
//! (F̄ ∇²H + t 1) δ = y − f − t ŵ,    δ ⊥ ŵ
//! ```
//!
//! Source: Goyal, Ruina & Papadopoulos 1991 (limit surfaces); the values above by sums over areas.

#![allow(non_snake_case, reason = "the letters of the derivation above")]

use super::friction::Vector;
use crate::spatial::{Mat3, Vec3, across};
use crate::tuning::{EVEN_SPREAD, MOST_TURNS, TURNED};

/// The set of forces that friction can bear, for a cap of 1.
pub trait Limit<X>: Copy + Default {
    /// What is left of the force `y` where it is not in the set for a cap; none where it is.
    fn cut(&self, y: X, cap: f64) -> Option<Cut<X>>;
}

/// The nearest force that friction can bear to another one.
#[derive(Clone, Copy, Debug)]
pub struct Cut<X> {
    /// That force.
    pub force: X,
    /// Unit vector from it to the other one: the direction of the slip.
    pub slip: X,
    /// Its derivative with the other one, in every direction but that of the slip.
    pub slope: f64,
    /// What the derivative is more: `slope (1 − ŝŝᵀ) + ridge ridgeᵀ`.
    pub ridge: X,
    /// Its derivative with the cap.
    pub growth: X,
}

/// The forces that are no longer than the cap.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radial;

impl<X: Vector> Limit<X> for Radial {
    #[inline]
    fn cut(&self, y: X, cap: f64) -> Option<Cut<X>> {
        let (slip, inverse) = y.beyond(cap)?;
        Some(Cut {
            force: slip * cap,
            slip,
            slope: cap * inverse,
            ridge: X::default(),
            growth: slip,
        })
    }
}

/// The forces along a face, and the moments about its normal over the mean distance of the load
/// from its middle, that the friction of an even pressure can bear.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// The unit normal `n̂`.
    pub normal: Vec3,
    /// `C`; zero for a point.
    spread: Mat3,
}

/// `H` for a unit vector, with its derivatives.
struct Dissipation {
    value: f64,
    gradient: Vec3,
    /// `∇²H` along two directions across the vector: 11, 12, 22.
    bends: [f64; 3],
}

impl Face {
    /// Square of the shortest force on the surface of the set, for a cap of 1: no force that is
    /// shorter slips. `H² ≥ (1 + √(1 − κ))/2`.
    const INNER: f64 = 0.723_606_797;

    /// The limit of a load with the normal `normal`, from sums over its points.
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
        Self {
            normal,
            spread: spread * (0.5 * EVEN_SPREAD),
        }
    }

    /// Whether it is that of a point.
    #[inline]
    fn is_point(&self) -> bool {
        self.spread.trace() <= 0.0
    }

    /// - `across`: two unit vectors across the unit vector `w` and each other
    #[inline]
    fn dissipation(&self, w: &Vec3, across: &[Vec3; 2]) -> Dissipation {
        let n = &self.normal;
        let (along, Cw) = (n.dot(w), self.spread * w);
        let (N, Q) = (along * along, w.dot(&Cw));
        let D = (1.0 - 4.0 * N * Q).max(1.0 - EVEN_SPREAD).sqrt();
        let value = (0.5 * (1.0 + D)).sqrt();
        // Half of the gradient of `D²`.
        let half = w * 2.0 - Cw * (4.0 * N) - n * (4.0 * Q * along);
        let of_D = half / D;
        let gradient = (w * 2.0 + of_D) / (4.0 * value);
        let bend = |x: &Vec3, y: &Vec3| {
            let (nx, ny) = (n.dot(x), n.dot(y));
            let one = x.dot(y);
            // Half of the second derivative of `D²`; `x` and `y` are across `w`.
            let halves = 2.0 * one
                - 4.0 * N * x.dot(&(self.spread * y))
                - 8.0 * along * (Cw.dot(x) * ny + Cw.dot(y) * nx)
                - 4.0 * Q * nx * ny;
            let second = (halves - of_D.dot(x) * of_D.dot(y)) / D;
            (0.5 * one + 0.25 * second - gradient.dot(x) * gradient.dot(y)) / value
        };
        let [first, second] = across;
        Dissipation {
            value,
            gradient,
            bends: [
                bend(first, first),
                bend(first, second),
                bend(second, second),
            ],
        }
    }

    /// The cut in the direction `slip` that has been found.
    fn cut_along(
        (slip, axes): (Vec3, &[Vec3; 2]),
        H: &Dissipation,
        (distance, cap): (f64, f64),
    ) -> Cut<Vec3> {
        // The derivative across the slip is `M (M + t 1)⁻¹` with `M = F̄ ∇²H`, which has the same
        // axes as `M`.
        let [a, b, c] = H.bends.map(|x| x * cap);
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let apart = (half * half + b * b).sqrt();
        let share = |x: f64| x.max(0.0) / (x.max(0.0) + distance);
        let [high, slope] = [mean + apart, mean - apart].map(share);
        // Twice the angle from the first axis to that of the higher one has the tangent `b/half`.
        let (cos, sin) = if half >= 0.0 {
            (half + apart, b)
        } else {
            (b, apart - half)
        };
        let long = axes[0] * cos + axes[1] * sin;
        let ridge = long.try_normalize(0.0).unwrap_or_default();
        let flat = H.gradient - slip * H.value;
        let excess = (high - slope).max(0.0);
        Cut {
            force: H.gradient * cap,
            slip,
            slope,
            ridge: ridge * excess.sqrt(),
            growth: H.gradient - flat * slope - ridge * (excess * ridge.dot(&flat)),
        }
    }
}

impl Limit<Vec3> for Face {
    #[inline]
    fn cut(&self, y: Vec3, cap: f64) -> Option<Cut<Vec3>> {
        if self.is_point() {
            return Radial.cut(y, cap);
        }
        if y.norm_squared() <= Self::INNER * cap * cap {
            return None;
        }
        let mut slip = y.normalize();
        for last in (0..MOST_TURNS).rev() {
            let first = across(&slip);
            let axes = [first, slip.cross(&first)];
            let mut H = self.dissipation(&slip, &axes);
            let rest = y - H.gradient * cap;
            let distance = rest.dot(&slip);
            let [x, z] = [rest.dot(&axes[0]), rest.dot(&axes[1])];
            let [a, b, c] = H.bends.map(|bend| bend * cap);
            let (right, above) = (a + distance, c + distance);
            let whole = right * above - b * b;
            let [x, z] = [(above * x - b * z) / whole, (right * z - b * x) / whole];
            let turn = axes[0] * x + axes[1] * z;
            let square = turn.norm_squared();
            // The error of the next direction is the square of this turn.
            if square > TURNED && last > 0 {
                slip = (slip + turn).normalize();
                continue;
            }
            if distance.is_nan() || distance <= 0.0 {
                return None;
            }
            let [a, b, c] = H.bends;
            H.gradient += axes[0] * (a * x + b * z) + axes[1] * (b * x + c * z);
            slip = (slip + turn).normalize();
            return Some(Self::cut_along((slip, &axes), &H, (distance, cap)));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::ElastoPlastic;
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

    fn dissipation(face: &Face, w: &Vec3) -> f64 {
        let unit = w.normalize();
        let first = across(&unit);
        let H = face.dissipation(&unit, &[first, unit.cross(&first)]);
        H.value * w.norm()
    }

    /// Against sums of Coulomb friction over the area: what a face dissipates, and the force along
    /// it, in shares of the cap, in eight directions with all ratios of sliding and spinning. With
    /// one ball for both the force on a disc is off by 0.15, on a square by 0.17 and on a board of
    /// 4:1 by 0.34.
    #[test]
    fn a_face_resists_as_its_points_do_together() {
        for (half, oval, most) in [
            ([1.0, 1.0], true, [0.012, 0.042]),
            ([1.0, 1.0], false, [0.015, 0.05]),
            ([2.0, 1.0], false, [0.025, 0.11]),
            ([4.0, 1.0], false, [0.042, 0.19]),
            ([4.0, 1e-3], false, [0.06, 0.26]),
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
                    let first = across(&w);
                    let H = face.dissipation(&w, &[first, w.cross(&first)]);
                    let apart = (H.gradient.x - force[0]).hypot(H.gradient.y - force[1]);
                    worst[0] = worst[0].max((H.value / sum - 1.0).abs());
                    worst[1] = worst[1].max(apart);
                }
            }
            assert!(
                worst[0] < most[0] && worst[1] < most[1],
                "{half:?}: {worst:?}"
            );
        }
    }

    /// The nearest force is on the surface, the rest is along its normal, and its derivatives are
    /// those of central differences; what is not cut is in the set in every direction.
    #[test]
    fn the_nearest_force_is_the_nearest_one() {
        let mut random = Random(31);
        let (mut cut, mut held) = (0, 0);
        for _ in 0..4000 {
            let face = any_face(&mut random);
            let cap = random.uniform(0.5, 2.0);
            let size = libm::pow(10.0, random.uniform(-0.1, 0.5)) * random.uniform(0.8, 1.0);
            let y = random.unit() * (cap * size);
            let limit = |w: &Vec3| cap * dissipation(&face, w);
            let Some(found) = face.cut(y, cap) else {
                held += 1;
                for _ in 0..50 {
                    let w = random.unit();
                    assert!(y.dot(&w) < limit(&w) * (1.0 + 1e-12));
                }
                continue;
            };
            cut += 1;
            let rest = y - found.force;
            let bound = 1e-11 * y.norm();
            assert!((rest - found.slip * rest.norm()).norm() < bound);
            assert!((found.force.dot(&found.slip) - limit(&found.slip)).abs() < bound);
            let by = 1e-5 * cap;
            let along = random.unit();
            let moved = |y: Vec3, cap: f64| face.cut(y, cap).map(|c| c.force);
            // Not where the difference reaches into the set.
            if rest.norm() < 10.0 * by {
                continue;
            }
            let difference = |ahead: Option<Vec3>, behind: Option<Vec3>| {
                (ahead.unwrap_or(y) - behind.unwrap_or(y)) / (2.0 * by)
            };
            let expected = found.slope * (along - found.slip * found.slip.dot(&along))
                + found.ridge * found.ridge.dot(&along);
            let by_force = difference(moved(y + along * by, cap), moved(y - along * by, cap));
            assert!((by_force - expected).norm() < 1e-5, "{by_force} {expected}");
            let by_cap = difference(moved(y, cap + by), moved(y, cap - by));
            assert!(
                (by_cap - found.growth).norm() < 1e-5,
                "{by_cap} {}",
                found.growth
            );
        }
        assert!(cut > 1000 && held > 300, "{cut} {held}");
    }

    /// As for [`crate::law::friction`]: `h F·u ≥ ½ k Δ|ς|²`.
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
            let more = 0.5 * element.stiffness * (after.norm_squared() - before.norm_squared());
            assert!(more <= paid + 1e-16, "{h} {u} {before}: {more} {paid}");
        }
    }

    /// A point, and what does not spin, has the force of a ball.
    #[test]
    fn without_a_face_or_a_spin_the_limit_is_a_ball() {
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
                let found = limit.cut(y, 1.0).map(|c| (c.force, c.slip));
                let unit = y.normalize();
                let (force, slip) = found.unwrap_or_default();
                assert!((force - unit).norm() < 1e-12 && (slip - unit).norm() < 1e-12);
            }
        }
    }
}
