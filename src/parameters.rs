//! Parameters, which a user may set: a flat list of numbers with one index function.
//!
//! What follows from the parameters (inertias, stiffness) is in [`crate::tree`]; commands are in
//! [`crate::inputs`].

use crate::model::{ActuatorId, JointId, LinkId, Model, RootId};
use crate::range::Range;
use crate::slots::{Axis, ParameterSlot};
use crate::spatial::Vec3;

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
            Self::InitialBasePosition(..)
            | Self::InitialBaseRpy(..)
            | Self::InitialJointPosition(_) => Range::Position,
            Self::InitialJointVelocity(_) => Range::Velocity,
            Self::InitialBaseLinearVelocity(..) => Range::Flight,
            Self::InitialBaseAngularVelocity(..) => Range::Spin,
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
    /// Number of trees.
    roots: usize,
    /// In the order that `Self::index` gives.
    pub values: Vec<f64>,
}

impl Parameters {
    /// The model's defaults.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let mut p = Self {
            actuators: model.actuators.len(),
            leader: model.leaders(),
            joints: model.joints.len(),
            links: model.links.len(),
            roots: model.roots.len(),
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
        v.extend(model.roots.iter().flat_map(|r| r.position.iter()));
        v.extend(model.roots.iter().flat_map(|r| r.rpy.iter()));
        v.extend(model.roots.iter().flat_map(|r| r.linear_velocity.iter()));
        v.extend(model.roots.iter().flat_map(|r| r.angular_velocity.iter()));
        v.extend(model.world.gravity.iter());
        let ground = model.world.ground.as_ref();
        v.push(ground.map_or(0.0, |g| g.friction));
        v.push(ground.map_or(0.0, |g| g.restitution));
        v.push(model.solver.step_size);
        v.push(model.solver.tolerance);
        v.push(model.solver.max_steps);
        p
    }

    #[cfg_attr(small, optimize(size))]
    fn index(&self, slot: ParameterSlot) -> usize {
        let joints = 2 * self.actuators;
        let links = joints + 4 * self.joints;
        let roots = links + 2 * self.links;
        let world = roots + 12 * self.roots;
        let of_base = |kind: usize, root: RootId, axis: u8| {
            roots + 3 * (kind * self.roots + root.index()) + axis as usize
        };
        match slot {
            ParameterSlot::Kp(a) => self.leader[a.index()],
            ParameterSlot::Kd(a) => self.actuators + self.leader[a.index()],
            ParameterSlot::JointDamping(j) => joints + j.index(),
            ParameterSlot::JointFriction(j) => joints + self.joints + j.index(),
            ParameterSlot::InitialJointPosition(j) => joints + 2 * self.joints + j.index(),
            ParameterSlot::InitialJointVelocity(j) => joints + 3 * self.joints + j.index(),
            ParameterSlot::LinkFriction(l) => links + l.index(),
            ParameterSlot::LinkMass(l) => links + self.links + l.index(),
            ParameterSlot::InitialBasePosition(root, axis) => of_base(0, root, axis),
            ParameterSlot::InitialBaseRpy(root, axis) => of_base(1, root, axis),
            ParameterSlot::InitialBaseLinearVelocity(root, axis) => of_base(2, root, axis),
            ParameterSlot::InitialBaseAngularVelocity(root, axis) => of_base(3, root, axis),
            ParameterSlot::Gravity(axis) => world + axis as usize,
            ParameterSlot::GroundFriction => world + 3,
            ParameterSlot::GroundRestitution => world + 4,
            ParameterSlot::StepSize => world + 5,
            ParameterSlot::Tolerance => world + 6,
            ParameterSlot::MaxSteps => world + 7,
        }
    }

    /// Whether `values` are what the parameters, with the model's defaults now, may be set to. A
    /// default may lie outside of its range: a link without mass is one, but nobody can take a
    /// link's mass away.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn allow(&self, values: &[f64]) -> bool {
        use ParameterSlot as P;
        let (actuator, joint, link) = (ActuatorId::from(0), JointId::from(0), LinkId::from(0));
        let root = RootId::from(0);
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
            (3 * self.roots, P::InitialBasePosition(root, 0)),
            (3 * self.roots, P::InitialBaseRpy(root, 0)),
            (3 * self.roots, P::InitialBaseLinearVelocity(root, 0)),
            (3 * self.roots, P::InitialBaseAngularVelocity(root, 0)),
            (3, P::Gravity(0)),
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

    /// The three values of a slot for the base of a tree.
    pub fn of_base(&self, slot: fn(RootId, Axis) -> ParameterSlot, root: RootId) -> Vec3 {
        Vec3::new(
            self.get(slot(root, 0)),
            self.get(slot(root, 1)),
            self.get(slot(root, 2)),
        )
    }

    /// Sets a parameter; ranges are [`crate::simulation::Simulation::check_parameter`]'s business.
    pub fn set(&mut self, slot: ParameterSlot, value: f64) {
        let index = self.index(slot);
        self.values[index] = value;
    }
}
