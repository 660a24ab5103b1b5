//! Stiffness, damping, friction and restitution of a contact whose points have been found.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, normal_part};
use super::memory::Touch;
use super::point::{ContactPoint, norm};
use crate::kinematics::Kinematics;
use crate::law::normal::Impact;
use crate::law::{Damping, ElastoPlastic, stribeck};
use crate::spatial::Vec3;
use crate::tree::{Surface, Tree};
use crate::tuning::{BOUNCE_THRESHOLD, DEEP_OVERLAP, EMERGENCE, PRESSED_IN, TANGENTIAL_RATIO};

/// How two shapes meet.
pub(super) struct Meeting<'a> {
    /// Friction and restitution.
    pub surface: &'a Surface,
    /// Hunt–Crossley dissipation without restitution, s/m.
    pub dissipation: f64,
    /// Acceleration that presses one of them on the other one, m/s².
    pub gravity: f64,
}

impl Meeting<'_> {
    /// Sets damping, friction and restitution of a contact whose points, spring and mass are set,
    /// and how its rims lean, for a step of `h` seconds.
    pub fn complete(
        &self,
        tree: &Tree,
        stored: &Touch,
        (kin, points): (&Kinematics, &mut [ContactPoint]),
        h: f64,
        contact: &mut Contact,
    ) {
        let (V, g) = (&kin.V, tree.world.gravity.norm());
        let speed = contact.normal_velocity(points, V);
        let u = contact.sliding(V);
        contact.bounce = stored.bounce;
        let surface = self.surface;
        let mass = contact.mass;
        if surface.restitution > 0.0 {
            let number = surface.dissipation_number;
            // It falls until it touches.
            let above = (-contact.depth).max(0.0);
            let gained = 2.0 * self.gravity * above;
            let impact = Impact {
                spring: contact.spring,
                mass,
                gravity: self.gravity,
                speed: (speed * speed + gained).max(0.0).sqrt(),
            };
            // Speed with which a body comes in that the spring has taken up.
            let kept = (2.0 * contact.spring.stored(contact.depth) / mass).sqrt();
            // Its spring has felt it come in with its number over its dissipation, or less. What
            // holds four times that energy, so deep, has been pressed in by others that it is in:
            // to give all of that back would throw it out.
            let pressed = contact.bounce * contact.weights * kept > PRESSED_IN * number;
            if pressed && contact.depth > DEEP_OVERLAP * contact.spring.reference {
                contact.bounce = 0.0;
            }
            // Shapes that hold more than they come with are not meeting, but are in each other,
            // and leave as such: mostly they have begun so.
            let least = kept.max(BOUNCE_THRESHOLD);
            let lands = contact.bounce == 0.0 && speed < 0.0 && impact.speed > least;
            if lands || contact.bounce > 0.0 {
                // A corner has a share of a face: the spring feels it come by less than its way,
                // and pushes it with less than its force.
                let reach = above + impact.speed * impact.duration();
                let (_, weights) = norm(&points[contact.points.clone()], reach);
                let mut felt = impact.felt(weights);
                if lands {
                    contact.bounce = felt.dissipation(surface.restitution, number);
                }
                // What it has come in with is in the spring by now.
                felt.speed = libm::hypot(felt.speed, weights * kept);
                contact.duration = felt.duration();
            }
        }
        contact.damping = self.damping(contact, g);
        let slope = TANGENTIAL_RATIO * contact.spring.slope(contact.depth);
        let (_, tangential) = normal_part(&contact.normal, &(u + contact.carried));
        contact.mu = friction(tree, surface, &tangential);
        contact.friction = ElastoPlastic {
            stiffness: slope,
            damping: 2.0 * (slope * mass).sqrt(),
            ..ElastoPlastic::default()
        };
        contact.friction.displacement = contact.recall_slip(&stored.displacement);
        let [load, elastic] = contact.loads(speed);
        contact.carry(load);
        contact.load = load.min(elastic);
        if contact.load > 0.0 {
            let dissipation = contact.damping.dissipation;
            let speed = contact.tilt_speed(points, V);
            contact.tilting = dissipation * contact.load / (1.0 + dissipation * speed);
        }
        contact.let_swing(points, h);
    }

    /// Damping of a contact whose bounce is known.
    ///
    /// - `gravity`: m/s²
    fn damping(&self, contact: &Contact, gravity: f64) -> Damping {
        if contact.bounce > 0.0 {
            return Damping {
                dissipation: contact.bounce,
                emergence: 0.0,
            };
        }
        let excess = contact.depth - DEEP_OVERLAP * contact.spring.reference;
        let emergence = if excess > 0.0 {
            // It leaves faster than a light touch, but slower than it would hop.
            (1.0 / self.dissipation).max(EMERGENCE * (2.0 * gravity * excess).sqrt())
        } else {
            0.0
        };
        Damping {
            dissipation: self.dissipation,
            emergence,
        }
    }
}

/// Coulomb coefficient of a contact that slides at `u`.
#[inline]
fn friction(tree: &Tree, surface: &Surface, u: &Vec3) -> f64 {
    if surface.mu_at_rest > surface.mu {
        let reference = tree.contact.stribeck_velocity;
        stribeck(surface.mu_at_rest, surface.mu, u.norm(), reference)
    } else {
        surface.mu
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::tests::{met, two_bodies};
    use crate::force::{ContactSet, detect};
    use crate::geometry::Shape;
    use crate::law::dissipation_number;
    use crate::simulation::Simulation;
    use crate::spatial::Pose;

    /// A spring that is 60 penetrations deep and holds more than the shapes have come in with has
    /// been pressed by others, and bounces no more; one that has taken up an impact goes on, and so
    /// does what is as deep as loads press. Before, what was pressed in among bodies that began in
    /// each other was resolved by 12,000 steps a communication step, and thrown out.
    #[test]
    fn what_is_pressed_into_others_bounces_no_more() {
        let radius = 0.05;
        for e in [0.3, 0.9, 1.0] {
            let shapes = [0; 2].map(|_| Shape::Sphere { radius });
            let mut model = two_bodies(&shapes).model().clone();
            for link in &mut model.links {
                link.restitution = e;
            }
            let s = Simulation::new(std::sync::Arc::new(model));
            // The share of the speed that it holds with which it has come in.
            for (depth, came, bounces) in [(60.0, 0.4, false), (60.0, 0.6, true), (30.0, 0.4, true)]
            {
                let pose = |depth: f64| Pose {
                    p: Vec3::z() * (2.0 * radius - depth),
                    ..Pose::IDENTITY
                };
                let between = |list: &ContactSet| {
                    let mut all = list.iter();
                    all.find(|c| c.other.is_some()).expect("they touch").clone()
                };
                let reference = between(&met(&s, &pose(0.01)).1).spring.reference;
                let (kin, mut list) = met(&s, &pose(depth * reference));
                let first = between(&list);
                let kept = (2.0 * first.spring.stored(first.depth) / first.mass).sqrt();
                let touch = Touch {
                    slot: first.slot,
                    bounce: dissipation_number(e) / (came * kept),
                    ..Touch::default()
                };
                detect(s.model(), s.tree(), &[touch], &kin, 0.0, &mut list);
                let bounce = between(&list).bounce;
                assert_eq!(bounce > 0.0, bounces, "{e}, {depth}, {came}: {bounce}");
            }
        }
    }
}
