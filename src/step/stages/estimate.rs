//! What a step in two stages errs by.
//!
//! With `R = F − k` at the start and at both stages, `(1 − γ) R₀ − R₁ + γ R₂` is of second order,
//! and so is the same of the velocities. [`ESTIMATE`] times `h` of it is of the size of what the
//! step errs by in its third order. What stiff springs and dampers make of it dies within the step:
//! it is filtered by the step's own matrix `H = M + η D + η² K`, twice.
//!
//! Source: Hairer & Wanner 1996, section IV.8 (filtered estimates).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{DRIFT, GAMMA, Stages, early};
use crate::force::{JointTerm, Terms};
use crate::joint::Sweep;
use crate::kinematics::forward;
use crate::state::Physical;
use crate::step::convex::Problem;
use crate::step::point::Context;
use crate::step::size::{fastest_within, worst_error};
use crate::tree::Tree;
use crate::tuning::{ESTIMATE, START, VELOCITY_WEIGHT};

/// What two stages leave of a transient with the rate `λ`, `(1 − 2γ)/(γ² h λ)` of it, as a share of
/// what the velocities' estimate, filtered twice, is of it.
const LEFT: f64 = (1.0 - 2.0 * GAMMA) / (ESTIMATE * (1.0 - GAMMA));

/// The same of the first stage alone: it leaves `1/(γ h λ)` of a transient, and its estimate,
/// filtered twice, is half of that.
const LEFT_BY_FIRST: f64 = 2.0;

/// What is of second order in three values, at the start and in both stages.
fn difference([start, first, second]: [f64; 3]) -> f64 {
    (1.0 - GAMMA) * start - first + GAMMA * second
}

impl Stages {
    /// Makes `self.aside` what acts at the start of the step of `h` seconds that has just been
    /// solved, with the commands and wrenches there: the first stage has those of its end.
    fn stand_at_start(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.way.fill([0.0; 6]);
        self.guess.fill(0.0);
        let nowhere = (&*self.way, &*self.guess, 0.0);
        self.aside.begin(&self.terms[0], nowhere, None);
        self.follow_wrenches(ctx, 0.0);
        self.middle.set_joints(ctx, from, (&self.q, [0.0; 2]));
        let back = |dof: usize| -0.5 * h * early(from.v[dof], self.trend.whole[dof], h);
        self.aside.begin_joints(&self.middle.terms, back);
    }

    /// Error of the step of `h` seconds that has just been solved, relative to the tolerance.
    pub fn error(&mut self, ctx: &Context, from: &Physical, h: f64) -> f64 {
        self.terms[0].scale_drift(-1.0 / DRIFT[0]);
        self.find_start(ctx, from, h, false);
        // That of the second stage again.
        self.follow_wrenches(ctx, h);
        let [first, second] = &self.solved;
        let [velocity, position] = &mut self.error;
        for i in 0..velocity.len() {
            velocity[i] = ESTIMATE
                * difference([
                    h * self.start[i],
                    first.change[i] / GAMMA,
                    second.change[i] / GAMMA,
                ]);
            position[i] = ESTIMATE * h * difference([from.v[i], first.v[i], second.v[i]]);
        }
        self.filter(ctx, (1, GAMMA * h), h);
        let turned = [self.turned(ctx.tree, from, (1, h)), self.lines_turned(1, h)];
        let [first, second] = &self.solved;
        let all = |dof: usize| [from.v[dof], first.v[dof], second.v[dof]];
        let unfiltered = |dof| ESTIMATE * h * difference(all(dof));
        let error = &mut self.error;
        add_yielding(&self.terms[0], from, LEFT, unfiltered, error);
        add_turning(ctx.tree, [&from.v, &second.v], (turned, [h, 0.0]), error);
        self.worst(ctx, h).max(self.lag()).max(self.off)
    }

    /// Error of the first stage of the step of `h` seconds of which [`Self::error`] has just been
    /// found, if the step ends there: implicit Euler, off by half of the change of force and of
    /// velocity, where what dies within the stage is no error. Where something meets, all of its
    /// velocity dies; what the law gives back of it is an error.
    pub fn first_error(&mut self, ctx: &Context, from: &Physical, h: f64) -> f64 {
        let eta = GAMMA * h;
        self.find_start(ctx, from, h, true);
        // That of the stage again.
        self.terms[0].scale_drift(-DRIFT[0]);
        self.follow_wrenches(ctx, eta);
        let first = &self.solved[0];
        let [velocity, position] = &mut self.error;
        for i in 0..velocity.len() {
            velocity[i] = 0.5 * (eta * self.start[i] - first.change[i]);
            position[i] = 0.5 * eta * (from.v[i] - first.v[i]);
        }
        self.filter(ctx, (0, eta), eta);
        let turned = [
            self.turned(ctx.tree, from, (0, eta)),
            self.lines_turned(0, eta),
        ];
        let first = &self.solved[0];
        let unfiltered = |dof: usize| 0.5 * eta * (from.v[dof] - first.v[dof]);
        let error = &mut self.error;
        add_yielding(&self.terms[0], from, LEFT_BY_FIRST, unfiltered, error);
        // Its place is the middle of the whole step.
        let ahead = 0.5 / GAMMA - 0.5;
        add_turning(ctx.tree, [&from.v, &first.v], (turned, [eta, ahead]), error);
        let bounced = VELOCITY_WEIGHT * self.bounced(ctx.tree, from, eta) / ctx.tolerance;
        let placed = self.first_misplaced(ctx, from, eta);
        self.worst(ctx, eta)
            .max(self.lag[0])
            .max(bounced)
            .max(placed)
    }

    /// Whether a step that has been solved errs by more than the tolerance because its middle has
    /// not been found: each solve leads to another one. So it is where something swings across its
    /// load faster than the step resolves, as the light links of a rope with a heavy load do.
    pub fn has_no_middle(&self) -> bool {
        self.off > 1.0
    }

    /// Error relative to the tolerance that a step of `h` seconds, which has been solved, makes
    /// because its middle is not where it was expected. The velocity there is off by half of what
    /// the change of velocity is off. Where something turns by `θ` in the step, bias and lever arms
    /// are off by `θ/h` times this, and velocities after the step by `θ` times this.
    pub(super) fn misplaced(&self, ctx: &Context, from: &Physical, h: f64) -> f64 {
        let (tree, end) = (ctx.tree, &self.solved[1].v);
        let turned = self.turned(tree, from, (1, h));
        let unexpected = |k: usize| {
            let change = end[k] - from.v[k] - h * self.trend.whole[k];
            (0.0, 0.5 * turned * change)
        };
        worst_error(tree, h, unexpected) / ctx.tolerance
    }

    /// Error of the first stage, relative to the tolerance, because bias and lever arms are those
    /// of the velocities in the middle of the whole step: what happens behind it is in these.
    /// See [`Self::misplaced`].
    fn first_misplaced(&self, ctx: &Context, from: &Physical, eta: f64) -> f64 {
        let (tree, end) = (ctx.tree, &self.solved[0].v);
        let turned = self.turned(tree, from, (0, eta));
        let off = |k: usize| (0.0, turned * (self.v[k] - 0.5 * (from.v[k] + end[k])));
        worst_error(tree, eta, off) / ctx.tolerance
    }

    /// The largest velocity, weighted, that the law may give back of an impact in the first stage,
    /// m/s: what meets with `u` leaves with less than `u` and than `1/d` of the dissipation `d`.
    fn bounced(&mut self, tree: &Tree, from: &Physical, eta: f64) -> f64 {
        let (kin, terms, first) = (&self.middle.kin, &self.terms[0], &self.solved[0]);
        forward(tree, &kin.S, &from.v, &mut self.way);
        let mut most: f64 = 0.0;
        for (contact, response) in terms.contacts.iter().zip(&first.responses.contacts) {
            if response.presses() {
                let speed = -contact.normal_velocity(&terms.contacts.points, &self.way);
                most = most.max(speed.min(contact.damping.fastest));
            }
        }
        for term in &terms.joints {
            let (dof, acts) = (term.dof, term.at_limits(first.v[term.dof], eta));
            for (acts, sign) in acts.into_iter().zip([-1.0, 1.0]) {
                if acts {
                    let speed = (sign * from.v[dof]).min(term.limit.damping.fastest);
                    most = most.max(tree.dofs.weight[dof] * speed);
                }
            }
        }
        most
    }

    /// Angle, rad, by which something turns in a step of `h` seconds that has been solved up to the
    /// stage `last`: a limb, or the line of a spring.
    pub fn turned(&self, tree: &Tree, from: &Physical, (last, h): (usize, f64)) -> f64 {
        let limbs = h * fastest_within(tree, [&from.v, &self.solved[last].v]);
        limbs.max(self.lines_turned(last, h))
    }

    /// The same of lines of springs alone.
    fn lines_turned(&self, last: usize, h: f64) -> f64 {
        let eta = if last == 0 { h } else { GAMMA * h };
        let begins = self.terms.each_ref().map(|terms| &terms.springs);
        let velocities = &self.solved[last].at.springs;
        let lines = begins[0].iter().zip(begins[last]).zip(velocities);
        let turned = lines.map(|((one, two), u)| one.turned([one.aside(), two.aside() + *u * eta]));
        turned.fold(0.0, f64::max)
    }

    /// Finds the forces at the start of the step of `h` seconds, as the limit of a short step. The
    /// drift is that of the start.
    ///
    /// - `pressed`: whether what presses at the end of the first stage does so here, too
    fn find_start(&mut self, ctx: &Context, from: &Physical, h: f64, pressed: bool) {
        let varies = ctx.inputs.varies();
        if varies {
            self.stand_at_start(ctx, from, h);
        } else if pressed {
            self.way.fill([0.0; 6]);
            self.guess.fill(0.0);
            let nowhere = (&*self.way, &*self.guess, 0.0);
            self.aside.begin(&self.terms[0], nowhere, None);
        }
        if pressed {
            self.aside.press(&self.solved[0].solved(), GAMMA * h);
        }
        let start = START * h;
        let terms = if varies || pressed {
            &self.aside
        } else {
            &self.terms[0]
        };
        let problem = Problem::new((ctx.tree, &self.middle.kin), terms, start, 0.0);
        self.probe.forces_at(&problem, &from.v, &mut self.start);
        for force in &mut self.start {
            *force /= start;
        }
    }

    /// Filters errors of momentum and of positions, `self.error`, by the matrix of a stage of `eta`
    /// seconds.
    ///
    /// - `h`: length of the step, s
    fn filter(&mut self, ctx: &Context, (stage, eta): (usize, f64), h: f64) {
        let tree = ctx.tree;
        let (kin, terms, solved) = (
            &self.middle.kin,
            &self.terms[stage],
            &mut self.solved[stage],
        );
        let problem = |terms| Problem::new((tree, kin), terms, eta, 0.0);
        let [velocity, position] = &mut self.error;
        // What the positions' error does to the forces of the stage, times η.
        forward(tree, &kin.S, position, &mut self.way);
        self.aside.begin(terms, (&self.way, position, 0.0), None);
        self.aside.strain(&self.way, position);
        self.probe
            .forces_at(&problem(&self.aside), &solved.v, &mut self.forces);
        solved.forces_found(&mut self.guess);
        for (velocity, (moved, here)) in
            velocity.iter_mut().zip(self.forces.iter().zip(&self.guess))
        {
            *velocity += moved - here;
        }
        // Friction that falls with the speed is, in the mean of the step, late by half of what it
        // changes by.
        let late = |term: &JointTerm| 0.5 * h * term.late_friction(tree, solved.v[term.dof], eta);
        self.forces.fill(0.0);
        for term in &terms.joints {
            self.forces[term.dof] = late(term);
        }
        let is_late = self.forces.iter().any(|late| *late != 0.0);
        let factor = solved.factor(&problem(terms));
        let rows = (tree, &kin.loops);
        factor.solve(rows, velocity, &mut self.loops);
        for (position, velocity) in position.iter_mut().zip(&*velocity) {
            *position += eta * velocity;
        }
        // Velocities once more: what dies within the step is no error of it.
        tree.sparsity.multiply(&kin.M, velocity, &mut self.guess);
        velocity.copy_from_slice(&self.guess);
        factor.solve(rows, velocity, &mut self.loops);
        if is_late {
            factor.solve(rows, &mut self.forces, &mut self.loops);
            // With the sign for which both do not cancel.
            for vector in tree.worked_vectors() {
                let along = vector
                    .clone()
                    .map(|k| velocity[k] * self.forces[k])
                    .sum::<f64>();
                let sign = 1.0_f64.copysign(along);
                for k in vector {
                    velocity[k] += sign * self.forces[k];
                }
            }
        }
    }

    /// The largest of `self.error` of a step of `h` seconds, relative to the tolerance.
    fn worst(&self, ctx: &Context, h: f64) -> f64 {
        let [velocity, position] = &self.error;
        worst_error(ctx.tree, h, |k| (position[k], velocity[k])) / ctx.tolerance
    }
}

/// Adds to the errors of positions what motors that yield where a step begins make of errors of
/// velocities: their displacement follows at once what is left of a transient. Positions are off by
/// no more than they would be if nothing were filtered.
///
/// - `left`: what is left, as a share of the velocity's error
/// - `unfiltered`: error of the position of a degree of freedom, rad or m
fn add_yielding(
    terms: &Terms,
    from: &Physical,
    left: f64,
    unfiltered: impl Fn(usize) -> f64,
    [velocity, position]: &mut [Vec<f64>; 2],
) {
    for term in &terms.joints {
        let (dof, time) = (term.dof, term.settling_time(from.v[term.dof]));
        if time > 0.0 {
            let stored = left * time * velocity[dof].abs();
            position[dof] = position[dof].abs() + stored.min(unfiltered(dof).abs());
        }
    }
}

/// Adds to the errors what one place for a whole step of `h` seconds leaves where something turns,
/// which the stages do not see. What changes by `dv` in a step that turns by `θ` turns with it: by
/// quadrature over the step, the midpoint rule errs by `θ² dv/24`, and positions by `θ h dv/12`
/// along what turns. A place that is `a` steps ahead of the middle errs by `a θ dv` besides, and by
/// `a θ² v` of what turns with `v`: its centrifugal force pulls along another way.
///
/// - `from`, `end`: velocities at its ends
/// - `turned`: `θ` of all, and of what lines of springs turn, which is everything
/// - `ahead`: `a`
fn add_turning(
    tree: &Tree,
    [from, end]: [&[f64]; 2],
    ([theta, of_lines], [h, ahead]): ([f64; 2], [f64; 2]),
    [velocity, position]: &mut [Vec<f64>; 2],
) {
    for (_, body) in tree.worked_bodies() {
        for column in 0..body.columns {
            let first = tree.dof[body.column + column];
            let vector = first..first + tree.dofs.components[first];
            if vector.is_empty() {
                continue;
            }
            let change = length(vector.clone().map(|k| end[k] - from[k]));
            let along = matches!(body.kind.sweep(column), Sweep::Along);
            let turns = if along { of_lines } else { theta };
            let fast = length(vector.clone().map(|k| end[k]));
            let off = ahead * theta * (change + turns * fast);
            lengthen(
                &mut velocity[vector.clone()],
                theta * theta * change / 24.0 + off,
            );
            if turns > 0.0 {
                let off = turns * h * change / 12.0 + 0.5 * h * off;
                lengthen(&mut position[vector], off);
            }
        }
    }
}

fn length(components: impl Iterator<Item = f64>) -> f64 {
    components.map(|x| x * x).sum::<f64>().sqrt()
}

/// Makes a vector at least as long as `least`; its direction does not matter.
fn lengthen(vector: &mut [f64], least: f64) {
    if length(vector.iter().copied()) < least {
        vector.fill(0.0);
        vector[0] = least;
    }
}
