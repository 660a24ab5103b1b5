//! The FMI 2.0 co-simulation C functions of an urdf2fmu robot.
//!
//! This is the one package with `unsafe` code. Every function that takes a component does nothing
//! but call the guard in `call`, which checks pointer and phase, sets the floating-point control
//! word, catches panics, logs and answers. What the functions do is in `instance`; which may be
//! called when, in `phase`.
//!
//! | module | holds |
//! |---|---|
//! | `types` | the types of the FMI headers |
//! | `call`, `control_word`, `panics` | the guard |
//! | `phase` | which function may be called when |
//! | `load`, `uri` | from the resource location to an instance |
//! | `instance` | the life of an instance, without pointers |
//! | `snapshot` | saved states and their bytes |
//! | `pointers`, `logger` | what goes in and out as C memory |
//!
//! The package is an rlib; the build script of the `urdf2fmu` command makes the shared library of
//! it. Nothing is process-wide: no static data but a thread-local note about the last panic, no
//! threads, no signal handlers, no output but through the importer's logger.
#![deny(unsafe_code)]

#[cfg(not(panic = "unwind"))]
compile_error!("the C boundary turns panics into FMI errors: build with panic = \"unwind\"");

mod call;
mod control_word;
mod error;
mod experiment;
mod exports;
mod instance;
mod load;
mod logger;
mod model_exchange;
mod panics;
mod phase;
mod pointers;
mod snapshot;
pub mod types;
mod uri;

pub use exports::*;
pub use model_exchange::*;
