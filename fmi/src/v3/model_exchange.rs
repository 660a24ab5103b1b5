//! The functions of Model Exchange. The safety contract is that of the other exports.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 3.0's"
)]

use super::phase::Function;
use super::types::{
    FMI3_FALSE, fmi3Boolean, fmi3Float64, fmi3Instance, fmi3Status, fmi3ValueReference,
};
use crate::call::call;
use crate::error::FmiError;
use crate::instance::Instance;
use crate::pointers::{self, In, Out};

const OK: Result<fmi3Status, FmiError> = Ok(fmi3Status::OK);

/// Inputs and parameters may jump.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::EnterEventMode, |instance| {
            instance.enter_event_mode();
            OK
        })
    }
}

/// There are no discrete states: nothing is to be done again. Tells when shapes may meet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: fmi3Instance,
    discreteStatesNeedUpdate: *mut fmi3Boolean,
    terminateSimulation: *mut fmi3Boolean,
    nominalsOfContinuousStatesChanged: *mut fmi3Boolean,
    valuesOfContinuousStatesChanged: *mut fmi3Boolean,
    nextEventTimeDefined: *mut fmi3Boolean,
    nextEventTime: *mut fmi3Float64,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::UpdateDiscreteStates, |instance| {
            let next = instance.next_event();
            for (argument, place) in [
                ("discreteStatesNeedUpdate", discreteStatesNeedUpdate),
                ("terminateSimulation", terminateSimulation),
                (
                    "nominalsOfContinuousStatesChanged",
                    nominalsOfContinuousStatesChanged,
                ),
                (
                    "valuesOfContinuousStatesChanged",
                    valuesOfContinuousStatesChanged,
                ),
            ] {
                pointers::write(argument, place, FMI3_FALSE)?;
            }
            pointers::write(
                "nextEventTimeDefined",
                nextEventTimeDefined,
                next.is_some().into(),
            )?;
            pointers::write("nextEventTime", nextEventTime, next.unwrap_or(0.0))?;
            OK
        })
    }
}

/// The importer integrates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: fmi3Instance) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::EnterContinuousTimeMode, |instance| {
            instance.enter_continuous_time_mode();
            OK
        })
    }
}

/// Tells whether contacts have begun or ended, or may be missed before the next event.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: fmi3Instance,
    _noSetFMUStatePriorToCurrentPoint: fmi3Boolean,
    enterEventMode: *mut fmi3Boolean,
    terminateSimulation: *mut fmi3Boolean,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::CompletedIntegratorStep, |instance| {
            let event = instance.completed_step();
            pointers::write("enterEventMode", enterEventMode, event.into())?;
            pointers::write("terminateSimulation", terminateSimulation, FMI3_FALSE)?;
            OK
        })
    }
}

/// Sets the time, s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: fmi3Instance, time: fmi3Float64) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SetTime, |instance| {
            instance.set_time(time)?;
            OK
        })
    }
}

/// Sets all states, in the order of the derivatives in modelDescription.xml.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(
    instance: fmi3Instance,
    continuousStates: *const fmi3Float64,
    nContinuousStates: usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::SetContinuousStates, |instance| {
            let states = In::new("continuousStates", continuousStates, nContinuousStates)?;
            instance.set_continuous_states(&states)?;
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
            instance: fmi3Instance,
            $array: *mut fmi3Float64,
            $n: usize,
        ) -> fmi3Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(instance, Function::$function, |instance| {
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
    GetContinuousStateDerivatives fmi3GetContinuousStateDerivatives(
        derivatives, nContinuousStates) Instance::derivatives;
    /// There are none.
    GetEventIndicators fmi3GetEventIndicators(eventIndicators, nEventIndicators)
        Instance::event_indicators;
    /// All states.
    GetContinuousStates fmi3GetContinuousStates(
        continuousStates, nContinuousStates) Instance::continuous_states;
    /// Sizes of the states to expect.
    GetNominalsOfContinuousStates fmi3GetNominalsOfContinuousStates(
        nominals, nContinuousStates) |instance, nominals| instance.nominals(nominals);
}

/// One where something floats that can touch, see `Events::indicators`; else none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(
    instance: fmi3Instance,
    nEventIndicators: *mut usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::GetNumberOfEventIndicators, |instance| {
            let count = instance.indicator_count();
            pointers::write("nEventIndicators", nEventIndicators, count)?;
            OK
        })
    }
}

/// Number of states, elements of vectors counted one by one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(
    instance: fmi3Instance,
    nContinuousStates: *mut usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(
            instance,
            Function::GetNumberOfContinuousStates,
            |instance| {
                pointers::write(
                    "nContinuousStates",
                    nContinuousStates,
                    instance.state_count(),
                )?;
                OK
            },
        )
    }
}

/// Partial derivatives of outputs and derivatives by states and inputs, along a direction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: fmi3Instance,
    unknowns: *const fmi3ValueReference,
    nUnknowns: usize,
    knowns: *const fmi3ValueReference,
    nKnowns: usize,
    seed: *const fmi3Float64,
    nSeed: usize,
    sensitivity: *mut fmi3Float64,
    nSensitivity: usize,
) -> fmi3Status {
    // SAFETY: FMI's contract.
    unsafe {
        call(instance, Function::GetDirectionalDerivative, |instance| {
            let unknowns = In::new("unknowns", unknowns, nUnknowns)?;
            let knowns = In::new("knowns", knowns, nKnowns)?;
            let seeds = In::new("seed", seed, nSeed)?;
            let mut found = Out::new("sensitivity", sensitivity, nSensitivity)?;
            instance.directional_derivative(&unknowns, &knowns, &seeds, &mut found)?;
            OK
        })
    }
}
