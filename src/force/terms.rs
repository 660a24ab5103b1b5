//! All that can act on a robot in a step, and what becomes of its memory.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, Response, normal_part};
use super::detect::detect;
use super::drive::Drive;
use super::gather::ContactSet;
use super::joint::{JointResponse, JointTerm, Start};
use super::memory::{Memory, seek};
use super::point::{PointResponse, PointVelocity};
use super::spring::SpringTerm;
use super::turn::{Turn, TurnResponse, find_turns};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Vec3, Vec6};
use crate::tree::Tree;

/// Velocities that contacts answer.
#[derive(Clone, Debug)]
pub struct Velocities {
    /// Sliding and drilling of each contact, m/s.
    pub contacts: Vec<Vec3>,
    /// Of each contact point.
    pub points: Vec<PointVelocity>,
    /// Angular velocity of each contact that resists turning, rad/s.
    pub turns: Vec<Vec3>,
    /// Of the points of each spring, m/s.
    pub springs: Vec<Vec3>,
}

impl Velocities {
    /// Room for as many contacts and points.
    #[cfg_attr(small, optimize(size))]
    pub fn new([contacts, points]: [usize; 2]) -> Self {
        Self {
            contacts: Vec::with_capacity(contacts),
            points: Vec::with_capacity(points),
            turns: Vec::with_capacity(contacts),
            springs: Vec::new(),
        }
    }

    /// With room for so many springs.
    #[must_use]
    pub fn with(mut self, springs: usize) -> Self {
        self.springs.reserve(springs);
        self
    }

    /// Those of the contacts and springs of `terms` where the bodies have the velocities `V`.
    #[inline]
    pub fn set(&mut self, terms: &Terms, V: &[Vec6]) {
        self.contacts.clear();
        self.points.clear();
        for contact in terms.contacts.iter() {
            let W = contact.relative(V);
            self.contacts.push(contact.sliding_with(&W));
            let points = contact.velocities_with(&terms.contacts.points, W);
            self.points.extend(points);
        }
        self.turns.clear();
        let turns = terms.turns.iter().map(|t| t.relative(V));
        self.turns.extend(turns);
        self.springs.clear();
        let springs = terms.springs.iter().map(|s| s.relative(V));
        self.springs.extend(springs);
    }

    /// Replaces each by `share` of itself plus `other_share` of its counterpart.
    #[inline]
    pub fn combine(&mut self, share: f64, other: &Self, other_share: f64) {
        let change = |v: &mut Vec3, other: &Vec3| *v = *v * share + other * other_share;
        for (v, other) in self.contacts.iter_mut().zip(&other.contacts) {
            change(v, other);
        }
        for (v, other) in self.points.iter_mut().zip(&other.points) {
            v.along = share * v.along + other_share * other.along;
            change(&mut v.tilt, &other.tilt);
        }
        for (v, other) in self.turns.iter_mut().zip(&other.turns) {
            change(v, other);
        }
        for (v, other) in self.springs.iter_mut().zip(&other.springs) {
            change(v, other);
        }
    }
}

/// What all terms answer to the velocities at the end of a step.
#[derive(Clone, Debug)]
pub struct Responses {
    /// Of each contact.
    pub contacts: Vec<Response>,
    /// Of each contact point.
    pub points: Vec<PointResponse>,
    /// Of each contact that resists turning.
    pub turns: Vec<TurnResponse>,
    /// Of each joint term.
    pub joints: Vec<JointResponse>,
    /// Impulse of each spring on its first point, N·s.
    pub springs: Vec<Vec3>,
}

impl Responses {
    /// Room for as many contacts, points and joint terms.
    #[cfg_attr(small, optimize(size))]
    pub fn new([contacts, points]: [usize; 2], joints: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(contacts),
            points: Vec::with_capacity(points),
            turns: Vec::with_capacity(contacts),
            joints: Vec::with_capacity(joints),
            springs: Vec::new(),
        }
    }

    /// With room for so many springs.
    #[must_use]
    pub fn with(mut self, springs: usize) -> Self {
        self.springs.reserve(springs);
        self
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
    /// Contacts, by ascending slot.
    pub contacts: ContactSet,
    /// Friction of some of them against turning, in the same order.
    pub turns: Vec<Turn>,
    /// What acts along each degree of freedom of a joint that a step works on, in the order of
    /// these; see [`Self::select`].
    pub joints: Vec<JointTerm>,
    /// Springs between two points.
    pub springs: Vec<SpringTerm>,
}

impl Terms {
    /// Those of a model, without contacts; room for all that it can have.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        Self {
            contacts: ContactSet::of(model),
            turns: Vec::with_capacity(model.contact_room()[0]),
            joints: JointTerm::of(model, 0..model.nv()).collect(),
            springs: Vec::with_capacity(model.springs.len()),
        }
    }

    /// Takes the joints of the trees that a step works on, see [`Tree::select`].
    pub fn select(&mut self, model: &Model, tree: &Tree) {
        self.joints.clear();
        self.joints.extend(JointTerm::of(model, tree.worked_dofs()));
    }

    /// What acts along a degree of freedom of a joint; none along one of a base, or of a tree that
    /// a step does not work on.
    pub fn along(&self, dof: usize) -> Option<&JointTerm> {
        let place = self.joints.binary_search_by_key(&dof, |term| term.dof);
        place.ok().map(|place| &self.joints[place])
    }

    /// Whether nothing acts between bodies, or on one from outside.
    #[inline]
    pub fn is_free(&self) -> bool {
        self.contacts.is_empty() && self.springs.is_empty()
    }

    /// Finds contacts, their friction against turning, and springs, for a step of at most `h`
    /// seconds from the poses and velocities of `kin`.
    pub fn find_contacts(
        &mut self,
        model: &Model,
        tree: &Tree,
        memory: &Memory,
        kin: &Kinematics,
        h: f64,
    ) {
        let (touches, contacts) = (&memory.touches, &mut self.contacts);
        detect(model, tree, touches, kin, h, contacts);
        find_turns(tree, touches, kin, contacts, &mut self.turns);
        self.springs.clear();
        let springs = tree.worked_springs();
        self.springs
            .extend(springs.map(|(index, s)| SpringTerm::new(tree, kin, index, s)));
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
        self.respond_with(v, (at, true), h, out);
    }

    /// The same without friction of contacts if that is to be found by [`Self::rub`].
    #[inline]
    pub fn respond_with(
        &self,
        v: &[f64],
        (at, rubs): (&Velocities, bool),
        h: f64,
        out: &mut Responses,
    ) {
        out.joints.clear();
        let joints = self.joints.iter().map(|t| t.response(v[t.dof], h));
        out.joints.extend(joints);
        out.contacts.clear();
        out.points.clear();
        let points = &self.contacts.points;
        for (contact, u) in self.contacts.iter().zip(&at.contacts) {
            let own = &at.points[contact.points.clone()];
            let u = rubs.then_some(u);
            let response = contact.response(points, u, |i| own[i], h, &mut out.points);
            out.contacts.push(response);
        }
        out.turns.clear();
        let turns = self.turns.iter().zip(&at.turns);
        out.turns.extend(turns.map(|(t, w)| t.response(w, h)));
        out.springs.clear();
        let springs = self.springs.iter().zip(&at.springs);
        out.springs.extend(springs.map(|(s, u)| s.impulse(u, h)));
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
        out.points.clear();
        let points = &self.contacts.points;
        let sliding = from.1.contacts.iter().zip(&along.1.contacts);
        for (contact, (v, w)) in self.contacts.iter().zip(sliding) {
            let own = contact.points.clone();
            let (at, dir) = (&from.1.points[own.clone()], &along.1.points[own.clone()]);
            let velocity = |i: usize| at[i].plus(&dir[i], alpha);
            let u = v + w * alpha;
            let response = contact.response(points, Some(&u), velocity, h, &mut out.points);
            slope -= Contact::power((&response, &out.points[own]), (w, dir), h);
            out.contacts.push(response);
        }
        out.turns.clear();
        let turns = from.1.turns.iter().zip(&along.1.turns);
        for (turn, (v, w)) in self.turns.iter().zip(turns) {
            let response = turn.response(&(v + w * alpha), h);
            slope -= response.impulse.dot(w);
            out.turns.push(response);
        }
        out.springs.clear();
        let springs = from.1.springs.iter().zip(&along.1.springs);
        for (spring, (v, w)) in self.springs.iter().zip(springs) {
            let impulse = spring.impulse(&(v + w * alpha), h);
            slope -= impulse.dot(w);
            out.springs.push(impulse);
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
    pub fn curvature(&self, responses: &Responses, along: (&[f64], &Velocities), h: f64) -> f64 {
        let mut curvature = 0.0;
        let sliding = responses.contacts.iter().zip(&along.1.contacts);
        for (contact, (r, w)) in self.contacts.iter().zip(sliding) {
            let own = contact.points.clone();
            let response = (r, &responses.points[own.clone()]);
            let along = (w, &along.1.points[own]);
            curvature += contact.curvature(&self.contacts.points, response, along, h);
        }
        let turns = responses.turns.iter().zip(&along.1.turns);
        for (turn, (r, w)) in self.turns.iter().zip(turns) {
            curvature += r.curvature(&turn.normal, w);
        }
        for (spring, w) in self.springs.iter().zip(&along.1.springs) {
            curvature += h * w.dot(&(spring.resistance(h) * w));
        }
        for (term, r) in self.joints.iter().zip(&responses.joints) {
            let w = along.0[term.dof];
            curvature += r.stiffness * w * w;
        }
        curvature
    }

    /// Energy that the springs of contacts, and those between two points, hold, J.
    pub fn springs(&self) -> f64 {
        let contacts: f64 = self.contacts.iter().map(Contact::stored).sum();
        let springs: f64 = self.springs.iter().map(SpringTerm::stored).sum();
        contacts + springs
    }

    /// At most what friction elements and velocity motors hold and may give back, J.
    pub fn friction(&self) -> f64 {
        let mut twice = 0.0;
        for contact in self.contacts.iter() {
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

    /// Takes the joint terms of `base`, each moved on by what `moved` gives for its degree of
    /// freedom, rad or m.
    pub fn begin_joints(&mut self, base: &Self, moved: impl Fn(usize) -> f64) {
        self.joints.clear();
        self.joints.extend_from_slice(&base.joints);
        for term in &mut self.joints {
            term.shift(moved(term.dof));
        }
    }

    /// Moves what elasto-plastic elements have stored by a displacement that no stage has gone: an
    /// error of positions stretches them as it stretches springs.
    ///
    /// - `way`, `moved`: see [`Self::begin`]
    pub fn strain(&mut self, way: &[Vec6], moved: &[f64]) {
        for contact in &mut self.contacts.list {
            contact.friction.displacement += contact.sliding(way);
        }
        for turn in &mut self.turns {
            let (torsion, roll) = normal_part(&turn.normal, &turn.relative(way));
            turn.torsional.displacement += torsion;
            turn.rolling.displacement += roll;
        }
        for term in &mut self.joints {
            let moved = moved[term.dof];
            if let Drive::Velocity { element, .. } = &mut term.drive {
                element.displacement += moved;
            }
            term.dry.displacement += moved;
        }
    }

    /// Makes what meets in a step of `h` seconds press from its start on, as deep as at its end.
    pub fn press(&mut self, solved: &Solved, h: f64) {
        let ContactSet { list, points, .. } = &mut self.contacts;
        for (contact, response) in list.iter_mut().zip(&solved.responses.contacts) {
            let deeper = response.depth - contact.depth;
            if response.presses() && deeper > 0.0 {
                contact.sink(points, deeper / contact.weights);
            }
        }
        for term in &mut self.joints {
            let nearer = h * solved.v[term.dof];
            for (gap, nearer) in term.gap.iter_mut().zip([nearer, -nearer]) {
                *gap += nearer.min(0.0);
            }
        }
    }

    /// Makes these the terms of a part of a step: those of `base`, moved on.
    ///
    /// - `way`: spatial displacement of each body; `moved`: of each degree of freedom, rad or m;
    ///   `risen`: for how long contacts and springs have moved by their drift besides, s
    /// - `after`: what the terms remember after the part before, and which multiple of the change
    ///   since `base` they begin with
    pub fn begin(
        &mut self,
        base: &Self,
        (way, moved, risen): (&[Vec6], &[f64], f64),
        after: Option<(&Memory, f64)>,
    ) {
        self.contacts.list.clear();
        self.contacts.list.extend(base.contacts.iter().cloned());
        let points = &mut self.contacts.points;
        points.clear();
        points.extend_from_slice(&base.contacts.points);
        for contact in &mut self.contacts.list {
            contact.shift(points, way, risen);
        }
        self.turns.clear();
        self.turns.extend_from_slice(&base.turns);
        self.springs.clear();
        self.springs.extend_from_slice(&base.springs);
        for spring in &mut self.springs {
            spring.shift(way, risen);
        }
        self.begin_joints(base, |dof| moved[dof]);
        let Some((memory, share)) = after else {
            return;
        };
        let mut touches = memory.touches.iter().peekable();
        let mut turns = self.turns.iter_mut().peekable();
        for contact in &mut self.contacts.list {
            let touch = seek(&mut touches, contact.slot, |t| t.slot);
            let touch = touch.copied().unwrap_or_default();
            let start = contact.friction.displacement;
            let next = contact.recall_slip(&touch.displacement);
            contact.friction.displacement = start + (next - start) * share;
            if let Some(turn) = seek(&mut turns, contact.slot, |t| t.slot) {
                turn.begin(&contact.recall(&touch.turn), share);
            }
        }
        for term in &mut self.joints {
            if let (Some(index), Drive::Velocity { element, .. }) = (term.actuator, &mut term.drive)
            {
                let start = element.displacement;
                element.displacement = start + share * (memory.motor[index] - start);
            }
            let start = term.dry.displacement;
            term.dry.displacement = start + share * (memory.dry[term.dof] - start);
        }
    }

    /// Multiplies the drift of all contacts and springs.
    pub fn scale_drift(&mut self, share: f64) {
        for contact in &mut self.contacts.list {
            contact.drift *= share;
            contact.rise *= share;
        }
        for spring in &mut self.springs {
            spring.scale_drift(share);
        }
    }
}
