//! Redundant rows of loops.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use super::search::{Search, WORD};
use crate::tree::Tree;
use crate::tuning::SPARE;

impl Rows {
    /// Leaves out rows that say nothing new where they stand, which is a place where the loops are
    /// closed. Where loops are open by the error of a step, such rows would say something, and
    /// wrong.
    ///
    /// By Cholesky's factor of `J D² Jᵀ` with the largest pivot first, of which only entries that
    /// are not zero are worked on.
    ///
    /// - `D2`: see [`crate::kinematics::Kinematics::inverse_diagonal`]
    pub fn select(&mut self, tree: &Tree, D2: &[f64]) {
        let mut search = std::mem::take(&mut self.search);
        if !self.are_apart(tree, D2, &mut search) {
            self.search_spare(tree, D2, &mut search);
        }
        self.search = search;
        self.drop_spare(tree);
    }

    /// How much of what a loop's ends move by is left of their motion against each other, at most:
    /// 0 where the loop holds nothing.
    #[cfg(feature = "urdf")]
    pub fn share(&self, tree: &Tree, closure: usize) -> f64 {
        let n = tree.closures[closure].dofs.len();
        let rows = self.of(tree, closure).map(|row| self.start[row]);
        let entries = rows.flat_map(|start| start..start + n);
        let shares = entries.map(|e| self.J[e].abs() / self.sides[e].max(f64::MIN_POSITIVE));
        shares.fold(0.0, f64::max)
    }

    /// Leaves out rows that vanish, and tells whether the others say something new each, by far: in
    /// the order of the rows each pivot is above the root of what it has to be above in the best
    /// one.
    fn are_apart(&mut self, tree: &Tree, D2: &[f64], search: &mut Search) -> bool {
        search.pivots.clear();
        search
            .pivots
            .extend((0..self.len()).map(|row| self.product(tree, [row; 2], D2)));
        let largest = search.pivots.iter().fold(0.0, |most: f64, x| most.max(*x));
        for row in 0..self.len() {
            let index = self.index(tree, row);
            self.keep[index] = search.pivots[row] > SPARE * largest;
        }
        search.factor.clear();
        search.near.clear();
        for row in 0..self.len() {
            if !self.keep[self.index(tree, row)] {
                continue;
            }
            let closure = &tree.closures[self.closure_of(row)];
            let begin = closure.beside.first();
            let begin = begin.map_or(row, |beside| self.of(tree, *beside).start);
            let first = search.near.partition_point(|other| *other < begin);
            search.near.push(row);
            let entries = search.factor.add(first);
            for (entry, other) in entries.iter_mut().zip(&search.near[first..]) {
                *entry = self.product(tree, [row, *other], D2);
            }
        }
        search.factor.factor();
        search.factor.least_pivot() > SPARE.sqrt() * largest
    }

    /// Leaves out rows by the pivots.
    fn search_spare(&mut self, tree: &Tree, D2: &[f64], search: &mut Search) {
        let largest = self.pair(tree, D2, search);
        for row in 0..self.len() {
            let index = self.index(tree, row);
            self.keep[index] = false;
        }
        for _ in 0..self.len() {
            // The first of equal ones.
            let mut next = (None, SPARE * largest);
            for (row, pivot) in search.pivots.iter().enumerate() {
                if *pivot > next.1 {
                    next = (Some(row), *pivot);
                }
            }
            let Some(row) = next.0 else { break };
            let index = self.index(tree, row);
            self.keep[index] = true;
            search.keep(row);
        }
    }

    /// Finds `J D² Jᵀ`; returns the largest entry of its diagonal.
    fn pair(&self, tree: &Tree, D2: &[f64], search: &mut Search) -> f64 {
        let m = self.len();
        let words = m.div_ceil(WORD);
        search.marks[..m * words].fill(0);
        search.pivots.clear();
        let mut largest: f64 = 0.0;
        for a in 0..m {
            for closure in &tree.closures[self.closure_of(a)].beside {
                let own = self.of(tree, *closure);
                for b in own.start..own.end.min(a) {
                    let entry = self.product(tree, [a, b], D2);
                    search.left[a * m + b] = entry;
                    if entry != 0.0 {
                        search.marks[a * words + b / WORD] |= 1 << (b % WORD);
                        search.marks[b * words + a / WORD] |= 1 << (a % WORD);
                    }
                }
            }
            let own = self.product(tree, [a, a], D2);
            largest = largest.max(own);
            search.pivots.push(own);
        }
        largest
    }

    /// `J D² Jᵀ` of two rows.
    fn product(&self, tree: &Tree, [a, b]: [usize; 2], D2: &[f64]) -> f64 {
        let [first, second] = [a, b].map(|row| self.entries(tree, row));
        let mut others = second.0.iter().zip(second.1).peekable();
        let mut sum = 0.0;
        for (dof, x) in first.0.iter().zip(first.1) {
            while others.next_if(|(other, _)| *other < dof).is_some() {}
            if let Some((_, y)) = others.next_if(|(other, _)| *other == dof) {
                sum += x * y * D2[*dof];
            }
        }
        sum
    }
}
