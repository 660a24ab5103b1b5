//! What a person asks for, and the settings that follow from it.

use crate::library;
use crate::world::Packages;
use crate::xacro;
use std::path::PathBuf;
use urdf2fmu_core::diagnostic::Diagnostic;
use urdf2fmu_core::model::{ActuatorMode, Arrays, Interface};
use urdf2fmu_core::pattern::Pattern;
use urdf2fmu_core::settings::{
    BaseChoice, Compat, FmiVersion, InertiaSource, ModeChoice, ObjectSettings, Settings,
};

/// What a person asked for. What stands here wins over the settings file.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The robot.
    pub urdf: PathBuf,
    /// The settings file.
    pub config: Option<PathBuf>,
    /// `--config-folder`: what names of files in the settings count from, if not their own folder.
    pub config_folder: Option<PathBuf>,
    /// `--fixed-base`, `--floating-base`.
    pub base: Option<BaseChoice>,
    /// `--mode`: for every joint that the settings file does not mention.
    pub mode: Option<ActuatorMode>,
    /// `--compat`.
    pub compat: Option<Compat>,
    /// `--density`.
    pub density: Option<f64>,
    /// `--missing-mass`.
    pub missing_mass: Option<f64>,
    /// `--inertia`.
    pub inertia: Option<InertiaSource>,
    /// `--sensors`: whether the URDF's are read.
    pub sensors: Option<bool>,
    /// Whether every link that can move gets inputs for forces from outside, and contact outputs
    /// say where forces act.
    pub pushable: bool,
    /// `--scale`.
    pub scale: Option<f64>,
    /// `--naming`.
    pub flat_names: Option<bool>,
    /// `--fmi`.
    pub fmi: Option<FmiVersion>,
    /// `--interface`.
    pub interface: Option<Interface>,
    /// `--arrays`.
    pub arrays: Option<Arrays>,
    /// `--srdf`.
    pub srdf: Option<PathBuf>,
    /// `--initial-state`: one of the SRDF's.
    pub initial_state: Option<String>,
    /// `--package-path` and `--package`.
    pub packages: Packages,
    /// `name:=value`, for xacro.
    pub xacro_arguments: Vec<String>,
    /// `--object`: beside those of the settings file.
    pub objects: Vec<ObjectSettings>,
}

impl Request {
    /// Arguments of xacro for the robot; none where they can only be meant for its SRDF.
    pub(super) fn arguments_of_robot(&self) -> &[String] {
        let of_srdf = || self.srdf.as_ref().is_some_and(|path| xacro::is_xacro(path));
        if !xacro::is_xacro(&self.urdf) && of_srdf() {
            return &[];
        }
        &self.xacro_arguments
    }
}

/// The settings file, as far as it can be read, with what the request says over it, and what is
/// wrong with the file.
pub(super) fn settings_of(request: &Request) -> (Settings, Vec<Diagnostic>) {
    let (read, mut findings) = match &request.config {
        Some(path) => Settings::read_rest(path, request.config_folder.as_deref(), request.compat),
        None => (None, Vec::new()),
    };
    let mut settings = read.unwrap_or_else(|| Settings::of(request.compat.unwrap_or_default()));
    if let Some(base) = request.base {
        settings.base = base;
    }
    if let Some(inertia) = request.inertia {
        settings.inertia = inertia;
    }
    if let Some(sensors) = request.sensors {
        settings.described_sensors = sensors;
    }
    if request.density.is_some() {
        settings.density = request.density;
    }
    if request.missing_mass.is_some() {
        settings.missing_mass = request.missing_mass;
    }
    if let Some(scale) = request.scale {
        settings.scale = scale;
    }
    if request.pushable {
        let all = Pattern {
            text: "*".to_owned(),
            place: None,
        };
        settings.external_wrenches = vec![all];
        settings.contact_points = true;
    }
    if let Some(flat_names) = request.flat_names {
        settings.flat_names = flat_names;
    }
    settings.fmu.fmi = request.fmi.unwrap_or(settings.fmu.fmi);
    settings.fmu.interface = request.interface.unwrap_or(settings.fmu.interface);
    settings.fmu.arrays = request.arrays.unwrap_or(settings.fmu.arrays);
    if let Some(mode) = request.mode {
        settings.default_mode = Some(ModeChoice::Commanded(mode));
    }
    settings.objects.extend(request.objects.iter().cloned());
    findings.extend(library::unknown(&settings.fmu.platforms));
    (settings, findings)
}
