//! Runge–Kutta steps of the equations of motion, with damping explicit or implicit.
//!
//! Used while no shape is near the ground, no limit is near, and no motor, servo or dry friction
//! acts: robots in the air, passive or torque-driven arms, pd laws that a step resolves.
//! Quaternions are integrated as four numbers and normalised after each step.
//!
//! Damping that is faster than the motion holds explicit steps up. It is linear, and diagonal in
//! joint space, so it may be taken implicitly at no cost: with the velocity `u` of the explicit
//! weights and `z` of the implicit ones ([`super::tableau::KENNEDY_CARPENTER`], whose two sets
//! share the weights of the solution), each stage solves
//!
//! ```text
//! (M(q) + h γ D) v̇ = τ − k(q, u) − D z,    z = v + h Σ (implicit weights of earlier stages) v̇
//! ```
//!
//! with the one factor that an explicit stage needs, too. It is a Runge–Kutta method for `F(u, z)`
//! partitioned by argument, hence of the order of the pair.
//!
//! Source: Hairer, Nørsett & Wanner 1993, sections II.4 to II.6; Boscarino, Filbet & Russo 2016
//! (one function of an explicit and an implicit argument).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::tableau::{EXTENSION, Pair, STAGES};
use crate::closure::{Rows, Schur};
use crate::dynamics::aba::Articulated;
use crate::dynamics::{crba, rnea};
use crate::force::{Drive, JointTerm, effort, push_springs};
use crate::kinematics::{Kinematics, position_rates};
use crate::sparsity::inverse::Inverse;
use crate::spatial::Vec6;
use crate::state::ahead::Ahead;
use crate::step::point::Context;
use crate::tree::Tree;

/// What drives the robot in an explicit step.
#[derive(Clone, Copy, Debug)]
pub struct Smooth<'a> {
    /// The robot, its inputs, and the time at which it stands.
    pub ctx: Context<'a>,
    /// Damping and efforts.
    pub joints: &'a [JointTerm],
}

/// Scratch of the explicit step.
#[derive(Clone, Debug)]
pub struct RungeKutta {
    /// Positions after the step.
    pub q: Vec<f64>,
    /// Velocities after the step.
    pub v: Vec<f64>,
    /// Estimated error of the velocities, and of the positions as velocities times time.
    pub error: [Vec<f64>; 2],
    q_rate: [Vec<f64>; STAGES],
    v_rate: [Vec<f64>; STAGES],
    factor: Vec<f64>,
    effort: Vec<f64>,
    /// Velocities that damping takes.
    damped: Vec<f64>,
    /// What implicit damping adds to the inertia, and rotor inertia if the tree is long.
    armature: Vec<f64>,
    articulated: Articulated,
    /// Forces of closed loops.
    closed: Schur,
    loops: Vec<f64>,
    /// Forces of springs on bodies.
    F: Vec<Vec6>,
    /// Whether stage 0 holds the rates at the current state.
    fresh: bool,
}

#[cfg(test)]
crate::spoil::spoil!(
    RungeKutta: q v error q_rate v_rate factor effort damped armature articulated closed loops F fresh;
);

impl RungeKutta {
    /// Buffers for a tree with `nq` coordinates.
    pub fn new(tree: &Tree, nq: usize) -> Self {
        let nv = tree.sparsity.len();
        Self {
            q: vec![0.0; nq],
            v: vec![0.0; nv],
            error: [vec![0.0; nv], vec![0.0; nv]],
            q_rate: std::array::from_fn(|_| vec![0.0; nq]),
            v_rate: std::array::from_fn(|_| vec![0.0; nv]),
            factor: vec![0.0; tree.sparsity.entries()],
            effort: vec![0.0; nv],
            damped: vec![0.0; nv],
            armature: vec![0.0; nv],
            articulated: Articulated::new(tree),
            closed: Schur::new(tree),
            loops: Vec::with_capacity(Rows::most(tree)),
            F: vec![[0.0; 6]; tree.bodies.len()],
            fresh: false,
        }
    }

    /// Forgets the rates kept from the last step; call it when the state or an input has changed.
    pub fn restart(&mut self) {
        self.fresh = false;
    }

    /// Room for the rates of positions at two states; whatever was kept is forgotten.
    pub fn rates(&mut self) -> [&mut [f64]; 2] {
        self.fresh = false;
        let [first, second, ..] = &mut self.q_rate;
        [first, second]
    }

    /// Takes the rates at the end of the last step by `pair` as those at the start of the next, if
    /// there are any.
    pub fn accept(&mut self, pair: &Pair) {
        self.fresh = pair.is_explicit();
        if self.fresh {
            self.q_rate.swap(0, pair.weights.len());
            self.v_rate.swap(0, pair.weights.len());
        }
    }

    /// One step of `h` seconds from `(q, v)`, into `self.q` and `self.v`.
    ///
    /// - `start`: kinematics at `(q, v)`: poses and velocities, and unless the tree is `long` mass
    ///   matrix and bias
    /// - `kin`: overwritten; poses and velocities are those of the new state afterwards
    /// - `finish`: whether an explicit pair's last stage is wanted, for error and next step
    #[expect(clippy::too_many_arguments, reason = "start and end of a step")]
    pub fn step(
        &mut self,
        pair: &Pair,
        system: &Smooth,
        start: &Kinematics,
        kin: &mut Kinematics,
        q: &[f64],
        v: &[f64],
        h: f64,
        finish: bool,
    ) {
        let tree = system.ctx.tree;
        if !self.fresh {
            self.damped.copy_from_slice(v);
            self.accelerations(system, start, 0, (q, v), 0.0);
            position_rates(tree, q, v, &mut self.q_rate[0]);
            self.fresh = true;
        }
        for (stage, weights) in pair.weights.iter().enumerate() {
            let mut stage_q = std::mem::take(&mut self.q);
            let mut stage_v = std::mem::take(&mut self.v);
            combine(&mut stage_q, q, &self.q_rate, weights, h);
            combine(&mut stage_v, v, &self.v_rate, weights, h);
            tree.normalize(&mut stage_q);
            // The time of a stage is the sum of its weights.
            let ctx = system.ctx.after(h * weights.iter().sum::<f64>());
            let system = &Smooth { ctx, ..*system };
            kin.update_poses(tree, &stage_q);
            kin.update_velocities(tree, &stage_v);
            let last = stage + 1 == pair.weights.len();
            if last && !(finish && pair.is_explicit()) {
                self.q = stage_q;
                self.v = stage_v;
                return;
            }
            if !tree.long {
                crba::mass_matrix(tree, kin);
                rnea::bias(tree, kin, &stage_v, &ctx.inputs.wrenches, ctx.elapsed);
            }
            let mut own = 0.0;
            if let Some(weights) = pair.implicit.get(stage) {
                own = h * pair.gamma;
                combine(&mut self.damped, v, &self.v_rate, weights, h);
            } else {
                self.damped.copy_from_slice(&stage_v);
            }
            self.accelerations(system, kin, stage + 1, (&stage_q, &stage_v), own);
            for (z, a) in self.damped.iter_mut().zip(&self.v_rate[stage + 1]) {
                *z += own * a;
            }
            let rates = &mut self.q_rate[stage + 1];
            position_rates(tree, &stage_q, &self.damped, rates);
            self.q = stage_q;
            self.v = stage_v;
        }
    }

    /// The polynomials of the step of `h` seconds that was just taken at time `start` by one of the
    /// pairs for long steps from `(q, v)`, before it is accepted, into `ahead`: cubics through
    /// values and rates at both ends, and what Dormand–Prince adds to them. The last stage of an
    /// implicit pair is at the end, too: positions change there with the new velocity, which is
    /// exact, and velocities with an acceleration that is third order in h.
    pub fn extension(
        &self,
        (tree, pair): (&Tree, &Pair),
        q: &[f64],
        v: &[f64],
        [start, h]: [f64; 2],
        ahead: &mut Ahead,
    ) {
        let (weights, end_rate): (&[f64], _) = if pair.is_explicit() {
            (&EXTENSION, STAGES - 1)
        } else {
            (&[], pair.weights.len() - 1)
        };
        let row = |from: &[f64], to: &[f64], rates: &[Vec<f64>; STAGES], i: usize| {
            let difference = to[i] - from[i];
            let bend = h * rates[0][i] - difference;
            let mut last = 0.0;
            for (rate, weight) in rates.iter().zip(weights) {
                last += weight * rate[i];
            }
            [
                from[i],
                difference,
                bend,
                difference - h * rates[end_rate][i] - bend,
                h * last,
            ]
        };
        ahead.begin(
            tree,
            [start, h],
            |i| row(q, &self.q, &self.q_rate, i),
            |k| row(v, &self.v, &self.v_rate, k),
        );
    }

    /// Errors of the step just taken, into `self.error`.
    pub fn estimate(&mut self, pair: &Pair, tree: &Tree, h: f64) {
        let [velocity, position] = &mut self.error;
        for (i, velocity) in velocity.iter_mut().enumerate() {
            *velocity = 0.0;
            for (rate, weight) in self.v_rate.iter().zip(pair.error) {
                *velocity += h * weight * rate[i];
            }
        }
        for (_, body) in tree.worked_bodies() {
            let c = body.coordinate;
            let error = |k: usize| -> f64 {
                self.q_rate
                    .iter()
                    .zip(pair.error)
                    .map(|(rate, w)| h * w * rate[k])
                    .sum()
            };
            body.kind
                .position_error(|k| error(c + k), &mut position[body.dof..]);
        }
    }

    /// Accelerations of stage `stage` from up-to-date kinematics for `q` and `v`; damping, that of
    /// pd laws too, acts on `self.damped` and `own` seconds of the acceleration.
    fn accelerations(
        &mut self,
        system: &Smooth,
        kin: &Kinematics,
        stage: usize,
        (q, v): (&[f64], &[f64]),
        own: f64,
    ) {
        let Context { tree, inputs, .. } = system.ctx;
        let acceleration = &mut self.v_rate[stage];
        self.effort.fill(0.0);
        self.armature.fill(0.0);
        if tree.long {
            self.armature.copy_from_slice(&tree.dofs.armature);
        }
        for term in system.joints {
            let (v, damped) = (v[term.dof], self.damped[term.dof]);
            let mut damping = term.damping;
            let effort = match (term.drive, term.actuator) {
                (Drive::Effort(_), Some(index)) if inputs.varies() => {
                    let command = inputs.command(index, system.ctx.elapsed, 0.0);
                    effort(system.ctx.model, index, &command)
                }
                (Drive::Effort(effort), _) => effort,
                (Drive::Pd { kp, kd, .. }, Some(index)) => {
                    let command = inputs.command(index, system.ctx.elapsed, 0.0);
                    let force = command.effort
                        + kp * (command.position - q[term.coordinate])
                        + kd * (command.velocity - damped);
                    let cap = command.max_effort;
                    damping += if force.abs() <= cap { kd } else { 0.0 };
                    force.clamp(-cap, cap)
                }
                _ => 0.0,
            };
            let resistance = term.damping * damped;
            self.effort[term.dof] += term.line.cut((effort, 0.0), v).0 - resistance;
            self.armature[term.dof] += own * damping;
        }
        push_springs(tree, kin, &mut self.F, &mut self.effort);
        if tree.long {
            self.articulated.accelerations_with(
                tree,
                kin,
                v,
                &self.armature,
                &self.effort,
                (&inputs.wrenches, system.ctx.elapsed),
                acceleration,
            );
            return;
        }
        for ((a, k), effort) in acceleration.iter_mut().zip(&kin.bias).zip(&self.effort) {
            *a = effort - k;
        }
        self.factor.copy_from_slice(&kin.M);
        if own > 0.0 {
            for (dof, damping) in self.armature.iter().enumerate() {
                self.factor[tree.sparsity.diagonal(dof)] += damping;
            }
        }
        tree.sparsity.factor(&mut self.factor);
        tree.sparsity.solve(&self.factor, acceleration);
        let rows = &kin.loops;
        if !rows.is_empty() {
            let (closed, factor) = (&mut self.closed, &self.factor);
            closed.factor(tree, rows, &Inverse::Packed(&tree.sparsity, factor));
            let asked = |row: usize| -rows.bias[row];
            closed.close((tree, rows), asked, acceleration, &mut self.loops);
        }
    }
}

/// `out = start + h Σ weight · rate`.
fn combine(out: &mut [f64], start: &[f64], rates: &[Vec<f64>; STAGES], weights: &[f64], h: f64) {
    for (i, (out, start)) in out.iter_mut().zip(start).enumerate() {
        let mut sum = 0.0;
        for (rate, weight) in rates.iter().zip(weights) {
            sum += weight * rate[i];
        }
        *out = start + h * sum;
    }
}
