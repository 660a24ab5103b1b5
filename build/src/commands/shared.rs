//! What all commands share: the errors that can end them early, and robots made into FMUs.

use crate::archive;
use crate::diagnostics::{self, Style};
use crate::importer::error::RunError;
use crate::output::{OutputError, Target, tell};
use crate::picture::ShowError;
use crate::results::ResultsError;
use crate::scene::{self, SceneError};
use crate::stage::{self, Request, StageError};
use crate::view::ViewError;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModelError};
use urdf2fmu_core::variables::TableError;

/// Exit code after Ctrl-C, as shells have it: 128 and the number of SIGINT.
const ENDED: u8 = 130;

/// What ends the program early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Findings; they are printed one by one.
    #[error("{summary}")]
    Findings {
        /// All of them, errors too.
        findings: Vec<Diagnostic>,
        /// One line for the end.
        summary: String,
    },
    /// Anything on the way to an FMU.
    #[error(transparent)]
    Stage(StageError),
    /// Reading or writing a zip.
    #[error(transparent)]
    Archive(#[from] archive::ArchiveError),
    /// The FMU's model.
    #[error("'{}': {source}", path.display())]
    Prepared {
        /// The FMU.
        path: PathBuf,
        /// Why.
        source: PreparedModelError,
    },
    /// The FMU's table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Whatever is written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// `init -c`.
    #[error("init writes new settings: leave -c out")]
    InitFromSettings,
    /// The simulation of an FMU.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A folder to unpack an FMU in.
    #[error("cannot make a temporary folder: {0}")]
    Temporary(std::io::Error),
    /// The FMU's scene.
    #[error("'{}': resources/{FILE}: {source}", path.display(), FILE = scene::FILE_NAME)]
    Scene {
        /// The FMU.
        path: PathBuf,
        /// Why.
        source: SceneError,
    },
    /// An FMU without a scene.
    #[error(
        "'{}' has no resources/{FILE}, so there is nothing to draw; export the robot again with this urdf2fmu",
        path.display(), FILE = scene::FILE_NAME
    )]
    NoScene {
        /// The FMU.
        path: PathBuf,
    },
    /// `--run` with a theme that has no background.
    #[error("an animation needs something behind the robot: --theme light or --theme dark")]
    FilmTheme,
    /// The run of `--run`.
    #[error("'{}': {source}", path.display())]
    Show {
        /// The table.
        path: PathBuf,
        /// Why.
        source: ShowError,
    },
    /// The table of a run that is shown.
    #[error("'{}': {source}", path.display())]
    Results {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ResultsError,
    },
    /// A live view.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A file that cannot be read.
    #[error("cannot read '{}': {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// An FMU that another program made.
    #[error("'{}' was not made by urdf2fmu: it has no resources/{FILE_NAME}", path.display())]
    ForeignFmu {
        /// The file.
        path: PathBuf,
    },
}

impl CliError {
    /// The program's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stage(StageError::Platform { .. }) | Self::InitFromSettings | Self::FilmTheme => {
                2
            }
            Self::Stage(StageError::Trial(_)) => 3,
            Self::Run(error) | Self::View(ViewError::Run(error)) if error.is_simulation() => 3,
            Self::Run(error) if error.is_usage() => 2,
            Self::Run(RunError::Ended { .. }) => ENDED,
            _ => 1,
        }
    }
}

impl From<StageError> for CliError {
    fn from(error: StageError) -> Self {
        match error {
            StageError::Robot(findings) => {
                let tally = diagnostics::tally(&findings).unwrap_or_default();
                Self::Findings {
                    findings,
                    summary: format!("the robot cannot be used: {tally}"),
                }
            }
            other => Self::Stage(other),
        }
    }
}

/// A folder that goes with the command.
pub(super) fn temporary() -> Result<TempDir, CliError> {
    let mut builder = tempfile::Builder::new();
    builder
        .prefix("urdf2fmu-")
        .tempdir()
        .map_err(CliError::Temporary)
}

/// An FMU as it is, or that of a robot, written into `folder`; and the files that it comes from.
pub(super) fn as_fmu(
    file: &Path,
    request: &Request,
    folder: &Path,
) -> Result<(PathBuf, Vec<PathBuf>), CliError> {
    let mut inputs = vec![file.to_owned()];
    if is_fmu(file) {
        return Ok((file.to_owned(), inputs));
    }
    let robot = stage::robot(request)?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let path = folder.join("robot.fmu");
    let fmu = stage::fmu(&robot, file, &[], false)?;
    Target::new(&path, [])?.write(&fmu.bytes)?;
    inputs.extend(robot.sources);
    Ok((path, inputs))
}

/// Whether a file is named as an FMU.
pub(super) fn is_fmu(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("fmu"))
}

/// Prints findings that are at least as bad as `least`.
///
/// # Errors
/// [`OutputError::Stream`].
pub fn print_findings(findings: &[Diagnostic], least: Severity) -> Result<(), OutputError> {
    let style = Style::of_stderr();
    let worst = findings.iter().filter(|d| d.severity >= least);
    tell(
        &worst
            .map(|d| diagnostics::render(d, style))
            .collect::<String>(),
    )
}
