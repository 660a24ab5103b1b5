//! Bases that move as inputs say, whatever pushes them.
//!
//! In the mass matrix they stand with [`crate::tuning::DRIVEN_MASS`] and the bias of their
//! acceleration, so that a step takes them to the velocity that it knows beforehand. They have no
//! mass of their own: what touches them is as stiff as its own weight asks, and no energy is
//! theirs.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::parts::Tree;
use crate::model::RootId;
use crate::spatial::{Vec3, Vec6, quaternion_exp, quaternion_normalized, quaternion_product};

/// Most parts of a turn: those of ten minutes at the fastest angular velocity that inputs may have.
/// Saved states may hold any speed; what they turn by then has no digits left. Without it
/// `no_turn_takes_for_ever` does.
const MOST_PARTS: f64 = 1e6;

impl Tree {
    /// Whether a body moves as inputs say.
    #[inline]
    pub fn is_driven(&self, body: usize) -> bool {
        let tree = &self.trees[self.bodies[body].tree];
        tree.driven.is_some() && tree.bodies.start == body
    }

    /// The driven bases that a step moves: their bodies, first degrees of freedom, accelerations.
    pub fn driven(&self) -> impl Iterator<Item = (usize, usize, &Vec6)> + '_ {
        self.moved().filter_map(|(_, tree)| {
            let driven = tree.driven.as_ref();
            driven.map(|a| (tree.bodies.start, tree.dofs.start, a))
        })
    }

    /// Sets the accelerations of driven bases.
    ///
    /// - `acceleration`: of a tree with its first degree of freedom
    pub fn drive(&mut self, acceleration: impl Fn(RootId, usize) -> Vec6) {
        for (root, tree) in (0..).map(RootId::from).zip(&mut self.trees) {
            let dof = tree.dofs.start;
            if let Some(driven) = &mut tree.driven {
                *driven = acceleration(root, dof);
            }
        }
    }

    /// Puts driven bases where their velocities, which change evenly from `v`, lead from `from` in
    /// `t` seconds, into `to`.
    pub fn carry_driven(&self, (from, v): (&[f64], &[f64]), t: f64, to: &mut [f64]) {
        for (body, dof, acceleration) in self.driven() {
            let place = self.bodies[body].coordinate;
            let (from, to) = (&from[place..place + 7], &mut to[place..place + 7]);
            let v = &v[dof..dof + 6];
            for i in 0..3 {
                to[i] = from[i] + t * (v[3 + i] + 0.5 * t * acceleration[3 + i]);
            }
            let [w, a] = [v, acceleration].map(|x| Vec3::new(x[0], x[1], x[2]));
            let before = [from[3], from[4], from[5], from[6]];
            let q = quaternion_product(&turn(&w, &a, t), &before);
            to[3..].copy_from_slice(&quaternion_normalized(&q));
        }
    }
}

/// Turn in `t` seconds at the angular velocity `w + a t`, to the last digits.
///
/// Its quaternion follows `q' = ½ (w + a t) q`. With `A = ½ w s` and `B = ½ a s²` that of a part of
/// `s` seconds is `Σ c_j (t/s)^j`, where
///
/// ```text
/// c₀ = 1,   (j + 1) c_{j+1} = A c_j + B c_{j−1}
/// ```
///
/// and no term is larger than that of `exp((|A| + |B|) t/s)`. A part turns by at most 1 rad, so
/// that `|A| + |B|` stays below 3/2 and hardly a digit is lost in the sum; it ends where terms are
/// below the last digit of a unit quaternion. A turn about an axis that stays is `exp(∫ w dt)`,
/// however far.
fn turn(w: &Vec3, a: &Vec3, t: f64) -> [f64; 4] {
    if w.cross(a) == Vec3::zeros() {
        return quaternion_exp(&((w + a * (0.5 * t)) * t));
    }
    let most = t * w.norm().max((w + a * t).norm());
    let parts = libm::ceil(most).clamp(1.0, MOST_PARTS);
    let s = t / parts;
    let (mut turned, mut done) = ([1.0, 0.0, 0.0, 0.0], 0.0);
    while done < parts {
        let [A, B] = [(w + a * (done * s)) * (0.5 * s), a * (0.5 * s * s)];
        turned = quaternion_product(&sum_of_turn(&A, &B), &turned);
        done += 1.0;
    }
    turned
}

/// The sum of [`turn`] at the end of a part.
fn sum_of_turn(A: &Vec3, B: &Vec3) -> [f64; 4] {
    let [A, B] = [A, B].map(|x| [0.0, x.x, x.y, x.z]);
    let [mut before, mut term] = [[0.0; 4], [1.0, 0.0, 0.0, 0.0]];
    let (mut sum, mut order) = (term, 0.0);
    let shows = |x: &[f64; 4]| x.iter().any(|x| x.abs() > 0.5 * f64::EPSILON);
    while shows(&term) || shows(&before) {
        order += 1.0;
        let [mut next, more] = [
            quaternion_product(&A, &term),
            quaternion_product(&B, &before),
        ];
        for ((next, more), sum) in next.iter_mut().zip(&more).zip(&mut sum) {
            *next = (*next + more) / order;
            *sum += *next;
        }
        [before, term] = [term, next];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speeds that only a saved state may have, whose axis turns.
    #[test]
    fn no_turn_takes_for_ever() {
        for speed in [1e12, 1e100, 1e300, f64::MAX, f64::INFINITY, f64::NAN] {
            let [w, a] = [Vec3::new(speed, 1.0, 0.0), Vec3::new(0.0, speed, 1.0)];
            let q = turn(&w, &a, 1.0 / 240.0);
            let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(!norm.is_finite() || (norm - 1.0).abs() < 1e-6, "{q:?}");
        }
    }
}
