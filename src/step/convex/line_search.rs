//! How far to go along Newton's direction.

use super::{Newton, Problem};
use crate::force::Response;
use crate::kinematics::forward;
use crate::spatial::{Vec3, angular};

/// Share of the initial slope that a full step may leave uphill before the line search looks closer.
const ACCEPTED_SLOPE: f64 = 0.1;
/// Share of the initial slope at which the line search stops.
const LINE_SEARCH_TOLERANCE: f64 = 1e-3;

impl Newton {
    /// Length along `direction` at which the slope of the cost is (nearly) zero, at most 1. The responses are then
    /// those at that length.
    #[inline]
    pub(super) fn line_search(&mut self, p: &Problem) -> f64 {
        let Problem { tree, kin, .. } = *p;
        tree.sparsity
            .multiply(&kin.M, &self.direction, &mut self.direction_momentum);
        self.point_direction.clear();
        if !p.terms.contacts.is_empty() {
            forward(tree, &kin.S, &self.direction, &mut self.V);
            let velocities = p.terms.contacts.iter().map(|c| c.velocity(&self.V));
            self.point_direction.extend(velocities);
        }
        self.turn_direction.clear();
        let turns = p.terms.turns.iter().map(|t| angular(&self.V[t.body]));
        self.turn_direction.extend(turns);
        let (mut linear, mut quadratic, mut initial) = (0.0, 0.0, 0.0_f64);
        for i in 0..self.v.len() {
            let w = self.direction[i];
            linear += (self.change[i] + p.h * p.bias[i]) * w;
            quadratic += self.direction_momentum[i] * w;
            initial += self.gradient[i] * w;
        }
        let initial = initial.abs();
        let mut alpha = 1.0;
        let mut value = linear + quadratic + self.respond_along(p, alpha);
        if value <= ACCEPTED_SLOPE * initial {
            return alpha;
        }
        // Newton inside a shrinking bracket; every third time, and where Newton leaves it, bisection: at a friction
        // element's kink the zone of the root can be a millionth of the bracket.
        let (mut low, mut high) = (0.0, 1.0);
        for trial in 0..60 {
            let inner = 1e-3 * (high - low);
            let newton: f64 = alpha - value / (quadratic + self.curvature(p));
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
        let mut slope = 0.0;
        self.responses.clear();
        let points = self.point_velocity.iter().zip(&self.point_direction);
        for (contact, (v, w)) in p.terms.contacts.iter().zip(points) {
            let response = contact.response(&(v + w * alpha), p.h);
            slope -= response.impulse.dot(w);
            self.responses.push(response);
        }
        self.turn_responses.clear();
        let turns = self.turn_velocity.iter().zip(&self.turn_direction);
        for (turn, (v, w)) in p.terms.turns.iter().zip(turns) {
            let response = turn.response(&(v + w * alpha), p.h);
            slope -= response.impulse.dot(w);
            self.turn_responses.push(response);
        }
        self.joint_responses.clear();
        for term in &p.terms.joints {
            let w = self.direction[term.dof];
            let response = term.response(self.v[term.dof] + alpha * w, p.h);
            slope -= response.impulse * w;
            self.joint_responses.push(response);
        }
        slope
    }

    /// Second derivative of the cost of contacts and joints along `direction`, from the responses.
    fn curvature(&self, p: &Problem) -> f64 {
        let mut curvature = 0.0;
        let points = self.responses.iter().zip(&self.point_direction);
        for (contact, (r, w)) in p.terms.contacts.iter().zip(points) {
            curvature += along(&contact.normal, r, w);
        }
        let turns = self.turn_responses.iter().zip(&self.turn_direction);
        for (turn, (r, w)) in p.terms.turns.iter().zip(turns) {
            curvature += along(&turn.normal, r, w);
        }
        for (term, r) in p.terms.joints.iter().zip(&self.joint_responses) {
            let stiffness = r.stiffness;
            let w = self.direction[term.dof];
            curvature += stiffness * w * w;
        }
        curvature
    }
}

/// `wᵀ G w` of a response's stiffness.
#[inline]
fn along(normal: &Vec3, r: &Response, w: &Vec3) -> f64 {
    let wn = normal.dot(w);
    let ws = r.slip.dot(w);
    r.tangential * (w.norm_squared() - wn * wn - ws * ws) + r.normal * wn * wn
}
