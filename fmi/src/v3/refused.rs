//! What this FMU does not offer: Scheduled Execution, clocks, discrete states, structural
//! parameters, adjoint derivatives. The functions are exported, because importers look up all
//! names, and refused in every phase.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 3.0's"
)]

use super::phase::Function;
use super::types::{
    fmi3DependencyKind, fmi3Float64, fmi3Instance, fmi3IntervalQualifier, fmi3Status, fmi3UInt64,
    fmi3ValueReference,
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
    EnterStepMode fmi3EnterStepMode();
    EvaluateDiscreteStates fmi3EvaluateDiscreteStates();
    ActivateModelPartition fmi3ActivateModelPartition(_clock: fmi3ValueReference, _time: fmi3Float64);
}
