//! Forces along one degree of freedom as convex terms: damping, dry friction, limits, actuators.
//!
//! Each gives an impulse that falls with the velocity at the end of the step, so that the step
//! stays a convex minimisation. Velocity motors and dry friction are elasto-plastic: a
//! spring–damper with a stored displacement and a capped force, which holds a load without creep.
//! Dry friction that is higher at rest follows the speed at the start of the step (Stribeck), which
//! keeps it convex. A motor's effort may fall with its speed: as it falls in the direction of
//! motion alone, the force still falls with the velocity and needs no lag. Position servos brake
//! along `v = √(2 a e)` and end in a critically damped spring, so that they do not overshoot within
//! their effort.

use super::drive::Drive;
use super::memory::Memory;
use crate::closure::Felt;
use crate::inputs::{Command, Inputs};
use crate::kinematics::Kinematics;
use crate::law::{Damping, ElastoPlastic, HuntCrossley, Radial, SpeedLine, Stop, stribeck};
use crate::model::{ActuatorMode, Model};
use crate::tree::{DryFriction, Tree};
use crate::tuning::{
    BRAKING_SHARE, FRICTION_DEFLECTION, HELD, LEAST_FREE, LIMIT_DEFLECTION, LIMIT_REACH,
    MOTOR_RELAXATION, SERVO_DEFLECTION,
};

/// Effort of an actuator in effort mode.
pub fn effort(model: &Model, index: usize, command: &Command) -> f64 {
    let limit = model.actuators[index].max_effort;
    command.effort.clamp(-limit, limit)
}

/// What a joint term gives for a velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct JointResponse {
    /// N·m·s or N·s
    pub impulse: f64,
    /// Minus the derivative of the impulse with the velocity, never negative.
    pub stiffness: f64,
    /// Sum of the magnitudes in the impulse: what a balance of motor and limit is to be measured
    /// by.
    pub effort: f64,
}

/// Everything that acts along one degree of freedom in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct JointTerm {
    /// Degree of freedom.
    pub dof: usize,
    /// Place of its position in `q`; of a ball joint the first of four.
    pub coordinate: usize,
    /// Index of the actuator in the model's list, where there is one.
    pub actuator: Option<usize>,
    /// N·m·s/rad or N·s/m
    pub damping: f64,
    /// Dry friction; cap 0 without.
    pub dry: ElastoPlastic<f64>,
    /// See [`ElastoPlastic::wound`], rad/s or m/s; 0 where friction is not higher at rest.
    pub wound: f64,
    /// Distance to the lower and the upper limit; infinite without, rad or m.
    pub gap: [f64; 2],
    /// Law of the limits.
    pub limit: HuntCrossley,
    /// Actuator.
    pub drive: Drive,
    /// What the actuator's effort is at most.
    pub line: SpeedLine,
    /// Enforced speed limit, rad/s or m/s; infinite without.
    pub speed_limit: f64,
    /// Damping beyond it, N·m·s/rad or N·s/m.
    pub speed_damping: f64,
}

impl JointTerm {
    /// The actuator's force and its (never positive) derivative with the velocity `v` at the end of
    /// a step of `h` seconds.
    #[inline]
    pub fn drive_force(&self, v: f64, h: f64) -> (f64, f64) {
        if matches!(self.drive, Drive::None) {
            return (0.0, 0.0);
        }
        self.line.cut(self.drive.force(v, h), v)
    }

    /// Elastic displacement of a velocity motor after the step; 0 for other actuators.
    pub fn next_motor(&self, v: f64, h: f64) -> f64 {
        match self.drive {
            Drive::Velocity { target, element } => self.settled(target, element, v, h),
            _ => 0.0,
        }
    }

    /// Elastic displacement that a velocity motor remembers which yields at the end of a step: all
    /// that its effort can hold. What of it spring and damper share follows from the command at the
    /// start of the next step: a smaller one, which the joint has not reached either, then takes
    /// nothing from the effort. None where it does not yield.
    pub fn wound_motor(&self, v: f64, h: f64) -> Option<f64> {
        let Drive::Velocity { element, .. } = self.drive else {
            return None;
        };
        let (force, slope) = self.drive_force(v, h);
        (slope.abs() <= 0.0 && element.cap > 0.0).then(|| element.settle(-force, 0.0))
    }

    /// By how much the displacement of a velocity motor that yields at the start of a step with the
    /// velocity `v` differs, for each difference of that velocity: the time constant of its spring
    /// and damper, s. 0 if it does not yield.
    pub fn settling_time(&self, v: f64) -> f64 {
        match self.drive {
            Drive::Velocity { target, element } if element.yields(v - target) => {
                element.damping / element.stiffness
            }
            _ => 0.0,
        }
    }

    /// How fast the elastic displacement of a velocity motor changes where no steps are taken, at
    /// the velocity `v`; a released one forgets.
    ///
    /// - `motor`: stiffness and damping
    /// - `stored`: its displacement
    pub fn motor_rate(&self, motor: (f64, f64), stored: f64, v: f64) -> f64 {
        let (stiffness, damping) = motor;
        let (force, _) = self.drive_force(v, 0.0);
        (-force - stiffness * stored) / damping
    }

    /// The same of a velocity motor that need not be the term's own.
    fn settled(&self, target: f64, element: ElastoPlastic<f64>, v: f64, h: f64) -> f64 {
        let drive = Drive::Velocity { target, element };
        let (force, _) = self.line.cut(drive.force(v, h), v);
        element.settle(-force, v - target)
    }

    /// Speed beyond the limit, with its sign; 0 below it.
    #[inline]
    fn overspeed(&self, v: f64) -> f64 {
        v - v.clamp(-self.speed_limit, self.speed_limit)
    }

    /// Whether only implicit steps resolve what acts here, whatever the state; but for a pd law,
    /// which short steps resolve.
    pub fn is_stiff_beside_pd(&self) -> bool {
        let drive = self.drive.is_stiff() && !matches!(self.drive, Drive::Pd { .. });
        drive || self.dry.cap > 0.0 || self.speed_limit.is_finite()
    }

    /// Response to the velocity `v` at the end of a step of `h` seconds.
    #[inline]
    pub fn response(&self, v: f64, h: f64) -> JointResponse {
        let (force, slope) = self.drive_force(v, h);
        let resistance = self.damping * v;
        let mut r = JointResponse {
            impulse: h * (force - resistance),
            stiffness: h * (self.damping - slope),
            effort: h * (force.abs() + resistance.abs()),
        };
        if self.dry.cap > 0.0 {
            let dry = self.dry.respond(v, h);
            r.impulse -= h * dry.force;
            r.stiffness += h * dry.slope;
            r.effort += h * dry.force.abs();
        }
        if v.abs() > self.speed_limit {
            let overspeed = self.overspeed(v);
            let force = self.speed_damping * overspeed;
            r.impulse -= h * force;
            r.stiffness += h * self.speed_damping;
            r.effort += h * force.abs();
        }
        // Most joints do not come to a limit in a step.
        if self.gap.iter().all(|gap| *gap > h * v.abs()) {
            return r;
        }
        for ((impulse, stiffness), sign) in self.pushed_back(v, h).into_iter().zip([1.0, -1.0]) {
            r.impulse += sign * impulse;
            r.stiffness += stiffness;
            r.effort += impulse;
        }
        r
    }

    /// Force at the start of the step for the velocity `v`: the limit of `response / h` for small
    /// `h`, but that limits are a [`Stop`] made for `load`, N·m or N, where an integrator outside
    /// takes the steps.
    pub fn force(&self, v: f64, load: Option<f64>) -> f64 {
        let mut force = self.drive_force(v, 0.0).0 - self.damping * v;
        force -= self.speed_damping * self.overspeed(v);
        force -= self.dry.respond(v, 0.0).force;
        for (gap, sign) in [(self.gap[0], 1.0), (self.gap[1], -1.0)] {
            force += sign
                * match load {
                    Some(load) => Stop::new(load, self.limit).force(gap, sign * v),
                    None => self.limit.force(gap, sign * v),
                };
        }
        force
    }

    /// Whether each of the limits acts on what an integrator outside makes of the joint: its slope
    /// is not small beside that of a motor which holds the joint. What a servo holds at a limit
    /// passes it with every shock, and the integrator need not know.
    pub fn is_stopped(&self, load: f64) -> [bool; 2] {
        let stop = Stop::new(load, self.limit);
        self.gap.map(|gap| {
            let stiffness = stop.stiffness(gap);
            stiffness > 0.0 && stiffness > HELD * self.drive.stiffness()
        })
    }

    /// Moves the place from which it acts by `moved`, rad or m.
    pub(super) fn shift(&mut self, moved: f64) {
        self.gap[0] += moved;
        self.gap[1] -= moved;
        match &mut self.drive {
            Drive::Pd { offset, kp, .. } => *offset -= *kp * moved,
            Drive::Position { error, .. } => *error -= moved,
            Drive::None | Drive::Effort(_) | Drive::Velocity { .. } => {}
        }
    }

    /// By how much dry friction that slips at the end of a step of `h` seconds, with the velocity
    /// `v` there, is more than at that speed: a step has the friction of the speed at its start.
    pub fn late_friction(&self, tree: &Tree, v: f64, h: f64) -> f64 {
        let friction = &tree.dofs.friction[self.dof];
        if friction.at_rest <= friction.moving || self.dry.respond(v, h).slip == 0.0 {
            return 0.0;
        }
        self.dry.cap - cap(friction, self.dry.sliding(v, self.wound, h) * v)
    }

    /// What each of the limits gives at the end of a step of `h` seconds with the velocity `v`
    /// there, see [`HuntCrossley::respond`].
    #[inline]
    fn pushed_back(&self, v: f64, h: f64) -> [(f64, f64); 2] {
        let [lower, upper] = self.gap;
        [(lower, v), (upper, -v)].map(|(gap, v)| self.limit.respond(gap, v, h))
    }

    /// Size of both impulses that the one of a limit is the difference of, N·m·s or N·s: one by the
    /// gap, the other one by the velocity `v`. Where a step just reaches the limit, nothing but
    /// their round-off is left.
    pub fn opposed(&self, v: f64, h: f64) -> f64 {
        let [lower, upper] = self.pushed_back(v, h);
        (lower.1 + upper.1) * v.abs()
    }

    /// Whether each of the limits acts at the end of a step of `h` seconds with the velocity `v`
    /// there.
    pub fn at_limits(&self, v: f64, h: f64) -> [bool; 2] {
        self.pushed_back(v, h).map(|(impulse, _)| impulse > 0.0)
    }

    /// Whether a limit can act within `h` seconds at velocity `v`.
    pub fn near_limit(&self, v: f64, h: f64) -> bool {
        self.gap[0].min(self.gap[1]) < LIMIT_REACH.0 * h * v.abs() + LIMIT_REACH.1
    }
}

/// What the joint terms of a step are set up from.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// The robot.
    pub model: &'a Model,
    /// What follows from it and the parameters.
    pub tree: &'a Tree,
    /// Commands.
    pub inputs: &'a Inputs,
    /// Time since the communication point at which the step begins, and its length, s.
    pub times: [f64; 2],
    /// Time at which efforts count, s.
    pub effort: f64,
    /// Positions and velocities at its start.
    pub q: &'a [f64],
    /// See `q`.
    pub v: &'a [f64],
    /// What the terms have stored.
    pub memory: &'a Memory,
    /// Inverse inertia of each degree of freedom and bias, at the start.
    pub kin: &'a Kinematics,
    /// What motors in closed loops move and carry there.
    pub felt: &'a Felt,
}

impl JointTerm {
    /// What acts along those of the degrees of freedom that are of a joint, as far as it is the
    /// same in every step.
    pub(super) fn of(
        model: &Model,
        dofs: impl Iterator<Item = usize>,
    ) -> impl Iterator<Item = Self> {
        let of_joint = |dof: &usize| model.bodies[model.dofs[*dof].body.index()].joint.is_some();
        dofs.filter(of_joint).map(|dof| Self::new(model, dof))
    }

    /// The same along one.
    fn new(model: &Model, dof: usize) -> Self {
        Self {
            dof,
            coordinate: model.bodies[model.dofs[dof].body.index()].coordinate,
            actuator: model.actuators.iter().position(|a| a.dof.index() == dof),
            gap: [f64::INFINITY; 2],
            speed_limit: f64::INFINITY,
            ..Self::default()
        }
    }

    /// Sets it up for a step.
    pub(super) fn set(&mut self, s: &Start) {
        let (tree, dof) = (s.tree, self.dof);
        self.damping = tree.dofs.damping[dof];
        self.speed_limit = tree.dofs.speed_limit[dof];
        self.speed_damping = tree.dofs.speed_damping[dof];
        let (speed, sliding) = (s.v[dof].abs(), s.memory.sliding[dof]);
        self.dry = dry_friction(s, dof, sliding * speed);
        let friction = &tree.dofs.friction[dof];
        self.wound = if friction.at_rest > friction.moving {
            ElastoPlastic::<f64>::wound(speed, sliding)
        } else {
            0.0
        };
        if let Some(limits) = &tree.dofs.limits[dof] {
            let q = s.q[self.coordinate];
            self.gap = [q - limits.lower, limits.upper - q];
        }
        let depth = -self.gap[0].min(self.gap[1]);
        self.limit = HuntCrossley {
            stiffness: tree.dofs.limit_stiffness[dof],
            damping: Damping::leaving(tree.contact.dissipation, depth / LIMIT_DEFLECTION),
        };
        if let Some(index) = self.actuator {
            let (actuator, [t, h]) = (&s.model.actuators[index], s.times);
            let mut command = s.inputs.command(index, t, h);
            if s.inputs.varies() {
                command.effort = s.inputs.command(index, s.effort, 0.0).effort;
            }
            let stall = match actuator.mode {
                ActuatorMode::Effort => actuator.max_effort,
                _ => command.max_effort,
            };
            self.line = SpeedLine::new(stall, actuator.no_load_speed);
            self.drive = self.drive_for(s, index, &command);
        }
    }

    /// The drive that follows a command.
    fn drive_for(&self, s: &Start, index: usize, command: &Command) -> Drive {
        let (actuator, cap) = (&s.model.actuators[index], command.max_effort);
        let (q, v) = (s.q[self.coordinate], s.v[self.dof]);
        match actuator.mode {
            // A released motor does nothing, whatever it is told.
            ActuatorMode::Velocity | ActuatorMode::Position | ActuatorMode::Pd if cap <= 0.0 => {
                Drive::None
            }
            ActuatorMode::Effort => Drive::Effort(effort(s.model, index, command)),
            ActuatorMode::Velocity => {
                let (stiffness, mut damping) = s.tree.actuators.motors[index];
                if let Some([mass, _]) = s.felt.of(index) {
                    damping = damping.max(2.0 * (stiffness * mass).sqrt());
                }
                let mut element = ElastoPlastic {
                    cap,
                    stiffness,
                    damping,
                    displacement: s.memory.motor[index],
                    limit: Radial,
                };
                // Where the effort is too little, also because the command has just jumped, the
                // displacement is what a short step would make it: a long step, at whose end the
                // motor has its speed already, would not see the jump. What a varying command rises
                // by within the step is no jump.
                let now = s.inputs.command(index, s.times[0], 0.0).velocity;
                element.displacement = self.settled(now, element, v, 0.0);
                Drive::Velocity {
                    target: command.velocity,
                    element,
                }
            }
            ActuatorMode::Position => {
                let reference = actuator.reference_effort;
                let kp = reference / SERVO_DEFLECTION;
                let alone = [1.0 / s.kin.inverse_diagonal[self.dof], s.kin.bias[self.dof]];
                let [inertia, load] = s.felt.of(index).unwrap_or(alone);
                let gain = (2.0 * (kp * inertia).sqrt()).max(kp * MOTOR_RELAXATION);
                let free = (cap.min(reference) - load.abs()).max(LEAST_FREE * cap.min(reference));
                let joint = &s.model.joints[actuator.joint.index()];
                Drive::Position {
                    load,
                    error: command.position - q,
                    rate: command.rate,
                    gain,
                    slope: kp / gain,
                    braking: BRAKING_SHARE * free / inertia,
                    speed: joint.velocity.filter(|v| *v > 0.0).unwrap_or(f64::INFINITY),
                    cap,
                }
            }
            ActuatorMode::Pd => {
                let [kp, kd] = s.tree.actuators.gains[index];
                Drive::Pd {
                    offset: command.effort + kp * (command.position - q) + kd * command.velocity,
                    kp,
                    kd,
                    cap,
                }
            }
        }
    }
}

/// The force at which dry friction slips at the speed `v`.
fn cap(friction: &DryFriction, v: f64) -> f64 {
    if friction.at_rest > friction.moving {
        let reference = friction.stribeck_velocity;
        stribeck(friction.at_rest, friction.moving, v, reference)
    } else {
        friction.moving
    }
}

/// Dry friction of a degree of freedom that slips at `speed`, rad/s or m/s, at the start of a step.
fn dry_friction(s: &Start, dof: usize, speed: f64) -> ElastoPlastic<f64> {
    let friction = &s.tree.dofs.friction[dof];
    if friction.moving <= 0.0 {
        return ElastoPlastic::default();
    }
    let stiffness = friction.moving / FRICTION_DEFLECTION;
    ElastoPlastic {
        cap: cap(friction, speed),
        stiffness,
        damping: 2.0 * (stiffness * s.tree.dofs.inertia[dof]).sqrt(),
        displacement: s.memory.dry[dof],
        limit: Radial,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_cut_by_the_torque_speed_line_still_falls_with_the_velocity() {
        let mut random = crate::testing::Random(3);
        for _ in 0..200 {
            let mut term = JointTerm {
                line: SpeedLine {
                    stall: random.uniform(0.0, 10.0),
                    no_load: random.uniform(0.1, 20.0),
                },
                speed_limit: random.uniform(1.0, 20.0),
                speed_damping: random.uniform(0.0, 5.0),
                gap: [f64::INFINITY; 2],
                ..JointTerm::default()
            };
            term.drive = Drive::Pd {
                offset: random.uniform(-30.0, 30.0),
                kp: random.uniform(0.0, 100.0),
                kd: random.uniform(0.0, 2.0),
                cap: term.line.stall,
            };
            let h = libm::pow(10.0, random.uniform(-5.0, -1.0));
            let mut last = term.response(-30.0, h).impulse;
            for i in 1..=600 {
                let v = -30.0 + 0.1 * f64::from(i) + 1e-3;
                let r = term.response(v, h);
                assert!(r.impulse <= last + 1e-12, "{term:?} {v}");
                last = r.impulse;
                let d = 1e-7;
                let [ahead, behind] = [d, -d].map(|d| term.response(v + d, h).impulse);
                // Off the kinks, where the derivative jumps.
                let kinks = [0.0, term.speed_limit, term.line.no_load];
                if kinks.iter().all(|k| (v.abs() - k).abs() > 1e-3) {
                    let difference = (behind - ahead) / (2.0 * d);
                    let kink = (ahead + behind - 2.0 * r.impulse).abs() > 1e-9 * h;
                    assert!(
                        kink || (difference - r.stiffness).abs() < 1e-5 * (1.0 + r.stiffness),
                        "{term:?} {v}"
                    );
                }
            }
        }
    }
}
