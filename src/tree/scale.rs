//! Quantities that follow from the robot in its initial position: stiffness of contacts, limits and
//! motors, error weights.

use super::parts::{Tree, TreeBody};
use super::within;
use crate::joint::Sweep;
use crate::law::motor_constants;
use crate::law::normal::Stiffening;
use crate::model::Model;
use crate::spatial::{Pose, Vec3};
use crate::tuning::{LIMIT_DEFLECTION, LIMIT_LOAD, OVERSPEED, REFERENCE_GRAVITY, SPEED_RELAXATION};

impl Tree {
    /// Finds which components of velocities are those of one vector.
    pub(super) fn find_vectors(&mut self) {
        for body in &self.bodies {
            for column in body.column..body.column + body.columns {
                let mut vector = vector_of(body, column);
                self.dofs.components[self.dof[column]] = match vector.next() {
                    Some(first) if first == column => 1 + vector.count(),
                    _ => 0,
                };
            }
        }
    }

    /// What the limit of a joint is made for at least, N·m or N.
    #[inline]
    pub fn limit_load(&self, dof: usize) -> f64 {
        LIMIT_LOAD * self.dofs.inertia[dof]
    }

    /// Sets what depends on the initial position: stiffness of contacts and limits, error weights.
    ///
    /// - `inertia`: diagonal of the mass matrix, per degree of freedom
    /// - `poses`: pose of each body's solver frame, relative to the base of its tree
    pub fn scale(&mut self, model: &Model, inertia: &[f64], poses: &[Pose]) {
        let spring = |weight: f64, stiffness: Option<f64>| {
            let penetration = model.contact.penetration;
            stiffness.map_or(Stiffening::new(weight, penetration), |k| {
                Stiffening::with_stiffness(k, weight)
            })
        };
        let weight_of = |tree: usize| self.trees[tree].moving_mass * REFERENCE_GRAVITY;
        for collider in &mut self.contact.colliders {
            let weight = weight_of(collider.tree);
            let own = model.links[collider.link].stiffness;
            collider.spring = spring(weight, own.or(model.contact.stiffness));
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
                let X_SG = within(&model.solver_frame(c.body), &c.X_BG);
                (b, poses[b].point(&X_SG.p), c.shape.bounding_radius())
            })
            .collect();
        for (b, body) in self.bodies.iter().enumerate() {
            if body.mass > 0.0 {
                points.push((b, poses[b].point(&body.com), 0.0));
            }
        }
        for tree in &mut self.trees {
            let own = points.iter().filter(|(b, ..)| tree.bodies.contains(b));
            let reach = own.map(|(_, p, r)| p.norm() + r).fold(0.0, f64::max);
            tree.reach = reach.max(0.01);
        }
        let mut subtree_mass: Vec<f64> = self.bodies.iter().map(|b| b.mass).collect();
        for (b, body) in self.bodies.iter().enumerate().rev() {
            if !body.kind.is_base() {
                let m = subtree_mass[b];
                subtree_mass[body.parent] += m;
            }
        }
        let reaches = self.reaches(&points, poses);
        let mut levers = vec![0.0; inertia.len()];
        for (b, body) in self.bodies.iter().enumerate() {
            let [about_axis, about_point] = reaches[b];
            let reaching = |far: f64, moment: f64| {
                let gyration = (moment / subtree_mass[b].max(1e-12)).sqrt();
                far.max(gyration).min(1.0)
            };
            for c in body.column..body.column + body.columns {
                let dof = self.dof[c];
                levers[dof] = about_axis;
                self.dofs.weight[dof] = match body.kind.sweep(c - body.column) {
                    Sweep::Along => 1.0,
                    Sweep::AboutPoint => {
                        let far = if body.kind.is_base() {
                            self.trees[body.tree].reach
                        } else {
                            about_point
                        };
                        // Half of the trace is the moment about the point, whatever the axes are.
                        let diagonal = vector_of(body, c).map(|c| inertia[self.dof[c]]);
                        reaching(far, 0.5 * diagonal.sum::<f64>())
                    }
                    Sweep::AboutAxis => reaching(levers[dof], inertia[dof]),
                };
            }
        }
        for (motor, actuator) in self.actuators.motors.iter_mut().zip(&model.actuators) {
            let dof = actuator.dof.index();
            let body = model.dofs[dof].body.index();
            let mass = self.trees[self.bodies[body].tree].moving_mass;
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
            *k = effort.max(LIMIT_LOAD * inertia[dof]) / LIMIT_DEFLECTION;
            let limit = self.dofs.speed_limit[dof];
            if limit.is_finite() {
                let damping = effort / (OVERSPEED * limit);
                self.dofs.speed_damping[dof] = damping.max(inertia[dof] / SPEED_RELAXATION);
            }
        }
    }
}

impl Tree {
    /// How far what moves with each body reaches from the axis of its frame, and from its origin.
    /// Each point counts for the bodies from its own up to the base, so that the effort is the sum
    /// of their depths.
    ///
    /// - `points`: bodies, places and radii
    fn reaches(&self, points: &[(usize, Vec3, f64)], poses: &[Pose]) -> Vec<[f64; 2]> {
        let mut reaches = vec![[0.0; 2]; self.bodies.len()];
        for (own, p, r) in points {
            let mut b = *own;
            loop {
                let d = p - poses[b].p;
                let axis = poses[b].R.column(2).into_owned();
                let far = [axis.cross(&d).norm() + r, d.norm() + r];
                for (reach, far) in reaches[b].iter_mut().zip(far) {
                    *reach = f64::max(*reach, far);
                }
                if self.bodies[b].kind.is_base() {
                    break;
                }
                b = self.bodies[b].parent;
            }
        }
        reaches
    }
}

/// Columns whose velocities are the components of the vector that the one of `column` belongs to.
fn vector_of(body: &TreeBody, column: usize) -> impl Iterator<Item = usize> + use<> {
    let (kind, first) = (body.kind, body.column);
    let sweep = kind.sweep(column - first);
    (first..first + body.columns).filter(move |other| kind.sweep(other - first) == sweep)
}
