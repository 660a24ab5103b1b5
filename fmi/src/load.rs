//! fmi2Instantiate after its pointers are checked: from a resource location to an instance.

use crate::error::InstantiateError;
use crate::instance::Instance;
use crate::logger::Logger;
use crate::snapshot::GuidHash;
use crate::types::FMI2_CO_SIMULATION;
use crate::uri;
use std::path::PathBuf;
use std::sync::Arc;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel};
use urdf2fmu_core::variables::table;

/// Loads the robot from the folder that `location` names.
///
/// # Errors
/// [`InstantiateError`] if there is no robot, or not the one that `guid` names.
pub(crate) fn load(
    fmu_type: i32,
    guid: &str,
    location: &[u8],
    logger: Logger,
) -> Result<Instance, InstantiateError> {
    if fmu_type != FMI2_CO_SIMULATION {
        return Err(InstantiateError::Type { found: fmu_type });
    }
    let (path, text) = read(location)?;
    let path = path.display().to_string();
    let prepared = PreparedModel::from_json(&text).map_err(|error| InstantiateError::Prepared {
        path: path.clone(),
        error,
    })?;
    if prepared.guid != guid {
        return Err(InstantiateError::Guid {
            given: guid.to_owned(),
            expected: prepared.guid,
        });
    }
    let variables =
        table(&prepared.model).map_err(|error| InstantiateError::Table { path, error })?;
    Ok(Instance::new(
        logger,
        GuidHash::new(guid),
        Arc::new(prepared.model),
        variables,
    ))
}

/// The prepared model's text, from the first reading of `location` under which there is one.
fn read(location: &[u8]) -> Result<(PathBuf, String), InstantiateError> {
    let mut first_error = None;
    for folder in uri::folders(location)? {
        let path = folder.join(FILE_NAME);
        match std::fs::read_to_string(&path) {
            Ok(text) => return Ok((path, text)),
            Err(error) => {
                let path = path.display().to_string();
                first_error.get_or_insert(InstantiateError::Read { path, error });
            }
        }
    }
    Err(first_error.unwrap_or(InstantiateError::Uri(uri::UriError::Empty)))
}
