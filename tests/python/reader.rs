//! Robots as read by this project, for comparison with other programs.

use std::path::Path;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::{BaseChoice, Settings};
use urdf2fmu_core::{assemble, urdf};

/// The robot of a URDF file under some settings.
///
/// # Panics
/// If it has an error.
pub fn model(path: &Path, settings: &Settings) -> Model {
    let options = assemble::read_options(settings, urdf::ReadOptions::from_environment());
    let description = urdf::read(path, &options).unwrap_or_else(|f| panic!("{f:#?}"));
    let built = assemble::build(&description, settings).unwrap_or_else(|f| panic!("{f:#?}"));
    built.model
}

/// The same under default settings, its base floating or fixed as in the other program.
///
/// # Panics
/// If it has an error.
pub fn model_on(path: &Path, floating: bool) -> Model {
    let base = if floating {
        BaseChoice::Floating
    } else {
        BaseChoice::Fixed
    };
    let settings = Settings {
        base,
        ..Settings::default()
    };
    model(path, &settings)
}
