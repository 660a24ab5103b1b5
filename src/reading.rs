//! Files that somebody names, and their bytes up to a size.
//!
//! Whoever opens a pipe by its name waits until someone writes to it, and what is read from it is
//! gone for whoever reads it again. A pipe that the shell has opened, `<(…)` or `| … /dev/stdin`,
//! begins at once and ends: texts are read from it.

use std::fs::{File, FileType, metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Largest file of text that people write, in bytes.
pub const LARGEST_TEXT: u64 = 64 << 20;

/// What something is that is no regular file; none of one.
pub fn special(file: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if file.is_fifo() {
            return Some("a pipe");
        }
        if file.is_socket() {
            return Some("a socket");
        }
    }
    match file {
        _ if file.is_file() => None,
        _ if file.is_dir() => Some("a folder"),
        _ => Some("a device"),
    }
}

/// What something is that gives its bytes once, at some time, or not at all; none of a file, and of
/// what is not there.
fn kind(path: &Path) -> Option<&'static str> {
    special(metadata(path).ok()?.file_type())
}

fn no_file(what: &str) -> Error {
    let help = match what {
        "a pipe" => ": write what comes out of it to a file, and name that",
        _ => "",
    };
    Error::other(format!("it is {what}, not a file{help}"))
}

/// Refuses what cannot be read from any place and as often as one likes.
///
/// # Errors
/// What it is instead of a regular file. One that is not there is told when it is opened.
pub fn lasting(path: &Path) -> Result<()> {
    kind(path).map_or(Ok(()), |what| Err(no_file(what)))
}

/// Opens what can be read from any place and as often as one likes.
///
/// # Errors
/// As of [`lasting`]; a file that cannot be opened.
pub fn open(path: &Path) -> Result<File> {
    lasting(path)?;
    File::open(path)
}

/// What cannot be read at once and to its end, not even once: a folder, a socket, and a pipe by its
/// name. Where the shell and the system name what a process has opened, it does not wait.
pub fn waiting(path: &Path) -> Option<&'static str> {
    let opened = ["/dev", "/proc"].iter().any(|own| path.starts_with(own));
    kind(path).filter(|what| match *what {
        "a pipe" => !opened,
        other => other != "a device",
    })
}

/// The bytes of a file, of a device and of what the shell has opened.
///
/// # Errors
/// A file that cannot be read, has more than `most` bytes, or is none.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    if let Some(what) = waiting(path) {
        return Err(no_file(what));
    }
    up_to(File::open(path)?, most)
}

/// The bytes of a file alone, which may be read again.
///
/// # Errors
/// As of [`open`]; a file that has more than `most` bytes.
pub fn read_lasting(path: &Path, most: u64) -> Result<Vec<u8>> {
    up_to(open(path)?, most)
}

fn up_to(file: File, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = format!("it has more than {most} bytes");
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_are_read_whole_up_to_a_size() {
        let path = std::env::temp_dir().join(format!("urdf2fmu-reading-{}", std::process::id()));
        fs::write(&path, "12345").expect("a file");
        assert_eq!(read(&path, 5).expect("all of it"), b"12345");
        let error = read(&path, 4).expect_err("too large").to_string();
        assert_eq!(error, "it has more than 4 bytes");
        assert!(lasting(&path).is_ok() && waiting(&path).is_none());
        fs::remove_file(&path).expect("removed");
        assert!(lasting(&path).is_ok(), "it is told when it is opened");
        assert!(read(&path, 5).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn devices_end_and_folders_are_none() {
        let folder = std::env::temp_dir();
        let error = read(&folder, 9).expect_err("a folder").to_string();
        assert_eq!(error, "it is a folder, not a file");
        let [null, zero] = ["/dev/null", "/dev/zero"].map(Path::new);
        assert_eq!(read(null, 9).expect("nothing"), b"");
        let error = read(zero, 9).expect_err("without an end").to_string();
        assert_eq!(error, "it has more than 9 bytes");
        let error = lasting(null).expect_err("a device").to_string();
        assert_eq!(error, "it is a device, not a file");
    }
}
