//! The error that a solve makes because its friction cones lag behind its normal forces.

use super::{Factor, Newton, Problem, project};

impl Newton {
    /// Largest error of a velocity, weighted and to first order, rad/s, that comes from friction
    /// whose cones belong to other normal forces than those of the solution.
    ///
    /// - `factor`: that of the Hessian, where the solve has not needed one of its own
    pub(in crate::step) fn lag(&mut self, p: &Problem, factor: Option<&Factor>) -> f64 {
        if p.terms.contacts.is_empty() {
            return 0.0;
        }
        self.clear_forces(p.tree);
        if !p.terms.add_lag(&self.at, &self.responses, p.h, &mut self.F) {
            return 0.0;
        }
        let mut missing = std::mem::take(&mut self.direction);
        let mut forces = std::mem::take(&mut self.lagging);
        missing.fill(0.0);
        project((p.tree, p.kin), &self.loaded, &mut self.F, |dof, lag| {
            missing[dof] += lag;
        });
        let factor = match factor {
            Some(factor) if !self.factored => factor,
            _ => self.factor(p),
        };
        factor.solve((p.tree, &p.kin.loops), &mut missing, &mut forces);
        (self.direction, self.lagging) = (missing, forces);
        let weighted = self.direction.iter().zip(&p.tree.dofs.weight);
        weighted.fold(0.0, |most: f64, (v, w)| most.max(w * v.abs()))
    }
}
