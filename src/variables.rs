//! The table of all variables of the FMU. modelDescription.xml, the C functions and the
//! documentation use this one table.

/// A description. The FMU's library has none: no function of FMI tells it, and texts for some
/// hundred variables of each kind would be a twentieth of its code.
macro_rules! about {
    ($($text:tt)*) => {
        if cfg!(feature = "urdf") {
            format!($($text)*)
        } else {
            String::new()
        }
    };
}

mod build;
mod closures;
mod entries;
mod outputs;
mod row;
mod sensors;
mod settable;
mod states;

use crate::model::Model;
use build::Table;
#[cfg(feature = "urdf")]
pub(crate) use build::identifier;
pub use entries::{Entry, entries, time_reference};
pub use row::{Causality, Display, Kind, Part, Slot, TableError, Unit, Variable};

/// The table of a model, in a fixed order: inputs, outputs, parameters.
///
/// # Errors
/// [`TableError`] if two names clash.
#[cfg_attr(small, optimize(size))]
pub fn table(model: &Model) -> Result<Vec<Variable>, TableError> {
    filled(model).finish()
}

/// All names that clash, which [`table`] gives one of.
pub fn clashes(model: &Model) -> Vec<TableError> {
    filled(model).clashes()
}

#[cfg_attr(small, optimize(size))]
fn filled(model: &Model) -> Table<'_> {
    let mut table = Table::new(model);
    table.inputs();
    table.conveyors();
    table.driven_bases();
    table.base_outputs();
    table.joint_outputs();
    table.link_outputs();
    table.contact_outputs();
    table.pair_outputs();
    table.closure_outputs();
    table.sensor_outputs();
    table.common_outputs();
    table.state_outputs();
    table.initial_parameters();
    table.tunable_parameters();
    table.solver_parameters();
    table
}

/// The row named `name`.
pub fn find<'t>(table: &'t [Variable], name: &str) -> Option<&'t Variable> {
    table.iter().find(|variable| variable.name == name)
}

#[cfg(test)]
mod tests;
