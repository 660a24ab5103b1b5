//! The settings file: base, actuators, contact, world, initial state, outputs.
//!
//! TOML text → [`Settings`]. Every error that does not depend on the robot is found here, with its
//! place; names and globs are matched when the model is built (see [`crate::assemble`]). Defaults
//! and ranges are in [`keys::KEYS`].
//!
//! | code | about |
//! |---|---|
//! | S101 | not TOML |
//! | S102 | unknown key |
//! | S103 | wrong type |
//! | S104 | value outside its range |
//! | S106 | keys that contradict each other |
//! | S107 | a key that must be there is missing |
//! | S108 | the file cannot be read |

mod advice;
mod closures;
mod common;
mod compat;
mod fill;
mod fmu;
pub mod keys;
mod numbers;
mod reader;
mod section;
mod sensor;
mod terrain;
mod types;
mod world;

pub use closures::{LoopChoice, LoopSettings, SpringSettings};
pub use compat::Compat;
pub use fmu::{FmiVersion, FmuSettings};
pub use sensor::{Errors, Fan, SensorSettings, SensorSettingsKind};
pub use types::{
    ActuatorSettings, BaseChoice, ContactOutputs, GeneratedHeights, GroupSettings, HeightForm,
    HeightSource, InertiaSource, InitialSettings, JointSettings, LinkSettings, MeshCollision,
    ModeChoice, Mounting, ObjectSettings, ObjectSource, PairSettings, RobotSettings, Settings,
    TerrainSettings, WheelFit,
};

pub(crate) use fill::{STATIC_FRICTION_HELP, static_excess};
pub use world::is_taken;

use crate::diagnostic::words::instead_of;
use crate::diagnostic::{Diagnostic, Severity};
use crate::encoding::{NoText, text};
use crate::reading;
use fill::fill;
use reader::Reader;
use section::Section;
use std::path::Path;

impl Default for Settings {
    /// What an empty file means.
    fn default() -> Self {
        let mut reader = Reader::new("", "");
        fill(&mut reader, &Section::default(), None)
    }
}

/// What to do about a file of settings that cannot be read.
fn unread(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "correct the name of the file",
        _ => "the settings are a TOML file in UTF-8",
    }
}

impl Settings {
    /// What an empty file means under the conventions of another simulator.
    pub fn of(compat: Compat) -> Self {
        let mut reader = Reader::new("", "");
        fill(&mut reader, &Section::default(), Some(compat))
    }

    /// Reads a settings file.
    ///
    /// # Errors
    /// Everything that is wrong with it, see the module's table of codes.
    pub fn read(path: &Path) -> Result<Self, Vec<Diagnostic>> {
        Self::read_as(path, None)
    }

    /// Reads a settings file; a given `compat` wins over the file's.
    ///
    /// # Errors
    /// As [`Settings::read`].
    pub fn read_as(path: &Path, compat: Option<Compat>) -> Result<Self, Vec<Diagnostic>> {
        match Self::read_rest(path, None, compat) {
            (Some(settings), findings) if findings.is_empty() => Ok(settings),
            (_, findings) => Err(findings),
        }
    }

    /// What is right of a settings file, none if it cannot be read, and everything that is wrong
    /// with it: for what can be told of a robot beside it.
    ///
    /// - `folder`: what relative names of files in it count from; none for its own folder
    pub fn read_rest(
        path: &Path,
        folder: Option<&Path>,
        compat: Option<Compat>,
    ) -> (Option<Self>, Vec<Diagnostic>) {
        let name = path.display().to_string();
        let no_text = |refused: NoText| {
            let before = &refused.bytes[..refused.at];
            let line = before.split(|byte| *byte == b'\n').count();
            std::io::Error::other(format!("line {line} is no text in UTF-8"))
        };
        let read = reading::read(path, reading::LARGEST_TEXT);
        match read.and_then(|bytes| text(bytes).map_err(no_text)) {
            Ok(text) => {
                let mut reader = Reader::new(&name, &text);
                reader.folder = folder.unwrap_or(reader.folder);
                Self::read_by(reader, compat)
            }
            Err(error) => {
                let finding = Diagnostic {
                    severity: Severity::Error,
                    code: "S108",
                    message: format!("cannot read the settings '{name}': {error}"),
                    help: Some(instead_of(path, &error))
                        .filter(|help| !help.is_empty())
                        .or_else(|| Some(unread(&error).to_owned())),
                    place: None,
                };
                (None, vec![finding])
            }
        }
    }

    /// Reads the text of a settings file; `file_name` is for the findings.
    ///
    /// # Errors
    /// Everything that is wrong with it, see the module's table of codes.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::parse_as(text, file_name, None)
    }

    fn parse_as(
        text: &str,
        file_name: &str,
        compat: Option<Compat>,
    ) -> Result<Self, Vec<Diagnostic>> {
        match Self::read_by(Reader::new(file_name, text), compat) {
            (Some(settings), findings) if findings.is_empty() => Ok(settings),
            (_, findings) => Err(findings),
        }
    }

    /// What is right of a text, and everything that is wrong with it.
    fn read_by(mut reader: Reader, compat: Option<Compat>) -> (Option<Self>, Vec<Diagnostic>) {
        let root = if let Some((span, kind, help)) = foreign(reader.text) {
            reader.error("S101", &span, format!("the file is {kind}, not TOML"), help);
            section::Section::default()
        } else {
            reader.read()
        };
        let settings = Some(fill(&mut reader, &root, compat));
        let mut findings = without_consequences(reader.findings);
        findings.sort_by_key(|d| d.place.as_ref().map_or((0, 0), |p| (p.line, p.column)));
        (settings, findings)
    }
}

/// The first line of a text that begins like a robot, JSON or YAML, its kind and what to do: what a
/// parser of TOML says of it is noise.
fn foreign(text: &str) -> Option<(std::ops::Range<usize>, &'static str, &'static str)> {
    let blank = |line: &&str| {
        let line = line.trim_start_matches('\u{feff}').trim();
        line.is_empty() || line.starts_with('#')
    };
    let before: usize = text
        .split_inclusive('\n')
        .take_while(blank)
        .map(str::len)
        .sum();
    let line = text[before..].lines().next()?;
    let solid = line.trim_start_matches('\u{feff}').trim();
    let start = before + line.find(solid)?;
    let word = solid.strip_suffix(':').unwrap_or_default();
    let is_word = |c: char| c.is_alphanumeric() || "_-".contains(c);
    let (kind, help) = if solid.starts_with('<') {
        ("XML", "settings are TOML 1.0; a URDF is given without -c")
    } else if solid.starts_with('{') {
        (
            "JSON",
            "settings are TOML 1.0: [robot], and below it base = \"fixed\"",
        )
    } else if solid == "---" || !word.is_empty() && word.chars().all(is_word) {
        (
            "YAML",
            "settings are TOML 1.0: [robot], and below it base = \"fixed\"",
        )
    } else {
        return None;
    };
    Some((start..start + solid.len(), kind, help))
}

/// Findings that do not follow from a line that is no TOML: what stands in such a line, and what is
/// missing or does not fit together, may be as it should be once the line is mended.
fn without_consequences(mut findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let line = |finding: &Diagnostic| finding.place.as_ref().map(|place| place.line);
    let broken = findings.iter().filter(|finding| finding.code == "S101");
    let broken: Vec<_> = broken.map(line).collect();
    if !broken.is_empty() {
        findings.retain(|finding| {
            let depends = ["S106", "S107"].contains(&finding.code);
            finding.code == "S101" || !depends && !broken.contains(&line(finding))
        });
    }
    findings
}

#[cfg(test)]
mod tests;
