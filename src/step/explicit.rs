//! The explicit method: Runge–Kutta steps where nothing stiff acts but damping.
//!
//! Dormand–Prince 5(4) takes the long steps; Bogacki–Shampine 3(2) those that end early because the
//! communication step does; Kennedy–Carpenter, which takes damping implicitly, those in which
//! damping is faster than the step. While no input changes a step may reach beyond the
//! communication point, see [`crate::state::ahead`]. Rigid bodies on which nothing but gravity acts
//! need none of them, see `coast.rs`.

mod rates;
pub mod runge_kutta;
pub mod tableau;

use self::rates::{Rates, Search};
use self::runge_kutta::{RungeKutta, Smooth};
use self::tableau::{BOGACKI_SHAMPINE, DORMAND_PRINCE, KENNEDY_CARPENTER, Pair};
use crate::force::{ContactSet, Drive, JointTerm, is_clear};
use crate::kinematics::Kinematics;
use crate::model::Model;
use crate::state::ahead::Ahead;
use crate::state::{Physical, State};
use crate::step::attempt::Attempt;
use crate::step::caps::{may_look_ahead, range};
use crate::step::point::{Context, Point};
use crate::step::size::{grown, landing, worst_error};
use crate::step::{coast, guards};
use crate::tree::Tree;
use crate::tuning::{CREEP, FADED, GROWTH, HIT, MAX_STEP, RESOLVED, SHARP, SHORT};

/// An explicit step that may be tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// The method.
    pub pair: &'static Pair,
    /// Its length, s.
    pub h: f64,
}

/// The explicit method and its scratch.
#[derive(Clone, Debug)]
pub(super) struct Explicit {
    pub integrator: RungeKutta,
    /// Poses and velocities where the last try has ended, and unless the tree is long mass matrix
    /// and bias, where its last stage stands there.
    pub end: Kinematics,
    /// None, and scratch of the search for those that shapes have passed by.
    contacts: ContactSet,
    /// For what swings and is damped.
    search: Search,
}

#[cfg(test)]
crate::spoil::spoil!(Explicit: integrator end search; contacts);

/// Whether no joint has anything but efforts and gentle damping, and nothing touches.
fn nothing_stiff(ctx: &Context, here: &Point) -> bool {
    // A motor that is let go may take hold again within the step.
    let may_become_stiff = |term: &JointTerm| {
        ctx.inputs.varies() && term.actuator.is_some() && !matches!(term.drive, Drive::Effort(_))
    };
    let gentle = |term: &JointTerm| {
        let pd = matches!(term.drive, Drive::Pd { .. });
        (pd || !may_become_stiff(term)) && !term.is_stiff_beside_pd() && term.damping >= 0.0
    };
    here.terms.contacts.is_empty() && here.terms.joints.iter().all(gentle)
}

/// Longest step that resolves every pd law which swings or is at its effort limit, and every spring
/// between two points, s. An implicit step that is longer would take the amplitude, or pass over
/// the place where a law comes to its limit. A damped law within its limit may be taken implicitly.
/// Where a law that is resolved comes to its limit or leaves it, the step ends: a kink within a
/// step is a first-order error.
fn swing(rates: &Rates, here: &Point, v: &[f64]) -> f64 {
    let longest = (SHARP * RESOLVED / rates.swinging).sqrt();
    here.terms.joints.iter().fold(longest, |h, term| {
        let Drive::Pd {
            offset,
            kp,
            kd,
            cap,
        } = term.drive
        else {
            return h;
        };
        if !rates::swings(term, here, v) {
            return h;
        }
        let v = v[term.dof];
        let force = offset - kd * v;
        // How fast the law's force grows in its own direction: the joint moves, and this force
        // accelerates it.
        let pull = force.abs().min(cap) * here.kin.inverse_diagonal[term.dof];
        let growth = -(kp * v * force.signum() + kd * pull);
        let crossing = (cap - force.abs()) / growth;
        if crossing > CREEP * h && crossing < h {
            crossing
        } else {
            h
        }
    })
}

/// Whether nothing comes near within `h` seconds, and pd laws, springs with their dampers and a
/// motor's torque–speed line are resolved.
fn is_free(ctx: &Context, rates: &Rates, here: &Point, v: &[f64], h: f64) -> bool {
    let mut joints = here.terms.joints.iter();
    h * h * rates.stiff < RESOLVED
        && h * rates.braked < 1.0
        && joints.all(|term| !term.near_limit(v[term.dof], h))
        && is_clear(ctx.tree, &here.kin, h)
}

impl Explicit {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Box<Self> {
        Box::new(Self {
            integrator: RungeKutta::new(tree, model.nq),
            end: Kinematics::new(tree),
            contacts: ContactSet::of(model),
            search: Search::new(tree),
        })
    }

    /// Method and length of the next explicit step: beyond the communication point as long as
    /// inputs stay as they are, else up to it; none where something stiff acts, or swings too fast.
    ///
    /// - `proposed`: length that the error control proposes, s
    /// - `remaining`: time to the communication point, s
    pub fn plan(
        &mut self,
        ctx: &Context,
        here: &mut Point,
        state: &State,
        [proposed, remaining]: [f64; 2],
    ) -> Option<Plan> {
        if !ctx.rules.explicit || !nothing_stiff(ctx, here) {
            return None;
        }
        here.complete(ctx, &state.physical);
        let v = &state.physical.v;
        let rates = self.search.rates(ctx.tree, here, v);
        let swing = swing(&rates, here, v);
        let long = proposed.min(MAX_STEP).min(swing);
        // What swings faster than the shortest step that is worth while is taken implicitly.
        if swing < state.stepping.sizes.floor[ctx.tree.island.lead] {
            return None;
        }
        if ctx.rules.look_ahead && !state.stepping.ahead.has_changed(ctx.tree) {
            if is_free(ctx, &rates, here, v, long) {
                return Some(if long * rates.damped < FADED {
                    Plan {
                        pair: &DORMAND_PRINCE,
                        h: long,
                    }
                } else {
                    Plan {
                        pair: &KENNEDY_CARPENTER,
                        h: long,
                    }
                });
            }
            // Implicit steps reach farther than those that end at the communication point.
            if may_look_ahead(ctx, here, state, long) {
                return None;
            }
        }
        let h = landing(long, remaining);
        if !is_free(ctx, &rates, here, v, h) {
            return None;
        }
        let short = h < shortened(ctx, proposed);
        let pair = match (h * rates.damped < FADED, short) {
            (true, true) => &BOGACKI_SHAMPINE,
            (true, false) => &DORMAND_PRINCE,
            (false, false) => &KENNEDY_CARPENTER,
            // Cut as short as this, one implicit solve may do.
            (false, true) => return None,
        };
        Some(Plan { pair, h })
    }

    /// Tries a step from where `here` stands; returns its error relative to what it may be.
    pub fn attempt(&mut self, ctx: &Context, here: &Point, from: &Physical, plan: Plan) -> f64 {
        let Plan { pair, h } = plan;
        self.run_stages(ctx, pair, here, from, h, true);
        self.integrator.estimate(pair, ctx.tree, h);
        let [velocity, position] = &self.integrator.error;
        let worst = worst_error(ctx.tree, h, |k| (position[k], velocity[k]));
        let error = worst / pair.allowed(ctx.tolerance);
        if self.stays_free(ctx, here, from, h) {
            error
        } else {
            error.max(HIT)
        }
    }

    /// Tries a step of `h` seconds in which nothing but gravity acts into `attempt`; none where
    /// something else does or comes near, else whether nothing was met.
    pub fn coast(
        &mut self,
        ctx: &Context,
        here: &Point,
        state: &State,
        h: f64,
        attempt: &mut Attempt,
    ) -> Option<bool> {
        let (from, terms) = (&state.physical, &here.terms);
        if !terms.is_free() || !coast::are_rigid(ctx) || !is_clear(ctx.tree, &here.kin, h) {
            return None;
        }
        if !coast::fly(ctx, (&here.kin, from), h, &mut attempt.end) {
            return None;
        }
        attempt.begin(state);
        terms.forget(&mut attempt.end.memory);
        attempt.end_plain_trend(ctx.tree, &from.v, h);
        self.integrator.restart();
        self.end.update_poses(ctx.tree, &attempt.end.q);
        self.end.update_velocities(ctx.tree, &attempt.end.v);
        Some(self.meets_nothing(ctx, here, h))
    }

    fn run_stages(
        &mut self,
        ctx: &Context,
        pair: &Pair,
        here: &Point,
        from: &Physical,
        h: f64,
        finish: bool,
    ) {
        let system = Smooth {
            ctx: *ctx,
            joints: &here.terms.joints,
        };
        let (start, end) = (&here.kin, &mut self.end);
        end.loops.follow(&start.loops);
        self.integrator
            .step(pair, &system, start, end, &from.q, &from.v, h, finish);
    }

    /// Tries a step of `h` seconds, a fixed length, into `attempt` where nothing stiff acts,
    /// nothing is met and no energy is made beyond a `gain`, where one is given, as a share of
    /// kinetic energy and weight times reach; tells whether it may be accepted, or takes as much
    /// from what keeps its energy: it errs by that, and a shorter one may do.
    pub fn attempt_fixed(
        &mut self,
        ctx: &Context,
        here: &mut Point,
        state: &State,
        (h, gain): (f64, Option<f64>),
        attempt: &mut Attempt,
    ) -> Option<bool> {
        let from = &state.physical;
        if !(ctx.rules.explicit && nothing_stiff(ctx, here)) {
            return None;
        }
        here.complete(ctx, from);
        let rates = self.search.rates(ctx.tree, here, &from.v);
        if !(is_free(ctx, &rates, here, &from.v, h) && h * rates.damped < FADED) {
            return None;
        }
        self.integrator.restart();
        // The short pair takes y⁴/24 of the amplitude of a spring in a step of the angle y, and of
        // what whirls on it or on a loop, or turns fast.
        let springs = |term: &JointTerm| matches!(term.drive, Drive::Pd { .. });
        let sprung = !here.terms.springs.is_empty() || here.terms.joints.iter().any(springs);
        let pair = if sprung || gain.is_some() {
            &DORMAND_PRINCE
        } else {
            &BOGACKI_SHAMPINE
        };
        self.run_stages(ctx, pair, here, from, h, false);
        attempt.begin(state);
        self.finish((ctx.tree, here), pair, (from, h), attempt);
        ctx.tree
            .carry_driven((&from.q, &from.v), h, &mut attempt.end.q);
        let made = gain.map_or(0.0, |gain| {
            let books = guards::open_books(ctx, here, from, gain);
            let end = (&attempt.end, &self.end);
            guards::gain_explicitly(ctx, &books, here, (from, h), end)
        });
        let sound = attempt.end.is_finite() && made <= 1.0 && self.stays_free(ctx, here, from, h);
        sound.then(|| made >= -1.0 || !guards::is_kept(ctx, &here.terms))
    }

    /// Whether the step just tried has stayed within all limits, and has ended off the ground and
    /// met nothing on its way.
    fn stays_free(&mut self, ctx: &Context, here: &Point, from: &Physical, h: f64) -> bool {
        let within = here.terms.joints.iter().all(|term| {
            ctx.tree.dofs.limits[term.dof].is_none_or(|limits| {
                let (place, dof) = (term.coordinate, term.dof);
                let (q, v) = (&self.integrator.q, &self.integrator.v);
                let [low, high] = range([from.q[place], q[place]], [from.v[dof], v[dof]], h);
                low >= limits.lower && high <= limits.upper
            })
        });
        within && self.meets_nothing(ctx, here, h)
    }

    /// Whether the step just tried has ended off the ground and met nothing on its way.
    fn meets_nothing(&mut self, ctx: &Context, here: &Point, h: f64) -> bool {
        let known = &here.terms.contacts;
        is_clear(ctx.tree, &self.end, 0.0)
            && !self.contacts.has_missed(ctx.tree, &self.end, h, known)
    }

    /// Puts the step just tried into `attempt`, and takes its rates as those of the next one.
    pub fn finish(
        &mut self,
        (tree, here): (&Tree, &Point),
        pair: &Pair,
        step: (&Physical, f64),
        attempt: &mut Attempt,
    ) {
        self.put(tree, here, step, attempt);
        self.integrator.accept(pair);
    }

    /// Puts the step just tried into `attempt`: nothing touches, so nothing is displaced.
    pub fn put(
        &mut self,
        tree: &Tree,
        here: &Point,
        (from, h): (&Physical, f64),
        attempt: &mut Attempt,
    ) {
        tree.copy_positions(&self.integrator.q, &mut attempt.end.q);
        tree.copy_velocities(&self.integrator.v, &mut attempt.end.v);
        here.terms.forget(&mut attempt.end.memory);
        attempt.end_plain_trend(tree, &from.v, h);
    }

    /// The same for a step of `plan` that began at time `start` and reaches beyond the
    /// communication point at `end`: what lies beyond it goes into `ahead`.
    pub fn finish_ahead(
        &mut self,
        (tree, here): (&Tree, &Point),
        plan: Plan,
        from: &Physical,
        [start, end]: [f64; 2],
        (ahead, attempt): (&mut Ahead, &mut Attempt),
    ) {
        let Plan { pair, h } = plan;
        self.integrator
            .extension((tree, pair), &from.q, &from.v, [start, h], ahead);
        self.finish((tree, here), pair, (from, h), attempt);
        ahead.evaluate(tree, end, &mut attempt.end.q, &mut attempt.end.v);
        tree.carry_driven((&from.q, &from.v), end - start, &mut attempt.end.q);
    }
}

/// The next proposal after an explicit step, in steps of the longer pair.
///
/// - `factor`: by what the next step may be longer
pub(super) fn next_proposal(ctx: &Context, proposed: f64, plan: Plan, factor: f64) -> f64 {
    let Plan { pair, h } = plan;
    if pair.order > BOGACKI_SHAMPINE.order {
        grown(proposed, h, factor)
    } else if factor >= GROWTH.1 {
        proposed
    } else {
        proposed.min(h * factor / shortened(ctx, 1.0))
    }
}

/// Length of the steps in which the short pair errs as much as the long one does in steps of `h`
/// seconds, s.
///
/// Errors of orders `p < q` in steps that share a time scale `T` are `(h/T)^p` and `(h/T)^q`: both
/// pairs err by `e` where their steps have the ratio `e^(1/p − 1/q)`.
fn shortened(ctx: &Context, h: f64) -> f64 {
    let [p, q] = [BOGACKI_SHAMPINE.order, DORMAND_PRINCE.order].map(f64::from);
    h * SHORT * libm::pow(DORMAND_PRINCE.allowed(ctx.tolerance), (q - p) / (p * q))
}
