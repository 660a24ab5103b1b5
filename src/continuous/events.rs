//! Events of a robot that an importer integrates.
//!
//! The laws are continuous, but an integrator cannot know what it does not ask for:
//!
//! 1. In free flight any method is exact, and takes steps as long as it likes. Between two of its
//!    places a ball may pass a shelf, or a floor that is a mesh, and nothing has been felt of it.
//!    So there is a *time event* before two shapes can have passed each other, see [`may_pass`];
//!    planned anew at each event, and brought forward where velocities have grown since.
//! 2. What leaves the ground keeps a slope of 10⁵/s until it has left, and none after that. An
//!    implicit method that goes on with the slopes of before takes any residual for the error of a
//!    converged solution: CVODE at 1e-4 let balls hover at 2 cm/s, and threw a cube 46 m high. So
//!    there is an *event* after a step in which two shapes have begun or ceased to overlap, or a
//!    limit of a joint has been reached or left, and the integrator begins anew.
//!
//! Nothing that is integrated depends on them.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, Terms, can_pass, may_pass};
use crate::spatial::Vec6;
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use crate::tuning::{LEAST_PLAN, PLAN};

/// What was known at the last event.
#[derive(Clone, Debug)]
pub struct Events {
    /// What acts, see [`find_acting`]; and scratch for the same.
    acting: Vec<usize>,
    now: Vec<usize>,
    /// Whether that is known of the present run.
    known: bool,
    /// Time of the planned event, s.
    next: f64,
    /// Whether any two shapes can pass each other.
    passes: bool,
}

impl Events {
    /// Room for what can act of a robot.
    ///
    /// - `contacts`: how many there may be
    pub fn new(tree: &Tree, contacts: usize) -> Self {
        let most = contacts + 2 * tree.dofs.weight.len();
        Self {
            acting: Vec::with_capacity(most),
            now: Vec::with_capacity(most),
            known: false,
            next: f64::INFINITY,
            passes: can_pass(tree),
        }
    }

    /// The state is another one, of which nothing is known.
    pub fn forget(&mut self) {
        self.known = false;
    }

    /// Takes note of what acts at `time`, s, and plans the next event; none where nothing can be
    /// passed.
    ///
    /// - `A`: accelerations of all bodies about O
    pub fn update(
        &mut self,
        ctx: &Context,
        (point, A): (&Point, &[Vec6]),
        time: f64,
    ) -> Option<f64> {
        find_acting(&point.terms, &mut self.acting);
        self.known = true;
        self.next = f64::INFINITY;
        if !self.passes {
            return None;
        }
        let mut h = PLAN;
        while h > LEAST_PLAN && may_pass(ctx.tree, &point.kin, A, h, &self.acting) {
            h *= 0.5;
        }
        self.next = time + h;
        Some(self.next)
    }

    /// Whether a step that ends at `time`, s, ends in an event.
    pub fn has_come(&mut self, ctx: &Context, (point, A): (&Point, &[Vec6]), time: f64) -> bool {
        find_acting(&point.terms, &mut self.now);
        if !self.known {
            return true;
        }
        let left = self.next - time;
        self.now != self.acting
            || self.passes
                && left > LEAST_PLAN
                && may_pass(ctx.tree, &point.kin, A, left, &self.now)
    }
}

/// Lists the slots of contacts whose shapes overlap, ascending, then the limits of joints that act,
/// by numbers that no slot has: from the largest one downwards, two for each degree of freedom.
fn find_acting(terms: &Terms, acting: &mut Vec<usize>) {
    acting.clear();
    let set = &terms.contacts;
    let overlaps = |c: &&Contact| c.depth > 0.0;
    acting.extend(set.iter().filter(overlaps).map(|contact| contact.slot));
    for term in &terms.joints {
        for (side, gap) in term.gap.into_iter().enumerate() {
            if gap < 0.0 {
                acting.push(usize::MAX - 2 * term.dof - side);
            }
        }
    }
}
