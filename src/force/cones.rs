//! Friction cones: how the force at which friction slips depends on the normal force.
//!
//! Within a Newton iteration of a step the cones are constant, which keeps the step a convex
//! minimisation. Between iterations they are set to the normal forces that have been found
//! ([`Terms::carry`]). Newton's direction may foresee what that will do, to first order: friction
//! that slips along `ŝ` changes by `−μ δL ŝ` where the load of its contact changes by `δL`
//! ([`Terms::foresee`]).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response};
use super::gather::ContactSet;
use super::point::{ContactPoint, PointResponse};
use super::terms::{Responses, Terms, Velocities};
use crate::law::{ElastoPlastic, Limit as _};
use crate::spatial::{Vec3, Vec6};

/// By how much the friction cone of a contact that slips grows, N·s: along a direction, and along
/// what that growth changes of the direction.
pub type Growth = [f64; 2];

impl Terms {
    /// Puts friction to where the normal forces of responses act.
    pub fn center(&mut self, responses: &Responses) {
        let ContactSet { list, points, .. } = &mut self.contacts;
        for (contact, r) in list.iter_mut().zip(&responses.contacts) {
            let of = &responses.points[contact.points.clone()];
            contact.stand(&contact.footing_under(points, (r, of)));
        }
    }

    /// Sets the friction cones to the normal forces that responses over `h` seconds have.
    pub fn carry(&mut self, responses: &Responses, h: f64) {
        for (contact, response) in self.contacts.list.iter_mut().zip(&responses.contacts) {
            contact.carry(response.load / h);
        }
        for turn in &mut self.turns {
            turn.carry(responses.contacts[turn.contact].load / h);
        }
    }

    /// Sets the friction in responses, and what it acts against, to that at the velocities `V` of
    /// all bodies, after [`Self::center`] and [`Self::carry`].
    pub fn rub(&self, V: &[Vec6], at: &mut Velocities, h: f64, responses: &mut Responses) {
        let contacts = self.contacts.iter().zip(&mut at.contacts);
        for ((contact, u), response) in contacts.zip(&mut responses.contacts) {
            *u = contact.sliding(V);
            response.friction = contact.rub(u, h);
        }
        let turns = self.turns.iter().zip(&at.turns);
        for ((turn, w), response) in turns.zip(&mut responses.turns) {
            *response = turn.response(w, h);
        }
    }

    /// Whether [`Self::add_lag`] may find anything.
    pub fn may_lag(&self, responses: &Responses, h: f64) -> bool {
        let mut contacts = self.contacts.iter().zip(&responses.contacts);
        !self.turns.is_empty() || contacts.any(|(contact, r)| contact.may_lag(r, h))
    }

    /// Adds what friction would do more over `h` seconds with the cones that belong to the normal
    /// forces of `responses`, where these act, N·s and N·m·s about O, to `F`; tells whether there
    /// is any.
    ///
    /// - `V`, `at`: velocities of all bodies, and those of the responses
    pub fn add_lag(
        &self,
        (V, at): (&[Vec6], &Velocities),
        responses: &Responses,
        h: f64,
        F: &mut [Vec6],
    ) -> bool {
        let mut any = false;
        let points = &self.contacts.points;
        for (contact, response) in self.contacts.iter().zip(&responses.contacts) {
            let of = &responses.points[contact.points.clone()];
            any |= contact.add_lag(points, V, ((response, of), h), F);
        }
        for ((turn, w), response) in self.turns.iter().zip(&at.turns).zip(&responses.turns) {
            let mut turn = *turn;
            turn.carry(responses.contacts[turn.contact].load / h);
            let more = turn.response(w, h).impulse - response.impulse;
            turn.act(&more, F);
            any |= more != Vec3::zeros();
        }
        any
    }

    /// Largest velocity, m/s, that friction which sticks outside the cone of its load over `h`
    /// seconds gives too much to the mass that takes part in its contact.
    pub fn freed(&self, responses: &Responses, h: f64) -> f64 {
        let contacts = self.contacts.iter().zip(&responses.contacts);
        contacts
            .filter(|(_, r)| !r.slips())
            .fold(0.0, |most, (contact, r)| {
                let force = r.friction.force * h;
                let borne = contact.friction.limit.clip(force, contact.mu * r.load);
                most.max((force - borne).norm() / contact.mass)
            })
    }

    /// Finds by how much the cones of contacts that slip grow over `h` seconds where the velocities
    /// of all bodies change by `V`, and tells whether any does.
    ///
    /// - `growth`: its first part is written, for each contact
    pub fn foresee(
        &self,
        V: &[Vec6],
        responses: &Responses,
        h: f64,
        growth: &mut Vec<Growth>,
    ) -> bool {
        growth.clear();
        let points = &self.contacts.points;
        let mut any = false;
        for (contact, r) in self.contacts.iter().zip(&responses.contacts) {
            let mut first = 0.0;
            if r.slips() {
                let of = &responses.points[contact.points.clone()];
                let load = r.load + contact.load_along(points, (r, of), V, h);
                first = contact.mu * load.max(0.0) - h * contact.friction.cap;
                any |= first != 0.0;
            }
            growth.push([first, 0.0]);
        }
        any
    }

    /// Finds by how much they grow where the velocities change by `V` because of the first part `x`
    /// of the growth, which is the second part `y`. With the linear map `C` from a growth to the
    /// growth that it causes, the whole growth `z` is `z = x + C z`, and `y = C x`.
    ///
    /// Returns the share `α` for which `α x` leaves the least error `|x − α (x − y)|`, and that
    /// error as a share of `|x|`. With `x + α y` the error is `C` times that.
    pub fn foresee_next(
        &self,
        V: &[Vec6],
        responses: &Responses,
        h: f64,
        growth: &mut [Growth],
    ) -> [f64; 2] {
        let points = &self.contacts.points;
        let (mut along, mut apart, mut all) = (0.0, 0.0, 0.0);
        let contacts = self.contacts.iter().zip(&responses.contacts);
        for ((contact, r), [x, y]) in contacts.zip(growth) {
            if r.slips() {
                let of = &responses.points[contact.points.clone()];
                *y = contact.mu * contact.load_along(points, (r, of), V, h);
                let left = *x - *y;
                along += *x * left;
                apart += left * left;
                all += *x * *x;
            }
        }
        if apart <= 0.0 {
            return [1.0, 0.0];
        }
        let share = along / apart;
        [share, ((all - share * along).max(0.0) / all).sqrt()]
    }

    /// Adds what friction does more where its cones grow by a part of `growth` to the impulses `F`
    /// on all bodies about O.
    pub fn add_growth(
        &self,
        (responses, h): (&Responses, f64),
        (growth, part): (&[Growth], usize),
        F: &mut [Vec6],
    ) {
        let contacts = self.contacts.iter().zip(&responses.contacts);
        for ((contact, r), growth) in contacts.zip(growth) {
            if r.slips() {
                let along = contact.friction.growth(&r.friction, h);
                contact.drag(&(along * -growth[part]), F);
            }
        }
    }

    /// Lets the cones of contacts that slip grow by `shares` of both parts of `growth`, and sets
    /// their friction at the velocities `at` anew.
    pub fn grow(
        &mut self,
        at: &Velocities,
        (growth, shares): (&[Growth], [f64; 2]),
        h: f64,
        responses: &mut Responses,
    ) {
        let contacts = self.contacts.list.iter_mut().zip(&at.contacts);
        for (((contact, u), r), [x, y]) in contacts.zip(&mut responses.contacts).zip(growth) {
            if r.slips() {
                let cap = &mut contact.friction.cap;
                *cap = (*cap + (shares[0] * x + shares[1] * y) / h).max(0.0);
                r.friction = contact.rub(u, h);
            }
        }
    }
}

impl Contact {
    /// Sets the friction for a normal force, N.
    #[inline]
    pub fn carry(&mut self, force: f64) {
        (self.friction.cap, self.friction.damping) = self.rubbing_under(force);
    }

    /// Cap and damping of its friction under a normal force, N: it slips in proportion to it. Nor
    /// is its damper less: in an impact, a damper in proportion to the normal force lets what
    /// sticks creep by less than one over the dissipation, at any speed. At rest the critical one
    /// is more.
    #[inline]
    fn rubbing_under(&self, force: f64) -> (f64, f64) {
        (self.mu * force, self.critical.max(self.dissipation * force))
    }

    /// Whether friction may be another one with the cone that belongs to the normal force of a
    /// response over `h` seconds: where it sticks within that cone it is the same.
    #[inline]
    fn may_lag(&self, r: &Response, h: f64) -> bool {
        let cap = self.mu * r.load / h;
        let sticks = !r.slips() && self.friction.cap > 0.0;
        !(sticks && self.friction.limit.holds(&r.friction.force, cap))
    }

    /// Adds what friction would do more with the cone that belongs to the normal force of a
    /// response over `h` seconds, where that acts; tells whether it is anything.
    #[inline]
    fn add_lag(
        &self,
        points: &[ContactPoint],
        V: &[Vec6],
        ((r, of), h): ((&Response, &[PointResponse]), f64),
        F: &mut [Vec6],
    ) -> bool {
        if !self.may_lag(r, h) {
            return false;
        }
        let footing = self.footing_under(points, (r, of));
        let (center, radius) = (footing.center, footing.radius);
        let W = self.relative(V);
        let u = self.sliding_at((&center, radius), &W);
        let (cap, damping) = self.rubbing_under(r.load / h);
        let carried = ElastoPlastic {
            cap,
            damping,
            limit: footing.limit.unwrap_or(self.friction.limit),
            ..self.friction
        };
        let [before, after] =
            [r.friction.force, carried.respond(self.slid(&u), h).force].map(|f| f * -h);
        let [(force, moment), (other, turned)] = [
            self.lever_at((&center, radius), &after),
            self.lever_at((&self.center, self.radius), &before),
        ];
        let (force, moment) = (force - other, moment - turned);
        self.act(&force, &moment, F);
        force != Vec3::zeros() || moment != Vec3::zeros()
    }

    /// By how much its load `h N Σ w_i` changes over `h` seconds, N·s, to first order, where the
    /// velocities of all bodies change by `V`. With `δ̇ = Σ w_i ḋ_i` the weights change by
    /// `ẇ_i = b_i ḋ_i − 3 w_i δ̇/δ`, where `b_i = 3 m_i d_i²/δ³`.
    fn load_along(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
        V: &[Vec6],
        h: f64,
    ) -> f64 {
        if !r.presses() {
            return 0.0;
        }
        let (mut deeper, mut bend, mut weights) = (0.0, 0.0, 0.0);
        for (r, v) in of.iter().zip(self.velocities(points, V)) {
            let change = -h * (v.along + r.lean.dot(&v.tilt));
            deeper += r.weight * change;
            bend += r.bend * change;
            weights += r.weight;
        }
        let weights_change = bend - 3.0 * weights / r.depth * deeper;
        h * (r.slope * deeper * weights + r.force * weights_change)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::random_contact;
    use super::super::{ContactSet, PointVelocity};
    use super::*;
    use crate::testing::Random;

    /// Against central differences of the load that the contact's own law gives.
    #[test]
    fn the_load_along_a_direction_is_the_derivative_of_the_load() {
        let mut random = Random(21);
        let mut compared = 0;
        for _ in 0..300 {
            let mut set = ContactSet::new([0, 0]);
            let contact = random_contact(&mut random, 0, &mut set.points);
            let h = libm::pow(10.0, random.uniform(-4.0, -2.0));
            let mut spatial = |size: f64| -> Vec6 {
                let (w, v) = (random.vector(size), random.vector(size));
                [w.x, w.y, w.z, v.x, v.y, v.z]
            };
            let (W, along) = (spatial(0.1), spatial(1.0));
            let respond = |W: Vec6| {
                let V = [W];
                let at: Vec<PointVelocity> = contact.velocities(&set.points, &V).collect();
                let (mut of, u) = (Vec::new(), contact.sliding(&V));
                let r = contact.response(&set.points, Some(&u), |i| at[i], h, &mut of);
                (r, of)
            };
            let moved = |step: f64| {
                respond(std::array::from_fn(|i| W[i] + step * along[i]))
                    .0
                    .load
            };
            let (r, of) = respond(W);
            let found = contact.load_along(&set.points, (&r, &of), &[along], h);
            let [ahead, behind] = [1e-7, -1e-7].map(moved);
            let expected = (ahead - behind) / 2e-7;
            let size = r.load.max(expected.abs());
            // Not where a kink lies within the difference: a point comes to the contact.
            let bend = (ahead - 2.0 * r.load + behind).abs() / 1e-7;
            if size > 0.0 && bend < 1e-4 * size {
                compared += 1;
                assert!((found - expected).abs() < 1e-4 * size, "{found} {expected}");
            }
        }
        assert!(compared > 200, "{compared}");
    }
}
