//! The deepest of many places.

/// The `MOST` deepest of the places that were added, the deepest first; of equally deep ones those
/// that came first.
#[derive(Clone, Debug)]
pub(super) struct Deepest<T, const MOST: usize> {
    list: [(f64, T); MOST],
    count: usize,
}

impl<T: Copy + Default, const MOST: usize> Deepest<T, MOST> {
    pub(super) fn new() -> Self {
        Self {
            list: [(0.0, T::default()); MOST],
            count: 0,
        }
    }

    /// Adds a place that is so deep, m.
    pub(super) fn add(&mut self, depth: f64, place: T) {
        let at = self.list[..self.count].partition_point(|(known, _)| *known >= depth);
        if at < MOST {
            self.count = (self.count + 1).min(MOST);
            self.list[at..self.count].rotate_right(1);
            self.list[at] = (depth, place);
        }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Each with its depth, m, to be put into another order.
    pub(super) fn all(&mut self) -> &mut [(f64, T)] {
        &mut self.list[..self.count]
    }

    /// Each with its depth, m.
    pub(super) fn found(&self) -> &[(f64, T)] {
        &self.list[..self.count]
    }
}
