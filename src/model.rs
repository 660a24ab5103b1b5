//! The world itself: a robot and what is around it, with links, joints, shapes, actuators and
//! defaults. It does not change after loading.
//!
//! A `Model` is prepared once at export (see `urdf/` and [`crate::assemble`]) and is all that the
//! FMU loads. Links and joints are the URDF's, fixed ones included. Bodies are the solver's: links
//! joined by fixed joints are one body; a planar or floating joint is a chain of bodies with one
//! kind of motion each. Parents come before children in all three lists.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod contacts;
mod id;
mod join;
mod joint_kind;
mod loops;
mod outputs;
mod root;
mod sensor;
mod validate;

use crate::geometry::Shape;
pub use crate::joint::Motion;
use crate::spatial::{Pose, RigidInertia, Vec3};
pub use id::{
    ActuatorId, BodyId, DofId, JointId, LinkId, LoopId, PairId, RootId, SensorId, SpringId, StateId,
};
pub use joint_kind::JointKind;
pub use loops::{Anchor, Loop, LoopKind, Share, Spring};
pub use outputs::{Arrays, ContactPair, Group, Interface, OutputSelection};
pub use root::{Root, RootKind};
pub use sensor::{Sampling, Sensor, SensorKind};
use serde::{Deserialize, Serialize};

/// A world of one robot or more, prepared for simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// The URDF's robot name.
    pub name: String,
    /// All links of the URDF, parents before children.
    pub links: Vec<Link>,
    /// All joints of the URDF, parents before children.
    pub joints: Vec<Joint>,
    /// Rigid bodies, parents before children; body 0 is the robot's base.
    pub bodies: Vec<Body>,
    /// The trees that the bodies make up, the robot's first. The links, joints, bodies and degrees
    /// of freedom of a tree come one after the other.
    pub roots: Vec<Root>,
    /// Independent degrees of freedom, parents before children; a floating base has the first six
    /// of its tree.
    pub dofs: Vec<Dof>,
    /// Length of `q`: 7 for a floating base, 4 for a spherical body, 1 for every other degree of
    /// freedom.
    pub nq: usize,
    /// Shapes that can touch the ground and each other.
    pub colliders: Vec<Collider>,
    /// Pairs of links that do not touch, the lower one first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub apart: Vec<[LinkId; 2]>,
    /// What closes loops.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loops: Vec<Loop>,
    /// Springs between two points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<Spring>,
    /// Commanded joints.
    pub actuators: Vec<Actuator>,
    /// Initial state of the joints; that of the bases is in [`Root`].
    pub initial: Initial,
    /// Step and tolerance.
    pub solver: SolverDefaults,
    /// Contact law.
    pub contact: ContactDefaults,
    /// Gravity and ground.
    pub world: World,
    /// What the FMU shows beyond what it always shows.
    pub outputs: OutputSelection,
}

/// A URDF link: a frame and the parts attached to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// The URDF's name.
    pub name: String,
    /// The joint that it hangs on; none for the root.
    pub joint: Option<JointId>,
    /// The body that it is part of.
    pub body: BodyId,
    /// Pose of the link in its body's frame.
    pub X_BL: Pose,
    /// As used by the solver, in the link's frame; [`RigidInertia::ZERO`] for a massless link.
    pub inertia: RigidInertia,
    /// Coulomb coefficient of its surface; combined with the ground's, see [`Combination`].
    pub friction: f64,
    /// Newton's coefficient of its surface; combined with the ground's, see [`Combination`].
    pub restitution: f64,
    /// Friction at rest over sliding friction, less 1: 0 where they are equal.
    pub static_excess: f64,
    /// Moment against rolling over normal force, m; combined with the ground's by the larger of the
    /// two.
    pub rolling_friction: f64,
    /// Moment against turning about the normal over normal force, m; combined likewise.
    pub torsional_friction: f64,
    /// Stiffness of its contact points, N/m, where it is not that of [`ContactDefaults`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Dissipation of its contact points where restitution is 0, s/m, where it is not that of
    /// [`ContactDefaults`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipation: Option<f64>,
}

/// A URDF joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// The URDF's name.
    pub name: String,
    /// The URDF's type.
    pub kind: JointKind,
    /// Parent link.
    pub parent: LinkId,
    /// Child link.
    pub child: LinkId,
    /// The URDF's `<origin>`: pose of the joint frame in the parent link's frame.
    pub X_PJ: Pose,
    /// Unit vector in the joint frame: axis of turning or sliding, normal of a planar joint.
    pub axis: Vec3,
    /// The bodies that make up its motion, in order: none for a fixed joint, one for a turning or
    /// sliding one, three for planar (x, y, angle), four for floating (x, y, z, spherical), one for
    /// spherical.
    pub bodies: Vec<BodyId>,
    /// The URDF's limits, for turning and sliding joints with `<limit>`, in rad or m.
    pub limits: Option<Limits>,
    /// The URDF's effort limit, N·m or N.
    pub effort: Option<f64>,
    /// The URDF's velocity limit, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Viscous damping, N·m·s/rad or N·s/m.
    pub damping: f64,
    /// Dry friction while it moves, N·m or N.
    pub friction: f64,
    /// Dry friction at rest over that while it moves, less 1: 0 where they are equal.
    pub static_excess: f64,
    /// Speed at which the friction has lost most of what it has more at rest, rad/s or m/s.
    pub stribeck_velocity: f64,
    /// Whether a damper keeps the joint from going faster than `velocity`; position servos do not
    /// anyway.
    pub enforce_velocity: bool,
    /// Rotor inertia times gear ratio squared, kg·m² or kg.
    pub armature: f64,
    /// Exact coupling to another joint.
    pub mimic: Option<Mimic>,
}

/// Range of a joint's position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// rad or m
    pub lower: f64,
    /// rad or m
    pub upper: f64,
}

/// `q = multiplier · q_joint + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mimic {
    /// The joint that is followed. Never itself a mimic: chains are resolved when the model is
    /// built.
    pub joint: JointId,
    /// Ratio.
    pub multiplier: f64,
    /// rad or m
    pub offset: f64,
}

/// A rigid body of the solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// The link whose frame is the body's; for the inner bodies of a planar or floating joint its
    /// child link.
    pub link: LinkId,
    /// None for the base.
    pub parent: Option<BodyId>,
    /// The URDF joint whose motion this body takes part in; none for the base.
    pub joint: Option<JointId>,
    /// How it moves in its parent.
    pub motion: Motion,
    /// Pose of the body at joint zero in its parent's frame. For the base: its pose in the world at
    /// zero.
    pub X_PB: Pose,
    /// First place in `q`: a 1-dof body reads `ratio · q[coordinate] + offset`.
    pub coordinate: usize,
    /// First place in `v`; a mimic body has the place of the joint that it follows.
    pub dof: DofId,
    /// 1, or the multiplier of a mimic joint.
    pub ratio: f64,
    /// 0, or the offset of a mimic joint.
    pub offset: f64,
}

/// An independent degree of freedom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dof {
    /// The body that it moves first (not its mimics).
    pub body: BodyId,
    /// Position limits: the joint's own, narrowed by those of the joints that mimic it.
    pub limits: Option<Limits>,
}

/// A shape on a link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Collider {
    /// The link that it belongs to.
    pub link: LinkId,
    /// The body that it moves with.
    pub body: BodyId,
    /// Pose of the shape in the body's frame.
    pub X_BG: Pose,
    /// Solid.
    pub shape: Shape,
}

/// A commanded joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// A turning or sliding joint that mimics nothing.
    pub joint: JointId,
    /// Its degree of freedom.
    pub dof: DofId,
    /// What is commanded.
    pub mode: ActuatorMode,
    /// Start value of the input `max_effort`, N·m or N; the stiffness of velocity and position
    /// servos follows from `reference_effort`, only the cap follows the input.
    pub max_effort: f64,
    /// N·m or N, above zero.
    pub reference_effort: f64,
    /// Start value of the tunable gain, pd mode only: N·m/rad or N/m.
    pub kp: f64,
    /// Start value of the tunable gain, pd mode only: N·m·s/rad or N·s/m.
    pub kd: f64,
    /// Speed at which the motor has no effort left, rad/s or m/s: towards it the effort limit falls
    /// in proportion while the motor drives, and stays what it is while it brakes. None: the limit
    /// does not depend on the speed.
    pub no_load_speed: Option<f64>,
}

/// What an actuator is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ActuatorMode {
    /// Reach and hold a velocity within an effort.
    Velocity,
    /// Reach and hold a position within an effort and the joint's velocity limit.
    Position,
    /// An effort, as it is.
    Effort,
    /// `effort + kp (position − q) + kd (velocity − q̇)`, clamped.
    Pd,
}

/// Initial state of the joints; that of the bases is in [`Root`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Initial {
    /// Per joint; meaningful for turning and sliding joints that mimic nothing, else 0.
    pub joint_positions: Vec<f64>,
    /// Per joint, as above.
    pub joint_velocities: Vec<f64>,
}

/// Step and tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverDefaults {
    /// s; 0 means error controlled.
    pub step_size: f64,
    /// Error allowed per step in m, and in rad at 1 m reach; 0 means: the importer's if given, else
    /// 1e-3.
    pub tolerance: f64,
    /// Most tries of a solver step in a communication step of up to a second, and in each second
    /// of a longer one.
    #[serde(default = "most_steps")]
    pub max_steps: f64,
}

/// [`crate::range::MOST_STEPS`], for models that do not say it.
fn most_steps() -> f64 {
    crate::range::MOST_STEPS
}

/// Contact law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactDefaults {
    /// Penetration, m, of which a flat face gives way by half under the robot's weight; the
    /// stiffness follows.
    pub penetration: f64,
    /// The weight over the depth of a contact under it, N/m; replaces `penetration` where given.
    pub stiffness: Option<f64>,
    /// Hunt–Crossley dissipation where restitution is 0, s/m.
    pub dissipation: f64,
    /// Sliding speed at which friction has lost most of what it has more at rest, m/s.
    pub stribeck_velocity: f64,
}

/// Gravity and ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// m/s²
    pub gravity: Vec3,
    /// How the friction and the restitution of a link and the ground are combined.
    pub combination: Combination,
    /// Drag `c` of every body, 1/s: the force `c m v (1 + |v|)` against the velocity of its centre
    /// of mass, and the torque `c I ω (1 + |ω|)` against its turning, with `v` in m/s and `ω` in
    /// rad/s. `PyBullet`'s; 0 for none.
    pub drag: f64,
    /// None: nothing to touch.
    pub ground: Option<Ground>,
}

/// How the surfaces of a link and the ground make one contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Combination {
    /// Friction by the harmonic mean, restitution by the larger of the two.
    #[default]
    Mean,
    /// Both by the product, as in `PyBullet`.
    Product,
}

/// The plane z = 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Coulomb coefficient.
    pub friction: f64,
    /// Newton's coefficient.
    pub restitution: f64,
    /// As [`Link::static_excess`].
    pub static_excess: f64,
    /// As [`Link::rolling_friction`].
    pub rolling_friction: f64,
    /// As [`Link::torsional_friction`].
    pub torsional_friction: f64,
}

/// Why a model cannot be computed with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Fields that contradict each other.
    #[error("{part} {wrong}")]
    Invalid {
        /// Which part.
        part: String,
        /// What is wrong with it.
        wrong: &'static str,
    },
}

impl Model {
    /// Whether the robot's base can move.
    pub fn is_floating(&self) -> bool {
        self.floats(RootId::ROBOT)
    }

    /// Whether the base of a tree can move.
    pub fn floats(&self, root: RootId) -> bool {
        self.base(root).motion.kind().is_free()
    }

    /// Whether the base of a tree moves as inputs say.
    pub fn is_driven(&self, root: RootId) -> bool {
        self.outputs.driven.contains(&root)
    }

    /// Whether forces can move a body: it moves, and not as inputs say.
    pub fn yields(&self, body: BodyId) -> bool {
        let root = self.root_of(body);
        let driven = self.is_driven(root) && self.roots[root.index()].body == body;
        self.bodies[body.index()].motion.kind().moves() && !driven
    }

    /// The tree of a body.
    pub fn root_of(&self, body: BodyId) -> RootId {
        let before = self.roots.partition_point(|root| root.body <= body);
        RootId::from(before.saturating_sub(1))
    }

    /// The base of a tree.
    pub fn base(&self, root: RootId) -> &Body {
        &self.bodies[self.roots[root.index()].body.index()]
    }

    /// Pose `X_BS` of the solver's frame of a body in the body's own: its z axis is the joint's
    /// axis, and that of a floating base stands in its centre of mass unless it is driven.
    #[cfg_attr(small, optimize(size))]
    pub fn solver_frame(&self, body: BodyId) -> Pose {
        let motion = self.bodies[body.index()].motion;
        Pose {
            R: motion.solver_frame(),
            p: if motion.kind().is_free() && !self.is_driven(self.root_of(body)) {
                self.center_of_mass(body)
            } else {
                Vec3::zeros()
            },
        }
    }

    /// Centre of mass of a body in its own frame, m, with the masses of the model, whatever the
    /// parameters make of them: a frame of the solver does not move; its origin if it has no mass.
    fn center_of_mass(&self, body: BodyId) -> Vec3 {
        let own = self.links.iter().filter(|link| link.body == body);
        let (mut mass, mut moment) = (0.0, Vec3::zeros());
        for link in own {
            mass += link.inertia.mass;
            moment += link.X_BL.point(&link.inertia.com) * link.inertia.mass;
        }
        if mass > 0.0 { moment / mass } else { moment }
    }

    /// Length of `v`.
    pub fn nv(&self) -> usize {
        self.dofs.len()
    }

    /// The first actuator of each one's group: itself for those in none.
    #[cfg_attr(small, optimize(size))]
    pub fn leaders(&self) -> Vec<usize> {
        let mut leaders: Vec<usize> = (0..self.actuators.len()).collect();
        for group in &self.outputs.groups {
            if let Some(first) = group.actuators.first() {
                for member in &group.actuators {
                    leaders[member.index()] = first.index();
                }
            }
        }
        leaders
    }

    /// The body of a turning or sliding joint; none for fixed, planar and floating ones.
    pub fn scalar_body(&self, joint: JointId) -> Option<BodyId> {
        let joint = &self.joints[joint.index()];
        match joint.kind {
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => {
                joint.bodies.first().copied()
            }
            JointKind::Fixed | JointKind::Planar | JointKind::Floating | JointKind::Spherical => {
                None
            }
        }
    }
}
