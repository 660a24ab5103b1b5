//! What an actuator does in a step: a force that falls with the velocity at its end, or stays.
//!
//! Set up from commands by [`super::Terms::set_joints`]; the torque–speed line is not applied here.

use crate::law::ElastoPlastic;
use crate::law::motor::servo_speed;

/// What an actuator does in a step.
#[derive(Clone, Copy, Debug, Default)]
pub enum Drive {
    /// Nothing.
    #[default]
    None,
    /// Constant force.
    Effort(f64),
    /// Elasto-plastic motor that follows a velocity.
    Velocity {
        /// rad/s or m/s
        target: f64,
        /// Relative to the target.
        element: ElastoPlastic<f64>,
    },
    /// Position servo: `F = clamp(load + gain (rate + v_des(target − q) − v), ±cap)`.
    Position {
        /// What gravity and motion ask of the joint, N·m or N: carried without an error.
        load: f64,
        /// Target at the end of the step minus `q` at its start.
        error: f64,
        /// Speed of the target, rad/s or m/s: a moving target is followed without lag.
        rate: f64,
        /// N·m·s/rad or N·s/m
        gain: f64,
        /// Slope of `v_des` near the target, 1/s.
        slope: f64,
        /// Planned braking, rad/s² or m/s².
        braking: f64,
        /// Speed limit, rad/s or m/s; may be infinite.
        speed: f64,
        /// N·m or N
        cap: f64,
    },
    /// `F = clamp(offset − (kp h + kd) v, ±cap)`.
    Pd {
        /// Force at rest: feed-forward and errors at the start of the step.
        offset: f64,
        /// N·m/rad or N/m
        kp: f64,
        /// N·m·s/rad or N·s/m
        kd: f64,
        /// N·m or N
        cap: f64,
    },
}

impl Drive {
    /// Force and its (never positive) derivative with the velocity `v` at the end of a step of `h`
    /// seconds.
    #[inline]
    pub fn force(&self, v: f64, h: f64) -> (f64, f64) {
        match *self {
            Self::None => (0.0, 0.0),
            Self::Effort(effort) => (effort, 0.0),
            Self::Velocity {
                target,
                ref element,
            } => {
                let resistance = element.respond(v - target, h);
                (-resistance.force, -resistance.slope)
            }
            Self::Position {
                load,
                error,
                rate,
                gain,
                slope,
                braking,
                speed,
                cap,
            } => {
                let (desired, change) = servo_speed(error - h * v, rate, slope, braking, speed);
                let force = load + gain * (desired - v);
                if force.abs() <= cap {
                    (force, -gain * (h * change + 1.0))
                } else {
                    (cap.copysign(force), 0.0)
                }
            }
            Self::Pd {
                offset,
                kp,
                kd,
                cap,
            } => {
                let gain = kp * h + kd;
                let force = offset - gain * v;
                if force.abs() <= cap {
                    (force, -gain)
                } else {
                    (cap.copysign(force), 0.0)
                }
            }
        }
    }

    /// The largest force that it can give.
    pub fn most(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Effort(effort) => effort.abs(),
            Self::Velocity { element, .. } => element.cap,
            Self::Position { cap, .. } | Self::Pd { cap, .. } => *cap,
        }
    }

    /// By how much the force falls with the position, or with what a velocity motor remembers of
    /// it, N·m/rad or N/m, within its effort limit.
    pub fn stiffness(&self) -> f64 {
        match self {
            Self::None | Self::Effort(_) => 0.0,
            Self::Velocity { element, .. } => element.stiffness,
            Self::Position { gain, slope, .. } => gain * slope,
            Self::Pd { kp, .. } => *kp,
        }
    }

    /// Whether the force changes with position or velocity: then steps must be implicit.
    pub fn is_stiff(&self) -> bool {
        match self {
            Self::None | Self::Effort(_) => false,
            Self::Velocity { element, .. } => element.cap > 0.0,
            Self::Position { cap, .. } | Self::Pd { cap, .. } => *cap > 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Radial;

    #[test]
    fn drive_stiffness_is_the_derivative_of_its_force() {
        let element = ElastoPlastic {
            cap: 5.0,
            stiffness: 1e3,
            damping: 10.0,
            displacement: 1e-3,
            limit: Radial,
        };
        let drives = [
            Drive::Velocity {
                target: 0.2,
                element,
            },
            Drive::Position {
                load: 0.4,
                error: 0.3,
                rate: 0.1,
                gain: 20.0,
                slope: 30.0,
                braking: 5.0,
                speed: 9.0,
                cap: 1e3,
            },
            Drive::Pd {
                offset: 1.0,
                kp: 40.0,
                kd: 2.0,
                cap: 9.0,
            },
        ];
        for drive in drives {
            for v in [-0.12, 0.19, 0.8] {
                let (h, d) = (1e-2, 1e-6);
                let difference = (drive.force(v + d, h).0 - drive.force(v - d, h).0) / (2.0 * d);
                let (_, slope) = drive.force(v, h);
                assert!(
                    (difference - slope).abs() <= 1e-4 * (1.0 + slope.abs()),
                    "{drive:?} {v}"
                );
            }
        }
    }
}
