//! A step that makes energy is solved once more, with contacts whose force agrees with how deep
//! they are at both of its ends.

use super::Stages;
use crate::force::{Secant, seek};
use crate::kinematics::forward;
use crate::state::Physical;
use crate::step::attempt::Attempt;
use crate::step::guards::{Books, gain};
use crate::step::point::{Context, Point};
use crate::tuning::{EASINGS, SECANTS};

/// A step that has been solved.
pub(in crate::step) struct Ending<'a> {
    /// Where it begins.
    pub(in crate::step) here: &'a Point,
    /// See `here`.
    pub(in crate::step) from: &'a Physical,
    /// Energies there.
    pub(in crate::step) books: &'a Books,
    /// Its length, s, and the accuracy of its solves.
    pub(in crate::step) lengths: [f64; 2],
    /// See [`Stages::solve`].
    pub(in crate::step) alike: bool,
}

/// What became of it.
pub(in crate::step) struct Ended {
    /// What putting it into the attempt adds to its error.
    pub(in crate::step) added: f64,
    /// Energy that it makes, as a multiple of what is allowed.
    pub(in crate::step) gain: f64,
    /// Whether it has been solved again, so that its error is another one.
    pub(in crate::step) again: bool,
}

/// The share of its secants with which a step keeps its energy.
///
/// Where a depth jumps within microseconds, the way of the step is so short that the whole of a
/// secant is a wall across it: the step then loses hundreds of times what it made without. It made
/// energy with none of them and loses it with all; what is between is found from that, first on the
/// line between both, then as the geometric mean of the largest share that makes energy and the
/// least that loses it.
struct Eased {
    /// What the step makes without secants, as a multiple of what is allowed.
    made: f64,
    /// Largest share with which it makes energy, least share with which it loses too much, and the
    /// one of now.
    shares: [f64; 3],
    /// How many shares have been tried.
    times: u32,
}

impl Eased {
    fn new() -> Self {
        Self {
            made: 0.0,
            shares: [0.0, 1.0, 1.0],
            times: 0,
        }
    }

    /// What the secants of a step that makes `gain` are multiplied by next; none where it loses no
    /// more than it made without, and, once eased, makes no more than `mended`.
    fn next(&mut self, gain: f64, mended: f64) -> Option<f64> {
        let makes = self.times > 0 && gain > mended;
        let off = gain.is_finite() && (makes || gain < -self.made);
        if !off || self.times == EASINGS {
            return None;
        }
        let [low, high, now] = &mut self.shares;
        *(if makes { &mut *low } else { &mut *high }) = *now;
        let next = if *low > 0.0 {
            (*low * *high).sqrt()
        } else {
            *now * self.made / (self.made - gain)
        };
        let by = next / *now;
        *now = next;
        self.times += 1;
        Some(by)
    }
}

impl Stages {
    /// Puts the step into an attempt by `finish`, which returns what that adds to its error; as
    /// long as it makes energy, solves it again with secants. None where that has no solution.
    /// Poses and velocities of `there` then stand at its end.
    pub(in crate::step) fn end(
        &mut self,
        ctx: &Context,
        step: &Ending,
        (there, attempt): (&mut Point, &mut Attempt),
        mut finish: impl FnMut(&mut Self, &mut Point, &mut Attempt) -> f64,
    ) -> Option<Ended> {
        let Ending { here, from, .. } = *step;
        let [h, _] = step.lengths;
        let mut eased = Eased::new();
        for round in 0.. {
            let added = finish(self, there, attempt);
            let work = self.work(ctx, h);
            let gain = gain(ctx, step.books, (here, there), &attempt.end, work);
            let makes = ctx.rules.secants && gain > step.books.mended && gain.is_finite();
            let depths = &there.terms.contacts.depths;
            if round == 0 {
                eased.made = gain;
            } else if let Some(share) = eased.next(gain, step.books.mended) {
                self.ease(share);
                if !self.run_stages(ctx, (here, from), step.lengths, step.alike) {
                    break;
                }
                continue;
            }
            let last = round == SECANTS || eased.times > 0;
            if !makes || last || !self.find_secants(ctx, here, depths, h) {
                return Some(Ended {
                    added,
                    gain,
                    again: round > 0,
                });
            }
            if !self.run_stages(ctx, (here, from), step.lengths, step.alike) {
                break;
            }
        }
        None
    }

    /// Leaves a share of all secants.
    fn ease(&mut self, share: f64) {
        for secant in &mut self.secants {
            secant.scale(share);
        }
    }

    /// Finds the secants of all contacts that press at the end of a step of `h` seconds from
    /// `here`; tells whether there are any.
    ///
    /// - `depths`: depth of the contact of each slot at its end, m
    fn find_secants(
        &mut self,
        ctx: &Context,
        here: &Point,
        depths: &[(usize, f64)],
        h: f64,
    ) -> bool {
        let kin = &self.middle.kin;
        forward(ctx.tree, &kin.S, &self.moved, &mut self.way);
        let mut starts = here.terms.contacts.iter().peekable();
        let firsts = self.terms[0].contacts.iter();
        let solved = &self.solved[1].responses.contacts;
        let mut any = false;
        for ((contact, first), response) in
            self.middle.terms.contacts.iter().zip(firsts).zip(solved)
        {
            let start = seek(&mut starts, contact.slot, |c| c.slot);
            let end = depths.iter().find(|(slot, _)| *slot == contact.slot);
            let (Some(start), Some((_, end))) = (start, end) else {
                continue;
            };
            if response.depth.max(*end) <= 0.0 {
                continue;
            }
            // What is apart holds no energy, however far: a corner that comes over an edge is deep
            // in what is behind it at once, and was a rounding away from that.
            // (`a_corner_that_comes_over_a_joint_goes_on`)
            let more = |depth: f64, than: f64| depth.max(0.0) - than.max(0.0);
            let errors = [more(start.depth, first.depth), more(*end, response.depth)];
            let depths = (errors, more(*end, start.depth));
            let found = Secant::new((ctx.tree, kin), contact, depths, (&self.way, h));
            let Some(found) = found else { continue };
            any = true;
            let known = |secant: &&mut Secant| secant.slot() == found.slot();
            match self.secants.iter_mut().find(known) {
                Some(secant) => secant.add(&found),
                None => self.secants.push(found),
            }
        }
        any
    }

    /// Gives contacts the secants that have been found.
    pub(super) fn bend(&mut self) {
        let contacts = &mut self.middle.terms.contacts;
        for secant in &self.secants {
            let list = &mut contacts.list;
            if let Some(contact) = list.iter_mut().find(|c| c.slot == secant.slot()) {
                secant.bend(contact, &mut contacts.points);
            }
        }
    }
}
