//! The factors of the Hessian `H` and, for the rows `J` of closed loops, of `J H⁻¹ Jᵀ`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::{Rows, Schur};
use crate::sparsity::coupled::Coupled;
use crate::sparsity::inverse::Inverse;
use crate::tree::Tree;

/// `H`, or its factor and that of `J H⁻¹ Jᵀ`.
#[derive(Clone, Debug)]
pub struct Factor {
    /// `H`, or its factor.
    pub(super) H: Coupled,
    /// The factor of `J H⁻¹ Jᵀ`.
    pub(super) closed: Schur,
}

#[cfg(test)]
crate::spoil::spoil!(Factor: H closed;);

impl Factor {
    /// Room for a tree's matrix.
    pub(super) fn new(tree: &Tree) -> Self {
        Self {
            H: Coupled::new(&tree.sparsity, tree.has_cross_terms()),
            closed: Schur::new(tree),
        }
    }

    /// Overwrites `H` by its factor.
    pub(super) fn factor(&mut self, tree: &Tree, rows: &Rows) {
        let Self { H, closed } = self;
        H.factor(&tree.sparsity);
        if !rows.is_empty() {
            closed.factor(tree, rows, &Inverse::Coupled(&tree.sparsity, H));
        }
    }

    /// The inverse of `H`, once it is factorised.
    pub fn inverse<'a>(&'a self, tree: &'a Tree) -> Inverse<'a> {
        Inverse::Coupled(&tree.sparsity, &self.H)
    }

    /// `x = H⁻¹ (x + Jᵀλ)` with `J x = 0`; `λ` then stands in `forces`.
    pub fn solve(&self, (tree, rows): (&Tree, &Rows), x: &mut [f64], forces: &mut Vec<f64>) {
        self.H.solve(&tree.sparsity, x);
        if !rows.is_empty() {
            self.closed.close((tree, rows), |_| 0.0, x, forces);
        }
    }
}
