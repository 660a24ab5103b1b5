//! The contact law: Hunt–Crossley normal force, elasto-plastic Coulomb friction.
//!
//! Both are gradients of convex functions of the velocity at the end of the step, so that a step is a convex
//! minimisation whatever touches what. In the normal direction, with `x = −gap − h vₙ` the penetration at the end,
//! `n = k x₊ (1 − d vₙ)₊`. In the tangent plane a spring–damper with a stored displacement ς carries any load below
//! `μ n` without motion; above it slips: `y = k_t ς + (k_t h + d_t) u`, `F = y` while `|y| ≤ F̄`, else `F̄ y/|y|`.
//! Where friction at rest is higher than sliding friction, `μ` follows the speed at the start of the step (Stribeck):
//! within the step it is constant, which keeps the law convex.
//!
//! Source: Hunt & Crossley 1975; Castro et al. 2022; the friction is the Moreau envelope of Coulomb's dissipation;
//! Armstrong-Hélouvry, Dupont & Canudas de Wit 1994 for the Stribeck curve.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Contact;
use crate::spatial::Vec3;

/// Impulse of a contact on its body and its derivative with the velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// N·s, world axes.
    pub impulse: Vec3,
    /// Normal stiffness, kg: minus the derivative of the normal impulse with the normal velocity.
    pub normal: f64,
    /// Tangential stiffness, kg, in every direction but `slip`.
    pub tangential: f64,
    /// Direction in which friction slips and has no stiffness; zero while it sticks.
    pub slip: Vec3,
}

impl Contact {
    /// Response to the velocity `v` of the contact point at the end of a step of `h` seconds.
    #[inline]
    pub fn response(&self, v: &Vec3, h: f64) -> Response {
        let vn = self.normal.dot(v);
        let (normal_impulse, normal) = self.normal_response(vn, h);
        let mut response = Response {
            impulse: self.normal * normal_impulse,
            normal,
            ..Response::default()
        };
        if self.cap > 0.0 {
            let u = v - self.normal * vn;
            let spring = (self.tangential_stiffness, self.tangential_damping);
            let (force, slope, slip) = slide(&self.displacement, &u, spring, self.cap, h);
            response.impulse -= force * h;
            response.tangential = h * slope;
            response.slip = slip;
        }
        response
    }

    /// Normal impulse, N·s, and its stiffness, kg.
    #[inline]
    fn normal_response(&self, vn: f64, h: f64) -> (f64, f64) {
        let elastic = self.stiffness * (-self.gap - h * vn);
        let damping = 1.0 - self.dissipation * vn;
        if elastic > 0.0 && damping > 0.0 {
            let stiffness = h * self.stiffness * damping + self.dissipation * elastic;
            (h * elastic * damping, h * stiffness)
        } else {
            (0.0, 0.0)
        }
    }

    /// Force on the body at the start of the step, N, for the velocity `v` of the point.
    pub fn force(&self, v: &Vec3) -> Vec3 {
        let vn = self.normal.dot(v);
        let mut force = self.normal * self.normal_force(vn);
        if self.cap > 0.0 {
            let u = v - self.normal * vn;
            let spring = (self.tangential_stiffness, self.tangential_damping);
            force -= slide(&self.displacement, &u, spring, self.cap, 0.0).0;
        }
        force
    }

    /// Normal force at the start of the step, N.
    #[inline]
    pub fn normal_force(&self, vn: f64) -> f64 {
        self.stiffness * (-self.gap).max(0.0) * (1.0 - self.dissipation * vn).max(0.0)
    }

    /// Elastic displacement after the step, for the velocity that solved it.
    #[inline]
    pub fn next_displacement(&self, v: &Vec3, h: f64) -> Vec3 {
        if self.cap <= 0.0 {
            return Vec3::zeros();
        }
        let u = v - self.normal * self.normal.dot(v);
        let (k, d) = (self.tangential_stiffness, self.tangential_damping);
        let (force, _, slip) = slide(&self.displacement, &u, (k, d), self.cap, h);
        let next = stretch(&self.displacement, (force - u * d) / k, &slip, (k, d), h);
        clip(next, self.cap / k)
    }
}

/// Elastic displacement after a step, from that with which spring and damper give the force that the step has found.
///
/// - `slip`: direction of the force where it slips; zero while it sticks
#[inline]
pub(super) fn stretch(
    stored: &Vec3,
    settled: Vec3,
    slip: &Vec3,
    spring: (f64, f64),
    h: f64,
) -> Vec3 {
    let (before, after) = (slip.dot(stored), slip.dot(&settled));
    settled + slip * (stretched(before, after, spring, h) - after)
}

/// Displacement along the slip after a step of `h` seconds in which an elasto-plastic element slips.
///
/// While it slips, spring and damper together could give more than the cap. As the slip slows down, the damper gives less
/// and the spring takes over, `k ς = F̄ − d u`: then the element comes to rest under the load that it carries, and does
/// not spring back. Slip faster than `F̄/d` leaves the spring nothing; what it holds from before goes within its own time
/// `d/k`, not at once: else a slip too short for a step to see would decide on all that comes after, and a velocity that
/// jumps would charge the spring without any work.
///
/// - `stored`: before the step; `settled`: `(F̄ − d u)/k`; both in the direction of the force
/// - `(k, d)`: stiffness and damping
#[inline]
pub(crate) fn stretched(stored: f64, settled: f64, (k, d): (f64, f64), h: f64) -> f64 {
    let share = k * h / (k * h + d);
    settled.max(stored + share * (settled.max(0.0) - stored))
}

/// The elasto-plastic element in a plane: resisting force for the velocity `u` at the end of a step of `h` seconds,
/// its derivative with the velocity in every direction but that of the slip, and that direction; zero while it sticks.
///
/// - `spring`: stiffness and damping
/// - `cap`: force that slips; 0: there is none
#[inline]
pub(super) fn slide(
    displacement: &Vec3,
    u: &Vec3,
    (stiffness, damping): (f64, f64),
    cap: f64,
    h: f64,
) -> (Vec3, f64, Vec3) {
    if cap <= 0.0 {
        return (Vec3::zeros(), 0.0, Vec3::zeros());
    }
    let b = stiffness * h + damping;
    let y = displacement * stiffness + u * b;
    let squared = y.norm_squared();
    if squared <= cap * cap {
        (y, b, Vec3::zeros())
    } else {
        let inverse = 1.0 / squared.sqrt();
        let slip = y * inverse;
        (slip * cap, b * cap * inverse, slip)
    }
}

/// Coulomb coefficient at a sliding speed, m/s: `rest` at none, `sliding` far above the Stribeck speed `reference`,
/// with a smooth fall `exp(−(u/u_s)²)` between.
#[inline]
pub(crate) fn stribeck(rest: f64, sliding: f64, speed: f64, reference: f64) -> f64 {
    let s = speed / reference;
    sliding + (rest - sliding) * libm::exp(-s * s)
}

/// `x`, shortened to `length` where it is longer.
#[inline]
pub(crate) fn clip(x: Vec3, length: f64) -> Vec3 {
    let squared = x.norm_squared();
    if squared > length * length {
        x * (length / squared.sqrt())
    } else {
        x
    }
}

/// Hunt–Crossley dissipation times approach speed that gives the coefficient of restitution `e`: the root of
/// `a − ln(1+a) = −e a − ln(1−e a)`; independent of mass and stiffness. Infinite for `e = 0`.
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
    0.5 * (low + high)
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

    fn contact() -> Contact {
        Contact {
            normal: Vec3::new(0.0, 0.6, 0.8),
            gap: -1e-3,
            stiffness: 1e5,
            dissipation: 3.0,
            mu: 0.5,
            cap: 20.0,
            tangential_stiffness: 8e4,
            tangential_damping: 300.0,
            displacement: Vec3::new(1e-5, 0.0, 0.0),
            ..Contact::default()
        }
    }

    #[test]
    fn response_stiffness_is_minus_the_derivative_of_the_impulse() {
        let (c, h) = (contact(), 1e-3);
        for v in [Vec3::new(0.01, -0.02, 0.01), Vec3::new(0.5, -0.1, -0.2)] {
            let r = c.response(&v, h);
            let G = crate::spatial::Mat3::identity() * r.tangential
                + c.normal * c.normal.transpose() * (r.normal - r.tangential)
                - r.slip * r.slip.transpose() * r.tangential;
            for axis in 0..3 {
                let mut step = Vec3::zeros();
                step[axis] = 1e-7;
                let difference = (c.response(&(v + step), h).impulse
                    - c.response(&(v - step), h).impulse)
                    / 2e-7;
                let expected = -G.column(axis);
                assert!(
                    (difference - expected).norm() < 1e-5 * G.norm(),
                    "{difference} {expected}"
                );
            }
        }
    }

    #[test]
    fn stribecks_curve_runs_from_rest_to_sliding() {
        assert!((stribeck(0.6, 0.4, 0.0, 0.01) - 0.6).abs() < 1e-15);
        // exp(−1) of the difference is left at the reference speed.
        assert!((stribeck(0.6, 0.4, 0.01, 0.01) - (0.4 + 0.2 * (-1.0_f64).exp())).abs() < 1e-15);
        assert!((stribeck(0.6, 0.4, 0.1, 0.01) - 0.4).abs() < 1e-15);
    }

    /// Work of the force on the element over the step, `h F·u`, against what its spring holds more, `½ k Δ|ς|²`. By hand: while
    /// it sticks `ς` moves by `h u`, and the rest is the damper's; while it slips the spring is stretched by no more than
    /// the slip's way, or loses. A cone that has shrunk since takes what it no longer holds.
    #[test]
    fn friction_gives_back_no_more_than_it_was_paid() {
        let mut random = crate::testing::Random(9);
        for _ in 0..10_000 {
            let mut c = contact();
            let h = libm::pow(10.0, random.uniform(-7.0, -1.0));
            let size = libm::pow(10.0, random.uniform(-5.0, 1.0));
            let flat = |x: Vec3| x - c.normal * c.normal.dot(&x);
            let most = c.cap / c.tangential_stiffness;
            let (stored, u) = (flat(random.vector(1.5 * most)), flat(random.vector(size)));
            c.displacement = stored;
            let paid = -flat(c.response(&u, h).impulse).dot(&u);
            let next = c.next_displacement(&u, h);
            let more = 0.5 * c.tangential_stiffness * (next.norm_squared() - stored.norm_squared());
            assert!(
                more <= paid + 1e-12 * c.cap * most,
                "{h} {u} {stored}: {more} {paid}"
            );
        }
    }

    #[test]
    fn friction_never_exceeds_the_cone_and_remembers_no_more_than_it() {
        let (c, h) = (contact(), 1e-2);
        for speed in [0.0, 1e-4, 1e-2, 1.0, 100.0] {
            let v = Vec3::new(speed, 0.0, 0.0);
            let tangential = c.response(&v, h).impulse.x.abs();
            assert!(tangential <= h * c.cap * (1.0 + 1e-12));
            let stored = c.next_displacement(&v, h).norm() * c.tangential_stiffness;
            assert!(stored <= c.cap * (1.0 + 1e-12));
        }
    }
}
