//! An importer: loads an FMU as any other program does and simulates it.
//!
//! In: an FMU (ours or another one of FMI 2.0 or 3.0), inputs and start values. Out: a table of
//! results. This module does not use the simulator directly, so `urdf2fmu simulate` gives
//! the results that every importer gets.
//!
//! | module | holds |
//! |---|---|
//! | `variable` | a variable |
//! | `attributes` | attributes of the elements of modelDescription.xml |
//! | `arrays` | those of FMI 3 as lists of elements |
//! | `description` | what modelDescription.xml says |
//! | `library` | the C functions: the only unsafe code of this package |
//! | `csv` | tables of numbers as text |
//! | `tabular` | encodings, separators and units of tables |
//! | `advice` | what to do about cells that are no numbers |
//! | `signals` | inputs between the rows of a table |
//! | `experiment` | what to simulate: times, start values, files of inputs |
//! | `select` | which variables are written |
//! | `states` | continuous states of Model Exchange |
//! | `rodas` | an integrator of stiff equations |
//! | `exchange` | drives a Model Exchange FMU by it |
//! | `run` | from start to stop |
//! | `live` | from step to step, by hand |
//!
//! Steps and inputs of co-simulation are those of `FMPy`'s `simulate_fmu` for the same arguments,
//! to the bit.

mod advice;
mod arrays;
mod attributes;
mod binary;
pub mod csv;
pub mod description;
pub mod error;
mod exchange;
pub mod experiment;
mod library;
pub mod live;
mod rodas;
pub mod run;
mod select;
mod signals;
mod states;
pub mod tabular;
mod variable;
