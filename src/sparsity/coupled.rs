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

/// Most rows that are eliminated together: those of a free body.
const GROUP: usize = 6;

/// Calls a function of a group for its number of rows, which is known to the function.
macro_rules! by_length {
    ($length:expr, $self:ident.$function:ident, ($($argument:expr),*)) => {
        match $length {
            6 => $self.$function::<6>($($argument),*),
            5 => $self.$function::<5>($($argument),*),
            4 => $self.$function::<4>($($argument),*),
            3 => $self.$function::<3>($($argument),*),
            2 => $self.$function::<2>($($argument),*),
            _ => $self.$function::<1>($($argument),*),
        }
    };
}

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
    /// Rows that have been eliminated together, the last ones first.
    groups: Vec<Range<usize>>,
}

#[cfg(test)]
crate::spoil::spoil!(Coupled: packed spread marks joined any runs groups; words);

/// First place of a row in the lower triangle.
#[inline]
fn row_start(k: usize) -> usize {
    k * (k + 1) / 2
}

impl Coupled {
    /// Room for a matrix of a pattern, of which contacts couple unknowns or not.
    #[cfg_attr(small, optimize(size))]
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
            groups: Vec::with_capacity(n),
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
        for unknown in unknowns {
            let blocks = &pattern.blocks;
            let b = blocks.partition_point(|block| block.rows.end <= unknown);
            if std::mem::replace(&mut self.joined[b], true) {
                continue;
            }
            for k in blocks[b].rows.clone() {
                self.marks[k * self.words..(k + 1) * self.words].fill(0);
                self.spread[row_start(k) + k] = 0.0;
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
        self.put(row, column, value);
    }

    /// Adds to an entry below the diagonal. What has no mark yet holds what an earlier matrix has
    /// left there.
    #[inline]
    fn put(&mut self, row: usize, column: usize, value: f64) {
        let (marks, mark) = (
            &mut self.marks[row * self.words + column / WORD],
            1 << (column % WORD),
        );
        let entry = &mut self.spread[row_start(row) + column];
        let before = if *marks & mark == 0 { 0.0 } else { *entry };
        *marks |= mark;
        *entry = before + value;
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
        self.groups.clear();
        for b in (0..pattern.blocks.len()).rev() {
            let rows = &pattern.blocks[b].rows;
            let mut end = if self.joined[b] { rows.end } else { rows.start };
            while end > rows.start {
                let first = self.group(rows.start, end);
                self.find_runs(first);
                by_length!(end - first, self.factor_group, (first));
                self.groups.push(first..end);
                end = first;
            }
        }
    }

    /// Adds what lies within coupled blocks to what lies between them.
    fn spread_out(&mut self, pattern: &Sparsity) {
        for (b, block) in pattern.blocks.iter().enumerate() {
            if !self.joined[b] {
                continue;
            }
            for k in block.rows.clone() {
                let (start, diagonal) = (pattern.start[k], pattern.diagonal(k));
                for place in start..diagonal {
                    self.put(k, pattern.column[place] as usize, self.packed[place]);
                }
                self.spread[row_start(k) + k] += self.packed[diagonal];
            }
        }
    }

    /// Marks what eliminating the rows from the last to the first fills in, and sets it to zero:
    /// the columns of a row become those of its highest one, too.
    fn eliminate(&mut self, pattern: &Sparsity) {
        let words = self.words;
        let blocks = pattern.blocks.iter().zip(&self.joined).rev();
        for (block, _) in blocks.filter(|(_, coupled)| **coupled) {
            for k in block.rows.clone().rev() {
                let (above, row) = self.marks.split_at_mut(k * words);
                let row = &row[..words];
                let Some(highest) = highest(row) else {
                    continue;
                };
                let parent = &mut above[highest * words..(highest + 1) * words];
                let entries = &mut self.spread[row_start(highest)..];
                for (place, (p, r)) in parent.iter_mut().zip(row).enumerate() {
                    let filled = r & !mark_in(place, highest) & !*p;
                    *p |= filled;
                    for_marks(filled, place * WORD, |column| entries[column] = 0.0);
                }
            }
        }
    }

    /// The columns of a row below its diagonal, as ranges, into `self.runs`.
    fn find_runs(&mut self, k: usize) {
        let mut runs = std::mem::take(&mut self.runs);
        runs.clear();
        self.for_runs(k, |run| match runs.last_mut() {
            Some(last) if last.end == run.start => last.end = run.end,
            _ => runs.push(run),
        });
        self.runs = runs;
    }

    /// Calls `take` with the columns of a row below its diagonal, as ranges, the lowest first; one
    /// that goes over a multiple of [`WORD`] comes in parts.
    #[inline]
    fn for_runs(&self, k: usize, mut take: impl FnMut(Range<usize>)) {
        let marks = &self.marks[k * self.words..(k + 1) * self.words];
        for (word, first) in marks.iter().zip((0..).step_by(WORD)) {
            let mut rest = *word;
            while rest != 0 {
                let begin = rest.trailing_zeros() as usize;
                let length = (!(rest >> begin)).trailing_zeros() as usize;
                take(first + begin..first + begin + length);
                let end = begin + length;
                rest = if end < WORD { rest >> end << end } else { 0 };
            }
        }
    }

    /// First row of the group that ends before `end`: neighbours in a block that begins at `begin`
    /// that have the same columns but for themselves, as the rows of a free body do.
    fn group(&self, begin: usize, end: usize) -> usize {
        let mut first = end - 1;
        while first > begin && end - first < GROUP && self.is_alike(first) {
            first -= 1;
        }
        first
    }

    /// Whether a row has the columns of the one before it, and that one.
    fn is_alike(&self, k: usize) -> bool {
        let (above, row) = self.marks.split_at(k * self.words);
        let before = &above[(k - 1) * self.words..];
        let mut words = row[..self.words].iter().zip(before).enumerate();
        words.all(|(place, (r, b))| *r == b | mark_in(place, k - 1))
    }

    /// Eliminates the `N` rows from `first` on, which have the columns `self.runs` besides
    /// themselves. A place of another row is read and written once for all of them, and from the
    /// last to the first, so that it gets the digits that it gets from one after the other.
    fn factor_group<const N: usize>(&mut self, first: usize) {
        let (above, own) = self.spread.split_at_mut(row_start(first));
        let mut reciprocals = [0.0; N];
        for g in (0..N).rev() {
            let k = first + g;
            let (before, row) = own.split_at_mut(row_start(k) - row_start(first));
            let reciprocal = 1.0 / row[k].max(f64::MIN_POSITIVE);
            (row[k], reciprocals[g]) = (reciprocal, reciprocal);
            for q in first..k {
                let factor = row[q] * reciprocal;
                let target = &mut before[row_start(q) - row_start(first)..][..=q];
                for run in &self.runs {
                    subtract([&row[run.clone()]], [factor], &mut target[run.clone()]);
                }
                subtract([&row[first..=q]], [factor], &mut target[first..=q]);
            }
        }
        let rows: [&[f64]; N] = std::array::from_fn(|g| {
            let start = row_start(first + g) - row_start(first);
            &own[start..start + first]
        });
        for (place, run) in self.runs.iter().enumerate() {
            for q in run.clone() {
                let factors = std::array::from_fn(|g| rows[g][q] * reciprocals[g]);
                let target = &mut above[row_start(q)..=row_start(q) + q];
                for part in &self.runs[..place] {
                    let of = rows.map(|row| &row[part.clone()]);
                    subtract(of, factors, &mut target[part.clone()]);
                }
                let of = rows.map(|row| &row[run.start..=q]);
                subtract(of, factors, &mut target[run.start..=q]);
            }
        }
    }

    /// `x = A⁻¹ x` with the factor of [`Self::factor`].
    pub fn solve(&self, pattern: &Sparsity, x: &mut [f64]) {
        if !self.any {
            pattern.solve(&self.packed, x);
            return;
        }
        for &b in &pattern.worked {
            if !self.joined[b] {
                pattern.solve_block(&pattern.blocks[b], &self.packed, x);
            }
        }
        self.solve_joined(x);
    }

    /// Whether a block is coupled with another one.
    #[inline]
    pub(super) fn joins(&self, block: usize) -> bool {
        self.any && self.joined[block]
    }

    /// From the first unknown of coupled blocks to the last one.
    pub(super) fn joined_rows(&self) -> Range<usize> {
        match (self.groups.last(), self.groups.first()) {
            (Some(first), Some(last)) => first.start..last.end,
            _ => 0..0,
        }
    }

    /// [`Self::solve`] for the unknowns of coupled blocks alone.
    pub(super) fn solve_joined(&self, x: &mut [f64]) {
        for group in &self.groups {
            by_length!(group.len(), self.take_off_group, (group.start, x));
        }
        for group in self.groups.iter().rev() {
            by_length!(group.len(), self.find_group, (group.start, x));
        }
    }

    /// The `N` rows from `first` on, each up to its diagonal.
    #[inline]
    fn rows<const N: usize>(&self, first: usize) -> [&[f64]; N] {
        std::array::from_fn(|g| &self.spread[row_start(first + g)..][..=first + g])
    }

    /// Takes what the unknowns of a group say off those above them.
    fn take_off_group<const N: usize>(&self, first: usize, x: &mut [f64]) {
        let (rows, mut own) = (self.rows::<N>(first), [0.0; N]);
        for g in (0..N).rev() {
            own[g] = x[first + g] * rows[g][first + g];
            for q in 0..g {
                x[first + q] -= rows[g][first + q] * own[g];
            }
        }
        self.for_runs(first, |run| {
            subtract(rows.map(|row| &row[run.clone()]), own, &mut x[run]);
        });
    }

    /// Finds the unknowns of a group from those above them.
    fn find_group<const N: usize>(&self, first: usize, x: &mut [f64]) {
        let rows = self.rows::<N>(first);
        let mut sums: [f64; N] = std::array::from_fn(|g| x[first + g]);
        self.for_runs(first, |run| {
            let of = rows.map(|row| &row[run.clone()]);
            for (i, x) in x[run].iter().enumerate() {
                for (sum, row) in sums.iter_mut().zip(&of) {
                    *sum -= row[i] * x;
                }
            }
        });
        for g in 0..N {
            for q in 0..g {
                sums[g] -= rows[g][first + q] * x[first + q];
            }
            x[first + g] = sums[g] * rows[g][first + g];
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
                self.for_runs(k, |run| {
                    for c in run {
                        let value = self.spread[row_start(k) + c];
                        y[k] += value * x[c];
                        y[c] += value * x[k];
                    }
                });
            }
        }
    }
}

/// The mark of a column in a row's number at `place`, 0 in the others.
#[inline]
fn mark_in(place: usize, column: usize) -> u64 {
    u64::from(place == column / WORD) << (column % WORD)
}

/// Calls `take` with the place of each mark of a word that begins at `first`.
#[inline]
fn for_marks(word: u64, first: usize, mut take: impl FnMut(usize)) {
    let mut rest = word;
    while rest != 0 {
        take(first + rest.trailing_zeros() as usize);
        rest &= rest - 1;
    }
}

/// Takes multiples of `rows` off `target`, those of the last row first.
#[inline]
fn subtract<const N: usize>(rows: [&[f64]; N], factors: [f64; N], target: &mut [f64]) {
    let n = target.len();
    let rows = rows.map(|row| &row[..n]);
    for (i, t) in target.iter_mut().enumerate() {
        let mut value = *t;
        for g in (0..N).rev() {
            value -= factors[g] * rows[g][i];
        }
        *t = value;
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
mod tests;
