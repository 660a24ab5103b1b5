//! Saved states: everything that a later run needs to continue with the same bits. Scratch memory
//! is not part of it.
//!
//! Bytes, little-endian: magic `U2FS`, format version (u32), hash of the model (u64), then lists,
//! each with its length (u64): parameters, inputs, which positions among them were set before the
//! start, inputs as the last step ended with them, the state's fields, the run's settings; the
//! counters; the number of touches, of loads of what rests and of coefficients of smooth steps
//! under way; the touches (slot, displacement, angle and touch-down speed of each); the loads
//! (slot and force); the coefficients; last an FNV-1a checksum (u64) of all before it. Lengths
//! must be those of the model, so that forged lengths allocate nothing.

use crate::force::Touch;
use crate::hash::fnv1a;
use crate::inputs::Inputs;
use crate::model::Model;
use crate::parameters::Parameters;
use crate::prepared::model_hash;
use crate::state::ahead::COEFFICIENTS;
use crate::state::{Counters, Load, State};

/// Why bytes are not a saved state of a model, or a saved state is not one of this model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("saved state refused: {reason}")]
pub struct SavedStateError {
    /// What is wrong with it.
    pub reason: String,
}

const MAGIC: &[u8; 4] = b"U2FS";
const VERSION: u32 = 14;

/// Bytes of a saved touch: slot and numbers.
const TOUCH: usize = 72;
/// Bytes of a saved load: slot and force.
const LOAD: usize = 32;

/// Everything that a later run needs to go on bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    pub(crate) hash: u64,
    pub(crate) parameters: Vec<f64>,
    pub(crate) inputs: Vec<f64>,
    pub(crate) given: Vec<f64>,
    pub(crate) applied: Vec<f64>,
    pub(crate) state: State,
    pub(crate) importer_tolerance: f64,
    pub(crate) start: f64,
    pub(crate) initialized: bool,
}

impl Snapshot {
    /// Whether it was saved after [`crate::simulation::Simulation::initialize`].
    pub fn is_initialized(&self) -> bool {
        self.initialized
    }

    /// Little-endian bytes with magic, version and a hash of the model.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.byte_len());
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.hash.to_le_bytes());
        let mut list = |values: &[f64]| {
            bytes.extend((values.len() as u64).to_le_bytes());
            for value in values {
                bytes.extend(value.to_le_bytes());
            }
        };
        list(&self.parameters);
        list(&self.inputs);
        list(&self.given);
        list(&self.applied);
        for field in self.state.fields() {
            list(field);
        }
        list(&[self.importer_tolerance, self.start]);
        for counter in self.state.stepping.counters.numbers() {
            bytes.extend(counter.to_le_bytes());
        }
        bytes.extend(u64::from(self.initialized).to_le_bytes());
        let coefficients = &self.state.stepping.ahead.coefficients;
        bytes.extend((self.state.physical.memory.touches.len() as u64).to_le_bytes());
        bytes.extend((self.state.stepping.loads.len() as u64).to_le_bytes());
        bytes.extend((coefficients.len() as u64).to_le_bytes());
        for touch in &self.state.physical.memory.touches {
            bytes.extend((touch.slot as u64).to_le_bytes());
            for value in touch.numbers() {
                bytes.extend(value.to_le_bytes());
            }
        }
        for load in &self.state.stepping.loads {
            bytes.extend((load.slot as u64).to_le_bytes());
            for value in load.force {
                bytes.extend(value.to_le_bytes());
            }
        }
        for value in coefficients {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(fnv1a(&bytes).to_le_bytes());
        bytes
    }

    /// Length of [`Self::to_bytes`].
    pub fn byte_len(&self) -> usize {
        let fields = self.state.fields();
        let numbers = self.parameters.len()
            + self.inputs.len()
            + self.given.len()
            + self.applied.len()
            + fields.iter().map(|f| f.len()).sum::<usize>()
            + 2;
        let lists = fields.len() + 5;
        let touches = TOUCH / 8 * self.state.physical.memory.touches.len();
        let loads = LOAD / 8 * self.state.stepping.loads.len();
        let coefficients = self.state.stepping.ahead.coefficients.len();
        16 + 8
            * (numbers
                + lists
                + self.state.stepping.counters.numbers().len()
                + touches
                + loads
                + coefficients
                + 5)
    }

    /// Numbers of touches, loads and coefficients in `bytes`, if they are possible and fit their
    /// length; `self` has none of them.
    #[cfg_attr(small, optimize(size))]
    fn counts(&self, model: &Model, bytes: &[u8]) -> Option<[usize; 3]> {
        let fixed = self.byte_len();
        let counts = bytes.get(fixed.checked_sub(32)?..fixed - 8)?;
        let mut reader = Reader { bytes: counts };
        let touches = usize::try_from(reader.integer()).ok()?;
        let loads = usize::try_from(reader.integer()).ok()?;
        let coefficients = usize::try_from(reader.integer()).ok()?;
        let possible = touches.max(loads) <= model.slots()
            && (coefficients == 0 || coefficients == COEFFICIENTS * (model.nq + model.nv()));
        let fits = || bytes.len() == fixed + TOUCH * touches + LOAD * loads + 8 * coefficients;
        (possible && fits()).then_some([touches, loads, coefficients])
    }

    /// One of nothing yet, with lists as long as those of the model.
    fn blank(model: &Model, hash: u64, parameters: &Parameters, inputs: &Inputs) -> Self {
        Self {
            hash,
            parameters: parameters.values.clone(),
            inputs: inputs.numbers.clone(),
            given: inputs.given.clone(),
            applied: inputs.numbers.clone(),
            state: State::new(model),
            importer_tolerance: 0.0,
            start: 0.0,
            initialized: false,
        }
    }

    /// Reads what [`Self::to_bytes`] wrote for the same model.
    ///
    /// # Errors
    /// [`SavedStateError`] for anything else.
    pub fn from_bytes(model: &Model, bytes: &[u8]) -> Result<Self, SavedStateError> {
        Self::with_hash(model, model_hash(model), bytes)
    }

    /// The same where the model's hash is known: it costs more than all the rest.
    pub(crate) fn with_hash(
        model: &Model,
        hash: u64,
        bytes: &[u8],
    ) -> Result<Self, SavedStateError> {
        let refused = |reason: &str| SavedStateError {
            reason: reason.into(),
        };
        let start = Inputs::new(model);
        let defaults = Parameters::new(model);
        let mut snapshot = Self::blank(model, hash, &defaults, &start);
        if bytes.get(..4) != Some(MAGIC) {
            return Err(refused("it does not begin with this format's mark"));
        }
        if bytes.get(4..8) != Some(&VERSION.to_le_bytes()) {
            return Err(refused("it was written by another version"));
        }
        if bytes.get(8..16) != Some(&hash.to_le_bytes()) {
            return Err(refused("it belongs to another model"));
        }
        let [touches, loads, coefficients] = snapshot
            .counts(model, bytes)
            .ok_or_else(|| refused("its length is not that of this model's states"))?;
        let (body, checksum) = bytes.split_at(bytes.len() - 8);
        if checksum != fnv1a(body).to_le_bytes() {
            return Err(refused(
                "its checksum does not match: some of it was changed",
            ));
        }
        let mut reader = Reader { bytes: &body[16..] };
        let mut tail = [0.0; 2];
        let Self {
            parameters,
            inputs,
            given,
            applied,
            state,
            ..
        } = &mut snapshot;
        let mut complete = reader.list(parameters)
            && reader.list(inputs)
            && reader.list(given)
            && reader.list(applied);
        for field in state.fields_mut() {
            complete = complete && reader.list(field);
        }
        complete = complete && reader.list(&mut tail);
        let counters = std::array::from_fn(|_| reader.integer());
        snapshot.state.stepping.counters = Counters::from_numbers(counters);
        let initialized = reader.integer();
        complete = complete && initialized <= 1;
        snapshot.initialized = initialized == 1;
        // Known already: the counts.
        for _ in 0..3 {
            reader.integer();
        }
        for _ in 0..touches {
            let slot = usize::try_from(reader.integer()).unwrap_or(usize::MAX);
            let mut numbers = [0.0; 8];
            reader.numbers(&mut numbers);
            let ascending = snapshot
                .state
                .physical
                .memory
                .touches
                .last()
                .is_none_or(|last| last.slot < slot);
            complete = complete && ascending && slot < model.slots();
            let touch = Touch::from_numbers(slot, numbers);
            snapshot.state.physical.memory.touches.push(touch);
        }
        for _ in 0..loads {
            let slot = usize::try_from(reader.integer()).unwrap_or(usize::MAX);
            let mut force = [0.0; 3];
            reader.numbers(&mut force);
            let list = &mut snapshot.state.stepping.loads;
            let ascending = list.last().is_none_or(|last| last.slot < slot);
            complete = complete && ascending && slot < model.slots();
            list.push(Load { slot, force });
        }
        snapshot
            .state
            .stepping
            .ahead
            .coefficients
            .resize(coefficients, 0.0);
        reader.numbers(&mut snapshot.state.stepping.ahead.coefficients);
        let ahead = &snapshot.state.stepping.ahead;
        let under_way = ahead.length.iter().any(|length| *length > 0.0);
        complete = complete && under_way != ahead.coefficients.is_empty();
        [snapshot.importer_tolerance, snapshot.start] = tail;
        // Effort limits may be infinite.
        let sound = defaults.allow(&snapshot.parameters)
            && start.is_sound(&snapshot.inputs)
            && Inputs::tells_given(&snapshot.given)
            && start.is_sound(&snapshot.applied)
            && snapshot.state.is_finite()
            && snapshot.state.lengths_are_positive();
        if !complete || !sound {
            return Err(refused("its contents are not those of a state"));
        }
        Ok(snapshot)
    }
}

/// Takes numbers off the front; the total length has been checked.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn integer(&mut self) -> u64 {
        let Some((head, tail)) = self.bytes.split_first_chunk::<8>() else {
            return u64::MAX;
        };
        self.bytes = tail;
        u64::from_le_bytes(*head)
    }

    /// Fills a list of known length; false if the bytes say another.
    fn list(&mut self, values: &mut [f64]) -> bool {
        let known = self.integer() == values.len() as u64;
        if known {
            self.numbers(values);
        }
        known
    }

    fn numbers(&mut self, values: &mut [f64]) {
        for value in values {
            *value = f64::from_bits(self.integer());
        }
    }
}
