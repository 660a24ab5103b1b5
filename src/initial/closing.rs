//! Closed loops at the start: positions and velocities are moved until the loops are closed.
//!
//! The search begins at the pose that is asked for. Gauss–Newton's method takes the shortest way,
//! in the weights of errors. Positions that have been given are moved only if the loops cannot be
//! closed by the others. Joints stay within their limits, and floating bases are moved only if
//! joints cannot close the loops.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::{Gap, Schur};
use crate::joint::Kind;
use crate::kinematics::{Kinematics, advance};
use crate::sparsity::inverse::Inverse;
use crate::state::Physical;
use crate::tree::Tree;
use crate::tuning::{
    BASE_WEIGHT, CLOSED, CLOSED_START, CLOSING_SPREAD, CLOSING_STARTS, CLOSING_TRIES, CLOSING_WAY,
    STOPPED,
};

/// What holds each degree of freedom: the reciprocal of its squared weight, 0 where it stays.
type Freedom = Vec<f64>;

struct Search<'a> {
    tree: &'a Tree,
    kin: &'a mut Kinematics,
    closed: Schur,
    freedom: Freedom,
    forces: Vec<f64>,
    change: Vec<f64>,
}

/// Closes the loops of a state; returns the widest that stays open, if one does. The state is then
/// as near to closed as was found.
///
/// - `kin`: scratch
/// - `held`: whether the position, or the velocity, of a degree of freedom has been given
#[cfg_attr(small, optimize(size))]
pub(crate) fn close(
    tree: &Tree,
    kin: &mut Kinematics,
    held: [&dyn Fn(usize) -> bool; 2],
    state: &mut Physical,
) -> Option<(usize, Gap)> {
    if tree.closures.is_empty() {
        return None;
    }
    let nv = tree.sparsity.len();
    let mut search = Search {
        tree,
        kin,
        closed: Schur::new(tree),
        freedom: vec![0.0; nv],
        forces: Vec::new(),
        change: vec![0.0; nv],
    };
    let open = search.close_positions(held[0], &mut state.q);
    search.close_velocities(held[1], &mut state.v);
    open
}

impl Search<'_> {
    fn close_positions(
        &mut self,
        held: &dyn Fn(usize) -> bool,
        q: &mut Vec<f64>,
    ) -> Option<(usize, Gap)> {
        let begin = q.clone();
        let mut best = (f64::INFINITY, begin.clone());
        let nothing: &dyn Fn(usize) -> bool = &|_| false;
        let any = (0..self.freedom.len()).any(held);
        for held in [held, nothing].into_iter().skip(usize::from(!any)) {
            for start in 0..CLOSING_STARTS {
                let mut found = begin.clone();
                self.free(held);
                self.stray(start, &mut found);
                let gap = self.approach(&mut found);
                if gap <= CLOSED_START {
                    *q = found;
                    self.gap(q);
                    return None;
                }
                if gap < best.0 {
                    best = (gap, found);
                }
            }
        }
        *q = best.1;
        self.gap(q);
        self.kin.loops.widest(self.tree)
    }

    /// Weighs all degrees of freedom but those that are held.
    #[cfg_attr(small, optimize(size))]
    fn free(&mut self, held: &dyn Fn(usize) -> bool) {
        let weights = &self.tree.dofs.weight;
        for (k, (free, weight)) in self.freedom.iter_mut().zip(weights).enumerate() {
            let weight = weight.max(1e-3);
            *free = if held(k) {
                0.0
            } else {
                1.0 / (weight * weight)
            };
        }
        for (b, body) in self.tree.bodies.iter().enumerate() {
            if !body.kind.is_free() {
                continue;
            }
            if self.tree.is_driven(b) {
                self.freedom[body.dof..body.dof + 6].fill(0.0);
            }
            for free in &mut self.freedom[body.dof..body.dof + 6] {
                *free /= BASE_WEIGHT * BASE_WEIGHT;
            }
        }
    }

    /// Begins elsewhere: the first time where it is, then farther and farther off.
    fn stray(&mut self, start: usize, q: &mut [f64]) {
        if start == 0 {
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        for (k, change) in self.change.iter_mut().enumerate() {
            let share = start as f64 / (CLOSING_STARTS - 1) as f64;
            let phase = libm::sin(1.7 * start as f64 + 2.3 * k as f64);
            *change = CLOSING_SPREAD * share * phase * self.freedom[k].sqrt();
        }
        self.go(1.0, q);
    }

    /// Moves by `share` of the change, within the limits.
    #[cfg_attr(small, optimize(size))]
    fn go(&self, share: f64, q: &mut [f64]) {
        let from = q.to_vec();
        advance(self.tree, &from, &self.change, share, q);
        for body in &self.tree.bodies {
            if let (Kind::Turn | Kind::Slide, Some(limits)) = (
                body.kind,
                self.tree.dofs.limits.get(body.dof).copied().flatten(),
            ) {
                // A start outside the limits stays where it has been put.
                let [low, high] = [
                    limits.lower.min(from[body.coordinate]),
                    limits.upper.max(from[body.coordinate]),
                ];
                q[body.coordinate] = q[body.coordinate].clamp(low, high);
            }
        }
    }

    /// The largest gap at `q`, m.
    fn gap(&mut self, q: &[f64]) -> f64 {
        self.kin.update_poses(self.tree, q);
        self.kin.update_loops(self.tree);
        self.kin.loops.find_sums(self.tree, q);
        self.kin.loops.largest()
    }

    fn cost(&self) -> f64 {
        self.kin.loops.gap.iter().map(|x| x * x).sum()
    }

    /// Gauss–Newton's method from `q`; returns the gap that is left, m.
    fn approach(&mut self, q: &mut [f64]) -> f64 {
        let mut gap = self.gap(q);
        for _ in 0..CLOSING_TRIES {
            if gap <= CLOSED || !gap.is_finite() {
                break;
            }
            let cost = self.cost();
            self.find_change(q);
            let ways = self.change.iter().zip(&self.tree.dofs.weight);
            let way = ways.fold(0.0, |most: f64, (x, w)| most.max(w * x.abs()));
            let mut share = (CLOSING_WAY / way).min(1.0);
            let before = q.to_vec();
            let mut falls = false;
            for _ in 0..30 {
                q.copy_from_slice(&before);
                self.go(share, q);
                gap = self.gap(q);
                falls = self.cost() < cost;
                if falls {
                    break;
                }
                share *= 0.5;
            }
            if !falls {
                q.copy_from_slice(&before);
                return self.gap(q);
            }
        }
        gap
    }

    /// The least change that closes the loops to first order; joints at their limits do not go
    /// beyond.
    fn find_change(&mut self, q: &[f64]) {
        let before = self.freedom.clone();
        for _ in 0..=self.tree.bodies.len() {
            let (rows, free) = (&self.kin.loops, &self.freedom);
            let inverse = Inverse::Diagonal(&self.tree.sparsity, free);
            self.closed.factor(self.tree, rows, &inverse);
            self.forces.clear();
            self.forces.extend(rows.gap.iter().map(|gap| -gap));
            self.closed.solve(&mut self.forces);
            self.change.fill(0.0);
            self.closed.push(&self.forces, &mut self.change);
            let mut stopped = false;
            for body in &self.tree.bodies {
                // Scenery has no degree of freedom.
                if !matches!(body.kind, Kind::Turn | Kind::Slide) {
                    continue;
                }
                let Some(limits) = self.tree.dofs.limits[body.dof] else {
                    continue;
                };
                let (place, change) = (q[body.coordinate], self.change[body.dof]);
                let out =
                    place <= limits.lower && change < 0.0 || place >= limits.upper && change > 0.0;
                if out && self.freedom[body.dof] > 0.0 {
                    self.freedom[body.dof] = 0.0;
                    stopped = true;
                }
            }
            if !stopped {
                break;
            }
        }
        self.freedom = before;
    }

    /// Takes the velocity out of the rows, first by what has not been given alone.
    fn close_velocities(&mut self, held: &dyn Fn(usize) -> bool, v: &mut [f64]) {
        let begin = v.to_vec();
        let nothing: &dyn Fn(usize) -> bool = &|_| false;
        for held in [held, nothing] {
            v.copy_from_slice(&begin);
            self.free(held);
            let (rows, free) = (&self.kin.loops, &self.freedom);
            let inverse = Inverse::Diagonal(&self.tree.sparsity, free);
            self.closed.factor(self.tree, rows, &inverse);
            for _ in 0..STOPPED {
                let along = (0..rows.len()).map(|row| -rows.along(self.tree, row, v));
                self.forces.clear();
                self.forces.extend(along);
                self.closed.solve(&mut self.forces);
                self.closed.push(&self.forces, v);
            }
            let along = (0..rows.len()).map(|row| rows.along(self.tree, row, v).abs());
            let fastest = begin.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            if along.fold(0.0, f64::max) <= CLOSED_START * fastest {
                return;
            }
        }
    }
}
