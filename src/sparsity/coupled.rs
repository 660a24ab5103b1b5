//! A symmetric matrix of several blocks, some of which contacts couple.
//!
//! Blocks that nothing couples are packed and worked on as [`Sparsity`] says, with the same digits
//! as if they were alone. The rows of coupled blocks are spread out over a lower triangle with a
//! place for each pair of unknowns, of which the factor touches those that are not zero: which ones
//! follows from eliminating the rows from the last to the first, as for [`Sparsity`], but here the
//! fill is exact. Rows of ancestors would couple everything with everything below it: fourteen
//! times the multiplications with ten stacked cubes.
//!
//! Which rows couple is found anew with each matrix and costs little beside its factor; nothing of
//! it outlives one, and nothing is allocated.
//!
//! Source: George & Liu 1981, chapter 5 (symbolic elimination).

use super::Sparsity;
use std::ops::Range;

/// Unknowns whose marks fit into one number.
const WORD: usize = u64::BITS as usize;

/// A symmetric matrix with room for what couples its blocks.
#[derive(Clone, Debug)]
pub struct Coupled {
    /// Entries within blocks, packed as the pattern says.
    pub packed: Vec<f64>,
    /// Lower triangle with a place for every pair; empty where nothing couples.
    spread: Vec<f64>,
    /// Which columns below its diagonal each row has, a bit each, `words` numbers a row.
    marks: Vec<u64>,
    words: usize,
    /// Whether each block is coupled with another one.
    joined: Vec<bool>,
    /// Whether any is.
    any: bool,
    /// Columns of the row that is worked on, as ranges.
    runs: Vec<Range<usize>>,
}

#[cfg(test)]
crate::spoil::spoil!(Coupled: packed spread marks joined any runs; words);

/// First place of a row in the lower triangle.
#[inline]
fn row_start(k: usize) -> usize {
    k * (k + 1) / 2
}

impl Coupled {
    /// Room for a matrix of a pattern, of which contacts couple unknowns or not.
    pub fn new(pattern: &Sparsity, couples: bool) -> Self {
        let n = if couples { pattern.len() } else { 0 };
        let words = n.div_ceil(WORD);
        Self {
            packed: vec![0.0; pattern.entries()],
            spread: vec![0.0; row_start(n)],
            marks: vec![0; n * words],
            words,
            joined: vec![false; pattern.blocks.len()],
            any: false,
            runs: Vec::with_capacity(n),
        }
    }

    /// Begins with blocks that nothing couples.
    pub fn part(&mut self) {
        self.joined.fill(false);
        self.any = false;
    }

    /// Couples the blocks of two unknowns, or those of one block beyond its pattern; their entries
    /// may then be added to. Those within blocks are taken from `packed` when the matrix is
    /// factorised.
    pub fn couple(&mut self, pattern: &Sparsity, unknowns: [usize; 2]) {
        for (block, coupled) in pattern.blocks.iter().zip(&mut self.joined) {
            if !*coupled && unknowns.iter().any(|k| block.rows.contains(k)) {
                *coupled = true;
                for k in block.rows.clone() {
                    self.marks[k * self.words..(k + 1) * self.words].fill(0);
                }
                // What lies within the block, and what others may reach it with.
                let end = row_start(block.rows.end);
                self.spread[row_start(block.rows.start)..end].fill(0.0);
            }
        }
        self.any = true;
    }

    /// Adds to an entry of two unknowns of coupled blocks, and to the one across the diagonal.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = (i.max(j), i.min(j));
        if row == column {
            self.spread[row_start(row) + column] += 2.0 * value;
            return;
        }
        self.marks[row * self.words + column / WORD] |= 1 << (column % WORD);
        self.spread[row_start(row) + column] += value;
    }

    /// Overwrites the matrix by its factor, see [`Sparsity::factor`].
    pub fn factor(&mut self, pattern: &Sparsity) {
        if !self.any {
            pattern.factor(&mut self.packed);
            return;
        }
        for &b in &pattern.worked {
            if !self.joined[b] {
                pattern.factor_block(&pattern.blocks[b], &mut self.packed);
            }
        }
        self.spread_out(pattern);
        self.eliminate(pattern);
        for b in (0..pattern.blocks.len()).rev() {
            if self.joined[b] {
                for k in pattern.blocks[b].rows.clone().rev() {
                    self.factor_row(k);
                }
            }
        }
    }

    /// Adds what lies within coupled blocks to what lies between them.
    fn spread_out(&mut self, pattern: &Sparsity) {
        let coupled = pattern.blocks.iter().zip(&self.joined);
        for (block, _) in coupled.filter(|(_, coupled)| **coupled) {
            for k in block.rows.clone() {
                let own = pattern.start[k]..=pattern.diagonal(k);
                let places = pattern.column[own.clone()].iter().zip(&self.packed[own]);
                let row = &mut self.spread[row_start(k)..];
                let marks = &mut self.marks[k * self.words..];
                for (&column, value) in places {
                    let column = column as usize;
                    row[column] += value;
                    if column < k {
                        marks[column / WORD] |= 1 << (column % WORD);
                    }
                }
            }
        }
    }

    /// Marks what eliminating the rows from the last to the first fills in: the columns of a row
    /// become those of its highest one, too.
    fn eliminate(&mut self, pattern: &Sparsity) {
        let words = self.words;
        let blocks = pattern.blocks.iter().zip(&self.joined).rev();
        for (block, _) in blocks.filter(|(_, coupled)| **coupled) {
            for k in block.rows.clone().rev() {
                let (above, row) = self.marks.split_at_mut(k * words);
                let Some(highest) = highest(&row[..words]) else {
                    continue;
                };
                let parent = &mut above[highest * words..(highest + 1) * words];
                for (p, r) in parent.iter_mut().zip(&row[..words]) {
                    *p |= r;
                }
                parent[highest / WORD] &= !(1 << (highest % WORD));
            }
        }
    }

    /// The columns of a row below its diagonal, as ranges, into `self.runs`.
    fn find_runs(&mut self, k: usize) {
        self.runs.clear();
        let marks = &self.marks[k * self.words..(k + 1) * self.words];
        for (word, first) in marks.iter().zip((0..).step_by(WORD)) {
            let mut rest = *word;
            while rest != 0 {
                let begin = rest.trailing_zeros() as usize;
                let length = (!(rest >> begin)).trailing_zeros() as usize;
                let start = first + begin;
                match self.runs.last_mut() {
                    Some(last) if last.end == start => last.end += length,
                    _ => self.runs.push(start..start + length),
                }
                let end = begin + length;
                rest = if end < WORD { rest >> end << end } else { 0 };
            }
        }
    }

    fn factor_row(&mut self, k: usize) {
        self.find_runs(k);
        let (above, rest) = self.spread.split_at_mut(row_start(k));
        let row = &mut rest[..=k];
        let reciprocal = 1.0 / row[k].max(f64::MIN_POSITIVE);
        row[k] = reciprocal;
        for (place, run) in self.runs.iter().enumerate() {
            for q in run.clone() {
                let factor = row[q] * reciprocal;
                let target = &mut above[row_start(q)..=row_start(q) + q];
                for part in &self.runs[..place] {
                    let own = target[part.clone()].iter_mut();
                    for (t, r) in own.zip(&row[part.clone()]) {
                        *t -= factor * r;
                    }
                }
                let own = target[run.start..=q].iter_mut();
                for (t, r) in own.zip(&row[run.start..=q]) {
                    *t -= factor * r;
                }
            }
        }
    }

    /// `x = A⁻¹ x` with the factor of [`Self::factor`].
    pub fn solve(&self, pattern: &Sparsity, x: &mut [f64]) {
        if !self.any {
            pattern.solve(&self.packed, x);
            return;
        }
        let blocks = || pattern.blocks.iter().zip(&self.joined);
        for &b in &pattern.worked {
            if !self.joined[b] {
                pattern.solve_block(&pattern.blocks[b], &self.packed, x);
            }
        }
        let coupled = || blocks().filter(|(_, coupled)| **coupled);
        for (block, _) in coupled().rev() {
            for k in block.rows.clone().rev() {
                let row = &self.spread[row_start(k)..=row_start(k) + k];
                let xk = x[k] * row[k];
                self.for_columns(k, |c| x[c] -= row[c] * xk);
            }
        }
        for (block, _) in coupled() {
            for k in block.rows.clone() {
                let row = &self.spread[row_start(k)..=row_start(k) + k];
                let mut sum = x[k];
                self.for_columns(k, |c| sum -= row[c] * x[c]);
                x[k] = sum * row[k];
            }
        }
    }

    /// `y = A x` of a matrix that is not factorised yet.
    #[cfg(test)]
    pub(crate) fn multiply(&self, pattern: &Sparsity, x: &[f64], y: &mut [f64]) {
        pattern.multiply(&self.packed, x, y);
        let blocks = pattern.blocks.iter().zip(&self.joined);
        for (block, _) in blocks.filter(|(_, coupled)| **coupled) {
            for k in block.rows.clone() {
                y[k] += self.spread[row_start(k) + k] * x[k];
                self.for_columns(k, |c| {
                    let value = self.spread[row_start(k) + c];
                    y[k] += value * x[c];
                    y[c] += value * x[k];
                });
            }
        }
    }

    /// Calls `take` with each column of a row below its diagonal, the lowest first.
    #[inline]
    fn for_columns(&self, k: usize, mut take: impl FnMut(usize)) {
        let marks = &self.marks[k * self.words..(k + 1) * self.words];
        for (word, first) in marks.iter().zip((0..).step_by(WORD)) {
            let mut rest = *word;
            while rest != 0 {
                take(first + rest.trailing_zeros() as usize);
                rest &= rest - 1;
            }
        }
    }
}

/// The highest column that is marked.
fn highest(marks: &[u64]) -> Option<usize> {
    let (place, word) = marks
        .iter()
        .enumerate()
        .rev()
        .find(|(_, word)| **word != 0)?;
    Some(place * WORD + WORD - 1 - word.leading_zeros() as usize)
}

#[cfg(test)]
#[allow(clippy::cast_precision_loss, reason = "small counts")]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Blocks of the lengths, full within, coupled by `pairs` of unknowns; the matrix, and the same
    /// written out in full.
    fn matrix(lengths: &[usize], pairs: &[[usize; 2]]) -> (Sparsity, Coupled, DMatrix<f64>) {
        let mut first = 0;
        let cliques = lengths.iter().map(|length| {
            first += length;
            (first - length..first).collect()
        });
        let cliques: Vec<Vec<usize>> = cliques.collect();
        let pattern = Sparsity::new(lengths, &cliques);
        let n = pattern.len();
        let mut m = DMatrix::zeros(n, n);
        let mut coupled = Coupled::new(&pattern, true);
        for k in 0..n {
            for q in 0..=pattern.depth[k] {
                let j = pattern.column[pattern.start[k] + q] as usize;
                let own = if j == k { 40.0 } else { 0.0 };
                let value = own + libm::sin(1.0 + 3.7 * (k * n + j) as f64);
                coupled.packed[pattern.start[k] + q] = value;
                (m[(k, j)], m[(j, k)]) = (value, value);
            }
        }
        coupled.part();
        for pair in pairs {
            coupled.couple(&pattern, *pair);
        }
        for (p, [i, j]) in pairs.iter().enumerate() {
            let value = libm::cos(p as f64);
            coupled.add(*i, *j, value);
            m[(*i, *j)] += value;
            m[(*j, *i)] += value;
        }
        (pattern, coupled, m)
    }

    fn check(lengths: &[usize], pairs: &[[usize; 2]]) {
        let (pattern, mut coupled, m) = matrix(lengths, pairs);
        let expected: Vec<f64> = (0..pattern.len()).map(|i| libm::cos(i as f64)).collect();
        let right = m * DVector::from_vec(expected.clone());
        coupled.factor(&pattern);
        let mut x: Vec<f64> = right.iter().copied().collect();
        coupled.solve(&pattern, &mut x);
        for (x, e) in x.iter().zip(&expected) {
            assert!((x - e).abs() < 1e-12, "{x} {e}");
        }
    }

    #[test]
    fn coupled_blocks_factor_and_solve() {
        check(&[6, 6], &[[2, 9]]);
        check(&[7, 3, 6, 2], &[[1, 9], [8, 12], [12, 0], [12, 0], [17, 6]]);
        // More than fit into one word, with a block that stays alone.
        let chain: Vec<[usize; 2]> = (0..29).map(|i| [6 * i + i % 5, 6 * i + 8]).collect();
        check(&[6; 31], &chain);
    }

    #[test]
    fn blocks_that_nothing_couples_have_the_digits_that_they_have_alone() {
        let (pattern, mut coupled, _) = matrix(&[6, 9, 6], &[[3, 17]]);
        let (alone, mut own, _) = matrix(&[6, 9, 6], &[]);
        coupled.factor(&pattern);
        own.factor(&alone);
        let (mut x, mut y) = (vec![1.0; 21], vec![1.0; 21]);
        coupled.solve(&pattern, &mut x);
        own.solve(&alone, &mut y);
        assert_eq!(x[6..15], y[6..15]);
        assert!(x[..6] != y[..6]);
    }

    #[test]
    fn nothing_of_an_earlier_coupling_is_left() {
        let (pattern, mut coupled, _) = matrix(&[6, 6, 6], &[[3, 17], [2, 9]]);
        coupled.factor(&pattern);
        let (_, fresh, m) = matrix(&[6, 6, 6], &[[0, 7]]);
        coupled.packed.copy_from_slice(&fresh.packed);
        coupled.part();
        coupled.couple(&pattern, [0, 7]);
        coupled.add(0, 7, 1.0);
        coupled.factor(&pattern);
        let mut x: Vec<f64> = (m * DVector::from_element(18, 1.0))
            .iter()
            .copied()
            .collect();
        coupled.solve(&pattern, &mut x);
        assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-12));
    }

    #[test]
    fn the_fill_of_a_pile_is_exact() {
        // Ten bodies one upon the other: each row reaches its own block and the one below.
        let chain: Vec<[usize; 2]> = (0..9)
            .flat_map(|i| (0..36).map(move |p| [6 * i + p / 6, 6 * i + 6 + p % 6]))
            .collect();
        let (pattern, mut coupled, _) = matrix(&[6; 10], &chain);
        coupled.factor(&pattern);
        let mut cost = 0;
        for k in 0..pattern.len() {
            coupled.find_runs(k);
            let d: usize = coupled.runs.iter().map(Range::len).sum();
            assert!(d < 12);
            cost += d * (d + 1) / 2;
        }
        // Rows of 6 … 11 entries in nine of the blocks, of 0 … 5 in the lowest.
        assert_eq!(cost, 9 * (21 + 28 + 36 + 45 + 55 + 66) + 35);
    }
}
