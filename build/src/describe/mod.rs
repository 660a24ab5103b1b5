//! modelDescription.xml, and what stands beside it in FMI 3.
//!
//! In: the variable table and a few facts of the model. Out: the XML text; the same input gives the
//! same bytes. Only this module writes with quick-xml. What each initial output depends on is in
//! [`crate::structure`].
//!
//! | module | holds |
//! |---|---|
//! | `words` | FMI's words for a variable, numbers as text |
//! | `shared` | what both versions have: units, categories, rules |
//! | `fmi2` | a variable for each row of the table |
//! | `fmi3` | a variable for each entry: rows, or vectors of them |
//! | `terminals` | which variables belong together, for FMI 3 |

mod fmi2;
mod fmi3;
mod shared;
mod terminals;
mod words;

pub use shared::{DescribeError, Header};
pub use terminals::{FILE_NAME as TERMINALS, terminals};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::variables::Variable;
pub use words::{ELEMENTS, STEP_SIZE, causality, number, variability};

/// The XML text, of the version that the settings ask for.
///
/// # Errors
/// [`DescribeError`] where the table breaks a rule of FMI.
pub fn model_description(
    header: &Header,
    model: &Model,
    table: &[Variable],
) -> Result<Vec<u8>, DescribeError> {
    match header.about.fmi {
        FmiVersion::V2 => fmi2::model_description(header, model, table),
        FmiVersion::V3 => fmi3::model_description(header, model, table),
    }
}

#[cfg(test)]
mod tests;
