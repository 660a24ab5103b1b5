//! An instance: a simulation, its phase, and the log categories that the importer asked for.
//!
//! This module does not use pointers. Each function of [`crate`] is one method here; the guard
//! ([`crate::call`]) has checked the phase.
//!
//! Over 500 lines because an instance has one method for each function of the interface.

use crate::error::FmiError;
use crate::experiment::Experiment;
use crate::logger::{Category, Logger};
use crate::phase::{Function, Phase};
use crate::pointers::{In, Out};
use crate::snapshot::{GuidHash, SavedState};
use crate::types::fmi2Status;
use std::sync::Arc;
use urdf2fmu_core::inputs::INPUT_ORDERS;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::range::Range;
use urdf2fmu_core::simulation::{Simulation, SimulationError};
use urdf2fmu_core::variables::{Kind, Slot, Variable};

/// How far the beginning of a step may lie from the instance's time, relative to max(1, |t|), and
/// as a part of the step. Masters add up their times in their own way (1e-16 relative per step) and
/// some round them.
const TIME_TOLERANCE: f64 = 1e-9;
/// See [`TIME_TOLERANCE`].
const STEP_TOLERANCE: f64 = 1e-3;
/// Longest step, s. A longer one is a mistake, and would keep the host waiting for hours.
const LONGEST_STEP: f64 = 1e6;
/// How far outside its range a value may be without a word, relative to 1 and to the limit.
const ROUND_OFF: f64 = 1e-9;

/// An instance of the FMU.
#[derive(Debug)]
pub(crate) struct Instance {
    logger: Logger,
    guid: GuidHash,
    model: Arc<Model>,
    /// A variable's position is its value reference.
    variables: Vec<Variable>,
    /// Type and place of each, side by side: what reading looks at.
    places: Vec<(Kind, Slot)>,
    simulation: Simulation,
    phase: Phase,
    experiment: Experiment,
    /// Per variable: that it left its range has been logged.
    range_logged: Vec<bool>,
    /// That a step ended past the stop time has been logged.
    overshoot_logged: bool,
}

/// The finest tolerance that is taken from an importer. Importers announce one tolerance for all
/// their units, 1e-6 and less, and each decade costs up to ten times the steps; below this one the
/// contacts of the model itself are coarser.
const FINEST_TOLERANCE: f64 = 1e-6;

impl Instance {
    /// In phase [`Phase::Instantiated`].
    pub(crate) fn new(
        logger: Logger,
        guid: GuidHash,
        model: Arc<Model>,
        variables: Vec<Variable>,
    ) -> Self {
        Self {
            simulation: Simulation::new(Arc::clone(&model)),
            range_logged: vec![false; variables.len()],
            places: variables.iter().map(|v| (v.kind, v.slot)).collect(),
            logger,
            guid,
            model,
            variables,
            phase: Phase::Instantiated,
            experiment: Experiment::DEFAULT,
            overshoot_logged: false,
        }
    }

    /// Where it stands.
    pub(crate) fn phase(&self) -> Phase {
        self.phase
    }

    /// The simulation.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Identifies the FMU.
    pub(crate) fn guid(&self) -> GuidHash {
        self.guid
    }

    /// Logs why `function` fails.
    pub(crate) fn report(&self, function: Function, error: &FmiError) -> fmi2Status {
        let status = error.status();
        let category = match status {
            fmi2Status::Discard => Category::StatusDiscard,
            _ => Category::StatusError,
        };
        if self.logger.wants(category) {
            let message = format!("{}: {error}", function.name());
            self.logger.log(status, category, &message);
        }
        status
    }

    fn warn(&self, message: &str) {
        self.logger
            .log(fmi2Status::Warning, Category::StatusWarning, message);
    }

    fn event(&self, message: impl FnOnce() -> String) {
        if self.logger.wants(Category::Events) {
            self.logger
                .log(fmi2Status::OK, Category::Events, &message());
        }
    }

    /// After a panic: the simulation may be inconsistent.
    pub(crate) fn poison(&mut self) {
        self.phase = Phase::Error;
    }

    pub(crate) fn set_debug_logging(&mut self, on: bool, names: &[String]) -> Result<(), FmiError> {
        match self.logger.select(on, names).into_iter().next() {
            None => Ok(()),
            Some(name) => Err(FmiError::Category { name }),
        }
    }

    pub(crate) fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), FmiError> {
        let illegal = |argument, value, expected| FmiError::Argument {
            argument,
            value,
            expected,
        };
        if !Range::Time.contains(start) {
            return Err(illegal("startTime", start, Range::Time.expected()));
        }
        let stop = stop.unwrap_or(f64::INFINITY);
        // An infinite stop time means no stop time.
        if stop.is_nan() || stop < start {
            return Err(illegal("stopTime", stop, "at or after startTime"));
        }
        if let Some(value) = tolerance.filter(|value| !(value.is_finite() && *value >= 0.0)) {
            return Err(illegal("tolerance", value, "0 or more"));
        }
        let asked = tolerance.unwrap_or(0.0);
        let greatest = Range::Tolerance.bounds().1;
        let tolerance = if asked > 0.0 {
            asked.clamp(FINEST_TOLERANCE, greatest)
        } else {
            0.0
        };
        if tolerance.to_bits() != asked.to_bits() && asked > 0.0 {
            self.warn(&format!(
                "fmi2SetupExperiment: the tolerance {asked:e} is taken as {tolerance:e}; the parameter \
                 solver.tolerance takes any down to 1e-12"
            ));
        }
        self.experiment = Experiment {
            start,
            stop,
            tolerance,
        };
        self.simulation.set_importer_tolerance(tolerance);
        Ok(())
    }

    pub(crate) fn enter_initialization_mode(&mut self) {
        self.phase = Phase::Initialization;
    }

    /// On an error the instance stays in initialization mode, where the parameters can be
    /// corrected.
    pub(crate) fn exit_initialization_mode(&mut self) -> Result<(), FmiError> {
        self.simulation.initialize(self.experiment.start)?;
        self.phase = Phase::StepComplete;
        if let Some((link, depth)) = self.simulation.deepest_in_ground() {
            let message = format!(
                "the start is {:.3} mm inside the ground, with link '{link}': contacts will push it \
                 out; raise initial.base.position.z",
                1e3 * depth
            );
            self.warn(&message);
        }
        self.event(|| format!("initialised at {} s", self.experiment.start));
        Ok(())
    }

    pub(crate) fn terminate(&mut self) {
        self.phase = Phase::Terminated;
        self.event(|| format!("terminated at {} s", self.simulation.time()));
    }

    /// As fmi2Instantiate left it, but for the log settings.
    pub(crate) fn reset(&mut self) {
        self.renew();
        self.simulation.reset();
        self.phase = Phase::Instantiated;
        self.experiment = Experiment::DEFAULT;
        self.range_logged.fill(false);
        self.overshoot_logged = false;
        self.event(|| "reset".into());
    }

    /// A simulation in which nothing of an interrupted call is left.
    fn renew(&mut self) {
        if self.phase == Phase::Error {
            self.simulation = Simulation::new(Arc::clone(&self.model));
        }
    }

    pub(crate) fn save(&self) -> SavedState {
        SavedState::new(
            self.guid,
            self.phase,
            self.experiment,
            self.simulation.save(),
        )
    }

    pub(crate) fn save_into(&self, state: &mut SavedState) {
        if state.guid == self.guid {
            self.simulation.save_into(&mut state.simulation);
            state.phase = self.phase;
            state.experiment = self.experiment;
        } else {
            *state = self.save();
        }
    }

    pub(crate) fn restore(&mut self, state: &SavedState) -> Result<(), FmiError> {
        if state.guid != self.guid {
            return Err(FmiError::State {
                reason: "it belongs to another FMU".into(),
            });
        }
        self.renew();
        self.simulation.restore(&state.simulation)?;
        self.phase = state.phase;
        self.experiment = state.experiment;
        self.event(|| format!("restored a state of {} s", self.simulation.time()));
        Ok(())
    }

    /// The variable behind a value reference, if it is of the kind asked for.
    fn variable(&self, value_reference: u32, kind: Asked) -> Result<&Variable, FmiError> {
        let variable =
            self.variables
                .get(value_reference as usize)
                .ok_or(FmiError::ValueReference {
                    value_reference,
                    count: self.variables.len(),
                })?;
        if kind == Asked::Kind(variable.kind) {
            return Ok(variable);
        }
        Err(FmiError::Kind {
            name: variable.name.clone(),
            value_reference,
            is: name_of(variable.kind),
            asked: match kind {
                Asked::Kind(kind) => name_of(kind),
                Asked::String => "String",
            },
        })
    }

    /// fmi2GetReal and its like: nothing is written unless all references are right.
    pub(crate) fn get<T: Copy>(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        values: &mut Out<T>,
        from_number: impl Fn(f64) -> T,
    ) -> Result<(), FmiError> {
        for value_reference in value_references.iter() {
            let place = self.places.get(value_reference as usize);
            if place.is_none_or(|(own, _)| *own != kind) {
                self.variable(value_reference, Asked::Kind(kind))?;
            }
        }
        for (index, value_reference) in value_references.iter().enumerate() {
            // Read again: the importer's array may overlap with `values`, so nothing is taken for
            // granted.
            let Some(&(_, slot)) = self.places.get(value_reference as usize) else {
                break;
            };
            let number = match slot {
                Slot::Input(slot) => self.simulation.input(slot),
                Slot::Parameter(slot) => self.simulation.parameter(slot),
                Slot::Output(slot) => self.simulation.output(slot),
            };
            if !number.is_finite() {
                return Err(self.not_finite(value_reference));
            }
            values.set(index, from_number(number));
        }
        Ok(())
    }

    /// An output that is no number.
    fn not_finite(&self, value_reference: u32) -> FmiError {
        let variable = self.variables.get(value_reference as usize);
        FmiError::NotFinite {
            name: variable.map(|v| v.name.clone()).unwrap_or_default(),
        }
    }

    /// fmi2SetReal and its like: nothing is set unless all of it is legal.
    pub(crate) fn set<T: Copy>(
        &mut self,
        kind: Kind,
        value_references: &In<u32>,
        values: &In<T>,
        to_number: impl Fn(T) -> f64,
    ) -> Result<(), FmiError> {
        for (value_reference, value) in value_references.iter().zip(values.iter()) {
            self.check(value_reference, kind, to_number(value))?;
        }
        for (value_reference, value) in value_references.iter().zip(values.iter()) {
            let number = to_number(value);
            // Read again: the importer may write to its array meanwhile, so nothing is taken for
            // granted.
            let Some(variable) = self.variables.get(value_reference as usize) else {
                break;
            };
            match variable.slot {
                Slot::Input(slot) => self.simulation.set_input(slot, number),
                Slot::Parameter(slot) => {
                    self.simulation.set_parameter(slot, number);
                    self.event(|| format!("parameter '{}' is set to {number}", variable.name));
                }
                Slot::Output(_) => {}
            }
            self.note_range(value_reference as usize, number);
        }
        Ok(())
    }

    /// Whether a variable may be set to `value` now.
    fn check(&self, value_reference: u32, kind: Kind, value: f64) -> Result<(), FmiError> {
        let variable = self.variable(value_reference, Asked::Kind(kind))?;
        let name = || variable.name.clone();
        if !value.is_finite() {
            return Err(FmiError::Value {
                name: name(),
                expected: "a finite number",
                value,
            });
        }
        let checked = match variable.slot {
            Slot::Input(slot) => self.simulation.check_input(slot, value),
            Slot::Parameter(slot) => {
                if self.phase == Phase::StepComplete && !slot.tunable() {
                    return Err(FmiError::Fixed { name: name() });
                }
                self.simulation.check_parameter(slot, value)
            }
            Slot::Output(_) => return Err(FmiError::Output { name: name() }),
        };
        checked.map_err(|error| match error {
            SimulationError::Value {
                expected, value, ..
            } => FmiError::Value {
                name: name(),
                expected,
                value,
            },
            other => FmiError::Simulation(other),
        })
    }

    /// Says once per variable that it has left its range; the value counts all the same.
    fn note_range(&mut self, index: usize, value: f64) {
        let variable = &self.variables[index];
        let (min, max) = (
            variable.min.unwrap_or(f64::NEG_INFINITY),
            variable.max.unwrap_or(f64::INFINITY),
        );
        // Importers interpolate their tables, with round-off.
        let slack = |limit: f64| ROUND_OFF * (1.0 + limit.abs());
        let inside = value >= min - slack(min) && value <= max + slack(max);
        if inside || self.range_logged[index] {
            return;
        }
        self.range_logged[index] = true;
        self.warn(&format!(
            "variable '{}' is set to {value}, outside its range [{min}, {max}]; the value is used, and this is \
             said once",
            variable.name
        ));
    }

    /// fmi2SetRealInputDerivatives: nothing is set unless all of it is legal.
    pub(crate) fn set_input_derivatives(
        &mut self,
        value_references: &In<u32>,
        orders: &In<i32>,
        values: &In<f64>,
    ) -> Result<(), FmiError> {
        let all = || {
            let places = value_references.iter().zip(orders.iter());
            places.zip(values.iter())
        };
        for ((value_reference, order), value) in all() {
            let variable = self.variable(value_reference, Asked::Kind(Kind::Real))?;
            let name = || variable.name.clone();
            if !matches!(variable.slot, Slot::Input(_)) {
                return Err(FmiError::NotInput { name: name() });
            }
            check_order(order, INPUT_ORDERS, name)?;
            if !Range::Slope.contains(value) {
                return Err(FmiError::Derivative {
                    name: name(),
                    order,
                    expected: Range::Slope.expected(),
                    value,
                });
            }
        }
        for ((value_reference, order), value) in all() {
            let row = self.variables.get(value_reference as usize);
            if let (Some(Slot::Input(slot)), Ok(order)) =
                (row.map(|row| row.slot), usize::try_from(order))
            {
                self.simulation
                    .set_input_derivative(slot, order.clamp(1, INPUT_ORDERS), value);
            }
        }
        Ok(())
    }

    /// fmi2GetRealOutputDerivatives: nothing is written unless all of it is known.
    pub(crate) fn output_derivatives(
        &mut self,
        value_references: &In<u32>,
        orders: &In<i32>,
        values: &mut Out<f64>,
    ) -> Result<(), FmiError> {
        // The second pass writes what the first has found to be there.
        for write in [false, true] {
            let places = value_references.iter().zip(orders.iter());
            for (index, (value_reference, order)) in places.enumerate() {
                let variable = self.variable(value_reference, Asked::Kind(Kind::Real))?;
                let name = || variable.name.clone();
                let Slot::Output(slot) = variable.slot else {
                    return Err(FmiError::NotOutput { name: name() });
                };
                check_order(order, 1, name)?;
                let Some(value) = self.simulation.output_derivative(slot) else {
                    let name = self.variables[value_reference as usize].name.clone();
                    return Err(FmiError::NoDerivative { name });
                };
                if !value.is_finite() {
                    return Err(self.not_finite(value_reference));
                }
                if write {
                    values.set(index, value);
                }
            }
        }
        Ok(())
    }

    /// fmi2GetString and fmi2SetString: there are no String variables.
    pub(crate) fn refuse_strings(&self, value_references: &In<u32>) -> Result<(), FmiError> {
        match value_references.iter().next() {
            None => Ok(()),
            Some(value_reference) => self.variable(value_reference, Asked::String).map(drop),
        }
    }

    pub(crate) fn do_step(&mut self, point: f64, step: f64) -> Result<fmi2Status, FmiError> {
        if !(step > 0.0 && step <= LONGEST_STEP) {
            return Err(FmiError::Argument {
                argument: "communicationStepSize",
                value: step,
                expected: "above 0 s and at most 1e6 s",
            });
        }
        let now = self.simulation.time();
        let slack = TIME_TOLERANCE * now.abs().max(1.0);
        let distance = (point - now).abs();
        if distance.is_nan() || distance > slack + STEP_TOLERANCE * step {
            return Err(FmiError::CommunicationPoint {
                given: point,
                expected: now,
            });
        }
        let (end, stop) = (point + step, self.experiment.stop);
        if point >= stop - TIME_TOLERANCE * stop.abs().max(1.0) {
            return Err(FmiError::StopTime { begin: point, stop });
        }
        // A fixed step that does not divide the experiment ends past its end: so do many masters.
        if end > stop + 1e-6 * stop.abs().max(1.0) && !self.overshoot_logged {
            self.overshoot_logged = true;
            self.warn(&format!(
                "fmi2DoStep: the step ends at {end} s, past the stop time {stop} s"
            ));
        }
        // A step so small that jitter or rounding puts its end at or before the present is done
        // already.
        if end <= now {
            return Ok(fmi2Status::OK);
        }
        match self.simulation.advance_to(end) {
            Ok(()) => {
                self.tell_solver();
                Ok(fmi2Status::OK)
            }
            Err(error) => {
                self.phase = Phase::StepFailed;
                let message = format!(
                    "fmi2DoStep: {error}; the step to {end} s is discarded, the last successful time is {} s; \
                     restore a saved state before the next step",
                    self.simulation.time()
                );
                self.logger
                    .log(fmi2Status::Discard, Category::StatusDiscard, &message);
                Ok(fmi2Status::Discard)
            }
        }
    }

    /// Debug logging of what the solver has done so far.
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
                .log(fmi2Status::OK, Category::NonlinearSystems, &message);
        }
    }

    /// fmi2LastSuccessfulTime, s.
    pub(crate) fn last_successful_time(&self) -> f64 {
        self.simulation.time()
    }

    /// fmi2DoStepStatus: what the last step returned.
    pub(crate) fn do_step_status(&self) -> fmi2Status {
        match self.phase {
            Phase::StepFailed => fmi2Status::Discard,
            _ => fmi2Status::OK,
        }
    }
}

/// Whether derivatives of this order exist.
fn check_order(order: i32, highest: usize, name: impl Fn() -> String) -> Result<(), FmiError> {
    let highest = i32::try_from(highest).unwrap_or(i32::MAX);
    if order < 1 {
        Err(FmiError::Order {
            name: name(),
            order,
        })
    } else if order > highest {
        Err(FmiError::HighOrder {
            name: name(),
            order,
            highest,
        })
    } else {
        Ok(())
    }
}

/// The type that an fmi2Get or fmi2Set function is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asked {
    Kind(Kind),
    String,
}

fn name_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "Real",
        Kind::Integer => "Integer",
        Kind::Boolean => "Boolean",
    }
}

#[cfg(test)]
pub(crate) mod tests;
