//! The tree of the solver, which follows from a model and its parameters: inertias, stiffness and
//! scales.
//!
//! Body frames are turned so that every turning or sliding joint acts along its own z axis, and
//! that of a floating base stands in its centre of mass; outputs, parameters and the states of
//! Model Exchange are those of the links ([`BaseFrame`]).
//!
//! A step finds velocities with the inertia of its middle. With the base in another place than its
//! centre of mass, momentum would depend on how this place turns within the step, and the error
//! would grow with its distance, which is that of an origin that somebody has chosen in a drawing.
//!
//! There is one entry per body degree of freedom ("column"): a mimic joint's column is scaled by
//! its ratio and belongs to the degree of freedom that it follows. What depends on the initial
//! position is in `scale`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod base;
mod closure;
mod closures;
mod driven;
mod elimination;
mod island;
mod keeping;
mod kept;
mod pairs;
mod parts;
mod scale;
mod scenery;
mod seams;
mod spinning;
mod turning;

pub use base::BaseFrame;
pub use closure::{Closure, ClosureKind, End, TreeSpring};
pub use kept::Kept;
pub(crate) use kept::Space;
pub use parts::{
    Actuators, Contacts, Dofs, DryFriction, Extent, Island, Span, Surface, Tree, TreeBody,
    TreeCollider, World, harmonic_mean,
};

use scenery::Scenery;
use turning::Turning;

use crate::geometry::pair::Solid;
use crate::geometry::{Faces, Shape};
use crate::law::normal::Stiffening;
use crate::model::{Body, BodyId, Model, RootId};
use crate::parameters::Parameters;
use crate::slots::ParameterSlot as P;
use crate::sparsity::Sparsity;
use crate::spatial::{Pose, RigidInertia, Vec3, rotation_from_rpy};
use crate::tuning::FACE;
use std::sync::Arc;

/// A pose in the frame of the solver, whose pose in the same frame is `X_BS`.
#[cfg_attr(small, optimize(size))]
pub(crate) fn within(X_BS: &Pose, X_BG: &Pose) -> Pose {
    let R_SB = X_BS.R.transpose();
    Pose {
        R: R_SB * X_BG.R,
        p: R_SB * (X_BG.p - X_BS.p),
    }
}

impl Tree {
    /// Derives the tree; masses, mounting and initial pose come from `parameters`.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, parameters: &Parameters) -> Self {
        Self::derive(model, parameters, (&[], &[]))
    }

    /// Derives the tree of the same model anew, from other parameters.
    pub fn renew(&mut self, model: &Model, parameters: &Parameters) {
        let shapes = std::mem::take(&mut self.contact.colliders);
        let bases: Vec<Pose> = self.trees.iter().map(|tree| tree.base).collect();
        *self = Self::derive(model, parameters, (&shapes, &bases));
    }

    /// The same.
    ///
    /// - `known`: colliders of the same model, whose shapes are prepared, and the poses of the
    ///   bases with which they are; or none
    #[cfg_attr(small, optimize(size))]
    fn derive(model: &Model, parameters: &Parameters, known: (&[TreeCollider], &[Pose])) -> Self {
        let nv = model.nv();
        let mut tree = Self {
            bodies: Vec::with_capacity(model.bodies.len()),
            trees: Vec::new(),
            dof: Vec::new(),
            sparsity: Sparsity::default(),
            island: Island::default(),
            pure: true,
            long: false,
            link_pose: Vec::new(),
            closures: Vec::new(),
            closure_order: Vec::new(),
            springs: Vec::new(),
            kept: Vec::with_capacity(model.bodies.len()),
            carrier: vec![None; model.bodies.len()],
            world: World {
                gravity: Vec3::zeros(),
                drag: model.world.drag,
            },
            contact: Contacts {
                shapes: model.colliders.len(),
                colliders: Vec::new(),
                turning: vec![Turning::default(); model.links.len()],
                resists_turning: false,
                dissipation: model.contact.dissipation,
                stribeck_velocity: model.contact.stribeck_velocity,
                combination: model.world.combination,
                pairs: Vec::new(),
                scenery: Scenery::default(),
                has_ground: model.world.ground.is_some(),
                ground_solid: None,
                ground: Surface::default(),
            },
            dofs: Dofs {
                armature: vec![0.0; nv],
                damping: vec![0.0; nv],
                friction: vec![DryFriction::default(); nv],
                speed_limit: vec![f64::INFINITY; nv],
                speed_damping: vec![0.0; nv],
                limits: model.dofs.iter().map(|d| d.limits).collect(),
                limit_stiffness: vec![0.0; nv],
                inertia: vec![0.0; nv],
                weight: vec![1.0; nv],
                components: vec![1; nv],
            },
            actuators: Actuators {
                motors: vec![(0.0, 0.0); model.actuators.len()],
                gains: vec![[0.0; 2]; model.actuators.len()],
            },
        };
        let frames = tree.add_bodies(model, parameters);
        tree.add_inertia(model, parameters, &frames);
        tree.find_spinning();
        tree.find_vectors();
        tree.add_closures(model, &frames);
        tree.add_colliders(model, &frames, known);
        tree.contact.scenery = tree.scenery();
        tree.sparsity = tree.pattern();
        tree.order_closures();
        tree.select_all();
        for joint in &model.joints {
            for body in &joint.bodies {
                let body = &tree.bodies[body.index()];
                for c in body.column..body.column + body.columns {
                    let dof = tree.dof[c];
                    tree.dofs.armature[dof] += joint.armature * body.ratio * body.ratio;
                    if let Some(limit) = joint.velocity.filter(|_| joint.enforce_velocity) {
                        let limit = limit / body.ratio.abs();
                        tree.dofs.speed_limit[dof] = tree.dofs.speed_limit[dof].min(limit);
                    }
                }
            }
        }
        tree.tune(model, parameters);
        tree
    }

    /// Bodies with their poses; returns the pose of each solver frame in the model's body frame.
    fn add_bodies(&mut self, model: &Model, parameters: &Parameters) -> Vec<Pose> {
        let mut frames: Vec<Pose> = Vec::with_capacity(model.bodies.len());
        for (id, body) in (0..).map(BodyId).zip(&model.bodies) {
            let X_BS = model.solver_frame(id);
            let (b, kind) = (self.bodies.len(), body.motion.kind());
            if kind.is_base() {
                self.add_tree(b, body, X_BS.p, parameters);
            }
            let parent = body.parent.map_or(b, super::model::BodyId::index);
            let X_PB = match body.parent {
                Some(parent) => within(&frames[parent.index()], &body.X_PB),
                None => body.X_PB,
            };
            let column = self.dof.len();
            let columns = body.motion.nv();
            self.dof.extend((0..columns).map(|i| body.dof.index() + i));
            let mut dofs = self.dof[column..].iter().zip(column..);
            let pure = dofs.all(|(dof, column)| *dof == column);
            self.bodies.push(TreeBody {
                parent,
                tree: self.trees.len() - 1,
                kind,
                X: Pose {
                    R: X_PB.R * X_BS.R,
                    p: X_PB.p,
                },
                column,
                columns,
                coordinate: body.coordinate,
                dof: body.dof.index(),
                ratio: body.ratio,
                offset: body.offset,
                spinning: 1.0,
                mass: 0.0,
                com: Vec3::zeros(),
                I_cm: [0.0; 6],
            });
            frames.push(X_BS);
            if let Some(tree) = self.trees.last_mut() {
                tree.bodies.end = b + 1;
                // A mimic body has the place of the joint that it follows.
                tree.dofs.end = tree.dofs.end.max(body.dof.index() + columns);
                tree.coordinates.end = tree.coordinates.end.max(body.coordinate + body.motion.nq());
                tree.pure &= pure;
            }
        }
        frames
    }

    /// Begins the next tree with its base, the body `b`.
    fn add_tree(&mut self, b: usize, base: &Body, center: Vec3, parameters: &Parameters) {
        let root = RootId::from(self.trees.len());
        let axes = |slot| parameters.of_base(slot, root);
        let dof = base.dof.index();
        self.trees.push(Extent {
            base: Pose {
                R: rotation_from_rpy(&axes(P::InitialBaseRpy)),
                p: axes(P::InitialBasePosition),
            },
            bodies: b..b,
            dofs: dof..dof,
            coordinates: base.coordinate..base.coordinate,
            free: base.motion.kind().is_free(),
            center,
            pure: true,
            closed: false,
            tied: false,
            driven: None,
            moving_mass: 0.0,
            joined_mass: 0.0,
            reach: 0.0,
        });
    }

    fn add_inertia(&mut self, model: &Model, parameters: &Parameters, frames: &[Pose]) {
        let mut total = vec![RigidInertia::ZERO; self.bodies.len()];
        for (id, link) in (0..).map(crate::model::LinkId).zip(&model.links) {
            let b = link.body.index();
            let X_SL = within(&frames[b], &link.X_BL);
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
        }
        for root in &model.outputs.driven {
            // No force moves it: the step knows its acceleration.
            let tree = &mut self.trees[root.index()];
            tree.driven = Some([0.0; 6]);
            let base = &mut self.bodies[tree.bodies.start];
            (base.mass, base.com, base.I_cm) = (0.0, Vec3::zeros(), [0.0; 6]);
        }
        for tree in &mut self.trees {
            for body in &self.bodies[tree.bodies.clone()] {
                if body.kind.moves() {
                    tree.moving_mass += body.mass;
                }
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn add_colliders(
        &mut self,
        model: &Model,
        frames: &[Pose],
        (known, bases): (&[TreeCollider], &[Pose]),
    ) {
        let ground = model.world.ground.as_ref();
        let others = model.has_pairs();
        if ground.is_none() && !others {
            return;
        }
        if let Some(ground) = ground {
            self.contact.ground.turning = [ground.torsional_friction, ground.rolling_friction];
            self.contact.resists_turning = self.contact.ground.resists_turning();
        }
        for (index, collider) in model.colliders.iter().enumerate() {
            let b = collider.body.index();
            let moves = self.bodies[b].kind.moves();
            if !moves && !others {
                continue;
            }
            let link = &model.links[collider.link.index()];
            let (shape, face) = (&collider.shape, FACE * model.contact.penetration);
            let place = self.contact.colliders.len();
            let (faces, solid) = match known.get(place) {
                Some(known) => (known.faces.clone(), known.solid.clone()),
                None => (
                    Arc::new(match shape {
                        Shape::Hull { vertices } => Faces::new(vertices, face),
                        _ => Faces::default(),
                    }),
                    others.then(|| Arc::new(Solid::new(shape, face))),
                ),
            };
            let own = Surface {
                turning: [link.torsional_friction, link.rolling_friction],
                ..Surface::default()
            };
            self.contact.colliders.push(TreeCollider {
                index,
                body: b,
                tree: self.bodies[b].tree,
                moves,
                yields: moves && !self.is_driven(b),
                link: collider.link.index(),
                X: within(&frames[b], &collider.X_BG),
                radius: if shape.is_terrain() {
                    f64::INFINITY
                } else {
                    shape.bounding_radius()
                },
                own,
                ground: Surface::default(),
                dissipation: link.dissipation.unwrap_or(self.contact.dissipation),
                belt: Vec3::zeros(),
                spring: Stiffening::default(),
                faces,
                solid,
            });
            if moves {
                // Half the robot at the shape's radius: a ball alone, or one wheel of four.
                let radius = collider.shape.bounding_radius();
                let inertia = 0.5 * self.mass_with(b) * radius * radius;
                let turning = &mut self.contact.turning[collider.link.index()];
                turning.inertia = turning.inertia.max(inertia);
            }
            self.contact.resists_turning |= own.resists_turning();
        }
        if others {
            self.contact.pairs = self.pairs(model);
            self.join_terrain(model, bases);
            let ground = self.contact.has_ground;
            let plane = || Arc::new(Solid::new(&Shape::Plane, 0.0));
            self.contact.ground_solid = ground.then(plane);
        }
    }

    /// All degrees of freedom on the way from the base to a body are coupled with each other.
    fn pattern(&self) -> Sparsity {
        let mut paths: Vec<Vec<usize>> = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            let mut path = if body.kind.is_base() {
                Vec::new()
            } else {
                paths[body.parent].clone()
            };
            path.extend(&self.dof[body.column..body.column + body.columns]);
            path.sort_unstable();
            path.dedup();
            paths.push(path);
        }
        let blocks: Vec<usize> = self.trees.iter().map(|tree| tree.dofs.len()).collect();
        Sparsity::new(&blocks, &paths)
    }

    /// Takes over the tunable parameters: what may change between two steps.
    #[cfg_attr(small, optimize(size))]
    pub fn tune(&mut self, model: &Model, parameters: &Parameters) {
        self.world.gravity = Vec3::new(
            parameters.get(P::Gravity(0)),
            parameters.get(P::Gravity(1)),
            parameters.get(P::Gravity(2)),
        );
        for (id, gains) in (0..)
            .map(crate::model::ActuatorId)
            .zip(&mut self.actuators.gains)
        {
            *gains = [parameters.get(P::Kp(id)), parameters.get(P::Kd(id))];
        }
        self.dofs.damping.fill(0.0);
        self.dofs.friction.fill(DryFriction::default());
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
                    self.dofs.damping[dof] += damping * body.ratio * body.ratio;
                    self.dofs.friction[dof].add(joint, friction, body.ratio.abs());
                }
            }
        }
        let ground = model.world.ground.as_ref();
        let excess = ground.map_or(0.0, |ground| ground.static_excess);
        let contact = &mut self.contact;
        contact.ground.set(
            parameters.get(P::GroundFriction),
            excess,
            parameters.get(P::GroundRestitution),
        );
        for collider in &mut contact.colliders {
            let link = &model.links[collider.link];
            let mu = parameters.get(P::LinkFriction(collider.link.into()));
            collider.own.set(mu, link.static_excess, link.restitution);
            let both = [&collider.own, &contact.ground];
            collider.ground.combine(both, contact.combination);
        }
        self.find_kept(model);
    }
}
