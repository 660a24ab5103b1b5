//! An instance: a simulation, its phase, and the log categories that the importer asked for.
//!
//! This module does not use pointers. Each function of the interface is one method here; the guard
//! ([`crate::call`]) has checked the phase. This file has the functions from instantiation to the
//! end; `values` reads and sets variables, `step` simulates, and `updates` is for calls of the
//! importer within steps; `exchange` is for importers that integrate, and `partial` finds partial
//! derivatives.

mod exchange;
mod partial;
mod step;
mod updates;
mod values;

use crate::common::{Interface, Status, Version};
use crate::error::FmiError;
use crate::experiment::Experiment;
use crate::layout::Layout;
use crate::logger::{Category, Logger};
use crate::phase::Phase;
use crate::snapshot::{GuidHash, SavedState};
use std::sync::Arc;
pub(crate) use updates::{Callback, Next, Updates};
use urdf2fmu_core::model::{Model, RootId, RootKind, StateId};
use urdf2fmu_core::range::Range;
use urdf2fmu_core::simulation::{OutputSlot, ParameterSlot, Simulation};
use urdf2fmu_core::variables::{Slot, Variable};

/// An instance of the FMU.
#[derive(Debug)]
pub(crate) struct Instance {
    logger: Logger,
    version: Version,
    integrated_by: Interface,
    guid: GuidHash,
    model: Arc<Model>,
    /// Rows of the table.
    variables: Vec<Variable>,
    /// Where the value of each element of the layout lives: what reading looks at.
    sources: Vec<Source>,
    /// Elements by value reference.
    layout: Layout,
    /// Number of event indicators: asked for at each call that reads them.
    indicators: usize,
    simulation: Box<Simulation>,
    phase: Phase,
    experiment: Experiment,
    /// Per variable: that it left its range has been logged.
    range_logged: Vec<bool>,
    /// That a step ended past the stop time has been logged.
    overshoot_logged: bool,
    /// FMI 3: the importer wants to be called within steps.
    updates: Option<Updates>,
    /// Room for a list of states.
    scratch: Vec<f64>,
}

/// Where a value lives.
#[derive(Clone, Copy, Debug)]
enum Source {
    Slot(Slot),
    /// Model Exchange: a continuous state as the importer has set it, and its derivative.
    State(StateId),
    Rate(StateId),
    /// The event indicator.
    Indicator,
    Time,
}

/// The finest tolerance that is taken from an importer. Importers announce one tolerance for all
/// their units, 1e-6 and less, and each decade costs up to ten times the steps; below this one the
/// contacts of the model itself are coarser.
const FINEST_TOLERANCE: f64 = 1e-6;

impl Instance {
    /// In phase [`Phase::Instantiated`].
    pub(crate) fn new(
        logger: Logger,
        (version, integrated_by): (Version, Interface),
        guid: GuidHash,
        (model, hash): (Arc<Model>, u64),
        variables: Vec<Variable>,
        layout: Layout,
    ) -> Self {
        let exchanges = integrated_by == Interface::ModelExchange;
        let source = |row: &u32| match variables.get(*row as usize) {
            None => Source::Time,
            Some(row) => match (row.state, row.slot) {
                (Some(id), _) if exchanges => Source::State(id),
                (_, Slot::Output(OutputSlot::Rate(id))) if exchanges => Source::Rate(id),
                (_, Slot::Output(OutputSlot::Indicator)) if exchanges => Source::Indicator,
                _ => Source::Slot(row.slot),
            },
        };
        let is_one = |row: &&Variable| row.slot == Slot::Output(OutputSlot::Indicator);
        Self {
            indicators: variables.iter().filter(is_one).count(),
            simulation: simulation(&model, hash, integrated_by),
            range_logged: vec![false; variables.len()],
            sources: layout.all_rows().iter().map(source).collect(),
            logger,
            version,
            integrated_by,
            guid,
            model,
            variables,
            layout,
            phase: Phase::Instantiated,
            experiment: Experiment::DEFAULT,
            overshoot_logged: false,
            updates: None,
            scratch: Vec::new(),
        }
    }

    /// Version of FMI that it speaks.
    pub(crate) fn version(&self) -> Version {
        self.version
    }

    /// Who integrates.
    pub(crate) fn integrated_by(&self) -> Interface {
        self.integrated_by
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
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn report(&self, function: &str, error: &FmiError) -> Status {
        let status = error.status();
        let category = match status {
            Status::Discard => Category::StatusDiscard,
            _ => Category::StatusError,
        };
        if self.logger.wants(category) {
            let message = format!("{function}: {error}");
            self.logger.log(status, category, &message);
        }
        status
    }

    fn warn(&self, message: &str) {
        self.logger
            .log(Status::Warning, Category::StatusWarning, message);
    }

    fn event(&self, message: impl FnOnce() -> String) {
        if self.logger.wants(Category::Events) {
            self.logger.log(Status::OK, Category::Events, &message());
        }
    }

    /// After a panic: the simulation may be inconsistent.
    pub(crate) fn poison(&mut self) {
        self.phase = Phase::Error;
    }

    #[cfg_attr(small, optimize(size))]
    pub(crate) fn set_debug_logging(&mut self, on: bool, names: &[String]) -> Result<(), FmiError> {
        match self.logger.select(on, names).into_iter().next() {
            None => Ok(()),
            Some(name) => Err(FmiError::Category { name }),
        }
    }

    #[cfg_attr(small, optimize(size))]
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
                "{}: the tolerance {asked:e} is taken as {tolerance:e}; the parameter \
                 solver.tolerance takes any down to 1e-12",
                self.version.setup()
            ));
        }
        self.experiment = Experiment {
            start,
            stop,
            tolerance,
        };
        self.simulation.set_importer_tolerance(tolerance);
        self.simulation.set_start(start);
        Ok(())
    }

    pub(crate) fn enter_initialization_mode(&mut self) {
        self.phase = Phase::Initialization;
    }

    /// On an error the instance stays in initialization mode, where the parameters can be
    /// corrected.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn exit_initialization_mode(&mut self) -> Result<(), FmiError> {
        let apart = self.simulation.apart_in_group().map(|[first, other]| {
            let [(leader, at), (name, own)] = [first, other];
            format!(
                "joints '{leader}' and '{name}' share a position command, which is not set and \
                 follows '{leader}', but start at {at} and {own}: the servo of '{name}' moves it \
                 over with its whole effort; set their initial.joint.*.position alike, or the command"
            )
        });
        self.simulation.initialize(self.experiment.start)?;
        if let Some(message) = apart {
            self.warn(&message);
        }
        self.phase = match self.integrated_by {
            Interface::CoSimulation => Phase::StepComplete,
            Interface::ModelExchange => Phase::EventMode,
        };
        if let Some((link, [depth, push])) = self.simulation.deepest_in_ground() {
            let message = format!(
                "the start is {:.3} mm inside the ground, with link '{link}': contacts will push it \
                 out, at first with {:.0} times its weight; raise {}",
                1e3 * depth,
                push,
                self.way_up(link)
            );
            self.warn(&message);
        }
        self.event(|| format!("initialised at {} s", self.experiment.start));
        Ok(())
    }

    /// Parameters that lift a link out of the ground: of the robot or the object that it is of.
    fn way_up(&self, link: &str) -> String {
        let mut links = self.model.links.iter();
        let body = links.find(|own| own.name == link).map(|own| own.body);
        let root = body.map_or(RootId::ROBOT, |body| self.model.root_of(body));
        let height = Slot::Parameter(ParameterSlot::InitialBasePosition(root, 2));
        let mut rows = self.variables.iter();
        let name = rows.find(|row| row.slot == height);
        let name = name.map_or("initial.base.position.z", |row| row.name.as_str());
        if self.model.roots[root.index()].kind == RootKind::Object {
            name.to_owned()
        } else {
            format!("{name} or set initial.joint.*.position")
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(crate) fn terminate(&mut self) {
        self.phase = Phase::Terminated;
        self.event(|| format!("terminated at {} s", self.simulation.time()));
    }

    /// As it was made, but for the log settings.
    #[cfg_attr(small, optimize(size))]
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
            let hash = self.simulation.model_hash();
            self.simulation = simulation(&self.model, hash, self.integrated_by);
        }
    }

    pub(crate) fn save(&self) -> SavedState {
        SavedState::new(
            self.guid,
            self.version,
            self.phase,
            self.experiment,
            self.simulation.save(),
        )
    }

    #[cfg_attr(small, optimize(size))]
    pub(crate) fn save_into(&self, state: &mut SavedState) {
        if state.check(self.guid, self.version).is_ok() {
            self.simulation.save_into(&mut state.simulation);
            state.phase = self.phase;
            state.experiment = self.experiment;
        } else {
            *state = self.save();
        }
    }

    #[cfg_attr(small, optimize(size))]
    pub(crate) fn restore(&mut self, state: &SavedState) -> Result<(), FmiError> {
        state.check(self.guid, self.version)?;
        if let Some(other) = state
            .phase
            .of()
            .filter(|other| *other != self.integrated_by)
        {
            let reason = format!(
                "it was saved in {other}, and the instance was made for {}",
                self.integrated_by
            );
            return Err(FmiError::State { reason });
        }
        self.renew();
        self.simulation.restore(&state.simulation)?;
        self.phase = state.phase;
        self.experiment = state.experiment;
        self.event(|| format!("restored a state of {} s", self.simulation.time()));
        Ok(())
    }

    /// fmi2LastSuccessfulTime, s.
    pub(crate) fn last_successful_time(&self) -> f64 {
        self.simulation.time()
    }

    /// fmi2DoStepStatus: what the last step returned.
    pub(crate) fn do_step_status(&self) -> Status {
        match self.phase {
            Phase::StepFailed => Status::Discard,
            _ => Status::OK,
        }
    }
}

/// A simulation of the model, for who integrates. On the heap: an instance is handed through many
/// calls, and hosts make it in threads with little stack.
fn simulation(model: &Arc<Model>, hash: u64, integrated_by: Interface) -> Box<Simulation> {
    let mut simulation = Box::new(Simulation::with_hash(Arc::clone(model), hash));
    if integrated_by == Interface::ModelExchange {
        simulation.exchange();
    }
    simulation
}

#[cfg(test)]
pub(crate) mod tests;
