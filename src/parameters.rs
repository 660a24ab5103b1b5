//! What a user may set, and what the robot is commanded: flat lists of numbers with one index function each.
//!
//! What follows from the parameters (inertias, stiffness) is in [`crate::tree`].

use crate::model::Model;
use crate::simulation::{InputSlot, ParameterSlot};

/// Values of all parameters of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    actuators: usize,
    joints: usize,
    links: usize,
    /// In the order that `Self::index` gives.
    pub values: Vec<f64>,
}

impl Parameters {
    /// The model's defaults.
    pub fn new(model: &Model) -> Self {
        let mut p = Self {
            actuators: model.actuators.len(),
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
        p
    }

    fn index(&self, slot: ParameterSlot) -> usize {
        let joints = 2 * self.actuators;
        let links = joints + 4 * self.joints;
        let world = links + 2 * self.links;
        match slot {
            ParameterSlot::Kp(a) => a.index(),
            ParameterSlot::Kd(a) => self.actuators + a.index(),
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
        }
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

/// Values of all inputs of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    actuators: usize,
    /// Per link, its place among those with an external wrench.
    wrench: Vec<Option<u32>>,
    /// In the order that `Self::index` gives.
    pub values: Vec<f64>,
}

impl Inputs {
    /// Start values: positions as initialised, efforts as the model says, all else 0.
    pub fn new(model: &Model) -> Self {
        let n = model.actuators.len();
        let mut wrench = vec![None; model.links.len()];
        for (place, link) in (0..).zip(&model.outputs.external_wrenches) {
            wrench[link.index()] = Some(place);
        }
        let mut values = vec![0.0; n];
        values.extend(
            model
                .actuators
                .iter()
                .map(|a| model.initial.joint_positions[a.joint.index()]),
        );
        values.extend(std::iter::repeat_n(0.0, n));
        values.extend(model.actuators.iter().map(|a| a.max_effort));
        values.extend(std::iter::repeat_n(
            0.0,
            6 * model.outputs.external_wrenches.len(),
        ));
        Self {
            actuators: n,
            wrench,
            values,
        }
    }

    fn index(&self, slot: InputSlot) -> Option<usize> {
        let n = self.actuators;
        let wrench =
            |link: crate::model::LinkId| self.wrench[link.index()].map(|w| 4 * n + 6 * w as usize);
        match slot {
            InputSlot::Velocity(a) => Some(a.index()),
            InputSlot::Position(a) => Some(n + a.index()),
            InputSlot::Effort(a) => Some(2 * n + a.index()),
            InputSlot::MaxEffort(a) => Some(3 * n + a.index()),
            InputSlot::ExternalTorque(link, axis) => wrench(link).map(|w| w + axis as usize),
            InputSlot::ExternalForce(link, axis) => wrench(link).map(|w| w + 3 + axis as usize),
        }
    }

    /// Value of an input; 0 for the wrench of a link that has none.
    pub fn get(&self, slot: InputSlot) -> f64 {
        self.index(slot).map_or(0.0, |i| self.values[i])
    }

    /// Sets an input; ignored for the wrench of a link that has none.
    pub fn set(&mut self, slot: InputSlot, value: f64) {
        if let Some(index) = self.index(slot) {
            self.values[index] = value;
        }
    }

    /// Velocity, position, effort and effort limit commanded to actuator `a`.
    pub fn command(&self, a: usize) -> [f64; 4] {
        let n = self.actuators;
        [
            self.values[a],
            self.values[n + a],
            self.values[2 * n + a],
            self.values[3 * n + a],
        ]
    }

    /// Torque and force of the external wrench number `place`, world axes.
    pub fn wrench(&self, place: usize) -> [f64; 6] {
        let start = 4 * self.actuators + 6 * place;
        std::array::from_fn(|i| self.values[start + i])
    }
}
