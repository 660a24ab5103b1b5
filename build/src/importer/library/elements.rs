//! Elements of FMI 3's arrays, read and set one by one, although FMI reads and sets whole arrays.

use std::collections::{BTreeMap, BTreeSet};

/// A variable, or an element of an array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Of the whole.
    pub value_reference: u32,
    /// Place in the array; 0 for a scalar.
    pub index: u32,
    /// Number of the array's elements; 1 for a scalar.
    pub count: u32,
}

/// The arrays that some elements are of, each once.
pub(super) struct Wholes {
    /// In the order of their first elements.
    pub references: Vec<u32>,
    /// Number of all their elements.
    pub len: usize,
    /// Place of each element asked for among them.
    pub places: Vec<usize>,
}

impl Wholes {
    /// Those of the elements with these numbers.
    pub fn of(elements: &[Element], numbers: &[u32]) -> Self {
        let (mut references, mut len) = (Vec::new(), 0);
        let mut begins = BTreeMap::new();
        let mut places = Vec::with_capacity(numbers.len());
        for number in numbers {
            let element = elements.get(*number as usize).copied().unwrap_or_default();
            let begin = *begins.entry(element.value_reference).or_insert_with(|| {
                references.push(element.value_reference);
                len += element.count as usize;
                len - element.count as usize
            });
            places.push(begin + element.index as usize);
        }
        Self {
            references,
            len,
            places,
        }
    }

    /// Whether all elements of all arrays are asked for.
    pub fn is_whole(&self) -> bool {
        let places: BTreeSet<_> = self.places.iter().collect();
        places.len() == self.len
    }
}
