//! The implicit method: convex solves, their error, and what is made of them.
//!
//! A step is solved once over `h` and twice over `h/2`. The difference of the two results is the
//! error estimate, positions and velocities together, and twice the second minus the first is the
//! solution that goes on: second order in smooth motion at the price of the estimate.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod cones;
mod single;

use self::cones::Cones;
use crate::force::Memory;
use crate::kinematics::{advance, difference, position_rates};
use crate::model::Model;
use crate::spatial::Vec6;
use crate::state::Physical;
use crate::state::ahead::Ahead;
use crate::state::lag::Lag;
use crate::step::attempt::{Attempt, add_impulses, take_solved};
use crate::step::convex::Newton;
use crate::step::guards;
use crate::step::point::{Context, Point};
use crate::step::size::worst_error;
use crate::tree::Tree;
use crate::tuning::{EXTRAPOLATION_GAIN, LAG_SHARE, MAX_ATTEMPTS, VELOCITY_WEIGHT};

/// The implicit method and its scratch.
#[derive(Clone, Debug)]
pub(super) struct Implicit {
    /// Solution over the whole step.
    pub full: Newton,
    /// Solution over its first half.
    first: Newton,
    /// Solution over its second half.
    second: Newton,
    cones: Cones,
    /// The robot in the middle of the step.
    half: Physical,
    /// What acts there.
    middle: Point,
    /// Positions at the end, by the full step and by the half steps.
    q_full: Vec<f64>,
    q_halves: Vec<f64>,
    /// What the force terms remember after the full step.
    memory: Memory,
    /// By how much the result's positions differ from those of the last solve, `nv`: after the half
    /// steps their positions less those of the full step; in a step of one solve what its known
    /// error moves.
    more: Vec<f64>,
    /// The same as spatial displacements of the bodies.
    way: Vec<Vec6>,
    /// Momentum of a change of velocity, `nv`.
    momentum: Vec<f64>,
    /// Rates of the positions at the start and at the end of a step.
    rates: [Vec<f64>; 2],
    /// Most Newton iterations in a solve since the communication step has begun.
    pub iterations: usize,
}

#[cfg(test)]
crate::spoil::spoil!(
    Implicit: full first second cones half middle q_full q_halves memory more way momentum rates
    iterations;
);

/// What one solve does for a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Single {
    /// It is not enough.
    No,
    /// It does as it is.
    Plain,
    /// It does less its known error.
    Corrected,
}

/// How a step that was solved in full and in halves ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finish {
    /// Whether its results are extrapolated.
    pub extrapolated: bool,
    /// Whether poses and velocities of the point given stand at its end.
    pub posed: bool,
}

impl Implicit {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let (slots, nv) = (model.contact_slots(), model.nv());
        // Not clones of one: a clone has no room beyond its length.
        let newton = || Newton::new(tree, slots);
        Self {
            full: newton(),
            first: newton(),
            second: newton(),
            cones: Cones::new(slots),
            half: Physical::new(model),
            middle: Point::new(model, tree),
            q_full: vec![0.0; model.nq],
            q_halves: vec![0.0; model.nq],
            memory: Memory::new(model),
            more: vec![0.0; nv],
            way: vec![[0.0; 6]; tree.bodies.len()],
            momentum: vec![0.0; nv],
            rates: [vec![0.0; model.nq], vec![0.0; model.nq]],
            iterations: 0,
        }
    }

    /// Begins with a step from another place: the friction cones are those of its start.
    pub fn restart(&mut self) {
        self.cones.moved = false;
    }

    /// Solves over `h` from where `here` stands; tells whether that went well.
    pub fn solve(
        &mut self,
        ctx: &Context,
        here: &mut Point,
        from: &Physical,
        [h, accuracy]: [f64; 2],
    ) -> bool {
        if self.cones.moved {
            self.cones.set(here, 0.0);
        }
        here.expect_commands(ctx, from, h);
        let problem = here.problem(ctx.tree, h, accuracy);
        self.full.guess_start(&problem, &from.v);
        let full = self.full.solve(&problem);
        self.iterations = self.iterations.max(full.iterations);
        full.converged
    }

    /// Whether the friction cones of the full solve over `h` seconds are too far off those that it
    /// has found.
    fn cones_lag(&self, ctx: &Context, here: &Point, h: f64) -> bool {
        let mass = ctx.tree.moving_mass();
        let allowed = LAG_SHARE * ctx.tolerance * mass / VELOCITY_WEIGHT;
        ctx.rules.cones && h * Cones::lag(here, &self.full, (mass, ctx.tolerance), h) > allowed
    }

    /// Repeats the full solve with the friction cones that it has found, and sets those of the
    /// first half, where the cones of the start are too far off; tells whether that went well.
    fn settle_cones(&mut self, ctx: &Context, here: &mut Point, [h, accuracy]: [f64; 2]) -> bool {
        for attempt in 0..MAX_ATTEMPTS {
            if !self.cones_lag(ctx, here, h) {
                break;
            }
            if attempt == 0 {
                self.cones.begin(here, &self.full, h);
            } else {
                self.cones.improve(here, &self.full, h);
            }
            self.cones.set(here, 1.0);
            let full = self.full.solve(&here.problem(ctx.tree, h, accuracy));
            self.iterations = self.iterations.max(full.iterations);
            if !full.converged {
                return false;
            }
        }
        if self.cones.moved {
            self.cones.set(here, 0.5);
        }
        true
    }

    /// Solves twice over `h/2` beside the full solve; returns the error relative to the tolerance,
    /// infinite if a solve fails.
    pub fn halves(
        &mut self,
        ctx: &Context,
        here: &mut Point,
        from: &Physical,
        [h, accuracy]: [f64; 2],
    ) -> f64 {
        let (tree, part) = (ctx.tree, 0.5 * h);
        if !self.settle_cones(ctx, here, [h, accuracy]) {
            return f64::INFINITY;
        }
        here.expect_commands(ctx, from, part);
        let problem = here.problem(tree, part, accuracy);
        self.first.guess_between(&problem, &from.v, &self.full);
        let first = self.first.solve(&problem);
        self.iterations = self.iterations.max(first.iterations);
        if !first.converged {
            return f64::INFINITY;
        }
        advance(tree, &from.q, &self.first.v, part, &mut self.half.q);
        take_solved(&mut self.half, here, &self.first, part);
        // As the full step saw them: `finish` asks again.
        here.expect_commands(ctx, from, h);
        let ctx = &ctx.after(part);
        self.middle.update(ctx, &self.half, part);
        if self.cones.moved {
            self.cones.set(here, 1.0);
            self.cones.carry(here, &mut self.middle);
        }
        self.middle.expect_commands(ctx, &self.half, part);
        let problem = self.middle.problem(tree, part, accuracy);
        self.second.guess(&problem, &self.half.v, &self.full.v);
        let before = (&self.first, here.terms.contacts.as_slice());
        let second = self.second.solve_after(&problem, before);
        self.iterations = self.iterations.max(second.iterations);
        if !second.converged {
            return f64::INFINITY;
        }
        advance(tree, &from.q, &self.full.v, h, &mut self.q_full);
        advance(tree, &self.half.q, &self.second.v, part, &mut self.q_halves);
        difference(tree, &self.q_halves, &self.q_full, &mut self.more);
        let velocities = self.second.v.iter().zip(&self.full.v).map(|(b, f)| b - f);
        let errors = self.more.iter().copied().zip(velocities);
        worst_error(errors, &tree.dofs.weight) / ctx.tolerance
    }

    /// Positions and velocities after the half steps.
    pub fn after_halves(&self) -> (&[f64], &[f64]) {
        (&self.q_halves, &self.second.v)
    }

    /// Puts the results of [`Self::halves`] from where `here` stands into `attempt`: extrapolated,
    /// or the half steps' as they are, which damp what the step does not resolve. Extrapolation
    /// goes where the laws would lead if the step resolved them; an impact that it does not, or the
    /// spring of a limit that is stiffer than the tolerance, may throw the robot back with more
    /// than it came with, and then the half steps' results are taken, too.
    ///
    /// - `there`: scratch, for the place where it ends
    pub fn finish(
        &mut self,
        ctx: &Context,
        (here, there): (&Point, &mut Point),
        from: &Physical,
        (h, extrapolate): (f64, bool),
        attempt: &mut Attempt,
    ) -> Finish {
        let part = 0.5 * h;
        let mut finish = Finish {
            extrapolated: extrapolate,
            posed: false,
        };
        if extrapolate {
            let allowed = EXTRAPOLATION_GAIN * ctx.tolerance;
            let doubtful = self.may_gain(ctx, here, from, [h, allowed]);
            self.extrapolate(ctx, here, h, attempt);
            if doubtful {
                let books = guards::open_books(ctx, here, from, allowed);
                let halves = guards::work(ctx, here, &self.first, part)
                    + guards::work(ctx, &self.middle, &self.second, part);
                let work = 2.0 * halves - guards::work(ctx, here, &self.full, h);
                finish.extrapolated =
                    !guards::gains(ctx, &books, (here, there), &attempt.end, [h, work]);
                finish.posed = finish.extrapolated;
            }
        }
        if finish.extrapolated {
            attempt.add_impulses(here, &self.first, 2.0);
            attempt.add_impulses(&self.middle, &self.second, 2.0);
            attempt.add_impulses(here, &self.full, -1.0);
        } else {
            attempt.take_solved(&self.middle, &self.second, part);
            attempt.end.q.copy_from_slice(&self.q_halves);
            attempt.add_impulses(here, &self.first, 1.0);
            attempt.add_impulses(&self.middle, &self.second, 1.0);
        }
        attempt.end_trend(&from.v, h);
        finish
    }

    /// Whether extrapolating the step may add more than allowed to the energy that the half steps
    /// have left.
    fn may_gain(
        &mut self,
        ctx: &Context,
        here: &Point,
        from: &Physical,
        [h, share]: [f64; 2],
    ) -> bool {
        // Kinetic energy at twice the half steps' velocity less the full one's, less that at the
        // former, where `M (v − full)` is what the second half step's solve has changed of its
        // guess.
        let mut rise = 0.0;
        let velocities = self.second.v.iter().zip(&self.full.v);
        let changes = self.second.change.iter().zip(&self.second.guessed_change);
        for ((v, full), (change, guessed)) in velocities.zip(changes) {
            rise += (change - guessed) * (1.5 * v - 0.5 * full);
        }
        let (point, solved) = (&self.middle, &self.second);
        rise += guards::lifted(ctx.tree, point, solved, 0.5 * h, &self.more, &mut self.way);
        guards::exceeds(ctx, here, from, [rise, share])
    }

    /// Twice the half steps' results less the full step's.
    fn extrapolate(&mut self, ctx: &Context, here: &Point, h: f64, attempt: &mut Attempt) {
        let end = &mut attempt.end;
        take_solved(end, &self.middle, &self.second, 0.5 * h);
        advance(ctx.tree, &self.q_halves, &self.more, 1.0, &mut end.q);
        let (start, middle, full) = (&here.terms, &self.middle.terms, &mut self.memory);
        start.remember(&self.full.solved(), h, full);
        start.extrapolate(middle, full, &mut end.memory);
        for ((v, second), full) in end.v.iter_mut().zip(&self.second.v).zip(&self.full.v) {
            *v = 2.0 * second - full;
        }
    }

    /// Measures the error of a solve by itself on the step of `h` seconds from where `here` stands
    /// that has been solved in full and in halves.
    pub fn measure(&self, here: &Point, h: f64, lag: &mut Lag) {
        if self.cones.moved {
            // The next solve begins with other cones.
            lag.clear();
            return;
        }
        lag.measure(h, &self.more, &self.full.v, &self.second.v);
        lag.pressing = self.full.pressing();
        let (share, impulses) = (2.0 / (h * h), &mut lag.impulses);
        impulses.fill([0.0; 3]);
        add_impulses(impulses, here, &self.full, share);
        add_impulses(impulses, here, &self.first, -share);
        add_impulses(impulses, &self.middle, &self.second, -share);
    }

    /// Puts the step of `h` seconds that began at time `start` and reaches beyond the communication
    /// point at `end` into `ahead`: cubic polynomials for positions, their derivatives' kind for
    /// velocities. `attempt` is then where they stand at that point.
    pub fn look_ahead(
        &mut self,
        tree: &Tree,
        from: &Physical,
        [start, h, end]: [f64; 3],
        ahead: &mut Ahead,
        attempt: &mut Physical,
    ) {
        let (q0, v0) = (&from.q, &from.v);
        let Physical { q, v, .. } = attempt;
        let [rate0, rate1] = &mut self.rates;
        position_rates(tree, q0, v0, rate0);
        position_rates(tree, q, v, rate1);
        difference(tree, q, q0, &mut self.more);
        ahead.start = start;
        ahead.length = h;
        ahead.coefficients.clear();
        for (i, (a, b)) in q0.iter().zip(q.iter()).enumerate() {
            let change = b - a;
            let bend = h * rate0[i] - change;
            let row = [*a, change, bend, change - h * rate1[i] - bend, 0.0];
            ahead.coefficients.extend(row);
        }
        for ((a, b), moved) in v0.iter().zip(v.iter()).zip(&self.more) {
            let bend = 6.0 * moved / h - 3.0 * (a + b);
            ahead.coefficients.extend([*a, b - a, bend, 0.0, 0.0]);
        }
        ahead.evaluate(tree, end, q, v);
    }
}
