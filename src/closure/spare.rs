//! Redundant rows of loops.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rows::Rows;
use crate::tree::Tree;
use crate::tuning::SPARE;

impl Rows {
    /// Leaves out rows that say nothing new where they stand, which is a place where the loops are
    /// closed. Where loops are open by the error of a step, such rows would say something, and
    /// wrong.
    ///
    /// By Cholesky's factor of `J D² Jᵀ` with the largest pivot first.
    ///
    /// - `D2`: see [`crate::kinematics::Kinematics::inverse_diagonal`]
    pub fn select(&mut self, tree: &Tree, D2: &[f64]) {
        let m = self.len();
        let mut largest: f64 = 0.0;
        for a in 0..m {
            for b in 0..=a {
                let x = self.product(tree, [a, b], D2);
                (self.pivots[a * m + b], self.pivots[b * m + a]) = (x, x);
            }
            largest = largest.max(self.pivots[a * m + a]);
        }
        for row in 0..m {
            let index = self.index(tree, row);
            self.keep[index] = false;
        }
        for _ in 0..m {
            let pivot = |row: usize| self.pivots[row * m + row];
            let open = (0..m).filter(|row| !self.keep[self.index(tree, *row)]);
            // The first of equal ones.
            let next = open.fold(None, |best: Option<usize>, row| match best {
                Some(best) if pivot(best) >= pivot(row) => Some(best),
                _ => Some(row),
            });
            let Some(row) = next.filter(|row| pivot(*row) > SPARE * largest) else {
                break;
            };
            let index = self.index(tree, row);
            self.keep[index] = true;
            let reciprocal = 1.0 / pivot(row);
            for a in 0..m {
                let share = self.pivots[a * m + row] * reciprocal;
                if a != row && !self.keep[self.index(tree, a)] {
                    for b in 0..m {
                        self.pivots[a * m + b] -= share * self.pivots[row * m + b];
                    }
                }
            }
        }
        self.drop_spare(tree);
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
