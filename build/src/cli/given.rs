//! Which options about a robot were given: an FMU has been made already, and takes none of them.

use super::Source;
use std::path::Path;

impl Source {
    /// Names of the options that were given, as the user writes them.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        // Each field is named, so that a new option cannot be forgotten.
        let Self {
            config,
            config_folder,
            fixed_base,
            floating_base,
            mode,
            compat,
            inertia,
            sensors,
            density,
            missing_mass,
            scale,
            naming,
            fmi,
            interface,
            arrays,
            srdf,
            initial_state,
            package_paths,
            packages,
            objects,
            xacro_arguments,
        } = self;
        let all = [
            ("--config", config.is_some()),
            ("--config-folder", config_folder.is_some()),
            ("--fixed-base", *fixed_base),
            ("--floating-base", *floating_base),
            ("--mode", mode.is_some()),
            ("--compat", compat.is_some()),
            ("--inertia", inertia.is_some()),
            ("--sensors", sensors.is_some()),
            ("--density", density.is_some()),
            ("--missing-mass", missing_mass.is_some()),
            ("--scale", scale.is_some()),
            ("--naming", naming.is_some()),
            ("--fmi", fmi.is_some()),
            ("--interface", interface.is_some()),
            ("--arrays", arrays.is_some()),
            ("--srdf", srdf.is_some()),
            ("--initial-state", initial_state.is_some()),
            ("--package-path", !package_paths.is_empty()),
            ("--package", !packages.is_empty()),
            ("--object", !objects.is_empty()),
            ("name:=value", !xacro_arguments.is_empty()),
        ];
        let given = all.iter().filter(|(_, given)| *given);
        given.map(|(name, _)| *name).collect()
    }

    /// The words of the command line that exports `urdf`, but for options that have a key of the
    /// settings.
    pub(crate) fn without_keys(&self, urdf: &Path) -> Vec<String> {
        let urdf = urdf.file_name().unwrap_or(urdf.as_os_str());
        let mut words = vec![urdf.to_string_lossy().into_owned()];
        words.extend(self.xacro_arguments.iter().cloned());
        let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
        for folder in &self.package_paths {
            option("--package-path", folder.display().to_string());
        }
        for (name, folder) in &self.packages {
            option("--package", format!("{name}={}", folder.display()));
        }
        if let Some(file) = &self.srdf {
            option("--srdf", file.display().to_string());
        }
        if let Some(name) = &self.initial_state {
            option("--initial-state", name.clone());
        }
        words
    }
}
