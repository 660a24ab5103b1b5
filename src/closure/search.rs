//! Pivots of the search for redundant rows of loops, of which only what is not zero is worked on.

use super::skyline::Skyline;

/// Rows whose marks fit into one number.
pub(super) const WORD: usize = u64::BITS as usize;

/// Scratch of the search.
#[derive(Clone, Debug, Default)]
pub(super) struct Search {
    /// What is left of `J D² Jᵀ` for rows that are open, a lower triangle by rows of as many
    /// numbers as there are rows; without its diagonal, and only where there is a mark.
    pub left: Vec<f64>,
    /// Which other open rows each row has an entry with, a bit each.
    pub marks: Vec<u64>,
    /// The diagonal; minus infinity where a row is kept.
    pub pivots: Vec<f64>,
    /// The open rows that the one that is kept has entries with, and these.
    pub near: Vec<usize>,
    pub along: Vec<f64>,
    /// `J D² Jᵀ` of the rows that `near` lists, and its factor, in the order of the rows.
    pub factor: Skyline,
}

#[cfg(test)]
crate::spoil::spoil!(Search: left marks pivots near along factor;);

impl Search {
    /// Room for so many rows.
    pub fn new(rows: usize) -> Self {
        Self {
            left: vec![0.0; rows * rows],
            marks: vec![0; rows * rows.div_ceil(WORD)],
            pivots: Vec::with_capacity(rows),
            near: Vec::with_capacity(rows),
            along: Vec::with_capacity(rows),
            factor: Skyline::new(rows),
        }
    }

    /// Takes a row that is kept out of what is left of the others.
    pub fn keep(&mut self, row: usize) {
        let (m, reciprocal) = (self.pivots.len(), 1.0 / self.pivots[row]);
        let words = m.div_ceil(WORD);
        self.pivots[row] = f64::NEG_INFINITY;
        self.near.clear();
        self.along.clear();
        for place in 0..words {
            for_marks(self.marks[row * words + place], place, |other| {
                let entry = self.left[row.max(other) * m + row.min(other)];
                self.near.push(other);
                self.along.push(entry);
            });
        }
        for (i, a) in self.near.iter().enumerate() {
            let left = &mut self.left[a * m..(a + 1) * m];
            let share = self.along[i] * reciprocal;
            for place in 0..words {
                let all = self.marks[row * words + place];
                let own = &mut self.marks[a * words + place];
                for_marks(all & !*own, place, |b| left[b] = 0.0);
                *own |= all;
            }
            for mark in [row, *a] {
                self.marks[a * words + mark / WORD] &= !(1 << (mark % WORD));
            }
            for (b, x) in self.near[..i].iter().zip(&self.along) {
                left[*b] -= share * x;
            }
            self.pivots[*a] -= share * self.along[i];
        }
    }
}

/// Calls `take` with the row of each mark of the number at `place`.
#[inline]
fn for_marks(mut marks: u64, place: usize, mut take: impl FnMut(usize)) {
    while marks != 0 {
        take(place * WORD + marks.trailing_zeros() as usize);
        marks &= marks - 1;
    }
}
