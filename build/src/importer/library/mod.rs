//! The C functions of an FMU's library: the only unsafe code of this package, except for the code
//! that runs before `main`.
//!
//! [`Slave`] is the safe interface for both versions of FMI: it owns the library and one instance,
//! passes each function its arrays, and frees both in the right order.

mod elements;
mod fmi2;
mod fmi3;
mod interface;
mod shared;

pub use elements::Element;
pub use interface::Interface;
pub use shared::{Completed, LibraryError, Message, Stepped, Update, uri};
use std::path::Path;

/// An instance of an FMU, with its library.
pub enum Slave {
    /// Of FMI 2.0; variables are known by their value references.
    Fmi2(fmi2::Slave),
    /// Of FMI 3.0; variables, and elements of arrays, by their place in a list.
    Fmi3(fmi3::Slave),
}

macro_rules! each {
    ($self:ident, $slave:ident => $call:expr) => {
        match $self {
            Self::Fmi2($slave) => $call,
            Self::Fmi3($slave) => $call,
        }
    };
}

impl Slave {
    /// Loads a library and makes an instance of FMI 2.0.
    ///
    /// - `resources`: a URI
    ///
    /// # Errors
    /// [`LibraryError`], as for all below.
    pub fn of_fmi_2(
        library: &Path,
        guid: &str,
        resources: &str,
        interface: Interface,
        debug_logging: bool,
    ) -> Result<Self, LibraryError> {
        fmi2::Slave::new(library, guid, resources, interface, debug_logging).map(Self::Fmi2)
    }

    /// Loads a library and makes an instance of FMI 3.0.
    ///
    /// - `resources`: a path
    /// - `elements`: what the numbers of variables mean
    pub fn of_fmi_3(
        library: &Path,
        token: &str,
        resources: &str,
        elements: Vec<Element>,
        interface: Interface,
        debug_logging: bool,
    ) -> Result<Self, LibraryError> {
        fmi3::Slave::new(
            library,
            token,
            resources,
            elements,
            interface,
            debug_logging,
        )
        .map(Self::Fmi3)
    }

    /// What has been said since the last time.
    pub fn messages(&self) -> Vec<Message> {
        each!(self, slave => slave.messages())
    }

    /// How many messages there are since the last time.
    pub fn heard(&self) -> usize {
        each!(self, slave => slave.heard())
    }

    /// Takes back the complaints after so many messages: those of a call whose failure is none.
    pub fn forget_complaints(&self, since: usize) {
        each!(self, slave => slave.forget_complaints(since));
    }

    /// Times and tolerance of the experiment.
    pub fn setup(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), LibraryError> {
        each!(self, slave => slave.setup(tolerance, start, stop))
    }

    /// Enters initialization mode.
    pub fn enter_initialization(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.enter_initialization())
    }

    /// Exits initialization mode.
    pub fn exit_initialization(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.exit_initialization())
    }

    /// Ends the simulation.
    pub fn terminate(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.terminate())
    }

    /// Back to as after its making.
    pub fn reset(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.reset())
    }

    /// Takes a step.
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<Stepped, LibraryError> {
        each!(self, slave => slave.do_step(time, step))
    }

    /// Reads numbers; `values` is as long as `references`.
    pub fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_real(references, values))
    }

    /// Reads whole numbers.
    pub fn get_integer(
        &mut self,
        references: &[u32],
        values: &mut [i32],
    ) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_integer(references, values))
    }

    /// Reads flags: 0 is false.
    pub fn get_boolean(
        &mut self,
        references: &[u32],
        values: &mut [i32],
    ) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_boolean(references, values))
    }

    /// Sets numbers.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.set_real(references, values))
    }

    /// Sets a whole number.
    pub fn set_integer(&mut self, reference: u32, value: i32) -> Result<(), LibraryError> {
        each!(self, slave => slave.set_integer(reference, value))
    }

    /// Sets a flag.
    pub fn set_boolean(&mut self, reference: u32, value: bool) -> Result<(), LibraryError> {
        each!(self, slave => slave.set_boolean(reference, value))
    }

    /// Sets first derivatives of inputs; FMI 3 has none.
    pub fn set_slopes(&mut self, references: &[u32], slopes: &[f64]) -> Result<(), LibraryError> {
        match self {
            Self::Fmi2(slave) => slave.set_slopes(references, slopes),
            Self::Fmi3(_) => Ok(()),
        }
    }

    /// Model Exchange: inputs and parameters may jump.
    pub fn enter_event_mode(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.enter_event_mode())
    }

    /// Model Exchange: what follows from an event.
    pub fn update_discrete_states(&mut self) -> Result<Update, LibraryError> {
        each!(self, slave => slave.update_discrete_states())
    }

    /// Model Exchange: states follow the importer.
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), LibraryError> {
        each!(self, slave => slave.enter_continuous_time_mode())
    }

    /// Model Exchange: the importer has taken a step, and does not go back before its end.
    pub fn completed_step(&mut self) -> Result<Completed, LibraryError> {
        each!(self, slave => slave.completed_step())
    }

    /// Model Exchange: sets the time, s.
    pub fn set_time(&mut self, time: f64) -> Result<(), LibraryError> {
        each!(self, slave => slave.set_time(time))
    }

    /// Model Exchange: sets all states.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.set_states(states))
    }

    /// Model Exchange: reads all states.
    pub fn get_states(&mut self, states: &mut [f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_states(states))
    }

    /// Model Exchange: reads the derivatives of all states.
    pub fn get_rates(&mut self, rates: &mut [f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_rates(rates))
    }

    /// Model Exchange: reads the sizes of the states to expect.
    pub fn get_nominals(&mut self, nominals: &mut [f64]) -> Result<(), LibraryError> {
        each!(self, slave => slave.get_nominals(nominals))
    }
}
