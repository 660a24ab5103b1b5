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
//! centres of mass of both bodies, of each as much as it turns. The force stays one between the two
//! bodies in one place, so that momentum is kept.
//!
//! What `ε` adds to the depth within a step is no approach of the two bodies, and Hunt and
//! Crossley's damping does not count it: a ball that rolls onto a second facet of a mesh is a fifth
//! deeper at once, however short the step, and damped along `−ε d̂` it would lose `F D ε²/|d|` of
//! its momentum, without bound. Of a rate it leaves out no more than the whole, so that it never
//! acts along with the motion.
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
    /// How fast the depth grows by what is added to the rows, and at all, m/s.
    rates: [f64; 2],
}

impl Secant {
    /// Of a contact; none where its rows err by less than [`STEEP`], as what turns in a step does.
    ///
    /// - `errors`: by how much deeper it is at the start and at the end than the step takes it, m
    /// - `grown`: by how much deeper it has become, m
    /// - `V`, `h`: mean velocities of all bodies over the step of `h` seconds
    pub fn new(
        (tree, kin): (&Tree, &Kinematics),
        contact: &Contact,
        (errors, grown): ([f64; 2], f64),
        (V, h): (&[Vec6], f64),
    ) -> Option<Self> {
        let W = contact.relative(V);
        let (way, turn) = (velocity_at(&W, &contact.center) * h, angular(&W) * h);
        let square = mean_square_of_levers((tree, kin), contact, V);
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
            rates: [error / h, grown / h],
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
        self.rates = [self.rates[0] + other.rates[0], other.rates[1]];
    }

    /// A share of it.
    pub fn scale(&mut self, share: f64) {
        self.linear *= share;
        self.angular *= share;
        self.deeper *= share;
        self.rates[0] *= share;
    }

    /// Changes the rows of a contact's points.
    pub fn bend(&self, contact: &mut Contact, points: &mut [ContactPoint]) {
        let [bent, whole] = self.rates;
        contact.bent = bent.clamp(whole.min(0.0), whole.max(0.0));
        contact.uneven = true;
        for p in &mut points[contact.points.clone()] {
            p.row += self.linear;
            p.arm += self.angular;
            p.depth += self.deeper;
        }
    }
}

/// Mean square of the levers of a contact about the centres of mass of both of its bodies, m², of
/// each in proportion to the square of how fast it turns: a lever of what stands still moves
/// nothing.
fn mean_square_of_levers((tree, kin): (&Tree, &Kinematics), contact: &Contact, V: &[Vec6]) -> f64 {
    let lever = |body: usize, center: Vec3| {
        let X = &kin.X[body];
        (center - (X.p + X.R * tree.bodies[body].com)).norm_squared()
    };
    let own = lever(contact.body, contact.center);
    let Some(other) = &contact.other else {
        return own;
    };
    let others = lever(other.body, contact.center + other.from);
    let [a, b] = [contact.body, other.body].map(|body| angular(&V[body]).norm_squared());
    if a + b > 0.0 {
        (a * own + b * others) / (a + b)
    } else {
        0.5 * (own + others)
    }
}

#[cfg(test)]
crate::spoil::spoil!(Secant: slot linear angular deeper rates;);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::tests::{met, two_bodies};
    use crate::geometry::Shape;
    use crate::spatial::Pose;

    /// What turns in a step by `θ` moves its surface by `θ` times its own lever, however large that
    /// is which it turns on: a depth that errs by a fiftieth of that way has a secant, the same on
    /// a box of 0.1 m and of 10 m. With a mean of both levers a body of 2 cm that whirled between
    /// the ground and one of 1 m had none.
    #[test]
    fn what_turns_on_a_large_body_has_the_secants_that_it_has_on_a_small_one() {
        let small = Vec3::repeat(0.01);
        let mut found = Vec::new();
        for large in [0.05, 0.5, 5.0] {
            let s = two_bodies(&[small, Vec3::repeat(large)].map(|half| Shape::Box { half }));
            // Flat on the top of the large one, near a corner of that.
            let at = Vec3::new(large - 0.02, large - 0.02, large + 0.01 - 1e-4);
            let (kin, list) = met(
                &s,
                &Pose {
                    p: at,
                    ..Pose::IDENTITY
                },
            );
            let contact = list
                .iter()
                .find(|c| c.other.is_some() && c.depth > 0.0)
                .expect("they touch");
            // One of them turns by 1 mrad about the place of contact.
            let (turn, h) = (Vec3::x() * 100.0, 1e-5);
            let secant = |turning: usize| {
                let other = contact.other.expect("another body");
                let from = if contact.body == turning {
                    contact.center
                } else {
                    contact.center + other.from
                };
                let v = from.cross(&turn);
                let mut V = [[0.0; 6]; 2];
                V[turning] = [turn.x, turn.y, turn.z, v.x, v.y, v.z];
                // The lever of the small one is 1 cm, so its surface moves by 10 µm.
                Secant::new((s.tree(), &kin), contact, ([0.0, 2e-7], 0.0), (&V, h))
            };
            found.push(secant(0).expect("a fiftieth of its way"));
            // Of the way of the large one it is less than a 200th.
            assert!(secant(1).is_none(), "{large}");
        }
        for other in &found[1..] {
            assert!((other.deeper / found[0].deeper - 1.0).abs() < 1e-9);
            assert!((other.angular - found[0].angular).norm() < 1e-9 * found[0].angular.norm());
        }
    }
}
