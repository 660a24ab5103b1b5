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
use crate::force::JointTerm;
use crate::joint::Sweep;
use crate::kinematics::forward;
use crate::state::Physical;
use crate::step::convex::Problem;
use crate::step::point::Context;
use crate::step::size::{fastest_within, worst_error};
use crate::tuning::{ESTIMATE, START};

/// What two stages leave of a transient with the rate `λ`, `(1 − 2γ)/(γ² h λ)` of it, as a share of
/// what the velocities' estimate, filtered twice, is of it.
const LEFT: f64 = (1.0 - 2.0 * GAMMA) / (ESTIMATE * (1.0 - GAMMA));

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
        let (tree, eta) = (ctx.tree, GAMMA * h);
        self.terms[0].scale_drift(-1.0 / DRIFT[0]);
        let varies = ctx.inputs.varies();
        if varies {
            self.stand_at_start(ctx, from, h);
        }
        // Forces at the start, as the limit of a short step.
        let start = START * h;
        let terms = if varies { &self.aside } else { &self.terms[0] };
        self.probe.forces_at(
            &Problem::new((tree, &self.middle.kin), terms, start, 0.0),
            &from.v,
            &mut self.forces,
        );
        // That of the second stage again.
        self.follow_wrenches(ctx, h);
        let pattern = &tree.sparsity;
        let kin = &self.middle.kin;
        let problem = |terms, h| Problem::new((tree, kin), terms, h, 0.0);
        let [first, second] = &self.solved;
        let [velocity, position] = &mut self.error;
        for i in 0..velocity.len() {
            velocity[i] = ESTIMATE
                * difference([
                    h * self.forces[i] / start,
                    first.change[i] / GAMMA,
                    second.change[i] / GAMMA,
                ]);
            position[i] = ESTIMATE * h * difference([from.v[i], first.v[i], second.v[i]]);
        }
        // What the positions' error does to the forces of the second stage, times η.
        forward(tree, &kin.S, position, &mut self.way);
        self.aside
            .begin(&self.terms[1], (&self.way, position, 0.0), None);
        self.probe
            .forces_at(&problem(&self.aside, eta), &second.v, &mut self.forces);
        second.forces_found(&mut self.guess);
        for (velocity, (moved, here)) in
            velocity.iter_mut().zip(self.forces.iter().zip(&self.guess))
        {
            *velocity += moved - here;
        }
        // Friction that falls with the speed is, in the mean of the step, late by half of what it
        // changes by.
        let late = |term: &JointTerm| 0.5 * h * term.late_friction(tree, second.v[term.dof], eta);
        self.forces.fill(0.0);
        for term in &self.terms[1].joints {
            self.forces[term.dof] = late(term);
        }
        let is_late = self.forces.iter().any(|late| *late != 0.0);
        let factor = self.solved[1].factor(&problem(&self.terms[1], eta));
        let rows = (tree, &kin.loops);
        factor.solve(rows, velocity, &mut self.loops);
        for (position, velocity) in position.iter_mut().zip(&*velocity) {
            *position += eta * velocity;
        }
        // Velocities once more: what dies within the step is no error of it.
        pattern.multiply(&kin.M, velocity, &mut self.guess);
        velocity.copy_from_slice(&self.guess);
        factor.solve(rows, velocity, &mut self.loops);
        if is_late {
            factor.solve(rows, &mut self.forces, &mut self.loops);
            for (velocity, late) in velocity.iter_mut().zip(&self.forces) {
                *velocity = velocity.abs() + late.abs();
            }
        }
        self.add_yielding(from, h);
        self.add_turning(ctx, from, h);
        let [velocity, position] = &self.error;
        let worst = worst_error(tree, h, |k| (position[k], velocity[k])) / ctx.tolerance;
        worst.max(self.lag())
    }

    /// Adds to the errors of positions what motors that yield where the step of `h` seconds begins
    /// make of errors of velocities: their displacement follows at once what is left of a
    /// transient. Positions are off by no more than they would be if nothing were filtered.
    fn add_yielding(&mut self, from: &Physical, h: f64) {
        let [first, second] = &self.solved;
        let [velocity, position] = &mut self.error;
        for term in &self.terms[0].joints {
            let (dof, time) = (term.dof, term.settling_time(from.v[term.dof]));
            if time > 0.0 {
                let all = [from.v[dof], first.v[dof], second.v[dof]];
                let unfiltered = ESTIMATE * h * difference(all);
                let stored = LEFT * time * velocity[dof].abs();
                position[dof] = position[dof].abs() + stored.min(unfiltered.abs());
            }
        }
    }

    /// Adds to the errors what one place for the whole step leaves where something turns, which the
    /// stages do not see. What changes by `dv` in a step that turns by `θ` turns with it: by
    /// quadrature over the step, the midpoint rule errs by `θ² dv/24`, and positions by `θ h dv/12`
    /// along what turns.
    fn add_turning(&mut self, ctx: &Context, from: &Physical, h: f64) {
        let tree = ctx.tree;
        let end = &self.solved[1].v;
        let theta = h * fastest_within(tree, [&from.v, end]);
        let [velocity, position] = &mut self.error;
        for (_, body) in tree.worked_bodies() {
            for column in 0..body.columns {
                let i = tree.dof[body.column + column];
                let change = (end[i] - from.v[i]).abs();
                velocity[i] = velocity[i].abs().max(theta * theta * change / 24.0);
                if !matches!(body.kind.sweep(column), Sweep::Along) {
                    position[i] = position[i].abs().max(theta * h * change / 12.0);
                }
            }
        }
    }
}
