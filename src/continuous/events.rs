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
//!    there is an *event* after a step at whose end something acts no more: two shapes have ceased
//!    to overlap, or a joint has left its limit, and the integrator begins anew. What begins to act
//!    needs none: the slopes of before are too small then, and the solution does not converge.
//! 3. It may have begun to act after the last event, also within a step: an importer may take many
//!    steps of its integrator for one, as `FMPy` does from one output to the next. So a joint that
//!    came to its limit and left it within 4 ms hovered there for a second. Therefore limits count
//!    that have acted where derivatives were asked for. Contacts do not: trial places of the
//!    integrator are in the ground where its steps are not, and each event costs a Jacobian.
//!
//! Nothing that is integrated depends on them.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, can_pass, may_pass};
use crate::spatial::Vec6;
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use crate::tuning::{LEAST_PLAN, PLAN};

/// What was known at the last event.
#[derive(Clone, Debug)]
pub struct Events {
    /// What acted at the last event or has acted since, in any order, see [`find_acting`].
    acted: Vec<usize>,
    /// Scratch for what acts.
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
            acted: Vec::with_capacity(most),
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
        find_acting(ctx, point, &mut self.acted);
        self.known = true;
        self.next = f64::INFINITY;
        if !self.passes {
            return None;
        }
        let mut h = PLAN;
        while h > LEAST_PLAN && may_pass(ctx.tree, &point.kin, A, h, &self.acted) {
            h *= 0.5;
        }
        self.next = time + h;
        Some(self.next)
    }

    /// Takes note of limits of joints that act where derivatives are asked for.
    pub fn watch(&mut self, ctx: &Context, point: &Point) {
        if self.known {
            self.now.clear();
            add_stopped(ctx, point, &mut self.now);
            for acts in &self.now {
                if !self.acted.contains(acts) {
                    self.acted.push(*acts);
                }
            }
        }
    }

    /// Whether a step that ends at `time`, s, ends in an event.
    pub fn has_come(&mut self, ctx: &Context, (point, A): (&Point, &[Vec6]), time: f64) -> bool {
        if !self.known {
            return true;
        }
        find_acting(ctx, point, &mut self.now);
        let ended = self.acted.iter().any(|acts| !self.now.contains(acts));
        if !ended {
            self.acted.clone_from(&self.now);
        }
        let left = self.next - time;
        ended
            || self.passes
                && left > LEAST_PLAN
                && may_pass(ctx.tree, &point.kin, A, left, &self.now)
    }
}

/// Lists the slots of contacts whose shapes overlap, ascending, then the limits of joints that act.
fn find_acting(ctx: &Context, point: &Point, acting: &mut Vec<usize>) {
    acting.clear();
    let set = &point.terms.contacts;
    let overlaps = |c: &&Contact| c.depth > 0.0;
    acting.extend(set.iter().filter(overlaps).map(|contact| contact.slot));
    add_stopped(ctx, point, acting);
}

/// Adds the limits of joints that act, by numbers that no slot has: from the largest one downwards,
/// two for each degree of freedom.
#[cfg_attr(small, optimize(size))]
fn add_stopped(ctx: &Context, point: &Point, acting: &mut Vec<usize>) {
    for term in &point.terms.joints {
        let stopped = term.is_stopped(ctx.tree.limit_load(term.dof));
        for (side, stopped) in stopped.into_iter().enumerate() {
            if stopped {
                acting.push(usize::MAX - 2 * term.dof - side);
            }
        }
    }
}
