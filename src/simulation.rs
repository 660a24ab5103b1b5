//! A simulation: model, parameters, state and scratch memory.
//!
//! Life of a simulation: [`Simulation::new`], set fixed parameters and inputs,
//! [`Simulation::initialize`], then inputs, [`Simulation::advance_to`], outputs, and again.

pub use self::error::SimulationError;
pub use crate::slots::{Axis, InputSlot, OutputSlot, ParameterSlot, Sensed};
pub use crate::snapshot::{SavedStateError, Snapshot};

use crate::closure::Gap;
use crate::inputs::Inputs;
use crate::model::{BodyId, Model};
use crate::parameters::Parameters;
use crate::prepared::model_hash;
use crate::range::{Range, SHORTEST_FIXED_STEP};
use crate::readout::Readout;
use crate::state::State;
use crate::step::driver::Stepper;
use crate::step::point::Context;
use crate::tree::Tree;
use crate::tuning::Rules;
use std::sync::Arc;

/// A robot that runs.
#[derive(Debug)]
pub struct Simulation {
    /// The robot; never changes.
    model: Arc<Model>,
    /// Hash of the model: saved states carry it.
    hash: u64,
    /// What the user has set; written by [`Self::set_parameter`].
    parameters: Parameters,
    /// What the robot is told from the last communication point on; written by [`Self::set_input`].
    inputs: Inputs,
    /// Inputs as the last step ended with them: outputs show no others.
    applied: Inputs,
    /// Where the robot is; written by [`Self::initialize`] and [`Self::advance_to`].
    state: State,
    /// What follows from model and parameters; derived by [`Self::initialize`], tuned between
    /// steps.
    tree: Tree,
    /// Scratch of the steps; nothing in it outlives one.
    stepper: Box<Stepper>,
    /// What has been computed of the state for outputs; forgotten when anything changes.
    readout: Box<Readout>,
    /// Model Exchange: the state with quaternions of unit length, which outputs show.
    posed: Option<Box<Posed>>,
    rules: Rules,
    /// Tolerance where the parameter is 0, see [`Self::tolerance`]; 0 where the importer gives
    /// none.
    importer_tolerance: f64,
    /// Time at which the simulation begins, s.
    start: f64,
    /// Whether [`Self::initialize`] has succeeded: fixed parameters no longer change.
    initialized: bool,
    /// The widest loop that the initial state leaves open.
    open: Option<(usize, Gap)>,
    /// Parameters have changed and nothing has been derived from them since.
    stale: bool,
}

/// What a readout looks at. A macro, because a method would borrow what it changes, too. Lengths
/// and tolerances of steps, which take a while to look up, are left out: importers read many
/// outputs.
macro_rules! reading {
    ($simulation:ident, $inputs:ident) => {
        Context {
            model: &$simulation.model,
            tree: &$simulation.tree,
            parameters: &$simulation.parameters,
            inputs: &$simulation.$inputs,
            elapsed: 0.0,
            tolerance: 0.0,
            fixed_step: 0.0,
            budget: u64::MAX,
            exchanged: $simulation.posed.is_some(),
            rules: &$simulation.rules,
        }
    };
}

/// What a step looks at.
macro_rules! context {
    ($simulation:ident, $inputs:ident) => {
        Context {
            tolerance: $simulation.tolerance(),
            fixed_step: match $simulation.parameters.get(ParameterSlot::StepSize) {
                step if step > 0.0 => step.max(SHORTEST_FIXED_STEP),
                _ => 0.0,
            },
            ..reading!($simulation, $inputs)
        }
    };
}

mod advance;
mod begin;
mod error;
mod exchange;
pub mod outputs;
mod posed;

use posed::Posed;

impl Simulation {
    /// A robot with its default parameters and initial state; call [`Self::initialize`] before the
    /// first step.
    pub fn new(model: Arc<Model>) -> Self {
        let hash = model_hash(&model);
        Self::with_hash(model, hash)
    }

    /// The same where the hash of the model is known, by which saved states know it: it costs more
    /// than all the rest. [`crate::prepared::PreparedModel::hash`].
    #[cfg_attr(small, optimize(size))]
    pub fn with_hash(model: Arc<Model>, hash: u64) -> Self {
        let parameters = Parameters::new(&model);
        let inputs = Inputs::new(&model);
        let tree = Tree::new(&model, &parameters);
        let mut simulation = Self {
            hash,
            state: State::new(&model),
            stepper: Stepper::new(&model, &tree),
            readout: Readout::new(&model, &tree),
            posed: None,
            model,
            parameters,
            applied: inputs.clone(),
            inputs,
            tree,
            rules: Rules::ALL,
            importer_tolerance: 0.0,
            start: 0.0,
            initialized: false,
            open: None,
            stale: false,
        };
        simulation.place();
        simulation
    }

    /// What saved states know the model by.
    pub fn model_hash(&self) -> u64 {
        self.hash
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What the solver derived from model and parameters.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The state, to be set from outside; positions and velocities as [`crate::model::Motion`]
    /// says.
    pub fn state_mut(&mut self) -> &mut State {
        self.forget();
        self.state.stepping.ahead.all_changed();
        &mut self.state
    }

    /// Back to what [`Self::new`] gives.
    pub fn reset(&mut self) {
        self.parameters = Parameters::new(&self.model);
        self.inputs = Inputs::new(&self.model);
        self.importer_tolerance = 0.0;
        self.start = 0.0;
        self.initialized = false;
        self.place();
    }

    /// Sets the tolerance that applies where the parameter `Tolerance` is 0.
    pub fn set_importer_tolerance(&mut self, tolerance: f64) {
        self.importer_tolerance = tolerance;
    }

    /// Fills all scratch with NaN: of the step, and of what is read out.
    #[cfg(test)]
    pub(crate) fn spoil(&mut self) {
        use crate::spoil::Spoil as _;
        self.stepper.spoil();
        self.forget();
        self.readout.spoil();
    }

    /// Switches rules of the method off or on, for tests and to measure what a rule does. Not part
    /// of saved states; an FMU has all of them.
    pub fn set_rules(&mut self, rules: Rules) {
        self.rules = rules;
    }

    /// Puts the robot into its initial state at time `start`, s, and derives what follows from the
    /// parameters. Before it, outputs follow parameters and inputs as set so far.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`] if parameters are out of all proportion;
    /// [`SimulationError::Open`] if loops do not close.
    pub fn initialize(&mut self, start: f64) -> Result<(), SimulationError> {
        self.start = start;
        self.place();
        let finite = self.state.is_finite() && self.tree.is_sound();
        self.initialized = finite && self.open.is_none();
        if let (Some((closure, gap)), true) = (self.open, finite) {
            return Err(SimulationError::Open {
                name: self.model.loops[closure].name.clone(),
                distance: gap.distance,
                angle: gap.angle,
            });
        }
        if finite {
            self.inputs.given.fill(0.0);
            self.sample();
            Ok(())
        } else {
            Err(SimulationError::NotFinite {
                time: start,
                hint: "check initial values, masses and inertias",
            })
        }
    }

    /// A communication step ends here: takes the samples of sensors that are due.
    /// [`Self::advance_to`] does so by itself.
    pub fn sample(&mut self) {
        if !self.state.stepping.samples.is_empty() {
            let ctx = context!(self, applied);
            self.readout.sample(&ctx, &mut self.state, self.start);
        }
    }

    /// Whether `value` may be set, without setting it.
    ///
    /// # Errors
    /// [`SimulationError::Value`].
    pub fn check_input(&self, slot: InputSlot, value: f64) -> Result<(), SimulationError> {
        check(slot.range(), self.input(slot), value, || {
            format!("input {slot:?}")
        })
    }

    /// Sets an input; `value` has passed [`Self::check_input`].
    pub fn set_input(&mut self, slot: InputSlot, value: f64) {
        if !self.initialized {
            self.inputs.give(slot);
        }
        if self.inputs.get(slot).to_bits() == value.to_bits() {
            return;
        }
        self.inputs.set(slot, value);
        self.input_changed(slot);
    }

    /// Sets the time derivative of order 1 … [`crate::inputs::INPUT_ORDERS`] of an input, for the
    /// next step: there the input follows its Taylor polynomial, after it the input stays where
    /// that has ended and its derivatives are 0. `value` is finite.
    #[cfg_attr(small, optimize(size))]
    pub fn set_input_derivative(&mut self, slot: InputSlot, order: usize, value: f64) {
        if self.inputs.set_derivative(slot, order, value) {
            self.input_changed(slot);
        }
    }

    /// Whether an input has a time derivative for the next step that is not 0.
    pub fn inputs_vary(&self) -> bool {
        self.inputs.varies()
    }

    /// What an input becomes where its time derivatives take it out of its range in a step to
    /// `end`, s.
    pub fn input_beyond(&self, slot: InputSlot, end: f64) -> Option<f64> {
        self.inputs.beyond(slot, end - self.state.time)
    }

    /// What a legal value of an input is, for messages.
    pub fn input_expected(slot: InputSlot) -> &'static str {
        slot.range().expected()
    }

    /// What follows from the inputs as a whole.
    fn gather(&mut self) {
        let inputs = &mut self.inputs;
        inputs.gather(&self.model, &self.tree);
        self.tree
            .run_conveyors(|root| inputs.surface_velocity(root));
    }

    /// The body that an input acts on.
    fn acted_on(&self, slot: InputSlot) -> BodyId {
        use InputSlot::{
            BaseAngularVelocity, BaseLinearVelocity, Effort, ExternalForce, ExternalTorque,
            MaxEffort, Position, SurfaceVelocity, Velocity,
        };
        let model = &self.model;
        match slot {
            Velocity(a) | Position(a) | Effort(a) | MaxEffort(a) => {
                model.dofs[model.actuators[a.index()].dof.index()].body
            }
            ExternalForce(link, _) | ExternalTorque(link, _) => model.links[link.index()].body,
            BaseLinearVelocity(root, _)
            | BaseAngularVelocity(root, _)
            | SurfaceVelocity(root, _) => model.roots[root.index()].body,
        }
    }

    /// What hangs on an input follows it. Outputs do not, once a simulation runs.
    fn input_changed(&mut self, slot: InputSlot) {
        match slot {
            InputSlot::ExternalForce(..) | InputSlot::ExternalTorque(..) => {
                self.inputs.gather(&self.model, &self.tree);
            }
            InputSlot::SurfaceVelocity(..) => {
                let inputs = &self.inputs;
                self.tree
                    .run_conveyors(|root| inputs.surface_velocity(root));
                self.state.stepping.ahead.all_changed();
            }
            _ => {}
        }
        let tree = self.model.root_of(self.acted_on(slot)).index();
        self.state.stepping.ahead.input_changed(&self.tree, tree);
        if !self.initialized || self.posed.is_some() {
            self.applied.copy_from(&self.inputs);
            self.forget();
        }
    }

    /// What is known of the state is no longer so.
    fn forget(&mut self) {
        self.readout.invalidate();
        if let Some(posed) = &mut self.posed {
            posed.known = false;
        }
    }

    /// Reads an input back. A position that has not been set follows the initial position when that
    /// is used: by [`Self::initialize`], and when an output is read before it.
    pub fn input(&self, slot: InputSlot) -> f64 {
        self.inputs.get(slot)
    }

    /// Whether `value` may be set, without setting it.
    ///
    /// # Errors
    /// [`SimulationError::Value`].
    #[cfg_attr(small, optimize(size))]
    pub fn check_parameter(&self, slot: ParameterSlot, value: f64) -> Result<(), SimulationError> {
        let set = self.parameters.get(slot);
        check(slot.range(), set, value, || format!("parameter {slot:?}"))?;
        self.check_exchanged(slot, value)
    }

    /// Sets a parameter; `value` has passed [`Self::check_parameter`]. Fixed ones only before
    /// [`Self::initialize`].
    #[cfg_attr(small, optimize(size))]
    pub fn set_parameter(&mut self, slot: ParameterSlot, value: f64) {
        if self.parameters.get(slot).to_bits() == value.to_bits() {
            return;
        }
        self.parameters.set(slot, value);
        self.state.stepping.ahead.all_changed();
        if self.initialized {
            self.tree.tune(&self.model, &self.parameters);
        } else {
            self.stale = true;
        }
        self.forget();
    }

    /// Reads a parameter back.
    pub fn parameter(&self, slot: ParameterSlot) -> f64 {
        self.parameters.get(slot)
    }

    /// Current time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Copies everything that a later run needs.
    #[cfg_attr(small, optimize(size))]
    pub fn save(&self) -> Snapshot {
        // Not a clone: room for all touches, so that saving again needs none.
        let mut state = State::new(&self.model);
        state.copy_from(&self.state);
        Snapshot {
            hash: self.hash,
            parameters: self.parameters.values.clone(),
            inputs: self.inputs.numbers.clone(),
            given: self.inputs.given.clone(),
            applied: self.applied.numbers.clone(),
            state,
            importer_tolerance: self.importer_tolerance,
            start: self.start,
            initialized: self.initialized,
        }
    }

    /// Reads what [`Snapshot::to_bytes`] wrote for the same model; faster than
    /// [`Snapshot::from_bytes`].
    ///
    /// # Errors
    /// [`SimulationError::State`] for anything else.
    #[cfg_attr(small, optimize(size))]
    pub fn saved_from_bytes(&self, bytes: &[u8]) -> Result<Snapshot, SimulationError> {
        Ok(Snapshot::with_hash(&self.model, self.hash, bytes)?)
    }

    /// Overwrites `snapshot` without allocating if it is of this model, else like [`Self::save`].
    pub fn save_into(&self, snapshot: &mut Snapshot) {
        if snapshot.hash != self.hash {
            *snapshot = self.save();
            return;
        }
        snapshot.parameters.copy_from_slice(&self.parameters.values);
        snapshot.inputs.copy_from_slice(&self.inputs.numbers);
        snapshot.given.copy_from_slice(&self.inputs.given);
        snapshot.applied.copy_from_slice(&self.applied.numbers);
        snapshot.state.copy_from(&self.state);
        snapshot.importer_tolerance = self.importer_tolerance;
        snapshot.start = self.start;
        snapshot.initialized = self.initialized;
    }

    /// Continues from `snapshot`, bit for bit.
    ///
    /// # Errors
    /// [`SimulationError::State`] if it belongs to another model.
    #[cfg_attr(small, optimize(size))]
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimulationError> {
        if snapshot.hash != self.hash {
            let reason = "it belongs to another model".to_owned();
            return Err(SavedStateError { reason }.into());
        }
        let same = self.parameters.values == snapshot.parameters && !self.stale;
        self.parameters.values.copy_from_slice(&snapshot.parameters);
        self.inputs.restore(&snapshot.inputs);
        self.inputs.given.copy_from_slice(&snapshot.given);
        self.importer_tolerance = snapshot.importer_tolerance;
        self.start = snapshot.start;
        self.initialized = snapshot.initialized;
        if !same {
            self.place();
            // Positions that have not been set have followed.
            self.inputs.restore(&snapshot.inputs);
        }
        self.gather();
        self.applied.restore(&snapshot.applied);
        self.applied.gather(&self.model, &self.tree);
        self.state.copy_from(&snapshot.state);
        self.drive_on();
        // Before initialisation the state follows from the parameters.
        self.stale = !self.initialized;
        self.forget();
        if let Some(posed) = &mut self.posed {
            posed.events.forget();
        }
        Ok(())
    }
}

/// Whether `value` is in `range`. What is `set` already may be set again: a robot's own numbers,
/// such as a massless link, may lie outside.
fn check(
    range: Range,
    set: f64,
    value: f64,
    what: impl FnOnce() -> String,
) -> Result<(), SimulationError> {
    if range.contains(value) || value.to_bits() == set.to_bits() {
        return Ok(());
    }
    Err(SimulationError::Value {
        what: what(),
        expected: range.expected(),
        value,
    })
}
