//! Friction against turning: the moments with which a contact resists rolling and drilling.
//!
//! A single contact point does not resist rolling and spinning. Real contacts are patches: rolling
//! costs a moment of `rolling · n` about a tangent, drilling one of `torsional · n` about the
//! normal, both coefficients in metres. The law is that of sliding friction (see
//! [`crate::law::friction`]), on the angular velocity: a spring–damper with a stored angle and a
//! plastic cap, one for the normal and one for the two tangents, so that a ball on a gentle slope
//! stands for ever. Most robots have none: the list of these elements is then empty.
//!
//! The stiffness is that with which the moment that slips, `c N`, is reached at an angle `θ` of
//! [`TURN_DEFLECTION`]:
//!
//! ```text
//! k = c max(N₀, N_w)/θ,    d = 2 √(k I)
//! ```
//!
//! where `N₀` is the load at the start of the step and `N_w` that of a quarter of the weight, for
//! what has just met. Fingers that press a light rod with a hundred times its weight turn by `θ`,
//! too, before it slips, and not by `100 θ`. As the load changes, so does the stiffness; what is
//! remembered is `√(k/k_w) ς`, by which the energy stays, as for sliding (see [`super::contact`]).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::normal_part;
use super::gather::ContactSet;
use super::memory::{Touch, seek};
use crate::kinematics::Kinematics;
use crate::law::ElastoPlastic;
use crate::spatial::{Vec3, Vec6, angular};
use crate::tree::Tree;
use crate::tuning::TURN_DEFLECTION;

/// Friction of one contact against turning, in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turn {
    /// Place of the contact in the list of contacts.
    pub contact: usize,
    /// Index of the body.
    pub body: usize,
    /// Index of the body that it turns against; none: what does not move.
    pub other: Option<usize>,
    /// Place in the state, the contact's.
    pub slot: usize,
    /// The contact's.
    pub normal: Vec3,
    /// Torsional and rolling coefficient, m: the moments that slip are those times the normal
    /// force.
    pub coefficient: [f64; 2],
    /// Load that its stiffness is made for, N.
    pub load: f64,
    /// Square root of how much stiffer it is than with a quarter of the weight.
    pub stiffened: f64,
    /// Square of the critical damping over the load that it is critical for, kg·m³, of both.
    pub critical: [f64; 2],
    /// Friction about the normal.
    pub torsional: ElastoPlastic<f64>,
    /// Friction about the tangents, world axes.
    pub rolling: ElastoPlastic<Vec3>,
}

/// Lists the friction against turning of `contacts`, which are by ascending slot, into `turns`.
pub fn find_turns(
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    contacts: &ContactSet,
    turns: &mut Vec<Turn>,
) {
    turns.clear();
    if !tree.contact.resists_turning {
        return;
    }
    let mut touches = touches.iter().peekable();
    for (index, contact) in contacts.iter().enumerate() {
        if contact.turning.iter().all(|c| *c <= 0.0) {
            continue;
        }
        let other = contact.other.filter(|other| !tree.is_driven(other.body));
        let other = other.and(contact.other_link);
        let turning = tree.contact.turning_of(contact.link, other);
        let stored = seek(&mut touches, contact.slot, |t| t.slot).map_or([0.0; 3], |t| t.turn);
        let along = contact.normal_velocity(&contacts.points, &kin.V);
        let [force, held] = contact.loads(along);
        let load = held.max(turning.load);
        let stiffened = (load / turning.load).sqrt();
        let angle = contact.recall(&stored) / stiffened;
        let (torsion, roll) = normal_part(&contact.normal, &angle);
        let [torsional, rolling] = contact.turning.map(|c| c * load / TURN_DEFLECTION);
        let mut turn = Turn {
            contact: index,
            body: contact.body,
            other: contact.other.map(|other| other.body),
            slot: contact.slot,
            normal: contact.normal,
            coefficient: contact.turning.map(|c| c * contact.rubbing),
            load,
            stiffened,
            critical: contact
                .turning
                .map(|c| 4.0 * turning.inertia * c / TURN_DEFLECTION),
            torsional: ElastoPlastic {
                stiffness: torsional,
                displacement: torsion,
                ..ElastoPlastic::default()
            },
            rolling: ElastoPlastic {
                stiffness: rolling,
                displacement: roll,
                ..ElastoPlastic::default()
            },
        };
        turn.carry(force);
        turns.push(turn);
    }
}

/// Impulse of the friction against turning on its body and its derivative with the velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct TurnResponse {
    /// N·m·s, world axes.
    pub impulse: Vec3,
    /// Stiffness about the normal, kg·m²: minus the derivative of the impulse.
    pub normal: f64,
    /// Stiffness about the tangents, in every direction but `slip`, kg·m².
    pub tangential: f64,
    /// Tangent about which it slips and has no stiffness; zero while it sticks.
    pub slip: Vec3,
}

impl TurnResponse {
    /// `wᵀ G w` of its stiffness `G`, where `w` is an angular velocity.
    #[inline]
    pub fn curvature(&self, normal: &Vec3, w: &Vec3) -> f64 {
        let wn = normal.dot(w);
        let ws = self.slip.dot(w);
        self.tangential * (w.norm_squared() - wn * wn - ws * ws) + self.normal * wn * wn
    }
}

impl Turn {
    /// Angular velocity of its body against the other one, where `V` are those of all.
    #[inline]
    pub fn relative(&self, V: &[Vec6]) -> Vec3 {
        let w = angular(&V[self.body]);
        self.other.map_or(w, |other| w - angular(&V[other]))
    }

    /// Adds a moment on the body, and its reaction, to the forces on all bodies; or impulses.
    #[inline]
    pub fn act(&self, moment: &Vec3, F: &mut [Vec6]) {
        for (sum, x) in F[self.body][..3].iter_mut().zip(moment.iter()) {
            *sum += x;
        }
        if let Some(other) = self.other {
            for (sum, x) in F[other][..3].iter_mut().zip(moment.iter()) {
                *sum -= x;
            }
        }
    }

    /// Sets the moments that slip for a normal force, N, and the dampers: critical for the load
    /// that the stiffness is made for, and in an impact as if it were made for that. With the
    /// damper of the load at rest an impact was over before friction against turning had set in.
    pub fn carry(&mut self, force: f64) {
        let dampers = self.critical.map(|c| (c * self.load.max(force)).sqrt());
        [self.torsional.cap, self.rolling.cap] = self.coefficient.map(|c| c * force);
        [self.torsional.damping, self.rolling.damping] = dampers;
    }

    /// Begins with `share` of the change from its own angle to that of what is remembered, in world
    /// axes.
    pub fn begin(&mut self, kept: &Vec3, share: f64) {
        let (torsion, roll) = normal_part(&self.normal, &(kept / self.stiffened));
        let (t, r) = (
            &mut self.torsional.displacement,
            &mut self.rolling.displacement,
        );
        *t += share * (torsion - *t);
        *r += (roll - *r) * share;
    }

    /// Whether it resists at all.
    pub fn holds(&self) -> bool {
        self.torsional.cap > 0.0 || self.rolling.cap > 0.0
    }

    /// Response to the angular velocity `w` of the body at the end of a step of `h` seconds: an
    /// impulse in N·m·s, a stiffness in kg·m² about the normal and about the tangents.
    pub fn response(&self, w: &Vec3, h: f64) -> TurnResponse {
        let (w_normal, w_tangent) = normal_part(&self.normal, w);
        let torsional = self.torsional.respond(w_normal, h);
        let rolling = self.rolling.respond(w_tangent, h);
        TurnResponse {
            impulse: (self.normal * torsional.force + rolling.force) * -h,
            normal: h * torsional.slope,
            tangential: h * rolling.slope,
            slip: rolling.slip,
        }
    }

    /// Moment on the body at the start of the step, N·m, for its angular velocity `w`.
    pub fn force(&self, w: &Vec3) -> Vec3 {
        let (w_normal, w_tangent) = normal_part(&self.normal, w);
        let about_normal = self.torsional.respond(w_normal, 0.0).force;
        -(self.normal * about_normal + self.rolling.respond(w_tangent, 0.0).force)
    }

    /// How fast what is remembered changes where no steps are taken, rad/s, world axes, for the
    /// velocities of all bodies.
    pub fn memory_rate(&self, V: &[Vec6]) -> Vec3 {
        let (w_normal, w_tangent) = normal_part(&self.normal, &self.relative(V));
        let rate = self.normal * self.torsional.rate(w_normal) + self.rolling.rate(w_tangent);
        rate * self.stiffened
    }

    /// What is remembered after the step, for the angular velocity that solved it: the elastic
    /// angle, world axes, rad, along the normal torsional, across it rolling, with which it would
    /// hold the same energy at the stiffness that it has with a quarter of the weight.
    pub fn remembered(&self, w: &Vec3, h: f64) -> Vec3 {
        self.next_displacement(w, h) * self.stiffened
    }

    /// Elastic angle after the step, world axes, rad.
    fn next_displacement(&self, w: &Vec3, h: f64) -> Vec3 {
        let (w_normal, w_tangent) = normal_part(&self.normal, w);
        self.normal * self.torsional.next(w_normal, h) + self.rolling.next(w_tangent, h)
    }

    /// An elastic angle, cut down to what the caps can hold.
    pub fn clipped(&self, displacement: &Vec3) -> Vec3 {
        let (torsion, roll) = normal_part(&self.normal, displacement);
        self.normal * self.torsional.clipped(torsion) + self.rolling.clipped(roll)
    }

    /// At most twice the energy that it has stored, J: both angles count with the stiffer of the
    /// two springs.
    pub fn twice_stored(&self) -> f64 {
        let (torsion, roll) = (self.torsional.displacement, self.rolling.displacement);
        let stiffness = self.torsional.stiffness.max(self.rolling.stiffness);
        stiffness * (roll.norm_squared() + torsion * torsion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Radial;
    use crate::spatial::Mat3;

    fn turn() -> Turn {
        let normal = Vec3::new(0.0, 0.6, 0.8);
        let (torsion, roll) = normal_part(&normal, &Vec3::new(2e-4, -4e-4, 3e-4));
        Turn {
            normal,
            coefficient: [0.02, 0.01],
            torsional: ElastoPlastic {
                cap: 0.4,
                stiffness: 300.0,
                damping: 4.0,
                displacement: torsion,
                limit: Radial,
            },
            rolling: ElastoPlastic {
                cap: 0.2,
                stiffness: 200.0,
                damping: 3.0,
                displacement: roll,
                limit: Radial,
            },
            ..Turn::default()
        }
    }

    #[test]
    fn response_stiffness_is_minus_the_derivative_of_the_impulse() {
        let (t, h) = (turn(), 1e-2);
        // Both stick; one slips, the other sticks; both slip.
        for w in [
            Vec3::new(0.005, -0.006, 0.004),
            Vec3::new(0.9, 0.0, 0.0),
            Vec3::new(0.0, 0.6, 0.8),
            Vec3::new(0.5, -2.0, 3.0),
        ] {
            let r = t.response(&w, h);
            let n = t.normal;
            let G = Mat3::identity() * r.tangential + n * n.transpose() * (r.normal - r.tangential)
                - r.slip * r.slip.transpose() * r.tangential;
            for axis in 0..3 {
                let mut step = Vec3::zeros();
                step[axis] = 1e-7;
                let difference = (t.response(&(w + step), h).impulse
                    - t.response(&(w - step), h).impulse)
                    / 2e-7;
                let expected = -G.column(axis);
                assert!(
                    (difference - expected).norm() < 1e-6 * (1.0 + G.norm()),
                    "{w} {difference} {expected}"
                );
            }
        }
    }

    /// The gradient of a convex cost: the impulse falls along every change of the velocity.
    #[test]
    fn the_impulse_is_monotone_in_the_angular_velocity() {
        let mut random = crate::testing::Random(5);
        let t = turn();
        for _ in 0..2000 {
            let h = libm::pow(10.0, random.uniform(-6.0, -1.0));
            let [a, b] = [0, 1].map(|_| {
                let size = libm::pow(10.0, random.uniform(-4.0, 1.0));
                random.vector(size)
            });
            let (ga, gb) = (t.response(&a, h).impulse, t.response(&b, h).impulse);
            assert!((ga - gb).dot(&(a - b)) <= 1e-15, "{a} {b}");
        }
    }

    #[test]
    fn moments_and_their_stored_angles_stay_within_their_caps() {
        let t = turn();
        for speed in [0.0, 1e-4, 1e-2, 1.0, 100.0] {
            let w = Vec3::new(speed, -speed, 2.0 * speed);
            let (about_normal, about_tangent) = normal_part(&t.normal, &t.force(&w));
            assert!(about_normal.abs() <= t.torsional.cap * (1.0 + 1e-12));
            assert!(about_tangent.norm() <= t.rolling.cap * (1.0 + 1e-12));
            let next = t.next_displacement(&w, 1e-2);
            let (torsion, roll) = normal_part(&t.normal, &next);
            assert!(torsion.abs() * t.torsional.stiffness <= t.torsional.cap * (1.0 + 1e-12));
            assert!(roll.norm() * t.rolling.stiffness <= t.rolling.cap * (1.0 + 1e-12));
        }
    }

    #[test]
    fn a_contact_without_load_has_no_force_and_no_memory() {
        let mut t = turn();
        t.carry(0.0);
        let w = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(t.response(&w, 1e-2).impulse, Vec3::zeros());
        assert_eq!(t.next_displacement(&w, 1e-2), Vec3::zeros());
        assert!(!t.holds());
    }
}
