//! Parameters, which a user may set: a flat list of numbers with one index function.
//!
//! What follows from the parameters (inertias, stiffness) is in [`crate::tree`]; commands are in
//! [`crate::inputs`].

use crate::model::{ActuatorId, JointId, LinkId, Model};
use crate::range::Range;
use crate::slots::ParameterSlot;

impl ParameterSlot {
    /// What its value may be.
    pub(crate) fn range(self) -> Range {
        match self {
            Self::Kp(_) | Self::Kd(_) | Self::JointDamping(_) | Self::JointFriction(_) => {
                Range::Coefficient
            }
            Self::LinkFriction(_) | Self::GroundFriction => Range::Friction,
            Self::GroundRestitution => Range::Restitution,
            Self::LinkMass(_) => Range::Mass,
            Self::Gravity(_) => Range::Gravity,
            Self::InitialBasePosition(_)
            | Self::InitialBaseRpy(_)
            | Self::InitialJointPosition(_) => Range::Position,
            Self::InitialJointVelocity(_) => Range::Velocity,
            Self::InitialBaseLinearVelocity(_) => Range::Flight,
            Self::InitialBaseAngularVelocity(_) => Range::Spin,
            Self::StepSize => Range::Step,
            Self::Tolerance => Range::ToleranceOrNone,
            Self::MaxSteps => Range::Work,
        }
    }
}

/// Values of all parameters of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Number of actuators.
    actuators: usize,
    /// Per actuator, the one whose gains it has: the first of its group, or itself.
    leader: Vec<usize>,
    /// Number of joints.
    joints: usize,
    /// Number of links.
    links: usize,
    /// In the order that `Self::index` gives.
    pub values: Vec<f64>,
}

impl Parameters {
    /// The model's defaults.
    pub fn new(model: &Model) -> Self {
        let mut p = Self {
            actuators: model.actuators.len(),
            leader: model.leaders(),
            joints: model.joints.len(),
            links: model.links.len(),
            values: Vec::new(),
        };
        let v = &mut p.values;
        v.extend(model.actuators.iter().map(|a| a.kp));
        v.extend(model.actuators.iter().map(|a| a.kd));
        v.extend(model.joints.iter().map(|j| j.damping));
        v.extend(model.joints.iter().map(|j| j.friction));
        v.extend(&model.initial.joint_positions);
        v.extend(&model.initial.joint_velocities);
        v.extend(model.links.iter().map(|l| l.friction));
        v.extend(model.links.iter().map(|l| l.inertia.mass));
        v.extend(model.world.gravity.iter());
        v.extend(model.initial.position.iter());
        v.extend(model.initial.rpy.iter());
        v.extend(model.initial.linear_velocity.iter());
        v.extend(model.initial.angular_velocity.iter());
        let ground = model.world.ground.as_ref();
        v.push(ground.map_or(0.0, |g| g.friction));
        v.push(ground.map_or(0.0, |g| g.restitution));
        v.push(model.solver.step_size);
        v.push(model.solver.tolerance);
        v.push(model.solver.max_steps);
        p
    }

    fn index(&self, slot: ParameterSlot) -> usize {
        let joints = 2 * self.actuators;
        let links = joints + 4 * self.joints;
        let world = links + 2 * self.links;
        match slot {
            ParameterSlot::Kp(a) => self.leader[a.index()],
            ParameterSlot::Kd(a) => self.actuators + self.leader[a.index()],
            ParameterSlot::JointDamping(j) => joints + j.index(),
            ParameterSlot::JointFriction(j) => joints + self.joints + j.index(),
            ParameterSlot::InitialJointPosition(j) => joints + 2 * self.joints + j.index(),
            ParameterSlot::InitialJointVelocity(j) => joints + 3 * self.joints + j.index(),
            ParameterSlot::LinkFriction(l) => links + l.index(),
            ParameterSlot::LinkMass(l) => links + self.links + l.index(),
            ParameterSlot::Gravity(axis) => world + axis as usize,
            ParameterSlot::InitialBasePosition(axis) => world + 3 + axis as usize,
            ParameterSlot::InitialBaseRpy(axis) => world + 6 + axis as usize,
            ParameterSlot::InitialBaseLinearVelocity(axis) => world + 9 + axis as usize,
            ParameterSlot::InitialBaseAngularVelocity(axis) => world + 12 + axis as usize,
            ParameterSlot::GroundFriction => world + 15,
            ParameterSlot::GroundRestitution => world + 16,
            ParameterSlot::StepSize => world + 17,
            ParameterSlot::Tolerance => world + 18,
            ParameterSlot::MaxSteps => world + 19,
        }
    }

    /// Whether `values` are what the parameters, with the model's defaults now, may be set to. A
    /// default may lie outside of its range: a link without mass is one, but nobody can take a
    /// link's mass away.
    pub(crate) fn allow(&self, values: &[f64]) -> bool {
        use ParameterSlot as P;
        let (actuator, joint, link) = (ActuatorId::from(0), JointId::from(0), LinkId::from(0));
        // One of each kind stands for all of them.
        let lists = [
            (self.actuators, P::Kp(actuator)),
            (self.actuators, P::Kd(actuator)),
            (self.joints, P::JointDamping(joint)),
            (self.joints, P::JointFriction(joint)),
            (self.joints, P::InitialJointPosition(joint)),
            (self.joints, P::InitialJointVelocity(joint)),
            (self.links, P::LinkFriction(link)),
            (self.links, P::LinkMass(link)),
            (3, P::Gravity(0)),
            (3, P::InitialBasePosition(0)),
            (3, P::InitialBaseRpy(0)),
            (3, P::InitialBaseLinearVelocity(0)),
            (3, P::InitialBaseAngularVelocity(0)),
            (1, P::GroundFriction),
            (1, P::GroundRestitution),
            (1, P::StepSize),
            (1, P::Tolerance),
            (1, P::MaxSteps),
        ];
        let all: usize = lists.iter().map(|(count, _)| count).sum();
        debug_assert_eq!(all, self.values.len());
        let ranges = lists
            .into_iter()
            .flat_map(|(count, slot)| std::iter::repeat_n(slot.range(), count));
        ranges
            .zip(values.iter().zip(&self.values))
            .all(|(range, (value, default))| {
                range.contains(*value) || value.to_bits() == default.to_bits()
            })
    }

    /// Value of a parameter.
    pub fn get(&self, slot: ParameterSlot) -> f64 {
        self.values[self.index(slot)]
    }

    /// Sets a parameter; ranges are [`crate::simulation::Simulation::check_parameter`]'s business.
    pub fn set(&mut self, slot: ParameterSlot, value: f64) {
        let index = self.index(slot);
        self.values[index] = value;
    }
}
