//! Smooth steps that reach beyond the communication point that asked for them.
//!
//! A robot on which nothing stiff acts could take steps of tens of milliseconds, while importers
//! ask for states every few. As long as no input changes, its step is therefore taken at its own
//! length, and communication points inside it are read off the method's continuous extension: a
//! polynomial in time of fourth order. Then neither cost nor result depends on how often outputs
//! are read. A changed input or parameter ends the step at the present time, and so does a meeting
//! with a tree that has another one under way.
//!
//! Source: Hairer, Nørsett & Wanner 1993, section II.6 (the extension of Dormand–Prince 5(4)).

use crate::model::Model;
use crate::tree::{Extent, Tree};
use std::ops::Range;

/// Coefficients of each polynomial.
pub const COEFFICIENTS: usize = 5;

/// What is left of the steps of all trees beyond the current time.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    /// Time at which the step of each tree began, s.
    pub start: Vec<f64>,
    /// Its length, s; 0 where none is under way.
    pub length: Vec<f64>,
    /// Index of the first tree of the island whose step it is; 0 where none is under way. Islands
    /// that have been alike may have steps alike, in which neither has looked for the other.
    pub lead: Vec<f64>,
    /// 1 for each tree of which an input or a parameter has changed since the last communication
    /// step, else 0.
    pub changed: Vec<f64>,
    /// Coefficients of the polynomials of each tree, 0 for one that has no step under way; empty
    /// where none has one.
    pub coefficients: Vec<f64>,
}

impl Ahead {
    /// No step under way; room for one of each tree.
    pub fn new(model: &Model) -> Self {
        let trees = model.roots.len();
        Self {
            start: vec![0.0; trees],
            length: vec![0.0; trees],
            lead: vec![0.0; trees],
            changed: vec![0.0; trees],
            coefficients: Vec::with_capacity(COEFFICIENTS * (model.nq + model.nv())),
        }
    }

    /// Begins a step of `h` seconds at time `start` of all trees that move in a step.
    ///
    /// - `position`, `velocity`: coefficients of the polynomial of each place in `q`, and in `v`
    #[expect(clippy::cast_precision_loss, reason = "there are fewer trees")]
    pub fn begin(
        &mut self,
        tree: &Tree,
        [start, h]: [f64; 2],
        position: impl Fn(usize) -> [f64; COEFFICIENTS],
        velocity: impl Fn(usize) -> [f64; COEFFICIENTS],
    ) {
        let all = tree.trees.last().map_or(0, |last| rows(last).end);
        self.coefficients.resize(all, 0.0);
        for (index, extent) in tree.moved() {
            self.start[index] = start;
            self.length[index] = h;
            self.lead[index] = tree.island.lead as f64;
            let positions = extent.coordinates.clone().map(&position);
            let values = positions.chain(extent.dofs.clone().map(&velocity));
            let own = self.coefficients[rows(extent)].chunks_exact_mut(COEFFICIENTS);
            for (row, value) in own.zip(values) {
                row.copy_from_slice(&value);
            }
        }
    }

    /// Whether all trees that move in a step are on one and the same smooth step.
    #[expect(clippy::float_cmp, reason = "the same step has the same numbers")]
    pub fn is_under_way(&self, tree: &Tree) -> bool {
        let lead = tree.island.lead;
        let same = |index: usize| {
            [&self.start, &self.length, &self.lead]
                .iter()
                .all(|of| of[index] == of[lead])
        };
        self.length[lead] > 0.0 && tree.moved().all(|(index, _)| same(index))
    }

    /// Ends the step of each tree that moves in a step.
    pub fn clear(&mut self, tree: &Tree) {
        if !self.coefficients.is_empty() {
            for (index, extent) in tree.moved() {
                self.end_one(index, extent);
            }
        }
    }

    /// Ends the step of a tree.
    fn end_one(&mut self, index: usize, tree: &Extent) {
        for of in [&mut self.start, &mut self.length, &mut self.lead] {
            of[index] = 0.0;
        }
        if self.length.iter().all(|length| *length <= 0.0) {
            self.coefficients.clear();
        } else {
            self.coefficients[rows(tree)].fill(0.0);
        }
    }

    /// An input of a tree has changed: what was foreseen no longer holds.
    pub fn input_changed(&mut self, tree: &Tree, index: usize) {
        self.end_one(index, &tree.trees[index]);
        self.changed[index] = 1.0;
    }

    /// Something has changed that may concern all trees.
    pub fn all_changed(&mut self) {
        for of in [&mut self.start, &mut self.length, &mut self.lead] {
            of.fill(0.0);
        }
        self.changed.fill(1.0);
        self.coefficients.clear();
    }

    /// Whether an input or a parameter of a tree that moves in a step has changed since the last
    /// communication step.
    pub fn has_changed(&self, tree: &Tree) -> bool {
        tree.moved().any(|(index, _)| self.changed[index] != 0.0)
    }

    /// Time at which the step of the trees that move in a step ends, s.
    pub fn end(&self, tree: &Tree) -> f64 {
        let lead = tree.island.lead;
        self.start[lead] + self.length[lead]
    }

    /// Positions and velocities at `time` within the step of the trees that move in a step.
    pub fn evaluate(&self, tree: &Tree, time: f64, q: &mut [f64], v: &mut [f64]) {
        for (index, extent) in tree.moved() {
            let theta = ((time - self.start[index]) / self.length[index]).clamp(0.0, 1.0);
            let rest = 1.0 - theta;
            let (places, dofs) = (extent.coordinates.clone(), extent.dofs.clone());
            let values = q[places].iter_mut().chain(&mut v[dofs]);
            let rows = self.coefficients[rows(extent)].chunks_exact(COEFFICIENTS);
            for (value, c) in values.zip(rows) {
                *value = c[0] + theta * (c[1] + rest * (c[2] + theta * (c[3] + rest * c[4])));
            }
        }
        tree.normalize(q);
    }
}

/// Where the polynomials of a tree stand among the coefficients of all: those of its positions,
/// then those of its velocities.
fn rows(tree: &Extent) -> Range<usize> {
    let (places, dofs) = (&tree.coordinates, &tree.dofs);
    COEFFICIENTS * (places.start + dofs.start)..COEFFICIENTS * (places.end + dofs.end)
}
