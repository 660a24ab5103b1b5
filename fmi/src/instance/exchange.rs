//! Model Exchange: the importer integrates.

use super::{Instance, Source};
use crate::error::FmiError;
use crate::phase::Phase;
use crate::pointers::{In, Out};
use urdf2fmu_core::range::Range;

impl Instance {
    /// Number of continuous states.
    pub(crate) fn state_count(&self) -> usize {
        self.simulation.states().len()
    }

    /// Whether an importer's array has an element for each state.
    fn check_states(&self, argument: &'static str, given: usize) -> Result<(), FmiError> {
        let expected = self.state_count();
        if given == expected {
            Ok(())
        } else {
            Err(FmiError::StateCount {
                argument,
                given,
                expected,
            })
        }
    }

    /// Inputs and parameters may jump from now on.
    pub(crate) fn enter_event_mode(&mut self) {
        self.phase = Phase::EventMode;
    }

    /// The time of the next event, s, if one is planned: shapes may touch soon after it.
    pub(crate) fn next_event(&mut self) -> Option<f64> {
        self.simulation.plan_event()
    }

    /// Whether a step of the importer has ended in an event.
    pub(crate) fn completed_step(&mut self) -> bool {
        self.simulation.has_event()
    }

    /// Time, states and continuous inputs follow the importer from now on.
    pub(crate) fn enter_continuous_time_mode(&mut self) {
        self.phase = Phase::ContinuousTime;
    }

    /// Sets the time, s.
    pub(crate) fn set_time(&mut self, time: f64) -> Result<(), FmiError> {
        if !Range::Time.contains(time) {
            return Err(FmiError::Argument {
                argument: "time",
                value: time,
                expected: Range::Time.expected(),
            });
        }
        self.simulation.set_time(time);
        Ok(())
    }

    /// Sets all continuous states, or none.
    pub(crate) fn set_continuous_states(&mut self, states: &In<f64>) -> Result<(), FmiError> {
        self.check_states("the list of states", states.len())?;
        self.scratch.clear();
        states.append_to(&mut self.scratch);
        if let Some(index) = not_finite(&self.scratch) {
            let value = self.scratch[index];
            return Err(FmiError::StateValue { index, value });
        }
        self.simulation.set_states(&self.scratch);
        Ok(())
    }

    /// Reads all continuous states.
    pub(crate) fn continuous_states(&mut self, states: &mut Out<f64>) -> Result<(), FmiError> {
        self.check_states("the list of states", states.len())?;
        self.scratch.resize(states.len(), 0.0);
        self.simulation.read_states(&mut self.scratch);
        states.copy(&self.scratch);
        Ok(())
    }

    /// Reads the derivatives of all continuous states; nothing is written if one is not finite.
    pub(crate) fn derivatives(&mut self, rates: &mut Out<f64>) -> Result<(), FmiError> {
        self.check_states("the list of derivatives", rates.len())?;
        let found = self.simulation.rates();
        if let Some(index) = not_finite(found) {
            return Err(self.rate_not_finite(index));
        }
        rates.copy(found);
        Ok(())
    }

    /// A derivative that is no number: the importer may try a shorter step.
    #[cold]
    #[cfg_attr(small, optimize(size))]
    fn rate_not_finite(&self, index: usize) -> FmiError {
        let is_it = |source: &Source| matches!(source, Source::Rate(id) if id.index() == index);
        let element = self.sources.iter().position(is_it);
        let row = element.map(|element| self.layout.all_rows()[element]);
        self.not_finite(row.unwrap_or(u32::MAX))
    }

    /// Reads the nominal values of all continuous states.
    pub(crate) fn nominals(&self, nominals: &mut Out<f64>) -> Result<(), FmiError> {
        self.check_states("the list of nominal values", nominals.len())?;
        for (index, state) in self.simulation.states().iter().enumerate() {
            nominals.set(index, state.nominal);
        }
        Ok(())
    }

    /// Number of event indicators.
    pub(crate) fn indicator_count(&self) -> usize {
        self.indicators
    }

    /// Reads the event indicators.
    pub(crate) fn event_indicators(&mut self, indicators: &mut Out<f64>) -> Result<(), FmiError> {
        let (given, expected) = (indicators.len(), self.indicator_count());
        if given != expected {
            return Err(FmiError::Count { given, expected });
        }
        for index in 0..expected {
            indicators.set(index, self.simulation.indicator());
        }
        Ok(())
    }
}

/// Where the first value stands that is no number; all are looked at without a branch for each,
/// because hardly ever there is one.
fn not_finite(values: &[f64]) -> Option<usize> {
    let all = values.iter().fold(true, |all, x| all & x.is_finite());
    if all {
        return None;
    }
    values.iter().position(|value| !value.is_finite())
}
