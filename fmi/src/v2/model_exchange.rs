//! The functions of Model Exchange. They are exported, because importers look up all names, and
//! refused in every phase.
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 2.0's"
)]

use super::phase::Function;
use super::types::{fmi2Boolean, fmi2Component, fmi2Real, fmi2Status};
use crate::call::call;
use std::ffi::c_void;

macro_rules! refused {
    ($($function:ident $export:ident ($($argument:ident: $type:ty),*);)*) => {$(
        /// Belongs to Model Exchange: logs that, and returns `fmi2Error`.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $export(c: fmi2Component, $($argument: $type),*) -> fmi2Status {
            // SAFETY: FMI's contract for `c`; the other arguments are not used.
            unsafe { call(c, Function::$function, |_| Ok(fmi2Status::Error)) }
        }
    )*};
}

refused! {
    EnterEventMode fmi2EnterEventMode();
    NewDiscreteStates fmi2NewDiscreteStates(_event_info: *mut c_void);
    EnterContinuousTimeMode fmi2EnterContinuousTimeMode();
    CompletedIntegratorStep fmi2CompletedIntegratorStep(
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
        _enter_event_mode: *mut fmi2Boolean,
        _terminate_simulation: *mut fmi2Boolean
    );
    SetTime fmi2SetTime(_time: fmi2Real);
    SetContinuousStates fmi2SetContinuousStates(_x: *const fmi2Real, _nx: usize);
    GetDerivatives fmi2GetDerivatives(_derivatives: *mut fmi2Real, _nx: usize);
    GetEventIndicators fmi2GetEventIndicators(_indicators: *mut fmi2Real, _ni: usize);
    GetContinuousStates fmi2GetContinuousStates(_x: *mut fmi2Real, _nx: usize);
    GetNominalsOfContinuousStates fmi2GetNominalsOfContinuousStates(_nominal: *mut fmi2Real, _nx: usize);
}
