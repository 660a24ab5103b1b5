//! Forces of a contact on its bodies, and what its friction acts against.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response, normal_part};
use super::point::{ContactPoint, PointResponse};
use crate::spatial::{Vec3, Vec6, angular, velocity_at};

impl Contact {
    /// Velocity `u` that friction acts against, m/s, world axes.
    #[inline]
    pub fn sliding(&self, V: &[Vec6]) -> Vec3 {
        self.sliding_with(&self.relative(V))
    }

    /// The same for the velocity `W` of its body against the other one.
    #[inline]
    pub(super) fn sliding_with(&self, W: &Vec6) -> Vec3 {
        self.sliding_at((&self.center, self.radius), W)
    }

    /// The same about another centre and with another radius of the load.
    #[inline]
    pub(super) fn sliding_at(&self, (center, radius): (&Vec3, f64), W: &Vec6) -> Vec3 {
        let (_, u) = normal_part(&self.normal, &velocity_at(W, center));
        u + self.normal * (radius * self.normal.dot(&angular(W)))
    }

    /// Force, and moment about O, of friction `x` along what `u` is along: the transpose of
    /// [`Self::sliding`].
    #[inline]
    pub fn lever(&self, x: &Vec3) -> (Vec3, Vec3) {
        self.lever_at((&self.center, self.radius), x)
    }

    /// The same about another centre and with another radius of the load.
    #[inline]
    pub(super) fn lever_at(&self, (center, radius): (&Vec3, f64), x: &Vec3) -> (Vec3, Vec3) {
        let (drilling, along) = normal_part(&self.normal, x);
        let moment = center.cross(&along) + self.normal * (radius * drilling);
        (along, moment)
    }

    /// Adds an impulse of friction, along what `u` is along, to those on all bodies about O.
    #[inline]
    pub(super) fn drag(&self, impulse: &Vec3, F: &mut [Vec6]) {
        let (along, moment) = self.lever(impulse);
        self.act(&along, &moment, F);
    }

    /// Adds the impulses of a response on the body, and their reaction on the other one, to those
    /// on all bodies about O.
    #[inline]
    pub fn push(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
        h: f64,
        F: &mut [Vec6],
    ) {
        self.drag(&(r.friction.force * -h), F);
        let (mut push, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for (p, response) in points[self.points.clone()].iter().zip(of) {
            push += p.row * response.impulse;
            moment += p.arm * response.impulse;
            if let Some(rim) = &p.rim {
                moment += rim.moment(&response.tilting);
            }
        }
        self.act(&push, &moment, F);
    }

    /// Adds a force on the body, N, and its moment about O, N·m, and their reaction on the other
    /// body, to those on all bodies; or impulses.
    #[inline]
    pub fn act(&self, force: &Vec3, moment: &Vec3, F: &mut [Vec6]) {
        let wrench = [moment.x, moment.y, moment.z, force.x, force.y, force.z];
        for (sum, x) in F[self.body].iter_mut().zip(wrench) {
            *sum += x;
        }
        if let Some(other) = self.other {
            // About the other tree's O.
            let m = moment + other.from.cross(force);
            let wrench = [m.x, m.y, m.z, force.x, force.y, force.z];
            for (sum, x) in F[other.body].iter_mut().zip(wrench) {
                *sum -= x;
            }
        }
    }

    /// Impulse on the body of a response, N·s, world axes; `points` and `of` are those of all
    /// contacts.
    #[inline]
    pub fn impulse(
        &self,
        points: &[ContactPoint],
        (r, of): (&Response, &[PointResponse]),
        h: f64,
    ) -> Vec3 {
        let (_, along) = normal_part(&self.normal, &r.friction.force);
        let own = self.points.clone();
        let push = if self.uneven {
            let own = points[own.clone()].iter().zip(&of[own]);
            own.map(|(p, r)| p.row * r.impulse).sum()
        } else {
            self.normal * r.load
        };
        push - along * h
    }

    /// Force on the body at the start of the step, N, and its moment about O, N·m, for the
    /// velocities of all bodies.
    pub fn wrench(&self, points: &[ContactPoint], V: &[Vec6]) -> (Vec3, Vec3) {
        let velocity = self.normal_velocity(points, V);
        let [load, _] = self.loads(velocity);
        let friction = self
            .friction
            .respond(self.sliding(V) + self.carried, 0.0)
            .force;
        let (mut force, mut moment) = self.lever(&-friction);
        let W = self.relative(V);
        let own = &points[self.points.clone()];
        let rock = |p: &ContactPoint| self.rocking(p.along(&W) - velocity).0 * p.load;
        let total: f64 = own.iter().map(rock).sum();
        for p in own {
            let push = (load + total) * p.load - rock(p);
            force += p.row * push;
            moment += p.arm * push;
            if let Some(rim) = &p.rim {
                let tilt = rim.rate(&p.normal, &angular(&W));
                moment -= rim.moment(&(tilt * (self.tilting * p.load * rim.tilt_damping)));
            }
        }
        (force, moment)
    }
}
