//! The readers of the importer, at the place that they have in the command.

#[path = "../../../build/src/importer/advice.rs"]
mod advice;
#[path = "../../../build/src/importer/arrays.rs"]
mod arrays;
#[path = "../../../build/src/importer/attributes.rs"]
mod attributes;
#[path = "../../../build/src/importer/csv/mod.rs"]
pub mod csv;
#[path = "../../../build/src/importer/description.rs"]
pub mod description;
#[path = "library.rs"]
mod library;
#[path = "../../../build/src/importer/states.rs"]
mod states;
#[path = "../../../build/src/importer/tabular.rs"]
pub mod tabular;
#[path = "../../../build/src/importer/variable.rs"]
mod variable;
