//! How a contact or a joint's limit is damped as it comes nearer and as it leaves.

use crate::tuning::PRESSED;

/// The factor on the force of the spring of a contact or of a joint's limit.
///
/// 1. A contact has the factor `1 + D δ̇` of Hunt & Crossley: nothing pushes what leaves faster
///    than `v_e = 1/D`.
/// 2. The spring is made for a weight `W`. What an initial pose, a neighbour or a fall has pressed
///    in is deeper: there it has the force `F` of up to a million weights. With the factor
///    `1 − v/v_e` it is in balance with the weight within the last `W/F` of `v_e`, with the slope
///    `F/v_e`. Contacts of one robot that leave side by side, or one contact and its joints, then
///    take turns for as long as they are deep, in steps of microseconds.
/// 3. With `x = v/v_e` the factor is `(1 − x)ⁿ (1 + (n − 1) x)`, which is `1 − x` for `n = 1`. For
///    all `n ≥ 1` it falls from 1 at `x = 0`, with the slope −1, to 0 at `x = 1`: what is at rest
///    or comes in does not know `n`. With `n = ln(F/100 W)`, at least 1, the slope at the weight is
///    65, 46 and 50 `W/v_e` where `F/W` is 10³, 10⁴ and 10⁶, and the weight leaves with 0.97, 0.90
///    and 0.82 of `v_e`. The least slope of all `n` would be 22, 29 and 43 `W/v_e`, at about
///    `n = ln(F/W)`. But what an impact of usual speed has pressed in, up to 100 weights or so,
///    then leaves so softly that fixed steps did not tell it from what stays: of 3200 rods that
///    landed on an end 9 were thrown back.
/// 4. An overlap that an initial pose has put there leaves with a `v_e` above `1/D`.
/// 5. A limit has the same law. What its spring is made for is the effort limit of its joint.
#[derive(Clone, Copy, Debug, Default)]
pub struct Damping {
    /// `D`, s/m.
    pub dissipation: f64,
    /// `v_e`, m/s.
    pub fastest: f64,
    /// `n`.
    pub power: f64,
}

impl Damping {
    /// That of Hunt & Crossley with a dissipation, s/m.
    pub fn new(dissipation: f64) -> Self {
        Self {
            dissipation,
            fastest: 1.0 / dissipation,
            power: 1.0,
        }
    }

    /// That of a spring that has been pressed in to so many times the load that it is made for.
    pub fn leaving(dissipation: f64, loads: f64) -> Self {
        let mut damping = Self::new(dissipation);
        if loads > PRESSED {
            damping.power = libm::log(loads / PRESSED).max(1.0);
        }
        damping
    }

    /// The factor where the depth grows at `rate`, m/s, and its derivative with that, s/m; both 0
    /// where it leaves too fast to be pushed.
    #[inline]
    pub fn factor(&self, rate: f64) -> (f64, f64) {
        if rate < 0.0 && self.power > 1.0 {
            let x = -rate / self.fastest;
            let (left, n) = (1.0 - x, self.power);
            if left <= 0.0 {
                return (0.0, 0.0);
            }
            let part = libm::exp((n - 1.0) * libm::log(left));
            let factor = part * left * (1.0 + (n - 1.0) * x);
            return (factor, part * (1.0 + (n * n - 1.0) * x) / self.fastest);
        }
        let factor = 1.0 + self.dissipation * rate;
        if factor > 0.0 {
            (factor, self.dissipation)
        } else {
            (0.0, 0.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_its_derivative_and_ends_where_nothing_pushes_any_more() {
        let dissipation = 51.0;
        let common = Damping::new(dissipation);
        for (fastest, power) in [(common.fastest, 1.0), (common.fastest, 3.7), (0.3, 14.2)] {
            let damping = Damping {
                fastest,
                power,
                ..common
            };
            assert!((damping.factor(0.0).0 - 1.0).abs() < 1e-15);
            let (beyond, change) = damping.factor(-1.01 * fastest);
            assert!(beyond <= 0.0 && change <= 0.0);
            for share in [-0.9, -0.4, 0.3] {
                let rate = share * fastest;
                let by = 1e-7 * fastest;
                let [ahead, behind] = [by, -by].map(|by| damping.factor(rate + by).0);
                let difference = (ahead - behind) / (2.0 * by);
                let (_, change) = damping.factor(rate);
                assert!(change > 0.0);
                assert!(
                    (difference - change).abs() < 1e-5 * (1.0 + change),
                    "{rate}"
                );
            }
        }
    }

    /// What rests does not know the power: the slope at no speed is the same from both sides.
    #[test]
    fn the_slope_at_rest_is_that_of_hunt_and_crossley() {
        let common = Damping::new(51.0);
        let deep = Damping {
            power: 14.0,
            ..common
        };
        let (_, slope) = deep.factor(-1e-12);
        assert!((slope / 51.0 - 1.0).abs() < 1e-8, "{slope}");
    }

    /// The weight against a spring of so many weights: speed and slope, in units of `v_e` and
    /// `W/v_e`, by halving; the power is that of [`PRESSED`].
    #[test]
    fn a_deep_overlap_meets_the_weight_softly() {
        for (strength, expected) in [
            (1e2, [0.990, 100.0]),
            (1e3, [0.965, 65.29]),
            (1e4, [0.901, 45.74]),
            (1e6, [0.821, 50.49]),
        ] {
            let damping = Damping::leaving(1.0, strength);
            let (mut low, mut high) = (-1.0, 0.0);
            for _ in 0..60 {
                let rate = 0.5 * (low + high);
                if strength * damping.factor(rate).0 < 1.0 {
                    low = rate;
                } else {
                    high = rate;
                }
            }
            let found = [-low, strength * damping.factor(low).1];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
            }
        }
    }
}
