//! What is asked for by the options about a robot.

use super::values::{ArrayStyle, InterfaceChoice};
use super::{Conventions, Fmi, Inertia, Mode, NamingStyle, Sensors, Source};
use crate::stage::Request;
use crate::world::Packages;
use std::path::Path;
use urdf2fmu_core::model::{ActuatorMode, Arrays, Interface};
use urdf2fmu_core::settings::{BaseChoice, Compat, FmiVersion, InertiaSource};

impl Source {
    pub(crate) fn request(&self, urdf: &Path) -> Request {
        let base = match (self.fixed_base, self.floating_base) {
            (true, _) => Some(BaseChoice::Fixed),
            (_, true) => Some(BaseChoice::Floating),
            _ => None,
        };
        Request {
            urdf: urdf.to_owned(),
            config: self.config.clone(),
            config_folder: self.config_folder.clone(),
            base,
            mode: self.mode.map(|mode| match mode {
                Mode::Velocity => ActuatorMode::Velocity,
                Mode::Position => ActuatorMode::Position,
                Mode::Effort => ActuatorMode::Effort,
                Mode::Pd => ActuatorMode::Pd,
            }),
            inertia: self.inertia.map(|inertia| match inertia {
                Inertia::Urdf => InertiaSource::Urdf,
                Inertia::Nearest => InertiaSource::Nearest,
                Inertia::Collision => InertiaSource::Collision,
                Inertia::Pybullet => InertiaSource::PyBullet,
            }),
            compat: self.compat.map(|compat| match compat {
                Conventions::None => Compat::None,
                Conventions::Pybullet => Compat::PyBullet,
            }),
            sensors: self.sensors.map(|from| matches!(from, Sensors::Urdf)),
            pushable: false,
            density: self.density,
            missing_mass: self.missing_mass,
            scale: self.scale,
            flat_names: self
                .naming
                .map(|naming| matches!(naming, NamingStyle::Flat)),
            fmi: self.fmi.map(|fmi| match fmi {
                Fmi::V2 => FmiVersion::V2,
                Fmi::V3 => FmiVersion::V3,
            }),
            interface: self.interface.map(|interface| match interface {
                InterfaceChoice::Cs => Interface::Cs,
                InterfaceChoice::Me => Interface::Me,
                InterfaceChoice::Both => Interface::Both,
            }),
            arrays: self.arrays.map(|arrays| match arrays {
                ArrayStyle::Vectors => Arrays::Vectors,
                ArrayStyle::None => Arrays::None,
                ArrayStyle::All => Arrays::All,
            }),
            srdf: self.srdf.clone(),
            initial_state: self.initial_state.clone(),
            packages: Packages {
                paths: self.package_paths.clone(),
                named: self.packages.clone(),
            },
            xacro_arguments: self.xacro_arguments.clone(),
            objects: self.objects.clone(),
        }
    }
}
