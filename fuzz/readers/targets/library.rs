//! What readers need of the functions of an FMU, without the functions.

#[path = "../../../build/src/importer/library/elements.rs"]
mod elements;
#[path = "../../../build/src/importer/library/interface.rs"]
mod interface;

pub use elements::Element;
pub use interface::Interface;
