//! The exported functions of an instance's life, its states and its steps, in the order of the FMI
//! headers. Each is a call of the guard.
//!
//! The safety contract of all of them is the standard's: pointers are null or valid for the
//! announced lengths during the call, an instance comes from fmi3InstantiateCoSimulation and is not
//! yet freed, a saved state comes from fmi3GetFMUState or fmi3DeserializeFMUState and is not yet
//! freed.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 3.0's"
)]

use super::phase::Function;
use super::step::{self, Told};
use super::types::{
    FMI3_FALSE, fmi3Boolean, fmi3Byte, fmi3ClockUpdateCallback, fmi3FMUState, fmi3Float64,
    fmi3Instance, fmi3InstanceEnvironment, fmi3Int32, fmi3IntermediateUpdateCallback,
    fmi3LogMessageCallback, fmi3PreemptionCallback, fmi3Status, fmi3String, fmi3ValueReference,
};
use crate::call::{call, free, into_pointer};
use crate::common::{Interface, Version};
use crate::control_word;
use crate::error::{FmiError, InstantiateError};
use crate::instance::Callback;
use crate::load::{load, made};
use crate::logger::{Logger, Sink};
use crate::panics;
use crate::pointers::{self, In, Out};
use crate::snapshot::{self, SavedState};
use std::ptr::null_mut;

const OK: Result<fmi3Status, FmiError> = Ok(fmi3Status::OK);

/// The standard's version.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> fmi3String {
    c"3.0".as_ptr()
}

/// Chooses log categories; see the logger for what on and off mean.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: fmi3Instance,
    loggingOn: fmi3Boolean,
    nCategories: usize,
    categories: *const fmi3String,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SetDebugLogging, |instance| {
            let mut names = Vec::new();
            for name in In::new("categories", categories, nCategories)?.iter() {
                let argument = "categories";
                names.push(pointers::text(name).ok_or(FmiError::NullPointer { argument })?);
            }
            instance.set_debug_logging(loggingOn != FMI3_FALSE, &names)?;
            OK
        })
    }
}

/// A new instance, or null with the reason logged. All arguments but the callbacks and their
/// environment are copied.
#[unsafe(no_mangle)]
#[cfg_attr(small, optimize(size))]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _instanceName: fmi3String,
    instantiationToken: fmi3String,
    resourcePath: fmi3String,
    _visible: fmi3Boolean,
    loggingOn: fmi3Boolean,
    eventModeUsed: fmi3Boolean,
    earlyReturnAllowed: fmi3Boolean,
    requiredIntermediateVariables: *const fmi3ValueReference,
    nRequiredIntermediateVariables: usize,
    instanceEnvironment: fmi3InstanceEnvironment,
    logMessage: Option<fmi3LogMessageCallback>,
    intermediateUpdate: Option<fmi3IntermediateUpdateCallback>,
) -> fmi3Instance {
    let _word = control_word::Guard::new();
    panics::silence();
    let logger = logger(logMessage, instanceEnvironment, loggingOn);
    // SAFETY: FMI's contract.
    let (token, path) = unsafe { identity(instantiationToken, resourcePath) };
    let may_end_early = earlyReturnAllowed != FMI3_FALSE;
    let instance = made("fmi3InstantiateCoSimulation", &logger, || {
        let wrong = |why: &str| Err(InstantiateError::Arguments(why.to_owned()));
        if eventModeUsed != FMI3_FALSE {
            return wrong(
                "eventModeUsed is true, but modelDescription.xml says hasEventMode=\"false\"",
            );
        }
        let (n, list) = (
            nRequiredIntermediateVariables,
            requiredIntermediateVariables,
        );
        // SAFETY: FMI's contract.
        let required = unsafe { In::new("requiredIntermediateVariables", list, n) }
            .map_err(|error| InstantiateError::Arguments(error.to_string()))?;
        let mut instance = load(
            Version::V3,
            Interface::CoSimulation,
            &token,
            &path,
            logger.clone(),
        )?;
        match intermediateUpdate {
            None if n > 0 => {
                return wrong(
                    "there are requiredIntermediateVariables, but intermediateUpdate is NULL",
                );
            }
            Some(function) if n > 0 || may_end_early => {
                let callback = Callback {
                    function,
                    environment: instanceEnvironment,
                    may_end_early,
                };
                instance.call_within_steps(callback, required.iter())?;
            }
            _ => {}
        }
        Ok(instance)
    });
    instance.map_or(null_mut(), into_pointer)
}

/// Token and path of resources; null ones are empty.
///
/// # Safety
/// As [`pointers::bytes`].
unsafe fn identity(token: fmi3String, path: fmi3String) -> (String, Vec<u8>) {
    // SAFETY: the caller's promise.
    unsafe {
        (
            pointers::text(token).unwrap_or_default(),
            pointers::bytes(path).unwrap_or_default(),
        )
    }
}

fn logger(
    callback: Option<fmi3LogMessageCallback>,
    environment: fmi3InstanceEnvironment,
    on: fmi3Boolean,
) -> Logger {
    let sink = callback.map_or(Sink::None, Sink::Fmi3);
    Logger::new(sink, environment, on != FMI3_FALSE)
}

/// A new instance whose states the importer integrates, or null with the reason logged.
#[unsafe(no_mangle)]
#[cfg_attr(small, optimize(size))]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _instanceName: fmi3String,
    instantiationToken: fmi3String,
    resourcePath: fmi3String,
    _visible: fmi3Boolean,
    loggingOn: fmi3Boolean,
    instanceEnvironment: fmi3InstanceEnvironment,
    logMessage: Option<fmi3LogMessageCallback>,
) -> fmi3Instance {
    let _word = control_word::Guard::new();
    panics::silence();
    let logger = logger(logMessage, instanceEnvironment, loggingOn);
    // SAFETY: FMI's contract.
    let (token, path) = unsafe { identity(instantiationToken, resourcePath) };
    let instance = made("fmi3InstantiateModelExchange", &logger, || {
        load(
            Version::V3,
            Interface::ModelExchange,
            &token,
            &path,
            logger.clone(),
        )
    });
    instance.map_or(null_mut(), into_pointer)
}

/// Null: this FMU offers no Scheduled Execution.
#[unsafe(no_mangle)]
#[cfg_attr(small, optimize(size))]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _instanceName: fmi3String,
    _instantiationToken: fmi3String,
    _resourcePath: fmi3String,
    _visible: fmi3Boolean,
    _loggingOn: fmi3Boolean,
    instanceEnvironment: fmi3InstanceEnvironment,
    logMessage: Option<fmi3LogMessageCallback>,
    _clockUpdate: Option<fmi3ClockUpdateCallback>,
    _lockPreemption: Option<fmi3PreemptionCallback>,
    _unlockPreemption: Option<fmi3PreemptionCallback>,
) -> fmi3Instance {
    let why = "this FMU is for co-simulation or Model Exchange: modelDescription.xml lists no \
               <ScheduledExecution>";
    let logger = logger(logMessage, instanceEnvironment, FMI3_FALSE);
    let none = made("fmi3InstantiateScheduledExecution", &logger, || {
        Err(InstantiateError::Arguments(why.to_owned()))
    });
    debug_assert!(none.is_none());
    null_mut()
}

/// Frees an instance; null is legal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: fmi3Instance) {
    // SAFETY: FMI's contract.
    unsafe { free::<Function>(instance) }
}

/// Takes start, stop and tolerance, and begins initialisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: fmi3Instance,
    toleranceDefined: fmi3Boolean,
    tolerance: fmi3Float64,
    startTime: fmi3Float64,
    stopTimeDefined: fmi3Boolean,
    stopTime: fmi3Float64,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::EnterInitializationMode, |instance| {
            instance.setup_experiment(
                (toleranceDefined != FMI3_FALSE).then_some(tolerance),
                startTime,
                (stopTimeDefined != FMI3_FALSE).then_some(stopTime),
            )?;
            instance.enter_initialization_mode();
            OK
        })
    }
}

/// Puts the robot into its initial state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::ExitInitializationMode, |instance| {
            instance.exit_initialization_mode()?;
            OK
        })
    }
}

/// Ends the simulation; outputs can still be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::Terminate, |instance| {
            instance.terminate();
            OK
        })
    }
}

/// Back to a new instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::Reset, |instance| {
            instance.reset();
            OK
        })
    }
}

/// Copies the state, into an earlier copy where `*FMUState` is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    instance: fmi3Instance,
    FMUState: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::GetFMUState, |instance| {
            let state = pointers::read("FMUState", FMUState)?;
            if state.is_null() {
                pointers::write("FMUState", FMUState, instance.save().into_pointer())?;
            } else {
                instance.save_into(snapshot::saved(state)?);
            }
            OK
        })
    }
}

/// Continues from a copy, which stays as it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(
    instance: fmi3Instance,
    FMUState: fmi3FMUState,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SetFMUState, |instance| {
            instance.restore(snapshot::saved(FMUState)?)?;
            OK
        })
    }
}

/// Frees a copy and sets the pointer to null; null is legal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: fmi3Instance,
    FMUState: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::FreeFMUState, |_| {
            if !FMUState.is_null() {
                snapshot::free(pointers::read("FMUState", FMUState)?)?;
                pointers::write("FMUState", FMUState, null_mut())?;
            }
            OK
        })
    }
}

/// Bytes that fmi3SerializeFMUState needs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: fmi3Instance,
    FMUState: fmi3FMUState,
    size: *mut usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SerializedFMUStateSize, |_| {
            pointers::write("size", size, snapshot::saved(FMUState)?.byte_len())?;
            OK
        })
    }
}

/// Writes a copy as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: fmi3Instance,
    FMUState: fmi3FMUState,
    serializedState: *mut fmi3Byte,
    size: usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SerializeFMUState, |_| {
            let state = snapshot::saved(FMUState)?;
            state.write_to(&mut Out::new("serializedState", serializedState, size)?)?;
            OK
        })
    }
}

/// Makes a copy from bytes of the same FMU, also of another instance or process.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: fmi3Instance,
    serializedState: *const fmi3Byte,
    size: usize,
    FMUState: *mut fmi3FMUState,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::DeserializeFMUState, |instance| {
            let bytes = In::new("serializedState", serializedState, size)?;
            let bytes: Vec<u8> = bytes.iter().collect();
            if FMUState.is_null() {
                return Err(FmiError::NullPointer {
                    argument: "FMUState",
                });
            }
            let (guid, version) = (instance.guid(), instance.version());
            let state = SavedState::from_bytes(guid, version, instance.simulation(), &bytes)?;
            pointers::write("FMUState", FMUState, state.into_pointer())?;
            OK
        })
    }
}

/// First derivatives of positions, orientations and velocities.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: fmi3Instance,
    valueReferences: *const fmi3ValueReference,
    nValueReferences: usize,
    orders: *const fmi3Int32,
    values: *mut fmi3Float64,
    nValues: usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::GetOutputDerivatives, |instance| {
            let references = In::new("valueReferences", valueReferences, nValueReferences)?;
            let orders = In::new("orders", orders, nValueReferences)?;
            let mut values = Out::new("values", values, nValues)?;
            instance.output_derivatives(&references, &orders, &mut values)?;
            OK
        })
    }
}

/// Simulates from `currentCommunicationPoint` to exactly
/// `currentCommunicationPoint + communicationStepSize`, or to where the importer's callback asks
/// for an early return.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: fmi3Instance,
    currentCommunicationPoint: fmi3Float64,
    communicationStepSize: fmi3Float64,
    _noSetFMUStatePriorToCurrentPoint: fmi3Boolean,
    eventHandlingNeeded: *mut fmi3Boolean,
    terminateSimulation: *mut fmi3Boolean,
    earlyReturn: *mut fmi3Boolean,
    lastSuccessfulTime: *mut fmi3Float64,
) -> fmi3Status {
    let told = Told {
        event_handling_needed: eventHandlingNeeded,
        terminate_simulation: terminateSimulation,
        early_return: earlyReturn,
        last_successful_time: lastSuccessfulTime,
    };
    let (point, size) = (currentCommunicationPoint, communicationStepSize);
    // SAFETY: FMI's contract.
    unsafe { step::do_step(instance, point, size, told) }
}
