//! The library of an unpacked FMU for this system.

use super::description::Description;
use super::error::RunError;
use crate::library::target;
use std::path::{Path, PathBuf};
use urdf2fmu_core::settings::FmiVersion;

/// This system's folder under `binaries/`.
fn platform(fmi: FmiVersion) -> &'static str {
    use std::env::consts::{ARCH, OS};
    target::of(OS, ARCH).map_or(OS, |target| target::folder(target.platform, fmi.major()))
}

/// Its path.
///
/// # Errors
/// [`RunError::Platform`], with the systems that there are.
pub(super) fn library(folder: &Path, description: &Description) -> Result<PathBuf, RunError> {
    let identifier = &description.model_identifier;
    let platform = platform(description.fmi);
    let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
    let file = if cfg!(target_os = "macos") {
        format!("{identifier}.dylib")
    } else {
        file
    };
    let binaries = folder.join("binaries");
    let path = binaries.join(platform).join(&file);
    if path.is_file() {
        return Ok(path);
    }
    let mut found: Vec<String> = std::fs::read_dir(&binaries)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    Err(RunError::Platform {
        platform: platform.to_owned(),
        file,
        found: if found.is_empty() {
            "none".to_owned()
        } else {
            found.join(", ")
        },
    })
}
