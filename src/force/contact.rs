//! A contact point: Hunt–Crossley force along the normal, elasto-plastic Coulomb friction in the
//! tangent plane.
//!
//! Source: Hunt & Crossley 1975; Castro et al. 2022.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::law::{ElastoPlastic, HuntCrossley};
use crate::spatial::{Vec3, Vec6, add_force_at, velocity_at};

/// Impulse of a contact on its body and its derivative with the velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// N·s, world axes.
    pub impulse: Vec3,
    /// Normal stiffness, kg: minus the derivative of the normal impulse with the normal velocity.
    pub normal: f64,
    /// Tangential stiffness, kg, in every direction but `slip`.
    pub tangential: f64,
    /// Direction in which friction slips and has no stiffness; zero while it sticks.
    pub slip: Vec3,
}

/// A contact point of a step: what was found at its start, constant while the step is solved.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contact {
    /// Index of the body that it pushes along the normal.
    pub body: usize,
    /// Index of the body that it pushes against; none: the ground, which does not move.
    pub other: Option<usize>,
    /// Index of the link, for outputs.
    pub link: usize,
    /// Place of its displacement in the state.
    pub slot: usize,
    /// Position from O, m, world axes.
    pub x: Vec3,
    /// Unit vector from the ground or the other body into the body.
    pub normal: Vec3,
    /// Distance along the normal, positive apart, m.
    pub gap: f64,
    /// Law in the normal direction.
    pub spring: HuntCrossley,
    /// Approach speed that the dissipation was chosen for, m/s; 0 without restitution.
    pub touchdown: f64,
    /// Coulomb coefficient at the sliding speed at the start of the step.
    pub mu: f64,
    /// Friction in the tangent plane, world axes; it slips at `μ` times the normal force at the
    /// start of the step.
    pub friction: ElastoPlastic<Vec3>,
}

impl Response {
    /// `wᵀ G w` of its stiffness `G`, where `w` is a velocity.
    #[inline]
    pub fn curvature(&self, normal: &Vec3, w: &Vec3) -> f64 {
        let wn = normal.dot(w);
        let ws = self.slip.dot(w);
        self.tangential * (w.norm_squared() - wn * wn - ws * ws) + self.normal * wn * wn
    }
}

impl Contact {
    /// Velocity of the point on its body against that on the other one, m/s, world axes, where `V`
    /// are those of all bodies.
    #[inline]
    pub fn velocity(&self, V: &[Vec6]) -> Vec3 {
        let v = velocity_at(&V[self.body], &self.x);
        self.other
            .map_or(v, |other| v - velocity_at(&V[other], &self.x))
    }

    /// Adds a force on the body at the point, and its reaction on the other one, to the forces on
    /// all bodies about O; or impulses.
    #[inline]
    pub fn push(&self, force: &Vec3, F: &mut [Vec6]) {
        add_force_at(&mut F[self.body], &self.x, force);
        if let Some(other) = self.other {
            add_force_at(&mut F[other], &self.x, &-force);
        }
    }

    /// Its part along the normal, m/s, positive apart.
    #[inline]
    pub fn normal_velocity(&self, V: &[Vec6]) -> f64 {
        self.normal.dot(&self.velocity(V))
    }

    /// Sets the friction that slips for a normal force, N.
    #[inline]
    pub fn carry(&mut self, force: f64) {
        self.friction.cap = self.mu * force;
    }

    /// Response to the velocity `v` of the contact point at the end of a step of `h` seconds.
    #[inline]
    pub fn response(&self, v: &Vec3, h: f64) -> Response {
        let (vn, u) = normal_part(&self.normal, v);
        let (normal_impulse, normal) = self.spring.respond(self.gap, vn, h);
        let friction = self.friction.respond(u, h);
        Response {
            impulse: self.normal * normal_impulse - friction.force * h,
            normal,
            tangential: h * friction.slope,
            slip: friction.slip,
        }
    }

    /// Force on the body at the start of the step, N, for the velocity `v` of the point.
    pub fn force(&self, v: &Vec3) -> Vec3 {
        let (vn, u) = normal_part(&self.normal, v);
        self.normal * self.normal_force(vn) - self.friction.respond(u, 0.0).force
    }

    /// Normal force at the start of the step, N.
    #[inline]
    pub fn normal_force(&self, vn: f64) -> f64 {
        self.spring.force(self.gap, vn)
    }

    /// Energy that its normal spring holds at the start of the step, J.
    pub fn stored(&self) -> f64 {
        self.spring.stored(self.gap)
    }

    /// Elastic displacement after the step, for the velocity that solved it.
    #[inline]
    pub fn next_displacement(&self, v: &Vec3, h: f64) -> Vec3 {
        self.friction.next(normal_part(&self.normal, v).1, h)
    }
}

/// Component of `x` along the unit vector `normal`, and the remainder.
#[inline]
pub(super) fn normal_part(normal: &Vec3, x: &Vec3) -> (f64, Vec3) {
    let along = normal.dot(x);
    (along, x - normal * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact() -> Contact {
        Contact {
            normal: Vec3::new(0.0, 0.6, 0.8),
            gap: -1e-3,
            spring: HuntCrossley {
                stiffness: 1e5,
                dissipation: 3.0,
            },
            mu: 0.5,
            friction: ElastoPlastic {
                cap: 20.0,
                stiffness: 8e4,
                damping: 300.0,
                displacement: Vec3::new(1e-5, 0.0, 0.0),
            },
            ..Contact::default()
        }
    }

    #[test]
    fn response_stiffness_is_minus_the_derivative_of_the_impulse() {
        let (c, h) = (contact(), 1e-3);
        for v in [Vec3::new(0.01, -0.02, 0.01), Vec3::new(0.5, -0.1, -0.2)] {
            let r = c.response(&v, h);
            let G = crate::spatial::Mat3::identity() * r.tangential
                + c.normal * c.normal.transpose() * (r.normal - r.tangential)
                - r.slip * r.slip.transpose() * r.tangential;
            for axis in 0..3 {
                let mut step = Vec3::zeros();
                step[axis] = 1e-7;
                let difference = (c.response(&(v + step), h).impulse
                    - c.response(&(v - step), h).impulse)
                    / 2e-7;
                let expected = -G.column(axis);
                assert!(
                    (difference - expected).norm() < 1e-5 * G.norm(),
                    "{difference} {expected}"
                );
            }
        }
    }

    /// Work of the force on the element over the step, `h F·u`, against what its spring holds more,
    /// `½ k Δ|ς|²`. By hand: while it sticks `ς` moves by `h u`, and the rest is the damper's;
    /// while it slips the spring is stretched by no more than the slip's way, or loses. A cone that
    /// has shrunk since takes what it no longer holds.
    #[test]
    fn friction_gives_back_no_more_than_it_was_paid() {
        let mut random = crate::testing::Random(9);
        for _ in 0..10_000 {
            let mut c = contact();
            let h = libm::pow(10.0, random.uniform(-7.0, -1.0));
            let size = libm::pow(10.0, random.uniform(-5.0, 1.0));
            let flat = |x: Vec3| x - c.normal * c.normal.dot(&x);
            let most = c.friction.cap / c.friction.stiffness;
            let (stored, u) = (flat(random.vector(1.5 * most)), flat(random.vector(size)));
            c.friction.displacement = stored;
            let paid = -flat(c.response(&u, h).impulse).dot(&u);
            let next = c.next_displacement(&u, h);
            let more = 0.5 * c.friction.stiffness * (next.norm_squared() - stored.norm_squared());
            assert!(
                more <= paid + 1e-12 * c.friction.cap * most,
                "{h} {u} {stored}: {more} {paid}"
            );
        }
    }

    /// Both bodies feel the same force, with opposite signs, and moving together is no motion.
    #[test]
    fn two_bodies_push_each_other_with_opposite_forces_and_feel_their_relative_velocity() {
        let x = Vec3::new(0.1, -0.2, 0.3);
        let pair = Contact {
            body: 1,
            other: Some(2),
            x,
            ..contact()
        };
        let V = [[0.0; 6], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.5; 6]];
        let together = [V[0], V[1], V[1]];
        assert_eq!(pair.velocity(&together), Vec3::zeros());
        let alone = |body| Contact { body, ..contact() }.velocity(&V);
        let relative = Contact { x, ..pair }.velocity(&V);
        let lever = |body: usize| crate::spatial::angular(&V[body]).cross(&x);
        assert!((relative - (alone(1) + lever(1) - alone(2) - lever(2))).norm() < 1e-14);
        let mut F = [[0.0; 6]; 3];
        pair.push(&Vec3::new(7.0, 8.0, 9.0), &mut F);
        assert!(
            F[1].iter()
                .zip(&F[2])
                .all(|(a, b)| a + b == 0.0 && *a != 0.0)
        );
    }

    #[test]
    fn friction_and_its_stored_displacement_stay_within_the_cone() {
        let (c, h) = (contact(), 1e-2);
        for speed in [0.0, 1e-4, 1e-2, 1.0, 100.0] {
            let v = Vec3::new(speed, 0.0, 0.0);
            let tangential = c.response(&v, h).impulse.x.abs();
            assert!(tangential <= h * c.friction.cap * (1.0 + 1e-12));
            let stored = c.next_displacement(&v, h).norm() * c.friction.stiffness;
            assert!(stored <= c.friction.cap * (1.0 + 1e-12));
        }
    }
}
