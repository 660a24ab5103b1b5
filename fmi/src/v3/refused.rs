//! What this FMU does not offer: Model Exchange, Scheduled Execution, events, clocks, structural
//! parameters, partial derivatives. The functions are exported, because importers look up all
//! names, and refused in every phase.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 3.0's"
)]

use super::phase::Function;
use super::types::{
    fmi3Boolean, fmi3DependencyKind, fmi3Float64, fmi3Instance, fmi3IntervalQualifier, fmi3Status,
    fmi3UInt64, fmi3ValueReference,
};
use crate::call::call;

macro_rules! refused {
    ($($function:ident $export:ident ($($argument:ident: $type:ty),*);)*) => {$(
        /// Not offered: logs why, and returns `fmi3Error`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $export(instance: fmi3Instance, $($argument: $type),*) -> fmi3Status {
            // SAFETY: FMI's contract for the instance; the other arguments are not used.
            unsafe { call(instance, Function::$function, |_| Ok(fmi3Status::Error)) }
        }
    )*};
}

type References = *const fmi3ValueReference;
type Numbers = *const fmi3Float64;
type Places = *mut fmi3Float64;

refused! {
    GetNumberOfVariableDependencies fmi3GetNumberOfVariableDependencies(
        _reference: fmi3ValueReference, _n: *mut usize);
    GetVariableDependencies fmi3GetVariableDependencies(
        _dependent: fmi3ValueReference, _elements: *mut usize, _independents: *mut fmi3ValueReference,
        _elements_of_independents: *mut usize, _kinds: *mut fmi3DependencyKind, _n: usize);
    GetDirectionalDerivative fmi3GetDirectionalDerivative(
        _unknowns: References, _n_unknowns: usize, _knowns: References, _n_knowns: usize, _seed: Numbers,
        _n_seed: usize, _sensitivity: Places, _n_sensitivity: usize);
    GetAdjointDerivative fmi3GetAdjointDerivative(
        _unknowns: References, _n_unknowns: usize, _knowns: References, _n_knowns: usize, _seed: Numbers,
        _n_seed: usize, _sensitivity: Places, _n_sensitivity: usize);
    EnterConfigurationMode fmi3EnterConfigurationMode();
    ExitConfigurationMode fmi3ExitConfigurationMode();
    GetIntervalDecimal fmi3GetIntervalDecimal(
        _references: References, _n: usize, _intervals: Places, _qualifiers: *mut fmi3IntervalQualifier);
    GetIntervalFraction fmi3GetIntervalFraction(
        _references: References, _n: usize, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64,
        _qualifiers: *mut fmi3IntervalQualifier);
    GetShiftDecimal fmi3GetShiftDecimal(_references: References, _n: usize, _shifts: Places);
    GetShiftFraction fmi3GetShiftFraction(
        _references: References, _n: usize, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64);
    SetIntervalDecimal fmi3SetIntervalDecimal(_references: References, _n: usize, _intervals: Numbers);
    SetIntervalFraction fmi3SetIntervalFraction(
        _references: References, _n: usize, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64);
    SetShiftDecimal fmi3SetShiftDecimal(_references: References, _n: usize, _shifts: Numbers);
    SetShiftFraction fmi3SetShiftFraction(
        _references: References, _n: usize, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64);
    EnterEventMode fmi3EnterEventMode();
    EnterStepMode fmi3EnterStepMode();
    EvaluateDiscreteStates fmi3EvaluateDiscreteStates();
    UpdateDiscreteStates fmi3UpdateDiscreteStates(
        _need_update: *mut fmi3Boolean, _terminate: *mut fmi3Boolean, _nominals_changed: *mut fmi3Boolean,
        _values_changed: *mut fmi3Boolean, _next_defined: *mut fmi3Boolean, _next: Places);
    EnterContinuousTimeMode fmi3EnterContinuousTimeMode();
    CompletedIntegratorStep fmi3CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi3Boolean, _enter_event_mode: *mut fmi3Boolean,
        _terminate: *mut fmi3Boolean);
    SetTime fmi3SetTime(_time: fmi3Float64);
    SetContinuousStates fmi3SetContinuousStates(_states: Numbers, _n: usize);
    GetContinuousStateDerivatives fmi3GetContinuousStateDerivatives(_derivatives: Places, _n: usize);
    GetEventIndicators fmi3GetEventIndicators(_indicators: Places, _n: usize);
    GetContinuousStates fmi3GetContinuousStates(_states: Places, _n: usize);
    GetNominalsOfContinuousStates fmi3GetNominalsOfContinuousStates(_nominals: Places, _n: usize);
    GetNumberOfEventIndicators fmi3GetNumberOfEventIndicators(_n: *mut usize);
    GetNumberOfContinuousStates fmi3GetNumberOfContinuousStates(_n: *mut usize);
    ActivateModelPartition fmi3ActivateModelPartition(_clock: fmi3ValueReference, _time: fmi3Float64);
}
