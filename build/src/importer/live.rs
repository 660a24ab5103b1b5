//! An FMU that is simulated step by step, with inputs that a person changes in between.

use super::error::RunError;
use super::experiment;
use super::run::{Recorded, Run};
use super::variable::Kind;
use std::collections::BTreeMap;
use std::path::Path;

/// A running FMU.
pub struct Live {
    run: Run,
    /// Handles of inputs that are numbers, by name.
    inputs: BTreeMap<String, u32>,
    tolerance: Option<f64>,
    start: f64,
    time: f64,
    begun: bool,
}

impl Live {
    /// Loads the FMU that was unpacked in `folder`.
    ///
    /// - `inputs`: a table of inputs over time
    /// - `step`: how long its steps will be, s
    ///
    /// # Errors
    /// [`RunError`]
    pub fn open(folder: &Path, inputs: Option<&Path>, step: f64) -> Result<Self, RunError> {
        let description = experiment::description(folder)?;
        let allowed = experiment::SAME * step;
        let signals = inputs.map(|path| experiment::signals(&description, path, allowed));
        let recorded = Recorded::new(&description, |v| v.causality == "output");
        let (signals, tolerance) = (signals.transpose()?, description.tolerance);
        let run = Run::new(folder, &description, signals, recorded, tolerance, false)?;
        let start = description.start_time.unwrap_or(0.0);
        let inputs = description.variables.iter();
        let inputs = inputs.filter(|v| v.is_input() && v.kind == Kind::Real);
        Ok(Self {
            run,
            inputs: inputs
                .map(|v| (v.name.clone(), v.value_reference))
                .collect(),
            tolerance: description.tolerance,
            start,
            time: start,
            begun: false,
        })
    }

    /// Names of a row, `time` first.
    pub fn names(&self) -> &[String] {
        self.run.names()
    }

    /// Whether the table of inputs has a column for a variable.
    pub fn has_in_table(&self, name: &str) -> bool {
        self.run.has_signal(name)
    }

    /// s, where it begins.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Initialises; a simulation that has begun is reset.
    ///
    /// # Errors
    /// [`RunError::Library`]
    pub fn begin(&mut self) -> Result<(), RunError> {
        if self.begun {
            self.run.slave.reset()?;
        }
        self.begun = true;
        self.time = self.start;
        self.run.slave.setup(self.tolerance, self.start, None)?;
        self.run.slave.enter_initialization()?;
        self.run.apply(self.start)?;
        self.run.begin(self.start, f64::INFINITY)
    }

    /// Sets inputs by name; a name that is none is left out.
    ///
    /// # Errors
    /// [`RunError::Library`]
    pub fn set(&mut self, inputs: &[(&str, f64)]) -> Result<(), RunError> {
        let known = inputs.iter();
        let known = known.filter_map(|(name, value)| Some((*self.inputs.get(*name)?, *value)));
        let known: Vec<(u32, f64)> = known.collect();
        self.run.hold(&known, self.time, f64::INFINITY)
    }

    /// Sets the inputs of the table to what they are now.
    ///
    /// # Errors
    /// [`RunError::Library`]
    pub fn follow_table(&mut self) -> Result<(), RunError> {
        self.run.follow_table(self.time, f64::INFINITY)
    }

    /// Simulates until `end`, s.
    ///
    /// # Errors
    /// [`RunError::Stopped`]
    pub fn step_to(&mut self, end: f64) -> Result<(), RunError> {
        self.run.step(self.time, end, end)?;
        self.time = end;
        Ok(())
    }

    /// Time and all outputs.
    ///
    /// # Errors
    /// [`RunError::Library`]
    pub fn row(&mut self) -> Result<Vec<f64>, RunError> {
        // What the FMU says meanwhile would pile up.
        self.run.slave.messages();
        Ok(self.run.row(self.time)?)
    }
}
