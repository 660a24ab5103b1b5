//! Outputs of a state: poses, velocities, accelerations, forces, energies; computed when first read.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod derivative;

use crate::dynamics::energy;
use crate::model::{JointId, Model};
use crate::sensor::{self, Sensors};
use crate::slots::{Axis, OutputSlot};
use crate::spatial::{
    Pose, Vec3, Vec6, add_force_at, add6, angular, dot6, quaternion_from_rotation,
    rpy_from_rotation, velocity_at,
};
use crate::state::State;
use crate::step::point::{Context, Point};
use crate::tree::Tree;

/// What is known of the current state.
#[derive(Clone, Debug)]
pub struct Readout {
    /// Kinematics, contacts and joint terms at the state.
    pub point: Point,
    vdot: Vec<f64>,
    /// Accelerations of the bodies; scratch of derivatives.
    A: Vec<Vec6>,
    factor: Vec<f64>,
    /// Poses and velocities are those of the state.
    has_kinematics: bool,
    /// So are mass matrix, bias, contacts and joint terms.
    has_forces: bool,
    has_accelerations: bool,
    /// What takes long and is asked for in parts, or often.
    rpy: Option<Vec3>,
    energies: Option<[f64; 2]>,
    sensors: Sensors,
}

impl Readout {
    /// Buffers for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            point: Point::new(model, tree),
            vdot: vec![0.0; model.nv()],
            A: vec![[0.0; 6]; tree.bodies.len()],
            factor: vec![0.0; tree.sparsity.entries()],
            has_kinematics: false,
            has_forces: false,
            has_accelerations: false,
            rpy: None,
            energies: None,
            sensors: Sensors::new(model),
        }
    }

    /// The state, a parameter or an input has changed.
    pub fn invalidate(&mut self) {
        self.has_kinematics = false;
        self.has_forces = false;
        self.has_accelerations = false;
        self.rpy = None;
        self.energies = None;
        self.sensors.invalidate();
    }

    /// Value of an output.
    pub fn read(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> f64 {
        use OutputSlot as O;
        let model = ctx.model;
        // What the state tells by itself.
        match slot {
            O::JointPosition(joint, axis) => return joint_position(model, state, joint, axis),
            O::JointOrientation(joint, axis) => {
                return joint_orientation(model, state, joint, axis);
            }
            O::JointVelocity(joint, axis) => {
                return joint_rate(model, &state.v, joint, axis);
            }
            O::BasePosition(axis) if model.is_floating() => return state.q[axis as usize],
            O::BaseOrientation(axis) if model.is_floating() => {
                return state.q[3 + (axis as usize + 1) % 4];
            }
            O::BaseLinearVelocity(axis) if model.is_floating() => {
                return state.v[3 + axis as usize];
            }
            O::BaseAngularVelocity(axis) if model.is_floating() => return state.v[axis as usize],
            #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
            O::Steps => return state.counters[0] as f64,
            #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
            O::Rejected => return state.counters[1] as f64,
            #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
            O::NewtonMax => return state.counters[2] as f64,
            O::ContactForce(link, axis) if state.last_step > 0.0 => {
                return state.impulse[link.index()][axis as usize] / state.last_step;
            }
            _ => {}
        }
        let forces = matches!(
            slot,
            O::ContactActive(_)
                | O::ContactForce(..)
                | O::JointEffort(_)
                | O::JointAcceleration(..)
                | O::SensorAcceleration(..)
                | O::SensorForce(..)
                | O::SensorTorque(..)
        );
        if forces {
            self.update_forces(ctx, state);
        } else if !self.has_kinematics {
            self.point.kin.update_poses(ctx.tree, &state.q);
            self.point.kin.update_velocities(ctx.tree, &state.v);
            self.has_kinematics = true;
        }
        let kin = &self.point.kin;
        match slot {
            O::BasePosition(axis) => kin.origin[axis as usize],
            O::BaseOrientation(axis) => quaternion(&kin.X[0])[axis as usize],
            O::BaseRpy(axis) => self.rpy()[axis as usize],
            O::LinkPosition(link, axis) => {
                (self.link_pose(ctx, link.index()).p + kin.origin)[axis as usize]
            }
            O::LinkOrientation(link, axis) => {
                quaternion(&self.link_pose(ctx, link.index()))[axis as usize]
            }
            O::LinkLinearVelocity(link, axis) => {
                let V = &kin.V[model.links[link.index()].body.index()];
                velocity_at(V, &self.link_pose(ctx, link.index()).p)[axis as usize]
            }
            O::LinkAngularVelocity(link, axis) => {
                kin.V[model.links[link.index()].body.index()][axis as usize]
            }
            O::ContactActive(link) => {
                let touches = self.point.terms.contacts.iter().any(|c| {
                    c.link == link.index() && c.normal_force(c.normal_velocity(&kin.V)) > 0.0
                });
                f64::from(u8::from(touches))
            }
            O::ContactForce(link, axis) => self
                .point
                .terms
                .contacts
                .iter()
                .filter(|c| c.link == link.index())
                .map(|c| c.force(&c.velocity(&kin.V))[axis as usize])
                .sum(),
            O::EnergyKinetic => self.energies(ctx, state)[0],
            O::EnergyPotential => self.energies(ctx, state)[1],
            O::JointEffort(joint) => self.joint_effort(model, state, joint),
            O::JointAcceleration(joint, axis) => {
                self.update_accelerations(ctx, state);
                joint_rate(model, &self.vdot, joint, axis)
            }
            O::SensorOrientation(..)
            | O::SensorAngularVelocity(..)
            | O::SensorAcceleration(..)
            | O::SensorForce(..)
            | O::SensorTorque(..)
            | O::SensorDistance(..) => self.sensor(ctx, state, slot),
            // Answered above for a floating base; a fixed one does not move.
            _ => 0.0,
        }
    }

    /// What a sensor measures; poses, velocities and, where it needs them, forces are up to date.
    fn sensor(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> f64 {
        use OutputSlot as O;
        match slot {
            O::SensorOrientation(sensor, axis) => {
                let (_, X) = sensor::pose(ctx, &self.point, sensor.index());
                quaternion(&X)[axis as usize]
            }
            O::SensorAngularVelocity(sensor, axis) => {
                sensor::angular_velocity(ctx, &self.point, sensor.index())[axis as usize]
            }
            O::SensorAcceleration(sensor, axis) => {
                self.link_accelerations(ctx, state);
                sensor::specific_force(ctx, &self.point, &self.A, sensor.index())[axis as usize]
            }
            O::SensorForce(sensor, axis) | O::SensorTorque(sensor, axis) => {
                self.link_accelerations(ctx, state);
                let (point, A) = (&self.point, &self.A);
                let [torque, force] = self.sensors.wrench(ctx, point, A, sensor.index());
                if matches!(slot, O::SensorForce(..)) {
                    force[axis as usize]
                } else {
                    torque[axis as usize]
                }
            }
            O::SensorDistance(sensor, ray) => {
                sensor::distance(ctx, &self.point, sensor.index(), ray as usize)
            }
            _ => 0.0,
        }
    }

    /// Pose of a link's frame: axes in the world, position from O.
    fn link_pose(&self, ctx: &Context, link: usize) -> Pose {
        let body = ctx.model.links[link].body.index();
        self.point.kin.X[body].compose(&ctx.tree.link_pose[link])
    }

    /// What the actuator applies at this moment.
    fn joint_effort(&self, model: &Model, state: &State, joint: JointId) -> f64 {
        let Some(body) = model.scalar_body(joint) else {
            return 0.0;
        };
        if model.joints[joint.index()].mimic.is_some() {
            return 0.0;
        }
        let dof = model.bodies[body.index()].dof.index();
        let terms = &self.point.terms.joints;
        terms
            .binary_search_by_key(&dof, |term| term.dof)
            .map_or(0.0, |place| terms[place].drive_force(state.v[dof], 0.0).0)
    }

    /// Roll, pitch, yaw of the base.
    fn rpy(&mut self) -> Vec3 {
        let R = &self.point.kin.X[0].R;
        *self.rpy.get_or_insert_with(|| rpy_from_rotation(R))
    }

    /// Kinetic and potential energy.
    fn energies(&mut self, ctx: &Context, state: &State) -> [f64; 2] {
        let kin = &self.point.kin;
        *self.energies.get_or_insert_with(|| {
            let kinetic = energy::kinetic(ctx.tree, kin, &state.v);
            [kinetic, energy::potential(ctx.tree, kin)]
        })
    }

    /// Kinematics, contacts and joint terms of this moment.
    fn update_forces(&mut self, ctx: &Context, state: &State) {
        if !self.has_forces {
            self.point.update(ctx, state, 0.0);
            (self.has_kinematics, self.has_forces) = (true, true);
        }
    }

    /// `vdot` of this moment.
    fn update_accelerations(&mut self, ctx: &Context, state: &State) {
        self.update_forces(ctx, state);
        if !self.has_accelerations {
            self.accelerations(ctx, state);
            self.has_accelerations = true;
        }
    }

    /// `M vdot = tau − k + Jᵀ f` with the forces of this moment.
    fn accelerations(&mut self, ctx: &Context, state: &State) {
        let tree = ctx.tree;
        let Point { kin, terms } = &mut self.point;
        for (a, k) in self.vdot.iter_mut().zip(&kin.bias) {
            *a = -k;
        }
        for term in &terms.joints {
            self.vdot[term.dof] += term.force(state.v[term.dof]);
        }
        // The bias is done with its forces: they serve for the contacts.
        let F = &mut kin.force;
        F.fill([0.0; 6]);
        for contact in &terms.contacts {
            let force = contact.force(&contact.velocity(&kin.V));
            add_force_at(&mut F[contact.body], &contact.x, &force);
        }
        for turn in &terms.turns {
            let moment = turn.force(&angular(&kin.V[turn.body]));
            for (sum, x) in F[turn.body].iter_mut().zip(moment.iter()) {
                *sum += x;
            }
        }
        for b in (1..tree.bodies.len()).rev() {
            let body = &tree.bodies[b];
            let f = F[b];
            for c in body.column..body.column + body.columns {
                self.vdot[tree.dof[c]] += dot6(&kin.S[c], &f);
            }
            add6(&mut F[body.parent], &f);
        }
        if tree.is_free() {
            for (a, f) in self.vdot.iter_mut().zip(&F[0]) {
                *a += f;
            }
        }
        self.factor.copy_from_slice(&kin.M);
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, &mut self.vdot);
    }
}

/// x, y, z, w.
fn quaternion(X: &Pose) -> [f64; 4] {
    let q = quaternion_from_rotation(&X.R);
    [q.i, q.j, q.k, q.w]
}

/// Position of a joint along one of its axes: of the body in its chain that moves along it; 0 where none does.
fn joint_position(model: &Model, state: &State, joint: JointId, axis: Axis) -> f64 {
    let joint = &model.joints[joint.index()];
    let body = joint.bodies.get(axis as usize);
    let body = body.map(|body| &model.bodies[body.index()]);
    body.filter(|body| body.motion.axis().is_some())
        .map_or(0.0, |body| {
            body.ratio * state.q[body.coordinate] + body.offset
        })
}

/// Orientation x, y, z, w of a floating or spherical joint; 0 for one that has none.
fn joint_orientation(model: &Model, state: &State, joint: JointId, axis: Axis) -> f64 {
    let last = model.joints[joint.index()].bodies.last();
    let component = (axis as usize + 1) % 4;
    last.and_then(|body| {
        let body = &model.bodies[body.index()];
        let first = body.motion.kind().quaternion()?;
        Some(state.q[body.coordinate + first + component])
    })
    .unwrap_or(0.0)
}

/// Velocity or acceleration of a joint along one of its axes, from `rate` (`v` or `vdot`): of the bodies in its chain,
/// one axis each, and of the last in all its own.
fn joint_rate(model: &Model, rate: &[f64], joint: JointId, axis: Axis) -> f64 {
    let bodies = &model.joints[joint.index()].bodies;
    let place = (axis as usize).min(bodies.len().saturating_sub(1));
    bodies.get(place).map_or(0.0, |body| {
        let body = &model.bodies[body.index()];
        let own = (axis as usize - place).min(body.motion.nv() - 1);
        body.ratio * rate[body.dof.index() + own]
    })
}
