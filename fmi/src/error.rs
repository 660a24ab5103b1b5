//! Every error of a call, as data; its text goes to the importer's logger.

use crate::common::{Interface, Status, Version};
use crate::uri::UriError;
use urdf2fmu_core::digits::Digits;
use urdf2fmu_core::prepared::PreparedModelError;
use urdf2fmu_core::simulation::SimulationError;
use urdf2fmu_core::variables::TableError;

/// Why a call on an instance fails.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum FmiError {
    #[error("called in phase '{phase}'; {advice}")]
    Phase { phase: &'static str, advice: String },
    #[error("the instance was made by {made}…, and {made} functions alone may be called with it")]
    Version { made: Version },
    #[error("'{argument}' is NULL")]
    NullPointer { argument: &'static str },
    #[error("'{argument}' is NULL, but {len} elements are announced")]
    NullArray { argument: &'static str, len: usize },
    #[error("'{argument}' cannot have {len} elements")]
    Length { argument: &'static str, len: usize },
    #[error("no variable has value reference {value_reference}; they run from 0 to {}", count.saturating_sub(1))]
    ValueReference { value_reference: u32, count: usize },
    #[error("variable '{name}' (value reference {value_reference}) is {is}, not {asked}")]
    Kind {
        name: String,
        value_reference: u32,
        is: &'static str,
        asked: &'static str,
    },
    #[error(
        "value reference {value_reference} is an element of '{name}', which is got and set as a whole"
    )]
    Element { value_reference: u32, name: String },
    #[error("{given} values are announced, but the variables have {expected}")]
    Count { given: usize, expected: usize },
    #[error("the independent variable 'time' cannot be set")]
    Time,
    #[error(
        "variable '{name}' is not among the requiredIntermediateVariables of \
         fmi3InstantiateCoSimulation"
    )]
    NotRequired { name: String },
    #[error("output '{name}' cannot be set")]
    Output { name: String },
    #[error(
        "fixed parameter '{name}' cannot be set after {fmi}ExitInitializationMode; call {fmi}Reset and set it \
         before the next initialisation"
    )]
    Fixed { name: String, fmi: Version },
    #[error("parameter '{name}' can be set in event mode, not in continuous-time mode")]
    Continuous { name: String },
    #[error("{argument} has {given} elements, but there are {expected} continuous states")]
    StateCount {
        argument: &'static str,
        given: usize,
        expected: usize,
    },
    #[error("continuous state {index} must be a finite number, not {}", Digits(*value))]
    StateValue { index: usize, value: f64 },
    #[error(
        "partial derivatives by '{name}' are not offered here: they are by continuous states and inputs, \
         and in initialization mode by inputs and parameters that may change"
    )]
    NotKnown { name: String },
    #[error("partial derivatives of '{name}' are not offered: they are of outputs and derivatives")]
    NotUnknown { name: String },
    #[error("variable '{name}' must be {expected}, not {}", Digits(*value))]
    Value {
        name: String,
        expected: &'static str,
        value: f64,
    },
    #[error(
        "derivative of order {order} of variable '{name}' must be {expected}, not {}",
        Digits(*value)
    )]
    Derivative {
        name: String,
        order: i32,
        expected: &'static str,
        value: f64,
    },
    #[error("output '{name}' is not finite: masses, forces or speeds are out of proportion")]
    NotFinite { name: String },
    #[error("argument '{argument}' is {}; it must be {expected}", Digits(*value))]
    Argument {
        argument: &'static str,
        value: f64,
        expected: &'static str,
    },
    #[error(
        "the step would begin at {} s, but the instance is at {} s",
        Digits(*given), Digits(*expected)
    )]
    CommunicationPoint { given: f64, expected: f64 },
    #[error(
        "the step would begin at {} s, at or after the stop time {} s of {}",
        Digits(*begin), Digits(*stop), fmi.setup()
    )]
    StopTime { begin: f64, stop: f64, fmi: Version },
    #[error("{0}")]
    Simulation(#[from] SimulationError),
    #[error("saved state refused: {reason}")]
    State { reason: String },
    #[error("log category '{name}' is not declared in modelDescription.xml; nothing is changed")]
    Category { name: String },
    #[error("{what} are not offered: modelDescription.xml says {attribute}")]
    NotOffered {
        what: &'static str,
        attribute: &'static str,
    },
    #[error("status kind {kind} has no {is} value")]
    StatusKind { kind: i32, is: &'static str },
    #[error("variable '{name}' is no input: only inputs have derivatives that can be set")]
    NotInput { name: String },
    #[error("variable '{name}' is no output: only outputs have derivatives that can be read")]
    NotOutput { name: String },
    #[error("derivative of order {order} of variable '{name}': orders begin at 1")]
    Order { name: String, order: i32 },
    #[error("derivative of order {order} of variable '{name}': orders up to {highest} are known")]
    HighOrder {
        name: String,
        order: i32,
        highest: i32,
    },
    #[error(
        "output '{name}' has no derivative here: positions, orientations and velocities have one, efforts, \
         forces, accelerations and energies have none"
    )]
    NoDerivative { name: String },
    #[error("internal error: {message}; please report it")]
    Panic { message: String },
}

impl FmiError {
    /// What the function returns. `fmi2Discard` where FMI 2.0.4 foresees that the FMU has no answer
    /// and the importer can go on without it (sections 2.1.3 and 4.2.3).
    pub(crate) fn status(&self) -> Status {
        match self {
            Self::StatusKind { .. }
            | Self::HighOrder { .. }
            | Self::NoDerivative { .. }
            | Self::NotFinite { .. } => Status::Discard,
            _ => Status::Error,
        }
    }
}

/// Why there is no instance.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InstantiateError {
    #[error("fmuType is {found}; it is 0 for Model Exchange and 1 for co-simulation")]
    Type { found: i32 },
    #[error(
        "this FMU was exported for {has} only; export it with --interface {option} or --interface both"
    )]
    Interface {
        has: Interface,
        option: &'static str,
    },
    #[error("{0}")]
    Arguments(String),
    #[error("{argument} {error}; {advice}")]
    Uri {
        argument: &'static str,
        error: UriError,
        advice: &'static str,
    },
    #[error("cannot read '{path}': {error}; unzip the whole FMU and {advice}")]
    Read {
        path: String,
        error: std::io::Error,
        advice: &'static str,
    },
    #[error("'{path}': {error}")]
    Prepared {
        path: String,
        error: PreparedModelError,
    },
    #[error("'{path}': {error}")]
    Table { path: String, error: TableError },
    #[error(
        "{argument} is '{given}', but this FMU's is '{expected}': modelDescription.xml and resources belong to \
         different exports; unzip the FMU again"
    )]
    Guid {
        argument: &'static str,
        given: String,
        expected: String,
    },
    #[error(
        "internal error while loading: {message}; export the FMU again, and report it if that does not help"
    )]
    Panic { message: String },
}
