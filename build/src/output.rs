//! All output: files, standard output and standard error.
//!
//! Every write is checked, and a failure is an error of the command. A file is complete or not
//! there at all: its bytes are written beside it and renamed, so that a failure leaves what was
//! there before. A closed pipe at standard output or standard error (`| head`) is no error, because
//! the reader needs no more.

#[cfg(unix)]
use crate::process;
use std::ffi::OsString;
use std::fs::{FileType, Metadata, Permissions};
use std::io::{self, ErrorKind, IsTerminal as _, Write};
use std::path::{Path, PathBuf};
use urdf2fmu_core::folder;

/// Why something could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output is one of the files that the result is made from.
    #[error("'{}' is one of the files that are read; give another name", path.display())]
    Input {
        /// As asked for.
        path: PathBuf,
    },
    /// The name belongs to something that is no regular file.
    #[error(
        "'{}' is {what} and would be replaced by a regular file, so nothing is written; give the \
         name of a regular file", path.display()
    )]
    NoFile {
        /// As asked for.
        path: PathBuf,
        /// "a folder", "a device" …
        what: &'static str,
    },
    /// A file without permission to write.
    #[error("'{}' is write-protected; make it writable or give another name", path.display())]
    Protected {
        /// As asked for.
        path: PathBuf,
    },
    /// No folder to write in.
    #[error("cannot write '{}': there is no folder '{}'; make it first", path.display(),
            folder.display())]
    Folder {
        /// As asked for.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// The system refuses.
    #[error("cannot write '{}': {source}", path.display())]
    File {
        /// As asked for.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Standard output, where something else goes.
    #[error("{option} - is standard output, where {other} goes; give the name of a file")]
    Taken {
        /// Of the output.
        option: &'static str,
        /// What goes there.
        other: &'static str,
    },
    /// Standard output, which is a terminal.
    #[error(
        "'-' is standard output, here a terminal, on which this is no text; give the name of a \
         file, or lead standard output to one: > FILE"
    )]
    Terminal,
    /// Standard output or standard error.
    #[error("cannot write to standard {stream}: {source}; what was written is not complete")]
    Stream {
        /// "output" or "error".
        stream: &'static str,
        /// Why.
        source: io::Error,
    },
}

/// A place where a file may be written. It is found before the work begins, so that a wrong name
/// is told at once.
#[derive(Debug)]
pub struct Target {
    /// As asked for.
    asked: PathBuf,
    /// Where symbolic links lead; none is standard output.
    place: Option<PathBuf>,
    /// Of the file that is there already.
    permissions: Option<Permissions>,
}

impl Target {
    /// The place that `path` names; `-` is standard output. Symbolic links stay, and what they lead
    /// to is written.
    ///
    /// - `inputs`: files that must not be overwritten
    ///
    /// # Errors
    /// [`OutputError`] for whatever is no place for a regular file.
    pub fn new<'p>(
        path: &Path,
        inputs: impl IntoIterator<Item = &'p Path>,
    ) -> Result<Self, OutputError> {
        let asked = path.to_owned();
        if is_stdout(path) {
            return Ok(Self {
                asked,
                place: None,
                permissions: None,
            });
        }
        let failed = |source| OutputError::File {
            path: path.to_owned(),
            source,
        };
        let there = match std::fs::metadata(path) {
            Ok(there) => Some(there),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(failed(error)),
        };
        let Some(there) = there else {
            if path
                .as_os_str()
                .to_string_lossy()
                .ends_with(std::path::is_separator)
            {
                let folder = path.to_owned();
                return Err(OutputError::Folder {
                    path: asked,
                    folder,
                });
            }
            let place = end_of_links(path);
            let folder = folder::of(&place);
            if !folder.is_dir() {
                let folder = folder.to_owned();
                return Err(OutputError::Folder {
                    path: asked,
                    folder,
                });
            }
            return Ok(Self {
                asked,
                place: Some(place),
                permissions: None,
            });
        };
        if !there.is_file() {
            return Err(OutputError::NoFile {
                path: asked,
                what: kind(&there),
            });
        }
        if there.permissions().readonly() {
            return Err(OutputError::Protected { path: asked });
        }
        let place = path.canonicalize().map_err(failed)?;
        let same = |input: &Path| input.canonicalize().is_ok_and(|input| input == place);
        if inputs.into_iter().any(same) {
            return Err(OutputError::Input { path: asked });
        }
        Ok(Self {
            asked,
            place: Some(place),
            permissions: Some(there.permissions()),
        })
    }

    /// Writes the whole file.
    ///
    /// # Errors
    /// [`OutputError::File`]; what was there before is then still there. Of standard output
    /// [`OutputError::Stream`], and [`OutputError::Terminal`] where that is one and these are no
    /// text.
    pub fn write(&self, bytes: &[u8]) -> Result<(), OutputError> {
        let Some(place) = &self.place else {
            if io::stdout().is_terminal() && std::str::from_utf8(bytes).is_err() {
                return Err(OutputError::Terminal);
            }
            return quiet("output", write_to(1, &io::stdout(), bytes));
        };
        self.try_write(place, bytes)
            .map_err(|error| OutputError::File {
                path: self.asked.clone(),
                source: plain(error),
            })
    }

    /// What it is called.
    pub fn named(&self) -> &Path {
        match self.place {
            Some(_) => &self.asked,
            None => Path::new("standard output"),
        }
    }

    /// Says what has been written: where it does not get into the result itself.
    ///
    /// # Errors
    /// As [`print()`].
    pub fn describe(&self, text: &str) -> Result<(), OutputError> {
        if self.place.is_some() {
            print(text)
        } else {
            tell(text)
        }
    }

    fn try_write(&self, place: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".urdf2fmu-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As for any new file; a temporary file is private by default.
            builder.permissions(Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder::of(place))?;
        file.write_all(bytes)?;
        if let Some(permissions) = &self.permissions {
            file.as_file().set_permissions(permissions.clone())?;
        }
        file.as_file().sync_all()?;
        file.persist(place).map_err(|error| error.error)?;
        Ok(())
    }
}

/// Whether a name of an output means standard output, as for other commands.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Only the system's message: the library adds the name of the temporary file, which the user does
/// not know.
fn plain(error: io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(_) => error,
        None => error.kind().into(),
    }
}

/// Where the symbolic links at `path` end; there is nothing yet, so that they end somewhere.
fn end_of_links(path: &Path) -> PathBuf {
    let mut place = path.to_owned();
    while let Ok(next) = std::fs::read_link(&place) {
        // An absolute one replaces the folder.
        place = folder::of(&place).join(next);
    }
    place
}

/// What is there that is no regular file.
fn kind(there: &Metadata) -> &'static str {
    if there.is_dir() {
        return "a folder";
    }
    special(there.file_type()).unwrap_or("no regular file")
}

#[cfg(unix)]
fn special(file: FileType) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    [
        (file.is_fifo(), "a pipe"),
        (file.is_socket(), "a socket"),
        (file.is_char_device(), "a device"),
        (file.is_block_device(), "a block device"),
    ]
    .into_iter()
    .find_map(|(is, what)| is.then_some(what))
}

#[cfg(not(unix))]
fn special(_: FileType) -> Option<&'static str> {
    None
}

/// Prints a result to standard output.
///
/// # Errors
/// [`OutputError::Stream`] for anything but a closed pipe.
pub fn print(text: &str) -> Result<(), OutputError> {
    quiet("output", write_to(1, &io::stdout(), text.as_bytes()))
}

/// Prints findings and problems to standard error.
///
/// # Errors
/// As [`print()`].
pub fn tell(text: &str) -> Result<(), OutputError> {
    quiet("error", write_to(2, &io::stderr(), text.as_bytes()))
}

fn quiet(stream: &'static str, written: io::Result<()>) -> Result<(), OutputError> {
    match written {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(OutputError::Stream { stream, source })
        }
        _ => Ok(()),
    }
}

/// Writes without a buffer to a copy of the stream: the standard library's own stream keeps a
/// buffer, and takes a stream that cannot be written for one that swallows everything.
#[cfg(unix)]
fn write_to(number: u8, stream: &impl std::os::fd::AsFd, bytes: &[u8]) -> io::Result<()> {
    if bytes.is_empty() {
        return Ok(());
    }
    process::check_open(number)?;
    let copy = stream.as_fd().try_clone_to_owned()?;
    std::fs::File::from(copy).write_all(bytes)
}

#[cfg(windows)]
fn write_to<S>(_: u8, stream: &S, bytes: &[u8]) -> io::Result<()>
where
    for<'s> &'s S: Write,
{
    let mut stream = stream;
    stream.write_all(bytes)?;
    stream.flush()
}

/// Endings that say what is in a file. Whatever else follows the last point of a name belongs to
/// it.
pub const ENDINGS: &[&str] = &[
    "arrow", "bz2", "csv", "feather", "fmu", "gif", "gz", "h5", "hdf5", "htm", "html", "jpeg",
    "jpg", "json", "mat", "npy", "npz", "ods", "parquet", "pdf", "pickle", "pkl", "png", "svg",
    "toml", "tsv", "urdf", "xacro", "xls", "xlsx", "xml", "xz", "yaml", "yml", "zip", "zst",
];

/// A file's name without the endings that say what is in it: `rover_v1.5` of `rover_v1.5.urdf` and
/// of `rover_v1.5.urdf.xacro`.
pub fn stem(path: &Path) -> OsString {
    let mut stem = Path::new(path.file_name().unwrap_or_default());
    let mut endings = ENDINGS;
    loop {
        let ending = stem.extension().map(|e| e.to_string_lossy().to_lowercase());
        match (ending, stem.file_stem()) {
            (Some(ending), Some(rest)) if endings.contains(&ending.as_str()) => {
                stem = Path::new(rest);
            }
            _ => return stem.as_os_str().to_owned(),
        }
        // What a URDF is written in may follow its own ending.
        endings = &["urdf", "xacro"];
    }
}

/// A file of the working folder that is named after another one; `or`: where that has no name.
pub fn beside(path: &Path, or: &str, ending: &str) -> PathBuf {
    let mut name = stem(path);
    if name.is_empty() {
        name = or.into();
    }
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn write(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
        Target::new(path, [])?.write(bytes)
    }

    #[test]
    fn a_file_is_replaced_and_no_other_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.fmu");
        write(&file, b"old").unwrap();
        write(&file, b"new").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = write(folder.path(), b"new").unwrap_err();
        assert!(
            matches!(error, OutputError::NoFile { what, .. } if what == "a folder"),
            "{error}"
        );
    }

    #[test]
    fn an_input_file_is_not_overwritten_under_any_spelling_of_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.urdf");
        std::fs::write(&file, "robot").unwrap();
        let other = folder.path().join(".").join("a.urdf");
        let error = Target::new(&other, [file.as_path()]).unwrap_err();
        assert!(matches!(error, OutputError::Input { .. }), "{error}");
    }

    #[test]
    fn only_endings_that_say_what_is_in_a_file_are_taken_off_its_name() {
        for (file, expected) in [
            ("rover.urdf", "rover.fmu"),
            ("robots/rover_v1.0.urdf", "rover_v1.0.fmu"),
            ("rover_v1.5.urdf", "rover_v1.5.fmu"),
            ("rover_v1.5", "rover_v1.5.fmu"),
            ("ur5e.v3.urdf.xacro", "ur5e.v3.fmu"),
            ("ur5e.v3.URDF.Xacro", "ur5e.v3.fmu"),
            ("arm.xacro", "arm.fmu"),
            ("arm.urdf.xml", "arm.fmu"),
            ("arm.csv.urdf", "arm.csv.fmu"),
            ("run.2.csv", "run.2.fmu"),
            (".urdf", ".urdf.fmu"),
            ("..", "robot.fmu"),
        ] {
            let found = beside(Path::new(file), "robot", "fmu");
            assert_eq!(found, Path::new(expected), "{file}");
        }
    }
}
