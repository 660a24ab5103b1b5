//! Reasons why a simulation does not start, or does not reach its end.

use super::attributes::DescriptionError;
use super::csv::CsvError;
use super::library::LibraryError;
use std::path::PathBuf;
use urdf2fmu_core::diagnostic::words::or_meant;
use urdf2fmu_core::digits::Digits;

/// Where a name on the command line stands.
pub(super) const START_VALUE: &str = "--start-value";

/// As [`START_VALUE`].
pub(super) const OUTPUT_VARIABLE: &str = "--output-variable";

/// Why nothing, or not all, was simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The description.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// A file that cannot be read.
    #[error("cannot read '{}': {source}{}", path.display(), or_meant(path, source))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The inputs.
    #[error("'{}': {source}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CsvError,
    },
    /// A name that is no variable, or cannot be set.
    #[error("{place}: {what}")]
    Name {
        /// Where it stands.
        place: String,
        /// What is wrong with it, and what comes nearest.
        what: String,
    },
    /// A value.
    #[error("--start-value {name}: '{text}' is no {expected}")]
    Value {
        /// The variable.
        name: String,
        /// As written.
        text: String,
        /// What it must be.
        expected: &'static str,
    },
    /// Times that make no simulation.
    #[error("{0}")]
    Times(String),
    /// Times of the FMU that make no simulation.
    #[error("modelDescription.xml: <DefaultExperiment> makes no simulation: {0}")]
    Default(String),
    /// No library for this system.
    #[error(
        "the FMU has no library for this system: there is no binaries/{platform}/{file}; it has: {found}"
    )]
    Platform {
        /// This system's folder.
        platform: String,
        /// File name.
        file: String,
        /// Folders that there are.
        found: String,
    },
    /// The library.
    #[error(transparent)]
    Library(#[from] LibraryError),
    /// A step.
    #[error("the simulation stopped at {} s of {} s: {why}", Digits(*time), Digits(*stop))]
    Stopped {
        /// s
        time: f64,
        /// s
        stop: f64,
        /// What the FMU said.
        why: String,
    },
    /// The FMU's wish.
    #[error("the FMU asked to end the simulation at {} s of {} s", Digits(*time), Digits(*stop))]
    Over {
        /// s
        time: f64,
        /// s
        stop: f64,
    },
    /// Ctrl-C.
    #[error("ended by the user at {} s of {} s", Digits(*time), Digits(*stop))]
    Ended {
        /// s
        time: f64,
        /// s
        stop: f64,
    },
}

impl RunError {
    /// Whether the command was used in a wrong way.
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Name { place, .. } => place == START_VALUE || place == OUTPUT_VARIABLE,
            Self::Value { .. } | Self::Times(_) => true,
            _ => false,
        }
    }

    /// Whether the simulation failed, rather than what it was to be made of.
    pub fn is_simulation(&self) -> bool {
        matches!(
            self,
            Self::Library(_) | Self::Stopped { .. } | Self::Over { .. }
        )
    }
}

/// The error of a simulation until `stop` that came to `time`, s.
pub(super) fn stopped(time: f64, stop: f64, why: &impl ToString) -> RunError {
    let why = why.to_string();
    RunError::Stopped { time, stop, why }
}
