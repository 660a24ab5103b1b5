//! Laws of motors: constants that follow from effort and inertia, the torque–speed line, the
//! servo's braking curve.

use crate::tuning::{MOTOR_DEFLECTION, MOTOR_RELAXATION};

/// Stiffness and damping of a velocity motor on a joint with the given inertia at the initial
/// position.
pub fn motor_constants(reference_effort: f64, inertia: f64) -> (f64, f64) {
    let stiffness = reference_effort / MOTOR_DEFLECTION;
    let critical = 2.0 * (stiffness * inertia).sqrt();
    (stiffness, critical.max(stiffness * MOTOR_RELAXATION))
}

/// Torque–speed line of a motor: while it drives, its effort is at most `stall (1 − |v|/no_load)`,
/// not below 0; while it brakes, the line does not act.
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
    pub fn new(stall: f64, no_load: Option<f64>) -> Self {
        match no_load {
            Some(no_load) if stall.is_finite() => Self { stall, no_load },
            _ => Self::default(),
        }
    }

    /// Steepest fall of the effort with the velocity.
    pub fn slope(&self) -> f64 {
        self.stall / self.no_load
    }

    /// Cuts a force and its derivative at velocity `v` down to the line. Both bounds fall with `v`,
    /// so a force that does still does.
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

/// Speed towards a target at the distance `e` (rad or m, with sign) that brakes to zero there, and
/// its derivative with the distance.
///
/// 1. A joint that brakes with the deceleration `a` from the speed `s` comes to rest within
///    `s²/2a`: farther out it may have `s(e) = √(2 a (|e| − e₀))`.
/// 2. This root is infinitely steep where it ends. Near the target the servo is a critically damped
///    spring instead, with `s(e) = m |e|` of the slope `m`, in 1/s.
/// 3. Where they meet, at `|e| = e₁`, values and slopes are to agree: `m² e₁² = 2 a (e₁ − e₀)` and
///    `m = a/(m e₁)`. The latter gives `e₁ = a/m²`, the former `e₀ = e₁ − m² e₁²/2a = a/2m²`.
/// 4. The derivative of the root is `a/s`. Beyond the `limit` of the speed it is zero.
///
/// - `slope`: `m`, 1/s; `braking`: `a`, rad/s² or m/s²; `limit`: rad/s or m/s, may be infinite
#[inline]
fn desired_speed(e: f64, slope: f64, braking: f64, limit: f64) -> (f64, f64) {
    let distance = e.abs();
    let (speed, rate) = if distance * slope * slope <= braking {
        (slope * distance, slope)
    } else {
        let speed = (2.0 * braking * (distance - 0.5 * braking / (slope * slope))).sqrt();
        (speed, braking / speed)
    };
    if speed <= limit {
        (speed.copysign(e), rate)
    } else {
        (limit.copysign(e), 0.0)
    }
}

/// `desired_speed` towards a target that moves at `rate`, within `limit`, and its derivative with
/// the distance.
#[inline]
pub fn servo_speed(e: f64, rate: f64, slope: f64, braking: f64, limit: f64) -> (f64, f64) {
    let (speed, change) = desired_speed(e, slope, braking, limit);
    let total = speed + rate;
    if total.abs() <= limit {
        (total, change)
    } else {
        (limit.copysign(total), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn desired_speed_is_continuous_with_its_slope_where_spring_and_braking_meet() {
        let (slope, braking) = (50.0, 4.0);
        let meet = braking / (slope * slope);
        let (below, rate_below) = desired_speed(meet * (1.0 - 1e-9), slope, braking, f64::INFINITY);
        let (above, rate_above) = desired_speed(meet * (1.0 + 1e-9), slope, braking, f64::INFINITY);
        assert!((below - above).abs() < 1e-8 && (rate_below - rate_above).abs() < 1e-5);
        assert_eq!(desired_speed(-10.0, slope, braking, 2.0), (-2.0, 0.0));
    }
}
