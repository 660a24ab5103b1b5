//! The command line and its options. [`crate::commands`] executes it.

mod given;
mod meant;
mod object;
mod packing;
mod request;
mod texts;
mod values;

use clap::{Args, Parser, Subcommand, ValueEnum};
pub(crate) use meant::instead;
pub(crate) use packing::Packing;
use std::path::PathBuf;
pub(crate) use texts::{Expand, Explain};
use urdf2fmu_core::settings::ObjectSettings;
use urdf2fmu_drawing::picture::{self, Look, Toward};
use values::{
    ArrayStyle, InterfaceChoice, density, factor, folder, mass, package, place, rate, seconds,
    size, speed, tolerance, xacro_argument,
};

/// Any URDF robot in, a self-contained FMI co-simulation FMU out.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 ok, 1 a problem in the robot or a file, 2 wrong usage, 3 the simulation failed, \
                  130 ended by Ctrl-C."
)]
pub struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
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
    /// Take a picture of a robot, or of an FMU made by urdf2fmu, as a PNG
    #[command(after_help = "Example: urdf2fmu picture rover.urdf -o rover.png --theme light")]
    Picture(Picture),
    /// Make a page that plays a run in 3-D and plots it, from results of any program
    #[command(after_help = "Example: urdf2fmu report out.csv --model rover.fmu -o rover.html")]
    Report(Report),
    /// Simulate an FMU, or a robot by way of its FMU, as an importer does
    #[command(
        after_help = "Example: urdf2fmu simulate rover.fmu --start-value cmd.left_front_wheel_joint.velocity 5 \
                      --stop-time 2 --output-file rover.csv"
    )]
    Simulate(Simulate),
    /// Expand a file in xacro to a URDF, without Python
    #[command(after_help = "Example: urdf2fmu expand arm.urdf.xacro name:=left > arm.urdf")]
    Expand(Expand),
    /// Explain a finding by its code
    #[command(after_help = "Example: urdf2fmu explain U063")]
    Explain(Explain),
    /// Show a robot live in a browser: drive it, push it, pause it
    #[command(after_help = "Example: urdf2fmu view rover.urdf")]
    View(View),
}

/// How a robot is read.
#[derive(Debug, Args)]
pub(crate) struct Source {
    /// Settings file (TOML)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Folder that names of files in the settings count from [default: that of the settings]
    #[arg(long, value_name = "DIR", requires = "config")]
    pub(crate) config_folder: Option<PathBuf>,
    /// Mount the base in the world
    #[arg(long, conflicts_with = "floating_base")]
    pub(crate) fixed_base: bool,
    /// Let the base move freely
    #[arg(long)]
    pub(crate) floating_base: bool,
    /// What is commanded, for every joint that the settings leave open
    #[arg(long, value_name = "MODE")]
    pub(crate) mode: Option<Mode>,
    /// Conventions of another simulator
    #[arg(long, value_name = "SIMULATOR")]
    pub(crate) compat: Option<Conventions>,
    /// Rotational inertia: from the file, or recomputed
    #[arg(long, value_name = "SOURCE")]
    pub(crate) inertia: Option<Inertia>,
    /// Sensors that the file describes: left out, or read
    #[arg(long, value_name = "SOURCE")]
    pub(crate) sensors: Option<Sensors>,
    /// kg/m³, of links that the file gives no mass: they weigh what their collision shapes weigh
    #[arg(long, value_name = "DENSITY", value_parser = density, allow_hyphen_values = true)]
    pub(crate) density: Option<f64>,
    /// kg, of links that cannot move without a mass: solids of their collision shapes, or balls
    #[arg(long, value_name = "MASS", value_parser = mass, allow_hyphen_values = true)]
    pub(crate) missing_mass: Option<f64>,
    /// Factor on every length; masses stay
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_hyphen_values = true)]
    pub(crate) scale: Option<f64>,
    /// Names of variables: `joint.elbow.position` or `joint_elbow_position`
    #[arg(long, value_name = "STYLE")]
    pub(crate) naming: Option<NamingStyle>,
    /// Version of the Functional Mock-up Interface
    #[arg(long, value_name = "VERSION")]
    pub(crate) fmi: Option<Fmi>,
    /// Who integrates: the FMU (cs, co-simulation), the importer (me, Model Exchange), or either
    #[arg(long, value_name = "INTERFACE")]
    pub(crate) interface: Option<InterfaceChoice>,
    /// What FMI 3 lists as arrays: vectors of outputs and parameters, nothing, or vectors of inputs
    /// and of all joints, too
    #[arg(long, value_name = "WHAT")]
    pub(crate) arrays: Option<ArrayStyle>,
    /// SRDF of the robot: its passive joints, and its states for --initial-state
    #[arg(long, value_name = "FILE.srdf")]
    pub(crate) srdf: Option<PathBuf>,
    /// Joint positions to start with: a group state of the SRDF
    #[arg(long, value_name = "NAME", requires = "srdf")]
    pub(crate) initial_state: Option<String>,
    /// Folder to look in for `package://`; may be repeated
    #[arg(long = "package-path", value_name = "DIR", value_parser = folder)]
    pub(crate) package_paths: Vec<PathBuf>,
    /// Folder of one package, for `package://NAME/…`; may be repeated
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    pub(crate) packages: Vec<(String, PathBuf)>,
    /// Something else in the world: a URDF, and where its base is in m and rad; without z it stands
    /// on the ground; may be repeated
    #[arg(long = "object", value_name = "FILE[@X,Y[,Z[,ROLL,PITCH,YAW]]]", value_parser = object::parse)]
    pub(crate) objects: Vec<ObjectSettings>,
    /// Arguments of a .xacro file
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub(crate) xacro_arguments: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Mode {
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
pub(crate) enum Inertia {
    /// As `<inertia>` says
    Urdf,
    /// As `<inertia>` says, or the nearest that a body can have
    Nearest,
    /// Computed from the collision shapes and the mass
    Collision,
    /// Computed as PyBullet does, of the box around the collision shapes
    Pybullet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Sensors {
    /// Only those of the settings
    None,
    /// `<sensor>` and `<gazebo><sensor>`, too
    Urdf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Conventions {
    /// None but ours
    None,
    /// PyBullet's: inertia, masses, friction, motors, step, drag
    Pybullet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum NamingStyle {
    /// With dots, as FMI's structured names
    Structured,
    /// With underscores, for tools that make trees or buses of dots
    Flat,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Fmi {
    /// FMI 2.0
    #[value(name = "2")]
    V2,
    /// FMI 3.0
    #[value(name = "3")]
    V3,
}

#[derive(Debug, Args)]
pub(crate) struct Export {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    pub(crate) urdf: PathBuf,
    /// The FMU to write [default: the URDF's name with .fmu, in this folder]
    #[arg(short, long, value_name = "FILE.fmu")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) packing: Packing,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct Info {
    /// A URDF or an FMU made by urdf2fmu
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    pub(crate) file: PathBuf,
    /// For other programs
    #[arg(long)]
    pub(crate) json: bool,
    /// List the FMU's variables too
    #[arg(long)]
    pub(crate) variables: bool,
    #[command(flatten)]
    pub(crate) packing: Packing,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    pub(crate) urdf: PathBuf,
    /// Treat them as errors
    #[arg(long, value_name = "WHAT")]
    pub(crate) deny: Option<Deny>,
    /// For other programs
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) packing: Packing,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct Init {
    /// The robot
    #[arg(value_name = "ROBOT.urdf")]
    pub(crate) urdf: PathBuf,
    /// Write the FMU's parameters with their values as an SSV file instead, for tools of SSP 1.0,
    /// or of SSP 2.0 with --fmi 3 and arrays
    #[arg(long)]
    pub(crate) ssv: bool,
    /// Where it goes [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) packing: Packing,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct Picture {
    /// A URDF, or an FMU made by urdf2fmu
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    pub(crate) file: PathBuf,
    /// The picture to write [default: the robot's name with .png, in this folder]
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) output: Option<PathBuf>,
    /// An animated PNG of this run: a table that `simulate` or another importer wrote
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) run: Option<PathBuf>,
    /// Pictures of the run a second
    #[arg(long, value_name = "HZ", value_parser = rate, default_value = "20", allow_hyphen_values = true, requires = "run")]
    pub(crate) rate: f64,
    /// Width and height in pixels, or one number for both [default: 512, of a run 320x240]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[usize; 2]>,
    /// Where the camera stands: front, back, left, right, top, corner, or azimuth from x towards y
    /// and elevation in degrees, such as 120,15
    #[arg(long, value_name = "PLACE", value_parser = place, default_value = "corner",
          allow_hyphen_values = true)]
    pub(crate) from: Toward,
    /// What is behind the robot [default: clear, of a run light]
    #[arg(long, value_name = "THEME")]
    pub(crate) theme: Option<Theme>,
    /// Draw the frames of the base and of the links that move: x red, y green, z blue
    #[arg(long)]
    pub(crate) frames: bool,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Theme {
    /// Nothing but its shadow, for pages of any colour
    Clear,
    /// Nothing at all
    Cutout,
    /// A light floor with a grid
    Light,
    /// A dark floor with a grid
    Dark,
}

impl Picture {
    /// As asked for, with the defaults of a picture or of an animation.
    pub(crate) fn look(&self) -> Look {
        let film = self.run.is_some();
        let (theme, size) = if film {
            (Theme::Light, [320, 240])
        } else {
            (Theme::Clear, [512, 512])
        };
        let [width, height] = self.size.unwrap_or(size);
        let plain = Look::default();
        Look {
            width,
            height,
            from: self.from,
            theme: match self.theme.unwrap_or(theme) {
                Theme::Clear => picture::Theme::Clear,
                Theme::Cutout => picture::Theme::Cutout,
                Theme::Light => picture::Theme::Light,
                Theme::Dark => picture::Theme::Dark,
            },
            // In motion, a third of the sky looks as good.
            sky: if film { plain.sky / 3 } else { plain.sky },
            frames: self.frames,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// A URDF or an FMU
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    pub(crate) file: PathBuf,
    /// Inputs over time: CSV, `time` first, then inputs by name; straight lines between the rows
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) input_file: Option<PathBuf>,
    /// Where the results go, as CSV [default: standard output, with --report or --plot nowhere]
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) output_file: Option<PathBuf>,
    /// An output or input to write and plot, or a glob such as `joint.*.position`; may be repeated
    /// [default: all outputs]
    #[arg(long = "output-variable", value_name = "NAME")]
    pub(crate) output_variables: Vec<String>,
    /// Where a page goes that plays the results in 3-D and plots them
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    /// Where a picture of the results goes, as curves over time
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Tell neither progress nor a summary
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Sets a parameter or an input at the start, or all that a glob matches; may be repeated
    #[arg(long, num_args = 2, value_names = ["NAME", "VALUE"], action = clap::ArgAction::Append,
          allow_hyphen_values = true)]
    pub(crate) start_value: Vec<String>,
    /// s [default: the FMU's]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) start_time: Option<f64>,
    /// s [default: the FMU's]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) stop_time: Option<f64>,
    /// Communication step, s [default: the FMU's]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) output_interval: Option<f64>,
    /// Relative tolerance [default: the FMU's]
    #[arg(long, value_name = "TOL", value_parser = tolerance, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Tell the FMU the slopes of its inputs, too: they then change within the steps
    #[arg(long)]
    pub(crate) set_input_derivatives: bool,
    /// Print what the FMU has to say about its steps
    #[arg(long)]
    pub(crate) debug_logging: bool,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct Report {
    /// Results: separated values, names in the first line, one of them `time`
    #[arg(value_name = "RESULTS.csv")]
    pub(crate) results: PathBuf,
    /// The robot: an FMU made by urdf2fmu, or a URDF
    #[arg(long, value_name = "ROBOT.fmu|ROBOT.urdf")]
    pub(crate) model: PathBuf,
    /// The page to write [default: the results' name with .html, in this folder]
    #[arg(short, long, value_name = "FILE.html")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Debug, Args)]
pub(crate) struct View {
    /// A URDF, or an FMU made by urdf2fmu
    #[arg(value_name = "ROBOT.urdf|ROBOT.fmu")]
    pub(crate) file: PathBuf,
    /// Port on 127.0.0.1, 0 for any
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub(crate) port: u16,
    /// Open no browser, only print the address
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Simulated seconds for each second
    #[arg(long, value_name = "FACTOR", value_parser = speed, default_value = "1", allow_hyphen_values = true)]
    pub(crate) speed: f64,
    /// Inputs over time: CSV, `time` first, then inputs by name; straight lines between the rows
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) input_file: Option<PathBuf>,
    /// Where the results go, as CSV; a run after a reset gets a file of its own
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) record: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Deny {
    /// Findings that are legal but suspicious
    Warnings,
}
