//! Faults that would be told only once those before them are mended.
//!
//! A robot goes from file to file and from check to check, and an error ends the way. So that one
//! run tells all that it can, what is left after an error goes on, and of what is found then the
//! errors are told that do not follow from the first ones: those of names. What is missing is not
//! taken for a fault: masses, shapes and limits may hang on what is wrong before.

use crate::world;
use std::path::Path;
use urdf2fmu_core::assemble;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::settings::Settings;
use urdf2fmu_core::urdf::{Description, ReadOptions};
use urdf2fmu_core::variables;

/// Errors of the assembly that are about names, whatever else is wrong.
const OF_NAMES: [&str; 8] = [
    "A101", "A102", "A103", "A130", "A131", "A137", "A139", "A140",
];

/// Errors of a robot's file that settings can mend: those of masses and inertias.
const OF_MASSES: &str = "U06";

/// Of a robot's findings what does not follow from faults of its settings.
///
/// - `is_toml`: whether any of them could be read
pub(super) fn beside_settings(
    findings: Vec<Diagnostic>,
    is_toml: bool,
) -> impl Iterator<Item = Diagnostic> {
    let holds = move |finding: &Diagnostic| {
        let of_file = finding.code.starts_with('U') && !finding.code.starts_with(OF_MASSES);
        finding.severity == Severity::Error && (is_toml || of_file)
    };
    findings.into_iter().filter(holds)
}

/// What else is wrong with a robot whose file has errors.
///
/// - `arguments`: for xacro
pub(super) fn beside_robot(
    urdf: &Path,
    arguments: &[String],
    (settings, options): (&Settings, &ReadOptions),
) -> Vec<Diagnostic> {
    let options = ReadOptions {
        rest: true,
        drawn: false,
        ..options.clone()
    };
    let read = world::read(urdf, arguments, &options);
    read.map_or_else(
        |_| Vec::new(),
        |(description, _)| of(&description, settings),
    )
}

/// What is wrong with the names in a robot and its settings.
pub(super) fn of(description: &Description, settings: &Settings) -> Vec<Diagnostic> {
    let settings = alone(settings);
    let (_, findings) = assemble::inspect(description, &settings);
    let told = |finding: &Diagnostic| {
        finding.severity == Severity::Error && OF_NAMES.contains(&finding.code)
    };
    let mut list: Vec<Diagnostic> = findings.into_iter().filter(told).collect();
    list.extend(clash(description, &settings));
    list
}

/// Names that become one.
pub(super) fn clash(description: &Description, settings: &Settings) -> Option<Diagnostic> {
    let (model, _) = assemble::inspect(description, &alone(settings));
    let error = variables::table(&model?).err()?;
    Some(crate::diagnostics::clash(description, &error))
}

/// Settings without what names other trees of the world.
fn alone(settings: &Settings) -> Settings {
    let mut alone = settings.clone();
    if !(alone.robots.is_empty() && alone.objects.is_empty()) {
        alone.pairs.clear();
        alone.loops.clear();
        alone.springs.clear();
        alone.closure_outputs = [Vec::new(), Vec::new()];
    }
    alone
}
