//! Friction against turning: the moments with which a contact resists rolling and drilling.
//!
//! A point alone lets its body roll and drill freely. Real contacts are patches: rolling costs a moment of
//! `rolling · n` about a tangent, drilling one of `torsional · n` about the normal, both coefficients in metres. The
//! law is that of sliding friction (see [`super::law`]), on the angular velocity: a spring–damper with a stored angle
//! and a plastic cap, one for the normal and one for the two tangents, so that a ball on a gentle slope stands for
//! ever. Most robots have none: the list of these elements is then empty.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::law::{Response, clip, slide, stretch};
use super::{Contact, normal_part, seek};
use crate::kinematics::Kinematics;
use crate::spatial::{Vec3, Vec6};
use crate::state::Touch;
use crate::tree::Tree;

/// Angle that a contact turns by before it gives way, under the load that its stiffness is made for, rad. The patch of
/// a tyre or a rubber ball turns by more, that of a steel ball by less.
const BREAKAWAY: f64 = 1e-3;

/// Friction of one contact against turning, in a step. Of each pair the first is torsional, the second rolling.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turn {
    /// Place of the contact in the list of contacts.
    pub contact: usize,
    /// Index of the body.
    pub body: usize,
    /// Place in the state, the contact's.
    pub slot: usize,
    /// The contact's.
    pub normal: Vec3,
    /// m
    pub coefficient: [f64; 2],
    /// Moments that slip, N·m: the coefficients times the normal force at the start of the step.
    pub cap: [f64; 2],
    /// N·m/rad
    pub stiffness: [f64; 2],
    /// N·m·s/rad
    pub damping: [f64; 2],
    /// Elastic angle at the start, world axes, rad: along the normal torsional, across it rolling.
    pub displacement: Vec3,
}

/// Lists the friction against turning of `contacts`, which are by ascending slot, into `turns`.
pub fn find_turns(
    tree: &Tree,
    touches: &[Touch],
    kin: &Kinematics,
    contacts: &[Contact],
    turns: &mut Vec<Turn>,
) {
    turns.clear();
    if !tree.resists_turning {
        return;
    }
    let mut touches = touches.iter().peekable();
    for (index, contact) in contacts.iter().enumerate() {
        let turning = &tree.turning[contact.link];
        if !turning.acts() {
            continue;
        }
        let share = contact.stiffness / turning.stiffness;
        let load = contact.stiffness * turning.penetration;
        let stiffness = turning.coefficient.map(|c| c * load / BREAKAWAY);
        let stored = seek(&mut touches, contact.slot, |t| t.slot).map_or([0.0; 3], |t| t.turn);
        let mut turn = Turn {
            contact: index,
            body: contact.body,
            slot: contact.slot,
            normal: contact.normal,
            coefficient: turning.coefficient,
            cap: [0.0; 2],
            stiffness,
            damping: stiffness.map(|k| 2.0 * (k * turning.inertia * share).sqrt()),
            displacement: stored.into(),
        };
        turn.carry(contact.normal_force(contact.normal_velocity(&kin.V)));
        turns.push(turn);
    }
}

/// Angular part of a spatial velocity.
#[inline]
pub fn angular(V: &Vec6) -> Vec3 {
    Vec3::new(V[0], V[1], V[2])
}

impl Turn {
    /// Sets the caps for a normal force, N.
    pub fn carry(&mut self, force: f64) {
        self.cap = self.coefficient.map(|c| c * force);
    }

    /// Whether it resists at all.
    pub fn holds(&self) -> bool {
        self.cap[0] > 0.0 || self.cap[1] > 0.0
    }

    /// Response to the angular velocity `w` of the body at the end of a step of `h` seconds: an impulse in N·m·s, a
    /// stiffness in kg·m² about the normal and about the tangents.
    pub fn response(&self, w: &Vec3, h: f64) -> Response {
        let (moment, torsional, rolling, slip) = self.moment(w, h);
        Response {
            impulse: moment * -h,
            normal: h * torsional,
            tangential: h * rolling,
            slip,
        }
    }

    /// Moment on the body at the start of the step, N·m, for its angular velocity `w`.
    pub fn force(&self, w: &Vec3) -> Vec3 {
        -self.moment(w, 0.0).0
    }

    /// Resisting moment, its derivatives with the angular velocity about the normal and about the tangents, and the
    /// tangent about which it slips.
    fn moment(&self, w: &Vec3, h: f64) -> (Vec3, f64, f64, Vec3) {
        let (w_normal, w_tangent) = normal_part(&self.normal, w);
        let (torsion, roll) = normal_part(&self.normal, &self.displacement);
        let [torsional, rolling] = [0, 1].map(|i| (self.stiffness[i], self.damping[i]));
        let (mut about_normal, mut slope) = (0.0, 0.0);
        if self.cap[0] > 0.0 {
            let b = torsional.0 * h + torsional.1;
            let y = torsional.0 * torsion + b * w_normal;
            (about_normal, slope) = if y.abs() <= self.cap[0] {
                (y, b)
            } else {
                (self.cap[0].copysign(y), 0.0)
            };
        }
        let (about_tangent, tangential, slip) = slide(&roll, &w_tangent, rolling, self.cap[1], h);
        let moment = self.normal * about_normal + about_tangent;
        (moment, slope, tangential, slip)
    }

    /// Elastic angle after the step, for the angular velocity that solved it.
    pub fn next_displacement(&self, w: &Vec3, h: f64) -> Vec3 {
        let (w_normal, w_tangent) = normal_part(&self.normal, w);
        let (moment, slope, _, slip) = self.moment(w, h);
        let (about_normal, about_tangent) = normal_part(&self.normal, &moment);
        let (torsion, roll) = normal_part(&self.normal, &self.displacement);
        let [torsional, rolling] = [0, 1].map(|i| (self.stiffness[i], self.damping[i]));
        let mut next = Vec3::zeros();
        if self.cap[0] > 0.0 {
            // Where it slips, the moment does not change with the velocity.
            let drill = if slope > 0.0 {
                Vec3::zeros()
            } else {
                self.normal * about_normal.signum()
            };
            let settled = self.normal * ((about_normal - torsional.1 * w_normal) / torsional.0);
            next = stretch(&(self.normal * torsion), settled, &drill, torsional, h);
        }
        if self.cap[1] > 0.0 {
            let settled = (about_tangent - w_tangent * rolling.1) / rolling.0;
            next += stretch(&roll, settled, &slip, rolling, h);
        }
        self.clipped(&next)
    }

    /// An elastic angle, cut down to what the caps can hold.
    pub fn clipped(&self, displacement: &Vec3) -> Vec3 {
        let (torsion, roll) = normal_part(&self.normal, displacement);
        let limit = |i: usize| {
            if self.cap[i] > 0.0 {
                self.cap[i] / self.stiffness[i]
            } else {
                0.0
            }
        };
        let most = limit(0);
        self.normal * torsion.clamp(-most, most) + clip(roll, limit(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Mat3;

    fn turn() -> Turn {
        Turn {
            normal: Vec3::new(0.0, 0.6, 0.8),
            coefficient: [0.02, 0.01],
            cap: [0.4, 0.2],
            stiffness: [300.0, 200.0],
            damping: [4.0, 3.0],
            displacement: Vec3::new(2e-4, -4e-4, 3e-4),
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
    fn moments_never_exceed_their_caps_and_no_more_is_remembered() {
        let t = turn();
        for speed in [0.0, 1e-4, 1e-2, 1.0, 100.0] {
            let w = Vec3::new(speed, -speed, 2.0 * speed);
            let (about_normal, about_tangent) = normal_part(&t.normal, &t.force(&w));
            assert!(about_normal.abs() <= t.cap[0] * (1.0 + 1e-12));
            assert!(about_tangent.norm() <= t.cap[1] * (1.0 + 1e-12));
            let next = t.next_displacement(&w, 1e-2);
            let (torsion, roll) = normal_part(&t.normal, &next);
            assert!(torsion.abs() * t.stiffness[0] <= t.cap[0] * (1.0 + 1e-12));
            assert!(roll.norm() * t.stiffness[1] <= t.cap[1] * (1.0 + 1e-12));
        }
    }

    #[test]
    fn a_contact_without_load_resists_nothing_and_forgets() {
        let mut t = turn();
        t.carry(0.0);
        let w = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(t.response(&w, 1e-2).impulse, Vec3::zeros());
        assert_eq!(t.next_displacement(&w, 1e-2), Vec3::zeros());
        assert!(!t.holds());
    }
}
