//! Accelerations where velocity motors hold joints.
//!
//! 1. The force of a stiff motor at the end of a step is that of its last stage, which balances the
//!    mass matrix and the bias of the middle of the step. With those of its end a force of first
//!    order in the step is left over, and what is light makes much of it: at 1e-3 the crank of
//!    Hoeken's linkage, turned at 6 rad/s, had 114 rad/s² in place of 0.06.
//! 2. What the step has done knows better: `a_s`, the mean acceleration from the first stage of the
//!    step to its end. After a command that jumps it is that of the time after the jump.
//! 3. As in an estimate of an error, what dies within the motor's own time `τ` is filtered out of
//!    the difference: `(M + G)(v̇ − a_s) = r − M a_s` with `G = τ (d + τ k)` along the joints of
//!    motors that do not yield, and `r` all forces less the bias. Where a motor is stiff this gives
//!    `a_s`; where nothing is, `M v̇ = r`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::force::Drive;
use crate::state::State;
use crate::step::late_acceleration;
use crate::step::point::Context;
use crate::tuning::MOTOR_RELAXATION;

impl Readout {
    /// Finds accelerations, with the forces of closed loops, where `self.vdot` is `M⁻¹ r` without
    /// these, and `self.factor` the factor of `M`.
    pub(super) fn hold_motors(&mut self, ctx: &Context, state: &State) {
        let (tree, tau) = (ctx.tree, MOTOR_RELAXATION);
        if state.stepping.last_step <= 0.0 {
            return;
        }
        let Self {
            point,
            vdot,
            factor,
            late,
            off,
            ..
        } = self;
        let motors = point.terms.joints.iter().filter_map(|term| {
            let is_motor = matches!(term.drive, Drive::Velocity { .. });
            let (_, slope) = term.drive_force(state.physical.v[term.dof], tau);
            (is_motor && slope < 0.0).then_some((term.dof, -tau * slope))
        });
        if motors.clone().next().is_none() {
            return;
        }
        for (dof, (late, a)) in late.iter_mut().zip(vdot.iter()).enumerate() {
            *late = late_acceleration(&state.stepping.trend, dof);
            off[dof] = a - *late;
        }
        tree.sparsity.multiply(&point.kin.M, off, vdot);
        factor.copy_from_slice(&point.kin.M);
        for (dof, stiffness) in motors {
            factor[tree.sparsity.diagonal(dof)] += stiffness;
        }
        tree.sparsity.factor(factor);
        tree.sparsity.solve(factor, vdot);
        for (a, late) in vdot.iter_mut().zip(late.iter()) {
            *a += late;
        }
    }
}
