//! What follows from a model and its parameters: the tree that the solver walks, its inertias, stiffness and scales.
//!
//! Body frames are turned so that every turning or sliding joint acts along its own z axis; nothing outside the
//! solver sees these frames. One entry per body degree of freedom ("column"): a mimic joint's column is scaled by its
//! ratio and belongs to the degree of freedom that it follows. What depends on the initial position is in `scale`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod scale;

pub use scale::LIMIT_DEFLECTION;

use crate::joint::Kind;
use crate::model::{Combination, Joint, Limits, Model};
use crate::parameters::Parameters;
use crate::slots::ParameterSlot as P;
use crate::sparsity::Sparsity;
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3, rotation_from_rpy};

/// A body as the solver sees it.
#[derive(Clone, Debug)]
pub struct TreeBody {
    /// Index of the parent; the base points to itself.
    pub parent: usize,
    /// How it moves in its parent.
    pub kind: Kind,
    /// Pose at joint zero in the parent's solver frame.
    pub X: Pose,
    /// First column.
    pub column: usize,
    /// Number of columns.
    pub columns: usize,
    /// First place in `q`.
    pub coordinate: usize,
    /// First place in `v`.
    pub dof: usize,
    /// Ratio of a mimic joint, else 1.
    pub ratio: f64,
    /// Offset of a mimic joint, else 0.
    pub offset: f64,
    /// kg
    pub mass: f64,
    /// Centre of mass in the solver frame, m.
    pub com: Vec3,
    /// Inertia about the centre of mass in the solver frame: xx, yy, zz, xy, xz, yz, kg·m².
    pub I_cm: [f64; 6],
}

/// A collision shape as the solver sees it.
#[derive(Clone, Debug)]
pub struct TreeCollider {
    /// Index of the body.
    pub body: usize,
    /// Index of the link.
    pub link: usize,
    /// Pose in the body's solver frame.
    pub X: Pose,
    /// Radius of a ball about `X.p` that holds the shape, m.
    pub radius: f64,
    /// Combined Coulomb coefficient with the ground, sliding.
    pub mu: f64,
    /// The same at rest, not below.
    pub mu_at_rest: f64,
    /// Combined coefficient of restitution with the ground.
    pub restitution: f64,
    /// Hunt–Crossley dissipation times approach speed for that restitution.
    pub dissipation_number: f64,
    /// Hunt–Crossley dissipation without restitution, s/m.
    pub dissipation: f64,
    /// Stiffness of a point, N/m.
    pub stiffness: f64,
    /// Penetration under the robot's weight on four such points, m.
    pub penetration: f64,
}

/// Dry friction of a degree of freedom.
#[derive(Clone, Copy, Debug, Default)]
pub struct DryFriction {
    /// Far above the Stribeck speed, N·m or N.
    pub moving: f64,
    /// At rest, not below.
    pub at_rest: f64,
    /// Stribeck speed, rad/s or m/s; 0 without friction.
    pub stribeck_velocity: f64,
}

impl DryFriction {
    /// Adds that of a joint which moves `ratio` times as fast.
    fn add(&mut self, joint: &Joint, friction: f64, ratio: f64) {
        self.moving += friction * ratio;
        self.at_rest += friction * ratio * (1.0 + joint.static_excess);
        if friction * ratio > 0.0 {
            let own = joint.stribeck_velocity / ratio;
            self.stribeck_velocity = self.stribeck_velocity.max(own);
        }
    }
}

/// What all contacts of a link have in common against turning.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turning {
    /// Combined torsional and rolling friction with the ground, m.
    pub coefficient: [f64; 2],
    /// Inertia that the damping is critical for, kg·m².
    pub inertia: f64,
    /// As [`TreeCollider::stiffness`].
    pub stiffness: f64,
    /// As [`TreeCollider::penetration`].
    pub penetration: f64,
}

impl Turning {
    /// Whether there is any.
    pub fn acts(&self) -> bool {
        self.coefficient[0] > 0.0 || self.coefficient[1] > 0.0
    }
}

/// Everything that follows from a model and its parameters and is constant in a step.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Parents before children.
    pub bodies: Vec<TreeBody>,
    /// Degree of freedom of each column.
    pub dof: Vec<usize>,
    /// Pattern of the joint-space matrix.
    pub sparsity: Sparsity,
    /// Whether every column is its own degree of freedom.
    pub pure: bool,
    /// Whether the articulated-body algorithm is cheaper than mass matrix and factor: chains of many joints.
    pub long: bool,
    /// Pose of each link in its body's solver frame.
    pub link_pose: Vec<Pose>,
    /// Pose of a fixed base in the world.
    pub base: Pose,
    /// Shapes on moving bodies, and the ground's plane z = 0 to touch; empty without a ground.
    pub colliders: Vec<TreeCollider>,
    /// Index of each entry of `colliders` in the model's list.
    pub collider_index: Vec<usize>,
    /// Friction against turning of each link's contacts.
    pub turning: Vec<Turning>,
    /// Whether any of them has some.
    pub resists_turning: bool,
    /// Which bodies are wheels: they carry nothing and are even about their joint's axis.
    pub wheel: Vec<bool>,
    /// m/s²
    pub gravity: Vec3,
    /// As [`crate::model::World::drag`], 1/s.
    pub drag: f64,
    /// Mass of all moving bodies, kg.
    pub moving_mass: f64,
    /// Contact stiffness of a point of a link that has none of its own, N/m.
    pub stiffness: f64,
    /// Dissipation of its contacts without restitution, and of joint limits, s/m.
    pub dissipation: f64,
    /// Sliding speed at which friction has lost most of what it has more at rest, m/s.
    pub stribeck_velocity: f64,
    /// Static penetration that the stiffness stands for, m.
    pub penetration: f64,
    /// Rotor inertia per degree of freedom.
    pub armature: Vec<f64>,
    /// Viscous damping per degree of freedom.
    pub damping: Vec<f64>,
    /// Dry friction per degree of freedom, at rest and far above the Stribeck speed, and that speed.
    pub friction: Vec<DryFriction>,
    /// Enforced speed limit per degree of freedom, rad/s or m/s; infinite without.
    pub speed_limit: Vec<f64>,
    /// Damping beyond the speed limit per degree of freedom, N·m·s/rad or N·s/m.
    pub speed_damping: Vec<f64>,
    /// Position limits per degree of freedom.
    pub limits: Vec<Option<Limits>>,
    /// Diagonal of the mass matrix at the initial position, per degree of freedom.
    pub inertia: Vec<f64>,
    /// Stiffness of the position limits per degree of freedom, N·m/rad or N/m.
    pub limit_stiffness: Vec<f64>,
    /// Stiffness and damping of each actuator as a velocity motor.
    pub motors: Vec<(f64, f64)>,
    /// Gains kp (N·m/rad or N/m) and kd (N·m·s/rad or N·s/m) of each actuator.
    pub gains: Vec<[f64; 2]>,
    /// Weight of an error in each degree of freedom, 1 at one metre or at one radian of a metre's reach.
    pub weight: Vec<f64>,
    /// Largest extent of the robot from its base, m.
    pub reach: f64,
}

/// Standard gravity, m/s²: gives the weight that contact stiffness is made from, whatever the tunable gravity is.
pub const REFERENCE_GRAVITY: f64 = 9.81;

/// Multiplications per body that the articulated-body algorithm needs beyond the mass matrix' own, measured where
/// both cost the same.
const ARTICULATED_COST: usize = 150;

/// Unevenness of a wheel, as a share of its inertia, that makes no difference.
const WHEEL: f64 = 0.02;

impl Tree {
    /// Derives the tree; masses, mounting and initial pose come from `parameters`.
    pub fn new(model: &Model, parameters: &Parameters) -> Self {
        let axes = |slot: fn(u8) -> P| {
            Vec3::new(
                parameters.get(slot(0)),
                parameters.get(slot(1)),
                parameters.get(slot(2)),
            )
        };
        let mut tree = Self {
            bodies: Vec::with_capacity(model.bodies.len()),
            dof: Vec::new(),
            sparsity: Sparsity::default(),
            pure: true,
            long: false,
            link_pose: Vec::new(),
            base: Pose {
                R: rotation_from_rpy(&axes(P::InitialBaseRpy)),
                p: axes(P::InitialBasePosition),
            },
            colliders: Vec::new(),
            collider_index: Vec::new(),
            turning: vec![Turning::default(); model.links.len()],
            resists_turning: false,
            wheel: Vec::new(),
            gravity: Vec3::zeros(),
            drag: model.world.drag,
            moving_mass: 0.0,
            stiffness: 0.0,
            dissipation: model.contact.dissipation,
            stribeck_velocity: model.contact.stribeck_velocity,
            penetration: model.contact.penetration,
            armature: vec![0.0; model.nv()],
            damping: vec![0.0; model.nv()],
            friction: vec![DryFriction::default(); model.nv()],
            speed_limit: vec![f64::INFINITY; model.nv()],
            speed_damping: vec![0.0; model.nv()],
            limits: model.dofs.iter().map(|d| d.limits).collect(),
            inertia: vec![0.0; model.nv()],
            limit_stiffness: vec![0.0; model.nv()],
            motors: vec![(0.0, 0.0); model.actuators.len()],
            gains: vec![[0.0; 2]; model.actuators.len()],
            weight: vec![1.0; model.nv()],
            reach: 0.0,
        };
        let turned = tree.add_bodies(model);
        tree.add_inertia(model, parameters, &turned);
        tree.wheel = (0..tree.bodies.len()).map(|b| tree.is_wheel(b)).collect();
        tree.add_colliders(model, &turned);
        tree.sparsity = tree.pattern(model.nv());
        tree.long = tree.pure && tree.sparsity.factor_cost() > ARTICULATED_COST * tree.bodies.len();
        for joint in &model.joints {
            for body in &joint.bodies {
                let body = &tree.bodies[body.index()];
                for c in body.column..body.column + body.columns {
                    let dof = tree.dof[c];
                    tree.armature[dof] += joint.armature * body.ratio * body.ratio;
                    if let Some(limit) = joint.velocity.filter(|_| joint.enforce_velocity) {
                        let limit = limit / body.ratio.abs();
                        tree.speed_limit[dof] = tree.speed_limit[dof].min(limit);
                    }
                }
            }
        }
        tree.tune(model, parameters);
        tree
    }

    /// Bodies with their poses; returns the rotation of each solver frame in the model's body frame.
    fn add_bodies(&mut self, model: &Model) -> Vec<Mat3> {
        let mut turned = Vec::with_capacity(model.bodies.len());
        for body in &model.bodies {
            let R_BS = body.motion.solver_frame();
            let parent = body.parent.map_or(0, super::model::BodyId::index);
            let R_PS: Mat3 = body.parent.map_or(Mat3::identity(), |p| turned[p.index()]);
            let column = self.dof.len();
            let columns = body.motion.nv();
            self.dof.extend((0..columns).map(|i| body.dof.index() + i));
            self.pure &= self.dof[column..]
                .iter()
                .enumerate()
                .all(|(i, &d)| d == column + i);
            self.bodies.push(TreeBody {
                parent,
                kind: body.motion.kind(),
                X: Pose {
                    R: R_PS.transpose() * body.X_PB.R * R_BS,
                    p: R_PS.transpose() * body.X_PB.p,
                },
                column,
                columns,
                coordinate: body.coordinate,
                dof: body.dof.index(),
                ratio: body.ratio,
                offset: body.offset,
                mass: 0.0,
                com: Vec3::zeros(),
                I_cm: [0.0; 6],
            });
            turned.push(R_BS);
        }
        turned
    }

    fn add_inertia(&mut self, model: &Model, parameters: &Parameters, turned: &[Mat3]) {
        let mut total = vec![RigidInertia::ZERO; self.bodies.len()];
        for (id, link) in (0..).map(crate::model::LinkId).zip(&model.links) {
            let b = link.body.index();
            let R_SB = turned[b].transpose();
            let X_SL = Pose {
                R: R_SB * link.X_BL.R,
                p: R_SB * link.X_BL.p,
            };
            self.link_pose.push(X_SL);
            let mut inertia = link.inertia;
            if inertia.mass > 0.0 {
                let mass = parameters.get(P::LinkMass(id));
                inertia.I_cm *= mass / inertia.mass;
                inertia.mass = mass;
            }
            total[b] = total[b].joined(&inertia.transformed(&X_SL));
        }
        for (body, inertia) in self.bodies.iter_mut().zip(&total) {
            let I = &inertia.I_cm;
            body.mass = inertia.mass;
            body.com = inertia.com;
            body.I_cm = [
                I[(0, 0)],
                I[(1, 1)],
                I[(2, 2)],
                I[(0, 1)],
                I[(0, 2)],
                I[(1, 2)],
            ];
            if body.kind.moves() {
                self.moving_mass += body.mass;
            }
        }
    }

    fn add_colliders(&mut self, model: &Model, turned: &[Mat3]) {
        let Some(ground) = &model.world.ground else {
            return;
        };
        for (index, collider) in model.colliders.iter().enumerate() {
            let b = collider.body.index();
            if !self.bodies[b].kind.moves() {
                continue;
            }
            let R_SB = turned[b].transpose();
            let link = &model.links[collider.link.index()];
            self.colliders.push(TreeCollider {
                body: b,
                link: collider.link.index(),
                X: Pose {
                    R: R_SB * collider.X_BG.R,
                    p: R_SB * collider.X_BG.p,
                },
                radius: collider.shape.bounding_radius(),
                mu: 0.0,
                mu_at_rest: 0.0,
                restitution: 0.0,
                dissipation_number: f64::INFINITY,
                dissipation: link.dissipation.unwrap_or(self.dissipation),
                stiffness: 0.0,
                penetration: 0.0,
            });
            self.collider_index.push(index);
            let turning = &mut self.turning[collider.link.index()];
            turning.coefficient = [
                link.torsional_friction.max(ground.torsional_friction),
                link.rolling_friction.max(ground.rolling_friction),
            ];
            // Half the robot at the shape's radius: a ball alone, or one wheel of four.
            let radius = collider.shape.bounding_radius();
            let inertia = 0.5 * self.moving_mass * radius * radius;
            turning.inertia = turning.inertia.max(inertia);
            self.resists_turning |= turning.acts();
        }
    }

    /// All degrees of freedom on the way from the base to a body are coupled with each other.
    fn pattern(&self, nv: usize) -> Sparsity {
        let mut paths: Vec<Vec<usize>> = Vec::with_capacity(self.bodies.len());
        for (b, body) in self.bodies.iter().enumerate() {
            let mut path = if b == 0 {
                Vec::new()
            } else {
                paths[body.parent].clone()
            };
            path.extend(&self.dof[body.column..body.column + body.columns]);
            path.sort_unstable();
            path.dedup();
            paths.push(path);
        }
        Sparsity::new(nv, &paths)
    }

    /// Takes over the tunable parameters: what may change between two steps.
    pub fn tune(&mut self, model: &Model, parameters: &Parameters) {
        self.gravity = Vec3::new(
            parameters.get(P::Gravity(0)),
            parameters.get(P::Gravity(1)),
            parameters.get(P::Gravity(2)),
        );
        for (id, gains) in (0..).map(crate::model::ActuatorId).zip(&mut self.gains) {
            *gains = [parameters.get(P::Kp(id)), parameters.get(P::Kd(id))];
        }
        self.damping.fill(0.0);
        self.friction.fill(DryFriction::default());
        for (id, joint) in (0..).map(crate::model::JointId).zip(&model.joints) {
            let (damping, friction) = (
                parameters.get(P::JointDamping(id)),
                parameters.get(P::JointFriction(id)),
            );
            for body in &joint.bodies {
                let body = &self.bodies[body.index()];
                if body.kind.is_free() {
                    continue;
                }
                for c in body.column..body.column + body.columns {
                    let dof = self.dof[c];
                    self.damping[dof] += damping * body.ratio * body.ratio;
                    self.friction[dof].add(joint, friction, body.ratio.abs());
                }
            }
        }
        let ground_mu = parameters.get(P::GroundFriction);
        let ground_e = parameters.get(P::GroundRestitution);
        let ground = model.world.ground.as_ref();
        let ground_excess = ground.map_or(0.0, |ground| ground.static_excess);
        let combined = match model.world.combination {
            Combination::Mean => harmonic_mean,
            Combination::Product => |a: f64, b: f64| a * b,
        };
        for collider in &mut self.colliders {
            let link = &model.links[collider.link];
            let mu = parameters.get(P::LinkFriction(collider.link.into()));
            collider.mu = combined(mu, ground_mu);
            collider.mu_at_rest = combined(
                mu * (1.0 + link.static_excess),
                ground_mu * (1.0 + ground_excess),
            );
            let e = match model.world.combination {
                Combination::Mean => link.restitution.max(ground_e),
                Combination::Product => link.restitution * ground_e,
            };
            #[expect(
                clippy::float_cmp,
                reason = "skips the root search where nothing changed"
            )]
            if collider.restitution != e {
                collider.restitution = e;
                collider.dissipation_number = crate::law::dissipation_number(e);
            }
        }
    }

    /// Whether a body turns about its joint's axis and looks the same to the rest of the robot however it has turned.
    fn is_wheel(&self, index: usize) -> bool {
        let body = &self.bodies[index];
        let [xx, yy, zz, xy, xz, yz] = body.I_cm;
        let eccentric = body.mass * (body.com.x * body.com.x + body.com.y * body.com.y);
        let uneven = (xx - yy).abs() + xy.abs() + xz.abs() + yz.abs() + eccentric;
        body.kind.turns_about_its_axis()
            && uneven <= WHEEL * (xx + yy + zz)
            && self.bodies.iter().skip(1).all(|b| b.parent != index)
    }

    /// Brings the quaternions in `q` back to unit length.
    pub fn normalize(&self, q: &mut [f64]) {
        for body in &self.bodies {
            body.kind.normalize(&mut q[body.coordinate..]);
        }
    }

    /// Whether the base floats.
    #[inline]
    pub fn is_free(&self) -> bool {
        self.bodies[0].kind.is_free()
    }
}

/// `2ab/(a+b)`, 0 where both are 0.
pub fn harmonic_mean(a: f64, b: f64) -> f64 {
    if a + b > 0.0 {
        2.0 * a * b / (a + b)
    } else {
        0.0
    }
}
