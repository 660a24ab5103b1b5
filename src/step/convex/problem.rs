//! What a solve is about.

use crate::force::Terms;
use crate::kinematics::Kinematics;
use crate::tree::Tree;
use crate::tuning::{COARSEST, ITERATED};

/// What a solve is about, but for what acts: that may change within it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The robot.
    pub tree: &'a Tree,
    /// See [`Problem`]; its bias is that of the problem.
    pub kin: &'a Kinematics,
    /// s
    pub h: f64,
    /// See [`Problem`], s.
    pub ahead: f64,
    /// See [`Problem`]: of a guess, and after an iteration.
    pub accuracy: [f64; 2],
}

impl Frame<'_> {
    /// The problem with what acts now.
    pub fn with<'a>(&'a self, terms: &'a Terms) -> Problem<'a> {
        let [accuracy, iterated] = self.accuracy;
        Problem {
            tree: self.tree,
            kin: self.kin,
            bias: &self.kin.bias,
            terms,
            h: self.h,
            ahead: self.ahead,
            accuracy,
            iterated,
        }
    }
}

/// What a solve is about.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// The robot.
    pub tree: &'a Tree,
    /// Mass matrix, joint motions, velocities at the start of the step.
    pub kin: &'a Kinematics,
    /// `k`: at the start of the step, or at its middle.
    pub bias: &'a [f64],
    /// What acts.
    pub terms: &'a Terms,
    /// s
    pub h: f64,
    /// Time from where `kin` stands to the end of the step, s.
    pub ahead: f64,
    /// Relative accuracy of the impulses that a guess must have.
    pub accuracy: f64,
    /// The same after an iteration. A guess that is taken as it is repeats its error in every step,
    /// while the rest that an iteration leaves is new each time and far below what the step's error
    /// estimate sees: it may be coarser.
    pub iterated: f64,
}

impl<'a> Problem<'a> {
    /// A step of `h` seconds with the bias of `kin`.
    pub fn new(
        (tree, kin): (&'a Tree, &'a Kinematics),
        terms: &'a Terms,
        h: f64,
        accuracy: f64,
    ) -> Self {
        Self {
            tree,
            kin,
            bias: &kin.bias,
            terms,
            h,
            ahead: h,
            accuracy,
            iterated: coarser(accuracy),
        }
    }
}

/// The accuracy after an iteration where a guess must have `accuracy`.
pub fn coarser(accuracy: f64) -> f64 {
    accuracy.max((ITERATED * accuracy).min(COARSEST))
}
