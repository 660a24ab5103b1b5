//! The command line: what can be asked for, and how the answer is printed.
//!
//! Results go to standard output, findings and problems to standard error.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command prints"
)]

use crate::diagnostics::{self, Style};
use crate::importer::run::{self, Experiment, RunError};
use crate::stage::{self, Request, Robot, StageError};
use crate::{archive, info, init, library, summary};
use clap::{Args, Parser, Subcommand, ValueEnum};
use serde_json::json;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use urdf2fmu_core::model::ActuatorMode;
use urdf2fmu_core::prepared::{FILE_NAME, PreparedModel, PreparedModelError};
use urdf2fmu_core::settings::{BaseChoice, Compat, InertiaSource};
use urdf2fmu_core::urdf::{Diagnostic, Severity};
use urdf2fmu_core::variables::{self, TableError};

/// Any URDF robot in, a self-contained FMI 2.0 co-simulation FMU out.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 ok, 1 a problem in the robot or a file, 2 wrong usage, 3 the simulation failed."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make an FMU of a robot
    #[command(after_help = "Example: urdf2fmu export rover.urdf -o rover.fmu")]
    Export(Export),
    /// Show joints, links and variables of a robot or an FMU
    Info(Info),
    /// Show everything that looks wrong in a robot, with file, line and advice
    Check(Check),
    /// Write commented settings for a robot, which change nothing until they are edited
    #[command(after_help = "Example: urdf2fmu init rover.urdf > rover.toml")]
    Init(Init),
    /// Simulate an FMU, or a robot by way of its FMU, as an importer does
    #[command(
        after_help = "Example: urdf2fmu simulate rover.fmu --start-value cmd.left_front_wheel_joint.velocity 5 \
                      --stop-time 2 --output-file rover.csv"
    )]
    Simulate(Simulate),
}

/// How a robot is read.
#[derive(Debug, Args)]
struct Source {
    /// Settings file (TOML)
    #[arg(short, long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Mount the base in the world
    #[arg(long, conflicts_with = "floating_base")]
    fixed_base: bool,
    /// Let the base move freely
    #[arg(long)]
    floating_base: bool,
    /// What is commanded, for every joint that the settings leave open
    #[arg(long, value_name = "MODE")]
    mode: Option<Mode>,
    /// Conventions of another simulator
    #[arg(long, value_name = "SIMULATOR")]
    compat: Option<Conventions>,
    /// Rotational inertia: from the file, or recomputed
    #[arg(long, value_name = "SOURCE")]
    inertia: Option<Inertia>,
    /// Factor on every length; masses stay
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    scale: Option<f64>,
    /// Names of variables: `joint.elbow.position` or `joint_elbow_position`
    #[arg(long, value_name = "STYLE")]
    naming: Option<NamingStyle>,
    /// SRDF of the robot: its passive joints, and its states for --initial-state
    #[arg(long, value_name = "FILE.srdf")]
    srdf: Option<PathBuf>,
    /// Joint positions to start with: a group state of the SRDF
    #[arg(long, value_name = "NAME", requires = "srdf")]
    initial_state: Option<String>,
    /// Folder to look in for `package://`; may be repeated
    #[arg(long = "package-path", value_name = "DIR")]
    package_paths: Vec<PathBuf>,
    /// Arguments of a .xacro file
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    xacro_arguments: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Mode {
    /// Reach and hold a velocity within an effort
    Velocity,
    /// Reach and hold a position within an effort
    Position,
    /// Apply an effort
    Effort,
    /// Effort plus gains on position and velocity errors
    Pd,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Inertia {
    /// As `<inertia>` says
    Urdf,
    /// Computed from the collision shapes and the mass
    Collision,
    /// Computed as PyBullet does, of the box around the collision shapes
    Pybullet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Conventions {
    /// None but ours
    None,
    /// PyBullet's: inertia, masses, friction, motors, step, drag
    Pybullet,
}

/// `name:=value`.
fn xacro_argument(text: &str) -> Result<String, String> {
    match text.split_once(":=") {
        Some((name, _)) if !name.is_empty() && !name.starts_with('-') => Ok(text.to_owned()),
        _ => Err("arguments of xacro are written name:=value".to_owned()),
    }
}

/// A number above zero.
fn factor(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
        _ => Err("must be a finite number above 0".to_owned()),
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum NamingStyle {
    /// With dots, as FMI's structured names
    Structured,
    /// With underscores, for tools that make trees or buses of dots
    Flat,
}

#[derive(Debug, Args)]
struct Export {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    urdf: PathBuf,
    /// The FMU to write [default: the URDF's name with .fmu, in this folder]
    #[arg(short, long, value_name = "FILE.fmu")]
    output: Option<PathBuf>,
    /// Platforms that the FMU runs on, such as `linux64,win64` [default: all that this program carries]
    #[arg(long = "platform", value_name = "NAMES", value_delimiter = ',')]
    platforms: Vec<String>,
    #[command(flatten)]
    source: Source,
}

#[derive(Debug, Args)]
struct Info {
    /// A URDF or an FMU made by urdf2fmu
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    file: PathBuf,
    /// For other programs
    #[arg(long)]
    json: bool,
    /// List the FMU's variables too
    #[arg(long)]
    variables: bool,
    #[command(flatten)]
    source: Source,
}

#[derive(Debug, Args)]
struct Check {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    urdf: PathBuf,
    /// Treat them as errors
    #[arg(long, value_name = "WHAT")]
    deny: Option<Deny>,
    /// For other programs
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    source: Source,
}

#[derive(Debug, Args)]
struct Init {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    urdf: PathBuf,
    #[command(flatten)]
    source: Source,
}

#[derive(Debug, Args)]
struct Simulate {
    /// A URDF or an FMU
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    file: PathBuf,
    /// Inputs over time: CSV, `time` first, then inputs by name; straight lines between the rows
    #[arg(long, value_name = "FILE.csv")]
    input_file: Option<PathBuf>,
    /// Where the results go, as CSV [default: standard output]
    #[arg(long, value_name = "FILE.csv")]
    output_file: Option<PathBuf>,
    /// Sets a parameter or an input at the start; may be repeated
    #[arg(long, num_args = 2, value_names = ["NAME", "VALUE"], action = clap::ArgAction::Append,
          allow_negative_numbers = true)]
    start_value: Vec<String>,
    /// s [default: the FMU's]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    start_time: Option<f64>,
    /// s [default: the FMU's]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    stop_time: Option<f64>,
    /// Communication step, s [default: the FMU's]
    #[arg(long, value_name = "S")]
    output_interval: Option<f64>,
    /// Relative tolerance [default: the FMU's]
    #[arg(long, value_name = "TOL")]
    tolerance: Option<f64>,
    /// Tell the FMU the slopes of its inputs, too: they then change within the steps
    #[arg(long)]
    set_input_derivatives: bool,
    /// Print what the FMU has to say about its steps
    #[arg(long)]
    debug_logging: bool,
    #[command(flatten)]
    source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Deny {
    /// Findings that are legal but suspicious
    Warnings,
}

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
    /// The output is a file that the robot is made from.
    #[error("'{}' is one of the robot's own files; give another name with -o", path.display())]
    OverwritesInput {
        /// The file.
        path: PathBuf,
    },
    /// `init -c`.
    #[error("init writes new settings: leave -c out")]
    InitFromSettings,
    /// The simulation of an FMU.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A folder to unpack an FMU in.
    #[error("cannot make a temporary folder: {0}")]
    Temporary(std::io::Error),
    /// A zip of somebody else.
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

impl Source {
    fn request(&self, urdf: &Path) -> Request {
        let base = match (self.fixed_base, self.floating_base) {
            (true, _) => Some(BaseChoice::Fixed),
            (_, true) => Some(BaseChoice::Floating),
            _ => None,
        };
        Request {
            urdf: urdf.to_owned(),
            config: self.config.clone(),
            base,
            mode: self.mode.map(|mode| match mode {
                Mode::Velocity => ActuatorMode::Velocity,
                Mode::Position => ActuatorMode::Position,
                Mode::Effort => ActuatorMode::Effort,
                Mode::Pd => ActuatorMode::Pd,
            }),
            inertia: self.inertia.map(|inertia| match inertia {
                Inertia::Urdf => InertiaSource::Urdf,
                Inertia::Collision => InertiaSource::Collision,
                Inertia::Pybullet => InertiaSource::PyBullet,
            }),
            compat: self.compat.map(|compat| match compat {
                Conventions::None => Compat::None,
                Conventions::Pybullet => Compat::PyBullet,
            }),
            scale: self.scale,
            flat_names: self
                .naming
                .map(|naming| matches!(naming, NamingStyle::Flat)),
            srdf: self.srdf.clone(),
            initial_state: self.initial_state.clone(),
            package_paths: self.package_paths.clone(),
            xacro_arguments: self.xacro_arguments.clone(),
        }
    }
}

impl Cli {
    /// Does what was asked.
    ///
    /// # Errors
    /// [`CliError`]; the caller prints it.
    pub fn run(&self) -> Result<(), CliError> {
        match &self.command {
            Command::Export(args) => export(args),
            Command::Info(args) => show(args),
            Command::Check(args) => check(args),
            Command::Init(args) => init(args),
            Command::Simulate(args) => simulate(args),
        }
    }
}

fn export(args: &Export) -> Result<(), CliError> {
    let robot = stage::robot(&args.source.request(&args.urdf))?;
    print_findings(&robot.diagnostics, Severity::Warning);
    let fmu = stage::fmu(&robot, &args.urdf, &args.platforms)?;
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = args.urdf.file_stem().unwrap_or("robot".as_ref());
        PathBuf::from(stem).with_extension("fmu")
    });
    // Resolved, so that neither links nor other spellings of the path get through.
    if let Ok(target) = output.canonicalize()
        && robot
            .sources
            .iter()
            .any(|source| source.canonicalize().is_ok_and(|s| s == target))
    {
        return Err(CliError::OverwritesInput { path: output });
    }
    archive::write_file(&output, &fmu.bytes)?;
    print(&summary::text(&output, &fmu, &robot));
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
        print_findings(&robot.diagnostics, Severity::Warning);
        // Those that its FMU would get.
        let platforms = library::embedded().iter();
        let platforms = platforms.map(|l| l.platform.to_owned()).collect();
        (robot.model, robot.table, platforms)
    };
    if args.json {
        let mut value = info::json(&model, &table, args.variables);
        value["platforms"] = json!(platforms);
        print(&format!("{value:#}\n"));
    } else {
        print(&info::text(&model, &table, args.variables));
        print(&format!("\nPlatforms\n  {}\n", platforms.join(" ")));
    }
    Ok(())
}

fn init(args: &Init) -> Result<(), CliError> {
    if args.source.config.is_some() {
        return Err(CliError::InitFromSettings);
    }
    let robot = stage::robot(&args.source.request(&args.urdf))?;
    print_findings(&robot.diagnostics, Severity::Warning);
    let urdf = args.urdf.file_name().unwrap_or(args.urdf.as_os_str());
    print(&init::text(&init::Subject {
        model: &robot.model,
        settings: &robot.settings,
        diagnostics: &robot.diagnostics,
        urdf: &urdf.to_string_lossy(),
    }));
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
        ));
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
        ));
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
    let folder = tempfile::Builder::new()
        .prefix("urdf2fmu-")
        .tempdir()
        .map_err(CliError::Temporary)?;
    let fmu = if is_fmu(&args.file) {
        args.file.clone()
    } else {
        let robot = stage::robot(&args.source.request(&args.file))?;
        print_findings(&robot.diagnostics, Severity::Warning);
        let path = folder.path().join("robot.fmu");
        archive::write_file(&path, &stage::fmu(&robot, &args.file, &[])?.bytes)?;
        path
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
    match &args.output_file {
        Some(path) => archive::write_file(path, text.as_bytes())?,
        None => print(&text),
    }
    for (status, message) in &outcome.messages {
        let word = match status {
            0 => "note",
            1 => "warning",
            _ => "error",
        };
        eprintln!("{word}: {message}");
    }
    outcome.failure.map_or(Ok(()), |error| Err(error.into()))
}

fn is_fmu(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("fmu"))
}

/// Prints findings that are at least as bad as `least`.
pub fn print_findings(findings: &[Diagnostic], least: Severity) {
    let style = Style::of_stderr();
    for finding in findings.iter().filter(|d| d.severity >= least) {
        eprint!("{}", diagnostics::render(finding, style));
    }
}

/// Prints a result; a reader that has seen enough (`| head`) is no error.
fn print(text: &str) {
    _ = std::io::stdout().lock().write_all(text.as_bytes());
}
