//! What all commands share: the errors that can end them early, and robots made into FMUs.

use crate::archive;
use crate::cli::Source;
use crate::diagnostics::{self, Style};
use crate::importer::error::RunError;
use crate::kind::other_kind;
use crate::output::{ENDINGS, OutputError, Target, tell};
use crate::results::ResultsError;
use crate::stage::{self, Extras, Request, StageError};
use crate::view::ViewError;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use urdf2fmu_core::diagnostic::words::or_meant;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModelError};
use urdf2fmu_core::variables::TableError;
use urdf2fmu_drawing::picture::ShowError;
use urdf2fmu_drawing::scene::{self, SceneError};

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
    #[error(
        "cannot make a temporary folder in '{}', where TMPDIR or the system has them: {error}",
        std::env::temp_dir().display(), error = .0
    )]
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
    #[error("cannot read '{}': {source}{}", path.display(), or_meant(path, source))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Neither a robot nor an FMU.
    #[error("'{}' is {kind}", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// What it is.
        kind: &'static str,
    },
    /// Options about how a robot is read, with an FMU.
    #[error(
        "'{}' is an FMU already, and {} belong{} to its export: give the URDF instead, or export it again with {}",
        path.display(), options.join(", "), if options.len() == 1 { "s" } else { "" },
        if options.len() == 1 { "it" } else { "them" }
    )]
    MadeAlready {
        /// The FMU.
        path: PathBuf,
        /// The options.
        options: Vec<&'static str>,
    },
    /// A file that is named as what is not written.
    #[error("what {option} writes is {writes}, and '{}' is named as something else: end it with .{ending}", path.display())]
    Ending {
        /// The file.
        path: PathBuf,
        /// The option that names it.
        option: &'static str,
        /// What is written.
        writes: &'static str,
        /// How such a file ends.
        ending: &'static str,
    },
    /// `explain` of what is no code.
    #[error("there is no finding '{code}'; urdf2fmu explain lists all")]
    Code {
        /// As asked for.
        code: String,
    },
    /// `init --ssv`
    #[error("the parameters cannot be written: {0}")]
    Ssv(std::io::Error),
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
            Self::Stage(StageError::Library(error)) if error.is_usage() => 2,
            Self::InitFromSettings
            | Self::FilmTheme
            | Self::Code { .. }
            | Self::MadeAlready { .. }
            | Self::Ending { .. } => 2,
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
    let make = || builder.prefix("urdf2fmu-").tempdir();
    #[cfg(unix)]
    let folder = crate::process::passing(make);
    #[cfg(not(unix))]
    let folder = make();
    folder.map_err(CliError::Temporary)
}

/// An FMU as it is, or that of a robot, written into `folder`; and the files that it comes from.
pub(super) fn as_fmu(
    file: &Path,
    request: &Request,
    folder: &Path,
) -> Result<(PathBuf, Vec<PathBuf>), CliError> {
    refuse_other_kinds(file)?;
    let mut inputs = vec![file.to_owned()];
    if is_fmu(file) {
        return Ok((file.to_owned(), inputs));
    }
    let robot = stage::robot(request)?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let path = folder.join("robot.fmu");
    let fmu = stage::fmu(&robot, file, &[], &Extras::default())?;
    Target::new(&path, [])?.write(&fmu.bytes)?;
    inputs.extend(robot.sources);
    Ok((path, inputs))
}

/// Refuses a file that is neither a robot nor an FMU.
///
/// # Errors
/// [`CliError::Kind`].
pub(super) fn refuse_other_kinds(path: &Path) -> Result<(), CliError> {
    other_kind(path).map_or(Ok(()), |kind| {
        Err(CliError::Kind {
            path: path.to_owned(),
            kind,
        })
    })
}

/// Refuses options about how a robot is read where `path` is an FMU: they would do nothing.
///
/// # Errors
/// [`CliError::MadeAlready`].
pub(super) fn refuse_options(path: &Path, source: &Source) -> Result<(), CliError> {
    refuse_given(path, source.given())
}

/// The same for options by their names.
///
/// # Errors
/// [`CliError::MadeAlready`].
pub(super) fn refuse_given(path: &Path, options: Vec<&'static str>) -> Result<(), CliError> {
    if options.is_empty() || !is_fmu(path) {
        return Ok(());
    }
    let path = path.to_owned();
    Err(CliError::MadeAlready { path, options })
}

/// Refuses to write what belongs into files that end with `ending` into one that is named as
/// another kind of file.
///
/// - `option`, `writes`: who names the file, and what is written, for the message
///
/// # Errors
/// [`CliError::Ending`].
pub(super) fn refuse_ending(
    path: Option<&PathBuf>,
    option: &'static str,
    [writes, ending]: [&'static str; 2],
) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    let own = path.extension().map(|own| own.to_string_lossy());
    let own = own.unwrap_or_default().to_lowercase();
    let fits = own == ending || own == "htm" && ending == "html";
    if fits || !ENDINGS.contains(&own.as_str()) {
        return Ok(());
    }
    Err(CliError::Ending {
        path: path.clone(),
        option,
        writes,
        ending,
    })
}

/// Whether a file is named as an FMU.
pub(super) fn is_fmu(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("fmu"))
}

/// Refuses an FMU, which is there, where a robot is meant; `kind`: what it is, and what takes it.
pub(super) fn refuse_fmu(path: &Path, kind: &'static str) -> Result<(), CliError> {
    if !is_fmu(path) || !path.exists() {
        return Ok(());
    }
    let path = path.to_owned();
    Err(CliError::Kind { path, kind })
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
