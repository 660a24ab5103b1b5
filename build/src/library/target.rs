//! The systems that a library can be for, and what FMI calls them. The build script uses this, too.

/// A system.
#[derive(Debug, PartialEq, Eq)]
pub struct Target {
    /// FMI 3.0's name: processor and system.
    pub platform: &'static str,
    /// FMI 2.0's, which names no processor: folders mean x86, 32 or 64 bits wide.
    pub fmi2: &'static str,
    /// Of its libraries' files.
    pub extension: &'static str,
}

const fn target(platform: &'static str, fmi2: &'static str, extension: &'static str) -> Target {
    Target {
        platform,
        fmi2,
        extension,
    }
}

/// All that there are. Of two for one folder of FMI 2.0 the first is what FMI means by its name.
pub const TARGETS: [Target; 9] = [
    target("x86_64-linux", "linux64", "so"),
    target("aarch64-linux", "linux64", "so"),
    target("riscv64-linux", "linux64", "so"),
    target("x86_64-windows", "win64", "dll"),
    target("aarch64-windows", "win64", "dll"),
    target("x86_64-darwin", "darwin64", "dylib"),
    target("aarch64-darwin", "darwin64", "dylib"),
    target("x86-linux", "linux32", "so"),
    target("x86-windows", "win32", "dll"),
];

/// The systems that a name means: one for FMI 3.0's, all that share the folder for FMI 2.0's.
pub fn named(name: &str) -> impl Iterator<Item = &'static Target> {
    let meant = move |target: &&Target| target.platform == name || target.fmi2 == name;
    TARGETS.iter().filter(meant)
}

/// The system of Rust's names, such as `macos` and `aarch64`.
pub fn of(system: &str, processor: &str) -> Option<&'static Target> {
    let system = if system == "macos" { "darwin" } else { system };
    let platform = format!("{processor}-{system}");
    TARGETS.iter().find(|target| target.platform == platform)
}

/// A platform's folder under `binaries/`.
///
/// - `platform`: FMI 3.0's name
/// - `fmi`: the major version
pub fn folder(platform: &'static str, fmi: u8) -> &'static str {
    let target = TARGETS.iter().find(|target| target.platform == platform);
    match target {
        Some(target) if fmi == 2 => target.fmi2,
        _ => platform,
    }
}
