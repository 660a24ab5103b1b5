//! The table of a run, from any program, as the values of a robot's variables.
//!
//! In: text with separated values, and a scene. Out: columns that have the names of the scene's
//! variables, and notes about what was corrected, is missing or is not known. `table` reads files,
//! `names` finds the robot's variables in them. Everything that shows a run reads it by this
//! module.

mod names;
mod table;

pub use table::{ResultsError, Table};
