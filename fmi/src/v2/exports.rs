//! The exported functions, common and co-simulation, in the order of the FMI headers. Each is a
//! call of the guard.
//!
//! The safety contract of all of them is the standard's: pointers are null or valid for the
//! announced lengths during the call, a component comes from fmi2Instantiate and is not yet freed,
//! a saved state comes from fmi2GetFMUstate or fmi2DeSerializeFMUstate and is not yet freed.
//!
//! Over 500 lines because the functions of the C interface stand together in the order of the
//! standard: a reader compares them line by line with its headers.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 2.0's"
)]

use super::phase::Function;
use super::types::{
    FMI2_CO_SIMULATION, FMI2_DO_STEP_STATUS, FMI2_FALSE, FMI2_LAST_SUCCESSFUL_TIME,
    FMI2_MODEL_EXCHANGE, FMI2_PENDING_STATUS, FMI2_TERMINATED, FMI2_TRUE, fmi2Boolean, fmi2Byte,
    fmi2CallbackFunctions, fmi2Component, fmi2FMUstate, fmi2Integer, fmi2Real, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2Type, fmi2ValueReference,
};
use crate::call::{call, free, into_pointer};
use crate::common::{Interface, Version};
use crate::control_word;
use crate::error::{FmiError, InstantiateError};
use crate::load::{load, made};
use crate::logger::{Logger, Sink};
use crate::panics;
use crate::pointers::{self, In, Out};
use crate::snapshot::{self, SavedState};
use std::ffi::CString;
use urdf2fmu_core::variables::Kind;

const OK: Result<fmi2Status, FmiError> = Ok(fmi2Status::OK);

/// The header's platform.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> fmi2String {
    c"default".as_ptr()
}

/// The standard's version.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> fmi2String {
    c"2.0".as_ptr()
}

/// Chooses log categories; see the logger for what on and off mean.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    loggingOn: fmi2Boolean,
    nCategories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetDebugLogging, |instance| {
            let mut names = Vec::new();
            for name in In::new("categories", categories, nCategories)?.iter() {
                let argument = "categories";
                names.push(pointers::text(name).ok_or(FmiError::NullPointer { argument })?);
            }
            instance.set_debug_logging(loggingOn != FMI2_FALSE, &names)?;
            OK
        })
    }
}

/// A new instance, or null with the reason logged. All arguments are copied.
#[unsafe(no_mangle)]
#[cfg_attr(small, optimize(size))]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: fmi2String,
    fmuType: fmi2Type,
    fmuGUID: fmi2String,
    fmuResourceLocation: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    loggingOn: fmi2Boolean,
) -> fmi2Component {
    let _word = control_word::Guard::new();
    panics::silence();
    // SAFETY: FMI's contract; null strings and null callbacks are survived.
    let (name, guid, location, functions) = unsafe {
        (
            pointers::bytes(instanceName).unwrap_or_default(),
            pointers::text(fmuGUID).unwrap_or_default(),
            pointers::bytes(fmuResourceLocation).unwrap_or_default(),
            pointers::read("functions", functions).ok(),
        )
    };
    let (callback, environment) = functions.map_or((None, std::ptr::null_mut()), |functions| {
        (functions.logger, functions.componentEnvironment)
    });
    let name = CString::new(name).unwrap_or_default();
    let sink = callback.map_or(Sink::None, |callback| Sink::Fmi2(callback, name));
    let logger = Logger::new(sink, environment, loggingOn != FMI2_FALSE);
    let instance = made("fmi2Instantiate", &logger, || {
        let integrated_by = match fmuType {
            FMI2_MODEL_EXCHANGE => Interface::ModelExchange,
            FMI2_CO_SIMULATION => Interface::CoSimulation,
            found => return Err(InstantiateError::Type { found }),
        };
        load(Version::V2, integrated_by, &guid, &location, logger.clone())
    });
    instance.map_or(std::ptr::null_mut(), into_pointer)
}

/// Frees an instance; null is legal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    // SAFETY: FMI's contract.
    unsafe { free::<Function>(c) }
}

/// Start, stop and tolerance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    toleranceDefined: fmi2Boolean,
    tolerance: fmi2Real,
    startTime: fmi2Real,
    stopTimeDefined: fmi2Boolean,
    stopTime: fmi2Real,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetupExperiment, |instance| {
            instance.setup_experiment(
                (toleranceDefined != FMI2_FALSE).then_some(tolerance),
                startTime,
                (stopTimeDefined != FMI2_FALSE).then_some(stopTime),
            )?;
            OK
        })
    }
}

/// Begins initialisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::EnterInitializationMode, |instance| {
            instance.enter_initialization_mode();
            OK
        })
    }
}

/// Puts the robot into its initial state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::ExitInitializationMode, |instance| {
            instance.exit_initialization_mode()?;
            OK
        })
    }
}

/// Ends the simulation; outputs can still be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::Terminate, |instance| {
            instance.terminate();
            OK
        })
    }
}

/// Back to a new instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::Reset, |instance| {
            instance.reset();
            OK
        })
    }
}

macro_rules! get_and_set {
    ($get:ident $get_function:ident, $set:ident $set_function:ident, $kind:ident: $type:ty, $from:expr, $to:expr) => {
        /// Reads variables of this type.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            c: fmi2Component,
            vr: *const fmi2ValueReference,
            nvr: usize,
            value: *mut $type,
        ) -> fmi2Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(c, Function::$get_function, |instance| {
                    let vr = In::new("vr", vr, nvr)?;
                    let mut value = Out::new("value", value, nvr)?;
                    instance.get(Kind::$kind, &vr, &mut value, $from)?;
                    OK
                })
            }
        }

        /// Sets variables of this type: all of them or none.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            c: fmi2Component,
            vr: *const fmi2ValueReference,
            nvr: usize,
            value: *const $type,
        ) -> fmi2Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(c, Function::$set_function, |instance| {
                    let vr = In::new("vr", vr, nvr)?;
                    let value = In::new("value", value, nvr)?;
                    instance.set(Kind::$kind, &vr, &value, $to)?;
                    OK
                })
            }
        }
    };
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "saturates: counters stop at the largest Integer"
)]
fn integer(number: f64) -> fmi2Integer {
    number as fmi2Integer
}

fn boolean(number: f64) -> fmi2Boolean {
    if number == 0.0 { FMI2_FALSE } else { FMI2_TRUE }
}

get_and_set!(fmi2GetReal GetReal, fmi2SetReal SetReal, Real: fmi2Real, |x| x, |x| x);
get_and_set!(fmi2GetInteger GetInteger, fmi2SetInteger SetInteger, Integer: fmi2Integer, integer, f64::from);
get_and_set!(fmi2GetBoolean GetBoolean, fmi2SetBoolean SetBoolean, Boolean: fmi2Boolean, boolean,
    |value| f64::from(u8::from(value != FMI2_FALSE)));

/// There are no String variables: legal without elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetString, |instance| {
            Out::new("value", value, nvr)?;
            instance.refuse("String", &In::new("vr", vr, nvr)?)?;
            OK
        })
    }
}

/// There are no String variables: legal without elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2String,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetString, |instance| {
            In::new("value", value, nvr)?;
            instance.refuse("String", &In::new("vr", vr, nvr)?)?;
            OK
        })
    }
}

/// Copies the state, into an earlier copy where `*FMUstate` is not null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetFMUstate, |instance| {
            let state = pointers::read("FMUstate", FMUstate)?;
            if state.is_null() {
                pointers::write("FMUstate", FMUstate, instance.save().into_pointer())?;
            } else {
                instance.save_into(snapshot::saved(state)?);
            }
            OK
        })
    }
}

/// Continues from a copy, which stays as it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetFMUstate, |instance| {
            instance.restore(snapshot::saved(FMUstate)?)?;
            OK
        })
    }
}

/// Frees a copy and sets the pointer to null; null is legal.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::FreeFMUstate, |_| {
            if !FMUstate.is_null() {
                snapshot::free(pointers::read("FMUstate", FMUstate)?)?;
                pointers::write("FMUstate", FMUstate, std::ptr::null_mut())?;
            }
            OK
        })
    }
}

/// Bytes that fmi2SerializeFMUstate needs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SerializedFMUstateSize, |_| {
            pointers::write("size", size, snapshot::saved(FMUstate)?.byte_len())?;
            OK
        })
    }
}

/// Writes a copy as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SerializeFMUstate, |_| {
            let state = snapshot::saved(FMUstate)?;
            state.write_to(&mut Out::new(
                "serializedState",
                serializedState.cast::<u8>(),
                size,
            )?)?;
            OK
        })
    }
}

/// Makes a copy from bytes of the same FMU, also of another instance or process.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serializedState: *const fmi2Byte,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::DeSerializeFMUstate, |instance| {
            let bytes: Vec<u8> = In::new("serializedState", serializedState.cast::<u8>(), size)?
                .iter()
                .collect();
            if FMUstate.is_null() {
                return Err(FmiError::NullPointer {
                    argument: "FMUstate",
                });
            }
            let state = SavedState::from_bytes(
                instance.guid(),
                instance.version(),
                instance.simulation(),
                &bytes,
            )?;
            pointers::write("FMUstate", FMUstate, state.into_pointer())?;
            OK
        })
    }
}

/// Partial derivatives of outputs and derivatives by states and inputs, along a direction; in
/// co-simulation not offered, and legal without elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    vUnknown_ref: *const fmi2ValueReference,
    nUnknown: usize,
    vKnown_ref: *const fmi2ValueReference,
    nKnown: usize,
    dvKnown: *const fmi2Real,
    dvUnknown: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetDirectionalDerivative, |instance| {
            let unknowns = In::new("vUnknown_ref", vUnknown_ref, nUnknown)?;
            let knowns = In::new("vKnown_ref", vKnown_ref, nKnown)?;
            let seeds = In::new("dvKnown", dvKnown, nKnown)?;
            let mut found = Out::new("dvUnknown", dvUnknown, nUnknown)?;
            if instance.integrated_by() == Interface::ModelExchange {
                instance.directional_derivative(&unknowns, &knowns, &seeds, &mut found)?;
                return OK;
            }
            if found.len() == 0 {
                return OK;
            }
            Err(FmiError::NotOffered {
                what: "directional derivatives",
                attribute: "providesDirectionalDerivative=\"false\"",
            })
        })
    }
}

/// Sets derivatives of inputs for the next step: all of them or none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetRealInputDerivatives, |instance| {
            let vr = In::new("vr", vr, nvr)?;
            let order = In::new("order", order, nvr)?;
            let value = In::new("value", value, nvr)?;
            instance.set_input_derivatives(&vr, &order, &value)?;
            OK
        })
    }
}

/// First derivatives of positions, orientations and velocities.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetRealOutputDerivatives, |instance| {
            let vr = In::new("vr", vr, nvr)?;
            let order = In::new("order", order, nvr)?;
            let mut value = Out::new("value", value, nvr)?;
            instance.output_derivatives(&vr, &order, &mut value)?;
            OK
        })
    }
}

/// Simulates from `currentCommunicationPoint` to exactly
/// `currentCommunicationPoint + communicationStepSize`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    c: fmi2Component,
    currentCommunicationPoint: fmi2Real,
    communicationStepSize: fmi2Real,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::DoStep, |instance| {
            instance.do_step(currentCommunicationPoint, communicationStepSize)
        })
    }
}

/// Refused: no step is ever pending.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe { call(c, Function::CancelStep, |_| Ok(fmi2Status::Error)) }
}

/// `fmi2DoStepStatus`: what the last step returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Status,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetStatus, |instance| {
            expect_kind(s, FMI2_DO_STEP_STATUS, "fmi2Status")?;
            pointers::write("value", value, instance.do_step_status())?;
            OK
        })
    }
}

/// `fmi2LastSuccessfulTime`: where the simulation stands, s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetRealStatus, |instance| {
            expect_kind(s, FMI2_LAST_SUCCESSFUL_TIME, "Real")?;
            pointers::write("value", value, instance.last_successful_time())?;
            OK
        })
    }
}

/// No status kind has an Integer value: `fmi2Discard`, as for every status that the FMU cannot
/// tell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetIntegerStatus, |_| {
            Err(FmiError::StatusKind {
                kind: s,
                is: "Integer",
            })
        })
    }
}

/// `fmi2Terminated`: this FMU never ends a simulation by itself.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetBooleanStatus, |_| {
            expect_kind(s, FMI2_TERMINATED, "Boolean")?;
            pointers::write("value", value, FMI2_FALSE)?;
            OK
        })
    }
}

/// `fmi2PendingStatus`: steps are finished when fmi2DoStep returns.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::GetStringStatus, |fmu| {
            expect_kind(s, FMI2_PENDING_STATUS, "String")?;
            let text = match fmu.do_step_status() {
                fmi2Status::Discard => c"no step is pending; the last one was discarded",
                _ => c"no step is pending",
            };
            pointers::write("value", value, text.as_ptr())?;
            OK
        })
    }
}

fn expect_kind(kind: i32, expected: i32, is: &'static str) -> Result<(), FmiError> {
    if kind == expected {
        Ok(())
    } else {
        Err(FmiError::StatusKind { kind, is })
    }
}
