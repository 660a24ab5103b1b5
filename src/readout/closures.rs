//! What loops and springs do at this moment: forces on the first of what they join.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::Readout;
use crate::closure::Places;
use crate::model::{LoopId, SpringId};
use crate::spatial::Vec3;
use crate::step::point::{Context, Point};

impl Readout {
    /// Force, N, and torque about the first end, N·m, of a loop on its first link, world axes; of a
    /// coupler its effort along the sum, as the force in x.
    #[inline(never)]
    pub(super) fn loop_wrench(&self, ctx: &Context, id: LoopId) -> [Vec3; 2] {
        let kin = &self.point.kin;
        let places = Places {
            origins: &kin.origins,
            X: &kin.X,
            S: &kin.S,
        };
        let wrench = kin.loops.wrench(ctx.tree, places, id.index(), &self.loops);
        let [force, torque, middle] = wrench;
        [force, torque + middle.cross(&force)]
    }

    /// Gap of a loop: m of points, that of a coupler in its own unit.
    #[inline(never)]
    pub(super) fn loop_gap(&self, ctx: &Context, id: LoopId) -> f64 {
        let gap = self.point.kin.loops.opening(ctx.tree, id.index());
        gap.distance
    }

    /// Force of a spring on its first link, N, world axes, and its length, m.
    #[inline(never)]
    pub(super) fn spring(&self, ctx: &Context, id: SpringId) -> (Vec3, f64) {
        let Point { kin, terms, .. } = &self.point;
        let mut springs = terms.springs.iter();
        let found = springs.find(|s| ctx.tree.springs[s.index].index == id.index());
        found.map_or((Vec3::zeros(), 0.0), |spring| {
            let force = spring.force(&spring.relative(&kin.V));
            let reversed = ctx.tree.springs[spring.index].reversed;
            (if reversed { -force } else { force }, spring.line().0)
        })
    }
}
