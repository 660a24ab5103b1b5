//! Events of a robot that an importer integrates.
//!
//! The laws are continuous, but an integrator cannot know what it does not ask for:
//!
//! 1. In free flight any method is exact, and takes steps as long as it likes. Between two of its
//!    places a ball may pass a shelf, or a floor that is a mesh, and nothing has been felt of it.
//!    So there is a *time event* before two shapes can have passed each other, see [`may_pass`];
//!    planned anew at each event, and brought forward where velocities have grown since.
//! 2. What leaves the ground keeps a slope of 10⁵/s until nothing pushes it any more, and none
//!    after that. An implicit method that goes on with the slopes of before takes any residual for
//!    the error of a converged solution: CVODE at 1e-4 let balls hover at 2 cm/s, and threw a cube
//!    46 m high. So there is a *state event* where something has left, and the integrator begins
//!    anew. What begins to act needs none: the slopes of before are too small then, and the
//!    solution does not converge.
//! 3. Nothing pushes what leaves faster than `v_e`, see [`Damping`](crate::law::Damping). What has
//!    been pressed in leaves just below `v_e`, by less than the tolerance, so it would cross `v_e`
//!    again and again. At `2 v_e` it has surely gone astray, and falls back for `v_e/g`, 2 ms. So
//!    it has left where the shapes overlap no more, or where they part with [`LEFT`] times `v_e`.
//! 4. The one *event indicator* is the least margin of all contacts, in parts of the depth for
//!    which a spring is made and of `v_e`; 1 where nothing touches. An integrator watches it at the
//!    end of each of its own steps, of which an importer such as `FMPy` may take many for one. A
//!    contact counts from the first time on that the indicator is asked for. Trial places of the
//!    integrator do not count: they are in the ground where its steps are not, and each event costs
//!    a Jacobian.
//! 5. Limits of joints are shorter than the tolerance of an angle: there it matters what trial
//!    places have felt. So a step event comes where a limit has acted, also where nothing but
//!    derivatives were asked for, and acts no more. A joint that came to its limit and left it
//!    within 4 ms hovered there for a second.
//!
//! Nothing that is integrated depends on them.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, can_pass, may_pass};
use crate::model::{Model, RootId};
use crate::spatial::Vec6;
use crate::step::point::{Context, Point};
use crate::tree::Tree;
use crate::tuning::{LEAST_PLAN, LEFT, PLAN};

/// What was known at the last event, and what has begun to act since.
#[derive(Clone, Debug)]
pub struct Events {
    /// Slots of contacts that act, in any order.
    touching: Vec<usize>,
    /// Scratch for slots of shapes that overlap.
    overlapping: Vec<usize>,
    /// Limits of joints that have acted, see [`find_stopped`].
    stopped: Vec<usize>,
    /// Scratch for those that act.
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
        let limits = 2 * tree.dofs.weight.len();
        Self {
            touching: Vec::with_capacity(contacts),
            overlapping: Vec::with_capacity(contacts),
            stopped: Vec::with_capacity(limits),
            now: Vec::with_capacity(limits),
            known: false,
            next: f64::INFINITY,
            passes: can_pass(tree),
        }
    }

    /// How many indicators a model has: none where nothing floats that can touch something. What is
    /// mounted is held by its joints, and the ends of steps are enough.
    ///
    /// Who has an indicator gets inputs that follow a table anew wherever `FMPy` asks for it, so
    /// that they jump between the steps of CVODE. The arm of the examples, whose servos have rates
    /// of 10⁷/s, then took more than 500 steps between two outputs.
    pub fn indicators(model: &Model) -> usize {
        let floats = (0..)
            .map(RootId)
            .zip(&model.roots)
            .any(|(id, _)| model.floats(id));
        usize::from(floats && model.contact_room()[0] > 0)
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
        self.touching.clear();
        self.known = true;
        self.note(point);
        find_stopped(ctx, point, &mut self.stopped);
        self.next = f64::INFINITY;
        if !self.passes {
            return None;
        }
        self.find_overlapping(point);
        let mut h = PLAN;
        while h > LEAST_PLAN && may_pass(ctx.tree, &point.kin, A, h, &self.overlapping) {
            h *= 0.5;
        }
        self.next = time + h;
        Some(self.next)
    }

    /// Takes note of limits of joints that act where derivatives are asked for.
    pub fn watch(&mut self, ctx: &Context, point: &Point) {
        if self.known {
            find_stopped(ctx, point, &mut self.now);
            for limit in &self.now {
                if !self.stopped.contains(limit) {
                    self.stopped.push(*limit);
                }
            }
        }
    }

    /// Takes note of contacts that have begun.
    fn note(&mut self, point: &Point) {
        let touching = &mut self.touching;
        for (slot, margin) in margins(point) {
            // Who takes no part in events leaves in the list what has left.
            let has_room = touching.len() < touching.capacity();
            if margin > 0.0 && has_room && !touching.contains(&slot) {
                touching.push(slot);
            }
        }
    }

    /// The least margin of all contacts.
    pub fn margin(&self, point: &Point) -> f64 {
        if !self.known {
            return 1.0;
        }
        let of_all = margins(point).filter(|(slot, _)| self.touching.contains(slot));
        let (found, least) = of_all.fold((0, 1.0_f64), |(found, least), (_, margin)| {
            (found + 1, least.min(margin))
        });
        // What is not found is far apart.
        if found < self.touching.len() {
            least.min(-1.0)
        } else {
            least
        }
    }

    /// The event indicator at the end of a step of the integrator.
    pub fn indicate(&mut self, point: &Point) -> f64 {
        if self.known {
            self.note(point);
        }
        self.margin(point)
    }

    /// Whether a step of the importer that ends at `time`, s, ends in an event.
    pub fn has_come(&mut self, ctx: &Context, (point, A): (&Point, &[Vec6]), time: f64) -> bool {
        if !self.known || self.indicate(point) <= 0.0 {
            return true;
        }
        find_stopped(ctx, point, &mut self.now);
        if self.stopped.iter().any(|limit| !self.now.contains(limit)) {
            return true;
        }
        self.stopped.clone_from(&self.now);
        let left = self.next - time;
        if !self.passes || left <= LEAST_PLAN {
            return false;
        }
        self.find_overlapping(point);
        may_pass(ctx.tree, &point.kin, A, left, &self.overlapping)
    }

    /// Lists the slots of contacts whose shapes overlap.
    fn find_overlapping(&mut self, point: &Point) {
        let set = &point.terms.contacts;
        let overlaps = |c: &&Contact| c.depth > 0.0;
        let slots = set.iter().filter(overlaps).map(|contact| contact.slot);
        self.overlapping.clear();
        self.overlapping.extend(slots);
    }
}

/// The slot of each contact that is near, and the margin that it has before it has left.
fn margins(point: &Point) -> impl Iterator<Item = (usize, f64)> + '_ {
    let (set, V) = (&point.terms.contacts, &point.kin.V);
    set.iter().map(|contact| {
        let leaving = contact.weights * contact.normal_velocity(&set.points, V);
        let speed = LEFT - leaving / contact.damping.fastest;
        let depth = contact.depth / contact.spring.reference;
        (contact.slot, depth.min(speed))
    })
}

/// Lists the limits of joints that act: two numbers for each degree of freedom.
#[cfg_attr(small, optimize(size))]
fn find_stopped(ctx: &Context, point: &Point, stopped: &mut Vec<usize>) {
    stopped.clear();
    for term in &point.terms.joints {
        let acts = term.is_stopped(ctx.tree.limit_load(term.dof));
        let sides = acts.into_iter().enumerate().filter(|(_, acts)| *acts);
        stopped.extend(sides.map(|(side, _)| 2 * term.dof + side));
    }
}
