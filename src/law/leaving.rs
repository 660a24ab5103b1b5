//! How a contact is damped as it comes nearer and as it leaves.

/// The factor on the force of a contact's spring.
///
/// 1. A contact has the factor `1 + D δ̇` of Hunt & Crossley: it pulls nothing back that leaves
///    faster than `1/D`.
/// 2. An overlap that an initial pose has put there is deeper than any load would make it. It
///    leaves with a speed `v` below its own `v_e`. There the spring has the force `F` of a million
///    weights `W`. With the factor `1 − v/v_e` it would be in balance with the weight within the
///    last millionth of `v_e`, with the slope `10⁶ W/v_e`. On a light link two such contacts, or
///    one and its joints, then take turns for as long as they are deep, in steps of microseconds.
/// 3. With `(1 − v/v_e)ⁿ` the slope at the weight is `n (F/W)^(1/n) W/v_e`. It is least for
///    `n = ln(F/W)`, which is 14 here: 38 weights. [`Self::factor`] has `n = 8`, which three
///    squares make: 45 weights, and the weight leaves with `0.82 v_e`.
/// 4. Where an overlap begins to be deep, `v_e` is `1/D`: with a weight it leaves with `1/D` on the
///    one side and with 0.82 of that on the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Damping {
    /// `D`, s/m.
    pub dissipation: f64,
    /// `v_e`, m/s; 0 of a contact that is not so deep.
    pub emergence: f64,
}

impl Damping {
    /// The factor where the depth grows at `rate`, m/s, and its derivative with that, s/m; both 0
    /// where it leaves too fast to be pushed.
    #[inline]
    pub fn factor(&self, rate: f64) -> (f64, f64) {
        if rate < 0.0 && self.emergence > 0.0 {
            let left = (1.0 + rate / self.emergence).max(0.0);
            let squared = left * left;
            let fourth = squared * squared;
            let eighth = fourth * fourth;
            return (eighth, 8.0 * fourth * squared * left / self.emergence);
        }
        let factor = 1.0 + self.dissipation * rate;
        if factor > 0.0 {
            (factor, self.dissipation)
        } else {
            (0.0, 0.0)
        }
    }

    /// The greatest speed with which the spring pushes what leaves, m/s.
    pub fn fastest(&self) -> f64 {
        if self.emergence > 0.0 {
            self.emergence
        } else {
            1.0 / self.dissipation
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_its_derivative_and_ends_where_nothing_pushes_any_more() {
        let dissipation = 51.0;
        for (emergence, fastest) in [(0.0, 1.0 / dissipation), (0.3, 0.3)] {
            let damping = Damping {
                dissipation,
                emergence,
            };
            assert!((damping.fastest() - fastest).abs() < 1e-15);
            assert!((damping.factor(0.0).0 - 1.0).abs() < 1e-15);
            let (beyond, change) = damping.factor(-1.01 * fastest);
            assert!(beyond <= 0.0 && change <= 0.0);
            for share in [-0.9, -0.4, 0.3] {
                let rate = share * fastest;
                let by = 1e-7 * fastest;
                let [ahead, behind] = [by, -by].map(|by| damping.factor(rate + by).0);
                let difference = (ahead - behind) / (2.0 * by);
                let (_, change) = damping.factor(rate);
                assert!(
                    (difference - change).abs() < 1e-5 * (1.0 + change),
                    "{rate}"
                );
            }
        }
    }

    /// Of all powers of `1 − v/v_e` the one of the natural logarithm of `F/W` has the least slope
    /// at the weight, `e ln(F/W) W/v_e`.
    #[test]
    fn a_deep_overlap_meets_the_weight_as_softly_as_it_can() {
        let damping = Damping {
            dissipation: 51.0,
            emergence: 1.0,
        };
        let strength = 1e6;
        let (mut low, mut high) = (-1.0, 0.0);
        for _ in 0..60 {
            let rate = 0.5 * (low + high);
            if strength * damping.factor(rate).0 < 1.0 {
                low = rate;
            } else {
                high = rate;
            }
        }
        let slope = strength * damping.factor(low).1;
        let least = std::f64::consts::E * libm::log(strength);
        assert!(slope < 1.2 * least, "{slope} {least}");
        assert!((low + 0.82).abs() < 5e-3, "{low}");
    }
}
