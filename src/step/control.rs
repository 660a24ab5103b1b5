//! From one communication point to the next: error control, exact landing, rest, fixed steps.
//!
//! An error-controlled step is solved once over `h` and twice over `h/2`; the difference of the two results is the
//! error estimate, positions and velocities together, and twice the second minus the first is the solution that goes
//! on: second order in smooth motion at the price of the estimate. Steps end at touch-down rather than across it.
//! Where nothing is stiff, explicit steps of fifth order take over (see [`super::smooth`]); as long as no input changes
//! they are as long as the motion allows, and communication points are read off inside them (see [`crate::state::ahead`]).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::actuator::{Drive, JointTerm, Joints};
use crate::contact::{Contact, Turn, detect, find_turns, is_clear};
use crate::dynamics::{crba, rnea};
use crate::inputs::Inputs;
use crate::kinematics::{Kinematics, advance, difference, forward};
use crate::model::Model;
use crate::parameters::Parameters;
use crate::spatial::{Vec3, velocity_at};
use crate::state::{State, Touch};
use crate::step::convex::{Newton, Problem};
use crate::step::smooth::{BOGACKI_SHAMPINE, DORMAND_PRINCE, Explicit, Pair, Smooth};
use crate::tree::Tree;

/// Longest step, s: a robot at rest in the air must still notice that it falls.
const MAX_STEP: f64 = 0.05;
/// Longest explicit step, s.
const MAX_EXPLICIT_STEP: f64 = 0.1;
/// Shortest step that error control asks for, s; a step that fails its test there is accepted and counted.
const MIN_STEP: f64 = 1e-7;
/// Largest value that the shortest step may rise to, s, see [`patience`].
const MAX_FLOOR: f64 = 1e-4;
/// Weight of a velocity error against a position error, s. Without it impacts go unnoticed.
const VELOCITY_WEIGHT: f64 = 0.1;
/// Error, relative to the tolerance and per second, up to which one solve does for a step that the communication step
/// cuts short: what such steps add up to stays below the tolerance.
const SINGLE_RATE: f64 = 0.3;
/// Speed below which a robot may be at rest, rad/s or m/s.
const REST_SPEED: f64 = 1e-7;
/// Relative accuracy of the impulses in fixed-step mode.
const FIXED_ACCURACY: f64 = 1e-8;
/// The short pair takes steps below `SHORT · tolerance^PAIR_EXPONENT` times what the long one proposes: there both
/// meet the tolerance if errors grow like powers of one time scale, `tolerance^(1/3 − 1/5)`.
const SHORT: f64 = 0.5;
/// Share of the tolerance that an explicit step may use: its steps are few and long, and what many of them add up to
/// shall be of the size of the tolerance still. Twice the steps for a fiftieth of the error.
const EXPLICIT_SHARE: f64 = 0.02;
/// Error that an explicit step counts as if it has run into something: half the step is tried next.
const HIT: f64 = 32.0;
/// See [`SHORT`].
const PAIR_EXPONENT: f64 = 2.0 / 15.0;
/// Growth and shrinkage of the step, at most.
const GROWTH: (f64, f64) = (0.1, 5.0);

/// What a step needs and does not change.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The robot.
    pub model: &'a Model,
    /// What follows from it and the parameters.
    pub tree: &'a Tree,
    /// Gains.
    pub parameters: &'a Parameters,
    /// Commands, and wrenches from outside.
    pub inputs: &'a Inputs,
    /// Time since the communication point at which the inputs were set, s.
    pub elapsed: f64,
    /// Error allowed per step.
    pub tolerance: f64,
    /// Fixed step, s; 0 for error control.
    pub fixed_step: f64,
}

impl Context<'_> {
    /// The same, `h` seconds later.
    pub(crate) fn after(&self, h: f64) -> Self {
        Self {
            elapsed: self.elapsed + h,
            ..*self
        }
    }
}

/// The state stopped being finite at the smallest step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite;

/// One place in time: kinematics, contacts and joint terms.
#[derive(Clone, Debug)]
pub struct Point {
    /// Poses, velocities, mass matrix, bias.
    pub kin: Kinematics,
    /// Contact points.
    pub contacts: Vec<Contact>,
    /// Friction of contacts against turning.
    pub turns: Vec<Turn>,
    /// Joint terms.
    pub joints: Joints,
}

impl Point {
    pub(crate) fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            kin: Kinematics::new(tree),
            contacts: Vec::with_capacity(model.contact_slots()),
            turns: Vec::with_capacity(model.contact_slots()),
            joints: Joints::new(model),
        }
    }

    /// Everything at `state`, for steps of at most `h` seconds.
    pub fn update(&mut self, ctx: &Context, state: &State, h: f64) {
        let tree = ctx.tree;
        self.kin.update_poses(tree, &state.q);
        crba::mass_matrix(tree, &mut self.kin);
        self.update_motion(ctx, state, h);
    }

    /// What an explicit step needs of `state`, without the mass matrix if the tree is long: then it is for explicit steps
    /// alone.
    fn update_smooth(&mut self, ctx: &Context, state: &State, h: f64) {
        let tree = ctx.tree;
        if !tree.long {
            self.update(ctx, state, h);
            return;
        }
        self.kin.update_poses(tree, &state.q);
        self.kin.update_velocities(tree, &state.v);
        crba::diagonal(tree, &mut self.kin);
        self.find_terms(ctx, state, h);
    }

    /// What depends on velocities, after the poses are up to date.
    fn update_motion(&mut self, ctx: &Context, state: &State, h: f64) {
        let tree = ctx.tree;
        self.kin.update_velocities(tree, &state.v);
        let wrenches = &ctx.inputs.wrenches;
        rnea::bias(tree, &mut self.kin, &state.v, wrenches, ctx.elapsed);
        tree.sparsity
            .multiply(&self.kin.M, &state.v, &mut self.kin.momentum);
        self.find_terms(ctx, state, h);
    }

    /// Contacts and joint terms, after the kinematics are up to date.
    fn find_terms(&mut self, ctx: &Context, state: &State, h: f64) {
        let Context { model, tree, .. } = *ctx;
        let limit = if ctx.fixed_step > 0.0 {
            // A step cannot resolve an oscillation faster than itself.
            let omega = std::f64::consts::TAU / h.max(f64::MIN_POSITIVE);
            0.25 * tree.moving_mass * omega * omega
        } else {
            f64::INFINITY
        };
        detect(
            model,
            tree,
            &state.touches,
            &self.kin,
            h,
            limit,
            &mut self.contacts,
        );
        find_turns(
            tree,
            &state.touches,
            &self.kin,
            &self.contacts,
            &mut self.turns,
        );
        self.find_joint_terms(ctx, state, 0.0);
    }

    /// Joint terms for a step of `h` seconds: commands that vary count as they are at its end.
    fn find_joint_terms(&mut self, ctx: &Context, state: &State, h: f64) {
        self.joints.update(
            ctx.model,
            ctx.tree,
            ctx.parameters,
            ctx.inputs,
            [ctx.elapsed, h],
            &state.q,
            &state.v,
            &state.motor,
            &state.dry,
            &self.kin.inverse_diagonal,
            &self.kin.bias,
        );
    }

    /// Joint terms for a step of `h` seconds from here, where commands vary.
    fn expect_commands(&mut self, ctx: &Context, state: &State, h: f64) {
        if ctx.inputs.varies() {
            self.find_joint_terms(ctx, state, h);
        }
    }

    fn problem<'a>(&'a self, tree: &'a Tree, h: f64, accuracy: f64) -> Problem<'a> {
        Problem {
            tree,
            kin: &self.kin,
            bias: &self.kin.bias,
            contacts: &self.contacts,
            turns: &self.turns,
            joints: &self.joints.terms,
            h,
            accuracy,
        }
    }
}

/// All scratch of a communication step, sized once. Filling it with NaN between steps changes nothing.
#[derive(Clone, Debug)]
pub struct Stepper {
    /// Start of the step.
    pub start: Point,
    middle: Point,
    full: Newton,
    first: Newton,
    second: Newton,
    half: State,
    backup: State,
    explicit: Explicit,
    guess: Vec<f64>,
    difference: Vec<f64>,
    q_full: Vec<f64>,
    q_halves: Vec<f64>,
}

impl Stepper {
    /// Buffers for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let slots = model.contact_slots();
        // Not clones of one: a clone has no room beyond its length.
        let newton = || Newton::new(tree, slots);
        Self {
            start: Point::new(model, tree),
            middle: Point::new(model, tree),
            full: newton(),
            first: newton(),
            second: newton(),
            half: State::new(model),
            backup: State::new(model),
            explicit: Explicit::new(tree, model.nq),
            guess: vec![0.0; model.nv()],
            difference: vec![0.0; model.nv()],
            q_full: vec![0.0; model.nq],
            q_halves: vec![0.0; model.nq],
        }
    }

    /// Simulates `state` up to exactly `end`.
    ///
    /// # Errors
    /// [`NotFinite`]; `state` is then what it was.
    pub fn advance(&mut self, ctx: &Context, state: &mut State, end: f64) -> Result<(), NotFinite> {
        self.backup.copy_from(state);
        state.last_step = end - state.time;
        state.impulse.fill([0.0; 3]);
        let result = if ctx.fixed_step > 0.0 {
            self.advance_fixed(ctx, state, end)
        } else {
            self.advance_controlled(ctx, state, end)
        };
        if result.is_ok() && state.moves_finitely() {
            state.time = end;
            state.ahead.changed = 0.0;
            for (index, last) in state.commands.iter_mut().enumerate() {
                *last = ctx.inputs.values(index, state.last_step);
            }
            Ok(())
        } else {
            state.copy_from(&self.backup);
            Err(NotFinite)
        }
    }

    fn advance_fixed(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
    ) -> Result<(), NotFinite> {
        let span = end - state.time;
        // Importers' steps carry round-off: a millionth more than a whole number of steps is that number.
        let count = (span / ctx.fixed_step - 1e-6).ceil().max(1.0);
        let h = span / count;
        let mut done = 0.0;
        while done < count {
            let ctx = &ctx.after(done * h);
            self.start.update(ctx, state, h);
            if self.rest(ctx, state, h, span - done * h, FIXED_ACCURACY) {
                return Ok(());
            }
            self.fixed_step(ctx, state, h)?;
            done += 1.0;
        }
        Ok(())
    }

    /// One solve with the friction cone and the bias of the start, one with those of the middle.
    fn fixed_step(&mut self, ctx: &Context, state: &mut State, h: f64) -> Result<(), NotFinite> {
        let tree = ctx.tree;
        self.start.expect_commands(ctx, state, h);
        let problem = self.start.problem(tree, h, FIXED_ACCURACY);
        self.full.guess_start(&problem, &state.v);
        let outcome = self.full.solve(&problem);
        count(state, outcome.iterations);
        for (contact, response) in self.start.contacts.iter_mut().zip(&self.full.responses) {
            contact.cap = contact.mu * contact.normal.dot(&response.impulse) / h;
        }
        for turn in &mut self.start.turns {
            let response = &self.full.responses[turn.contact];
            turn.carry(turn.normal.dot(&response.impulse) / h);
        }
        for ((g, a), b) in self.guess.iter_mut().zip(&state.v).zip(&self.full.v) {
            *g = 0.5 * (a + b);
        }
        forward(tree, &self.start.kin.S, &self.guess, &mut self.start.kin.V);
        let (wrenches, middle) = (&ctx.inputs.wrenches, ctx.elapsed + 0.5 * h);
        rnea::bias(tree, &mut self.start.kin, &self.guess, wrenches, middle);
        let outcome = self
            .full
            .solve(&self.start.problem(tree, h, FIXED_ACCURACY));
        count(state, outcome.iterations);
        if !outcome.converged {
            state.counters[1] += 1;
        }
        if !self.full.v.iter().all(|v| v.is_finite()) {
            return Err(NotFinite);
        }
        self.q_full.copy_from_slice(&state.q);
        advance(tree, &self.q_full, &self.full.v, h, &mut state.q);
        store(ctx, &self.start, &self.full, h, state);
        add_impulses(&self.start.contacts, &self.full, 1.0, &mut state.impulse);
        state.counters[0] += 1;
        Ok(())
    }

    fn advance_controlled(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
    ) -> Result<(), NotFinite> {
        let accuracy = (1e-3 * ctx.tolerance).clamp(1e-10, 1e-5);
        let span = end - state.time;
        let begin = state.time;
        let mut done = follow(ctx.tree, state, end);
        // Inputs that have jumped make the first step shorter than those after it: begin with what was good last time.
        let mut first = state.ahead.changed != 0.0;
        // Whether `self.start` stands at the state already, after an explicit step.
        let mut current = false;
        let mut proposed = state.step[0];
        if first {
            proposed = proposed.min(state.step[1]);
        }
        while done < span {
            let ctx = &ctx.after(done);
            let remaining = span - done;
            if !current {
                let h = landing(proposed.min(MAX_STEP), remaining);
                self.start.update_smooth(ctx, state, h);
                self.explicit.restart();
            }
            if let Some((pair, h)) = self.smooth_step(ctx, state, proposed, remaining) {
                let error = self.explicit_step(ctx, pair, state, h);
                let floor = patience(state, ctx.tolerance, h, remaining);
                let power = -1.0 / f64::from(pair.order);
                let factor = (0.9 * libm::pow(error.max(1e-10), power)).clamp(GROWTH.0, GROWTH.1);
                if error <= 1.0 || (h <= floor && error.is_finite()) {
                    if error > 1.0 {
                        state.counters[3] += 1;
                    }
                    proposed = next_proposal(proposed, h, pair, factor, ctx.tolerance).max(floor);
                    accepted(state, first, h.min(remaining), proposed);
                    first = false;
                    if h > remaining {
                        self.look_ahead(ctx, state, begin + done, h, end);
                        return Ok(());
                    }
                    accept_explicit(&mut self.explicit, pair, state);
                    done = if h >= remaining { span } else { done + h };
                    // The last stage stands at the new state: it tells whether the next step may be explicit, too.
                    std::mem::swap(&mut self.start.kin, &mut self.middle.kin);
                    let next = landing(proposed.min(MAX_STEP), span - done);
                    self.start.find_terms(&ctx.after(h), state, next);
                    current = true;
                } else if error.is_finite() || h > MIN_STEP {
                    state.counters[1] += 1;
                    proposed = (h * factor).max(if error.is_finite() { floor } else { MIN_STEP });
                    current = true;
                } else {
                    return Err(NotFinite);
                }
                continue;
            }
            let mut h = landing(proposed.min(MAX_STEP), remaining);
            if current || ctx.tree.long {
                self.start.update(ctx, state, h);
            }
            current = false;
            if first {
                proposed = self.cap_by_command(ctx, state, proposed, remaining);
            }
            h = self.cap_by_touchdown(h.min(proposed));
            if self.rest(ctx, state, h, remaining, accuracy) {
                return Ok(());
            }
            loop {
                let solved = self.full_solve(ctx, state, h, accuracy);
                // Cut short by the communication step, and hardly anything happens: the one solve does.
                let settled = solved && !first && 2.0 * h <= proposed && !ctx.inputs.varies();
                if settled && self.single_error(ctx, state, h) <= SINGLE_RATE * h {
                    self.accept_single(ctx, state, h);
                    done = if h >= remaining { span } else { done + h };
                    accepted(state, first, h, proposed);
                    break;
                }
                let error = if solved {
                    self.doubled_step(ctx, state, h, accuracy)
                } else {
                    f64::INFINITY
                };
                let factor = (0.9 / error.max(1e-12).sqrt()).clamp(GROWTH.0, GROWTH.1);
                let floor = patience(state, ctx.tolerance, h, remaining);
                if error <= 1.0 || (h <= floor && error.is_finite()) {
                    if error > 1.0 {
                        state.counters[3] += 1;
                    }
                    begin_trend(state);
                    self.accept_doubled(ctx, state, h, error <= 1.0);
                    end_trend(state, h);
                    proposed = grown(proposed, h, factor).max(floor);
                    done = if h >= remaining { span } else { done + h };
                    accepted(state, first, h, proposed);
                    first = false;
                    break;
                }
                if h <= MIN_STEP {
                    return Err(NotFinite);
                }
                state.counters[1] += 1;
                h = (h * factor).max(if error.is_finite() { floor } else { MIN_STEP });
                proposed = h;
            }
        }
        Ok(())
    }

    /// Method and length of the next explicit step: beyond the communication point as long as inputs stay as they
    /// are, else up to it; none where something stiff acts.
    fn smooth_step(
        &self,
        ctx: &Context,
        state: &State,
        proposed: f64,
        remaining: f64,
    ) -> Option<(&'static Pair, f64)> {
        if !self.nothing_stiff(ctx) {
            return None;
        }
        let long = proposed.min(MAX_EXPLICIT_STEP);
        if state.ahead.changed == 0.0 && self.is_free(ctx, state, long) {
            return Some((&DORMAND_PRINCE, long));
        }
        let h = landing(long, remaining);
        let short = h < SHORT * proposed * libm::pow(ctx.tolerance, PAIR_EXPONENT);
        let pair = if short {
            &BOGACKI_SHAMPINE
        } else {
            &DORMAND_PRINCE
        };
        self.is_free(ctx, state, h).then_some((pair, h))
    }

    /// Keeps what lies beyond the communication point at `end` of the explicit step of `h` seconds from time `start`.
    fn look_ahead(&mut self, ctx: &Context, state: &mut State, start: f64, h: f64, end: f64) {
        self.explicit
            .extension(&state.q, &state.v, h, &mut state.ahead.coefficients);
        state.ahead.start = start;
        state.ahead.length = h;
        accept_explicit(&mut self.explicit, &DORMAND_PRINCE, state);
        let State { ahead, q, v, .. } = state;
        ahead.evaluate(ctx.tree, end, q, v);
    }

    /// Whether no joint has anything but efforts and gentle damping.
    fn nothing_stiff(&self, ctx: &Context) -> bool {
        // A motor that is let go may take hold again within the step.
        let may_become_stiff = |term: &JointTerm| {
            ctx.inputs.varies()
                && term.actuator.is_some()
                && !matches!(term.drive, Drive::Effort(_))
        };
        self.start.contacts.is_empty()
            && self
                .start
                .joints
                .terms
                .iter()
                .all(|term| !term.is_stiff() && !may_become_stiff(term) && term.damping >= 0.0)
            && ctx.fixed_step == 0.0
    }

    /// Whether nothing comes near within `h` seconds, and damping is resolved.
    fn is_free(&self, ctx: &Context, state: &State, h: f64) -> bool {
        let kin = &self.start.kin;
        self.start.joints.terms.iter().all(|term| {
            !term.near_limit(state.v[term.dof], h)
                && h * term.steepness() * kin.inverse_diagonal[term.dof] < 1.0
        }) && is_clear(ctx.tree, kin, h)
    }
    /// Explicit step into `self.explicit`; returns its error relative to the tolerance.
    fn explicit_step(&mut self, ctx: &Context, pair: &Pair, state: &State, h: f64) -> f64 {
        let system = Smooth {
            ctx: *ctx,
            joints: &self.start.joints.terms,
        };
        let (start, middle) = (&self.start.kin, &mut self.middle.kin);
        self.explicit
            .step(pair, &system, start, middle, &state.q, &state.v, h);
        let [velocity, position] = &self.explicit.error;
        let errors = position.iter().copied().zip(velocity.iter().copied());
        let error = worst_error(errors, &ctx.tree.weight) / (EXPLICIT_SHARE * ctx.tolerance);
        if self.arrives_free(ctx) {
            error
        } else {
            error.max(HIT)
        }
    }

    /// Whether the explicit step just taken has ended within all limits and off the ground.
    fn arrives_free(&self, ctx: &Context) -> bool {
        let within = self.start.joints.terms.iter().all(|term| {
            let q = self.explicit.q[term.coordinate];
            ctx.tree.limits[term.dof].is_none_or(|limits| q >= limits.lower && q <= limits.upper)
        });
        within && is_clear(ctx.tree, &self.middle.kin, 0.0)
    }

    /// A step must not jump over what a changed command sets going: full and half steps would both arrive at the
    /// target and agree.
    fn cap_by_command(&self, ctx: &Context, state: &State, proposed: f64, remaining: f64) -> f64 {
        let mut capped = proposed;
        for term in &self.start.joints.terms {
            let Some(index) = term.actuator else { continue };
            let command = ctx.inputs.values(index, 0.0);
            #[expect(clippy::float_cmp, reason = "any change counts")]
            let unchanged = command == state.commands[index];
            if unchanged && !ctx.inputs.varies() {
                continue;
            }
            let (cap, error) = term.drive.velocity_error(state.v[term.dof]);
            let time = ctx.tree.inertia[term.dof] * error / cap;
            let moved = error * capped.min(remaining) * ctx.tree.weight[term.dof];
            if moved > ctx.tolerance && time < capped {
                capped = time.max(1e-6);
            }
        }
        capped
    }

    /// Ends the step where the first point touches down.
    fn cap_by_touchdown(&self, h: f64) -> f64 {
        let mut capped = h;
        for contact in &self.start.contacts {
            if contact.gap > 0.0 {
                let V = &self.start.kin.V[contact.body];
                let approach = -contact.normal.dot(&velocity_at(V, &contact.x));
                let time = contact.gap / approach;
                if approach > 0.0 && time < capped && time > MIN_STEP {
                    capped = time;
                }
            }
        }
        capped
    }

    /// If the robot stands still and all forces balance, it stays: nothing moves until `remaining` has passed. The
    /// test does not depend on `h`, so it does not depend on the communication step either.
    fn rest(
        &mut self,
        ctx: &Context,
        state: &mut State,
        h: f64,
        remaining: f64,
        accuracy: f64,
    ) -> bool {
        let speed = state.v.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        // Forces that balance now need not balance later if a command changes.
        if speed >= REST_SPEED || ctx.inputs.varies() {
            return false;
        }
        if speed > 0.0 {
            self.guess.copy_from_slice(&state.v);
            state.v.fill(0.0);
            self.start.update_motion(ctx, state, h);
        }
        let balanced = self
            .full
            .is_balanced(&self.start.problem(ctx.tree, h, accuracy));
        if balanced {
            state.trend.fill(0.0);
            state.counters[0] += 1;
            // Who carries nothing forgets.
            let Point {
                contacts, turns, ..
            } = &self.start;
            state.touches.retain(|touch| {
                let slot = touch.slot;
                contacts.iter().any(|c| c.slot == slot && c.cap > 0.0)
                    || turns.iter().any(|t| t.slot == slot && t.holds())
                    || touch.touchdown > 0.0
            });
            add_impulses(
                &self.start.contacts,
                &self.full,
                remaining / h,
                &mut state.impulse,
            );
        } else if speed > 0.0 {
            state.v.copy_from_slice(&self.guess);
            self.start.update_motion(ctx, state, h);
        }
        balanced
    }

    /// Solves over `h`; tells whether that went well.
    fn full_solve(&mut self, ctx: &Context, state: &mut State, h: f64, accuracy: f64) -> bool {
        self.start.expect_commands(ctx, state, h);
        let problem = self.start.problem(ctx.tree, h, accuracy);
        self.full.guess_start(&problem, &state.v);
        let full = self.full.solve(&problem);
        count(state, full.iterations);
        full.converged
    }

    /// Error of the full solve by itself, relative to the tolerance: positions lag behind by half the change of
    /// velocity, velocities by half the change of acceleration since the last step (Milne's device).
    fn single_error(&self, ctx: &Context, state: &State, h: f64) -> f64 {
        let changes = self.full.v.iter().zip(&state.v).zip(&state.trend);
        let errors = changes.map(|((v, v0), trend)| {
            let change = v - v0;
            (0.5 * h * change, 0.5 * (change - h * trend))
        });
        worst_error(errors, &ctx.tree.weight) / ctx.tolerance
    }

    /// Takes the full solve into the state as it is.
    fn accept_single(&mut self, ctx: &Context, state: &mut State, h: f64) {
        begin_trend(state);
        store(ctx, &self.start, &self.full, h, state);
        self.q_full.copy_from_slice(&state.q);
        advance(ctx.tree, &self.q_full, &self.full.v, h, &mut state.q);
        add_impulses(&self.start.contacts, &self.full, 1.0, &mut state.impulse);
        end_trend(state, h);
    }

    /// Solves twice over `h/2` beside the full solve; returns the error relative to the tolerance, infinite if a solve
    /// fails.
    fn doubled_step(&mut self, ctx: &Context, state: &mut State, h: f64, accuracy: f64) -> f64 {
        let tree = ctx.tree;
        self.start.expect_commands(ctx, state, 0.5 * h);
        let problem = self.start.problem(tree, 0.5 * h, accuracy);
        self.first.guess_between(&problem, &state.v, &self.full);
        let first = self.first.solve(&problem);
        count(state, first.iterations);
        if !first.converged {
            return f64::INFINITY;
        }
        advance(tree, &state.q, &self.first.v, 0.5 * h, &mut self.half.q);
        store(ctx, &self.start, &self.first, 0.5 * h, &mut self.half);
        // As the full step saw them: `accept_doubled` asks again.
        self.start.expect_commands(ctx, state, h);
        let ctx = &ctx.after(0.5 * h);
        self.middle.update(ctx, &self.half, 0.5 * h);
        self.middle.expect_commands(ctx, &self.half, 0.5 * h);
        let problem = self.middle.problem(tree, 0.5 * h, accuracy);
        self.second.guess(&problem, &self.full.v);
        let second = self.second.solve(&problem);
        count(state, second.iterations);
        if !second.converged {
            return f64::INFINITY;
        }
        advance(tree, &state.q, &self.full.v, h, &mut self.q_full);
        advance(
            tree,
            &self.half.q,
            &self.second.v,
            0.5 * h,
            &mut self.q_halves,
        );
        difference(tree, &self.q_halves, &self.q_full, &mut self.difference);
        let velocities = self.second.v.iter().zip(&self.full.v).map(|(b, f)| b - f);
        let errors = self.difference.iter().copied().zip(velocities);
        worst_error(errors, &tree.weight) / ctx.tolerance
    }

    /// Takes the results of [`Self::doubled_step`] into the state: extrapolated, or the half steps' as they are,
    /// which damp what the step does not resolve.
    fn accept_doubled(&mut self, ctx: &Context, state: &mut State, h: f64, extrapolate: bool) {
        let tree = ctx.tree;
        store(ctx, &self.middle, &self.second, 0.5 * h, state);
        if !extrapolate {
            state.q.copy_from_slice(&self.q_halves);
            add_impulses(&self.start.contacts, &self.first, 1.0, &mut state.impulse);
            add_impulses(&self.middle.contacts, &self.second, 1.0, &mut state.impulse);
            return;
        }
        advance(tree, &self.q_halves, &self.difference, 1.0, &mut state.q);
        // Twice the displacement after the second half step minus that after the full one; both by ascending slot.
        let mut full = self
            .start
            .contacts
            .iter()
            .zip(&self.full.point_velocity)
            .peekable();
        let mut middle = self.middle.contacts.iter().peekable();
        self.extrapolate_turns(state, h);
        for touch in &mut state.touches {
            while full
                .next_if(|(contact, _)| contact.slot < touch.slot)
                .is_some()
            {}
            while middle
                .next_if(|contact| contact.slot < touch.slot)
                .is_some()
            {}
            let before = full
                .next_if(|(contact, _)| contact.slot == touch.slot)
                .map_or(Vec3::zeros(), |(contact, v)| {
                    contact.next_displacement(v, h)
                });
            let limit = middle
                .next_if(|contact| contact.slot == touch.slot && contact.cap > 0.0)
                .map_or(0.0, |contact| contact.cap / contact.tangential_stiffness);
            let extrapolated = Vec3::from(touch.displacement) * 2.0 - before;
            touch.displacement = crate::contact::clip(extrapolated, limit).into();
        }
        let terms = self
            .start
            .joints
            .terms
            .iter()
            .zip(&self.middle.joints.terms);
        for (start, middle) in terms {
            let dof = start.dof;
            if let (Some(index), Drive::Velocity { element, .. }) = (start.actuator, start.drive) {
                let full = start.next_motor(self.full.v[dof], h);
                let limit = element.cap / element.stiffness;
                state.motor[index] = (2.0 * state.motor[index] - full).clamp(-limit, limit);
            }
            if start.dry.cap > 0.0 {
                let full = start.dry.next(self.full.v[dof], h);
                let limit = middle.dry.cap / middle.dry.stiffness;
                state.dry[dof] = (2.0 * state.dry[dof] - full).clamp(-limit, limit);
            }
        }
        for ((v, second), full) in state.v.iter_mut().zip(&self.second.v).zip(&self.full.v) {
            *v = 2.0 * second - full;
        }
        add_impulses(&self.start.contacts, &self.first, 2.0, &mut state.impulse);
        add_impulses(&self.middle.contacts, &self.second, 2.0, &mut state.impulse);
        add_impulses(&self.start.contacts, &self.full, -1.0, &mut state.impulse);
    }

    /// The stored angles of friction against turning, extrapolated like the displacements.
    fn extrapolate_turns(&self, state: &mut State, h: f64) {
        let mut full = self
            .start
            .turns
            .iter()
            .zip(&self.full.turn_velocity)
            .peekable();
        let mut touches = state.touches.iter_mut().peekable();
        for turn in &self.middle.turns {
            while full.next_if(|(t, _)| t.slot < turn.slot).is_some() {}
            while touches.next_if(|t| t.slot < turn.slot).is_some() {}
            let before = full
                .next_if(|(t, _)| t.slot == turn.slot)
                .map_or(Vec3::zeros(), |(t, w)| t.next_displacement(w, h));
            if let Some(touch) = touches.next_if(|t| t.slot == turn.slot) {
                let extrapolated = Vec3::from(touch.turn) * 2.0 - before;
                touch.turn = turn.clipped(&extrapolated).into();
            }
        }
    }
}

/// Remembers the velocity before a step, see [`end_trend`].
fn begin_trend(state: &mut State) {
    state.trend.copy_from_slice(&state.v);
}

/// The mean acceleration over the step of `h` seconds that has just been taken.
fn end_trend(state: &mut State, h: f64) {
    for (trend, v) in state.trend.iter_mut().zip(&state.v) {
        *trend = (v - *trend) / h;
    }
}

/// Books an accepted step and what the controller proposes next.
fn accepted(state: &mut State, first: bool, h: f64, proposed: f64) {
    state.counters[0] += 1;
    state.step[0] = proposed;
    if first {
        state.step[1] = proposed.min(2.0 * state.step[1]).max(h.min(proposed));
    }
}

/// Shortest step that error control may ask for now; books that a step of `h` seconds was tried.
///
/// Some contacts of very light bodies on heavy robots oscillate in nanoseconds between normal force and friction
/// (Painlevé's problem), and a joint may be told to spin at any speed: resolving that buys nothing and stalls the host.
/// A run of steps near the floor therefore raises it, slowly enough that an impact passes unhindered, and longer steps
/// lower it again. Steps that are short because the communication step ends do not count.
fn patience(state: &mut State, tolerance: f64, h: f64, remaining: f64) -> f64 {
    let floor = &mut state.step[2];
    *floor = floor.max(MIN_STEP);
    if h >= 10.0 * *floor {
        *floor *= 0.5;
    } else if h < remaining {
        *floor = (*floor * (1.0 + 0.02 * (tolerance / 1e-3).sqrt().min(1.0))).min(MAX_FLOOR);
    }
    floor.max(MIN_STEP)
}

/// Goes along the smooth step under way, at most to `end`; returns how far.
fn follow(tree: &Tree, state: &mut State, end: f64) -> f64 {
    if state.ahead.is_empty() {
        return 0.0;
    }
    let State { ahead, q, v, .. } = state;
    let last = ahead.end();
    if end < last {
        ahead.evaluate(tree, end, q, v);
        return end - state.time;
    }
    ahead.evaluate(tree, last, q, v);
    ahead.clear();
    (last - state.time).min(end - state.time)
}

/// Length of the next step on the way to a communication point: no crumb is left over.
fn landing(h: f64, remaining: f64) -> f64 {
    if h >= remaining {
        remaining
    } else if 1.5 * h > remaining {
        0.5 * remaining
    } else {
        h
    }
}

/// The next proposal after an explicit step, in steps of the longer pair.
fn next_proposal(proposed: f64, h: f64, pair: &Pair, factor: f64, tolerance: f64) -> f64 {
    if pair.order == DORMAND_PRINCE.order {
        grown(proposed, h, factor)
    } else if factor >= GROWTH.1 {
        proposed
    } else {
        proposed.min(h * factor / (SHORT * libm::pow(tolerance, PAIR_EXPONENT)))
    }
}

/// The next proposal: a step that was cut short and went well does not shrink it.
fn grown(proposed: f64, h: f64, factor: f64) -> f64 {
    let next = h * factor;
    if h < proposed && factor >= GROWTH.1 {
        proposed.max(next)
    } else {
        next
    }
}

/// The largest of the weighted errors of positions and velocities; infinite if one is not a number.
fn worst_error(errors: impl Iterator<Item = (f64, f64)>, weights: &[f64]) -> f64 {
    errors
        .zip(weights)
        .fold(0.0, |worst: f64, ((position, velocity), weight)| {
            let error = weight * position.abs().max(VELOCITY_WEIGHT * velocity.abs());
            // `f64::max` would drop a NaN.
            if error.is_nan() || position.is_nan() || velocity.is_nan() {
                f64::INFINITY
            } else {
                worst.max(error)
            }
        })
}

/// Counts the iterations of a solve.
fn count(state: &mut State, iterations: usize) {
    state.counters[2] = state.counters[2].max(iterations as u64);
}

/// Velocity, displacements and touch-down speeds after a solve; positions are the caller's.
fn store(ctx: &Context, point: &Point, newton: &Newton, h: f64, state: &mut State) {
    state.v.copy_from_slice(&newton.v);
    state.touches.clear();
    let mut turns = point.turns.iter().zip(&newton.turn_velocity).peekable();
    for (contact, v) in point.contacts.iter().zip(&newton.point_velocity) {
        let inside = contact.gap + h * contact.normal.dot(v) < 0.0;
        let touchdown = if inside { contact.touchdown } else { 0.0 };
        let turn = turns.next_if(|(turn, _)| turn.slot == contact.slot);
        let turns = turn.is_some_and(|(turn, _)| turn.holds());
        if contact.cap > 0.0 || turns || touchdown > 0.0 {
            let angle = turn.map(|(turn, w)| turn.next_displacement(w, h));
            state.touches.push(Touch {
                slot: contact.slot,
                displacement: contact.next_displacement(v, h).into(),
                turn: angle.unwrap_or_default().into(),
                touchdown,
            });
        }
    }
    debug_assert_eq!(state.motor.len(), ctx.model.actuators.len());
    for term in &point.joints.terms {
        if let Some(index) = term.actuator {
            state.motor[index] = term.next_motor(newton.v[term.dof], h);
        }
        state.dry[term.dof] = term.dry.next(newton.v[term.dof], h);
    }
}

/// Adds `share` times the contact impulses to their links.
fn add_impulses(contacts: &[Contact], newton: &Newton, share: f64, impulse: &mut [[f64; 3]]) {
    for (contact, response) in contacts.iter().zip(&newton.responses) {
        let sum = &mut impulse[contact.link];
        for (sum, x) in sum.iter_mut().zip(response.impulse.iter()) {
            *sum += share * x;
        }
    }
}

/// Takes over an explicit step: nothing touches, so nothing is displaced.
fn accept_explicit(explicit: &mut Explicit, pair: &Pair, state: &mut State) {
    state.q.copy_from_slice(&explicit.q);
    state.v.copy_from_slice(&explicit.v);
    state.touches.clear();
    state.motor.fill(0.0);
    state.dry.fill(0.0);
    state.trend.fill(0.0);
    explicit.accept(pair);
}
