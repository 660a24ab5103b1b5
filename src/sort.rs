//! Sorting of lists that are short or sorted once.
//!
//! The standard library's sorts are fast for long lists and take 6 kB of code for each type and
//! order that is sorted; these take a tenth of that. What they give is the same, because both keep
//! the order of equal elements.

/// Sorts a list of a few elements in place.
pub fn short<T>(list: &mut [T], before: impl Fn(&T, &T) -> bool) {
    for end in 1..list.len() {
        let mut place = end;
        while place > 0 && before(&list[place], &list[place - 1]) {
            list.swap(place, place - 1);
            place -= 1;
        }
    }
}

/// Sorts a list of any length, with as much memory again.
pub fn once<T: Copy>(list: &mut [T], before: impl Fn(&T, &T) -> bool) {
    let mut merged = list.to_vec();
    let mut run = 1;
    while run < list.len() {
        let both = list.chunks(2 * run).zip(merged.chunks_mut(2 * run));
        for (from, into) in both {
            let (mut first, mut second) = from.split_at(run.min(from.len()));
            for place in into {
                let of = match (first.first(), second.first()) {
                    (Some(a), Some(b)) if before(b, a) => &mut second,
                    (None, _) => &mut second,
                    _ => &mut first,
                };
                if let Some((next, rest)) = of.split_first() {
                    (*place, *of) = (*next, rest);
                }
            }
        }
        list.copy_from_slice(&merged);
        run *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    type Sort = fn(&mut [(u8, usize)]);

    /// The standard library's stable sort, on lists with equal elements.
    #[test]
    fn lists_are_sorted_as_the_standard_library_sorts_them() {
        let mut random = Random(1);
        for len in 0..70 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 … 10"
            )]
            let list: Vec<(u8, usize)> = (0..len)
                .map(|i| (random.uniform(0.0, 10.0) as u8, i))
                .collect();
            let mut sound = list.clone();
            sound.sort_by_key(|(key, _)| *key);
            let sorts: [Sort; 2] = [
                |list| short(list, |a, b| a.0 < b.0),
                |list| once(list, |a, b| a.0 < b.0),
            ];
            for sort in sorts {
                let mut list = list.clone();
                sort(&mut list);
                assert_eq!(list, sound);
            }
        }
    }
}
