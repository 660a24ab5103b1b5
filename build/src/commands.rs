//! The commands, and the errors that can end them early.
//!
//! Results go to standard output, findings and problems to standard error, all of it through
//! [`crate::output`].

use crate::cli::{Check, Cli, Command, Deny, Export, Info, Init, Simulate};
use crate::diagnostics::{self, Style};
use crate::importer::error::RunError;
use crate::importer::run::{self, Experiment};
use crate::output::{OutputError, Target, print, tell};
use crate::stage::{self, Robot, StageError};
use crate::{archive, info, init, library, summary};
use serde_json::json;
use std::path::{Path, PathBuf};
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel, PreparedModelError};
use urdf2fmu_core::variables::{self, TableError};

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
            Self::Stage(StageError::Platform { .. }) | Self::InitFromSettings => 2,
            Self::Stage(StageError::Trial(_)) => 3,
            Self::Run(error) if error.is_simulation() => 3,
            Self::Run(error) if error.is_usage() => 2,
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

/// Does what was asked.
///
/// # Errors
/// [`CliError`]; the caller prints it.
pub fn run(cli: &Cli) -> Result<(), CliError> {
    match &cli.command {
        Command::Export(args) => export(args),
        Command::Info(args) => show(args),
        Command::Check(args) => check(args),
        Command::Init(args) => init(args),
        Command::Simulate(args) => simulate(args),
    }
}

fn export(args: &Export) -> Result<(), CliError> {
    let robot = stage::robot(&args.source.request(&args.urdf))?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = args.urdf.file_stem().unwrap_or("robot".as_ref());
        PathBuf::from(stem).with_extension("fmu")
    });
    let target = Target::new(&output, robot.sources.iter().map(PathBuf::as_path))?;
    let fmu = stage::fmu(&robot, &args.urdf, &args.platforms)?;
    target.write(&fmu.bytes)?;
    print(&summary::text(&output, &fmu, &robot))?;
    Ok(())
}

fn show(args: &Info) -> Result<(), CliError> {
    let (model, table, platforms) = if is_fmu(&args.file) {
        let path = args.file.clone();
        let Some(bytes) = archive::read_entry(&path, &format!("resources/{FILE_NAME}"))? else {
            return Err(CliError::ForeignFmu { path });
        };
        let platforms = archive::folders(&path, "binaries/")?;
        let prepared = PreparedModel::from_json(&String::from_utf8_lossy(&bytes))
            .map_err(|source| CliError::Prepared { path, source })?;
        let table = variables::table(&prepared.model)?;
        (prepared.model, table, platforms)
    } else {
        let robot = stage::robot(&args.source.request(&args.file))?;
        print_findings(&robot.diagnostics, Severity::Warning)?;
        // Those that its FMU would get.
        let platforms = library::embedded().iter();
        let platforms = platforms.map(|l| l.platform.to_owned()).collect();
        (robot.model, robot.table, platforms)
    };
    if args.json {
        let mut value = info::json(&model, &table, args.variables);
        value["platforms"] = json!(platforms);
        print(&format!("{value:#}\n"))?;
    } else {
        let text = info::text(&model, &table, args.variables);
        print(&format!("{text}\nPlatforms\n  {}\n", platforms.join(" ")))?;
    }
    Ok(())
}

fn init(args: &Init) -> Result<(), CliError> {
    if args.source.config.is_some() {
        return Err(CliError::InitFromSettings);
    }
    let robot = stage::robot(&args.source.request(&args.urdf))?;
    print_findings(&robot.diagnostics, Severity::Warning)?;
    let urdf = args.urdf.file_name().unwrap_or(args.urdf.as_os_str());
    print(&init::text(&init::Subject {
        model: &robot.model,
        settings: &robot.settings,
        diagnostics: &robot.diagnostics,
        urdf: &urdf.to_string_lossy(),
    }))?;
    Ok(())
}

fn check(args: &Check) -> Result<(), CliError> {
    let findings = match stage::robot(&args.source.request(&args.urdf)) {
        Ok(Robot { diagnostics, .. }) => diagnostics,
        Err(StageError::Robot(findings)) => findings,
        Err(other) => return Err(other.into()),
    };
    let worst = findings.iter().map(|d| d.severity).max();
    let refused = worst == Some(Severity::Error)
        || worst == Some(Severity::Warning) && args.deny == Some(Deny::Warnings);
    let tally = diagnostics::tally(&findings);
    if args.json {
        let list: Vec<_> = findings.iter().map(diagnostics::to_json).collect();
        print(&format!(
            "{:#}\n",
            json!({ "ok": !refused, "findings": list })
        ))?;
    } else if !refused {
        let findings_text: String = findings
            .iter()
            .map(|d| diagnostics::render(d, Style::of_stdout()))
            .collect();
        let verdict = tally
            .clone()
            .map_or("ok".to_owned(), |tally| format!("ok, with {tally}"));
        print(&format!(
            "{findings_text}{}: {verdict}\n",
            args.urdf.display()
        ))?;
    }
    if !refused {
        return Ok(());
    }
    Err(CliError::Findings {
        summary: format!("{}: {}", args.urdf.display(), tally.unwrap_or_default()),
        findings: if args.json { Vec::new() } else { findings },
    })
}

fn simulate(args: &Simulate) -> Result<(), CliError> {
    let mut inputs = vec![args.file.clone()];
    inputs.extend(args.input_file.clone());
    let folder = tempfile::Builder::new()
        .prefix("urdf2fmu-")
        .tempdir()
        .map_err(CliError::Temporary)?;
    let fmu = if is_fmu(&args.file) {
        args.file.clone()
    } else {
        let robot = stage::robot(&args.source.request(&args.file))?;
        print_findings(&robot.diagnostics, Severity::Warning)?;
        let path = folder.path().join("robot.fmu");
        let fmu = stage::fmu(&robot, &args.file, &[])?;
        Target::new(&path, [])?.write(&fmu.bytes)?;
        inputs.extend(robot.sources);
        path
    };
    let target = match &args.output_file {
        Some(path) => Some(Target::new(path, inputs.iter().map(PathBuf::as_path))?),
        None => None,
    };
    let unpacked = folder.path().join("fmu");
    archive::unpack(&fmu, &unpacked)?;
    let pairs = args.start_value.chunks_exact(2);
    let outcome = run::simulate(
        &unpacked,
        &Experiment {
            start_time: args.start_time,
            stop_time: args.stop_time,
            output_interval: args.output_interval,
            tolerance: args.tolerance,
            start_values: pairs.map(|p| (p[0].clone(), p[1].clone())).collect(),
            inputs: args.input_file.clone(),
            slopes: args.set_input_derivatives,
            debug_logging: args.debug_logging,
        },
    )?;
    // What was reached is of use even if the end was not.
    let text = outcome.table.to_text();
    let written = match &target {
        Some(target) => target.write(text.as_bytes()),
        None => print(&text),
    };
    let told = outcome.messages.iter().try_for_each(|(status, message)| {
        let word = match status {
            0 => "note",
            1 => "warning",
            _ => "error",
        };
        tell(&format!("{word}: {message}\n"))
    });
    let written = written.and(told);
    match (outcome.failure, written) {
        (None, written) => Ok(written?),
        (Some(failure), Ok(())) => Err(failure.into()),
        (Some(failure), Err(error)) => {
            tell(&format!("error: {error}\n"))?;
            Err(failure.into())
        }
    }
}

fn is_fmu(path: &Path) -> bool {
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
