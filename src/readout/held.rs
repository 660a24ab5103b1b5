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
    /// Where motors hold joints, makes `r − M a_s` of `r` in `self.vdot`, `M + G` of `M` in
    /// `self.factor`, and leaves `a_s` in `self.late`; tells whether any motor does.
    pub(super) fn hold_motors(&mut self, ctx: &Context, state: &State) -> bool {
        let tau = MOTOR_RELAXATION;
        let sparsity = &ctx.tree.sparsity;
        let mut any = false;
        if state.stepping.last_step <= 0.0 {
            return false;
        }
        for term in &self.point.terms.joints {
            let (_, slope) = term.drive_force(state.physical.v[term.dof], tau);
            if matches!(term.drive, Drive::Velocity { .. }) && slope < 0.0 {
                self.factor[sparsity.diagonal(term.dof)] -= tau * slope;
                any = true;
            }
        }
        if any {
            for (dof, late) in self.late.iter_mut().enumerate() {
                *late = late_acceleration(&state.stepping.trend, dof);
            }
            sparsity.multiply(&self.point.kin.M, &self.late, &mut self.held);
            for (r, held) in self.vdot.iter_mut().zip(&self.held) {
                *r -= held;
            }
        }
        any
    }
}
