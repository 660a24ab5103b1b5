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
use crate::tuning::{
    BOUNCE_THRESHOLD, DEEP_OVERLAP, EMERGENCE, PRESSED_IN, SMOOTH_OVERLAP, TANGENTIAL_RATIO,
};

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
        let surface = self.surface;
        let mass = contact.mass;
        // What has come in with a restitution that has been set to 0 since bounces no more.
        if surface.restitution > 0.0 {
            contact.bounce = stored.bounce;
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
            let meets = speed < 0.0 && impact.speed > least;
            if meets || contact.bounce > 0.0 {
                // A corner has a share of a face: the spring feels it come by less than its way,
                // and pushes it with less than its force.
                let reach = above + impact.speed * impact.duration();
                let (_, weights) = norm(&points[contact.points.clone()], reach);
                let mut felt = impact.felt(weights);
                // What it has come in with is in the spring by now.
                let whole = libm::hypot(felt.speed, weights * kept);
                if meets {
                    contact.bounce = self.landing(contact, &felt, whole);
                }
                felt.speed = whole;
                contact.duration = felt.duration();
            }
        }
        contact.damping = self.damping(contact, g);
        let slope = TANGENTIAL_RATIO * contact.spring.slope(contact.depth);
        let (_, tangential) = normal_part(&contact.normal, &(u + contact.carried));
        // What pushes apart shapes that have begun in each other is no load that they carry: it is
        // a million times their weight, and its friction would throw out what is light.
        let overlap = contact.depth / contact.spring.reference;
        let rubbing = (SMOOTH_OVERLAP - overlap) / (SMOOTH_OVERLAP - DEEP_OVERLAP);
        contact.rubbing = rubbing.clamp(0.0, 1.0);
        let sliding = tangential.norm();
        if surface.mu_at_rest > surface.mu {
            contact.wound = ElastoPlastic::<Vec3>::wound(sliding, stored.sliding);
        }
        contact.mu = friction(tree, surface, stored.sliding * sliding) * contact.rubbing;
        contact.turning = surface.turning;
        let [load, elastic] = contact.loads(speed);
        // An impact presses with more than the spring does, and its friction is as much quicker:
        // with the damper of a load at rest it gave way sideways first, and when it had caught up
        // no load was left to stop the slip.
        let pressing = if load > elastic { load / elastic } else { 1.0 };
        contact.critical = 2.0 * (slope * pressing * mass).sqrt();
        contact.dissipation = self.dissipation;
        contact.friction = ElastoPlastic {
            stiffness: slope,
            ..ElastoPlastic::default()
        };
        contact.friction.displacement = contact.recall_slip(&stored.displacement);
        contact.carry(load);
        contact.slide_along(&u);
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
            return Damping::new(contact.bounce);
        }
        let weights = contact.spring.weights(contact.depth);
        let common = Damping::leaving(self.dissipation, weights);
        let excess = contact.depth - DEEP_OVERLAP * contact.spring.reference;
        // It leaves faster than a light touch, but slower than it would hop.
        let hop = libm::sqrt(2.0 * gravity * excess.max(0.0));
        Damping {
            fastest: common.fastest.max(EMERGENCE * hop),
            ..common
        }
    }

    /// Dissipation of a contact that bounces, s/m, while its shapes come in as `felt` by its
    /// spring; `whole`: the same speed with all that the spring has taken up, m/s.
    ///
    /// It is that of their touch-down, unless others have thrown them against each other since:
    /// then the impact is the one that has come through these. Of balls that lie side by side the
    /// first one moves the second one slowly before the third one feels it. With the dissipation
    /// of this slow touch nothing came back: a break of billiard balls lost 0.86 of its energy at
    /// a restitution of 0.9, and 0.40 where gaps of 1 mm lay between them.
    fn landing(&self, contact: &Contact, felt: &Impact, whole: f64) -> f64 {
        let (e, number) = (self.surface.restitution, self.surface.dissipation_number);
        if contact.bounce == 0.0 {
            return felt.dissipation(e, number);
        }
        // What the weight gives on the way counts with the dissipation itself.
        let given = 2.0 * felt.gravity * contact.depth.max(0.0);
        let speed = (whole * whole - given).max(0.0).sqrt();
        if contact.bounce * speed > number {
            Impact { speed, ..*felt }.dissipation(e, number)
        } else {
            contact.bounce
        }
    }
}

/// Coulomb coefficient of a contact that slips at `speed`, m/s.
#[inline]
fn friction(tree: &Tree, surface: &Surface, speed: f64) -> f64 {
    if surface.mu_at_rest > surface.mu {
        let reference = tree.contact.stribeck_velocity;
        stribeck(surface.mu_at_rest, surface.mu, speed, reference)
    } else {
        surface.mu
    }
}

#[cfg(test)]
mod tests;
