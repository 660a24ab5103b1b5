//! All that can act on a robot in a step, and what becomes of its memory.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response, normal_part};
use super::detect::detect;
use super::drive::Drive;
use super::joint::{JointResponse, JointTerm, Start};
use super::memory::{Memory, Touch, seek};
use super::turn::{Turn, find_turns};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Vec3, Vec6, angular};
use crate::tree::Tree;

/// Velocities that contacts answer.
#[derive(Clone, Debug)]
pub struct Velocities {
    /// Of each contact point, m/s.
    pub points: Vec<Vec3>,
    /// Angular velocity of each contact that resists turning, rad/s.
    pub turns: Vec<Vec3>,
}

impl Velocities {
    /// Room for as many contacts.
    pub fn new(contacts: usize) -> Self {
        Self {
            points: Vec::with_capacity(contacts),
            turns: Vec::with_capacity(contacts),
        }
    }

    /// Those of the contacts of `terms` where the bodies have the velocities `V`.
    #[inline]
    pub fn set(&mut self, terms: &Terms, V: &[Vec6]) {
        self.points.clear();
        self.points
            .extend(terms.contacts.iter().map(|c| c.velocity(V)));
        self.turns.clear();
        let turns = terms.turns.iter().map(|t| angular(&V[t.body]));
        self.turns.extend(turns);
    }

    /// Replaces each by what `change` makes of it and of its counterpart.
    #[inline]
    pub fn combine(&mut self, other: &Self, change: impl Fn(&mut Vec3, &Vec3)) {
        for (v, other) in self.points.iter_mut().zip(&other.points) {
            change(v, other);
        }
        for (v, other) in self.turns.iter_mut().zip(&other.turns) {
            change(v, other);
        }
    }
}

/// What all terms answer to the velocities at the end of a step.
#[derive(Clone, Debug)]
pub struct Responses {
    /// Of each contact.
    pub contacts: Vec<Response>,
    /// Of each contact that resists turning.
    pub turns: Vec<Response>,
    /// Of each joint term.
    pub joints: Vec<JointResponse>,
}

impl Responses {
    /// Room for as many contacts and joint terms.
    pub fn new(contacts: usize, joints: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(contacts),
            turns: Vec::with_capacity(contacts),
            joints: Vec::with_capacity(joints),
        }
    }
}

/// What the solve of a step has found.
#[derive(Clone, Copy, Debug)]
pub struct Solved<'a> {
    /// Generalised velocity, `nv`.
    pub v: &'a [f64],
    /// Velocities of contacts.
    pub at: &'a Velocities,
    /// Responses to them.
    pub responses: &'a Responses,
}

/// Everything that can act in a step, as found at its start and constant while the step is solved.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Contact points, by ascending slot.
    pub contacts: Vec<Contact>,
    /// Friction of some of them against turning, in the same order.
    pub turns: Vec<Turn>,
    /// What acts along each degree of freedom of a joint, in the order of these.
    pub joints: Vec<JointTerm>,
}

impl Terms {
    /// Those of a model, without contacts; room for all that it can have.
    pub fn new(model: &Model) -> Self {
        let of_joint = |dof: &usize| model.bodies[model.dofs[*dof].body.index()].joint.is_some();
        let dofs = (0..model.nv()).filter(of_joint);
        Self {
            contacts: Vec::with_capacity(model.contact_slots()),
            turns: Vec::with_capacity(model.contact_slots()),
            joints: dofs.map(|dof| JointTerm::new(model, dof)).collect(),
        }
    }

    /// Finds contacts, and their friction against turning, for a step of at most `h` seconds from
    /// the poses and velocities of `kin`.
    ///
    /// - `stiffness_limit`: see [`detect`]
    pub fn find_contacts(
        &mut self,
        model: &Model,
        tree: &Tree,
        memory: &Memory,
        kin: &Kinematics,
        h: f64,
        stiffness_limit: f64,
    ) {
        let (touches, contacts) = (&memory.touches, &mut self.contacts);
        detect(model, tree, touches, kin, h, stiffness_limit, contacts);
        find_turns(tree, touches, kin, contacts, &mut self.turns);
    }

    /// Sets the joint terms up for a step.
    pub fn set_joints(&mut self, start: &Start) {
        for term in &mut self.joints {
            term.set(start);
        }
    }

    /// Responses to the generalised velocity `v` and the velocities `at` of contacts at the end of
    /// a step of `h` seconds.
    #[inline]
    pub fn respond(&self, v: &[f64], at: &Velocities, h: f64, out: &mut Responses) {
        out.joints.clear();
        let joints = self.joints.iter().map(|t| t.response(v[t.dof], h));
        out.joints.extend(joints);
        out.contacts.clear();
        let contacts = self.contacts.iter().zip(&at.points);
        out.contacts.extend(contacts.map(|(c, v)| c.response(v, h)));
        out.turns.clear();
        let turns = self.turns.iter().zip(&at.turns);
        out.turns.extend(turns.map(|(t, w)| t.response(w, h)));
    }

    /// Responses `alpha` along a direction from velocities; returns what they add to the slope of
    /// the cost along it.
    ///
    /// - `from`, `along`: generalised velocities, and those of contacts
    #[inline]
    pub fn respond_along(
        &self,
        from: (&[f64], &Velocities),
        along: (&[f64], &Velocities),
        alpha: f64,
        h: f64,
        out: &mut Responses,
    ) -> f64 {
        let mut slope = 0.0;
        out.contacts.clear();
        let points = from.1.points.iter().zip(&along.1.points);
        for (contact, (v, w)) in self.contacts.iter().zip(points) {
            let response = contact.response(&(v + w * alpha), h);
            slope -= response.impulse.dot(w);
            out.contacts.push(response);
        }
        out.turns.clear();
        let turns = from.1.turns.iter().zip(&along.1.turns);
        for (turn, (v, w)) in self.turns.iter().zip(turns) {
            let response = turn.response(&(v + w * alpha), h);
            slope -= response.impulse.dot(w);
            out.turns.push(response);
        }
        out.joints.clear();
        for term in &self.joints {
            let w = along.0[term.dof];
            let response = term.response(from.0[term.dof] + alpha * w, h);
            slope -= response.impulse * w;
            out.joints.push(response);
        }
        slope
    }

    /// Second derivative of the cost of all terms along a direction, from their responses.
    ///
    /// - `along`: generalised velocity, and those of contacts
    #[inline]
    pub fn curvature(&self, responses: &Responses, along: (&[f64], &Velocities)) -> f64 {
        let mut curvature = 0.0;
        let points = responses.contacts.iter().zip(&along.1.points);
        for (contact, (r, w)) in self.contacts.iter().zip(points) {
            curvature += r.curvature(&contact.normal, w);
        }
        let turns = responses.turns.iter().zip(&along.1.turns);
        for (turn, (r, w)) in self.turns.iter().zip(turns) {
            curvature += r.curvature(&turn.normal, w);
        }
        for (term, r) in self.joints.iter().zip(&responses.joints) {
            let w = along.0[term.dof];
            curvature += r.stiffness * w * w;
        }
        curvature
    }

    /// Energy that the springs of contacts and limits hold, J.
    pub fn springs(&self) -> f64 {
        self.contacts.iter().map(Contact::stored).sum()
    }

    /// At most what friction elements and velocity motors hold and may give back, J.
    pub fn friction(&self) -> f64 {
        let mut twice = 0.0;
        for contact in &self.contacts {
            twice += contact.friction.twice_stored();
        }
        for turn in &self.turns {
            twice += turn.twice_stored();
        }
        for term in &self.joints {
            twice += term.dry.twice_stored();
            if let Drive::Velocity { element, .. } = &term.drive {
                twice += element.twice_stored();
            }
        }
        0.5 * twice
    }

    /// What the terms remember after a step of `h` seconds that has been solved.
    pub fn remember(&self, solved: &Solved, h: f64, memory: &mut Memory) {
        memory.clear();
        let mut turns = self.turns.iter().zip(&solved.at.turns).peekable();
        for (contact, v) in self.contacts.iter().zip(&solved.at.points) {
            let inside = contact.gap + h * contact.normal.dot(v) < 0.0;
            let touchdown = if inside { contact.touchdown } else { 0.0 };
            let turn = turns.next_if(|(turn, _)| turn.slot == contact.slot);
            let turns = turn.is_some_and(|(turn, _)| turn.holds());
            if contact.friction.cap > 0.0 || turns || touchdown > 0.0 {
                let angle = turn.map(|(turn, w)| turn.next_displacement(w, h));
                memory.touches.push(Touch {
                    slot: contact.slot,
                    displacement: contact.next_displacement(v, h).into(),
                    turn: angle.unwrap_or_default().into(),
                    touchdown,
                });
            }
        }
        for term in &self.joints {
            let v = solved.v[term.dof];
            if let Some(index) = term.actuator {
                memory.motor[index] = term.next_motor(v, h);
            }
            memory.dry[term.dof] = term.dry.next_under_falling_cap(v, h);
        }
    }

    /// Twice what two half steps from these terms have left in `memory` less what one step leaves
    /// in `full`; each no more than its cap can hold.
    ///
    /// - `middle`: terms at the start of the second half
    pub fn extrapolate(&self, middle: &Self, full: &Memory, memory: &mut Memory) {
        let mut full_touches = full.touches.iter().peekable();
        let mut contacts = middle.contacts.iter().peekable();
        let mut turns = middle.turns.iter().peekable();
        for touch in &mut memory.touches {
            let slot = touch.slot;
            let before = seek(&mut full_touches, slot, |t| t.slot);
            let before = before.copied().unwrap_or_default();
            if let Some(contact) = seek(&mut contacts, slot, |c| c.slot) {
                let twice = Vec3::from(touch.displacement) * 2.0;
                let next = twice - Vec3::from(before.displacement);
                touch.displacement = contact.friction.clipped(next).into();
            }
            if let Some(turn) = seek(&mut turns, slot, |t| t.slot) {
                let next = Vec3::from(touch.turn) * 2.0 - Vec3::from(before.turn);
                touch.turn = turn.clipped(&next).into();
            }
        }
        for (start, middle) in self.joints.iter().zip(&middle.joints) {
            if let (Some(index), Drive::Velocity { element, .. }) = (start.actuator, start.drive) {
                let motor = &mut memory.motor[index];
                *motor = element.clipped(2.0 * *motor - full.motor[index]);
            }
            if start.dry.cap > 0.0 {
                let dry = &mut memory.dry[start.dof];
                *dry = middle.dry.clipped(2.0 * *dry - full.dry[start.dof]);
            }
        }
    }

    /// Drops what contacts without load remember.
    pub fn drop_unloaded(&self, memory: &mut Memory) {
        memory.touches.retain(|touch| {
            let slot = touch.slot;
            let mut contacts = self.contacts.iter();
            contacts.any(|c| c.slot == slot && c.friction.cap > 0.0)
                || self.turns.iter().any(|t| t.slot == slot && t.holds())
                || touch.touchdown > 0.0
        });
    }

    /// What the terms remember where a step of `h` seconds that has been solved, and whose `memory`
    /// is given, is corrected by a known displacement. What slips keeps its own.
    ///
    /// - `way`: spatial displacement of each body; `moved`: of each degree of freedom, rad or m
    pub fn shift(
        &self,
        solved: &Solved,
        (way, moved): (&[Vec6], &[f64]),
        h: f64,
        memory: &mut Memory,
    ) {
        let contacts = self.contacts.iter().zip(&solved.responses.contacts);
        let sticks = |(_, response): &(_, &Response)| response.slip == Vec3::zeros();
        let mut contacts = contacts.filter(sticks).peekable();
        let mut turns = self.turns.iter().peekable();
        for touch in &mut memory.touches {
            let slot = touch.slot;
            if let Some((contact, _)) = seek(&mut contacts, slot, |(c, _)| c.slot) {
                let (_, along) = normal_part(&contact.normal, &contact.velocity(way));
                let next = Vec3::from(touch.displacement) + along;
                touch.displacement = contact.friction.clipped(next).into();
            }
            if let Some(turn) = seek(&mut turns, slot, |t| t.slot) {
                let next = Vec3::from(touch.turn) + angular(&way[turn.body]);
                touch.turn = turn.clipped(&next).into();
            }
        }
        for term in &self.joints {
            let (v, moved) = (solved.v[term.dof], moved[term.dof]);
            if let (Some(index), Drive::Velocity { target, element }) = (term.actuator, term.drive)
            {
                let motor = &mut memory.motor[index];
                *motor = element.moved(*motor, moved, v - target, h);
            }
            let dry = &mut memory.dry[term.dof];
            *dry = term.dry.moved(*dry, moved, v, h);
        }
    }
}
