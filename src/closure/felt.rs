//! What motors in closed loops move and carry.
//!
//! A motor plans with the mass that it moves and the load that it carries. In a tree these are the
//! diagonal of `M` and the bias: those of what is beyond the joint, with all other joints held. In
//! a loop other joints must follow, and what they carry is felt, too: a cylinder of a kilogram that
//! lifts a boom of a tonne feels the tonne. For the degrees of freedom of all loops, with all
//! others held:
//!
//! 1. `P = M⁻¹ − Y W⁻¹ Yᵀ` with `Y = M⁻¹Jᵀ` and `W = J Y` is what forces make of accelerations
//!    within the loops. Without forces of motors these are `v̇₀ = −P k − Y W⁻¹ J̇v`. With the
//!    factors `M = L Lᵀ` and `W = C Cᵀ`, `Z = L⁻¹Jᵀ`, and for each motor `z = L⁻¹e` and
//!    `w = C⁻¹Zᵀz`, it is `P_ab = z_a·z_b − w_a·w_b`. Likewise `v̇₀_a = z_a·z − w_a·w` with
//!    `z = −L⁻¹k` and `w = C⁻¹(Zᵀz + J̇v)`.
//! 2. Along the joint `j` the loops move like the mass `1/P_jj`. What is beyond the joint counts at
//!    least, as in a tree.
//! 3. The motors carry what holds their joints: `P_AA τ = −v̇₀_A` for the joints `A` that have one.
//!    With more of them than the loops have freedoms `P_AA` has no inverse, and joints that move
//!    cannot all be without acceleration. So `τ` has the least sum of the squares of what is left
//!    of the accelerations and, by [`SHARED_LOAD`], of forces, `(P_AA² + ε²) τ = −P_AA v̇₀_A`, in
//!    units of the diagonal: such motors share their load.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use super::schur::{cholesky, divide, forward, soften};
use crate::model::{ActuatorMode, Model};
use crate::tree::Tree;
use crate::tuning::{LOOP_COMPLIANCE, SHARED_LOAD, SPARE};

/// Mass and load of the motors in loops.
#[derive(Clone, Debug)]
pub struct Felt {
    /// Whether a motor holds a joint, and there is a loop.
    needed: bool,
    /// Of each actuator, kg·m² or kg, and N·m or N; none outside of loops.
    of: Vec<Option<[f64; 2]>>,
    /// Degrees of freedom of the loops, ascending.
    dofs: Vec<usize>,
    /// Actuators that hold joints of loops, and the places of these in `dofs`.
    motors: Vec<(usize, usize)>,
    /// By rows of `n = dofs.len()` numbers.
    L: Vec<f64>,
    /// One row a row of the loops, `n` numbers each.
    Z: Vec<f64>,
    /// By rows of as many numbers as the loops have rows.
    C: Vec<f64>,
    /// `z` and `w` of the motors, one after the other, and last those of `v̇₀`.
    z: Vec<f64>,
    w: Vec<f64>,
    /// `P_AA` in units of its diagonal, the factor of its square, and what makes a force or an
    /// acceleration of a unit.
    P: Vec<f64>,
    square: Vec<f64>,
    scale: Vec<f64>,
    /// `−v̇₀_A`, then `τ`, in these units.
    asked: Vec<f64>,
    loads: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Felt: dofs L Z C z w P square scale asked loads; needed of motors);

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
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let mut motors = model.actuators.iter();
        let needed = !tree.closures.is_empty() && motors.any(|a| a.mode != ActuatorMode::Effort);
        let room = usize::from(needed);
        let nv = room * tree.sparsity.len();
        let (m, k) = (room * Rows::most(tree), room * model.actuators.len());
        Self {
            needed,
            of: vec![None; model.actuators.len()],
            dofs: Vec::with_capacity(nv),
            motors: Vec::with_capacity(k),
            L: Vec::with_capacity(nv * nv),
            Z: Vec::with_capacity(m * nv),
            C: Vec::with_capacity(m * m),
            z: Vec::with_capacity((k + 1) * nv),
            w: Vec::with_capacity((k + 1) * m),
            P: Vec::with_capacity(k * k),
            square: Vec::with_capacity(k * k),
            scale: Vec::with_capacity(k),
            asked: Vec::with_capacity(k),
            loads: Vec::with_capacity(k),
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
        if !self.needed || !tree.is_closed() {
            return;
        }
        self.select(model, tree, acts);
        if !self.motors.is_empty() {
            self.factor(tree, at);
            self.reduce(at);
            self.share(at);
        }
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

    /// `L`, `Z` and `C`.
    fn factor(&mut self, tree: &Tree, at: Carried) {
        let (n, m) = (self.dofs.len(), at.rows.len());
        self.L.clear();
        for dof in &self.dofs {
            let entry = |other: &usize| tree.sparsity.entry(at.M, *dof, *other);
            self.L.extend(self.dofs.iter().map(entry));
        }
        cholesky(&mut self.L, n);
        self.Z.clear();
        self.Z.resize(m * n, 0.0);
        self.C.clear();
        self.C.resize(m * m, 0.0);
        for row in 0..m {
            let (before, z) = self.Z.split_at_mut(row * n);
            let z = &mut z[..n];
            let (dofs, entries) = at.rows.entries(tree, row);
            for (dof, entry) in dofs.iter().zip(entries) {
                z[self.dofs.partition_point(|other| other < dof)] += entry;
            }
            forward(&self.L, n, z);
            let places = &mut self.C[row * m..=row * m + row];
            let others = before.chunks_exact(n).map(|other| dot(other, z));
            for (place, product) in places.iter_mut().zip(others.chain([dot(z, z)])) {
                *place = product;
            }
        }
        soften(&mut self.C, m, LOOP_COMPLIANCE);
        cholesky(&mut self.C, m);
    }

    /// `z` and `w` of the motors and of `v̇₀`.
    fn reduce(&mut self, at: Carried) {
        let (n, m, k) = (self.dofs.len(), at.rows.len(), self.motors.len());
        self.z.clear();
        self.z.resize((k + 1) * n, 0.0);
        self.w.clear();
        self.w.resize((k + 1) * m, 0.0);
        for i in 0..=k {
            let z = &mut self.z[i * n..(i + 1) * n];
            let w = &mut self.w[i * m..(i + 1) * m];
            if let Some((_, place)) = self.motors.get(i) {
                z[*place] = 1.0;
            } else {
                for (z, dof) in z.iter_mut().zip(&self.dofs) {
                    *z = -at.bias[*dof];
                }
                w.copy_from_slice(&at.rows.bias[..m]);
            }
            forward(&self.L, n, z);
            for (w, row) in w.iter_mut().zip(self.Z.chunks_exact(n)) {
                *w += dot(row, z);
            }
            forward(&self.C, m, w);
        }
    }

    /// Masses, and shares of the load.
    fn share(&mut self, at: Carried) {
        let (n, m, k) = (self.dofs.len(), at.rows.len(), self.motors.len());
        let (z, w) = (&self.z, &self.w);
        let z = |i: usize| &z[i * n..(i + 1) * n];
        let w = |i: usize| &w[i * m..(i + 1) * m];
        let product = |a: usize, b: usize| dot(z(a), z(b)) - dot(w(a), w(b));
        self.scale.clear();
        for i in 0..k {
            // What cannot move at all is heavy.
            let mobility = product(i, i).max(SPARE * dot(z(i), z(i)));
            self.scale.push(1.0 / mobility.sqrt());
        }
        self.P.clear();
        self.asked.clear();
        for i in 0..k {
            let scale = &self.scale;
            let along = (0..k).map(|j| product(i, j) * scale[i] * scale[j]);
            self.P.extend(along);
            self.asked.push(-product(i, k) * scale[i]);
        }
        self.square.clear();
        self.loads.clear();
        for (i, row) in self.P.chunks_exact(k).enumerate() {
            let others = self.P.chunks_exact(k).map(|other| dot(row, other));
            self.square.extend(others);
            self.square[i * k + i] += SHARED_LOAD * SHARED_LOAD;
            self.loads.push(dot(row, &self.asked));
        }
        cholesky(&mut self.square, k);
        divide(&self.square, k, &mut self.loads);
        for (i, (index, place)) in self.motors.iter().enumerate() {
            let beyond = 1.0 / at.inverse_diagonal[self.dofs[*place]];
            let mass = (self.scale[i] * self.scale[i]).max(beyond);
            self.of[*index] = Some([mass, self.loads[i] * self.scale[i]]);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
