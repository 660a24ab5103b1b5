//! Sensors: inertial units and force–torque sensors in joints; rays are in `scan`.
//!
//! In: kinematics, accelerations and contacts of a state. Out: numbers in the sensor's own axes, as
//! they are at the moment of the state. Bias, noise and samples are added in
//! [`crate::readout`].
//!
//! The specific force of an inertial unit is acceleration minus gravity, so it is 0 in free fall.
//! The wrench in a joint is the rate of momentum of all links beyond it minus weight, contacts,
//! springs, closed loops and external wrenches (Newton and Euler, link by link), whether bearings,
//! motors or a weld carry it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

pub mod frame;
mod held;
pub mod noise;
pub mod scan;

use crate::model::{LinkId, Model, Sensor, SensorKind};
use crate::slots::{InputSlot, ParameterSlot};
use crate::spatial::{Vec3, Vec6, angular, linear, velocity_at};
use crate::step::point::{Context, Point};
use frame::{link_pose, pose};
use held::holds;
use scan::Scans;

/// Accelerations of bodies and wrenches in joints, computed when first read.
#[derive(Clone, Debug)]
pub struct Sensors {
    /// Links beyond the joint of each sensor, its child first; empty for sensors of another kind.
    beyond: Vec<Vec<usize>>,
    /// `[τ; f]` that the parent exerts on the child, about the child's origin, world axes, per
    /// sensor.
    wrench: Vec<Vec6>,
    has_wrenches: bool,
    /// Distances along rays.
    pub scans: Scans,
}

#[cfg(test)]
crate::spoil::spoil!(Sensors: wrench scans; beyond has_wrenches);

impl Sensors {
    /// Buffers for a robot.
    pub fn new(model: &Model) -> Self {
        let sensors = &model.outputs.sensors;
        let beyond = |sensor: &Sensor| -> Vec<usize> {
            let SensorKind::ForceTorque { joint, .. } = sensor.kind else {
                return Vec::new();
            };
            let child = model.joints[joint.index()].child.index();
            let mut reached = vec![false; model.links.len()];
            reached[child] = true;
            // Parents come before children, in joints as in links.
            for joint in &model.joints {
                reached[joint.child.index()] |= reached[joint.parent.index()];
            }
            (child..reached.len()).filter(|&l| reached[l]).collect()
        };
        Self {
            beyond: sensors.iter().map(beyond).collect(),
            wrench: vec![[0.0; 6]; sensors.len()],
            has_wrenches: false,
            scans: Scans::new(model),
        }
    }

    /// The state, a parameter or an input has changed.
    pub fn invalidate(&mut self) {
        self.has_wrenches = false;
        self.scans.invalidate();
    }

    /// Wrench `[τ; f]` in the joint, about the child link's origin, sensor axes; of the parent on
    /// the child unless the sensor tells the other.
    ///
    /// `point` is up to date with the state, forces included; `A` are the bodies' spatial
    /// accelerations about O, `loops` the forces of all rows of closed loops, and `pushed` what
    /// each contact pushes its body more by, about O, if anything.
    pub fn wrench(
        &mut self,
        ctx: &Context,
        point: &Point,
        (A, loops, pushed): (&[Vec6], &[f64], &[Vec6]),
        sensor: usize,
    ) -> [Vec3; 2] {
        if !self.has_wrenches {
            for s in 0..self.wrench.len() {
                if !self.beyond[s].is_empty() {
                    self.wrench[s] = wrench_beyond(ctx, point, (A, loops, pushed), &self.beyond[s]);
                }
            }
            self.has_wrenches = true;
        }
        let (_, X) = pose(ctx, point, sensor);
        let mut R_SW = X.R.transpose();
        if let SensorKind::ForceTorque { reversed: true, .. } =
            ctx.model.outputs.sensors[sensor].kind
        {
            R_SW = -R_SW;
        }
        let W = &self.wrench[sensor];
        [R_SW * angular(W), R_SW * linear(W)]
    }
}

/// Specific force at the sensor's origin, m/s², sensor axes. As for [`Sensors::wrench`].
pub fn specific_force(ctx: &Context, point: &Point, A: &[Vec6], sensor: usize) -> Vec3 {
    let (body, X) = pose(ctx, point, sensor);
    X.R.transpose() * support(ctx, &A[body], &point.kin.V[body], &X.p)
}

/// `[τ; f]` that hold `links`, about the origin of the first, world axes.
fn wrench_beyond(
    ctx: &Context,
    point: &Point,
    (A, loops, pushed): (&[Vec6], &[f64], &[Vec6]),
    links: &[usize],
) -> Vec6 {
    let kin = &point.kin;
    let origin = links
        .first()
        .map_or(Vec3::zeros(), |&l| link_pose(ctx, point, l).p);
    let (mut moment, mut force) = (Vec3::zeros(), Vec3::zeros());
    let mut add = |x: &Vec3, f: &Vec3, sign: f64| {
        force += f * sign;
        moment += (x - origin).cross(f) * sign;
    };
    let mut couple = Vec3::zeros();
    for &l in links {
        let link = &ctx.model.links[l];
        let body = link.body.index();
        let X = link_pose(ctx, point, l);
        let (A, V) = (&A[body], &kin.V[body]);
        let x = X.point(&link.inertia.com);
        // The inertia scales with the mass, which may be set.
        let mass = ctx.parameters.get(ParameterSlot::LinkMass(LinkId::from(l)));
        let scale = if link.inertia.mass > 0.0 {
            mass / link.inertia.mass
        } else {
            1.0
        };
        let I = X.R * link.inertia.I_cm * X.R.transpose() * scale;
        let omega = angular(V);
        add(&x, &(support(ctx, A, V, &x) * mass), 1.0);
        couple += I * angular(A) + omega.cross(&(I * omega));
    }
    let is_beyond = |link: usize| links.binary_search(&link).is_ok();
    let contacts = &point.terms.contacts;
    for (i, contact) in contacts.iter().enumerate() {
        let (mut force, mut about) = contact.wrench(&contacts.points, &kin.V);
        if let Some(more) = pushed.get(i) {
            force += linear(more);
            about += angular(more);
        }
        if is_beyond(contact.link) {
            couple -= about;
            add(&Vec3::zeros(), &force, -1.0);
        }
        if let Some(link) = contact.other_link.filter(|link| is_beyond(*link)) {
            couple += about;
            let from = contact.seen_from((ctx.model, ctx.tree), kin, link);
            add(&from, &force, 1.0);
        }
    }
    for turn in &point.terms.turns {
        let contact = &contacts.list[turn.contact];
        let moment = turn.force(&turn.relative(&kin.V));
        if is_beyond(contact.link) {
            couple -= moment;
        }
        if contact.other_link.is_some_and(is_beyond) {
            couple += moment;
        }
    }
    for hold in holds(ctx, point, loops, &is_beyond) {
        add(&hold.x, &hold.force, -1.0);
        couple -= hold.torque;
    }
    for &link in &ctx.model.outputs.external_wrenches {
        if !is_beyond(link.index()) {
            continue;
        }
        let input = |slot: fn(LinkId, u8) -> InputSlot| {
            Vec3::from(std::array::from_fn(|axis| {
                // Three axes.
                #[expect(clippy::cast_possible_truncation, reason = "0, 1, 2")]
                ctx.inputs.get(slot(link, axis as u8))
            }))
        };
        let com = &ctx.model.links[link.index()].inertia.com;
        let x = link_pose(ctx, point, link.index()).point(com);
        add(&x, &input(InputSlot::ExternalForce), -1.0);
        couple -= input(InputSlot::ExternalTorque);
    }
    moment += couple;
    [moment.x, moment.y, moment.z, force.x, force.y, force.z]
}

/// Angular velocity in sensor axes, rad/s. Needs poses and velocities.
pub fn angular_velocity(ctx: &Context, point: &Point, sensor: usize) -> Vec3 {
    let (body, X) = pose(ctx, point, sensor);
    X.R.transpose() * angular(&point.kin.V[body])
}

/// Acceleration less gravity of the point of a body that is at `x` from O.
fn support(ctx: &Context, A: &Vec6, V: &Vec6, x: &Vec3) -> Vec3 {
    let omega = angular(V);
    linear(A) + angular(A).cross(x) + omega.cross(&velocity_at(V, x)) - ctx.tree.world.gravity
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
