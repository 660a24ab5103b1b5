//! A zip that is the same, byte for byte, for the same content.
//!
//! In: names and bytes. Out: the zip's bytes. Entries are sorted by name, their time is 1980-01-01,
//! the earliest of the format, and nothing about the machine is recorded. There are no zip64
//! records, links or folders, and entries are stored or deflated, because the unzip of some
//! importers reads nothing else.
//!
//! Only this module uses the `zip` crate.

mod packed;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use urdf2fmu_core::reading;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Largest size of one entry and of the whole zip that needs no zip64, in bytes.
const MAX_BYTES: usize = u32::MAX as usize - 1;
/// Largest number of entries that needs no zip64.
const MAX_ENTRIES: usize = u16::MAX as usize - 1;

/// Files to be zipped.
#[derive(Debug, Default)]
pub struct Archive {
    entries: BTreeMap<String, Entry>,
    /// Lower-case names: two entries must not fall together where the file system ignores case.
    folded: BTreeSet<String>,
}

#[derive(Debug)]
struct Entry {
    bytes: Vec<u8>,
    /// The same bytes, deflated, where somebody has done that already.
    deflated: Option<&'static [u8]>,
    /// Unix permission bits.
    mode: u32,
}

/// Why a zip cannot be made or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// A name that would leave the folder that the zip is unpacked in, or that some system cannot
    /// store.
    #[error("'{name}' is no safe name for a file in a zip")]
    Name {
        /// As given.
        name: String,
    },
    /// Two files with one name.
    #[error("two files would be called '{name}' in the zip")]
    Clash {
        /// As given.
        name: String,
    },
    /// Too large for a zip that every importer can read.
    #[error(
        "{what} exceeds what a zip without 64-bit extensions can hold; leave out large meshes that the robot does not need"
    )]
    TooLarge {
        /// An entry's name, or "the FMU".
        what: String,
    },
    /// The compressor failed.
    #[error("cannot pack '{name}': {source}")]
    Pack {
        /// Entry.
        name: String,
        /// Why.
        source: zip::result::ZipError,
    },
    /// The zip was refused.
    #[error("'{}' is not a readable FMU: {}; {AGAIN}", path.display(), unreadable(path, source))]
    Unpack {
        /// The file.
        path: PathBuf,
        /// Why.
        source: zip::result::ZipError,
    },
    /// A zip of something else.
    #[error("'{}' is no FMU: it has no modelDescription.xml at its top{hint}", path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// Where else there is one.
        hint: String,
    },
    /// Its files could not be read or written.
    #[error("cannot unpack '{}' into '{}': {source}{}", path.display(), folder.display(), remedy(source))]
    Extract {
        /// The zip.
        path: PathBuf,
        /// Where its files go.
        folder: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What a file in it unpacks to.
    #[error(
        "'{}' is refused: '{name}' unpacks to more than any FMU holds ({} MB for modelDescription.xml, \
         {} MB for another file, {} MB together)",
        path.display(), LARGEST_DESCRIPTION >> 20, LARGEST_ENTRY >> 20, LARGEST_FMU >> 20
    )]
    Bomb {
        /// The file.
        path: PathBuf,
        /// The entry that goes beyond it.
        name: String,
    },
    /// The file could not be read.
    #[error("cannot read '{}': {source}{}", path.display(), urdf2fmu_core::diagnostic::words::or_meant(path, source))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// What to do about an FMU that is not whole.
const AGAIN: &str = "copy or download it once more, or export it again";

/// What is wrong with a zip.
fn unreadable(path: &Path, source: &zip::result::ZipError) -> String {
    let empty = std::fs::metadata(path).is_ok_and(|file| file.len() == 0);
    match source {
        _ if empty => "it is empty".to_owned(),
        // What a zip ends with.
        zip::result::ZipError::InvalidArchive(why) if why.contains("EOCD") => {
            "it is cut short, or no zip archive".to_owned()
        }
        other => other.to_string(),
    }
}

/// What to do where a zip cannot be unpacked.
fn remedy(source: &std::io::Error) -> String {
    use std::io::ErrorKind::{FileTooLarge, InvalidData, Other, StorageFull, UnexpectedEof};
    match source.kind() {
        InvalidData | Other | UnexpectedEof => format!("; the FMU is damaged: {AGAIN}"),
        FileTooLarge | StorageFull => {
            let variable = if cfg!(windows) { "TMP" } else { "TMPDIR" };
            format!("; make room, or name a folder with more in the variable {variable}")
        }
        _ => String::new(),
    }
}

impl Archive {
    /// Adds a file, `name` with forward slashes.
    ///
    /// # Errors
    /// [`ArchiveError::Name`], [`ArchiveError::Clash`].
    pub fn add(
        &mut self,
        name: impl Into<String>,
        bytes: impl Into<Vec<u8>>,
    ) -> Result<(), ArchiveError> {
        let entry = Entry {
            bytes: bytes.into(),
            deflated: None,
            mode: 0o644,
        };
        self.insert(name.into(), entry)
    }

    /// Adds a file that may be executed; some importers keep the bits and some loaders want them.
    ///
    /// - `deflated`: the same bytes, as the zip is to have them; without, they are deflated here
    ///
    /// # Errors
    /// As [`Self::add`].
    pub fn add_executable(
        &mut self,
        name: impl Into<String>,
        bytes: impl Into<Vec<u8>>,
        deflated: Option<&'static [u8]>,
    ) -> Result<(), ArchiveError> {
        let entry = Entry {
            bytes: bytes.into(),
            deflated,
            mode: 0o755,
        };
        self.insert(name.into(), entry)
    }

    fn insert(&mut self, name: String, entry: Entry) -> Result<(), ArchiveError> {
        if !is_safe(&name) {
            return Err(ArchiveError::Name { name });
        }
        if !self.folded.insert(name.to_lowercase()) {
            return Err(ArchiveError::Clash { name });
        }
        self.entries.insert(name, entry);
        Ok(())
    }

    /// The zip's bytes.
    ///
    /// # Errors
    /// [`ArchiveError::TooLarge`], [`ArchiveError::Pack`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, ArchiveError> {
        if self.entries.len() > MAX_ENTRIES {
            return Err(ArchiveError::TooLarge {
                what: "the number of files".to_owned(),
            });
        }
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, entry) in &self.entries {
            if entry.bytes.len() > MAX_BYTES {
                return Err(ArchiveError::TooLarge { what: name.clone() });
            }
            let pack = |source| ArchiveError::Pack {
                name: name.clone(),
                source,
            };
            if let Some(deflated) = entry.deflated {
                packed::copy(&mut zip, name, &entry.bytes, deflated, entry.mode).map_err(pack)?;
                continue;
            }
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                // The best that deflate's own search finds: a library is 2.7 % smaller than at the
                // usual level.
                .compression_level(Some(9))
                .last_modified_time(DateTime::DEFAULT)
                // Else the writer's own operating system is recorded.
                .system(zip::System::Unix)
                .unix_permissions(entry.mode)
                .large_file(false);
            zip.start_file(name.as_str(), options).map_err(pack)?;
            zip.write_all(&entry.bytes).map_err(|e| pack(e.into()))?;
        }
        let bytes = zip
            .finish()
            .map_err(|source| ArchiveError::Pack {
                name: "the directory of the zip".to_owned(),
                source,
            })?
            .into_inner();
        if bytes.len() > MAX_BYTES {
            return Err(ArchiveError::TooLarge {
                what: "the FMU".to_owned(),
            });
        }
        Ok(bytes)
    }
}

/// What a modelDescription.xml may unpack to, bytes: a million variables need a third of it.
const LARGEST_DESCRIPTION: u64 = 512 << 20;

/// What any other file may unpack to, bytes.
const LARGEST_ENTRY: u64 = 1 << 30;

/// What all files together may unpack to, bytes.
const LARGEST_FMU: u64 = 4 << 30;

/// What a file must have at its top to be an FMU.
const DESCRIPTION: &str = "modelDescription.xml";

type Zip = zip::ZipArchive<std::fs::File>;

/// An FMU on disk.
///
/// # Errors
/// [`ArchiveError::Read`], [`ArchiveError::Unpack`]; [`ArchiveError::Other`] for another zip.
fn open(path: &Path) -> Result<Zip, ArchiveError> {
    // Parts of it are read from their places, some of them again and again.
    let file = reading::open(path).map_err(unread(path))?;
    let zip = zip::ZipArchive::new(file).map_err(not_unpacked(path))?;
    if zip.index_for_name(DESCRIPTION).is_some() {
        return Ok(zip);
    }
    let below = |name: &str| {
        let folder = name.strip_suffix(DESCRIPTION)?.strip_suffix('/')?;
        Some(folder.to_owned())
    };
    let mut names = zip.file_names().flatten();
    let hint = names.find_map(|name| below(&slashed(&name)));
    let hint = hint.map_or_else(String::new, |folder| {
        format!(", but in '{folder}': an FMU is a zip of what is in that folder")
    });
    let path = path.to_owned();
    Err(ArchiveError::Other { path, hint })
}

/// The error of a file that cannot be read.
fn unread(path: &Path) -> impl Fn(std::io::Error) -> ArchiveError + Copy {
    move |source| ArchiveError::Read {
        path: path.to_owned(),
        source,
    }
}

/// The error of a zip that cannot be unpacked.
fn not_unpacked(path: &Path) -> impl Fn(zip::result::ZipError) -> ArchiveError + Copy {
    move |source| ArchiveError::Unpack {
        path: path.to_owned(),
        source,
    }
}

/// The name of an entry with the separators that the format prescribes: some programs on Windows
/// write others.
fn slashed(name: &str) -> String {
    name.replace('\\', "/")
}

/// One entry of a zip on disk; none where it has no such entry.
///
/// # Errors
/// [`ArchiveError::Read`], [`ArchiveError::Unpack`], [`ArchiveError::Other`].
pub fn read_entry(path: &Path, name: &str) -> Result<Option<Vec<u8>>, ArchiveError> {
    let (io, unpack) = (unread(path), not_unpacked(path));
    let mut zip = open(path)?;
    // Of two entries of one name the later one is unpacked over the other.
    let is_it = |i: &usize| {
        let own = zip.name_for_index(*i).and_then(Result::ok);
        own.is_some_and(|own| slashed(&own) == name)
    };
    let Some(index) = (0..zip.len()).rev().find(is_it) else {
        return Ok(None);
    };
    let mut entry = zip.by_index(index).map_err(unpack)?;
    let mut bytes = Vec::new();
    let mut limited = (&mut entry).take(LARGEST_ENTRY + 1);
    limited.read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > LARGEST_ENTRY {
        let (path, name) = (path.to_owned(), name.to_owned());
        return Err(ArchiveError::Bomb { path, name });
    }
    Ok(Some(bytes))
}

/// The folders below `parent`, sorted, each with the first bytes of a file in it.
///
/// # Errors
/// [`ArchiveError::Read`], [`ArchiveError::Unpack`], [`ArchiveError::Other`].
pub fn heads(path: &Path, parent: &str) -> Result<Vec<(String, Vec<u8>)>, ArchiveError> {
    /// Enough for the headers of libraries.
    const FIRST: u64 = 4096;
    let (io, unpack) = (unread(path), not_unpacked(path));
    let mut zip = open(path)?;
    let mut found = BTreeMap::new();
    for i in 0..zip.len() {
        let entry = zip.by_index(i).map_err(unpack)?;
        let name = slashed(&entry.name().map_err(unpack)?);
        let place = name.strip_prefix(parent).and_then(|n| n.split_once('/'));
        let Some((folder, _)) = place.filter(|(_, file)| !file.is_empty()) else {
            continue;
        };
        let mut head = Vec::new();
        entry.take(FIRST).read_to_end(&mut head).map_err(io)?;
        found.insert(folder.to_owned(), head);
    }
    Ok(found.into_iter().collect())
}

/// Unpacks a zip into `folder`. Names that lead out of it are errors.
///
/// # Errors
/// [`ArchiveError::Read`], [`ArchiveError::Unpack`], [`ArchiveError::Other`],
/// [`ArchiveError::Extract`].
pub fn unpack(path: &Path, folder: &Path) -> Result<(), ArchiveError> {
    let mut zip = open(path)?;
    // The sizes that the directory tells may be wrong: every byte is counted.
    let mut left = LARGEST_FMU;
    let unpack = |source| ArchiveError::Unpack {
        path: path.to_owned(),
        source,
    };
    for i in 0..zip.len() {
        let mut entry = zip.by_index(i).map_err(unpack)?;
        let name = entry.name().unwrap_or_default().into_owned();
        let own = if name == DESCRIPTION {
            LARGEST_DESCRIPTION
        } else {
            LARGEST_ENTRY
        };
        let most = left.min(own);
        let mut limited = (&mut entry).take(most + 1);
        let size = std::io::copy(&mut limited, &mut std::io::sink());
        match size {
            Ok(size) if size > most => {
                let path = path.to_owned();
                return Err(ArchiveError::Bomb { path, name });
            }
            Ok(size) => left -= size,
            // The reader says below what is wrong with it.
            Err(_) => break,
        }
    }
    let unpacked = zip.extract(folder);
    unpacked.map_err(|source| match source {
        zip::result::ZipError::Io(source) => ArchiveError::Extract {
            path: path.to_owned(),
            folder: folder.to_owned(),
            source,
        },
        source => unpack(source),
    })
}

/// Whether `name` stays inside the folder that it is unpacked in, on every system.
fn is_safe(name: &str) -> bool {
    !name.is_empty()
        && name.len() <= 1000
        && name
            .split('/')
            .all(|part| !part.is_empty() && part == safe_component(part))
}

/// `part` as a file name that every system can store and none takes for something else: ASCII
/// letters, digits, `.`, `-`, `_`, `+` and inner spaces stay, all else becomes `_`.
pub fn safe_component(part: &str) -> String {
    let mut name: String = part
        .chars()
        .map(|c| match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' | '-' | '_' | '+' | ' ' => c,
            _ => '_',
        })
        .collect();
    // `.` and `..` walk; Windows drops dots and spaces at the end, and reads `con.stl` as a device.
    if name.starts_with(' ') || name.chars().all(|c| c == '.') {
        name.insert(0, '_');
    }
    if name.ends_with(['.', ' ']) {
        name.push('_');
    }
    let stem = name.split('.').next().unwrap_or_default().trim_end();
    if is_device(stem) {
        name.insert(0, '_');
    }
    name
}

/// Whether Windows takes a file of this name, with any extension, for a device.
pub fn is_device(stem: &str) -> bool {
    let stem = stem.to_ascii_lowercase();
    let numbered = |prefix: &str| {
        stem.strip_prefix(prefix)
            .is_some_and(|n| n.len() == 1 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    ["con", "prn", "aux", "nul"].contains(&stem.as_str()) || numbered("com") || numbered("lpt")
}

#[cfg(test)]
mod tests;
