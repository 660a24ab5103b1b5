//! Closed loops at the end of a step: positions and velocities are projected to where the loops
//! are closed.
//!
//! A step leaves a gap of its own order, because its rows are those of one place. The gap is taken
//! out by `q ⊕ M⁻¹Jᵀλ`, and what is left of the rows' velocity by `v + M⁻¹Jᵀλ`: forces of the
//! loops alone, which change no momentum.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::{Rows, Schur};
use crate::dynamics::crba;
use crate::kinematics::{Kinematics, advance};
use crate::model::Model;
use crate::sparsity::inverse::Inverse;
use crate::state::Physical;
use crate::tree::Tree;
use crate::tuning::{CLOSED, OPEN, PROJECTIONS, STOPPED};

/// Scratch of a projection.
#[derive(Clone, Debug)]
pub(super) struct Closing {
    closed: Schur,
    factor: Vec<f64>,
    forces: Vec<f64>,
    /// Change of positions or velocities, `nv`.
    change: Vec<f64>,
    /// Sum of the changes of positions.
    moved: Vec<f64>,
    q: Vec<f64>,
    /// Kinetic energy that the last projection of velocities has taken, J.
    pub taken: f64,
    /// The loop that has stayed open in this try of a step, the widest of them.
    pub apart: Option<usize>,
}

#[cfg(test)]
crate::spoil::spoil!(Closing: closed factor forces change moved q; taken apart);

impl Closing {
    /// Room for a robot.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        Self {
            closed: Schur::new(tree),
            factor: vec![0.0; tree.sparsity.entries()],
            forces: Vec::with_capacity(Rows::most(tree)),
            change: vec![0.0; tree.sparsity.len()],
            moved: vec![0.0; tree.sparsity.len()],
            q: vec![0.0; model.nq],
            taken: 0.0,
            apart: None,
        }
    }

    /// Closes the loops of what a step works on; returns how far the farthest degree of freedom has
    /// moved, weighted, m, infinite where a gap stays.
    ///
    /// - `kin`: overwritten; poses are those of `end` afterwards
    /// - `h`: for how long a change of velocity counts, s
    pub fn close(&mut self, tree: &Tree, kin: &mut Kinematics, end: &mut Physical, h: f64) -> f64 {
        if !tree.is_closed() {
            return 0.0;
        }
        kin.loops.keep_all();
        Self::place(tree, kin, &end.q);
        self.factor(tree, kin);
        tree.clear_velocities(&mut self.moved);
        let mut gap = kin.loops.largest();
        // Whether mass matrix and rows are those of where the robot stands.
        let mut placed = true;
        for _ in 0..PROJECTIONS {
            if gap <= CLOSED || !gap.is_finite() {
                break;
            }
            self.push(tree, kin, |rows, row| -rows.gap[row]);
            self.q.copy_from_slice(&end.q);
            advance(tree, &self.q, &self.change, 1.0, &mut end.q);
            for k in tree.worked_dofs() {
                self.moved[k] += self.change[k];
            }
            placed = false;
            kin.update_poses(tree, &end.q);
            kin.update_loops(tree);
            kin.loops.find_sums(tree, &end.q);
            let now = kin.loops.largest();
            // What no longer falls is round-off.
            let stays = now > 0.5 * gap;
            if stays && now <= OPEN {
                gap = now;
                break;
            }
            if now > 0.1 * gap {
                Self::place(tree, kin, &end.q);
                self.factor(tree, kin);
                placed = true;
            }
            gap = now;
        }
        if !placed {
            Self::place(tree, kin, &end.q);
            self.factor(tree, kin);
        }
        let stopped = h * self.stop(tree, kin, end);
        if gap > OPEN || gap.is_nan() {
            self.apart = kin.loops.widest(tree).map(|(closure, _)| closure);
            return f64::INFINITY;
        }
        stopped.max(tree.longest(|k| [self.moved[k]]))
    }

    /// Takes the velocity out of the rows; returns the largest change, weighted, m/s.
    fn stop(&mut self, tree: &Tree, kin: &Kinematics, end: &mut Physical) -> f64 {
        let rows = &kin.loops;
        let mut most: f64 = 0.0;
        self.taken = 0.0;
        for _ in 0..STOPPED {
            let v = &mut end.v;
            self.forces.clear();
            let along = (0..rows.len()).map(|row| -rows.along(tree, row, v));
            self.forces.extend(along);
            let speed = self
                .forces
                .iter()
                .fold(0.0, |most: f64, x| most.max(x.abs()));
            if speed <= CLOSED {
                break;
            }
            self.closed.solve(&mut self.forces);
            for (row, force) in self.forces.iter().enumerate() {
                self.taken -= 0.5 * force * rows.along(tree, row, v);
            }
            tree.clear_velocities(&mut self.change);
            self.closed.push(&self.forces, &mut self.change);
            for k in tree.worked_dofs() {
                v[k] += self.change[k];
            }
            most = most.max(tree.longest(|k| [self.change[k]]));
        }
        most
    }

    /// Poses, mass matrix, rows and gaps at `q`.
    fn place(tree: &Tree, kin: &mut Kinematics, q: &[f64]) {
        kin.update_poses(tree, q);
        crba::mass_matrix(tree, kin);
        kin.loops.find_sums(tree, q);
    }

    fn factor(&mut self, tree: &Tree, kin: &Kinematics) {
        self.factor.copy_from_slice(&kin.M);
        tree.sparsity.factor(&mut self.factor);
        let inverse = Inverse::Packed(&tree.sparsity, &self.factor);
        self.closed.factor(tree, &kin.loops, &inverse);
    }

    /// The change that closes what `asked` says of each row, into `self.change`.
    fn push(&mut self, tree: &Tree, kin: &Kinematics, asked: impl Fn(&Rows, usize) -> f64) {
        let rows = &kin.loops;
        self.forces.clear();
        let asked = (0..rows.len()).map(|row| asked(rows, row));
        self.forces.extend(asked);
        self.closed.solve(&mut self.forces);
        tree.clear_velocities(&mut self.change);
        self.closed.push(&self.forces, &mut self.change);
    }
}
