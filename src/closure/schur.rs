//! The forces of loops: `x = H⁻¹ (r + Jᵀλ)` with `J x = b`.
//!
//! With `Y = H⁻¹ Jᵀ` it is `(J Y) λ = b − J H⁻¹ r`. Where rows are redundant, or vanish for an
//! instant because the mechanism is at a singular place, `J Y` has no inverse: `ε` times its mean
//! diagonal is added to it, so that forces are shared by the least sum of squares.
//!
//! A row of `Y` is zero but at the groups of unknowns that its loop acts on, see
//! [`Inverse::group`], and an entry of `J Y` is zero where two loops have none in common. Neither
//! is computed or kept.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use super::skyline::Skyline;
use crate::sparsity::inverse::Inverse;
use crate::tree::Tree;
use crate::tuning::LOOP_COMPLIANCE;
use std::ops::Range;

/// `Y` and the factor of `J Y`.
#[derive(Clone, Debug)]
pub struct Schur {
    /// `H⁻¹ Jᵀ`, one row a row of `J`, at the spans of its loop.
    Y: Vec<f64>,
    /// The groups of unknowns that each loop acts on, where these are, and how many rows and groups
    /// there are up to the end of each loop.
    groups: Vec<usize>,
    spans: Vec<Range<usize>>,
    ends: Vec<(usize, usize)>,
    /// `J Y`, then its factor.
    W: Skyline,
    /// The first row of each group.
    first: Vec<usize>,
    /// A row of `Y` with all unknowns.
    y: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Schur: Y groups spans ends W first y;);

impl Schur {
    /// Room for all loops of a tree.
    #[cfg_attr(small, optimize(size))]
    pub fn new(tree: &Tree) -> Self {
        let (rows, nv) = (Rows::most(tree), tree.sparsity.len());
        let parts = tree.closures.iter().map(|c| c.parts.len()).sum();
        let groups = tree.sparsity.parts.len() + 1;
        Self {
            Y: Vec::with_capacity(rows * nv),
            groups: Vec::with_capacity(parts),
            spans: Vec::with_capacity(parts),
            ends: Vec::with_capacity(tree.closures.len()),
            W: Skyline::new(rows),
            first: vec![0; if rows > 0 { groups } else { 0 }],
            y: vec![0.0; if rows > 0 { nv } else { 0 }],
        }
    }

    /// Factorises for the matrix `H`.
    pub fn factor(&mut self, tree: &Tree, rows: &Rows, inverse: &Inverse) {
        self.Y.clear();
        self.groups.clear();
        self.spans.clear();
        self.ends.clear();
        self.W.clear();
        if rows.is_empty() {
            return;
        }
        self.find_groups(tree, rows, inverse);
        tree.clear_velocities(&mut self.y);
        let (mut row, mut begin) = (0, 0);
        for (end, last) in &self.ends {
            let (groups, spans) = (&self.groups[begin..*last], &self.spans[begin..*last]);
            let mut first = row;
            for group in groups {
                let own = &mut self.first[*group];
                *own = (*own).min(row);
                first = first.min(*own);
            }
            for row in row..*end {
                rows.add(tree, row, 1.0, &mut self.y);
                for group in groups {
                    inverse.solve(*group, &mut self.y);
                }
                for (entry, other) in self.W.add(first).iter_mut().zip(first..) {
                    *entry = rows.along(tree, other, &self.y);
                }
                for span in spans {
                    let y = &mut self.y[span.clone()];
                    self.Y.extend_from_slice(y);
                    y.fill(0.0);
                }
            }
            (row, begin) = (*end, *last);
        }
        self.W.soften(LOOP_COMPLIANCE);
        self.W.factor();
    }

    /// Finds the groups of each loop and where they are. Coupled unknowns may lie around others: a
    /// loop that acts on such has one span from its first unknown to the last one.
    fn find_groups(&mut self, tree: &Tree, rows: &Rows, inverse: &Inverse) {
        let mut row = 0;
        while row < rows.len() {
            let (index, begin) = (rows.closure_of(row), self.groups.len());
            for part in &tree.closures[index].parts {
                let group = inverse.group(*part);
                if !self.groups[begin..].contains(&group) {
                    self.groups.push(group);
                    self.spans.push(inverse.span(group));
                    self.first[group] = usize::MAX;
                }
            }
            let spans = &mut self.spans[begin..];
            if spans.len() > 1 && self.groups[begin..].iter().any(|g| inverse.is_coupled(*g)) {
                for place in 1..spans.len() {
                    let span = std::mem::take(&mut spans[place]);
                    let all = &mut spans[0];
                    *all = all.start.min(span.start)..all.end.max(span.end);
                }
            }
            while row < rows.len() && rows.closure_of(row) == index {
                row += 1;
            }
            self.ends.push((row, self.groups.len()));
        }
    }

    /// How many numbers are kept.
    #[cfg(test)]
    pub(super) fn entries(&self) -> usize {
        self.Y.len() + self.W.entries()
    }

    /// `λ = (J Y)⁻¹ λ`.
    pub fn solve(&self, forces: &mut [f64]) {
        self.W.divide(forces);
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
        forces.extend((0..self.W.len()).map(|row| asked(row) - rows.along(tree, row, x)));
        self.solve(forces);
        self.push(forces, x);
    }

    /// `x += Y λ`.
    pub fn push(&self, forces: &[f64], x: &mut [f64]) {
        let (mut row, mut first, mut rest) = (0, 0, &self.Y[..]);
        for (end, last) in &self.ends {
            for force in &forces[row..*end] {
                for span in &self.spans[first..*last] {
                    let (own, after) = rest.split_at(span.len());
                    for (x, y) in x[span.clone()].iter_mut().zip(own) {
                        *x += force * y;
                    }
                    rest = after;
                }
            }
            (row, first) = (*end, *last);
        }
    }
}
