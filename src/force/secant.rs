//! Contacts whose force agrees with how deep they are at both ends of a step.
//!
//! A step takes it that a contact's depth changes with the displacement `x` of its body against the
//! other one by the rows of its points, as they are in the middle of the step: `δ(x) = δ* − J x`.
//! Where the direction between two shapes turns fast, or points come and go, that is not so, not
//! even in a short step: the spring then holds energy that its force has not taken from anything.
//! A force that comes from a potential is the gradient of the depth, and what the rows lack of that
//! gradient is known along the way `d` of the step. With the errors `ε₀` and `ε₁` of the depth at
//! its ends, `J − ε d̂` and `δ* + c` meet both depths, with
//!
//! ```text
//! c = (ε₀ + ε₁)/2,    ε = ε₁ − ε₀,    d̂ = K d/(dᵀ K d)
//! ```
//!
//! and of all rows that do, these differ least from `J` by the metric `K` of displacements: of the
//! place of contact as they are, and of rotations times the mean square of its levers about the
//! centres of mass of both bodies. The force stays one between the two bodies in one place, so that
//! momentum is kept.
//!
//! Source: the discrete gradient of Gonzalez, Time integration and discrete Hamiltonian systems,
//! J. Nonlinear Science 6 (1996), for the depth in place of the energy.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::Contact;
use super::point::ContactPoint;
use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, Vec6, angular, velocity_at};
use crate::tree::Tree;
use crate::tuning::STEEP;

/// What the rows of a contact's points have to change by.
#[derive(Clone, Copy, Debug)]
pub struct Secant {
    slot: usize,
    /// Added to what a linear and an angular velocity, about O, is multiplied by.
    linear: Vec3,
    /// See `linear`, m.
    angular: Vec3,
    /// Added to the depth in the middle, m.
    deeper: f64,
}

impl Secant {
    /// Of a contact; none where its rows err by less than [`STEEP`], as what turns in a step does.
    ///
    /// - `errors`: by how much deeper it is at the start and at the end than the step takes it, m
    /// - `V`, `h`: mean velocities of all bodies over the step of `h` seconds
    pub fn new(
        (tree, kin): (&Tree, &Kinematics),
        contact: &Contact,
        errors: [f64; 2],
        (V, h): (&[Vec6], f64),
    ) -> Option<Self> {
        let W = contact.relative(V);
        let (way, turn) = (velocity_at(&W, &contact.center) * h, angular(&W) * h);
        let lever = |body: usize, center: Vec3| {
            let X = &kin.X[body];
            (center - (X.p + X.R * tree.bodies[body].com)).norm_squared()
        };
        let mut square = lever(contact.body, contact.center);
        if let Some(other) = &contact.other {
            square = 0.5 * (square + lever(other.body, contact.center + other.from));
        }
        let length = way.norm_squared() + square * turn.norm_squared();
        let error = errors[1] - errors[0];
        if error * error <= STEEP * STEEP * length {
            return None;
        }
        let share = error / (length * contact.weights);
        let linear = -way * share;
        Some(Self {
            slot: contact.slot,
            linear,
            angular: contact.center.cross(&linear) - turn * (square * share),
            deeper: 0.5 * (errors[0] + errors[1]) / contact.weights,
        })
    }

    /// Which contact it is of.
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// This one after another one of the same contact.
    pub fn add(&mut self, other: &Self) {
        self.linear += other.linear;
        self.angular += other.angular;
        self.deeper += other.deeper;
    }

    /// Changes the rows of a contact's points.
    pub fn bend(&self, contact: &mut Contact, points: &mut [ContactPoint]) {
        contact.uneven = true;
        for p in &mut points[contact.points.clone()] {
            p.row += self.linear;
            p.arm += self.angular;
            p.depth += self.deeper;
        }
    }
}

#[cfg(test)]
crate::spoil::spoil!(Secant: slot linear angular deeper;);
