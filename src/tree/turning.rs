//! What resists turning where two links touch.

use crate::tuning::TURN_DEFLECTION;

/// What friction against turning at a link is made for. Its inertia is filled by
/// [`super::Tree::new`], its load by [`super::Tree::scale`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Turning {
    /// Inertia that the damping is critical for, kg·m².
    pub inertia: f64,
    /// Normal force that the stiffness is made for at least, N: a quarter of the weight.
    pub load: f64,
}

impl Turning {
    /// That of two bodies that turn each other: the inertia of both, reduced, and the load of the
    /// lighter one.
    pub fn with(self, other: Self) -> Self {
        Self {
            inertia: self.inertia * other.inertia / (self.inertia + other.inertia),
            load: self.load.min(other.load),
        }
    }

    /// One over the longer of the own times `d/k` of friction with these coefficients, 1/s: how
    /// fast it forgets while nothing presses.
    pub fn forgets(&self, [torsional, rolling]: [f64; 2]) -> f64 {
        // `d = 2 √(k I)`
        let least = if torsional > 0.0 && rolling > 0.0 {
            torsional.min(rolling)
        } else {
            torsional.max(rolling)
        };
        0.5 * (least * self.load / (TURN_DEFLECTION * self.inertia)).sqrt()
    }
}
