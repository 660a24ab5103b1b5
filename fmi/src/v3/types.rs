//! The types of fmi3PlatformTypes.h and fmi3FunctionTypes.h, spelled as there.
//!
//! What comes from C stays an integer until it has been checked. `bool` of C is a byte here: a
//! caller may hand over any, and a `bool` of Rust that is neither 0 nor 1 would be undefined
//! behaviour.

#![allow(
    non_camel_case_types,
    reason = "the names of the FMI 3.0 headers are kept"
)]

pub use crate::common::Status as fmi3Status;
use crate::common::{IntermediateUpdate, LoggerOfFmi3};
use std::ffi::{c_char, c_int, c_void};

/// Opaque pointer to an instance.
pub type fmi3Instance = *mut c_void;
/// Opaque pointer that belongs to the importer.
pub type fmi3InstanceEnvironment = *mut c_void;
/// Opaque pointer to a saved state.
pub type fmi3FMUState = *mut c_void;
/// Handle of a variable.
pub type fmi3ValueReference = u32;
/// `float`
pub type fmi3Float32 = f32;
/// `double`
pub type fmi3Float64 = f64;
/// `int8_t`
pub type fmi3Int8 = i8;
/// `uint8_t`
pub type fmi3UInt8 = u8;
/// `int16_t`
pub type fmi3Int16 = i16;
/// `uint16_t`
pub type fmi3UInt16 = u16;
/// `int32_t`
pub type fmi3Int32 = i32;
/// `uint32_t`
pub type fmi3UInt32 = u32;
/// `int64_t`
pub type fmi3Int64 = i64;
/// `uint64_t`
pub type fmi3UInt64 = u64;
/// `bool`: 0 is false.
pub type fmi3Boolean = u8;
/// Zero-terminated UTF-8.
pub type fmi3String = *const c_char;
/// Smallest addressable unit.
pub type fmi3Byte = u8;
/// Bytes whose length is told beside them.
pub type fmi3Binary = *const fmi3Byte;
/// `bool`: 0 is inactive.
pub type fmi3Clock = u8;
/// `fmi3DependencyKind`; never written.
pub type fmi3DependencyKind = c_int;
/// `fmi3IntervalQualifier`; never written.
pub type fmi3IntervalQualifier = c_int;

/// `fmi3True`
pub const FMI3_TRUE: fmi3Boolean = 1;
/// `fmi3False`
pub const FMI3_FALSE: fmi3Boolean = 0;

/// `fmi3LogMessageCallback`
pub type fmi3LogMessageCallback = LoggerOfFmi3;
/// `fmi3IntermediateUpdateCallback`
pub type fmi3IntermediateUpdateCallback = IntermediateUpdate;
/// `fmi3ClockUpdateCallback`; never called.
pub type fmi3ClockUpdateCallback = unsafe extern "C" fn(fmi3InstanceEnvironment);
/// `fmi3LockPreemptionCallback` and `fmi3UnlockPreemptionCallback`; never called.
pub type fmi3PreemptionCallback = unsafe extern "C" fn();
