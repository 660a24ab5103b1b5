//! An entry of a zip from what is deflated already.
//!
//! The `zip` crate copies entries as they are from one zip to another. Such a zip, with one entry,
//! is written here: PKWARE's APPNOTE 6.3.3, sections 4.3.7 (local header), 4.3.12 (directory) and
//! 4.3.16 (end).

use std::io::Cursor;
use zip::result::{ZipError, ZipResult};
use zip::{ZipArchive, ZipWriter};

/// Needed to unpack: 2.0, folders and deflate.
const VERSION: u16 = 20;
/// Of Unix, in the upper byte of what has made the entry.
const UNIX: u16 = 3 << 8;
const DEFLATE: u16 = 8;
/// 1980-01-01, the earliest of the format.
const DATE: u16 = (1 << 5) | 1;
/// An ordinary file, in the upper half of its attributes.
const ORDINARY: u32 = 0o100_000;

/// Appends an entry.
///
/// - `bytes`: the file
/// - `deflated`: what it is in the zip
/// - `mode`: Unix permission bits
///
/// # Errors
/// [`ZipError`] if something exceeds 4 GB.
pub fn copy(
    zip: &mut ZipWriter<Cursor<Vec<u8>>>,
    name: &str,
    bytes: &[u8],
    deflated: &[u8],
    mode: u32,
) -> ZipResult<()> {
    let single = single(name, bytes, deflated, mode)
        .ok_or(ZipError::InvalidArchive("an entry has 4 GB or more".into()))?;
    let mut single = ZipArchive::new(Cursor::new(single))?;
    zip.raw_copy_file(single.by_index_raw(0)?)
}

/// A zip with one entry; none where a size needs more than 32 bits.
fn single(name: &str, bytes: &[u8], deflated: &[u8], mode: u32) -> Option<Vec<u8>> {
    let size = |length: usize| u32::try_from(length).ok().map(u32::to_le_bytes);
    let short = u16::to_le_bytes;
    // What both headers say: method, time, date, sum, sizes, lengths of the name and of nothing.
    let common = [
        &short(DEFLATE)[..],
        &short(0),
        &short(DATE),
        &crc32fast::hash(bytes).to_le_bytes(),
        &size(deflated.len())?,
        &size(bytes.len())?,
        &short(u16::try_from(name.len()).ok()?),
        &short(0),
    ]
    .concat();
    let (version, no_flags) = (short(VERSION), short(0));
    let mut zip = [b"PK\x03\x04", &version[..], &no_flags, &common].concat();
    zip.extend(name.as_bytes());
    zip.extend(deflated);
    let start = zip.len();
    let made_by = short(UNIX | VERSION);
    zip.extend([b"PK\x01\x02", &made_by[..], &version, &no_flags, &common].concat());
    // No comment, the first disk, no text, attributes, and the local header's place.
    zip.extend([0; 6]);
    zip.extend(((ORDINARY | mode) << 16).to_le_bytes());
    zip.extend([0; 4]);
    zip.extend(name.as_bytes());
    let directory = zip.len() - start;
    zip.extend([&b"PK\x05\x06"[..], &[0; 4], &short(1), &short(1)].concat());
    zip.extend([size(directory)?, size(start)?].concat());
    zip.extend(short(0));
    Some(zip)
}
