//! Cholesky's factor of a symmetric matrix whose rows begin at different columns.
//!
//! A row holds all columns from its first one to the diagonal: factorising fills in nothing before
//! that. What is not there is zero, and products with it are left out, so that all digits are those
//! of the full matrix.

use std::ops::Range;

/// A matrix or its factor `L`, with reciprocals on the diagonal.
#[derive(Clone, Debug, Default)]
pub struct Skyline {
    /// First column of each row.
    first: Vec<usize>,
    /// Where each row begins in `entries`; of the row after the last one, too.
    start: Vec<usize>,
    /// The last row that each column has an entry in.
    last: Vec<usize>,
    entries: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Skyline: first start last entries;);

impl Skyline {
    /// Room for so many rows.
    #[cfg_attr(small, optimize(size))]
    pub fn new(rows: usize) -> Self {
        Self {
            first: Vec::with_capacity(rows),
            start: Vec::with_capacity(rows + 1),
            last: Vec::with_capacity(rows),
            entries: Vec::with_capacity(rows * (rows + 1) / 2),
        }
    }

    /// Leaves no row.
    pub fn clear(&mut self) {
        self.first.clear();
        self.start.clear();
        self.start.push(0);
        self.last.clear();
        self.entries.clear();
    }

    /// How many numbers are kept.
    #[cfg(test)]
    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Adds a row from its column `first` to the diagonal, of zeros; returns it.
    #[inline]
    pub fn add(&mut self, first: usize) -> &mut [f64] {
        let (row, begin) = (self.first.len(), self.entries.len());
        self.first.push(first);
        self.entries.resize(begin + row + 1 - first, 0.0);
        self.start.push(self.entries.len());
        self.last.push(row);
        &mut self.entries[begin..]
    }

    /// Adds a share of the mean diagonal to the diagonal. Where that is 0 it becomes infinite: what
    /// moves nothing has no force.
    pub fn soften(&mut self, share: f64) {
        let diagonal = |i: usize| self.start[i + 1] - 1;
        let trace: f64 = (0..self.len()).map(|i| self.entries[diagonal(i)]).sum();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let more = (share * trace / self.len() as f64).max(f64::MIN_POSITIVE);
        for end in &self.start[1..] {
            let entry = &mut self.entries[end - 1];
            *entry = if *entry > 0.0 {
                *entry + more
            } else {
                f64::INFINITY
            };
        }
    }

    /// Overwrites the matrix by its factor.
    pub fn factor(&mut self) {
        for i in 0..self.len() {
            let first = self.first[i];
            self.last[first..i].fill(i);
            let (above, row) = self.entries.split_at_mut(self.start[i]);
            let row = &mut row[..=i - first];
            for j in first..i {
                let common = first.max(self.first[j]);
                let other = &above[self.start[j] + common - self.first[j]..][..=j - common];
                let mut x = row[j - first];
                for (a, b) in row[common - first..j - first].iter().zip(other) {
                    x -= a * b;
                }
                row[j - first] = x * other[j - common];
            }
            let mut x = row[i - first];
            for a in &row[..i - first] {
                x -= a * a;
            }
            row[i - first] = 1.0 / x.max(f64::MIN_POSITIVE).sqrt();
        }
    }

    /// The rows that depend on no others, with a row; maybe some more of them.
    pub fn block(&self, row: usize) -> Range<usize> {
        let (mut begin, mut end) = (row, row + 1);
        let mut seen = row..row;
        while seen != (begin..end) {
            seen = begin..end;
            for i in seen.clone() {
                begin = begin.min(self.first[i]);
                end = end.max(self.last[i] + 1);
            }
        }
        seen
    }

    /// The least pivot of the factor; infinite where there is no row.
    pub fn least_pivot(&self) -> f64 {
        let roots = self.start[1..].iter().map(|end| self.entries[end - 1]);
        let most = roots.fold(0.0, f64::max);
        1.0 / (most * most)
    }

    /// `x = L⁻¹ x`, the first half of [`Self::divide`].
    pub fn forward(&self, x: &mut [f64]) {
        self.forward_span(0..self.len(), x);
    }

    /// The same where `x` is zero but in a span, and has the entries of that.
    pub fn forward_span(&self, span: Range<usize>, x: &mut [f64]) {
        for (place, i) in span.clone().enumerate() {
            let first = self.first[i].max(span.start);
            let row = &self.entries[self.start[i] + first - self.first[i]..][..=i - first];
            let mut sum = x[place];
            for (w, x) in row.iter().zip(&x[first - span.start..place]) {
                sum -= w * x;
            }
            x[place] = sum * row[i - first];
        }
    }

    /// Divides by the matrix of which [`Self::factor`] has made the factor.
    pub fn divide(&self, x: &mut [f64]) {
        self.forward(x);
        for i in (0..self.len()).rev() {
            let mut sum = x[i];
            for (x, j) in x[i + 1..=self.last[i]].iter().zip(i + 1..) {
                if self.first[j] <= i {
                    sum -= self.entries[self.start[j] + i - self.first[j]] * x;
                }
            }
            x[i] = sum * self.entries[self.start[i + 1] - 1];
        }
    }
}
