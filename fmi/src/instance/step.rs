//! From one communication point to the next.

use super::Instance;
use super::updates::{Callback, Next, Updates, Way};
use crate::common::Status;
use crate::error::{FmiError, InstantiateError};
use crate::logger::Category;
use crate::phase::Phase;
use std::fmt::Display;
use urdf2fmu_core::clock;
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::simulation::{InputSlot, ParameterSlot, Simulation, SimulationError};
use urdf2fmu_core::variables::{Slot, Variable};

/// How far apart two times may lie that are taken for the same, as a part of the step, beside their
/// round-off and [`ROUNDED`].
const STEP_TOLERANCE: f64 = 1e-3;
/// The same in seconds: some masters round their times to nanoseconds, however short their steps
/// are. At 0 fails `wrong_times_are_errors_and_near_ones_are_not`.
const ROUNDED: f64 = 1e-9;
/// Longest step, s. A longer one is a mistake, and would keep the host waiting for hours.
const LONGEST_STEP: f64 = 1e6;
/// What FMI 3 promises of a step that is discarded.
const UNCHANGED: &str = "the state is that before the call";

impl Instance {
    /// The importer wants to be called within steps, to get and set these variables there.
    ///
    /// # Errors
    /// [`InstantiateError`] for one that is no input or output.
    pub(crate) fn call_within_steps(
        &mut self,
        callback: Callback,
        value_references: impl Iterator<Item = u32>,
    ) -> Result<(), InstantiateError> {
        let mut required = vec![false; self.layout.len()];
        for value_reference in value_references {
            let refused = |why: String| {
                let text = format!("requiredIntermediateVariables: {why}");
                InstantiateError::Arguments(text)
            };
            let place = self.layout.find(value_reference);
            if place.len() == 0 {
                let error = self.layout.wrong(value_reference, "a variable");
                return Err(refused(error.to_string()));
            }
            let known = |row: &u32| {
                let row = self.variables.get(*row as usize);
                row.is_some_and(Variable::within_steps)
            };
            if !self.layout.rows(place).iter().all(known) {
                let name = self.layout.name(place);
                return Err(refused(format!("'{name}' is no input or output")));
            }
            required[place.number as usize] = true;
        }
        self.updates = Some(Updates {
            callback,
            required,
            before: self.simulation.save(),
            way: Way::default(),
        });
        Ok(())
    }

    /// Where a step from `point` ends; at or before the present where there is nothing to do.
    fn end_of_step(&mut self, point: f64, step: f64) -> Result<f64, FmiError> {
        if !(step > 0.0 && step <= LONGEST_STEP) {
            return Err(FmiError::Argument {
                argument: "communicationStepSize",
                value: step,
                expected: "above 0 s and at most 1e6 s",
            });
        }
        let now = self.simulation.time();
        let same = |a, b| clock::is_same(a, b, ROUNDED + STEP_TOLERANCE * step);
        if !same(point, now) {
            return Err(FmiError::CommunicationPoint {
                given: point,
                expected: now,
            });
        }
        let (end, stop) = (point + step, self.experiment.stop);
        // However near to the stop time it begins, a step that ends there is in order.
        if end > stop && (point >= stop || same(point, stop)) {
            let (begin, fmi) = (point, self.version);
            return Err(FmiError::StopTime { begin, stop, fmi });
        }
        // A fixed step that does not divide the experiment ends past its end: so do many masters.
        if end > stop && !same(end, stop) && !self.overshoot_logged {
            self.overshoot_logged = true;
            self.warn(&format!(
                "{}DoStep: the step ends at {end} s, past the stop time {stop} s",
                self.version
            ));
        }
        Ok(end)
    }

    /// fmi2DoStep
    pub(crate) fn do_step(&mut self, point: f64, step: f64) -> Result<Status, FmiError> {
        let end = self.end_of_step(point, step)?;
        // A step so small that jitter or rounding puts its end at or before the present is done
        // already.
        if end <= self.simulation.time() {
            return Ok(Status::OK);
        }
        let ramps = self.check_ramps(end);
        let advanced = ramps.and_then(|()| {
            let advanced = self.simulation.advance_to(end);
            advanced.map_err(|error| error.to_string())
        });
        match advanced {
            Ok(()) => {
                self.tell_solver();
                Ok(Status::OK)
            }
            Err(why) => {
                self.phase = Phase::StepFailed;
                Ok(self.discard(&why, end, "restore a saved state before the next step"))
            }
        }
    }

    /// Looks where derivatives take the inputs in a step to `end`, s. A limit of an effort that
    /// would fall below 0 stops there, which is said once: importers hold a slope to the end of a
    /// step where their table has a corner within it.
    ///
    /// # Errors
    /// Which other input leaves its range.
    fn check_ramps(&mut self, end: f64) -> Result<(), String> {
        if !self.simulation.inputs_vary() {
            return Ok(());
        }
        for row in 0..self.variables.len() {
            let variable = &self.variables[row];
            let Slot::Input(slot) = variable.slot else {
                continue;
            };
            let Some(value) = self.simulation.input_beyond(slot, end) else {
                continue;
            };
            let (name, value) = (&variable.name, Digits(value));
            if !(matches!(slot, InputSlot::MaxEffort(_)) && value.0 < 0.0) {
                let expected = Simulation::input_expected(slot);
                return Err(format!(
                    "the derivatives of '{name}' take it to {value} within the step, but it must be \
                     {expected}"
                ));
            }
            let text = format!(
                "the derivatives of '{name}' take it to {value} within the step; it stops at 0, and \
                 this is said once"
            );
            if !std::mem::replace(&mut self.range_logged[row], true) {
                self.warn(&text);
            }
        }
        Ok(())
    }

    /// fmi3DoStep up to its end, or to the first call of the callback.
    pub(crate) fn begin_step(&mut self, point: f64, step: f64) -> Result<Next, FmiError> {
        let end = self.end_of_step(point, step)?;
        let begin = self.simulation.time();
        let tries = self.tries();
        if let Some(updates) = &mut self.updates {
            self.simulation.save_into(&mut updates.before);
            updates.way = Way {
                begin,
                end,
                asked: end,
                tries,
            };
            return Ok(self.go_on());
        }
        let mut status = Status::OK;
        if end > begin {
            match self.simulation.advance_to(end) {
                Ok(()) => self.tell_solver(),
                Err(error) => status = self.discard(&error, end, UNCHANGED),
            }
        }
        Ok(Next::End {
            status,
            early: false,
            time: self.simulation.time(),
        })
    }

    /// What the callback has answered: when the step shall end, s, if it shall end early.
    pub(crate) fn answer(&mut self, end: Option<f64>) {
        self.phase = Phase::StepComplete;
        let now = self.simulation.time();
        if let (Some(updates), Some(end)) = (&mut self.updates, end) {
            // One that is not a number counts as now.
            updates.way.end = if end > now {
                end.min(updates.way.end)
            } else {
                now
            };
        }
    }

    /// Goes on to where all trees stand at the same time, which is where the callback is called.
    pub(crate) fn go_on(&mut self) -> Next {
        let now = self.simulation.time();
        let Some(updates) = &self.updates else {
            return Self::arrived(now, false);
        };
        let (way, callback) = (updates.way, updates.callback);
        if now >= way.end {
            let early = way.end < way.asked;
            if early {
                self.simulation.sample();
            }
            self.tell_solver();
            return Self::arrived(now, early);
        }
        let most = self.simulation.parameter(ParameterSlot::MaxSteps);
        let most = most * (way.asked - way.begin).max(1.0);
        #[expect(clippy::cast_precision_loss, reason = "no step takes 2^52 tries")]
        let tried = (self.tries() - way.tries) as f64;
        let advanced = if tried > most {
            let time = way.begin;
            Err(SimulationError::Work { time, most })
        } else {
            let next = self.simulation.common_step_to(way.end);
            self.simulation.advance_part(next, way.asked)
        };
        if let Err(error) = advanced {
            let status = self.give_up(&error, way.asked);
            let time = self.simulation.time();
            return Next::End {
                status,
                early: false,
                time,
            };
        }
        self.phase = Phase::IntermediateUpdate;
        let time = self.simulation.time();
        Next::Update { callback, time }
    }

    /// The end of a step that is done.
    fn arrived(time: f64, early: bool) -> Next {
        Next::End {
            status: Status::OK,
            early,
            time,
        }
    }

    /// Takes back all of a step that failed after the callback has been called.
    fn give_up(&mut self, error: &SimulationError, end: f64) -> Status {
        if let Some(updates) = &self.updates {
            // A state of the same instance is never refused.
            let restored = self.simulation.restore(&updates.before);
            debug_assert!(restored.is_ok());
        }
        self.discard(error, end, UNCHANGED)
    }

    /// Says that a step is discarded, and what to do.
    #[cfg_attr(small, optimize(size))]
    fn discard(&self, error: &dyn Display, end: f64, advice: &str) -> Status {
        let message = format!(
            "{}DoStep: {error}; the step to {end} s is discarded, the last successful time is {} s; \
             {advice}",
            self.version,
            self.simulation.time()
        );
        self.logger
            .log(Status::Discard, Category::StatusDiscard, &message);
        Status::Discard
    }

    /// Tries of a solver step so far.
    fn tries(&self) -> u64 {
        let [steps, rejected, ..] = self.simulation.state().stepping.counters.numbers();
        steps + rejected
    }

    /// Debug logging of what the solver has done so far.
    #[cfg_attr(small, optimize(size))]
    fn tell_solver(&self) {
        if self.logger.wants(Category::NonlinearSystems) {
            let counters = self.simulation.state().stepping.counters;
            let [steps, rejected, newton, forced] = counters.numbers();
            let message = format!(
                "at {} s: {steps} solver steps since the start, {rejected} rejected, {forced} at the smallest \
                 size; at most {newton} Newton iterations in one solve",
                self.simulation.time()
            );
            self.logger
                .log(Status::OK, Category::NonlinearSystems, &message);
        }
    }
}
