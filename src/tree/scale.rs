//! Quantities that follow from the robot in its initial position: stiffness of contacts, limits and
//! motors, error weights.

use super::parts::Tree;
use crate::joint::Sweep;
use crate::law::motor_constants;
use crate::law::normal::Stiffening;
use crate::model::Model;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{LIMIT_DEFLECTION, OVERSPEED, REFERENCE_GRAVITY, SPEED_RELAXATION};

impl Tree {
    /// Sets what depends on the initial position: stiffness of contacts and limits, error weights.
    ///
    /// - `inertia`: diagonal of the mass matrix, per degree of freedom
    /// - `poses`: pose of each body's solver frame, relative to the base
    pub fn scale(&mut self, model: &Model, inertia: &[f64], poses: &[Pose]) {
        let mass = self.moving_mass();
        let weight = mass * REFERENCE_GRAVITY;
        let spring = |stiffness: Option<f64>| {
            let penetration = model.contact.penetration;
            stiffness.map_or(Stiffening::new(weight, penetration), |k| {
                Stiffening::with_stiffness(k, weight)
            })
        };
        self.contact.spring = spring(model.contact.stiffness);
        for collider in &mut self.contact.colliders {
            let own = model.links[collider.link].stiffness;
            collider.spring = spring(own.or(model.contact.stiffness));
            self.contact.turning[collider.link].load = 0.25 * weight;
        }
        self.dofs.inertia.copy_from_slice(inertia);
        // Reach: farthest shape or centre of mass, from the base and from each joint's axis, over
        // its subtree.
        let mut points: Vec<(usize, Vec3, f64)> = model
            .colliders
            .iter()
            .map(|c| {
                let b = c.body.index();
                // The shape's place in the model's body frame and in the solver frame are equally
                // far from the axis.
                let X = &poses[b];
                (
                    b,
                    X.p + X.R * (model.bodies[b].motion.solver_frame().transpose() * c.X_BG.p),
                    c.shape.bounding_radius(),
                )
            })
            .collect();
        for (b, body) in self.bodies.iter().enumerate() {
            if body.mass > 0.0 {
                points.push((b, poses[b].point(&body.com), 0.0));
            }
        }
        let reach = points
            .iter()
            .map(|(_, p, r)| p.norm() + r)
            .fold(0.0, f64::max)
            .max(0.01);
        // Poses are from the one base that all trees share so far.
        for tree in &mut self.trees {
            tree.reach = reach;
        }
        let mut subtree_mass: Vec<f64> = self.bodies.iter().map(|b| b.mass).collect();
        for b in (1..self.bodies.len()).rev() {
            let m = subtree_mass[b];
            subtree_mass[self.bodies[b].parent] += m;
        }
        let mut levers = vec![0.0; inertia.len()];
        for (b, body) in self.bodies.iter().enumerate() {
            let within = |mut other: usize| {
                while other > b {
                    other = self.bodies[other].parent;
                }
                other == b
            };
            let lever = |axis: Option<Vec3>| {
                points
                    .iter()
                    .filter(|(other, ..)| within(*other))
                    .map(|(_, p, r)| {
                        let d = p - poses[b].p;
                        axis.map_or(d.norm(), |a| a.cross(&d).norm()) + r
                    })
                    .fold(0.0, f64::max)
            };
            for c in body.column..body.column + body.columns {
                let dof = self.dof[c];
                levers[dof] = lever(Some(poses[b].R.column(2).into_owned()));
                let gyration = (inertia[dof] / subtree_mass[b].max(1e-12)).sqrt();
                self.dofs.weight[dof] = match body.kind.sweep(c - body.column) {
                    Sweep::Along => 1.0,
                    Sweep::AboutPoint if body.kind.is_base() => reach.max(gyration).min(1.0),
                    Sweep::AboutPoint => lever(None).max(gyration).min(1.0),
                    Sweep::AboutAxis => levers[dof].max(gyration).min(1.0),
                };
            }
        }
        for (motor, actuator) in self.actuators.motors.iter_mut().zip(&model.actuators) {
            let dof = actuator.dof.index();
            // A wheel on the ground carries the whole robot along: damped for itself alone it would
            // overshoot.
            let inertia = inertia[dof].max(mass * levers[dof] * levers[dof]);
            *motor = motor_constants(actuator.reference_effort, inertia);
        }
        for (k, dof) in self.dofs.limit_stiffness.iter_mut().zip(0..) {
            let joint = model.bodies[model.dofs[dof].body.index()].joint;
            let effort = joint
                .and_then(|j| model.joints[j.index()].effort)
                .unwrap_or(0.0);
            let effort = if effort.is_finite() { effort } else { 0.0 };
            *k = effort.max(inertia[dof] * 100.0) / LIMIT_DEFLECTION;
            let limit = self.dofs.speed_limit[dof];
            if limit.is_finite() {
                let damping = effort / (OVERSPEED * limit);
                self.dofs.speed_damping[dof] = damping.max(inertia[dof] / SPEED_RELAXATION);
            }
        }
    }
}
