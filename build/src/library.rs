//! The FMU's libraries, which `build.rs` embeds into this program, deflated.

pub mod header;
pub mod target;
mod universal;

use flate2::read::DeflateDecoder;
use std::io::{self, Read};
use strsim::jaro_winkler;
use target::TARGETS;
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::pattern::Pattern;

/// A shared library with the FMI functions.
#[derive(Clone, Copy)]
pub struct Library {
    /// FMI 3.0's name of the system, such as `x86_64-linux`.
    pub platform: &'static str,
    /// Of its file, such as `so`; the name is the model identifier.
    pub extension: &'static str,
    /// The file, deflated.
    pub deflated: &'static [u8],
}

impl Library {
    /// The file.
    ///
    /// # Errors
    /// [`io::Error`] if this program is damaged.
    pub fn file(&self) -> io::Result<Vec<u8>> {
        unpacked(self.deflated)
    }
}

fn unpacked(deflated: &[u8]) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    DeflateDecoder::new(deflated).read_to_end(&mut file)?;
    Ok(file)
}

/// A universal file as this program carries it, deflated with more effort than an export takes.
///
/// - `file`: as it is to be
fn ready(file: &[u8]) -> Option<&'static [u8]> {
    // Empty if `platforms.sh` has not made it.
    const UNIVERSAL: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/universal.deflate"));
    unpacked(UNIVERSAL)
        .is_ok_and(|unpacked| unpacked == file)
        .then_some(UNIVERSAL)
}

/// A library as an FMU has it.
#[derive(Debug)]
pub struct Binary {
    /// Its folder under `binaries/`, such as `linux64` or `x86_64-linux`.
    pub folder: &'static str,
    /// Of its file.
    pub extension: &'static str,
    /// The systems that it is for, by FMI 3.0's names.
    pub platforms: Vec<&'static str>,
    /// The file.
    pub file: Vec<u8>,
    /// The same, deflated, if it is as this program carries it.
    pub deflated: Option<&'static [u8]>,
}

/// Why an FMU cannot have the libraries that were asked for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// The name of no system.
    #[error("'{asked}' is no platform{}; names are {}", meant(asked), names().join(", "))]
    Unknown {
        /// As asked for.
        asked: String,
    },
    /// Not in this program.
    #[error(
        "this urdf2fmu carries no library for the platform '{asked}', only for {}; one that carries several is built \
         as docs/platforms.md says",
        carried.join(", ")
    )]
    Missing {
        /// As asked for.
        asked: String,
        /// What there is.
        carried: Vec<&'static str>,
    },
    /// Two for one folder of FMI 2.0.
    #[error(
        "{first} and {second} share the folder binaries/{folder} of FMI 2.0, which names no processors: \
         export one FMU for each"
    )]
    Shared {
        /// The folder.
        folder: &'static str,
        /// FMI 3.0's name of one.
        first: &'static str,
        /// And of another.
        second: &'static str,
    },
    /// This program was built without a library for any platform.
    #[error("this urdf2fmu carries no FMU library; build it again without URDF2FMU_LIBRARY=none")]
    None,
    /// A library of this program.
    #[error("this program is damaged: its library cannot be unpacked ({0})")]
    Damaged(io::Error),
}

impl LibraryError {
    /// Whether other names would do.
    pub fn is_usage(&self) -> bool {
        !matches!(self, Self::None | Self::Damaged(_))
    }
}

/// Names that may be asked for: FMI 3.0's, then FMI 2.0's.
fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = TARGETS.iter().map(|target| target.platform).collect();
    for target in &TARGETS {
        if !names.contains(&target.fmi2) {
            names.push(target.fmi2);
        }
    }
    names
}

fn meant(asked: &str) -> String {
    const OTHERS: [(&str, &str); 8] = [
        ("windows", "win64"),
        ("win", "win64"),
        ("linux", "linux64"),
        ("mac", "darwin64"),
        ("macos", "darwin64"),
        ("darwin", "darwin64"),
        ("arm64", "aarch64-linux"),
        ("aarch64", "aarch64-linux"),
    ];
    if asked.eq_ignore_ascii_case("all") {
        return " (without platforms an FMU has all that this command carries)".to_owned();
    }
    let called = OTHERS
        .iter()
        .find(|(other, _)| asked.eq_ignore_ascii_case(other));
    if let Some((_, name)) = called {
        return format!(" (did you mean '{name}'?)");
    }
    let alike = names().into_iter().map(|n| (jaro_winkler(asked, n), n));
    let best = alike.max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(likeness, _)| *likeness > 0.85)
        .map_or_else(String::new, |(_, name)| {
            format!(" (did you mean '{name}'?)")
        })
}

/// One per platform, in the order of [`TARGETS`].
pub fn embedded() -> &'static [Library] {
    const LIBRARIES: &[Library] = include!(concat!(env!("OUT_DIR"), "/libraries.rs"));
    LIBRARIES
}

/// The libraries of an FMU, sorted by their folders.
///
/// - `asked`: names of platforms, FMI 3.0's or 2.0's; without any, all that the FMU can have
/// - `fmi`: its major version
///
/// FMI 2.0's names mean every processor that the folder may be for, and 64-bit ARM Linux shares
/// that of `x86_64`. It is in an FMI 2.0 FMU where `x86_64` is not: on a command that carries it
/// alone, or asked for by its name. Both Macs become one file.
///
/// # Errors
/// [`LibraryError`].
pub fn pack(
    all: &[Library],
    asked: &[impl AsRef<str>],
    fmi: u8,
) -> Result<Vec<Binary>, LibraryError> {
    let mut binaries: Vec<Binary> = Vec::new();
    for (library, by_name) in select(all, asked)? {
        let folder = target::folder(library.platform, fmi);
        let file = library.file().map_err(LibraryError::Damaged)?;
        let Some(other) = binaries.iter_mut().find(|other| other.folder == folder) else {
            binaries.push(Binary {
                folder,
                extension: library.extension,
                platforms: vec![library.platform],
                file,
                deflated: Some(library.deflated),
            });
            continue;
        };
        if library.extension == "dylib" {
            other.file = universal::universal(&[&other.file, &file]);
            other.deflated = ready(&other.file);
            other.platforms.push(library.platform);
        } else if by_name {
            let (first, second) = (other.platforms[0], library.platform);
            return Err(LibraryError::Shared {
                folder,
                first,
                second,
            });
        }
    }
    binaries.sort_by_key(|binary| binary.folder);
    Ok(binaries)
}

/// Those asked for, and whether by the name of this very system.
fn select(
    all: &[Library],
    asked: &[impl AsRef<str>],
) -> Result<Vec<(Library, bool)>, LibraryError> {
    if all.is_empty() {
        return Err(LibraryError::None);
    }
    for asked in asked.iter().map(AsRef::as_ref) {
        if !target::named(asked).any(|t| all.iter().any(|library| library.platform == t.platform)) {
            let asked = asked.to_owned();
            return Err(if names().contains(&&*asked) {
                let carried = all.iter().map(|library| library.platform).collect();
                LibraryError::Missing { asked, carried }
            } else {
                LibraryError::Unknown { asked }
            });
        }
    }
    let by_name = |library: &Library| asked.iter().any(|a| a.as_ref() == library.platform);
    let wanted = |library: &&Library| {
        let platform = library.platform;
        let mut names = asked.iter().map(AsRef::as_ref);
        asked.is_empty() || names.any(|a| target::named(a).any(|t| t.platform == platform))
    };
    let chosen = all.iter().filter(wanted);
    Ok(chosen
        .map(|&library| (library, by_name(&library)))
        .collect())
}

/// A name of a settings file that an FMU cannot have.
pub fn finding(name: &Pattern, error: &LibraryError) -> Diagnostic {
    Diagnostic {
        severity: Severity::Error,
        code: "S109",
        message: error.to_string(),
        help: None,
        place: name.place.clone(),
    }
}

/// Refuses what is the name of no platform, whatever this program carries.
///
/// # Errors
/// [`LibraryError::Unknown`].
pub fn known(names: &[String]) -> Result<(), LibraryError> {
    let mut names = names.iter();
    match names.find(|name| target::named(name).next().is_none()) {
        Some(asked) => Err(LibraryError::Unknown {
            asked: asked.clone(),
        }),
        None => Ok(()),
    }
}

/// What is wrong with the names of a settings file, whatever this program carries.
pub fn unknown(names: &[Pattern]) -> Vec<Diagnostic> {
    let wrong = names
        .iter()
        .filter(|name| target::named(&name.text).next().is_none());
    wrong
        .map(|name| {
            let asked = name.text.clone();
            finding(name, &LibraryError::Unknown { asked })
        })
        .collect()
}

/// A folder under `binaries/` with the processors that its file is for, where the name does not
/// tell: FMI 2.0's mean x86.
///
/// - `platforms`: FMI 3.0's names
pub fn describe(folder: &str, platforms: &[&str]) -> String {
    let told = target::named(folder).next().map(|target| target.platform);
    if platforms.is_empty() || platforms == told.as_slice() {
        return folder.to_owned();
    }
    let processors = platforms.iter().map(|p| p.split('-').next().unwrap_or(p));
    format!(
        "{folder} ({})",
        processors.collect::<Vec<_>>().join(" and ")
    )
}
