//! Inputs, parameters and outputs of a simulation: one name for each number, with units and axes.
//!
//! Names and value references for the outside are given by [`crate::variables`].

use crate::model::{
    ActuatorId, JointId, LinkId, LoopId, PairId, RootId, SensorId, SpringId, StateId,
};

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
    /// m/s, axes of the base of something that stands still: how fast its surface moves.
    SurfaceVelocity(RootId, Axis),
    /// m/s, world axes: how fast the origin of a driven base moves at the end of the next step.
    BaseLinearVelocity(RootId, Axis),
    /// rad/s, world axes: how fast it turns then.
    BaseAngularVelocity(RootId, Axis),
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
    InitialBasePosition(RootId, Axis),
    /// rad, fixed; roll, pitch, yaw.
    InitialBaseRpy(RootId, Axis),
    /// m/s, fixed.
    InitialBaseLinearVelocity(RootId, Axis),
    /// rad/s, fixed.
    InitialBaseAngularVelocity(RootId, Axis),
    /// rad or m, fixed; turning and sliding joints that mimic nothing.
    InitialJointPosition(JointId),
    /// rad/s or m/s, fixed.
    InitialJointVelocity(JointId),
    /// s, fixed; 0 means error controlled.
    StepSize,
    /// fixed; 0 means the importer's if given, else 1e-3.
    Tolerance,
    /// Most tries of a solver step in a communication step of up to a second, and in each second
    /// of a longer one.
    MaxSteps,
}

impl ParameterSlot {
    /// Whether it may change between steps; the others are fixed when initialisation ends.
    pub fn tunable(self) -> bool {
        match self {
            Self::Kp(_)
            | Self::Kd(_)
            | Self::JointDamping(_)
            | Self::JointFriction(_)
            | Self::LinkFriction(_)
            | Self::Gravity(_)
            | Self::GroundFriction
            | Self::GroundRestitution
            | Self::MaxSteps => true,
            Self::LinkMass(_)
            | Self::InitialBasePosition(..)
            | Self::InitialBaseRpy(..)
            | Self::InitialBaseLinearVelocity(..)
            | Self::InitialBaseAngularVelocity(..)
            | Self::InitialJointPosition(_)
            | Self::InitialJointVelocity(_)
            | Self::StepSize
            | Self::Tolerance => false,
        }
    }
}

/// A quantity that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputSlot {
    /// m, base link origin in the world.
    BasePosition(RootId, Axis),
    /// x, y, z, w.
    BaseOrientation(RootId, Axis),
    /// rad: roll, pitch, yaw.
    BaseRpy(RootId, Axis),
    /// m/s, of the base link origin.
    BaseLinearVelocity(RootId, Axis),
    /// rad/s, world axes.
    BaseAngularVelocity(RootId, Axis),
    /// rad or m. `Axis` is 0 for turning and sliding joints; x, y, angle of a planar one; x, y, z
    /// of a floating one.
    JointPosition(JointId, Axis),
    /// Orientation x, y, z, w of a spherical joint, or a floating one that is not the base.
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
    /// m, world: where the normal forces on the link act, or its origin where nothing touches.
    ContactPoint(LinkId, Axis),
    /// 1 or 0: whether the two sides of a pair press on each other.
    PairActive(PairId),
    /// N, on the first side by the second one, world, mean over the last communication step.
    PairForce(PairId, Axis),
    /// m, world: where the normal forces between the sides act, or the origin of a link of the
    /// first one where they do not touch.
    PairPoint(PairId, Axis),
    /// Mean direction of the normals from the second side into the first, weighted with the normal
    /// forces, world; 0 where they do not touch.
    PairNormal(PairId, Axis),
    /// m, the deepest overlap of the sides; 0 where they do not touch.
    PairDepth(PairId),
    /// m/s, how fast the sides slide on each other, weighted likewise.
    PairSlipSpeed(PairId),
    /// N, of a loop on its first link at this moment, world axes.
    LoopForce(LoopId, Axis),
    /// N·m, likewise, about the loop's end on that link.
    LoopTorque(LoopId, Axis),
    /// N·m or N, of a coupler along its sum.
    LoopEffort(LoopId),
    /// m, or rad of a coupler of turning joints: how far a loop is open.
    LoopGap(LoopId),
    /// N, of a spring on its first link at this moment, world axes.
    SpringForce(SpringId, Axis),
    /// m
    SpringLength(SpringId),
    /// J
    EnergyKinetic,
    /// J, of gravity, zero at world height 0.
    EnergyPotential,
    /// What a sensor measures.
    Sensor(SensorId, Sensed),
    /// A continuous state that is no other output.
    State(StateId),
    /// Derivative of a continuous state.
    Rate(StateId),
    /// How far from leaving is what touches, where an importer integrates; the event indicator.
    Indicator,
    /// Steps taken since the start.
    Steps,
    /// Steps rejected since the start.
    Rejected,
    /// Most Newton iterations in one solve since the start.
    NewtonMax,
}

/// A quantity that a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensed {
    /// x, y, z, w: orientation of the sensor's frame in the world.
    Orientation(Axis),
    /// rad/s, sensor axes.
    AngularVelocity(Axis),
    /// m/s², acceleration less gravity of the sensor's origin, sensor axes.
    Acceleration(Axis),
    /// N, that a joint's parent exerts on its child, sensor axes.
    Force(Axis),
    /// N·m, about the child's origin, likewise.
    Torque(Axis),
    /// m, to the first thing along a ray (0, 1, …), or the sensor's range.
    Distance(u32),
    /// What that thing is: 0 nothing, −1 the ground, else one more than the index of its link.
    Hit(u32),
    /// rad or m, of an encoder's joint, in whole steps.
    Position,
    /// rad/s or m/s, of an encoder: by how much its last two samples differ, per time.
    Velocity,
    /// N, sum of the normal forces on a contact sensor.
    NormalForce,
    /// m, sensor frame: where they act; 0 where nothing presses.
    Point(Axis),
    /// m, the deepest overlap there.
    Depth,
}

impl OutputSlot {
    /// Whether it says how the solver fares, or what it integrates: nothing that another model is
    /// connected to.
    pub fn local(self) -> bool {
        self.counts() || matches!(self, Self::State(_) | Self::Rate(_) | Self::Indicator)
    }

    /// Whether it is listed among the unknowns at the start.
    pub fn begins(self) -> bool {
        !self.counts() && self != Self::Indicator
    }

    /// Whether it says how the solver fares.
    pub fn counts(self) -> bool {
        matches!(self, Self::Steps | Self::Rejected | Self::NewtonMax)
    }
}
