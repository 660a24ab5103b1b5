//! A robot that runs: model, parameters, state and scratch in one place.
//!
//! Life of a simulation: [`Simulation::new`], set fixed parameters and inputs, [`Simulation::initialize`], then
//! set inputs and tunable parameters, [`Simulation::advance_to`], read outputs, and again.

use crate::model::{ActuatorId, JointId, LinkId, Model};
use std::sync::Arc;

/// x, y, z or w of a vector or quaternion: 0, 1, 2, 3.
pub type Axis = u8;

/// A quantity that the outside commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputSlot {
    /// rad/s or m/s; velocity and pd mode.
    Velocity(ActuatorId),
    /// rad or m; position and pd mode.
    Position(ActuatorId),
    /// N·m or N; effort and pd mode.
    Effort(ActuatorId),
    /// N·m or N, not negative; velocity, position and pd mode.
    MaxEffort(ActuatorId),
    /// N, world axes, at the link's centre of mass.
    ExternalForce(LinkId, Axis),
    /// N·m, world axes.
    ExternalTorque(LinkId, Axis),
}

/// A quantity that a user may set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterSlot {
    /// pd gain, N·m/rad or N/m.
    Kp(ActuatorId),
    /// pd gain, N·m·s/rad or N·s/m.
    Kd(ActuatorId),
    /// Viscous damping of a moving joint.
    JointDamping(JointId),
    /// Dry friction of a moving joint.
    JointFriction(JointId),
    /// Coulomb coefficient of a link's surface.
    LinkFriction(LinkId),
    /// m/s²
    Gravity(Axis),
    /// Coulomb coefficient of the ground.
    GroundFriction,
    /// Newton's coefficient of the ground.
    GroundRestitution,
    /// kg, fixed; the inertia scales with it.
    LinkMass(LinkId),
    /// m, fixed.
    InitialBasePosition(Axis),
    /// rad, fixed; roll, pitch, yaw.
    InitialBaseRpy(Axis),
    /// m/s, fixed.
    InitialBaseLinearVelocity(Axis),
    /// rad/s, fixed.
    InitialBaseAngularVelocity(Axis),
    /// rad or m, fixed; turning and sliding joints that mimic nothing.
    InitialJointPosition(JointId),
    /// rad/s or m/s, fixed.
    InitialJointVelocity(JointId),
    /// s, fixed; 0 means error controlled.
    StepSize,
    /// fixed; 0 means the importer's if given, else 1e-3.
    Tolerance,
}

impl ParameterSlot {
    /// Whether it may change between steps; the others are fixed when initialisation ends.
    pub fn tunable(self) -> bool {
        matches!(
            self,
            Self::Kp(_)
                | Self::Kd(_)
                | Self::JointDamping(_)
                | Self::JointFriction(_)
                | Self::LinkFriction(_)
                | Self::Gravity(_)
                | Self::GroundFriction
                | Self::GroundRestitution
        )
    }
}

/// A quantity that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputSlot {
    /// m, base link origin in the world.
    BasePosition(Axis),
    /// x, y, z, w.
    BaseOrientation(Axis),
    /// rad: roll, pitch, yaw.
    BaseRpy(Axis),
    /// m/s, of the base link origin.
    BaseLinearVelocity(Axis),
    /// rad/s, world axes.
    BaseAngularVelocity(Axis),
    /// rad or m. `Axis` is 0 for turning and sliding joints; x, y, angle of a planar one; x, y, z of a floating one.
    JointPosition(JointId, Axis),
    /// Orientation x, y, z, w of a floating joint that is not the base.
    JointOrientation(JointId, Axis),
    /// rad/s or m/s; axes as for the position; floating: 0–2 linear, 3–5 angular (child axes).
    JointVelocity(JointId, Axis),
    /// rad/s² or m/s²; axes as for the velocity.
    JointAcceleration(JointId, Axis),
    /// N·m or N, the actuator's alone; turning and sliding joints.
    JointEffort(JointId),
    /// m, link origin in the world.
    LinkPosition(LinkId, Axis),
    /// x, y, z, w.
    LinkOrientation(LinkId, Axis),
    /// m/s, of the link origin, world axes.
    LinkLinearVelocity(LinkId, Axis),
    /// rad/s, world axes.
    LinkAngularVelocity(LinkId, Axis),
    /// 1 or 0.
    ContactActive(LinkId),
    /// N, net contact force on the link, world, mean over the last communication step.
    ContactForce(LinkId, Axis),
    /// J
    EnergyKinetic,
    /// J, of gravity, zero at world height 0.
    EnergyPotential,
    /// Steps taken since the start.
    Steps,
    /// Steps rejected since the start.
    Rejected,
    /// Most Newton iterations in one solve since the start.
    NewtonMax,
}

/// A robot that runs.
#[derive(Debug)]
pub struct Simulation {
    model: Arc<Model>,
}

/// Everything that a later run needs to go on bit for bit; the workspace is not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {}

/// Why a simulation cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A value that cannot be set.
    #[error("{what} must be {expected}, not {value}")]
    Value {
        /// Which quantity.
        what: String,
        /// What would be legal.
        expected: &'static str,
        /// What came.
        value: f64,
    },
    /// The state is no longer finite.
    #[error("the state is not finite after t = {time} s; {hint}")]
    NotFinite {
        /// Last good time, s.
        time: f64,
        /// What to try.
        hint: &'static str,
    },
    /// Bytes that are not a saved state of this model.
    #[error("saved state refused: {reason}")]
    State {
        /// Why.
        reason: String,
    },
}

impl Simulation {
    /// A robot with its default parameters and initial state; call [`Self::initialize`] before the first step.
    pub fn new(model: Arc<Model>) -> Self {
        Self { model }
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Back to what [`Self::new`] gives.
    pub fn reset(&mut self) {}

    /// Sets the tolerance that applies where the parameter `Tolerance` is 0.
    pub fn set_importer_tolerance(&mut self, _tolerance: f64) {}

    /// Puts the robot into its initial state at time `start`, s, and derives what follows from the parameters.
    /// Before it, outputs follow parameters and inputs as set so far.
    ///
    /// # Errors
    /// [`SimulationError`] if parameters contradict each other.
    pub fn initialize(&mut self, _start: f64) -> Result<(), SimulationError> {
        Ok(())
    }

    /// Whether `value` may be set, without setting it.
    ///
    /// # Errors
    /// [`SimulationError::Value`].
    pub fn check_input(&self, _slot: InputSlot, _value: f64) -> Result<(), SimulationError> {
        Ok(())
    }

    /// Sets an input; `value` has passed [`Self::check_input`].
    pub fn set_input(&mut self, _slot: InputSlot, _value: f64) {}

    /// Reads an input back.
    pub fn input(&self, _slot: InputSlot) -> f64 {
        0.0
    }

    /// Whether `value` may be set, without setting it.
    ///
    /// # Errors
    /// [`SimulationError::Value`].
    pub fn check_parameter(
        &self,
        _slot: ParameterSlot,
        _value: f64,
    ) -> Result<(), SimulationError> {
        Ok(())
    }

    /// Sets a parameter; `value` has passed [`Self::check_parameter`]. Fixed ones only before [`Self::initialize`].
    pub fn set_parameter(&mut self, _slot: ParameterSlot, _value: f64) {}

    /// Reads a parameter back.
    pub fn parameter(&self, _slot: ParameterSlot) -> f64 {
        0.0
    }

    /// Reads an output; the first read after a change computes what is needed.
    pub fn output(&mut self, _slot: OutputSlot) -> f64 {
        0.0
    }

    /// Simulates up to exactly `end`, s; it must lie after [`Self::time`].
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`]; the state is then that of [`Self::time`].
    pub fn advance_to(&mut self, _end: f64) -> Result<(), SimulationError> {
        Ok(())
    }

    /// Current time, s.
    pub fn time(&self) -> f64 {
        0.0
    }

    /// Copies everything that a later run needs.
    pub fn save(&self) -> Snapshot {
        Snapshot {}
    }

    /// Overwrites `snapshot` without allocating.
    pub fn save_into(&self, _snapshot: &mut Snapshot) {}

    /// Continues from `snapshot`, bit for bit.
    ///
    /// # Errors
    /// [`SimulationError::State`] if it belongs to another model.
    pub fn restore(&mut self, _snapshot: &Snapshot) -> Result<(), SimulationError> {
        Ok(())
    }
}

impl Snapshot {
    /// Little-endian bytes with magic, version and a hash of the model.
    pub fn to_bytes(&self) -> Vec<u8> {
        Vec::new()
    }

    /// Length of [`Self::to_bytes`].
    pub fn byte_len(&self) -> usize {
        0
    }

    /// Reads what [`Self::to_bytes`] wrote for the same model.
    ///
    /// # Errors
    /// [`SimulationError::State`] for anything else.
    pub fn from_bytes(_model: &Model, _bytes: &[u8]) -> Result<Self, SimulationError> {
        Ok(Self {})
    }
}
