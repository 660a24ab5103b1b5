//! Get and set functions of FMI 3.0, in the order of its headers.
//!
//! There are variables of the types Float64, Int32 and Boolean. The functions of other types are
//! legal without elements. The safety contract is that of [`super::exports`].
#![allow(unsafe_code, reason = "C functions")]
#![allow(
    non_snake_case,
    clippy::missing_safety_doc,
    reason = "names and contracts are FMI 3.0's"
)]

use super::phase::Function;
use super::types::{
    FMI3_FALSE, FMI3_TRUE, fmi3Binary, fmi3Boolean, fmi3Clock, fmi3Float32, fmi3Float64,
    fmi3Instance, fmi3Int8, fmi3Int16, fmi3Int32, fmi3Int64, fmi3Status, fmi3String, fmi3UInt8,
    fmi3UInt16, fmi3UInt32, fmi3UInt64, fmi3ValueReference,
};
use crate::call::call;
use crate::pointers::{In, Out};
use urdf2fmu_core::variables::Kind;

macro_rules! get_and_set {
    ($get:ident $get_function:ident, $set:ident $set_function:ident, $kind:ident: $type:ty, $from:expr, $to:expr) => {
        /// Reads variables of this type, arrays whole.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: fmi3Instance,
            valueReferences: *const fmi3ValueReference,
            nValueReferences: usize,
            values: *mut $type,
            nValues: usize,
        ) -> fmi3Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(instance, Function::$get_function, |instance| {
                    let references = In::new("valueReferences", valueReferences, nValueReferences)?;
                    let mut values = Out::new("values", values, nValues)?;
                    instance.get(Kind::$kind, &references, &mut values, $from)?;
                    Ok(fmi3Status::OK)
                })
            }
        }

        /// Sets variables of this type, arrays whole: all of them or none.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: fmi3Instance,
            valueReferences: *const fmi3ValueReference,
            nValueReferences: usize,
            values: *const $type,
            nValues: usize,
        ) -> fmi3Status {
            // SAFETY: FMI's contract.
            unsafe {
                call(instance, Function::$set_function, |instance| {
                    let references = In::new("valueReferences", valueReferences, nValueReferences)?;
                    let values = In::new("values", values, nValues)?;
                    instance.set(Kind::$kind, &references, &values, $to)?;
                    Ok(fmi3Status::OK)
                })
            }
        }
    };
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "saturates: counters stop at the largest Int32"
)]
fn integer(number: f64) -> fmi3Int32 {
    number as fmi3Int32
}

fn boolean(number: f64) -> fmi3Boolean {
    if number == 0.0 { FMI3_FALSE } else { FMI3_TRUE }
}

get_and_set!(fmi3GetFloat64 GetFloat64, fmi3SetFloat64 SetFloat64, Real: fmi3Float64, |x| x, |x| x);
get_and_set!(fmi3GetInt32 GetInt32, fmi3SetInt32 SetInt32, Integer: fmi3Int32, integer, f64::from);
get_and_set!(fmi3GetBoolean GetBoolean, fmi3SetBoolean SetBoolean, Boolean: fmi3Boolean, boolean,
    |value| f64::from(u8::from(value != FMI3_FALSE)));

/// Functions of a type that no variable has; arguments between the references and their number,
/// and the number of values.
macro_rules! of_no_variable {
    ($($export:ident $function:ident $type:literal ($($argument:ident: $of:ty),*);)*) => {$(
        /// There are no variables of this type: legal without elements.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $export(
            instance: fmi3Instance,
            valueReferences: *const fmi3ValueReference,
            nValueReferences: usize,
            $($argument: $of),*
        ) -> fmi3Status {
            // SAFETY: FMI's contract for the instance and the references; nothing else is used.
            unsafe {
                call(instance, Function::$function, |instance| {
                    let references = In::new("valueReferences", valueReferences, nValueReferences)?;
                    instance.refuse($type, &references)?;
                    Ok(fmi3Status::OK)
                })
            }
        }
    )*};
}

of_no_variable! {
    fmi3GetFloat32 GetFloat32 "Float32" (_values: *mut fmi3Float32, _n: usize);
    fmi3GetInt8 GetInt8 "Int8" (_values: *mut fmi3Int8, _n: usize);
    fmi3GetUInt8 GetUInt8 "UInt8" (_values: *mut fmi3UInt8, _n: usize);
    fmi3GetInt16 GetInt16 "Int16" (_values: *mut fmi3Int16, _n: usize);
    fmi3GetUInt16 GetUInt16 "UInt16" (_values: *mut fmi3UInt16, _n: usize);
    fmi3GetUInt32 GetUInt32 "UInt32" (_values: *mut fmi3UInt32, _n: usize);
    fmi3GetInt64 GetInt64 "Int64" (_values: *mut fmi3Int64, _n: usize);
    fmi3GetUInt64 GetUInt64 "UInt64" (_values: *mut fmi3UInt64, _n: usize);
    fmi3GetString GetString "String" (_values: *mut fmi3String, _n: usize);
    fmi3GetBinary GetBinary "Binary" (_sizes: *mut usize, _values: *mut fmi3Binary, _n: usize);
    fmi3GetClock GetClock "Clock" (_values: *mut fmi3Clock);
    fmi3SetFloat32 SetFloat32 "Float32" (_values: *const fmi3Float32, _n: usize);
    fmi3SetInt8 SetInt8 "Int8" (_values: *const fmi3Int8, _n: usize);
    fmi3SetUInt8 SetUInt8 "UInt8" (_values: *const fmi3UInt8, _n: usize);
    fmi3SetInt16 SetInt16 "Int16" (_values: *const fmi3Int16, _n: usize);
    fmi3SetUInt16 SetUInt16 "UInt16" (_values: *const fmi3UInt16, _n: usize);
    fmi3SetUInt32 SetUInt32 "UInt32" (_values: *const fmi3UInt32, _n: usize);
    fmi3SetInt64 SetInt64 "Int64" (_values: *const fmi3Int64, _n: usize);
    fmi3SetUInt64 SetUInt64 "UInt64" (_values: *const fmi3UInt64, _n: usize);
    fmi3SetString SetString "String" (_values: *const fmi3String, _n: usize);
    fmi3SetBinary SetBinary "Binary" (_sizes: *const usize, _values: *const fmi3Binary, _n: usize);
    fmi3SetClock SetClock "Clock" (_values: *const fmi3Clock);
}
