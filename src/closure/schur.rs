//! The forces of loops: `x = H⁻¹ (r + Jᵀλ)` with `J x = b`.
//!
//! With `Y = H⁻¹ Jᵀ` it is `(J Y) λ = b − J H⁻¹ r`. Where rows are redundant, or vanish for an
//! instant because the mechanism is at a singular place, `J Y` has no inverse: `ε` times its mean
//! diagonal is added to it, so that forces are shared by the least sum of squares.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use crate::tree::Tree;
use crate::tuning::LOOP_COMPLIANCE;

/// `Y` and the factor of `J Y`.
#[derive(Clone, Debug)]
pub struct Schur {
    /// `H⁻¹ Jᵀ`, one row a row of `J`, `nv` numbers each.
    Y: Vec<f64>,
    /// Lower triangle of the factor, by rows of `count`; reciprocals on the diagonal.
    W: Vec<f64>,
    count: usize,
    nv: usize,
}

#[cfg(test)]
crate::spoil::spoil!(Schur: Y W count; nv);

impl Schur {
    /// Room for all loops of a tree.
    pub fn new(tree: &Tree) -> Self {
        let (rows, nv) = (Rows::most(tree), tree.sparsity.len());
        Self {
            Y: Vec::with_capacity(rows * nv),
            W: Vec::with_capacity(rows * rows),
            count: 0,
            nv,
        }
    }

    /// Factorises for the matrix `H`, which `solve` divides by.
    pub fn factor(&mut self, tree: &Tree, rows: &Rows, solve: impl Fn(&mut [f64])) {
        let (m, nv) = (rows.len(), self.nv);
        self.count = m;
        self.Y.clear();
        self.Y.resize(m * nv, 0.0);
        self.W.clear();
        self.W.resize(m * m, 0.0);
        if m == 0 {
            return;
        }
        for (row, y) in self.Y.chunks_exact_mut(nv).enumerate() {
            rows.add(tree, row, 1.0, y);
            solve(y);
            for other in 0..=row {
                self.W[row * m + other] = rows.along(tree, other, y);
            }
        }
        soften(&mut self.W, m, LOOP_COMPLIANCE);
        cholesky(&mut self.W, m);
    }

    /// `λ = (J Y)⁻¹ λ`.
    pub fn solve(&self, forces: &mut [f64]) {
        divide(&self.W, self.count, forces);
    }

    /// Makes `x = H⁻¹ r` that with the forces of loops, `J x = b`; these stand in `forces` then.
    ///
    /// - `asked`: `b` of each row
    pub fn close(
        &self,
        (tree, rows): (&Tree, &Rows),
        asked: impl Fn(usize) -> f64,
        x: &mut [f64],
        forces: &mut Vec<f64>,
    ) {
        forces.clear();
        forces.extend((0..self.count).map(|row| asked(row) - rows.along(tree, row, x)));
        self.solve(forces);
        self.push(forces, x);
    }

    /// `x += Y λ`.
    pub fn push(&self, forces: &[f64], x: &mut [f64]) {
        if forces.is_empty() {
            return;
        }
        for (y, force) in self.Y.chunks_exact(self.nv).zip(forces) {
            for (x, y) in x.iter_mut().zip(y) {
                *x += force * y;
            }
        }
    }
}

/// Adds a share of the mean diagonal to the diagonal of a matrix by rows of `m`.
pub(super) fn soften(W: &mut [f64], m: usize, share: f64) {
    let trace: f64 = (0..m).map(|i| W[i * m + i]).sum();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let more = (share * trace / m as f64).max(f64::MIN_POSITIVE);
    for i in 0..m {
        W[i * m + i] += more;
    }
}

/// Divides by the factor `W` that [`cholesky`] has made, the first half of [`divide`].
pub(super) fn forward(W: &[f64], m: usize, x: &mut [f64]) {
    for i in 0..m {
        let mut sum = x[i];
        for (w, x) in W[i * m..].iter().zip(&x[..i]) {
            sum -= w * x;
        }
        x[i] = sum * W[i * m + i];
    }
}

/// Divides by the matrix of which [`cholesky`] has made the factor `W`.
pub(super) fn divide(W: &[f64], m: usize, x: &mut [f64]) {
    forward(W, m, x);
    for i in (0..m).rev() {
        let mut sum = x[i];
        for (j, x) in x.iter().enumerate().skip(i + 1) {
            sum -= W[j * m + i] * x;
        }
        x[i] = sum * W[i * m + i];
    }
}

/// Overwrites a symmetric matrix by its factor `L`, with reciprocals on the diagonal.
pub(super) fn cholesky(W: &mut [f64], m: usize) {
    for i in 0..m {
        for j in 0..=i {
            let mut x = W[i * m + j];
            for k in 0..j {
                x -= W[i * m + k] * W[j * m + k];
            }
            if i == j {
                W[i * m + i] = 1.0 / x.max(f64::MIN_POSITIVE).sqrt();
            } else {
                W[i * m + j] = x * W[j * m + j];
            }
        }
    }
}
