//! A spring–damper with a capped force, and a motor's torque–speed line.
//!
//! Both give a force that falls with the velocity.

use crate::contact::stretched;

/// A spring–damper with a plastic cap along one coordinate.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElastoPlastic {
    /// Force that slips, N·m or N; may be infinite.
    pub cap: f64,
    /// N·m/rad or N/m
    pub stiffness: f64,
    /// N·m·s/rad or N·s/m
    pub damping: f64,
    /// Stored displacement at the start of the step, rad or m.
    pub displacement: f64,
}

impl ElastoPlastic {
    /// Resisting force and its derivative with the relative velocity `u` at the end of a step of `h` seconds.
    #[inline]
    pub fn force(&self, u: f64, h: f64) -> (f64, f64) {
        let b = self.stiffness * h + self.damping;
        let y = self.stiffness * self.displacement + b * u;
        if y.abs() <= self.cap {
            (y, b)
        } else {
            (self.cap.copysign(y), 0.0)
        }
    }

    /// Stored displacement of friction after the step.
    #[inline]
    pub fn next(&self, u: f64, h: f64) -> f64 {
        let (force, slope) = self.force(u, h);
        let mut next = self.settle(force, u);
        if slope <= 0.0 && self.cap > 0.0 {
            let (slip, spring) = (force.signum(), (self.stiffness, self.damping));
            next = slip * stretched(slip * self.displacement, slip * next, spring, h);
        }
        next
    }

    /// Displacement with which spring and damper give `force` at the velocity `u`. A motor goes there at once where its effort is
    /// too little or its torque–speed line has cut it down to `force`: it eases off in time and comes to its speed without
    /// running past it.
    #[inline]
    pub(super) fn settle(&self, force: f64, u: f64) -> f64 {
        if self.cap <= 0.0 {
            return 0.0;
        }
        let limit = self.cap / self.stiffness;
        ((force - self.damping * u) / self.stiffness).clamp(-limit, limit)
    }

    /// A stored displacement, found for the relative velocity `u` at the end of a step of `h` seconds, where the joint has
    /// `moved` by so much more. An element that slips keeps it.
    pub fn shifted(&self, displacement: f64, moved: f64, u: f64, h: f64) -> f64 {
        if self.force(u, h).0.abs() < self.cap {
            let limit = self.cap / self.stiffness;
            (displacement + moved).clamp(-limit, limit)
        } else {
            displacement
        }
    }
}

/// Torque–speed line of a motor: while it drives, its effort is at most `stall (1 − |v|/no_load)`, not below 0; while it
/// brakes, the line does not act.
#[derive(Clone, Copy, Debug)]
pub struct SpeedLine {
    /// Effort at standstill, N·m or N.
    pub stall: f64,
    /// Speed without effort, rad/s or m/s; infinite: there is no line.
    pub no_load: f64,
}

impl Default for SpeedLine {
    /// No line.
    fn default() -> Self {
        Self {
            stall: 0.0,
            no_load: f64::INFINITY,
        }
    }
}

impl SpeedLine {
    /// A line if there is a no-load speed and a finite effort to begin with.
    pub(super) fn new(stall: f64, no_load: Option<f64>) -> Self {
        match no_load {
            Some(no_load) if stall.is_finite() => Self { stall, no_load },
            _ => Self::default(),
        }
    }

    /// Steepest fall of the effort with the velocity.
    pub fn slope(&self) -> f64 {
        self.stall / self.no_load
    }

    /// Cuts a force and its derivative at velocity `v` down to the line. Both bounds fall with `v`, so a force that does
    /// still does.
    #[inline]
    pub fn cut(&self, (force, slope): (f64, f64), v: f64) -> (f64, f64) {
        if self.no_load == f64::INFINITY || force * v <= 0.0 {
            return (force, slope);
        }
        let most = self.stall - self.slope() * v.abs();
        if most <= 0.0 {
            (0.0, 0.0)
        } else if force.abs() > most {
            (most.copysign(force), -self.slope())
        } else {
            (force, slope)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `h F u ≥ ½ k Δz²`, as for contacts.
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
            };
            let paid = h * u * element.force(u, h).0;
            let (before, after) = (element.displacement, element.next(u, h));
            let more = 0.5 * element.stiffness * (after * after - before * before);
            assert!(more <= paid + 1e-16, "{h} {u} {before}: {more} {paid}");
        }
    }

    /// Slip that lasts a millionth of the element's own time d/k changes what it stores by as much, however fast it is.
    #[test]
    fn a_short_slip_leaves_the_displacement_as_it_is() {
        for displacement in [-5e-5, 0.0, 5e-5] {
            let element = ElastoPlastic {
                cap: 2.0,
                stiffness: 2e4,
                damping: 30.0,
                displacement,
            };
            let h = 1e-6 * element.damping / element.stiffness;
            let limit = element.cap / element.stiffness;
            for u in [-10.0, 10.0] {
                let next = element.next(u, h);
                assert!((next - displacement).abs() < 2e-6 * limit, "{u}: {next}");
            }
        }
    }

    #[test]
    fn a_released_motor_forgets_its_displacement() {
        let element = ElastoPlastic {
            cap: 0.0,
            stiffness: 1e3,
            damping: 1.0,
            displacement: 1e-3,
        };
        assert!(element.next(0.0, 1e-2).abs() < f64::MIN_POSITIVE);
    }
}
