//! What motors in closed loops move and carry.
//!
//! A motor plans with the mass that it moves and the load that it carries. In a tree these are the
//! diagonal of `M` and the bias: those of what is beyond the joint, with all other joints held. In
//! a loop other joints must follow, and what they carry is felt, too: a cylinder of a kilogram that
//! lifts a boom of a tonne feels the tonne. For the degrees of freedom of all loops, with all
//! others held:
//!
//! 1. `P = M⁻¹ − Y W⁻¹ Yᵀ` with `Y = M⁻¹Jᵀ` and `W = J Y` is what forces make of accelerations
//!    within the loops. Without forces of motors these are `v̇₀ = −P k − Y W⁻¹ J̇v`.
//! 2. Along the joint `j` the loops move like the mass `1/P_jj`. What is beyond the joint counts at
//!    least, as in a tree.
//! 3. The motors carry what holds their joints: `P_AA τ = −v̇₀_A` for the joints `A` that have one.
//!    With more of them than the loops have freedoms `P_AA` has no inverse, and joints that move
//!    cannot all be without acceleration. So `τ` has the least sum of the squares of what is left
//!    of the accelerations and, by [`SHARED_LOAD`], of forces, `(P_AA² + ε²) τ = −P_AA v̇₀_A`, in
//!    units of the diagonal: such motors share their load.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use super::schur::{cholesky, divide, soften};
use crate::model::{ActuatorMode, Model};
use crate::tree::Tree;
use crate::tuning::{LOOP_COMPLIANCE, SHARED_LOAD, SPARE};

/// Mass and load of the motors in loops.
#[derive(Clone, Debug)]
pub struct Felt {
    /// Of each actuator, kg·m² or kg, and N·m or N; none outside of loops.
    of: Vec<Option<[f64; 2]>>,
    /// Degrees of freedom of the loops, ascending.
    dofs: Vec<usize>,
    /// Actuators that hold joints of loops, and the places of these in `dofs`.
    motors: Vec<(usize, usize)>,
    /// Factor of `M`, by rows of `n = dofs.len()`.
    M: Vec<f64>,
    /// `J` and `Y`, one row a row of the loops, `n` numbers each.
    J: Vec<f64>,
    Y: Vec<f64>,
    /// Factor of `W`.
    W: Vec<f64>,
    /// Columns of `P` of the motors, one after the other; `P_AA` in units of its diagonal, and the
    /// factor of its square.
    P: Vec<f64>,
    shares: Vec<f64>,
    squares: Vec<f64>,
    /// `τ` in these units.
    loads: Vec<f64>,
    /// `v̇₀`, and forces of rows or motors.
    free: Vec<f64>,
    forces: Vec<f64>,
    /// `nv` numbers each: a vector of zeros, and a column of `M`.
    unit: Vec<f64>,
    column: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Felt: dofs M J Y W P shares squares loads free forces column; of motors unit);

/// What masses and loads are found from.
#[derive(Clone, Copy, Debug)]
pub struct Carried<'a> {
    /// Mass matrix, packed as [`Tree::sparsity`] says.
    pub M: &'a [f64],
    /// `1 / M_kk`
    pub inverse_diagonal: &'a [f64],
    /// `k`
    pub bias: &'a [f64],
    /// `J` and `J̇v`
    pub rows: &'a Rows,
}

impl Felt {
    /// Room for all loops of a robot; none where no motor holds a joint, or there is no loop.
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let mut motors = model.actuators.iter();
        let needed = !tree.closures.is_empty() && motors.any(|a| a.mode != ActuatorMode::Effort);
        let room = usize::from(needed);
        let nv = room * tree.sparsity.len();
        let (m, k) = (room * Rows::most(tree), room * model.actuators.len());
        Self {
            of: vec![None; model.actuators.len()],
            dofs: Vec::with_capacity(nv),
            motors: Vec::with_capacity(k),
            M: Vec::with_capacity(nv * nv),
            J: Vec::with_capacity(m * nv),
            Y: Vec::with_capacity(m * nv),
            W: Vec::with_capacity(m * m),
            P: Vec::with_capacity(k * nv),
            shares: Vec::with_capacity(k * k),
            squares: Vec::with_capacity(k * k),
            loads: Vec::with_capacity(k),
            free: Vec::with_capacity(nv),
            forces: Vec::with_capacity(m.max(k)),
            unit: vec![0.0; nv],
            column: vec![0.0; nv],
        }
    }

    /// Mass, kg·m² or kg, and load, N·m or N, of an actuator whose joint is in a loop.
    pub fn of(&self, actuator: usize) -> Option<[f64; 2]> {
        self.of[actuator]
    }

    /// Finds them.
    ///
    /// - `acts`: whether an actuator has an effort to hold its joint with
    pub fn find(
        &mut self,
        (model, tree): (&Model, &Tree),
        at: Carried,
        acts: impl Fn(usize) -> bool,
    ) {
        self.of.fill(None);
        if self.unit.is_empty() || !tree.is_closed() {
            return;
        }
        self.select(model, tree, acts);
        if self.motors.is_empty() {
            return;
        }
        let n = self.dofs.len();
        self.factor(tree, at);
        self.free.clear();
        let bias = self.dofs.iter().map(|dof| -at.bias[*dof]);
        self.free.extend(bias);
        divide(&self.M, n, &mut self.free);
        let mut x = std::mem::take(&mut self.free);
        self.close(|row| -at.rows.bias[row], &mut x);
        self.free = x;
        let mut P = std::mem::take(&mut self.P);
        P.clear();
        P.resize(self.motors.len() * n, 0.0);
        for ((_, place), column) in self.motors.iter().zip(P.chunks_exact_mut(n)) {
            column[*place] = 1.0;
        }
        for (i, column) in P.chunks_exact_mut(n).enumerate() {
            let place = self.motors[i].1;
            divide(&self.M, n, column);
            let alone = column[place];
            self.close(|_| 0.0, column);
            // What cannot move at all is heavy.
            column[place] = column[place].max(SPARE * alone);
        }
        self.P = P;
        self.share(at);
    }

    /// Which degrees of freedom and motors are in loops.
    fn select(&mut self, model: &Model, tree: &Tree, acts: impl Fn(usize) -> bool) {
        self.dofs.clear();
        for (_, closure) in tree.worked_closures() {
            for dof in &closure.dofs {
                if let Err(place) = self.dofs.binary_search(dof) {
                    self.dofs.insert(place, *dof);
                }
            }
        }
        self.motors.clear();
        for (index, actuator) in model.actuators.iter().enumerate() {
            if actuator.mode != ActuatorMode::Effort && acts(index) {
                let place = self.dofs.binary_search(&actuator.dof.index());
                self.motors.extend(place.ok().map(|place| (index, place)));
            }
        }
    }

    /// Factors of `M` and `W`, and `J` and `Y`.
    fn factor(&mut self, tree: &Tree, at: Carried) {
        let (n, rows) = (self.dofs.len(), at.rows);
        let m = rows.len();
        self.M.clear();
        for dof in &self.dofs {
            self.unit[*dof] = 1.0;
            tree.sparsity.multiply(at.M, &self.unit, &mut self.column);
            self.unit[*dof] = 0.0;
            let column = &self.column;
            self.M.extend(self.dofs.iter().map(|other| column[*other]));
        }
        cholesky(&mut self.M, n);
        self.J.clear();
        self.J.resize(m * n, 0.0);
        for (row, J) in self.J.chunks_exact_mut(n).enumerate() {
            let (dofs, entries) = rows.entries(tree, row);
            for (dof, entry) in dofs.iter().zip(entries) {
                J[self.dofs.partition_point(|other| other < dof)] += entry;
            }
        }
        self.Y.clear();
        self.Y.extend_from_slice(&self.J);
        self.W.clear();
        self.W.resize(m * m, 0.0);
        for (row, y) in self.Y.chunks_exact_mut(n).enumerate() {
            divide(&self.M, n, y);
            for (w, J) in self.W[row * m..=row * m + row]
                .iter_mut()
                .zip(self.J.chunks_exact(n))
            {
                *w = dot(J, y);
            }
        }
        soften(&mut self.W, m, LOOP_COMPLIANCE);
        cholesky(&mut self.W, m);
    }

    /// Adds to the accelerations `x` what the loops' forces make of them, for `J x = b`.
    fn close(&mut self, asked: impl Fn(usize) -> f64, x: &mut [f64]) {
        let (n, forces) = (self.dofs.len(), &mut self.forces);
        forces.clear();
        let rows = self.J.chunks_exact(n).enumerate();
        forces.extend(rows.map(|(row, J)| asked(row) - dot(J, x)));
        divide(&self.W, forces.len(), forces);
        for (y, force) in self.Y.chunks_exact(n).zip(forces.iter()) {
            for (x, y) in x.iter_mut().zip(y) {
                *x += force * y;
            }
        }
    }

    /// Masses, and shares of the load.
    fn share(&mut self, at: Carried) {
        let (n, k) = (self.dofs.len(), self.motors.len());
        let (P, motors) = (&self.P, &self.motors);
        let scale = |i: usize| 1.0 / P[i * n + motors[i].1].sqrt();
        self.shares.clear();
        self.forces.clear();
        self.squares.clear();
        self.loads.clear();
        for i in 0..k {
            let along = (0..k).map(|j| P[i * n + motors[j].1] * scale(i) * scale(j));
            self.shares.extend(along);
            self.forces.push(-self.free[motors[i].1] * scale(i));
        }
        // Their square, and what it makes of the forces.
        for i in 0..k {
            let row = &self.shares[i * k..(i + 1) * k];
            for other in self.shares[..k * k].chunks_exact(k) {
                self.squares.push(dot(row, other));
            }
            self.squares[i * k + i] += SHARED_LOAD * SHARED_LOAD;
            self.loads.push(dot(row, &self.forces));
        }
        cholesky(&mut self.squares, k);
        divide(&self.squares, k, &mut self.loads);
        for (i, (index, place)) in motors.iter().enumerate() {
            let beyond = 1.0 / at.inverse_diagonal[self.dofs[*place]];
            let mass = (scale(i) * scale(i)).max(beyond);
            self.of[*index] = Some([mass, self.loads[i] * scale(i)]);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
