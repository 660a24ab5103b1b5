//! Solutions for right sides of which most entries are zero.
//!
//! Parts of a pattern do not depend on each other: where a right side is zero but in some of them,
//! the solution is zero but in these. Parts of blocks that contacts or springs couple make up one
//! group; each other part is a group of its own.

use super::coupled::Coupled;
use super::{Block, Part, Sparsity};
use std::ops::Range;

impl Sparsity {
    /// Adds the parts of the next block.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn add_parts(&mut self, rows: Range<usize>, floating: bool) {
        // From the last row up: a part begins where no row so far has an ancestor before it.
        let (mut end, mut lowest, place) = (rows.end, rows.end, self.parts.len());
        for k in rows.rev() {
            lowest = lowest.min(self.column[self.start[k]] as usize);
            if lowest == k {
                let rows = k..end;
                let own = Block { rows, floating };
                let block = self.blocks.len();
                self.parts.insert(place, Part { own, block });
                end = k;
            }
        }
    }

    /// The part of an unknown.
    pub fn part_of(&self, unknown: usize) -> usize {
        let ends = |part: &Part| part.own.rows.end <= unknown;
        self.parts.partition_point(ends)
    }
}

/// A matrix that has been factorised, or a diagonal one that has been inverted.
#[derive(Clone, Copy, Debug)]
pub enum Inverse<'a> {
    /// By [`Sparsity::factor`].
    Packed(&'a Sparsity, &'a [f64]),
    /// By [`Coupled::factor`].
    Coupled(&'a Sparsity, &'a Coupled),
    /// Reciprocals of the diagonal.
    Diagonal(&'a Sparsity, &'a [f64]),
}

impl Inverse<'_> {
    fn pattern(&self) -> &Sparsity {
        match self {
            Self::Packed(pattern, _) | Self::Coupled(pattern, _) | Self::Diagonal(pattern, _) => {
                pattern
            }
        }
    }

    /// The group of a part: its own number, or that of all parts where it is coupled.
    #[inline]
    pub fn group(&self, part: usize) -> usize {
        match self {
            Self::Coupled(pattern, matrix) if matrix.joins(pattern.parts[part].block) => {
                pattern.parts.len()
            }
            _ => part,
        }
    }

    /// Whether a group is that of what is coupled.
    pub fn is_coupled(&self, group: usize) -> bool {
        group == self.pattern().parts.len()
    }

    /// From the first unknown of a group to the last one. Between those of coupled parts there may
    /// be others.
    pub fn span(&self, group: usize) -> Range<usize> {
        match (self, self.pattern().parts.get(group)) {
            (Self::Coupled(_, matrix), None) => matrix.joined_rows(),
            (_, part) => part.map_or(0..0, |part| part.own.rows.clone()),
        }
    }

    /// `x = A⁻¹ x` for the unknowns of a group.
    pub fn solve(&self, group: usize, x: &mut [f64]) {
        let part = self.pattern().parts.get(group);
        match (self, part) {
            (Self::Coupled(_, matrix), None) => matrix.solve_joined(x),
            (Self::Coupled(pattern, matrix), Some(part)) => {
                pattern.solve_block(&part.own, &matrix.packed, x);
            }
            (Self::Packed(pattern, factor), Some(part)) => {
                pattern.solve_block(&part.own, factor, x);
            }
            (Self::Diagonal(_, diagonal), Some(part)) => {
                let rows = part.own.rows.clone();
                for (x, d) in x[rows.clone()].iter_mut().zip(&diagonal[rows]) {
                    *x *= d;
                }
            }
            (Self::Packed(..) | Self::Diagonal(..), None) => {}
        }
    }
}
