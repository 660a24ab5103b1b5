//! The deepest of many places.

/// The deepest of the places that were added, as many as the list has room for, the deepest first;
/// of equally deep ones those that came first. The list is an array within a query, which allocates
/// nothing, and on the heap where it is kept for the next one.
#[derive(Clone, Debug)]
pub(super) struct Deepest<L> {
    list: L,
    count: usize,
}

impl<T: Copy + Default, const MOST: usize> Deepest<[(f64, T); MOST]> {
    pub(super) fn new() -> Self {
        Self {
            list: [(0.0, T::default()); MOST],
            count: 0,
        }
    }
}

impl<T: Copy + Default> Deepest<Box<[(f64, T)]>> {
    /// Room for `most` places on the heap.
    pub(super) fn with_room(most: usize) -> Self {
        Self {
            list: vec![(0.0, T::default()); most].into(),
            count: 0,
        }
    }
}

impl<L> Deepest<L> {
    /// Adds a place that is so deep, m.
    pub(super) fn add<T>(&mut self, depth: f64, place: T)
    where
        L: AsMut<[(f64, T)]>,
    {
        let list = self.list.as_mut();
        let at = list[..self.count].partition_point(|(known, _)| *known >= depth);
        if at < list.len() {
            self.count = (self.count + 1).min(list.len());
            list[at..self.count].rotate_right(1);
            list[at] = (depth, place);
        }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Each with its depth, m, to be put into another order.
    pub(super) fn all<T>(&mut self) -> &mut [(f64, T)]
    where
        L: AsMut<[(f64, T)]>,
    {
        &mut self.list.as_mut()[..self.count]
    }

    /// Each with its depth, m.
    pub(super) fn found<T>(&self) -> &[(f64, T)]
    where
        L: AsRef<[(f64, T)]>,
    {
        &self.list.as_ref()[..self.count]
    }
}
