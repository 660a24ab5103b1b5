//! The robot at one time: everything that a step needs of it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::{Carried, Felt};
use crate::dynamics::{crba, rnea};
use crate::force::{Start, Terms};
use crate::inputs::Inputs;
use crate::kinematics::Kinematics;
use crate::model::{ActuatorMode, Model};
use crate::parameters::Parameters;
use crate::state::Physical;
use crate::step::convex::Problem;
use crate::tree::Tree;
use crate::tuning::Rules;

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
    /// Most steps that may be tried in a communication step.
    pub budget: u64,
    /// Whether an integrator outside takes the steps: limits of joints are then a
    /// [`Stop`](crate::law::Stop).
    pub exchanged: bool,
    /// Which rules act.
    pub rules: &'a Rules,
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

/// One place in time: kinematics, contacts and joint terms.
#[derive(Clone, Debug)]
pub struct Point {
    /// Poses, velocities, mass matrix, bias.
    pub kin: Kinematics,
    /// What can act.
    pub terms: Terms,
    /// What motors in closed loops move and carry.
    felt: Felt,
    /// Whether mass matrix and bias have been found, too; see [`Self::begin`].
    complete: bool,
}

#[cfg(test)]
crate::spoil::spoil!(Point: kin terms felt complete;);

impl Point {
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            kin: Kinematics::new(tree),
            terms: Terms::new(model),
            felt: Felt::new(model, tree),
            complete: false,
        }
    }

    /// Everything at `from`, for steps of at most `h` seconds.
    pub fn update(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.pose(ctx, from);
        self.update_dynamics(ctx, from, h);
    }

    /// What each step needs of where it begins, for steps of at most `h` seconds. Stages stand in
    /// the middle of their step: mass matrix and bias of its start are found by [`Self::complete`]
    /// for who needs them, or here for servos and closed loops.
    pub(super) fn begin(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.pose(ctx, from);
        self.begin_dynamics(ctx, from, h);
    }

    fn begin_dynamics(&mut self, ctx: &Context, from: &Physical, h: f64) {
        let mut actuators = ctx.model.actuators.iter();
        let servos = actuators.any(|actuator| actuator.mode == ActuatorMode::Position);
        if servos || ctx.tree.is_closed() {
            self.update_dynamics(ctx, from, h);
        } else {
            self.find_terms(ctx, from, h);
            self.complete = false;
        }
    }

    /// Finds mass matrix and bias where [`Self::begin`] has left them out.
    pub(super) fn complete(&mut self, ctx: &Context, from: &Physical) {
        if !self.complete {
            crba::mass_matrix(ctx.tree, &mut self.kin);
            self.find_bias(ctx, from);
            self.complete = true;
        }
    }

    /// Poses and velocities of `from`.
    pub(super) fn pose(&mut self, ctx: &Context, from: &Physical) {
        self.kin.update_poses(ctx.tree, &from.q);
        self.kin.update_velocities(ctx.tree, &from.v);
    }

    /// The same as [`Self::begin`]; if the tree is long, without the mass matrix: then it is for
    /// explicit steps alone. After [`Self::pose`].
    pub(super) fn begin_smooth(&mut self, ctx: &Context, from: &Physical, h: f64) {
        if ctx.tree.long {
            self.find_smooth(ctx, from, h);
        } else {
            self.begin_dynamics(ctx, from, h);
        }
    }

    /// The same after an explicit step, whose last stage has found mass matrix and bias here unless
    /// the tree is long.
    pub(super) fn find_smooth(&mut self, ctx: &Context, from: &Physical, h: f64) {
        if ctx.tree.long {
            crba::diagonal(ctx.tree, &mut self.kin);
        }
        self.find_terms(ctx, from, h);
        self.complete = true;
    }

    /// What depends on velocities, after the poses are up to date.
    pub(super) fn update_motion(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.kin.update_velocities(ctx.tree, &from.v);
        self.update_forces(ctx, from, h);
    }

    fn update_dynamics(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.kin.loops.keep_all();
        crba::mass_matrix(ctx.tree, &mut self.kin);
        if ctx.tree.is_closed() {
            let Kinematics {
                loops,
                inverse_diagonal,
                ..
            } = &mut self.kin;
            loops.select(ctx.tree, inverse_diagonal);
        }
        self.update_forces(ctx, from, h);
        self.complete = true;
    }

    /// Bias, contacts and joint terms, after poses, mass matrix and velocities are up to date.
    fn update_forces(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.find_bias(ctx, from);
        self.find_felt(ctx);
        self.find_terms(ctx, from, h);
    }

    /// What motors in closed loops move and carry, after mass matrix and bias are up to date.
    fn find_felt(&mut self, ctx: &Context) {
        let acts = |index: usize| ctx.inputs.command(index, ctx.elapsed, 0.0).max_effort > 0.0;
        let Kinematics {
            M,
            inverse_diagonal,
            bias,
            loops: rows,
            ..
        } = &self.kin;
        let at = Carried {
            M,
            inverse_diagonal,
            bias,
            rows,
        };
        self.felt.find((ctx.model, ctx.tree), at, acts);
    }

    fn find_bias(&mut self, ctx: &Context, from: &Physical) {
        let wrenches = &ctx.inputs.wrenches;
        rnea::bias(ctx.tree, &mut self.kin, &from.v, wrenches, ctx.elapsed);
    }

    /// Contacts and joint terms, after the kinematics are up to date.
    pub(super) fn find_terms(&mut self, ctx: &Context, from: &Physical, h: f64) {
        let Context { model, tree, .. } = *ctx;
        let memory = &from.memory;
        self.terms.find_contacts(model, tree, memory, &self.kin, h);
        self.find_joint_terms(ctx, from, 0.0);
    }

    /// Contacts and joint terms of a step of `h` seconds from `from`, whose kinematics stand at the
    /// positions `q` in its midst: what terms remember, and the velocities that motors and dry
    /// friction start from, are those of its start.
    pub(super) fn find_around(&mut self, ctx: &Context, from: &Physical, (q, h): (&[f64], f64)) {
        let Context { model, tree, .. } = *ctx;
        let memory = &from.memory;
        self.terms.find_contacts(model, tree, memory, &self.kin, h);
        self.find_felt(ctx);
        self.set_joints(ctx, from, (q, [h, 0.5 * h]));
    }

    /// Joint terms alone, with targets and efforts as they are so many seconds after the start.
    pub(super) fn set_joints(
        &mut self,
        ctx: &Context,
        from: &Physical,
        (q, [target, effort]): (&[f64], [f64; 2]),
    ) {
        self.terms.set_joints(&Start {
            model: ctx.model,
            tree: ctx.tree,
            inputs: ctx.inputs,
            times: [ctx.elapsed, target],
            effort: ctx.elapsed + effort,
            q,
            v: &from.v,
            memory: &from.memory,
            kin: &self.kin,
            felt: &self.felt,
        });
    }

    /// Joint terms for a step of `h` seconds: commands that vary count as they are at its end.
    fn find_joint_terms(&mut self, ctx: &Context, from: &Physical, h: f64) {
        self.terms.set_joints(&Start {
            model: ctx.model,
            tree: ctx.tree,
            inputs: ctx.inputs,
            times: [ctx.elapsed, h],
            effort: ctx.elapsed + 0.5 * h,
            q: &from.q,
            v: &from.v,
            memory: &from.memory,
            kin: &self.kin,
            felt: &self.felt,
        });
    }

    /// Joint terms for a step of `h` seconds from here, where commands vary.
    pub(super) fn expect_commands(&mut self, ctx: &Context, from: &Physical, h: f64) {
        if ctx.inputs.varies() {
            self.find_joint_terms(ctx, from, h);
        }
    }

    pub(super) fn problem<'a>(&'a self, tree: &'a Tree, h: f64, accuracy: f64) -> Problem<'a> {
        Problem::new((tree, &self.kin), &self.terms, h, accuracy)
    }
}
