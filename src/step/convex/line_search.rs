//! Step length along Newton's direction.

use super::{Newton, Problem};
use crate::kinematics::forward;
use crate::tuning::{LINE_SEARCH_EDGE, LINE_SEARCH_TOLERANCE, LINE_SEARCH_TRIALS};

impl Newton {
    /// Length along `direction` at which the slope of the cost is (nearly) zero, at most 1. The
    /// responses are then those at that length.
    #[inline]
    pub(super) fn line_search(&mut self, p: &Problem) -> f64 {
        let Problem { tree, kin, .. } = *p;
        tree.sparsity
            .multiply(&kin.M, &self.direction, &mut self.direction_momentum);
        if !p.terms.is_free() {
            forward(tree, &kin.S, &self.direction, &mut self.V);
        }
        self.along.set(p.terms, &self.V);
        let (mut linear, mut quadratic, mut initial) = (0.0, 0.0, 0.0_f64);
        for span in &tree.island.spans {
            let of = || span.dofs.clone();
            let forces = self.change[of()].iter().zip(&p.bias[of()]);
            let slopes = self.direction_momentum[of()]
                .iter()
                .zip(&self.gradient[of()]);
            let rows = self.direction[of()].iter().zip(forces).zip(slopes);
            for ((w, (change, bias)), (momentum, gradient)) in rows {
                linear += (change + p.h * bias) * w;
                quadratic += momentum * w;
                initial += gradient * w;
            }
        }
        let initial = initial.abs();
        let mut alpha = 1.0;
        let mut value = linear + quadratic + self.respond_along(p, alpha);
        if value <= LINE_SEARCH_TOLERANCE * initial {
            return alpha;
        }
        // Newton inside a shrinking bracket; every third time, and where Newton leaves it,
        // bisection: at a friction element's kink the zone of the root can be a millionth of the
        // bracket.
        let (mut low, mut high) = (0.0, 1.0);
        for trial in 0..LINE_SEARCH_TRIALS {
            let inner = LINE_SEARCH_EDGE * (high - low);
            let along = (&self.direction[..], &self.along);
            let curvature = p.terms.curvature(&self.responses, along, p.h);
            let newton: f64 = alpha - value / (quadratic + curvature);
            alpha = if newton > low + inner && newton < high - inner && trial % 3 != 2 {
                newton
            } else {
                0.5 * (low + high)
            };
            value = linear + alpha * quadratic + self.respond_along(p, alpha);
            if value.abs() <= LINE_SEARCH_TOLERANCE * initial {
                break;
            }
            if value < 0.0 {
                low = alpha;
            } else {
                high = alpha;
            }
        }
        alpha
    }

    /// Responses at `v + alpha · direction`; returns what they add to the slope of the cost.
    fn respond_along(&mut self, p: &Problem, alpha: f64) -> f64 {
        let (from, along) = ((&self.v[..], &self.at), (&self.direction[..], &self.along));
        let out = &mut self.responses;
        p.terms.respond_along(from, along, alpha, p.h, out)
    }
}
