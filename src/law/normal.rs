//! The Hunt–Crossley law of contacts in the normal direction and of joint limits.
//!
//! With the gap `g` at the start of a step of `h` seconds (negative in contact) and the velocity
//! `v` at its end, positive apart, the penetration at the end is `x = −g − h v`, and the force `F =
//! k x₊ (1 − d v)₊`: it falls with `v`.
//!
//! Source: Hunt & Crossley 1975.

/// A spring that only pushes, with damping proportional to its force.
#[derive(Clone, Copy, Debug, Default)]
pub struct HuntCrossley {
    /// Stiffness `k`, N/m or N·m/rad.
    pub stiffness: f64,
    /// Dissipation `d`, s/m or s/rad.
    pub dissipation: f64,
}

impl HuntCrossley {
    /// Impulse for the velocity `v` at the end of a step of `h` seconds, N·s or N·m·s, and minus
    /// its derivative with the velocity, kg or kg·m².
    #[inline]
    pub fn respond(&self, gap: f64, v: f64, h: f64) -> (f64, f64) {
        let elastic = self.stiffness * (-gap - h * v);
        let damping = 1.0 - self.dissipation * v;
        if elastic > 0.0 && damping > 0.0 {
            let stiffness = h * self.stiffness * damping + self.dissipation * elastic;
            (h * elastic * damping, h * stiffness)
        } else {
            (0.0, 0.0)
        }
    }

    /// Force at the start of the step, N or N·m.
    #[inline]
    pub fn force(&self, gap: f64, v: f64) -> f64 {
        self.stiffness * (-gap).max(0.0) * (1.0 - self.dissipation * v).max(0.0)
    }

    /// Energy that the spring holds at a gap, J.
    #[inline]
    pub fn stored(&self, gap: f64) -> f64 {
        0.5 * self.stiffness * gap.min(0.0) * gap.min(0.0)
    }

    /// Energy that a spring which is `depth` deep takes up over `more` of it, J.
    #[inline]
    pub fn taken_up(&self, depth: f64, more: f64) -> f64 {
        if depth.max(depth + more) <= 0.0 {
            return 0.0;
        }
        let (before, after) = (depth.max(0.0), (depth + more).max(0.0));
        0.5 * self.stiffness * (after * after - before * before)
    }
}

/// Hunt–Crossley dissipation times approach speed that gives the coefficient of restitution `e`:
/// the root of `a − ln(1+a) = −e a − ln(1−e a)`; independent of mass and stiffness. Infinite for `e
/// = 0`.
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
}
