//! An importer: loads an FMU as any other program does and simulates it.
//!
//! In: an FMU (ours or another FMI 2.0 or 3.0 co-simulation FMU), inputs and start values. Out: a
//! table of results. This module does not use the simulator directly, so `urdf2fmu simulate` gives
//! the results that every importer gets.
//!
//! | module | holds |
//! |---|---|
//! | `variable` | a variable |
//! | `arrays` | those of FMI 3 as lists of elements |
//! | `description` | what modelDescription.xml says |
//! | `library` | the C functions: the only unsafe code of this package |
//! | `csv` | tables of numbers as text |
//! | `signals` | inputs between the rows of a table |
//! | `experiment` | what to simulate: times, start values, files of inputs |
//! | `select` | which variables are written |
//! | `run` | from start to stop |
//! | `live` | from step to step, by hand |
//!
//! Steps and inputs are those of `FMPy`'s `simulate_fmu` for the same arguments, to the bit.

mod arrays;
pub mod csv;
pub mod description;
pub mod error;
pub mod experiment;
mod library;
pub mod live;
pub mod run;
mod select;
mod signals;
mod variable;
