//! Elasto-plastic friction in one, two and three dimensions, and Stribeck's curve.
//!
//! A spring–damper with a stored displacement `ς` carries any load below the cap `F̄` without
//! motion and slips above it. With the relative velocity `u` at the end of a step of `h` seconds:
//!
//! 1. Spring and damper together would give `y = k ς + (k h + d) u`.
//! 2. The force is `F = y` while `|y| ≤ F̄` (the element sticks), else `F̄ ŷ` with `ŷ = y/|y|` (it
//!    slips along `ŷ`). Of a face it is the nearest force to `y` of those that it can bear, see
//!    [`super::face`], and `ŷ` is the direction of the difference.
//! 3. The displacement after the step is `(F − d u)/k`, at which the spring alone gives what the
//!    damper leaves of `F`. Along the slip it may only approach that value, see
//!    `ElastoPlastic::slipped`.
//!
//! Where friction at rest is higher than sliding friction, the cap follows the speed of the slip
//! at the start of the step (Stribeck): within the step it is constant, which keeps the law convex.
//! The slip is what the spring does not take up, `s = |u| − w`. While the element sticks,
//! `w = |u|`: a load that sets in yields by the spring, at any speed, and friction at rest holds
//! it. Once it slips, the spring is stretched at `w = (F̄ − k ς)/d`, which dies within its own time
//! `d/k`.
//!
//! Source: Castro et al. 2022 (the force is the gradient of the Moreau envelope of Coulomb's
//! dissipation); Armstrong-Hélouvry, Dupont & Canudas de Wit 1994 for the Stribeck curve.

use super::face::Face;
use super::limit::{Limit, Radial, Resistance, Vector};
use crate::spatial::Vec3;
use crate::tuning::ROUND_OFF;

/// A spring–damper with a capped force. Units are those of a force (N, or N·m about an axis) and of
/// a displacement (m or rad).
#[derive(Clone, Copy, Debug, Default)]
pub struct ElastoPlastic<X, L = Radial> {
    /// Force that slips, N or N·m; may be infinite; 0: the element does nothing.
    pub cap: f64,
    /// Stiffness `k`, N/m or N·m/rad.
    pub stiffness: f64,
    /// Damping `d`, N·s/m or N·m·s/rad.
    pub damping: f64,
    /// Stored displacement `ς` at the start of the step, m or rad.
    pub displacement: X,
    /// Which forces it can bear.
    pub limit: L,
}

impl<X: Vector, L: Limit<X>> ElastoPlastic<X, L> {
    /// Resistance to the relative velocity `u` at the end of a step of `h` seconds.
    #[inline]
    pub fn respond(&self, u: X, h: f64) -> Resistance<X> {
        if self.cap <= 0.0 {
            return Resistance::default();
        }
        let b = self.stiffness * h + self.damping;
        let y = self.displacement * self.stiffness + u * b;
        self.limit.bear(y, self.cap, b)
    }

    /// Displacement after a step of `h` seconds that ends with the relative velocity `u`.
    #[inline]
    pub fn next(&self, u: X, h: f64) -> X {
        self.next_after(&self.respond(u, h), u, h)
    }

    /// The same where its resistance `r` is known.
    #[inline]
    pub fn next_after(&self, r: &Resistance<X>, u: X, h: f64) -> X {
        if self.cap <= 0.0 {
            return X::default();
        }
        let slip = r.slip;
        let settled = (r.force - u * self.damping) / self.stiffness;
        let (before, after) = (slip.dot(&self.displacement), slip.dot(&settled));
        let next = settled + slip * (self.slipped(before, after, h) - after);
        self.limit.clip(next, self.cap / self.stiffness)
    }

    /// Share of the relative velocity `u` at the end of a step of `h` seconds that the spring does
    /// not take up, 0 … 1. At the start it has taken up the speed `wound`; infinite where the
    /// element stuck: then the slip begins where spring and damper give the cap.
    #[inline]
    pub fn sliding(&self, u: X, wound: f64, h: f64) -> f64 {
        self.sliding_after(&self.respond(u, h), u, wound, h)
    }

    /// The same where its resistance `r` is known.
    #[inline]
    pub fn sliding_after(&self, r: &Resistance<X>, u: X, wound: f64, h: f64) -> f64 {
        let speed = u.dot(&u).sqrt();
        let Resistance { force, slip, .. } = *r;
        if slip.dot(&slip) <= 0.0 || speed <= 0.0 {
            return 0.0;
        }
        let left = (slip.dot(&force) - self.stiffness * slip.dot(&self.displacement)).max(0.0);
        let wound = left.min(wound * self.damping) / (self.damping + h * self.stiffness);
        (1.0 - wound / speed).max(0.0)
    }

    /// Speed that the spring takes up at the start of a step, where the relative speed is `speed`
    /// and this share of it `sliding`, as [`Self::sliding`] has it.
    #[inline]
    pub fn wound(speed: f64, sliding: f64) -> f64 {
        if sliding > 0.0 {
            speed * (1.0 - sliding)
        } else {
            f64::INFINITY
        }
    }

    /// Displacement along the slip after a step of `h` seconds in which the element slips.
    ///
    /// While it slips, spring and damper together could give more than the cap. As the slip slows
    /// down, the damper gives less and the spring takes over, `k ς = F̄ − d u`: then the element
    /// comes to rest under the load that it carries, and does not spring back. Slip faster than
    /// `F̄/d` leaves the spring nothing; what it holds from before goes within its own time `d/k`,
    /// not at once: else a slip too short for a step to see would decide on all that comes after,
    /// and a velocity that jumps would charge the spring without any work.
    ///
    /// - `stored`: before the step; `settled`: `(F̄ − d u)/k`; both in the direction of the force
    #[inline]
    fn slipped(&self, stored: f64, settled: f64, h: f64) -> f64 {
        let (k, d) = (self.stiffness, self.damping);
        let share = k * h / (k * h + d);
        settled.max(stored + share * (settled.max(0.0) - stored))
    }

    /// How fast the displacement changes at the relative velocity `u`, where no steps are taken:
    /// `ς̇ = (F − k ς)/d`, see [`crate::continuous`].
    #[inline]
    pub fn rate(&self, u: X) -> X {
        if self.damping <= 0.0 {
            return X::default();
        }
        let force = self.respond(u, 0.0).force;
        (force - self.displacement * self.stiffness) / self.damping
    }

    /// A displacement, cut down to what the cap can hold.
    #[inline]
    pub fn clipped(&self, displacement: X) -> X {
        let limit = if self.cap > 0.0 {
            self.cap / self.stiffness
        } else {
            0.0
        };
        self.limit.clip(displacement, limit)
    }

    /// Energy of the spring, J, times two.
    #[inline]
    pub fn twice_stored(&self) -> f64 {
        self.stiffness * self.displacement.dot(&self.displacement)
    }
}

impl ElastoPlastic<Vec3, Face> {
    /// Derivative with the cap of a force that it gives over `h` seconds while it slips. The
    /// force `f` is in proportion to what spring and damper give and the cap together, so that
    /// `F̄ ∂f/∂F̄ = f − (∂f/∂y) y`; and `∂f/∂y` takes from `y` and `f` the same, because nothing
    /// changes along the slip `ŝ`: the share of [`Resistance::slope`] of `f − ŝ (ŝ·f)`.
    pub fn growth(&self, r: &Resistance<Vec3>, h: f64) -> Vec3 {
        if self.limit.is_point() {
            return r.slip;
        }
        let share = r.slope / (self.stiffness * h + self.damping);
        let left = r.force * (1.0 - share) + r.slip * (share * r.slip.dot(&r.force));
        left / self.cap
    }
}

impl ElastoPlastic<f64> {
    /// Whether spring and damper give all of the force, but for round-off, that the cap leaves at
    /// the relative velocity `u`.
    pub fn yields(&self, u: f64) -> bool {
        let force = self.stiffness * self.displacement + self.damping * u;
        self.cap > 0.0 && force.abs() >= self.cap * (1.0 - ROUND_OFF)
    }

    /// Displacement with which spring and damper give `force` at the velocity `u`, as far as the
    /// cap can hold it.
    #[inline]
    pub fn settle(&self, force: f64, u: f64) -> f64 {
        if self.cap <= 0.0 {
            return 0.0;
        }
        self.clipped((force - self.damping * u) / self.stiffness)
    }

    /// The same as [`Self::next`] for dry friction, whose cap falls as the joint begins to move:
    /// what the spring holds from before may exceed the cap for a while, and goes within the
    /// element's own time.
    #[inline]
    pub fn next_under_falling_cap(&self, u: f64, h: f64) -> f64 {
        let Resistance { force, slip, .. } = self.respond(u, h);
        let next = self.settle(force, u);
        if slip == 0.0 {
            next
        } else {
            slip * self.slipped(slip * self.displacement, slip * next, h)
        }
    }
}

/// Coulomb coefficient, or any cap of friction, at a sliding speed: `rest` at none, `sliding` far
/// above the Stribeck speed `reference`, with a smooth fall `exp(−(u/u_s)²)` between. Both speeds
/// in m/s or rad/s.
#[inline]
pub fn stribeck(rest: f64, sliding: f64, speed: f64, reference: f64) -> f64 {
    let s = speed / reference;
    sliding + (rest - sliding) * libm::exp(-s * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stribecks_curve_runs_from_rest_to_sliding() {
        assert!((stribeck(0.6, 0.4, 0.0, 0.01) - 0.6).abs() < 1e-15);
        // exp(−1) of the difference is left at the reference speed.
        assert!((stribeck(0.6, 0.4, 0.01, 0.01) - (0.4 + 0.2 * (-1.0_f64).exp())).abs() < 1e-15);
        assert!((stribeck(0.6, 0.4, 0.1, 0.01) - 0.4).abs() < 1e-15);
    }

    /// `h F u ≥ ½ k Δς²`, as for contacts.
    #[test]
    fn dry_friction_gives_back_no_more_than_it_was_paid() {
        let mut random = crate::testing::Random(10);
        for _ in 0..10_000 {
            let h = libm::pow(10.0, random.uniform(-7.0, -1.0));
            let u = random.uniform(-1.0, 1.0) * libm::pow(10.0, random.uniform(-5.0, 1.0));
            let element = ElastoPlastic {
                cap: 2.0,
                stiffness: 2e4,
                damping: 30.0,
                displacement: random.uniform(-1.5e-4, 1.5e-4),
                limit: Radial,
            };
            let paid = h * u * element.respond(u, h).force;
            let before = element.displacement;
            for after in [element.next_under_falling_cap(u, h), element.next(u, h)] {
                let more = 0.5 * element.stiffness * (after * after - before * before);
                assert!(more <= paid + 1e-16, "{h} {u} {before}: {more} {paid}");
            }
        }
    }

    /// Slip that lasts a millionth of the element's own time d/k changes what it stores by as much,
    /// however fast it is.
    #[test]
    fn a_short_slip_leaves_the_displacement_as_it_is() {
        for displacement in [-5e-5, 0.0, 5e-5] {
            let element = ElastoPlastic {
                cap: 2.0,
                stiffness: 2e4,
                damping: 30.0,
                displacement,
                limit: Radial,
            };
            let h = 1e-6 * element.damping / element.stiffness;
            let limit = element.cap / element.stiffness;
            for u in [-10.0, 10.0] {
                for next in [element.next_under_falling_cap(u, h), element.next(u, h)] {
                    assert!((next - displacement).abs() < 2e-6 * limit, "{u}: {next}");
                }
            }
        }
    }

    #[test]
    fn an_element_without_a_cap_stores_nothing() {
        let element = ElastoPlastic {
            cap: 0.0,
            stiffness: 1e3,
            damping: 1.0,
            displacement: 1e-3,
            limit: Radial,
        };
        assert!(element.next(0.0, 1e-2).abs() < f64::MIN_POSITIVE);
        assert!(element.next_under_falling_cap(0.0, 1e-2).abs() < f64::MIN_POSITIVE);
        assert!(element.settle(1.0, 0.0).abs() < f64::MIN_POSITIVE);
    }

    /// A vector along an axis is a number.
    #[test]
    fn the_law_is_the_same_along_a_line_and_in_space() {
        let mut random = crate::testing::Random(11);
        let axis = Vec3::new(0.36, 0.48, 0.8);
        for _ in 0..2000 {
            let h = libm::pow(10.0, random.uniform(-6.0, -1.0));
            let u = random.uniform(-1.0, 1.0) * libm::pow(10.0, random.uniform(-5.0, 1.0));
            let line = ElastoPlastic {
                cap: 2.0,
                stiffness: 2e4,
                damping: 30.0,
                displacement: random.uniform(-1e-4, 1e-4),
                limit: Radial,
            };
            let space = ElastoPlastic {
                cap: line.cap,
                stiffness: line.stiffness,
                damping: line.damping,
                displacement: axis * line.displacement,
                limit: Radial,
            };
            let (a, b) = (line.respond(u, h), space.respond(axis * u, h));
            assert!((axis * a.force - b.force).norm() < 1e-12 * line.cap);
            let (a, b) = (line.next(u, h), space.next(axis * u, h));
            assert!((axis * a - b).norm() < 1e-12 * line.cap / line.stiffness);
        }
    }
}
