//! Pattern of the joint-space matrix, and its factorisation.
//!
//! Row `k` of a symmetric matrix stores its entries at the ancestors of `k` in the elimination
//! tree, root first, then the diagonal. Ancestors of an ancestor are a prefix, so that factor and
//! solve run over contiguous memory, and entry (k, j) lies at `start[k] + depth[j]`. For a tree
//! without mimic joints the elimination tree is the robot's own; a mimic joint couples two branches
//! and only makes the elimination tree deeper there. Trees that do not depend on each other are
//! blocks of consecutive rows, and each block is worked on as if it were alone.
//!
//! Source: Featherstone 2008, section 6.5; elimination trees: Liu 1990.

pub mod coupled;
pub mod inverse;

use crate::spatial::{Vec6, add_scaled6, add6, dot6, multiply_lower};
use std::ops::Range;

/// Entries of a row from which a loop over neighbours costs less than one over columns that are
/// looked up.
const MANY: usize = 14;

/// The pattern of a symmetric matrix under `LᵀDL` factorisation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sparsity {
    /// First entry of each row.
    pub start: Vec<usize>,
    /// Number of off-diagonal entries of each row; the diagonal is at `start + depth`.
    pub depth: Vec<usize>,
    /// Column of every entry.
    pub column: Vec<u32>,
    /// How many of each row's ancestors are the first of its block, one after the other, where they
    /// are many: there no column needs to be looked up.
    pub prefix: Vec<usize>,
    /// Rows that depend on no others.
    pub blocks: Vec<Block>,
    /// The same, as short as they can be: a block has several where its base is mounted.
    pub parts: Vec<Part>,
    /// The blocks that are worked on, by ascending index; of the others nothing is read or written.
    pub worked: Vec<usize>,
}

/// Consecutive rows that depend on no others.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Which.
    pub rows: Range<usize>,
    /// Whether the ancestors of every row begin with the first six, as they do for a floating base.
    pub floating: bool,
}

/// Rows that depend on no others, and the block that they are of.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Which.
    pub own: Block,
    /// Index of the block.
    pub block: usize,
}

impl Sparsity {
    /// The pattern that holds all pairs within each of the `cliques` of the unknowns, each of which
    /// lies within one block; `blocks` are their lengths.
    ///
    /// # Panics
    /// If there are 2^32 unknowns or more.
    #[cfg_attr(small, optimize(size))]
    pub fn new(blocks: &[usize], cliques: &[Vec<usize>]) -> Self {
        let n = blocks.iter().sum();
        let mut coupled = vec![vec![false; n]; n];
        // Only with the highest of each clique, which comes first: eliminating it couples the
        // others.
        for clique in cliques {
            let highest = clique.iter().max();
            for (&i, &j) in highest
                .iter()
                .flat_map(|i| clique.iter().map(move |j| (*i, j)))
            {
                coupled[i][j] = j < i;
            }
        }
        // Eliminating k couples its lower neighbours; the highest of them is its parent.
        let mut parent = vec![None; n];
        for k in (0..n).rev() {
            let row = coupled[k].clone();
            let highest = (0..k).rev().find(|&j| row[j]);
            parent[k] = highest;
            if let Some(p) = highest {
                for j in 0..p {
                    coupled[p][j] |= row[j];
                }
            }
        }
        let mut pattern = Self {
            worked: (0..blocks.len()).collect(),
            ..Self::default()
        };
        let mut first = 0;
        for length in blocks {
            pattern.add_block(first..first + length, &parent);
            first += length;
        }
        pattern
    }

    /// Adds the next block, with the parent of each row.
    fn add_block(&mut self, rows: Range<usize>, parent: &[Option<usize>]) {
        let first = rows.start;
        let mut floating = rows.len() >= 6;
        for k in rows.clone() {
            let mut path = vec![k];
            while let Some(p) = parent[path[path.len() - 1]] {
                path.push(p);
            }
            path.reverse();
            let first_ones = 6.min(k - first + 1);
            let mut begin = path.iter().take(first_ones).zip(first..);
            floating &= path.len() >= first_ones && begin.all(|(j, i)| *j == i);
            let ancestors = &path[..path.len() - 1];
            let prefix = ancestors.iter().zip(first..).take_while(|(c, i)| **c == *i);
            let prefix = prefix.count();
            self.prefix.push(if prefix < MANY { 0 } else { prefix });
            self.start.push(self.column.len());
            self.depth.push(path.len() - 1);
            let columns = path.iter().map(|&j| u32::try_from(j));
            self.column
                .extend(columns.map(|j| j.expect("few unknowns")));
        }
        self.add_parts(rows.clone(), floating);
        self.blocks.push(Block { rows, floating });
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.start.len()
    }

    /// Whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.column.len()
    }

    /// Multiplications of filling and factorising a block, nearly.
    pub fn factor_cost(&self, block: usize) -> usize {
        let rows = self.blocks[block].rows.clone();
        self.depth[rows].iter().map(|d| d * (d + 13) / 2).sum()
    }

    /// The blocks that are worked on.
    fn worked(&self) -> impl Iterator<Item = &Block> + '_ {
        self.worked.iter().map(|block| &self.blocks[*block])
    }

    /// Place of entry (i, j); the pair must be in the pattern.
    #[inline]
    pub fn place(&self, i: usize, j: usize) -> usize {
        self.start[i.max(j)] + self.depth[i.min(j)]
    }

    /// Entry (i, j), 0 outside of the pattern.
    pub fn entry(&self, a: &[f64], i: usize, j: usize) -> f64 {
        let (row, column) = (i.max(j), i.min(j));
        let place = self.place(i, j);
        let is_ancestor = self.depth[column] <= self.depth[row];
        if is_ancestor && self.column[place] as usize == column {
            a[place]
        } else {
            0.0
        }
    }

    /// Place of the diagonal entry of row `k`.
    #[inline]
    pub fn diagonal(&self, k: usize) -> usize {
        self.start[k] + self.depth[k]
    }

    /// `y = A x`.
    pub fn multiply(&self, a: &[f64], x: &[f64], y: &mut [f64]) {
        for block in self.worked() {
            y[block.rows.clone()].fill(0.0);
            self.multiply_block(block, a, x, y);
        }
    }

    #[inline]
    fn multiply_block(&self, block: &Block, a: &[f64], x: &[f64], y: &mut [f64]) {
        if block.floating {
            self.multiply_rows::<6>(&block.rows, a, x, y);
        } else {
            self.multiply_rows::<0>(&block.rows, a, x, y);
        }
    }

    /// The same, where every row's ancestors begin with the first `BASE`.
    fn multiply_rows<const BASE: usize>(
        &self,
        rows: &Range<usize>,
        a: &[f64],
        x: &[f64],
        y: &mut [f64],
    ) {
        let (first, end) = (rows.start, rows.end);
        // What rows beyond the base's add to its six stays in registers.
        let (mut head, mut above) = ([0.0; 6], [0.0; 6]);
        if BASE > 0
            && let Some(x) = x[first..].first_chunk()
        {
            head = *x;
        }
        for k in first + BASE..end {
            let (row, diagonal, columns) = self.row(k, a);
            let xk = x[k];
            let mut sum = diagonal * xk;
            if BASE > 0
                && let Some(r) = row.first_chunk()
            {
                sum += dot6(r, &head);
                add_scaled6(&mut above, r, xk);
            }
            let near = self.prefix[k].max(BASE);
            if near > BASE {
                let beside = first + BASE..first + near;
                let direct = row[BASE..near].iter().zip(&x[beside.clone()]);
                for ((r, x), y) in direct.zip(&mut y[beside]) {
                    sum += r * x;
                    *y += r * xk;
                }
            }
            for (r, &c) in row[near..].iter().zip(&columns[near..]) {
                let c = c as usize;
                sum += r * x[c];
                y[c] += r * xk;
            }
            y[k] += sum;
        }
        if BASE > 0
            && let (Some(lower), Some(y)) = (
                a[self.start[first]..].first_chunk(),
                y[first..].first_chunk_mut(),
            )
        {
            *y = multiply_lower(lower, &head);
            add6(y, &above);
        }
    }

    /// Overwrites `a` by its factor: `D L` below the diagonal and `1/D` on it, with `A = LᵀDL`; no
    /// roots are taken, whose time is that of a whole row. A pivot that round-off has made smaller
    /// than the smallest positive number is replaced by that, so that the direction stays finite.
    pub fn factor(&self, a: &mut [f64]) {
        for block in self.worked() {
            self.factor_block(block, a);
        }
    }

    #[inline]
    fn factor_block(&self, block: &Block, a: &mut [f64]) {
        if block.floating {
            self.factor_rows::<6>(&block.rows, a);
        } else {
            self.factor_rows::<0>(&block.rows, a);
        }
    }

    /// The same, where every row's ancestors begin with the first `BASE`.
    fn factor_rows<const BASE: usize>(&self, rows: &Range<usize>, a: &mut [f64]) {
        let (first, end) = (rows.start, rows.end);
        let own = self.start.get(first).copied().unwrap_or_default();
        for k in (first + BASE..end).rev() {
            let (s, d) = (self.start[k], self.depth[k]);
            let (above, rest) = a.split_at_mut(s);
            let Some((diagonal, row)) = rest[..=d].split_last_mut() else {
                continue;
            };
            let reciprocal = 1.0 / diagonal.max(f64::MIN_POSITIVE);
            *diagonal = reciprocal;
            // A floating base's rows begin with its six.
            if BASE > 0
                && let (Some(lower), Some(r)) = (above[own..].first_chunk_mut(), row.first_chunk())
            {
                subtract_square(lower, r, reciprocal);
            }
            let columns = &self.column[s..s + d];
            for q in BASE..d {
                let factor = row[q] * reciprocal;
                let target = &mut above[self.start[columns[q] as usize]..][..=q];
                if BASE > 0
                    && let (Some(t), Some(r)) = (target.first_chunk_mut(), row.first_chunk())
                {
                    add_scaled6(t, r, -factor);
                }
                subtract_scaled(&mut target[BASE..], &row[BASE..=q], factor);
            }
        }
        if BASE > 0
            && let Some(lower) = a[own..].first_chunk_mut()
        {
            factor_base(lower);
        }
    }

    /// `x = A⁻¹ x` with the factor of [`Self::factor`].
    pub fn solve(&self, factor: &[f64], x: &mut [f64]) {
        for block in self.worked() {
            self.solve_block(block, factor, x);
        }
    }

    #[inline]
    fn solve_block(&self, block: &Block, factor: &[f64], x: &mut [f64]) {
        if block.floating {
            self.solve_rows::<6>(&block.rows, factor, x);
        } else {
            self.solve_rows::<0>(&block.rows, factor, x);
        }
    }

    /// The same, where every row's ancestors begin with the first `BASE`.
    fn solve_rows<const BASE: usize>(&self, rows: &Range<usize>, factor: &[f64], x: &mut [f64]) {
        let (first, end) = (rows.start, rows.end);
        // The base's six stay in registers.
        let mut head = [0.0; 6];
        if BASE > 0
            && let Some(x) = x[first..].first_chunk()
        {
            head = *x;
        }
        for k in (first + BASE..end).rev() {
            let (row, diagonal, columns) = self.row(k, factor);
            let xk = x[k] * diagonal;
            if BASE > 0
                && let Some(r) = row.first_chunk()
            {
                add_scaled6(&mut head, r, -xk);
            }
            let near = self.prefix[k].max(BASE);
            if near > BASE {
                subtract_scaled(&mut x[first + BASE..first + near], &row[BASE..near], xk);
            }
            for (r, &c) in row[near..].iter().zip(&columns[near..]) {
                x[c as usize] -= r * xk;
            }
        }
        if BASE > 0
            && let (Some(lower), Some(x)) = (
                factor[self.start[first]..].first_chunk(),
                x[first..].first_chunk_mut(),
            )
        {
            solve_base(lower, &mut head);
            *x = head;
        }
        for k in first + BASE..end {
            let (row, diagonal, columns) = self.row(k, factor);
            let mut sum = x[k];
            if BASE > 0
                && let Some(r) = row.first_chunk()
            {
                sum -= dot6(r, &head);
            }
            let near = self.prefix[k].max(BASE);
            if near > BASE {
                sum -= dot(&row[BASE..near], &x[first + BASE..first + near]);
            }
            for (r, &c) in row[near..].iter().zip(&columns[near..]) {
                sum -= r * x[c as usize];
            }
            x[k] = sum * diagonal;
        }
    }

    /// The entries of row `k` at its ancestors, the one on the diagonal, and the ancestors.
    #[expect(clippy::inline_always, reason = "a call takes as long as a short row")]
    #[inline(always)]
    fn row<'a>(&'a self, k: usize, a: &'a [f64]) -> (&'a [f64], f64, &'a [u32]) {
        let (s, d) = (self.start[k], self.depth[k]);
        let row = &a[s..][..=d];
        (&row[..d], row[d], &self.column[s..][..d])
    }
}

/// Inner product in two running sums, so that two lanes suffice.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (pairs, others) = (a.chunks_exact(2), b.chunks_exact(2));
    let last = match (pairs.remainder(), others.remainder()) {
        ([a], [b]) => a * b,
        _ => 0.0,
    };
    let (mut even, mut odd) = (0.0, 0.0);
    for (a, b) in pairs.zip(others) {
        even += a[0] * b[0];
        odd += a[1] * b[1];
    }
    even + odd + last
}

/// `A −= r share rᵀ`, lower triangle.
#[inline]
fn subtract_square(lower: &mut [f64; 21], r: &[f64; 6], share: f64) {
    let mut place = 0;
    for i in 0..6 {
        let factor = share * r[i];
        for j in 0..=i {
            lower[place + j] -= factor * r[j];
        }
        place += i + 1;
    }
}

/// `x −= s y`, two lanes at a time.
#[inline]
fn subtract_scaled(x: &mut [f64], y: &[f64], s: f64) {
    let ((pairs, last), (others, rest)) = (x.as_chunks_mut::<2>(), y.as_chunks::<2>());
    for (x, y) in pairs.iter_mut().zip(others) {
        x[0] -= s * y[0];
        x[1] -= s * y[1];
    }
    if let ([x], [y]) = (last, rest) {
        *x -= s * y;
    }
}

/// The first place of row `k` of a lower triangle.
const fn row_start(k: usize) -> usize {
    k * (k + 1) / 2
}

/// The last rows of [`Sparsity::factor`]: those of a floating base.
#[inline]
fn factor_base(lower: &mut [f64; 21]) {
    eliminate::<5>(lower);
    eliminate::<4>(lower);
    eliminate::<3>(lower);
    eliminate::<2>(lower);
    eliminate::<1>(lower);
    eliminate::<0>(lower);
}

/// Row `K`, whose length is known here, of [`factor_base`].
#[inline]
fn eliminate<const K: usize>(lower: &mut [f64; 21]) {
    let start = row_start(K);
    let row: [f64; K] = std::array::from_fn(|i| lower[start + i]);
    let reciprocal = 1.0 / lower[start + K].max(f64::MIN_POSITIVE);
    lower[start + K] = reciprocal;
    for i in 0..K {
        let factor = reciprocal * row[i];
        for j in 0..=i {
            lower[row_start(i) + j] -= factor * row[j];
        }
    }
}

/// The rows of a floating base in [`Sparsity::solve`].
#[inline]
fn solve_base(factor: &[f64; 21], x: &mut Vec6) {
    take_off::<5>(factor, x);
    take_off::<4>(factor, x);
    take_off::<3>(factor, x);
    take_off::<2>(factor, x);
    take_off::<1>(factor, x);
    find::<0>(factor, x);
    find::<1>(factor, x);
    find::<2>(factor, x);
    find::<3>(factor, x);
    find::<4>(factor, x);
    find::<5>(factor, x);
}

/// Takes what row `K`, whose length is known here, says off the rows above it.
#[inline]
fn take_off<const K: usize>(factor: &[f64; 21], x: &mut Vec6) {
    let start = row_start(K);
    let xk = x[K] * factor[start + K];
    for i in 0..K {
        x[i] -= factor[start + i] * xk;
    }
}

/// Finds unknown `K` from those before it.
#[inline]
fn find<const K: usize>(factor: &[f64; 21], x: &mut Vec6) {
    let start = row_start(K);
    let mut sum = x[K];
    for i in 0..K {
        sum -= factor[start + i] * x[i];
    }
    x[K] = sum * factor[start + K];
}

#[cfg(test)]
mod tests;
