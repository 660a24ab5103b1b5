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
use std::path::{Path, PathBuf};
use std::sync::Arc;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel};
use urdf2fmu_core::reading;
use urdf2fmu_core::variables::table;

/// Largest model that is read, bytes: what a file of an FMU may unpack to, as the command has it.
/// A model of 2000 degrees of freedom takes a hundredth of it.
const LARGEST_MODEL: u64 = 1 << 30;

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

/// The text of a file of at most so many bytes.
fn text(path: &Path, most: u64) -> std::io::Result<String> {
    let bytes = reading::read(path, most)?;
    let no_text = |_| std::io::Error::other("it is no text in UTF-8");
    String::from_utf8(bytes).map_err(no_text)
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
        match text(&path, LARGEST_MODEL) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of a broken FMU could take all memory of the host.
    #[test]
    fn a_model_larger_than_any_is_refused() {
        let path = std::env::temp_dir().join(format!("urdf2fmu-load-{}", std::process::id()));
        std::fs::write(&path, "{\"a\": 1}").expect("a file");
        assert_eq!(text(&path, 8).expect("all of it"), "{\"a\": 1}");
        let error = text(&path, 7).expect_err("too large").to_string();
        assert_eq!(error, "it has more than 7 bytes");
        std::fs::write(&path, [0xff]).expect("a file");
        let error = text(&path, 7).expect_err("no text").to_string();
        std::fs::remove_file(&path).expect("removed");
        assert_eq!(error, "it is no text in UTF-8");
    }
}
