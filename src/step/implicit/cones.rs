//! Friction cones within a step: how far a contact's normal force runs ahead of the friction that
//! it allows.
//!
//! A solve takes the largest friction of a contact from a normal force that is known before: that
//! of the step's start. Two things make that force a bad guess for the step:
//!
//! - Where a robot pitches because it slips, the normal force answers friction within milliseconds.
//!   A longer step sees the answer one solve late, and slipping on front and rear wheels feeds on
//!   itself, more so when it is extrapolated: an error `e` of the forces becomes `(2c² + c) e`,
//!   with `c` the share of friction that comes back as normal force.
//! - A light link presses into the ground by less than the tolerance: what its penetration at the
//!   start says of its load is noise.
//!
//! There the full solve is repeated with the normal forces that it has found until they agree, by a
//! secant through the last two tries (Anderson's mixing of depth one); the half steps take the
//! forces half way to them and at them. All three are then late or early by half their length, and
//! the order is two.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, Response, seek};
use crate::spatial::Vec3;
use crate::step::convex::Newton;
use crate::step::point::Point;

/// Normal forces of the contacts of a step, N, in the order of its contacts.
#[derive(Clone, Debug)]
pub(in crate::step) struct Cones {
    /// Those at its start, and those that its full solve takes for its end.
    loads: Vec<[f64; 2]>,
    /// What the last solve has found more than it took.
    excess: Vec<f64>,
    /// Whether the cones of the contacts are not those of the start.
    pub(in crate::step) moved: bool,
}

#[cfg(test)]
crate::spoil::spoil!(Cones: loads excess moved;);

impl Cones {
    /// Room for `slots` contacts.
    pub(in crate::step) fn new(slots: usize) -> Self {
        Self {
            loads: Vec::with_capacity(slots),
            excess: Vec::with_capacity(slots),
            moved: false,
        }
    }

    /// Friction that a solve over `h` seconds has had too little or too much of, by the normal
    /// forces that it has found, N. Contacts that the step resolves do not count: those on which
    /// `mass`, kg, answers more slowly, and which are deeper than `tolerance`, m.
    pub(in crate::step) fn lag(
        start: &Point,
        solved: &Newton,
        (mass, tolerance): (f64, f64),
        h: f64,
    ) -> f64 {
        let mut lag = 0.0;
        for (contact, response) in start.terms.contacts.iter().zip(&solved.responses.contacts) {
            let normal = contact.normal.dot(&response.impulse);
            let cap = contact.mu * normal / h;
            let friction = response.impulse - contact.normal * normal;
            let slips =
                response.slip != Vec3::zeros() || friction.norm_squared() > h * h * cap * cap;
            let load = cap.max(contact.friction.cap) / contact.mu;
            let coarse = h * h * contact.spring.stiffness > mass
                || load < tolerance * contact.spring.stiffness;
            let slips = slips || (contact.friction.cap <= 0.0 && cap > 0.0);
            if slips && coarse {
                lag += (cap - contact.friction.cap).abs();
            }
        }
        lag
    }

    /// Takes the normal forces that the solve over `h` seconds with the cones of the start has
    /// found.
    pub(in crate::step) fn begin(&mut self, start: &Point, solved: &Newton, h: f64) {
        self.loads.clear();
        self.excess.clear();
        for (contact, response) in start.terms.contacts.iter().zip(&solved.responses.contacts) {
            let begin = contact.normal_force(contact.normal_velocity(&start.kin.V));
            let end = found(contact, response, h);
            self.loads.push([begin, end]);
            self.excess.push(end - begin);
        }
    }

    /// Takes what the last two solves, over `h` seconds, say together.
    pub(in crate::step) fn improve(&mut self, start: &Point, solved: &Newton, h: f64) {
        let solutions = || start.terms.contacts.iter().zip(&solved.responses.contacts);
        let (mut along, mut squared) = (0.0, 0.0);
        let rows = self.loads.iter().zip(&self.excess).zip(solutions());
        for (([_, taken], before), (contact, response)) in rows {
            let excess = found(contact, response, h) - taken;
            along += excess * (excess - before);
            squared += (excess - before) * (excess - before);
        }
        // Excesses that grow the same way would be run away from.
        let share = if along > 0.0 && along < squared {
            along / squared
        } else {
            0.0
        };
        let rows = self.loads.iter_mut().zip(&mut self.excess);
        for (([_, taken], excess), (contact, response)) in rows.zip(solutions()) {
            let found = found(contact, response, h);
            let before = *taken;
            *excess = found - before;
            *taken = found + share * (before - found);
        }
    }

    /// Sets the cones of the step's contacts to those at `share` of its length.
    pub(in crate::step) fn set(&mut self, start: &mut Point, share: f64) {
        self.moved = share > 0.0;
        for (contact, [a, b]) in start.terms.contacts.iter_mut().zip(&self.loads) {
            contact.carry(a + share * (b - a));
        }
        for turn in &mut start.terms.turns {
            let [a, b] = self.loads[turn.contact];
            turn.carry(a + share * (b - a));
        }
    }

    /// Sets the cones of contacts in the middle of the step to those at its end; who has touched
    /// down since keeps its own.
    pub(in crate::step) fn carry(&self, start: &Point, middle: &mut Point) {
        let mut known = start.terms.contacts.iter().zip(&self.loads).peekable();
        let mut turns = middle.terms.turns.iter_mut().peekable();
        for (place, contact) in middle.terms.contacts.iter_mut().enumerate() {
            let Some((_, [_, end])) = seek(&mut known, contact.slot, |(c, _)| c.slot) else {
                continue;
            };
            contact.carry(*end);
            if let Some(turn) = seek(&mut turns, place, |t| t.contact) {
                turn.carry(*end);
            }
        }
    }
}

/// Normal force that a solve over `h` seconds has found, N.
fn found(contact: &Contact, response: &Response, h: f64) -> f64 {
    contact.normal.dot(&response.impulse) / h
}
