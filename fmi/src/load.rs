//! From a resource location to an instance, after the pointers are checked.

use crate::common::{Interface, Status, Version};
use crate::error::InstantiateError;
use crate::instance::Instance;
use crate::layout::Layout;
use crate::logger::{Category, Logger};
use crate::panics;
use crate::snapshot::GuidHash;
use crate::uri::{self, UriError};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel};
use urdf2fmu_core::variables::table;

/// What `make` makes; otherwise the reason is logged as that of `function`.
pub(crate) fn made(
    function: &str,
    logger: &Logger,
    make: impl FnOnce() -> Result<Instance, InstantiateError>,
) -> Option<Instance> {
    let made = catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|payload| {
        let message = panics::message(payload.as_ref());
        Err(InstantiateError::Panic { message })
    });
    match made {
        Ok(instance) => Some(instance),
        Err(error) => {
            let message = format!("{function}: {error}");
            logger.log(Status::Error, Category::StatusError, &message);
            None
        }
    }
}

/// Loads the robot from the folder that `location` names.
///
/// # Errors
/// [`InstantiateError`] if there is no robot, or not the one that `guid` names.
#[cfg_attr(small, optimize(size))]
pub(crate) fn load(
    version: Version,
    integrated_by: Interface,
    guid: &str,
    location: &[u8],
    logger: Logger,
) -> Result<Instance, InstantiateError> {
    let (path, text) = read(version, location)?;
    let path = path.display().to_string();
    let prepared = PreparedModel::from_json(&text).map_err(|error| InstantiateError::Prepared {
        path: path.clone(),
        error,
    })?;
    if prepared.guid != guid {
        return Err(InstantiateError::Guid {
            argument: version.identity(),
            given: guid.to_owned(),
            expected: prepared.guid,
        });
    }
    let interface = prepared.model.outputs.interface;
    match integrated_by {
        Interface::CoSimulation if !interface.steps() => {
            return Err(InstantiateError::Interface {
                has: Interface::ModelExchange,
                option: "cs",
            });
        }
        Interface::ModelExchange if !interface.exchanges() => {
            return Err(InstantiateError::Interface {
                has: Interface::CoSimulation,
                option: "me",
            });
        }
        _ => {}
    }
    let clash = |error| InstantiateError::Table {
        path: path.clone(),
        error,
    };
    let variables = table(&prepared.model).map_err(clash)?;
    let layout = Layout::new(version, &prepared.model, &variables).map_err(clash)?;
    Ok(Instance::new(
        logger,
        (version, integrated_by),
        GuidHash::new(guid),
        (Arc::new(prepared.model), prepared.hash),
        variables,
        layout,
    ))
}

/// The prepared model's text, from the first reading of `location` under which there is one.
fn read(version: Version, location: &[u8]) -> Result<(PathBuf, String), InstantiateError> {
    let (argument, advice) = version.location();
    let nowhere = |error: UriError| InstantiateError::Uri {
        argument,
        error,
        advice,
    };
    let mut first_error = None;
    for folder in uri::folders(location).map_err(nowhere)? {
        let path = folder.join(FILE_NAME);
        match std::fs::read_to_string(&path) {
            Ok(text) => return Ok((path, text)),
            Err(error) => {
                let path = path.display().to_string();
                first_error.get_or_insert(InstantiateError::Read {
                    path,
                    error,
                    advice,
                });
            }
        }
    }
    Err(first_error.unwrap_or_else(|| nowhere(UriError::Empty)))
}
