//! A smooth step that reaches beyond the communication point that asked for it.
//!
//! A robot on which nothing stiff acts could take steps of tens of milliseconds, while importers
//! ask for states every few. As long as no input changes, its step is therefore taken at its own
//! length, and communication points inside it are read off the method's continuous extension: a
//! polynomial in time of fourth order. Then neither cost nor result depends on how often outputs
//! are read. A changed input or parameter ends the step at the present time.
//!
//! Source: Hairer, Nørsett & Wanner 1993, section II.6 (the extension of Dormand–Prince 5(4)).

use crate::model::Model;
use crate::tree::Tree;

/// Coefficients of each polynomial.
pub const COEFFICIENTS: usize = 5;

/// What is left of a step beyond the current time.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    /// Time at which the step began, s.
    pub start: f64,
    /// Its length, s.
    pub length: f64,
    /// 1 if an input or a parameter has changed since the last communication step, else 0.
    pub changed: f64,
    /// Coefficients of the polynomials of every position, then of every velocity; empty where no
    /// step is under way.
    pub coefficients: Vec<f64>,
}

impl Ahead {
    /// No step under way; room for one.
    pub fn new(model: &Model) -> Self {
        Self {
            start: 0.0,
            length: 0.0,
            changed: 0.0,
            coefficients: Vec::with_capacity(COEFFICIENTS * (model.nq + model.nv())),
        }
    }

    /// Whether no step is under way.
    pub fn is_empty(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// Ends the step under way.
    pub fn clear(&mut self) {
        self.start = 0.0;
        self.length = 0.0;
        self.coefficients.clear();
    }

    /// An input or a parameter has changed: what was foreseen no longer holds.
    pub fn input_changed(&mut self) {
        self.clear();
        self.changed = 1.0;
    }

    /// Overwrites this step with another of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.start = other.start;
        self.length = other.length;
        self.changed = other.changed;
        self.coefficients.clear();
        self.coefficients.extend_from_slice(&other.coefficients);
    }

    /// Time at which the step ends, s.
    pub fn end(&self) -> f64 {
        self.start + self.length
    }

    /// Positions and velocities at `time` within the step.
    pub fn evaluate(&self, tree: &Tree, time: f64, q: &mut [f64], v: &mut [f64]) {
        let theta = ((time - self.start) / self.length).clamp(0.0, 1.0);
        let rest = 1.0 - theta;
        let values = q.iter_mut().chain(v);
        for (value, c) in values.zip(self.coefficients.chunks_exact(COEFFICIENTS)) {
            *value = c[0] + theta * (c[1] + rest * (c[2] + theta * (c[3] + rest * c[4])));
        }
        tree.normalize(q);
    }
}
