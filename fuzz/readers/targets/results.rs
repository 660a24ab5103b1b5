//! The reader of results, at the place that it has in the command.

#[path = "../../../build/src/results/names.rs"]
mod names;
#[path = "../../../build/src/results/table.rs"]
pub mod table;
