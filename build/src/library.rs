//! The FMU's libraries, which `build.rs` embeds into this program.

/// A shared library with the FMI functions.
#[derive(Clone, Copy)]
pub struct Library {
    /// Its folder under `binaries/`, such as `linux64`.
    pub platform: &'static str,
    /// Of its file, such as `so`; the name is the model identifier.
    pub extension: &'static str,
    /// The file.
    pub bytes: &'static [u8],
}

/// One per platform, sorted by platform.
pub fn embedded() -> &'static [Library] {
    const LIBRARIES: &[Library] = include!(concat!(env!("OUT_DIR"), "/libraries.rs"));
    LIBRARIES
}
