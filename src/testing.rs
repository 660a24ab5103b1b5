//! Models built in code, and their simulation, for tests.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::model::{
    Actuator, ActuatorMode, Body, BodyId, Collider, Combination, ContactDefaults, Dof, DofId,
    Ground, Initial, Joint, JointId, JointKind, Limits, Link, LinkId, Mimic, Model, Motion,
    OutputSelection, Root, SolverDefaults, World,
};
use crate::simulation::Simulation;
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use std::sync::Arc;

// Its place is given because tests/acceptance takes this file by its path, too.
#[path = "testing/random.rs"]
pub mod random;

// Loops.
pub use random::Random;

impl Random {
    pub fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.uniform(-size, size))
    }

    pub fn unit(&mut self) -> Vec3 {
        (self.vector(1.0) + Vec3::new(1e-3, 0.0, 0.0)).normalize()
    }
}

/// Builds a model body by body.
pub struct Builder {
    pub model: Model,
}

impl Builder {
    /// A base with the given inertia; floating or fixed at the world's origin, gravity 9.81, no
    /// ground.
    pub fn new(floating: bool, inertia: RigidInertia) -> Self {
        let motion = if floating {
            Motion::Free
        } else {
            Motion::Welded
        };
        let mut model = Model {
            name: "test".into(),
            links: vec![link("base".into(), None, BodyId(0), inertia)],
            joints: Vec::new(),
            bodies: vec![Body {
                link: 0.into(),
                parent: None,
                joint: None,
                motion,
                X_PB: Pose::IDENTITY,
                coordinate: 0,
                dof: DofId(0),
                ratio: 1.0,
                offset: 0.0,
            }],
            dofs: Vec::new(),
            roots: vec![Root::new(String::new(), BodyId(0))],
            nq: motion.nq(),
            colliders: Vec::new(),
            apart: Vec::new(),
            loops: Vec::new(),
            springs: Vec::new(),
            actuators: Vec::new(),
            initial: Initial {
                joint_positions: Vec::new(),
                joint_velocities: Vec::new(),
            },
            solver: SolverDefaults {
                step_size: 0.0,
                tolerance: 0.0,
                max_steps: crate::range::MOST_STEPS,
            },
            contact: ContactDefaults {
                penetration: 1e-4,
                stiffness: None,
                dissipation: 51.0,
                stribeck_velocity: 0.01,
            },
            world: World {
                gravity: Vec3::new(0.0, 0.0, -9.81),
                combination: Combination::Mean,
                drag: 0.0,
                ground: None,
            },
            outputs: OutputSelection::default(),
        };
        for _ in 0..motion.nv() {
            model.dofs.push(Dof {
                body: 0.into(),
                limits: None,
            });
        }
        Self { model }
    }

    /// A link on a joint of one body; returns the link.
    pub fn link(
        &mut self,
        parent: LinkId,
        X: Pose,
        motion: Motion,
        inertia: RigidInertia,
    ) -> LinkId {
        let m = &mut self.model;
        let (link, joint) = (LinkId::from(m.links.len()), JointId::from(m.joints.len()));
        let body = m.bodies.len().into();
        let (kind, axis) = match motion {
            Motion::Revolute(axis) => (JointKind::Continuous, axis),
            Motion::Prismatic(axis) => (JointKind::Prismatic, axis),
            _ => (JointKind::Floating, Vec3::new(1.0, 0.0, 0.0)),
        };
        m.joints.push(Joint {
            name: format!("joint{}", joint.0),
            kind,
            parent,
            child: link,
            X_PJ: X,
            axis,
            bodies: vec![body],
            limits: None,
            effort: None,
            velocity: None,
            damping: 0.0,
            friction: 0.0,
            armature: 0.0,
            static_excess: 0.0,
            stribeck_velocity: 0.01,
            enforce_velocity: false,
            mimic: None,
        });
        m.links.push(self::link(
            format!("link{}", link.0),
            Some(joint),
            body,
            inertia,
        ));
        m.bodies.push(Body {
            link,
            parent: Some(m.links[parent.index()].body),
            joint: Some(joint),
            motion,
            X_PB: X,
            coordinate: m.nq,
            dof: m.dofs.len().into(),
            ratio: 1.0,
            offset: 0.0,
        });
        m.nq += motion.nq();
        for _ in 0..motion.nv() {
            m.dofs.push(Dof { body, limits: None });
        }
        m.initial.joint_positions.push(0.0);
        m.initial.joint_velocities.push(0.0);
        link
    }

    /// Makes the joint of `link` follow that of `source`; `link` must be the last one added.
    pub fn mimic(&mut self, link: LinkId, source: LinkId, ratio: f64, offset: f64) {
        let m = &mut self.model;
        let (target, follower) = (m.links[source.index()].body, m.links[link.index()].body);
        m.nq -= 1;
        m.dofs.pop();
        let (coordinate, dof) = (
            m.bodies[target.index()].coordinate,
            m.bodies[target.index()].dof,
        );
        let body = &mut m.bodies[follower.index()];
        (body.coordinate, body.dof, body.ratio, body.offset) = (coordinate, dof, ratio, offset);
        let joint = m.links[source.index()].joint.expect("not the base");
        let own = m.links[link.index()].joint.expect("not the base");
        m.joints[own.index()].mimic = Some(Mimic {
            joint,
            multiplier: ratio,
            offset,
        });
    }

    /// A shape on a link; gives the world a ground.
    pub fn shape(&mut self, link: LinkId, shape: Shape, X: Pose) {
        let m = &mut self.model;
        m.world.ground.get_or_insert(Ground {
            friction: 0.8,
            ..Ground::default()
        });
        let body = m.links[link.index()].body;
        m.colliders.push(Collider {
            link,
            body,
            X_BG: X,
            shape,
        });
    }

    /// An actuator on the joint of `link`.
    pub fn actuator(&mut self, link: LinkId, mode: ActuatorMode, max_effort: f64) {
        let m = &mut self.model;
        let joint = m.links[link.index()].joint.expect("not the base");
        let dof = m.bodies[m.links[link.index()].body.index()].dof;
        m.actuators.push(Actuator {
            joint,
            dof,
            mode,
            max_effort,
            reference_effort: if max_effort > 0.0 { max_effort } else { 1.0 },
            kp: 0.0,
            kd: 0.0,
            no_load_speed: None,
        });
    }

    /// Limits of the joint of `link`.
    pub fn limits(&mut self, link: LinkId, lower: f64, upper: f64) {
        let m = &mut self.model;
        let dof = m.bodies[m.links[link.index()].body.index()].dof;
        m.dofs[dof.index()].limits = Some(Limits { lower, upper });
    }
}

/// A link in its body's frame.
fn link(name: String, joint: Option<JointId>, body: BodyId, inertia: RigidInertia) -> Link {
    Link {
        name,
        joint,
        body,
        X_BL: Pose::IDENTITY,
        inertia,
        friction: 0.8,
        restitution: 0.0,
        static_excess: 0.0,
        rolling_friction: 0.0,
        torsional_friction: 0.0,
        stiffness: None,
        dissipation: None,
    }
}

/// A pose without turn, m.
pub fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose {
        p: Vec3::new(x, y, z),
        ..Pose::IDENTITY
    }
}

/// A running simulation with a tolerance.
pub fn start(mut model: Model, tolerance: f64) -> Simulation {
    model.solver.tolerance = tolerance;
    let mut simulation = Simulation::new(Arc::new(model));
    simulation.initialize(0.0).expect("a sound model");
    simulation
}

/// Advances to `end` in steps of about `h`, all of the same length.
pub fn run(simulation: &mut Simulation, end: f64, h: f64) {
    let begin = simulation.time();
    let count = ((end - begin) / h).round().max(1.0) as u64;
    for i in 1..=count {
        simulation
            .advance_to(begin + (end - begin) * (i as f64 / count as f64))
            .expect("finite");
    }
}

/// Inertia of a solid ball or box-like body.
pub fn inertia(mass: f64, com: Vec3, diagonal: [f64; 3]) -> RigidInertia {
    RigidInertia {
        mass,
        com,
        I_cm: Mat3::from_diagonal(&Vec3::from(diagonal)),
    }
}

/// A random tree of `n` moving bodies; every joint kind, masses within a factor of 100.
pub fn random_tree(random: &mut Random, n: usize, floating: bool, mimic: bool) -> Model {
    let body = |random: &mut Random| {
        let mass = libm::pow(10.0, random.uniform(-1.0, 1.0));
        let R = crate::spatial::rotation_from_rpy(&random.vector(3.0));
        let d: [f64; 3] = std::array::from_fn(|_| mass * random.uniform(0.02, 0.03));
        let I_cm = R * Mat3::from_diagonal(&Vec3::from(d)) * R.transpose();
        RigidInertia {
            mass,
            com: random.vector(0.2),
            I_cm: (I_cm + I_cm.transpose()) * 0.5,
        }
    };
    let base = body(random);
    let mut b = Builder::new(floating, base);
    for i in 0..n {
        let parent = LinkId::from((random.uniform(0.0, 1.0) * (i + 1) as f64) as usize);
        let X = Pose::from_xyz_rpy(random.vector(0.4), random.vector(3.0));
        let axis = random.unit();
        let motion = match i % 5 {
            0 | 1 => Motion::Revolute(axis),
            2 => Motion::Prismatic(axis),
            3 => Motion::Revolute(Vec3::new(0.0, 0.0, -1.0)),
            _ if mimic => Motion::Revolute(axis),
            _ => Motion::Spherical,
        };
        let inertia = body(random);
        let link = b.link(parent, X, motion, inertia);
        if mimic && i % 5 == 4 {
            b.mimic(link, LinkId::from(i - 3), -0.7, 0.3);
        }
    }
    b.model
}

/// Gives every link a shape of about 0.1 m: a ball, a cylinder, a box and a capsule in turn.
pub fn shape_all_links(model: &mut Model) {
    for (i, link) in model.links.iter().enumerate() {
        let shape = match i % 4 {
            0 => Shape::Sphere { radius: 0.1 },
            1 => Shape::Cylinder {
                radius: 0.08,
                half_length: 0.1,
            },
            2 => Shape::Box {
                half: Vec3::new(0.05, 0.1, 0.07),
            },
            _ => Shape::Capsule {
                radius: 0.05,
                half_length: 0.1,
            },
        };
        model.colliders.push(Collider {
            link: i.into(),
            body: link.body,
            X_BG: Pose::IDENTITY,
            shape,
        });
    }
}
