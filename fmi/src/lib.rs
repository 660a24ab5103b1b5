//! The C functions of an urdf2fmu robot, of FMI 2.0 and of FMI 3.0.
//!
//! Every function that takes an instance does nothing but call the guard in `call`, which checks
//! pointer, version and phase, sets the floating-point control word, catches panics, logs and
//! returns the status. What the functions do is in `instance`, for both versions; which may be
//! called when, in the tables of `v2` and `v3`.
//!
//! | module | holds |
//! |---|---|
//! | `v2`, `v3` | types, functions and tables of phases of one version |
//! | `common` | what the versions share, and how each spells things |
//! | `call`, `control_word`, `panics` | the guard |
//! | `phase` | where an instance stands, and the form of the tables |
//! | `load`, `uri` | from the resource location to an instance |
//! | `instance` | an instance, without pointers |
//! | `layout` | value references |
//! | `snapshot` | saved states and their bytes |
//! | `pointers`, `logger` | what goes in and out as C memory |
//!
//! The package is an rlib; the build script of the `urdf2fmu` command makes the shared library of
//! it. Nothing is process-wide: no static data but a thread-local note about the last panic, no
//! threads, no signal handlers, no output but through the importer's logger.
// What runs once is compiled for size in a small library, see build/platforms/tools.sh.
#![cfg_attr(small, feature(optimize_attribute))]
#![deny(unsafe_code)]

#[cfg(not(panic = "unwind"))]
compile_error!("the C boundary turns panics into FMI errors: build with panic = \"unwind\"");

mod call;
mod common;
mod control_word;
mod error;
mod experiment;
mod instance;
mod layout;
mod load;
mod logger;
mod panics;
mod phase;
mod pointers;
mod snapshot;
mod uri;
pub mod v2;
pub mod v3;

pub use common::{IntermediateUpdate, LoggerOfFmi2, LoggerOfFmi3, Status};
pub use v2::exports::*;
pub use v2::model_exchange::*;
pub use v3::exports::*;
pub use v3::model_exchange::*;
pub use v3::refused::*;
pub use v3::values::*;
