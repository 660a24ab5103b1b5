//! The limit of a joint where an integrator outside takes the steps.
//!
//! 1. A step solves for the impulse of a limit, so its spring may be as stiff as the effort limit
//!    of the joint wants it, which in files is often 1e6 N·m and more for "no limit". An integrator
//!    has to resolve that: with 1e9 N·m an impact is over in a microsecond and took thousands of
//!    evaluations, and CVODE gave up at 1e-6, or made 3 J out of nothing.
//! 2. So the spring begins as one that is made for a load `L` of the joint's own inertia at
//!    [`LIMIT_LOAD`](crate::tuning::LIMIT_LOAD), and stiffens as contacts do: `F = k δ (1 +
//!    (δ/δ₁)³)` with `δ₁` = [`LIMIT_DEFLECTION`] and `k = L/δ₁`. Its rate is 10³/s where it sets
//!    in. A load of a thousand or a million `L` finds it 6 or 32 `δ₁` deep.
//! 3. From where its slope is that of the spring of steps it keeps that. So a joint whose effort
//!    limit is below `L` has the same limit in both interfaces, and what begins far beyond its
//!    limit is not pushed harder than in steps.
//! 4. Where it sets in, its slope jumps from nothing to `k`. A servo may hold its joint just there,
//!    and then it crosses this place with every shock, by a ten-thousandth of a millimetre. With
//!    the slope of steps, ten times that of the servo, integrators shortened their steps or gave
//!    up.
//! 5. What leaves is damped as in steps, see [`Damping`].

use super::Damping;
use super::normal::{HuntCrossley, Stiffening};
use crate::tuning::LIMIT_DEFLECTION;

/// A limit with this law.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    spring: Stiffening,
    /// That of steps.
    limit: HuntCrossley,
}

impl Stop {
    /// That of a joint.
    ///
    /// - `load`: what its spring is made for, N·m or N
    /// - `limit`: the law of steps
    pub fn new(load: f64, limit: HuntCrossley) -> Self {
        let spring = Stiffening {
            stiffness: load / LIMIT_DEFLECTION,
            reference: LIMIT_DEFLECTION,
        };
        Self { spring, limit }
    }

    /// The part of a depth up to which it stiffens, and the rest, m or rad.
    fn parts(&self, depth: f64) -> (f64, f64) {
        let most = self.limit.stiffness / self.spring.stiffness;
        let full = LIMIT_DEFLECTION * libm::cbrt(0.25 * (most - 1.0).max(0.0));
        let stiffening = depth.min(full);
        (stiffening, depth - stiffening)
    }

    /// Force, N or N·m, at the velocity `v`, positive apart.
    #[inline]
    pub fn force(&self, gap: f64, v: f64) -> f64 {
        if gap >= 0.0 {
            return 0.0;
        }
        let (depth, rest) = self.parts(-gap);
        let elastic = self.spring.force(depth) + rest * self.spring.slope(depth);
        let loads = elastic / (self.limit.stiffness * LIMIT_DEFLECTION);
        let damping = Damping::leaving(self.limit.damping.dissipation, loads);
        elastic * damping.factor(-v).0
    }

    /// Stiffness at a gap, N/m or N·m/rad; 0 where the joint is not at its limit.
    #[inline]
    pub fn stiffness(&self, gap: f64) -> f64 {
        if gap < 0.0 {
            self.spring.slope(self.parts(-gap).0)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: f64 = 8.0;

    /// One whose joint has an effort limit of so many `LOAD`.
    fn stop(loads: f64) -> Stop {
        let stiffness = loads.max(1.0) * LOAD / LIMIT_DEFLECTION;
        let damping = Damping::new(51.0);
        Stop::new(LOAD, HuntCrossley { stiffness, damping })
    }

    /// Where effort limits are small, the law is that of a step without length.
    #[test]
    fn a_weak_joint_has_the_same_limit_in_both_interfaces() {
        for (gap, v) in [(-1e-6, 0.01), (-1e-4, -0.3), (-3e-3, 0.0), (1e-5, -1.0)] {
            let stop = stop(0.3);
            let (impulse, _) = stop.limit.respond(gap, v, 1e-12);
            let force = stop.force(gap, v);
            assert!((impulse / 1e-12 - force).abs() < 1e-6 * LOAD, "{gap} {v}");
        }
    }

    /// Depths by hand: the roots of `x (1 + x³) = 10, 10³`, and for 10⁶ the tangent at `x = 30`, by
    /// which a contact goes on from there.
    #[test]
    fn a_strong_joint_finds_its_limit_a_little_deeper() {
        for (loads, depth) in [(10.0, 1.697_472), (1e3, 5.615_502), (1e6, 31.758_965)] {
            let force = stop(1e9).force(-depth * LIMIT_DEFLECTION, 0.0);
            assert!((force / (loads * LOAD) - 1.0).abs() < 1e-4, "{loads}");
        }
    }

    /// The stiffness is the derivative of the force at rest, grows with the depth, and is at most
    /// that of steps.
    #[test]
    fn it_stiffens_up_to_the_spring_of_steps() {
        for loads in [1.0, 30.0, 1e6] {
            let (stop, by) = (stop(loads), 1e-3 * LIMIT_DEFLECTION);
            let mut last = LOAD / LIMIT_DEFLECTION;
            for i in 1..1000 {
                let gap = -0.1 * LIMIT_DEFLECTION * f64::from(i);
                let stiffness = stop.stiffness(gap);
                assert!(stiffness >= last * (1.0 - 1e-12));
                assert!(stiffness <= stop.limit.stiffness * (1.0 + 1e-12));
                let [deeper, before] = [gap - by, gap + by].map(|gap| stop.force(gap, 0.0));
                let between = (deeper - before) / (2.0 * by);
                let ends = [gap - by, gap + by].map(|gap| stop.stiffness(gap));
                assert!(
                    between >= 0.999 * ends[1] && between <= 1.001 * ends[0],
                    "{gap}"
                );
                last = stiffness;
            }
        }
        assert!(stop(1.0).stiffness(0.0) == 0.0 && stop(1.0).force(0.0, -1.0) == 0.0);
    }
}
