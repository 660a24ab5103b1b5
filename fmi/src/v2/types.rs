//! The types of fmi2TypesPlatform.h and fmi2FunctionTypes.h, spelled as there.
//!
//! What comes from C stays an integer until it has been checked: an incoming value outside a Rust
//! enum would be undefined behaviour. Only the status, which this library alone produces, is an
//! enum.

#![allow(
    non_camel_case_types,
    non_snake_case,
    reason = "the names of the FMI 2.0 headers are kept"
)]

use crate::common::LoggerOfFmi2;
pub use crate::common::Status as fmi2Status;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// Opaque pointer to an instance.
pub type fmi2Component = *mut c_void;
/// Opaque pointer that belongs to the importer.
pub type fmi2ComponentEnvironment = *mut c_void;
/// Opaque pointer to a saved state.
pub type fmi2FMUstate = *mut c_void;
/// Handle of a variable.
pub type fmi2ValueReference = c_uint;
/// `double`
pub type fmi2Real = f64;
/// `int`
pub type fmi2Integer = c_int;
/// `int`: 0 is false.
pub type fmi2Boolean = c_int;
/// Zero-terminated UTF-8.
pub type fmi2String = *const c_char;
/// Smallest addressable unit.
pub type fmi2Byte = c_char;
/// `fmi2Type`: [`FMI2_MODEL_EXCHANGE`] or [`FMI2_CO_SIMULATION`].
pub type fmi2Type = c_int;
/// `fmi2StatusKind`: one of [`FMI2_DO_STEP_STATUS`] and those below it.
pub type fmi2StatusKind = c_int;

/// `fmi2True`
pub const FMI2_TRUE: fmi2Boolean = 1;
/// `fmi2False`
pub const FMI2_FALSE: fmi2Boolean = 0;
/// `fmi2ModelExchange`
pub const FMI2_MODEL_EXCHANGE: fmi2Type = 0;
/// `fmi2CoSimulation`
pub const FMI2_CO_SIMULATION: fmi2Type = 1;
/// `fmi2DoStepStatus`
pub const FMI2_DO_STEP_STATUS: fmi2StatusKind = 0;
/// `fmi2PendingStatus`
pub const FMI2_PENDING_STATUS: fmi2StatusKind = 1;
/// `fmi2LastSuccessfulTime`
pub const FMI2_LAST_SUCCESSFUL_TIME: fmi2StatusKind = 2;
/// `fmi2Terminated`
pub const FMI2_TERMINATED: fmi2StatusKind = 3;

/// `fmi2CallbackLogger`; variadic, the message is a printf format.
pub type fmi2CallbackLogger = LoggerOfFmi2;
/// `fmi2CallbackAllocateMemory`; never called.
pub type fmi2CallbackAllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `fmi2CallbackFreeMemory`; never called.
pub type fmi2CallbackFreeMemory = unsafe extern "C" fn(*mut c_void);
/// `fmi2StepFinished`; never called, steps are synchronous.
pub type fmi2StepFinished = unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status);

/// `fmi2CallbackFunctions`
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fmi2CallbackFunctions {
    /// May be null.
    pub logger: Option<fmi2CallbackLogger>,
    /// May be null.
    pub allocateMemory: Option<fmi2CallbackAllocateMemory>,
    /// May be null.
    pub freeMemory: Option<fmi2CallbackFreeMemory>,
    /// May be null.
    pub stepFinished: Option<fmi2StepFinished>,
    /// Passed back as it came; may be null.
    pub componentEnvironment: fmi2ComponentEnvironment,
}

/// `fmi2EventInfo`; the default one says that nothing happens.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct fmi2EventInfo {
    /// Whether discrete states are to be computed again.
    pub newDiscreteStatesNeeded: fmi2Boolean,
    /// Whether the simulation is to end.
    pub terminateSimulation: fmi2Boolean,
    /// Whether nominal values have changed.
    pub nominalsOfContinuousStatesChanged: fmi2Boolean,
    /// Whether states have been set by the FMU.
    pub valuesOfContinuousStatesChanged: fmi2Boolean,
    /// Whether `nextEventTime` holds.
    pub nextEventTimeDefined: fmi2Boolean,
    /// s
    pub nextEventTime: fmi2Real,
}
