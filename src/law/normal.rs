//! The Hunt–Crossley law of contacts in the normal direction and of joint limits.
//!
//! With the gap `g` at the start of a step of `h` seconds (negative in contact) and the velocity
//! `v` at its end, positive apart, the penetration at the end is `x = −g − h v`, and the force `F =
//! k x₊ (1 − d v)₊`: it falls with `v`. What is deep leaves by a softer law, see [`Damping`].
//!
//! Source: Hunt & Crossley 1975.

use super::Damping;
use crate::tuning::{
    LEAST_NUMBER, RESTITUTION_ACCURACY, RESTITUTION_STEP, RESTITUTION_STEPS, RESTITUTION_TRIALS,
    STIFFEST,
};

/// A spring that only pushes, with damping proportional to its force.
#[derive(Clone, Copy, Debug, Default)]
pub struct HuntCrossley {
    /// Stiffness `k`, N/m or N·m/rad.
    pub stiffness: f64,
    /// Its damping.
    pub damping: Damping,
}

impl HuntCrossley {
    /// Impulse for the velocity `v` at the end of a step of `h` seconds, N·s or N·m·s, and minus
    /// its derivative with the velocity, kg or kg·m².
    #[inline]
    pub fn respond(&self, gap: f64, v: f64, h: f64) -> (f64, f64) {
        let elastic = self.stiffness * (-gap - h * v);
        if elastic <= 0.0 {
            return (0.0, 0.0);
        }
        let (factor, change) = self.damping.factor(-v);
        let stiffness = h * self.stiffness * factor + change * elastic;
        (h * elastic * factor, h * stiffness)
    }

    /// Force at the start of the step, N or N·m.
    #[inline]
    pub fn force(&self, gap: f64, v: f64) -> f64 {
        self.stiffness * (-gap).max(0.0) * self.damping.factor(-v).0
    }

    /// Energy that the spring holds at a gap, J.
    #[inline]
    pub fn stored(&self, gap: f64) -> f64 {
        0.5 * self.stiffness * gap.min(0.0) * gap.min(0.0)
    }
}

/// A spring that stiffens with its depth `δ`: `N = K δ (1 + (δ/δ₁)³)`, up to [`STIFFEST`] times
/// `δ₁`, from where its slope stays.
///
/// Its stiffness is made for the weight of one tree of bodies. Under a load that is a million times
/// as large a linear spring would let one body pass through the other; this one gives way by some
/// thirty `δ₁`, and by 75 `δ₁` under ten million times its weight. More stiffness beyond would
/// only be hard to solve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stiffening {
    /// Stiffness `K` at small depths, N/m.
    pub stiffness: f64,
    /// Depth `δ₁` at which the force is twice that of a linear spring, m.
    pub reference: f64,
}

impl Stiffening {
    /// The spring that gives way by half of `penetration`, m, under `weight`, N. With `δ₁` the
    /// penetration, `K (δ₁/2) (1 + 1/8) = W`.
    pub fn new(weight: f64, penetration: f64) -> Self {
        Self {
            stiffness: weight / (0.5625 * penetration),
            reference: penetration,
        }
    }

    /// The spring that is as deep under `weight`, N, as a linear one of `stiffness`, N/m.
    pub fn with_stiffness(stiffness: f64, weight: f64) -> Self {
        // With `W/k = δ₁/2`, as in `new`.
        Self {
            stiffness: stiffness / 1.125,
            reference: 2.0 * weight / stiffness,
        }
    }

    /// The part of it that carries a share of the weight, as deep.
    #[must_use]
    pub fn part(&self, share: f64) -> Self {
        Self {
            stiffness: self.stiffness * share,
            ..*self
        }
    }

    /// `(δ/δ₁)³`.
    #[inline]
    fn excess(&self, depth: f64) -> f64 {
        let x = depth / self.reference;
        x * x * x
    }

    /// The part of a depth up to which it stiffens, and the rest, m; none of a negative one.
    #[inline]
    fn parts(&self, depth: f64) -> (f64, f64) {
        let stiffening = depth.clamp(0.0, STIFFEST * self.reference);
        (stiffening, depth.max(0.0) - stiffening)
    }

    /// Force at a depth, N; 0 where it is negative.
    #[inline]
    pub fn force(&self, depth: f64) -> f64 {
        let (depth, rest) = self.parts(depth);
        let excess = self.excess(depth);
        self.stiffness * (depth * (1.0 + excess) + rest * (1.0 + 4.0 * excess))
    }

    /// Derivative of the force with the depth, N/m; `K` where the depth is negative.
    #[inline]
    pub fn slope(&self, depth: f64) -> f64 {
        let (depth, _) = self.parts(depth);
        self.stiffness * (1.0 + 4.0 * self.excess(depth))
    }

    /// Force at a depth, in weights that the spring is made for.
    pub fn weights(&self, depth: f64) -> f64 {
        // With `K = W/(9/16 δ₁)`, see `new`.
        self.force(depth) / (0.5625 * self.stiffness * self.reference)
    }

    /// Energy that it holds at a depth, J.
    #[inline]
    pub fn stored(&self, depth: f64) -> f64 {
        let (depth, rest) = self.parts(depth);
        let excess = self.excess(depth);
        let soft = depth * depth * (0.5 + 0.2 * excess);
        let stiff = rest * (depth * (1.0 + excess) + 0.5 * rest * (1.0 + 4.0 * excess));
        self.stiffness * (soft + stiff)
    }
}

/// A body of `mass` that comes down on a spring under gravity.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Spring of the contact.
    pub spring: Stiffening,
    /// kg
    pub mass: f64,
    /// Acceleration towards the contact without it, m/s².
    pub gravity: f64,
    /// Approach speed, m/s, positive.
    pub speed: f64,
}

impl Impact {
    /// What a spring feels of it that is deeper by `weights` times the way of the body, and pushes
    /// it with `weights` times its force `F`: with the depth `δ = w y`,
    /// `(m/w²) δ'' = (m/w²) (w g) − F`.
    #[must_use]
    pub fn felt(&self, weights: f64) -> Self {
        Self {
            mass: self.mass / (weights * weights),
            gravity: self.gravity * weights,
            speed: self.speed * weights,
            ..*self
        }
    }

    /// Hunt–Crossley dissipation, s/m, with which the body lifts off at `e` times the speed of its
    /// approach; `number` is the [`dissipation_number`] of `e`.
    ///
    /// Without gravity the number over the speed is exact, whatever the spring. The weight pushes
    /// deeper, so that more is lost. With the depth `δ` and times `T = √(m/K)`, in units of `v₀ T`
    /// and `T`, the body moves by
    ///
    /// ```text
    /// x'' = γ − x (1 + κ x³) (1 + a x')₊,    x(0) = 0, x'(0) = 1
    /// ```
    ///
    /// with `γ = g T/v₀`, `κ = (v₀ T/δ₁)³` and `a = D v₀`. The speed at which it leaves falls with
    /// `a`: from 1 at `a = 0` (energy is kept) to below `e` at the number. The root is found by
    /// regula falsi (the Illinois form). Never 0, which would stand for a contact that does not
    /// bounce, see [`LEAST_NUMBER`].
    pub fn dissipation(&self, e: f64, number: f64) -> f64 {
        let (mut low, mut high) = ((0.0, 1.0 - e), (number, self.leaving(number) - e));
        if high.1 >= 0.0 {
            return number / self.speed;
        }
        let mut root = number;
        for _ in 0..RESTITUTION_TRIALS {
            root = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let excess = self.leaving(root) - e;
            if excess.abs() < RESTITUTION_ACCURACY * e {
                break;
            }
            if excess > 0.0 {
                low = (root, excess);
                high.1 *= 0.5;
            } else {
                high = (root, excess);
                low.1 *= 0.5;
            }
        }
        root.max(LEAST_NUMBER) / self.speed
    }

    /// Time scale of the impact, s: `√(m/K)` of a light one; one that is deep enough for the spring
    /// to stiffen is shorter by `(1 + 2κ/5)^(1/5)`, as its depth is: where the spring has taken up
    /// the kinetic energy, `x²/2 + κ x⁵/5 = 1/2`.
    pub fn duration(&self) -> f64 {
        let time = (self.mass / self.spring.stiffness).sqrt();
        time / libm::pow(1.0 + 0.4 * self.hardness(time), 0.2)
    }

    /// `κ`, for the time scale `T` of a light impact.
    fn hardness(&self, time: f64) -> f64 {
        self.spring.excess(self.speed * time)
    }

    /// Speed at which it leaves over that of its approach, for a dissipation number `a`; 0 if it
    /// stays.
    fn leaving(&self, a: f64) -> f64 {
        let time = (self.mass / self.spring.stiffness).sqrt();
        let gamma = self.gravity.max(0.0) * time / self.speed;
        let kappa = self.hardness(time);
        let rate = |x: f64, v: f64| {
            gamma - x.max(0.0) * (1.0 + kappa * x * x * x) * (1.0 + a * v).max(0.0)
        };
        let dt = RESTITUTION_STEP * self.duration() / time;
        let (mut x, mut v) = (0.0_f64, 1.0_f64);
        for _ in 0..RESTITUTION_STEPS {
            let a1 = rate(x, v);
            let (v2, a2) = (v + 0.5 * dt * a1, rate(x + 0.5 * dt * v, v + 0.5 * dt * a1));
            let (v3, a3) = (
                v + 0.5 * dt * a2,
                rate(x + 0.5 * dt * v2, v + 0.5 * dt * a2),
            );
            let (v4, a4) = (v + dt * a3, rate(x + dt * v3, v + dt * a3));
            let next = x + dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
            let speed = v + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            if next <= 0.0 {
                let share = x / (x - next);
                return -(v + share * (speed - v));
            }
            // It turns down again inside: it stays.
            if v < 0.0 && speed >= 0.0 {
                return 0.0;
            }
            (x, v) = (next, speed);
        }
        0.0
    }
}

/// Hunt–Crossley dissipation times approach speed that gives the coefficient of restitution `e`:
/// the root of `a − ln(1+a) = −e a − ln(1−e a)`; independent of mass and stiffness. Infinite for `e
/// = 0`, and never less than [`LEAST_NUMBER`].
pub fn dissipation_number(e: f64) -> f64 {
    if e <= 0.0 {
        return f64::INFINITY;
    }
    let excess = |a: f64| a - libm::log1p(a) + e * a + libm::log1p(-e * a);
    // Positive near 0 for e < 1, minus infinity at 1/e.
    let (mut low, mut high) = (0.0, 1.0 / e);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).max(LEAST_NUMBER)
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Values of the design's table, computed there by an independent root finder.
    #[test]
    fn dissipation_number_matches_the_exact_hunt_crossley_relation() {
        for (e, a) in [
            (0.95, 0.0789),
            (0.9, 0.1665),
            (0.5, 1.4328),
            (0.2, 4.9192),
            (0.05, 20.0),
        ] {
            assert!((dissipation_number(e) - a).abs() < 1e-3 * a, "{e}");
        }
    }

    /// The definition of the coefficient of restitution, against Heun's method in ten thousandths
    /// of the impact's time.
    #[test]
    fn a_body_that_its_weight_pushes_in_leaves_at_its_restitution() {
        let (mass, gravity) = (2.0, 9.81);
        for (e, speed, stiffness) in [
            (0.9, 0.1, 1e5),
            (0.7, 0.05, 1e5),
            (0.5, 0.2, 1e4),
            (0.5, 5.0, 1e6),
            (0.2, 1.0, 1e5),
        ] {
            let spring = Stiffening::with_stiffness(stiffness, mass * gravity);
            let impact = Impact {
                spring,
                mass,
                gravity,
                speed,
            };
            let d = impact.dissipation(e, dissipation_number(e));
            let rate = |x: f64, v: f64| gravity - spring.force(x) * (1.0 + d * v).max(0.0) / mass;
            let dt = 1e-4 * impact.duration();
            let (mut x, mut v) = (0.0_f64, speed);
            while x >= 0.0 {
                let a = rate(x, v);
                let (there, then) = (x + dt * v, v + dt * a);
                x += 0.5 * dt * (v + then);
                v += 0.5 * dt * (a + rate(there, then));
            }
            let error = (-v / speed - e).abs() / e;
            assert!(error < 1e-3, "{e} at {speed} m/s: off by {error}");
        }
    }
}
