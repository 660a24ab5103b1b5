//! A try of a step and its result. It is accepted whole or dropped.

use crate::force::{NamedPairs, Terms};
use crate::model::Model;
use crate::state::{Physical, State, Trend};
use crate::step::company::Company;
use crate::step::convex::Newton;
use crate::step::point::Point;
use crate::tree::Tree;

/// A try of a step. [`Self::accept`] is the one place where steps write what a robot is in.
///
/// Of trees that a step does not work on, see [`Tree::select`], it holds what the state does.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// Positions, velocities and memory at its end.
    pub end: Physical,
    /// Contact impulse per link from the last communication point to its end, world axes, N·s.
    pub impulse: Vec<[f64; 3]>,
    /// The same per named pair, on its first side by the second one.
    pub pair_impulse: Vec<[f64; 3]>,
    /// Which contacts belong to which of these; never changes.
    named: NamedPairs,
    /// Its accelerations; their mean for a step without stages.
    pub trend: Trend,
    /// Who has pushed whom.
    pub(super) company: Company,
}

#[cfg(test)]
crate::spoil::spoil!(Attempt: end impulse pair_impulse trend company; named);

impl Attempt {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            end: Physical::new(model),
            impulse: vec![[0.0; 3]; model.links.len()],
            pair_impulse: vec![[0.0; 3]; model.outputs.pairs.len()],
            named: NamedPairs::new(model),
            trend: Trend::new(model.nv()),
            company: Company::new(model, tree),
        }
    }

    /// Begins a try from `state`: no impulse yet but those of the steps before.
    pub(super) fn begin(&mut self, state: &State) {
        self.impulse.copy_from_slice(&state.stepping.impulse);
        self.pair_impulse
            .copy_from_slice(&state.stepping.pair_impulse);
        self.company.begin();
    }

    /// Begins a try that leaves everything as it is in `state`.
    pub(super) fn stay(&mut self, state: &State) {
        self.begin(state);
        self.end.copy_from(&state.physical);
        self.trend.copy_from(&state.stepping.trend);
    }

    /// Takes velocities and memory from a solve over `h` seconds from `point`; positions are the
    /// caller's.
    pub(super) fn take_solved(&mut self, tree: &Tree, point: &Point, solved: &Newton, h: f64) {
        tree.copy_velocities(&solved.v, &mut self.end.v);
        let memory = &mut self.end.memory;
        point.terms.remember(&solved.solved(), h, memory);
    }

    /// Makes its impulses those of the state.
    pub(super) fn give_impulses(&mut self, state: &mut State) {
        std::mem::swap(&mut self.impulse, &mut state.stepping.impulse);
        std::mem::swap(&mut self.pair_impulse, &mut state.stepping.pair_impulse);
    }

    /// Adds an impulse, N·s, on the first of two links, of which none is the ground, and its
    /// reaction on the other one to what these and named pairs have.
    pub(super) fn add_impulse(&mut self, links: [Option<usize>; 2], impulse: &[f64; 3]) {
        if impulse.iter().any(|x| *x != 0.0) {
            self.company.join_links(links);
        }
        let add = |sum: &mut [f64; 3], sign: f64| {
            for (sum, x) in sum.iter_mut().zip(impulse) {
                *sum += sign * x;
            }
        };
        for (link, sign) in links.iter().zip([1.0, -1.0]) {
            if let Some(link) = *link {
                add(&mut self.impulse[link], sign);
            }
        }
        for (pair, sum) in self.pair_impulse.iter_mut().enumerate() {
            let sign = self.named.share(pair, links);
            if sign != 0.0 {
                add(sum, sign);
            }
        }
    }

    /// Adds `share` times the contact impulses that a solve over `h` seconds has found to their
    /// links and named pairs.
    pub(super) fn add_impulses(&mut self, terms: &Terms, solved: &Newton, [h, share]: [f64; 2]) {
        self.company.join_limits(terms, solved);
        let (points, of) = (&terms.contacts.points, &solved.responses.points);
        for (contact, response) in terms.contacts.iter().zip(&solved.responses.contacts) {
            let impulse = contact.impulse(points, (response, of), h) * share;
            self.add_impulse(contact.links(), &impulse.into());
        }
    }

    /// Sets the accelerations of a step of `h` seconds that began with the velocities `v`.
    ///
    /// - `first`: velocities at the end of its first stage, which takes so many seconds
    pub(super) fn end_trend(
        &mut self,
        tree: &Tree,
        v: &[f64],
        h: f64,
        (first, eta): (&[f64], f64),
    ) {
        mean_acceleration(tree, v, (&self.end.v, h), &mut self.trend.whole);
        mean_acceleration(tree, v, (first, eta), &mut self.trend.first);
    }

    /// The same of a step without stages.
    pub(super) fn end_plain_trend(&mut self, tree: &Tree, v: &[f64], h: f64) {
        let Trend { first, whole } = &mut self.trend;
        for trend in [first, whole] {
            mean_acceleration(tree, v, (&self.end.v, h), trend);
        }
    }

    /// No accelerations.
    pub(super) fn clear_trend(&mut self, tree: &Tree) {
        tree.clear_velocities(&mut self.trend.first);
        tree.clear_velocities(&mut self.trend.whole);
    }

    /// Makes it the state. What is left here is where the step began.
    pub(super) fn accept(&mut self, state: &mut State) {
        std::mem::swap(&mut self.end, &mut state.physical);
        self.give_impulses(state);
        std::mem::swap(&mut self.trend, &mut state.stepping.trend);
        self.company.accept();
    }
}

/// Mean acceleration over `h` seconds from the velocities `v` to `end`.
pub(super) fn mean_acceleration(tree: &Tree, v: &[f64], (end, h): (&[f64], f64), out: &mut [f64]) {
    for k in tree.worked_dofs() {
        out[k] = (end[k] - v[k]) / h;
    }
}
