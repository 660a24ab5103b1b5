//! In which order forces of loops are solved for.
//!
//! The rows of two loops have a common entry in `J H⁻¹ Jᵀ` where they act on one part of the joint-
//! space matrix: in a rope of free bodies each loop has two neighbours. A row of the factor begins
//! at its first neighbour, and costs the less the nearer that is, so the order of the loops
//! decides. By turns the loop with the fewest neighbours comes next, after which these are
//! neighbours of each other, and what is eliminated into one loop stands together before it. Where
//! this is not cheaper than the order of the model, that stays.
//!
//! Source: George and Liu 1981, chapters 4 and 5.

use super::parts::Tree;
use std::ops::Range;

impl Tree {
    /// Finds the order of loops; their degrees of freedom and the pattern are there.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn order_closures(&mut self) {
        for closure in &mut self.closures {
            let parts = closure.dofs.iter().map(|dof| self.sparsity.part_of(*dof));
            closure.parts = parts.collect();
            closure.parts.dedup();
        }
        let count = self.closures.len();
        let mut of_part = vec![Vec::new(); self.sparsity.parts.len()];
        for (index, closure) in self.closures.iter().enumerate() {
            for part in &closure.parts {
                of_part[*part].push(index);
            }
        }
        let beside = |index: usize| {
            let parts = self.closures[index].parts.iter();
            let mut beside: Vec<usize> = parts.flat_map(|part| of_part[*part].clone()).collect();
            // A loop without a degree of freedom is beside itself, too.
            beside.push(index);
            beside.sort_unstable();
            beside.dedup();
            beside
        };
        let beside: Vec<Vec<usize>> = (0..count).map(beside).collect();
        let rows: Vec<usize> = self.closures.iter().map(|c| c.kind.rows()).collect();
        self.closure_order = (0..count).collect();
        let found = fewest_neighbours(&beside);
        if cost(&found, &beside, &rows) < cost(&self.closure_order, &beside, &rows) {
            self.closure_order = found;
        }
        for (rank, index) in self.closure_order.iter().enumerate() {
            self.closures[*index].rank = rank;
        }
        for (index, mut beside) in beside.into_iter().enumerate() {
            let rank = |other: usize| self.closures[other].rank;
            beside.retain(|other| rank(*other) <= rank(index));
            beside.sort_unstable_by_key(|other| rank(*other));
            self.closures[index].beside = beside;
        }
    }
}

/// The order of elimination.
///
/// - `beside`: neighbours of each, and itself
#[cfg_attr(small, optimize(size))]
fn fewest_neighbours(beside: &[Vec<usize>]) -> Vec<usize> {
    let count = beside.len();
    let mut joined = vec![vec![false; count]; count];
    for (a, beside) in beside.iter().enumerate() {
        for b in beside {
            joined[a][*b] = true;
        }
    }
    let mut degree: Vec<usize> = beside.iter().map(|beside| beside.len() - 1).collect();
    let mut left: Vec<usize> = (0..count).collect();
    let mut eliminated = Vec::with_capacity(count);
    let mut last = 0;
    loop {
        // Of equal ones a neighbour of the last one.
        let rank = |index: usize| (degree[index], !joined[last][index]);
        let Some(place) = (0..left.len()).min_by_key(|place| rank(left[*place])) else {
            break;
        };
        if degree[left[place]] + 1 == left.len() {
            // All that are left are neighbours, and come as they are.
            for (place, index) in left.iter().enumerate() {
                eliminated.push((*index, left[place + 1..].to_vec()));
            }
            break;
        }
        let index = left.remove(place);
        let neighbours = left.iter().copied().filter(|other| joined[index][*other]);
        let neighbours: Vec<usize> = neighbours.collect();
        for a in &neighbours {
            degree[*a] -= 1;
            for b in &neighbours {
                if a != b && !std::mem::replace(&mut joined[*a][*b], true) {
                    degree[*a] += 1;
                }
            }
        }
        eliminated.push((index, neighbours));
        last = index;
    }
    let mut turn = vec![0; count];
    for (place, (index, _)) in eliminated.iter().enumerate() {
        turn[*index] = place;
    }
    // Each with what has been eliminated into it before it.
    let (mut before, mut order) = (vec![Vec::new(); count], Vec::with_capacity(count));
    for (index, neighbours) in eliminated {
        let mut own = std::mem::take(&mut before[index]);
        own.push(index);
        let next = neighbours.into_iter().min_by_key(|other| turn[*other]);
        next.map_or(&mut order, |next| &mut before[next])
            .append(&mut own);
    }
    order
}

/// Multiplications of the factor, whose rows go from the first neighbour to the diagonal.
///
/// - `rows`: of each loop
#[cfg_attr(small, optimize(size))]
fn cost(order: &[usize], beside: &[Vec<usize>], rows: &[usize]) -> usize {
    let (mut end, mut spans) = (0, vec![0..0; order.len()]);
    for index in order {
        spans[*index] = end..end + rows[*index];
        end += rows[*index];
    }
    let first = |index: usize| beside[index].iter().map(|other| spans[*other].start).min();
    let begin: Vec<usize> = order
        .iter()
        .map(|i| first(*i).unwrap_or_default())
        .collect();
    let ends = |place: usize| -> &Range<usize> { &spans[order[place]] };
    let mut sum = 0;
    for (place, index) in order.iter().enumerate() {
        let own = (0..=place)
            .rev()
            .take_while(|other| ends(*other).start >= begin[place]);
        let products = own
            .map(|other| rows[order[other]] * (ends(other).end - begin[place].max(begin[other])));
        sum += rows[*index] * products.sum::<usize>();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{cost, fewest_neighbours};

    /// Neighbours of each of `count` that pairs make.
    fn beside(count: usize, pairs: &[[usize; 2]]) -> Vec<Vec<usize>> {
        let mut beside: Vec<Vec<usize>> = (0..count).map(|index| vec![index]).collect();
        for [a, b] in pairs {
            beside[*a].push(*b);
            beside[*b].push(*a);
        }
        beside
    }

    /// A rope whose loops are listed anyhow costs what it does from one end to the other.
    #[test]
    fn a_rope_costs_the_same_however_its_loops_are_listed() {
        let count = 40;
        let place = |i: usize| i * 17 % count;
        let pairs: Vec<[usize; 2]> = (1..count).map(|i| [place(i - 1), place(i)]).collect();
        let (beside, rows) = (beside(count, &pairs), vec![3; count]);
        let along: Vec<usize> = (0..count).map(place).collect();
        let found = fewest_neighbours(&beside);
        let mut sorted = found.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..count));
        assert_eq!(cost(&found, &beside, &rows), cost(&along, &beside, &rows));
        let listed: Vec<usize> = (0..count).collect();
        assert!(20 * cost(&found, &beside, &rows) < cost(&listed, &beside, &rows));
    }

    /// Loops that are all neighbours keep their order.
    #[test]
    fn loops_of_one_tree_keep_their_order() {
        let beside: Vec<Vec<usize>> = vec![(0..7).collect(); 7];
        assert!(fewest_neighbours(&beside).into_iter().eq(0..7));
    }

    /// Ropes from a hub: the loops at the hub are neighbours of each other. The cost grows with the
    /// length of the ropes.
    #[test]
    fn ropes_from_a_hub_cost_in_proportion_to_their_length() {
        let hub = |length: usize| {
            let mut pairs = Vec::new();
            for a in 0..4 {
                pairs.extend((0..a).map(|b| [a * length, b * length]));
                pairs.extend((1..length).map(|i| [a * length + i - 1, a * length + i]));
            }
            let beside = beside(4 * length, &pairs);
            cost(&fewest_neighbours(&beside), &beside, &vec![3; 4 * length])
        };
        let [short, long] = [20, 40].map(hub);
        assert!(long < 3 * short, "{short} {long}");
    }
}
