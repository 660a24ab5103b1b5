//! Outputs of a state: poses, velocities, accelerations, forces, energies; computed when first
//! read.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod channels;
mod closures;
mod derivative;
mod held;
mod hold;
mod links;
mod pair;
mod sample;
mod sensed;
mod states;
mod touch;

use crate::closure::{Rows, Schur};
use crate::continuous::{Derivatives, States};
use crate::dynamics::energy;
use crate::force::{self, NamedPairs};
use crate::kinematics::forward;
use crate::model::{JointId, Model, RootId};
use crate::sensor::Sensors;
use crate::slots::{Axis, OutputSlot};
use crate::sparsity::inverse::Inverse;
use crate::spatial::{Pose, Vec3, Vec6, add6, dot6, quaternion_from_rotation, rpy_from_rotation};
use crate::state::State;
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use channels::Sampler;
use held::Held;

/// How much of a state has been computed; each level needs the ones before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    /// The state itself, which needs nothing.
    State,
    /// Poses and velocities of the bodies.
    Kinematics,
    /// Mass matrix, bias, contacts and joint terms.
    Forces,
    /// Generalised accelerations.
    Accelerations,
    /// Spatial accelerations of the bodies.
    BodyAccelerations,
}

/// What is known of the current state.
#[derive(Clone, Debug)]
pub struct Readout {
    /// Kinematics, contacts and joint terms at the state, up to `known`; filled by
    /// [`Self::at`].
    pub point: Point,
    /// Generalised accelerations, `nv`, rad/s² or m/s²; filled by [`Self::accelerations`].
    vdot: Vec<f64>,
    /// Accelerations of the bodies about O, world axes; filled by [`Self::body_accelerations`].
    A: Vec<Vec6>,
    /// What something stiff holds; filled by [`Self::hold`].
    held: Held,
    /// Factor of the mass matrix; scratch of [`Self::accelerations`].
    factor: Vec<f64>,
    /// Forces of closed loops, one a row; filled by [`Self::accelerations`], and its scratch.
    loops: Vec<f64>,
    closed: Schur,
    /// What of the fields above is that of the state.
    known: Level,
    /// Roll, pitch, yaw of the base, rad; filled when first read, because it is asked for in parts.
    rpy: Vec<Option<Vec3>>,
    /// Kinetic and potential energy, J; filled when first read, because it takes long.
    energies: Option<[f64; 2]>,
    /// Wrenches in joints, distances along rays; filled when first read.
    sensors: Sensors,
    /// Errors of sensors, and samples.
    sampler: Sampler,
    /// Which contacts belong to which named pair; never changes.
    named: NamedPairs,
    /// The continuous states of Model Exchange; never changes.
    pub states: States,
    /// Their derivatives, and whether they are those of the state.
    derivatives: (Derivatives, bool),
}

#[cfg(test)]
crate::spoil::spoil!(Readout: point vdot A held factor loops closed sensors sampler; known rpy energies named states derivatives);

impl Readout {
    /// Buffers for a robot.
    ///
    /// - `tree`: that of the model's own parameters
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, tree: &Tree) -> Box<Self> {
        let states = States::of(model, tree);
        Box::new(Self {
            point: Point::new(model, tree),
            vdot: vec![0.0; model.nv()],
            A: vec![[0.0; 6]; tree.bodies.len()],
            held: Held::new(model, tree),
            factor: vec![0.0; tree.sparsity.entries()],
            loops: Vec::with_capacity(Rows::most(tree)),
            closed: Schur::new(tree),
            known: Level::State,
            rpy: vec![None; model.roots.len()],
            energies: None,
            sensors: Sensors::new(model),
            sampler: Sampler::new(model),
            named: NamedPairs::new(model),
            derivatives: (Derivatives::new(states.len(), model.nq), false),
            states,
        })
    }

    /// The state, a parameter or an input has changed.
    pub fn invalidate(&mut self) {
        self.known = Level::State;
        self.rpy.fill(None);
        self.energies = None;
        self.derivatives.1 = false;
        self.sensors.invalidate();
    }

    /// Computes what is above the level that is known, up to `level`.
    fn compute(&mut self, ctx: &Context, state: &State, level: Level) {
        if level == Level::Kinematics {
            self.point.kin.update_poses(ctx.tree, &state.physical.q);
            self.point
                .kin
                .update_velocities(ctx.tree, &state.physical.v);
        } else if self.known < Level::Forces {
            self.point.update(ctx, &state.physical, 0.0);
            if ctx.tree.is_closed() {
                // All rows have their share of the forces.
                let kin = &mut self.point.kin;
                kin.loops.keep_all();
                kin.update_loops(ctx.tree);
                kin.update_loop_bias(ctx.tree);
                kin.loops.find_sums(ctx.tree, &state.physical.q);
            }
        }
        if level >= Level::Accelerations && self.known < Level::Accelerations {
            self.accelerations(ctx, state);
        }
        if level >= Level::BodyAccelerations {
            self.body_accelerations(ctx);
        }
        self.known = level;
    }

    /// What is known once all up to `level` has been computed.
    #[inline]
    fn at(&mut self, ctx: &Context, state: &State, level: Level) -> &mut Self {
        if level > self.known {
            self.compute(ctx, state, level);
        }
        self
    }

    /// Value of an output.
    #[inline]
    pub fn read(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> f64 {
        let measured = match slot {
            OutputSlot::Sensor(id, what) => self.measured(ctx, state, id, what),
            _ => None,
        };
        measured.unwrap_or_else(|| self.read_now(ctx, state, slot))
    }

    /// Value of an output as it is at this moment, whatever a sensor makes of it. Each line says
    /// what must be computed first. Most outputs that an importer reads are held by the state
    /// itself, and need nothing: what else there is stays apart, so that reading them needs no room
    /// for it.
    #[expect(clippy::too_many_lines, reason = "one line for each kind of output")]
    fn read_now(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> f64 {
        use OutputSlot as O;
        let (model, physical, stepping) = (ctx.model, &state.physical, &state.stepping);
        match slot {
            O::JointPosition(joint, axis) => joint_position(model, state, joint, axis),
            O::JointOrientation(joint, axis) => joint_orientation(model, state, joint, axis),
            O::JointVelocity(joint, axis) => joint_rate(model, &physical.v, joint, axis),
            O::JointAcceleration(joint, axis) => {
                let known = self.at(ctx, state, Level::Accelerations);
                joint_rate(model, &known.vdot, joint, axis)
            }
            O::JointEffort(joint) => {
                let known = self.at(ctx, state, Level::Accelerations);
                known.joint_effort(model, state, joint)
            }
            O::BaseOrientation(root, axis) if model.floats(root) => {
                physical.q[model.base(root).coordinate + 3 + (axis as usize + 1) % 4]
            }
            // A fixed base does not move.
            O::BaseLinearVelocity(root, axis) => ctx.tree.base_frame(root).map_or(0.0, |base| {
                base.velocity(&physical.q, &physical.v)[axis as usize]
            }),
            O::BaseAngularVelocity(root, axis) => ctx
                .tree
                .base_frame(root)
                .map_or(0.0, |base| physical.v[base.dof + axis as usize]),
            O::BaseRpy(root, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                known.rpy(ctx, root)[axis as usize]
            }
            O::BasePosition(root, axis) => {
                if let Some(base) = ctx.tree.base_frame(root) {
                    return base.position(&physical.q)[axis as usize];
                }
                let known = self.at(ctx, state, Level::Kinematics);
                known.point.kin.origins[root.index()][axis as usize]
            }
            O::BaseOrientation(root, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                let body = model.roots[root.index()].body;
                quaternion(&known.point.kin.X[body.index()])[axis as usize]
            }
            O::LinkPosition(link, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                known.link_position(ctx, link)[axis as usize]
            }
            O::LinkOrientation(link, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                quaternion(&known.link_pose(ctx, link.index()))[axis as usize]
            }
            O::LinkLinearVelocity(link, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                known.link_velocity(ctx, link)[axis as usize]
            }
            O::LinkAngularVelocity(link, axis) => {
                let known = self.at(ctx, state, Level::Kinematics);
                let body = model.links[link.index()].body;
                known.point.kin.V[body.index()][axis as usize]
            }
            O::ContactForce(link, axis) if stepping.last_step > 0.0 => {
                stepping.impulse[link.index()][axis as usize] / stepping.last_step
            }
            O::PairForce(pair, axis) if stepping.last_step > 0.0 => {
                stepping.pair_impulse[pair.index()][axis as usize] / stepping.last_step
            }
            // Before the first step, which the mean would be taken over: the force of this moment.
            O::ContactForce(link, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.contact_force(link, axis)
            }
            O::ContactActive(link) => {
                let known = self.at(ctx, state, Level::Forces);
                f64::from(u8::from(known.touches(ctx, link)))
            }
            O::ContactPoint(link, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.contact_point(ctx, link)[axis as usize]
            }
            O::PairForce(pair, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.pair_force(pair)[axis as usize]
            }
            O::PairActive(pair) => {
                let known = self.at(ctx, state, Level::Forces);
                f64::from(u8::from(known.pair_presses(pair)))
            }
            O::PairPoint(pair, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.pair_point(ctx, pair)[axis as usize]
            }
            O::PairNormal(pair, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.pair_normal(pair)[axis as usize]
            }
            O::PairDepth(pair) => {
                let known = self.at(ctx, state, Level::Forces);
                known.pair_depth(pair)
            }
            O::PairSlipSpeed(pair) => {
                let known = self.at(ctx, state, Level::Forces);
                known.pair_slip_speed(pair)
            }
            O::LoopForce(id, axis) => {
                let known = self.at(ctx, state, Level::Accelerations);
                known.loop_wrench(ctx, id)[0][axis as usize]
            }
            O::LoopTorque(id, axis) => {
                let known = self.at(ctx, state, Level::Accelerations);
                known.loop_wrench(ctx, id)[1][axis as usize]
            }
            O::LoopEffort(id) => {
                let known = self.at(ctx, state, Level::Accelerations);
                known.loop_wrench(ctx, id)[0].x
            }
            O::LoopGap(id) => {
                let known = self.at(ctx, state, Level::Forces);
                known.loop_gap(ctx, id)
            }
            O::SpringForce(id, axis) => {
                let known = self.at(ctx, state, Level::Forces);
                known.spring(ctx, id).0[axis as usize]
            }
            O::SpringLength(id) => {
                let known = self.at(ctx, state, Level::Forces);
                known.spring(ctx, id).1
            }
            O::EnergyKinetic => self.energies(ctx, state)[0],
            O::EnergyPotential => self.energies(ctx, state)[1],
            O::Sensor(id, what) => {
                let known = self.at(ctx, state, Self::needed_of(what));
                known.sensed(ctx, state, id, what)
            }
            O::State(id) => self.states.value(id.index(), physical),
            O::Rate(id) => self.rates(ctx, state)[id.index()],
            // What acts is known where an importer integrates, see [`Events`].
            O::Indicator => 1.0,
            O::Steps => count(stepping.counters.steps),
            O::Rejected => count(stepping.counters.rejected),
            O::NewtonMax => count(stepping.counters.newton_max),
        }
    }

    /// What the actuator applies at this moment; 0 for a joint without one.
    fn joint_effort(&self, model: &Model, state: &State, joint: JointId) -> f64 {
        let Some(body) = model.scalar_body(joint) else {
            return 0.0;
        };
        if model.joints[joint.index()].mimic.is_some() {
            return 0.0;
        }
        let dof = model.bodies[body.index()].dof.index();
        let joints = &self.point.terms.joints;
        let Ok(place) = joints.binary_search_by_key(&dof, |term| term.dof) else {
            return 0.0;
        };
        self.drive_effort(state, place)
    }

    /// Roll, pitch, yaw of the base of a tree.
    fn rpy(&mut self, ctx: &Context, root: RootId) -> Vec3 {
        let body = ctx.model.roots[root.index()].body;
        let R = &self.point.kin.X[body.index()].R;
        *self.rpy[root.index()].get_or_insert_with(|| rpy_from_rotation(R))
    }

    /// Kinetic and potential energy, the latter with what springs hold: it is that of all forces
    /// that have a potential by what the model says, and not by how contacts and limits are solved.
    fn energies(&mut self, ctx: &Context, state: &State) -> [f64; 2] {
        let known = self.at(ctx, state, Level::Kinematics);
        let kin = &known.point.kin;
        *known.energies.get_or_insert_with(|| {
            let kinetic = energy::kinetic(ctx.tree, kin, &state.physical.v);
            let springs = force::held_by_springs(ctx.tree, kin);
            [kinetic, energy::potential(ctx.tree, kin) + springs]
        })
    }

    /// Spatial accelerations of the bodies, from `vdot` and the bias.
    fn body_accelerations(&mut self, ctx: &Context) {
        let kin = &self.point.kin;
        forward(ctx.tree, &kin.S, &self.vdot, &mut self.A);
        let g = ctx.tree.world.gravity;
        for (A, C) in self.A.iter_mut().zip(&kin.C) {
            for i in 0..3 {
                A[i] += C[i];
                // The bias accelerations have gravity as an upward acceleration of the base.
                A[3 + i] += C[3 + i] + g[i];
            }
        }
    }

    /// `M vdot = tau − k + Jᵀ f` with the forces of this moment, but see [`hold`].
    fn accelerations(&mut self, ctx: &Context, state: &State) {
        let tree = ctx.tree;
        let Point { kin, terms, .. } = &mut self.point;
        for (a, k) in self.vdot.iter_mut().zip(&kin.bias) {
            *a = -k;
        }
        for term in &terms.joints {
            let load = ctx.exchanged.then(|| tree.limit_load(term.dof));
            self.vdot[term.dof] += term.force(state.physical.v[term.dof], load);
        }
        // The bias is done with its forces: they serve for the contacts.
        let F = &mut kin.force;
        F.fill([0.0; 6]);
        for contact in terms.contacts.iter() {
            let (force, moment) = contact.wrench(&terms.contacts.points, &kin.V);
            contact.act(&force, &moment, F);
        }
        for turn in &terms.turns {
            turn.act(&turn.force(&turn.relative(&kin.V)), F);
        }
        for spring in &terms.springs {
            spring.act(&spring.force(&spring.relative(&kin.V)), F);
        }
        for (b, body) in tree.bodies.iter().enumerate().rev() {
            let f = F[b];
            if body.kind.is_base() {
                for (a, f) in self.vdot[body.dof..].iter_mut().zip(&f[..body.columns]) {
                    *a += f;
                }
                continue;
            }
            for c in body.column..body.column + body.columns {
                self.vdot[tree.dof[c]] += dot6(&kin.S[c], &f);
            }
            add6(&mut F[body.parent], &f);
        }
        if self.hold(ctx, state) {
            return;
        }
        self.factor.copy_from_slice(&self.point.kin.M);
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, &mut self.vdot);
        let (rows, factor) = (&self.point.kin.loops, &self.factor);
        if !rows.is_empty() {
            let closed = &mut self.closed;
            closed.factor(tree, rows, &Inverse::Packed(&tree.sparsity, factor));
            let asked = |row: usize| -rows.bias[row];
            closed.close((tree, rows), asked, &mut self.vdot, &mut self.loops);
        }
    }
}

/// A counter as an output.
#[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
fn count(counter: u64) -> f64 {
    counter as f64
}

/// x, y, z, w.
fn quaternion(X: &Pose) -> [f64; 4] {
    let q = quaternion_from_rotation(&X.R);
    [q.i, q.j, q.k, q.w]
}

/// Position of a joint along one of its axes: of the body in its chain that moves along it; 0 where
/// none does.
fn joint_position(model: &Model, state: &State, joint: JointId, axis: Axis) -> f64 {
    let joint = &model.joints[joint.index()];
    let body = joint.bodies.get(axis as usize);
    let body = body.map(|body| &model.bodies[body.index()]);
    body.filter(|body| body.motion.axis().is_some())
        .map_or(0.0, |body| {
            body.ratio * state.physical.q[body.coordinate] + body.offset
        })
}

/// Orientation x, y, z, w of a floating or spherical joint; 0 for one that has none.
fn joint_orientation(model: &Model, state: &State, joint: JointId, axis: Axis) -> f64 {
    let last = model.joints[joint.index()].bodies.last();
    let component = (axis as usize + 1) % 4;
    last.and_then(|body| {
        let body = &model.bodies[body.index()];
        let first = body.motion.kind().quaternion()?;
        Some(state.physical.q[body.coordinate + first + component])
    })
    .unwrap_or(0.0)
}

/// Velocity or acceleration of a joint along one of its axes, from `rate` (`v` or `vdot`): of the
/// bodies in its chain, one axis each, and of the last in all its own.
fn joint_rate(model: &Model, rate: &[f64], joint: JointId, axis: Axis) -> f64 {
    let bodies = &model.joints[joint.index()].bodies;
    let place = (axis as usize).min(bodies.len().saturating_sub(1));
    bodies.get(place).map_or(0.0, |body| {
        let body = &model.bodies[body.index()];
        let own = (axis as usize - place).min(body.motion.nv() - 1);
        body.ratio * rate[body.dof.index() + own]
    })
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
