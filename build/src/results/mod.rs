//! The table of a run, whoever wrote it, as the values of a robot's variables.
//!
//! In: text with separated values, and a scene. Out: columns that have the names of the scene's
//! variables, and sentences about what was mended, is missing or is not known. `table` reads files,
//! `names` finds the robot's variables in them. Whatever shows a run reads it here.

mod names;
mod table;

pub use table::{ResultsError, Table};
