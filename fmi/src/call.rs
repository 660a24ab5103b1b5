//! The guard of every exported function. Its steps, in fixed order:
//!
//! 1. the pointer: not null, one of ours, not in use by another call, of the function's version
//! 2. the phase table
//! 3. the default floating-point control word
//! 4. the body, with panics caught
//! 5. the log, and the status
#![allow(
    unsafe_code,
    reason = "dereferences the importer's pointer to an instance"
)]

use crate::common::Status;
use crate::control_word;
use crate::error::FmiError;
use crate::instance::Instance;
use crate::panics;
use crate::phase::{Function, Phase};
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Marks a living instance, so that most wrong pointers are refused instead of followed.
const TAG: u64 = 0x7564_6632_666d_7532;

/// What the importer's pointer leads to. In C's order: of a pointer that is none of ours only the
/// tag's eight bytes are read.
#[repr(C)]
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

/// The handle behind a pointer, if it is one of ours.
///
/// # Safety
/// `c` is null, or points to eight readable bytes that are not by chance those of [`TAG`], or was
/// returned by a function that makes instances.
unsafe fn handle<'a>(c: *mut c_void) -> Option<&'a Handle> {
    let pointer = c.cast::<Handle>();
    if pointer.is_null() || !pointer.is_aligned() {
        return None;
    }
    // SAFETY: not null, aligned, readable by the caller's promise. Only the tag is read before it
    // is known.
    let tag = unsafe { &(*pointer).tag };
    // SAFETY: the tag says that `into_pointer` made it and `free` has not yet dropped it.
    (tag.load(Ordering::Acquire) == TAG).then(|| unsafe { &*pointer })
}

/// Hands an instance to the importer.
pub(crate) fn into_pointer(instance: Instance) -> *mut c_void {
    let handle = Handle {
        tag: AtomicU64::new(TAG),
        busy: AtomicBool::new(false),
        instance: UnsafeCell::new(instance),
    };
    Box::into_raw(Box::new(handle)).cast()
}

/// Frees an instance; nothing happens if `c` is null, no instance of this version, or in use.
///
/// # Safety
/// As [`call`]; afterwards `c` is dangling.
#[cfg_attr(small, optimize(size))]
pub(crate) unsafe fn free<F: Function>(c: *mut c_void) {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle(c) }) else {
        return;
    };
    let Some(taken) = handle.take() else {
        return;
    };
    if taken.version() != F::VERSION || !F::FREE.allowed_in(taken.phase()) {
        return;
    }
    handle.tag.store(0, Ordering::Release);
    std::mem::forget(taken);
    let _word = control_word::Guard::new();
    // SAFETY: made by `into_pointer`; the tag is gone, so it is not followed again.
    let instance = unsafe { Box::from_raw(c.cast::<Handle>()) };
    // A panic while dropping is a bug that must not reach the host; there is no logger left to
    // report it to.
    drop(catch_unwind(AssertUnwindSafe(|| drop(instance))));
}

/// Runs `body` on the instance behind `c`, if `function` may be called now.
///
/// # Safety
/// `c` is null or was returned by a function that makes instances and is not yet freed.
pub(crate) unsafe fn call<F: Function>(
    c: *mut c_void,
    function: F,
    body: impl FnOnce(&mut Instance) -> Result<Status, FmiError>,
) -> Status {
    let mut body = Some(body);
    // SAFETY: the caller's promise.
    unsafe {
        call_if(c, function, false, &mut |instance| {
            once(&mut body, instance)
        })
    }
}

/// Runs `body` on the instance behind `c` after the importer's callback within a call of
/// `function`, whatever the table says.
///
/// # Safety
/// As [`call`].
pub(crate) unsafe fn resume<F: Function>(
    c: *mut c_void,
    function: F,
    body: impl FnOnce(&mut Instance) -> Result<Status, FmiError>,
) -> Status {
    let mut body = Some(body);
    // SAFETY: the caller's promise.
    unsafe { call_if(c, function, true, &mut |instance| once(&mut body, instance)) }
}

/// What is done with an instance, behind a pointer: the guard of a hundred functions is one then,
/// and not a copy for each.
type Body<'b> = &'b mut dyn FnMut(&mut Instance) -> Result<Status, FmiError>;

/// Runs a body that may run once.
fn once(
    body: &mut Option<impl FnOnce(&mut Instance) -> Result<Status, FmiError>>,
    instance: &mut Instance,
) -> Result<Status, FmiError> {
    body.take().map_or(Ok(Status::Error), |body| body(instance))
}

/// - `resumed`: after a callback, see [`resume`]
///
/// # Safety
/// As [`call`].
#[inline(never)]
unsafe fn call_if<F: Function>(c: *mut c_void, function: F, resumed: bool, body: Body) -> Status {
    // SAFETY: the caller's promise.
    let Some(mut instance) = (unsafe { handle(c) }).and_then(Handle::take) else {
        return Status::Error;
    };
    let _word = control_word::Guard::new();
    guarded(&mut instance, function, resumed, body)
}

/// [`call`] behind the pointer. Not inlined, so that no arithmetic moves before the control word is
/// set.
#[inline(never)]
fn guarded<F: Function>(instance: &mut Instance, function: F, resumed: bool, body: Body) -> Status {
    let is_for = instance.version() == F::VERSION;
    let only = function.only();
    let is_for = is_for && only.is_none_or(|only| only == instance.integrated_by());
    let phase = instance.phase();
    let allowed = if resumed {
        phase == Phase::IntermediateUpdate
    } else {
        function.allowed_in(phase)
    };
    if !(is_for && allowed) {
        return refuse(instance, function);
    }
    match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(status)) => status,
        failed => fail(instance, function.name(), failed),
    }
}

/// Says why a function may not be called now.
#[cold]
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn refuse<F: Function>(instance: &mut Instance, function: F) -> Status {
    let (name, made) = (function.name(), instance.version());
    if made != F::VERSION {
        return instance.report(name, &FmiError::Version { made });
    }
    let (phase, made) = (instance.phase(), instance.integrated_by());
    let advice = match function.only() {
        Some(only) if only != made => {
            format!("it belongs to {only}, but the instance was made for {made}")
        }
        _ => function.advice(phase),
    };
    let phase = F::name_of(phase);
    instance.report(name, &FmiError::Phase { phase, advice })
}

/// Reports an error, or a panic.
#[cold]
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn fail(
    instance: &mut Instance,
    name: &'static str,
    failed: std::thread::Result<Result<Status, FmiError>>,
) -> Status {
    match failed {
        Ok(Ok(status)) => status,
        Ok(Err(error)) => instance.report(name, &error),
        Err(payload) => {
            instance.poison();
            let message = panics::message(payload.as_ref());
            instance.report(name, &FmiError::Panic { message })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Status, call, free, guarded, into_pointer};
    use crate::instance::tests::instance;
    use crate::phase::{Phase, table};

    table! {
        V2 "fmi2", [Instantiated "instantiated", Error "error"], |_| "", |_| None;
        FreeInstance x x;
        Reset        x x;
        GetReal      x o;
    }
    use self::Function as Row;

    #[test]
    fn null_and_foreign_component_pointers_are_refused() {
        let mut strange = [7_u64; 64];
        // SAFETY: null, or readable memory.
        unsafe {
            for c in [std::ptr::null_mut(), strange.as_mut_ptr().cast()] {
                assert_eq!(call(c, Row::Reset, |_| Ok(Status::OK)), Status::Error);
                free::<Row>(c);
            }
        }
    }

    #[test]
    fn a_call_from_inside_a_call_is_refused() {
        let c = into_pointer(instance());
        // SAFETY: `c` lives until it is freed here.
        unsafe {
            let status = call(c, Row::Reset, |_| {
                free::<Row>(c);
                Ok(call(c, Row::Reset, |_| Ok(Status::OK)))
            });
            assert_eq!(status, Status::Error);
            assert_eq!(call(c, Row::Reset, |_| Ok(Status::OK)), Status::OK);
            free::<Row>(c);
        }
    }

    #[test]
    fn after_a_panic_only_reset_helps() {
        let mut instance = instance();
        let mut run = |function: Row, panic: bool| {
            guarded(&mut instance, function, false, &mut |instance| {
                assert!(!panic, "bug");
                if function == Row::Reset {
                    instance.reset();
                }
                Ok(Status::OK)
            })
        };
        assert_eq!(run(Row::GetReal, true), Status::Error);
        assert_eq!(run(Row::GetReal, false), Status::Error);
        assert_eq!(run(Row::Reset, false), Status::OK);
        assert_eq!(run(Row::GetReal, false), Status::OK);
        assert_eq!(instance.phase(), Phase::Instantiated);
    }
}
