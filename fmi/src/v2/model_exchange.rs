//! The functions of Model Exchange, in the order of the FMI headers. The safety contract is that of
//! the other exports.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 2.0's"
)]

use super::phase::Function;
use super::types::{FMI2_FALSE, fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2Real, fmi2Status};
use crate::call::call;
use crate::error::FmiError;
use crate::instance::Instance;
use crate::pointers::{self, In, Out};

const OK: Result<fmi2Status, FmiError> = Ok(fmi2Status::OK);

/// Inputs and parameters may jump.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::EnterEventMode, |instance| {
            instance.enter_event_mode();
            OK
        })
    }
}

/// There are no discrete states: nothing is to be done again. Tells when shapes may meet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    c: fmi2Component,
    fmi2eventInfo: *mut fmi2EventInfo,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::NewDiscreteStates, |instance| {
            let next = instance.next_event();
            let info = fmi2EventInfo {
                nextEventTimeDefined: fmi2Boolean::from(next.is_some()),
                nextEventTime: next.unwrap_or(0.0),
                ..fmi2EventInfo::default()
            };
            pointers::write("fmi2eventInfo", fmi2eventInfo, info)?;
            OK
        })
    }
}

/// The importer integrates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::EnterContinuousTimeMode, |instance| {
            instance.enter_continuous_time_mode();
            OK
        })
    }
}

/// Tells whether contacts have begun or ended, or may be missed before the next event.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    enterEventMode: *mut fmi2Boolean,
    terminateSimulation: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::CompletedIntegratorStep, |instance| {
            let event = fmi2Boolean::from(instance.completed_step());
            pointers::write("enterEventMode", enterEventMode, event)?;
            pointers::write("terminateSimulation", terminateSimulation, FMI2_FALSE)?;
            OK
        })
    }
}

/// Sets the time, s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetTime, |instance| {
            instance.set_time(time)?;
            OK
        })
    }
}

/// Sets all states, in the order of the derivatives in modelDescription.xml.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(
    c: fmi2Component,
    x: *const fmi2Real,
    nx: usize,
) -> fmi2Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(c, Function::SetContinuousStates, |instance| {
            instance.set_continuous_states(&In::new("x", x, nx)?)?;
            OK
        })
    }
}

/// A function that fills an array of the importer.
macro_rules! filling {
    ($($(#[$doc:meta])* $function:ident $export:ident ($array:ident, $n:ident) $body:expr;)*) => {$(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $export(
            c: fmi2Component,
            $array: *mut fmi2Real,
            $n: usize,
        ) -> fmi2Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(c, Function::$function, |instance| {
                    let body: fn(&mut Instance, &mut Out<f64>) -> Result<(), FmiError> = $body;
                    body(instance, &mut Out::new(stringify!($array), $array, $n)?)?;
                    OK
                })
            }
        }
    )*};
}

filling! {
    /// Derivatives of all states.
    GetDerivatives fmi2GetDerivatives(derivatives, nx) Instance::derivatives;
    /// There are none.
    GetEventIndicators fmi2GetEventIndicators(eventIndicators, ni)
        Instance::event_indicators;
    /// All states.
    GetContinuousStates fmi2GetContinuousStates(x, nx) Instance::continuous_states;
    /// Sizes of the states to expect.
    GetNominalsOfContinuousStates fmi2GetNominalsOfContinuousStates(x_nominal, nx)
        |instance, nominals| instance.nominals(nominals);
}
