//! Deflates what `build.rs` embeds.

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use std::error::Error;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;

/// A file, deflated: less than half of its size in the command, and in every page.
///
/// - `packed`: where that may lie, ready
pub fn deflated(file: &Path, packed: Option<&Path>) -> Result<Vec<u8>, Box<dyn Error>> {
    if let Some(packed) = packed
        && let Some(ready) = ready(file, packed)?
    {
        return Ok(ready);
    }
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&fs::read(file)?)?;
    Ok(encoder.finish()?)
}

/// What `platforms.sh` has made of a file, with more effort; none where it has not, or of another.
fn ready(file: &Path, packed: &Path) -> Result<Option<Vec<u8>>, Box<dyn Error>> {
    if !packed.is_file() {
        return Ok(None);
    }
    println!("cargo::rerun-if-changed={}", packed.display());
    let bytes = fs::read(packed)?;
    let mut unpacked = Vec::new();
    let read = DeflateDecoder::new(&*bytes).read_to_end(&mut unpacked);
    if read.is_ok() && unpacked == fs::read(file)? {
        return Ok(Some(bytes));
    }
    let (packed, file) = (packed.display(), file.display());
    println!(
        "cargo::warning='{packed}' does not hold '{file}'; make it again, see docs/platforms.md"
    );
    Ok(None)
}
