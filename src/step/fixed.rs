//! Steps of a length that the user fixes.
//!
//! Each is taken in two stages. Where what touches is not the same in both, or friction lags behind
//! its cones, it has one solve with the friction cones and the bias of its start instead, and one
//! with those of its middle unless that changes nothing. It is taken in parts where something turns
//! far in it, its middle is not found, or it makes energy or takes some as lever arms turn, and
//! under error control where a point bounces or no part is short enough.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::{crba, rnea};
use crate::force::{ContactPoint, ContactSet, detect, seek};
use crate::kinematics::{advance, forward};
use crate::model::Model;
use crate::range::SHORTEST_FIXED_STEP;
use crate::spatial::{Vec3, Vec6};
use crate::state::{Counters, Physical, State};
use crate::step::attempt::Attempt;
use crate::step::caps::still_bounces;
use crate::step::closing::Closing;
use crate::step::convex::{Frame, Problem};
use crate::step::explicit::Explicit;
use crate::step::guards;
use crate::step::implicit::Implicit;
use crate::step::point::{Context, Point};
use crate::step::size::{fastest, fastest_within, worst_error};
use crate::step::stages::secants::Ending;
use crate::step::stages::{Stages, lag_allowed};
use crate::tree::Tree;
use crate::tuning::{AHEAD, CALM, FIXED_ACCURACY, GAIN, MAX_PARTS, STEP_ROUND_OFF, TURN, WHIRL};

/// Scratch of fixed steps.
#[derive(Clone, Debug)]
pub(super) struct Fixed {
    /// Velocities that the first solve has found, `nv`.
    first: Vec<f64>,
    /// Velocities that the bias of the second solve is taken at, `nv`.
    mean: Vec<f64>,
    /// Positions half way, `nq`.
    q_middle: Vec<f64>,
    /// Contacts there.
    contacts: ContactSet,
}

#[cfg(test)]
crate::spoil::spoil!(Fixed: first mean q_middle contacts;);

impl Fixed {
    /// Room for a robot.
    pub fn new(model: &Model) -> Self {
        Self {
            first: vec![0.0; model.nv()],
            mean: vec![0.0; model.nv()],
            q_middle: vec![0.0; model.nq],
            contacts: ContactSet::of(model),
        }
    }
}

/// What became of a fixed step that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// It may be accepted.
    Good,
    /// Something turns too far in it, its middle is not found, it makes energy or takes some from
    /// what keeps it, or it leaves the numbers: a shorter one may do.
    Bad,
    /// A contact with restitution touches in it.
    Bounces,
}

/// Lengths of a fixed step, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Its own.
    pub h: f64,
    /// That of the whole step that it is a part of.
    pub whole: f64,
}

/// The methods that a fixed step is made of, with their scratch.
pub(super) struct Methods<'a> {
    /// Where it begins; put half way where something turns.
    pub here: &'a mut Point,
    /// Where it ends.
    pub there: &'a mut Point,
    pub implicit: &'a mut Implicit,
    pub stages: &'a mut Stages,
    pub explicit: &'a mut Explicit,
    pub closing: &'a mut Closing,
}

impl Fixed {
    /// Tries a step into `attempt`, explicit where nothing stiff acts, else implicit, and closes
    /// its loops.
    pub fn attempt(
        &mut self,
        ctx: &Context,
        methods: &mut Methods,
        state: &State,
        part: Part,
        (attempt, counters): (&mut Attempt, &mut Counters),
    ) -> Outcome {
        let outcome = self.attempt_open(ctx, methods, state, part, (attempt, counters));
        if outcome != Outcome::Good || !ctx.tree.is_closed() {
            return outcome;
        }
        let (kin, end) = (&mut methods.there.kin, &mut attempt.end);
        methods.explicit.integrator.restart();
        let closes = methods.closing.close(ctx.tree, kin, end, 0.0).is_finite();
        // Forces of loops do no work: what closing them takes is what the step errs by.
        let books = [methods.closing.taken, GAIN * part.h / part.whole];
        if closes && !guards::takes(ctx, kin, end, books) {
            Outcome::Good
        } else {
            counters.rejected += 1;
            Outcome::Bad
        }
    }

    /// The same without closing them.
    fn attempt_open(
        &mut self,
        ctx: &Context,
        methods: &mut Methods,
        state: &State,
        part: Part,
        (attempt, counters): (&mut Attempt, &mut Counters),
    ) -> Outcome {
        let from = &state.physical;
        let turning = fastest(ctx.tree, &from.v) * part.whole > TURN;
        // A loop that is nearly stretched out begins slowly and whirls within the step.
        let gain = (turning || ctx.tree.is_closed()).then(|| GAIN * part.h / part.whole);
        let explicit = &mut *methods.explicit;
        if let Some(free) = explicit.coast(ctx, methods.here, state, part.h, attempt) {
            if free {
                return Outcome::Good;
            }
        } else {
            let length = (part.h, gain);
            match explicit.attempt_fixed(ctx, methods.here, state, length, attempt) {
                Some(true) => return Outcome::Good,
                Some(false) => {
                    counters.rejected += 1;
                    return Outcome::Bad;
                }
                None => {}
            }
        }
        if let Some(outcome) = Self::attempt_stages(ctx, methods, state, part, attempt) {
            counters.rejected += u64::from(outcome != Outcome::Good);
            return outcome;
        }
        attempt.begin(state);
        self.attempt_implicit(ctx, methods, state, part, (attempt, counters))
    }

    /// The same in two stages; none where what touches, or a limit, is not the same in both: an
    /// impact that the stages do not resolve would throw the robot back. None either where friction
    /// is off by more than the tolerance.
    fn attempt_stages(
        ctx: &Context,
        methods: &mut Methods,
        state: &State,
        part: Part,
        attempt: &mut Attempt,
    ) -> Option<Outcome> {
        let Methods {
            here,
            there,
            stages,
            ..
        } = methods;
        let (tree, Part { h, whole }) = (ctx.tree, part);
        let (from, trend) = (&state.physical, &state.stepping.trend);
        let solved = stages.solve(ctx, (here, from), trend, [h, FIXED_ACCURACY[0]], true);
        if ctx.rules.bounce && stages.touchdown(here, h).is_some() {
            return Some(Outcome::Bounces);
        }
        if !solved {
            return None;
        }
        if ctx.rules.parts && stages.turned(tree, from, (1, h)) > WHIRL {
            return Some(Outcome::Bad);
        }
        let books = guards::open_books(ctx, here, from, GAIN * h / whole);
        let step = Ending {
            here,
            from,
            books: &books,
            lengths: [h, FIXED_ACCURACY[0]],
            alike: true,
        };
        let ended = stages.end(ctx, &step, (there, attempt), |stages, _, attempt| {
            attempt.begin(state);
            stages.finish(ctx, (here, from), h, attempt);
            0.0
        })?;
        if !attempt.end.is_finite() {
            return None;
        }
        let bad =
            ended.gain > 1.0 || stages.has_no_middle() || guards::has_missed(ctx, (here, there), h);
        Some(if bad { Outcome::Bad } else { Outcome::Good })
    }

    /// One solve with the friction cones and the bias of the start, one with those of the middle
    /// unless that changes nothing.
    pub fn attempt_implicit(
        &mut self,
        ctx: &Context,
        methods: &mut Methods,
        state: &State,
        part: Part,
        (attempt, counters): (&mut Attempt, &mut Counters),
    ) -> Outcome {
        let Methods {
            here,
            there,
            implicit,
            stages,
            ..
        } = methods;
        let (tree, Part { h, whole }) = (ctx.tree, part);
        let (from, trend) = (&state.physical, &state.stepping.trend);
        here.complete(ctx, from);
        here.expect_commands(ctx, from, h);
        let problem = fixed_problem(here, tree, h);
        implicit.full.guess_start(&problem, &from.v);
        let outcome = implicit.full.solve(&problem);
        implicit.iterations = implicit.iterations.max(outcome.iterations);
        // Where hardly anything happens the middle is as the start.
        if outcome.converged && implicit.single_error(ctx, from, &trend.whole, h) <= CALM * h * h {
            implicit.take_full(ctx, here, from, h, attempt);
            return Outcome::Good;
        }
        let turn = fastest_within(ctx.tree, [&from.v, &implicit.full.v]);
        if ctx.rules.parts && turn * h > WHIRL {
            return Outcome::Bad;
        }
        let turning = turn * whole > TURN;
        let books = guards::open_books(ctx, here, from, GAIN * h / whole);
        let share = if turning { AHEAD } else { 0.5 };
        for ((mean, a), b) in self.mean.iter_mut().zip(&from.v).zip(&implicit.full.v) {
            *mean = a + share * (b - a);
        }
        if turning {
            self.first.copy_from_slice(&implicit.full.v);
            self.go_to_middle(ctx, here, from, h);
        }
        forward(tree, &here.kin.S, &self.mean, &mut here.kin.V);
        let (wrenches, middle) = (&ctx.inputs.wrenches, ctx.elapsed + 0.5 * h);
        rnea::bias(tree, &mut here.kin, &self.mean, wrenches, middle);
        let Point { kin, terms, .. } = &mut **here;
        let frame = Frame {
            tree,
            kin,
            h,
            ahead: if turning { 0.5 * h } else { h },
            accuracy: FIXED_ACCURACY,
        };
        if turning {
            implicit
                .full
                .guess_with_cones((&frame, terms), &from.v, &self.first);
        } else {
            implicit.full.carry((tree, kin), terms, h);
        }
        let cones = lag_allowed(ctx, h);
        let (outcome, _) = implicit.full.solve_with_cones(&frame, terms, cones, None);
        implicit.iterations = implicit.iterations.max(outcome.iterations);
        counters.rejected += u64::from(!outcome.converged);
        if !tree.worked_dofs().all(|k| implicit.full.v[k].is_finite()) {
            return Outcome::Bad;
        }
        implicit.take_full(ctx, here, from, h, attempt);
        let parts = (&here.terms, &implicit.full);
        let work = guards::work(ctx, &here.kin, parts, [h, middle]);
        let lost = stages.taken_by_drift(&here.terms.contacts, &implicit.full.responses, h);
        let spoilt = guards::spoils(ctx, &books, (here, there), &attempt.end, [h, work]);
        let drained = books.are_drained(lost, h / whole);
        if spoilt || drained || turning && self.has_no_middle(ctx, from, &attempt.end, h) {
            counters.rejected += 1;
            return Outcome::Bad;
        }
        Outcome::Good
    }

    /// Whether the step to `end` of `h` seconds errs by more than the tolerance because its middle
    /// was taken where the first solve leads and not where the second one does: see
    /// [`Stages::has_no_middle`].
    fn has_no_middle(&self, ctx: &Context, from: &Physical, end: &Physical, h: f64) -> bool {
        let turned = h * fastest_within(ctx.tree, [&from.v, &end.v]);
        let unexpected = |k: usize| (0.0, 0.5 * turned * (end.v[k] - self.first[k]));
        worst_error(ctx.tree, h, unexpected) > ctx.tolerance
    }

    /// Puts mass matrix, joint motions and lever arms to where the robot is half way with the
    /// velocities `self.first`. Gaps stay those of the start, for lever arms of the middle.
    fn go_to_middle(&mut self, ctx: &Context, here: &mut Point, from: &Physical, h: f64) {
        let tree = ctx.tree;
        advance(tree, &from.q, &self.first, 0.5 * h, &mut self.q_middle);
        let Point { kin, terms, .. } = here;
        kin.update_poses(tree, &self.q_middle);
        crba::mass_matrix(tree, kin);
        kin.update_velocities(tree, &self.first);
        let (touches, found) = (&from.memory.touches, &mut self.contacts);
        detect(ctx.model, tree, touches, kin, h, found);
        let places = &found.points;
        let mut found = found.list.iter().peekable();
        let ContactSet { list, points, .. } = &mut terms.contacts;
        for contact in list {
            let Some(f) = seek(&mut found, contact.slot, |f| f.slot) else {
                continue;
            };
            let velocities = f.velocities(places, &kin.V);
            for (place, v) in places[f.points.clone()].iter().zip(velocities) {
                let own = &mut points[contact.points.clone()];
                if let Some(point) = own.iter_mut().find(|p| p.is(place)) {
                    (point.x, point.arm) = (place.x, place.arm);
                    (point.normal, point.row) = (place.normal, place.row);
                    point.rim = place.rim;
                    point.depth = place.depth + 0.5 * h * v.along;
                }
            }
            if let (Some(other), Some(then)) = (&contact.other, &f.other) {
                // Points between shapes have no names by which they are found again. Their rows
                // stay where they were at the start, and so does the way between the origins of
                // both bodies. By how much that has changed, they are off from each of them half.
                let own = &mut points[contact.points.clone()];
                let moved = middle(&places[f.points.clone()]) - middle(own);
                for point in own {
                    point.x += moved + (then.from - other.from) * 0.5;
                }
            }
            contact.center_on_load(points);
        }
    }
}

/// Middle of points, from O.
fn middle(points: &[ContactPoint]) -> Vec3 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = points.len() as f64;
    points.iter().map(|p| p.x).sum::<Vec3>() / count
}

/// Whether a contact that has restitution touches down within `h` seconds, or has done so and not
/// come to rest yet, or shapes come nearer than they are thick. That is over in less than a fixed
/// step, which would swallow it: it is taken under error control.
pub(super) fn bounces(here: &Point, pull: &[Vec6], h: f64) -> bool {
    let (points, V) = (&here.terms.contacts.points, &here.kin.V);
    here.terms.contacts.iter().any(|contact| {
        let bounces = still_bounces(here, contact, pull)
            && (contact.depth > 0.0 || contact.time_to_touch(points, V) < h);
        bounces || contact.longest_step(points, V, h) < h
    })
}

/// How many fixed steps lead over `span` seconds. Importers' steps carry round-off: a millionth
/// more than a whole number of steps is that number.
pub(super) fn fixed_count(ctx: &Context, span: f64) -> f64 {
    libm::ceil(span / ctx.fixed_step - STEP_ROUND_OFF).max(1.0)
}

/// In how many parts a step of `h` seconds is to be taken: so many that nothing turns too far in
/// one, and none is shorter than a fixed step may be.
pub(super) fn parts(ctx: &Context, v: &[f64], h: f64) -> f64 {
    if !ctx.rules.parts {
        return 1.0;
    }
    let most = (h / SHORTEST_FIXED_STEP).clamp(1.0, MAX_PARTS);
    libm::ceil(fastest(ctx.tree, v) * h / WHIRL - 1e-9).clamp(1.0, most)
}

/// Whether a part of a step of `whole` seconds that went badly may be taken in halves.
pub(super) fn may_be_halved(part: f64, whole: f64) -> bool {
    part > (1.5 * whole / MAX_PARTS).max(2.0 * SHORTEST_FIXED_STEP)
}

/// What is solved for a step of `h` seconds from `start`.
fn fixed_problem<'a>(start: &'a Point, tree: &'a Tree, h: f64) -> Problem<'a> {
    let [accuracy, iterated] = FIXED_ACCURACY;
    Problem {
        iterated,
        ..start.problem(tree, h, accuracy)
    }
}
