//! Steps, and the importer's callback within them.
//!
//! The callback runs outside of the guard: nothing of the instance is borrowed, and the host's
//! floating-point control word holds. Meanwhile the phase determines what the callback may call.
#![allow(unsafe_code, reason = "calls the importer's function")]

use super::phase::Function;
use super::types::{FMI3_FALSE, FMI3_TRUE, fmi3Boolean, fmi3Float64, fmi3Instance, fmi3Status};
use crate::call::{call, resume};
use crate::error::FmiError;
use crate::instance::{Callback, Next};
use crate::pointers;

/// Where a step tells what came of it.
#[derive(Clone, Copy)]
pub(super) struct Told {
    pub event_handling_needed: *mut fmi3Boolean,
    pub terminate_simulation: *mut fmi3Boolean,
    pub early_return: *mut fmi3Boolean,
    pub last_successful_time: *mut fmi3Float64,
}

impl Told {
    /// # Safety
    /// Unless null, all pointers can be written during the call.
    unsafe fn write(&self, early: bool, time: f64) -> Result<(), FmiError> {
        // SAFETY: the caller's promise.
        unsafe {
            pointers::write(
                "eventHandlingNeeded",
                self.event_handling_needed,
                FMI3_FALSE,
            )?;
            pointers::write("terminateSimulation", self.terminate_simulation, FMI3_FALSE)?;
            pointers::write("earlyReturn", self.early_return, fmi3Boolean::from(early))?;
            pointers::write("lastSuccessfulTime", self.last_successful_time, time)
        }
    }
}

/// fmi3DoStep
///
/// # Safety
/// FMI's contract, for `c` and what `told` points to.
pub(super) unsafe fn do_step(
    c: fmi3Instance,
    point: fmi3Float64,
    size: fmi3Float64,
    told: Told,
) -> fmi3Status {
    let mut waiting: Option<(Callback, f64)> = None;
    // SAFETY: the caller's promise, here and below.
    let mut status = unsafe {
        call(c, Function::DoStep, |instance| {
            // Before anything is done, so that a null pointer has no effect.
            told.write(false, instance.last_successful_time())?;
            go(instance.begin_step(point, size)?, told, &mut waiting)
        })
    };
    while let Some((callback, time)) = waiting.take() {
        let end = call_back(&callback, time);
        // SAFETY: as above.
        status = unsafe {
            resume(c, Function::DoStep, |instance| {
                instance.answer(end);
                go(instance.go_on(), told, &mut waiting)
            })
        };
    }
    status
}

/// Tells what came of a step, or waits for the callback.
///
/// # Safety
/// As [`Told::write`].
unsafe fn go(
    next: Next,
    told: Told,
    waiting: &mut Option<(Callback, f64)>,
) -> Result<fmi3Status, FmiError> {
    match next {
        Next::Update { callback, time } => {
            *waiting = Some((callback, time));
            Ok(fmi3Status::OK)
        }
        Next::End {
            status,
            early,
            time,
        } => {
            // SAFETY: the caller's promise.
            unsafe { told.write(early, time) }?;
            Ok(status)
        }
    }
}

/// Calls the callback at `time`; when it asks for the step to end, s, if it does.
fn call_back(callback: &Callback, time: f64) -> Option<f64> {
    let (mut requested, mut end) = (FMI3_FALSE, time);
    let may_end_early = fmi3Boolean::from(callback.may_end_early);
    // SAFETY: the importer's function, with the arguments that FMI 3.0 prescribes; both places live
    // until it returns.
    unsafe {
        (callback.function)(
            callback.environment,
            time,
            FMI3_TRUE,
            FMI3_TRUE,
            FMI3_TRUE,
            may_end_early,
            &raw mut requested,
            &raw mut end,
        );
    }
    (callback.may_end_early && requested != FMI3_FALSE).then_some(end)
}
