//! The guard of every exported function. Its steps, in fixed order:
//!
//! 1. the component: not null, one of ours, not in use by another call
//! 2. the phase table
//! 3. the default floating-point control word
//! 4. the body, with panics caught
//! 5. the log, and the status
#![allow(unsafe_code, reason = "dereferences the importer's component pointer")]

use crate::control_word;
use crate::error::FmiError;
use crate::instance::Instance;
use crate::panics;
use crate::phase::Function;
use crate::types::{fmi2Component, fmi2Status};
use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Marks a living instance, so that most wrong pointers are refused instead of followed.
const TAG: u64 = 0x7564_6632_666d_7532;

/// What a component points to.
struct Handle {
    /// [`TAG`]; 0 once freed.
    tag: AtomicU64,
    /// A call is under way. The standard forbids a second one meanwhile, be it from another thread
    /// or from the logger; it is refused.
    busy: AtomicBool,
    instance: UnsafeCell<Instance>,
}

/// Exclusive use of an instance, until dropped.
struct Use<'a> {
    handle: &'a Handle,
}

impl Deref for Use<'_> {
    type Target = Instance;
    fn deref(&self) -> &Instance {
        // SAFETY: `busy` was taken by `Handle::take`, so this is the only `Use`.
        unsafe { &*self.handle.instance.get() }
    }
}

impl DerefMut for Use<'_> {
    fn deref_mut(&mut self) -> &mut Instance {
        // SAFETY: as above.
        unsafe { &mut *self.handle.instance.get() }
    }
}

impl Drop for Use<'_> {
    fn drop(&mut self) {
        self.handle.busy.store(false, Ordering::Release);
    }
}

impl Handle {
    /// None while another call is under way.
    fn take(&self) -> Option<Use<'_>> {
        let taken = self
            .busy
            .compare_exchange(false, true, Ordering::Acquire, Ordering::Relaxed);
        // Lazily: dropping a `Use` ends the other call's claim.
        taken.is_ok().then(|| Use { handle: self })
    }
}

/// The handle behind a component, if it is one.
///
/// # Safety
/// `c` is null or points to readable memory of the size of a handle, such as fmi2Instantiate
/// returned.
unsafe fn handle<'a>(c: fmi2Component) -> Option<&'a Handle> {
    let pointer = c.cast::<Handle>();
    if pointer.is_null() || !pointer.is_aligned() {
        return None;
    }
    // SAFETY: not null, aligned, readable by the caller's promise. Only the tag is read before it
    // is known.
    let tag = unsafe { &(*pointer).tag };
    // SAFETY: the tag says that `into_component` made it and `free` has not yet dropped it.
    (tag.load(Ordering::Acquire) == TAG).then(|| unsafe { &*pointer })
}

/// Hands an instance to the importer.
pub(crate) fn into_component(instance: Instance) -> fmi2Component {
    let handle = Handle {
        tag: AtomicU64::new(TAG),
        busy: AtomicBool::new(false),
        instance: UnsafeCell::new(instance),
    };
    Box::into_raw(Box::new(handle)).cast()
}

/// fmi2FreeInstance; nothing happens if `c` is null, no component or in use.
///
/// # Safety
/// As [`call`]; afterwards `c` is dangling.
pub(crate) unsafe fn free(c: fmi2Component) {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle(c) }) else {
        return;
    };
    let Some(taken) = handle.take() else {
        return;
    };
    if !Function::FreeInstance.allowed_in(taken.phase()) {
        return;
    }
    handle.tag.store(0, Ordering::Release);
    std::mem::forget(taken);
    let _word = control_word::Guard::new();
    // SAFETY: made by `into_component`; the tag is gone, so it is not followed again.
    let instance = unsafe { Box::from_raw(c.cast::<Handle>()) };
    // A panic while dropping is a bug that must not reach the host; there is no logger left to
    // report it to.
    drop(catch_unwind(AssertUnwindSafe(|| drop(instance))));
}

/// Runs `body` on the instance behind `c`, if `function` may be called now.
///
/// # Safety
/// `c` is null or was returned by fmi2Instantiate and not yet freed.
pub(crate) unsafe fn call(
    c: fmi2Component,
    function: Function,
    body: impl FnOnce(&mut Instance) -> Result<fmi2Status, FmiError>,
) -> fmi2Status {
    // SAFETY: the caller's promise.
    let Some(mut instance) = (unsafe { handle(c) }).and_then(Handle::take) else {
        return fmi2Status::Error;
    };
    let _word = control_word::Guard::new();
    guarded(&mut instance, function, body)
}

/// [`call`] behind the pointer. Not inlined, so that no arithmetic moves before the control word is
/// set.
#[inline(never)]
fn guarded(
    instance: &mut Instance,
    function: Function,
    body: impl FnOnce(&mut Instance) -> Result<fmi2Status, FmiError>,
) -> fmi2Status {
    if !function.allowed_in(instance.phase()) {
        let phase = instance.phase();
        return instance.report(function, &FmiError::Phase { function, phase });
    }
    match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(status)) => status,
        Ok(Err(error)) => instance.report(function, &error),
        Err(payload) => {
            instance.poison();
            let message = panics::message(payload.as_ref());
            instance.report(function, &FmiError::Panic { message })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instance::tests::instance;
    use crate::phase::Phase;

    #[test]
    fn null_and_foreign_component_pointers_are_refused() {
        let mut strange = [7_u64; 64];
        // SAFETY: null, or readable memory.
        unsafe {
            for c in [std::ptr::null_mut(), strange.as_mut_ptr().cast()] {
                assert_eq!(
                    call(c, Function::Reset, |_| Ok(fmi2Status::OK)),
                    fmi2Status::Error
                );
                free(c);
            }
        }
    }

    #[test]
    fn a_call_from_inside_a_call_is_refused() {
        let c = into_component(instance());
        // SAFETY: `c` lives until it is freed here.
        unsafe {
            let status = call(c, Function::Reset, |_| {
                free(c);
                Ok(call(c, Function::Reset, |_| Ok(fmi2Status::OK)))
            });
            assert_eq!(status, fmi2Status::Error);
            assert_eq!(
                call(c, Function::Reset, |_| Ok(fmi2Status::OK)),
                fmi2Status::OK
            );
            free(c);
        }
    }

    #[test]
    fn after_a_panic_only_reset_helps() {
        let mut instance = instance();
        let mut run = |function, panic: bool| {
            guarded(&mut instance, function, |instance| {
                assert!(!panic, "bug");
                if function == Function::Reset {
                    instance.reset();
                }
                Ok(fmi2Status::OK)
            })
        };
        assert_eq!(run(Function::GetReal, true), fmi2Status::Error);
        assert_eq!(run(Function::GetReal, false), fmi2Status::Error);
        assert_eq!(run(Function::Reset, false), fmi2Status::OK);
        assert_eq!(run(Function::GetReal, false), fmi2Status::OK);
        assert_eq!(instance.phase(), Phase::Instantiated);
    }
}
