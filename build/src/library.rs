//! The FMU's libraries, which `build.rs` embeds into this program, deflated.

use flate2::read::DeflateDecoder;
use std::io::{self, Read};
use urdf2fmu_core::settings::FmiVersion;

/// A shared library with the FMI functions.
#[derive(Clone, Copy)]
pub struct Library {
    /// Its folder under `binaries/`, such as `linux64`.
    pub platform: &'static str,
    /// Of its file, such as `so`; the name is the model identifier.
    pub extension: &'static str,
    /// The file, deflated.
    pub deflated: &'static [u8],
}

impl Library {
    /// Its folder under `binaries/`, by the names of a version of FMI.
    pub fn folder(&self, fmi: FmiVersion) -> &'static str {
        match (fmi, self.platform) {
            (FmiVersion::V3, "linux64") => "x86_64-linux",
            (FmiVersion::V3, "win64") => "x86_64-windows",
            (FmiVersion::V3, "darwin64") => "x86_64-darwin",
            (_, platform) => platform,
        }
    }

    /// The file.
    ///
    /// # Errors
    /// [`io::Error`] if this program is damaged.
    pub fn file(&self) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        DeflateDecoder::new(self.deflated).read_to_end(&mut file)?;
        Ok(file)
    }
}

/// One per platform, sorted by platform.
pub fn embedded() -> &'static [Library] {
    const LIBRARIES: &[Library] = include!(concat!(env!("OUT_DIR"), "/libraries.rs"));
    LIBRARIES
}
