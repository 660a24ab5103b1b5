//! Deflates what `build.rs` embeds.

use crate::universal;
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use std::error::Error;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;

/// What `platforms.sh` has made of the libraries of both Macs, in the folder of libraries.
const UNIVERSAL: &str = "universal.dylib.deflate";

/// A file, deflated: less than half of its size in the command, and in every page.
///
/// - `packed`: where that may lie, ready
pub fn deflated(file: &Path, packed: Option<&Path>) -> Result<Vec<u8>, Box<dyn Error>> {
    let bytes = fs::read(file)?;
    if let Some(packed) = packed
        && let Some(ready) = ready(&bytes, packed)?
    {
        return Ok(ready);
    }
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&bytes)?;
    Ok(encoder.finish()?)
}

/// The universal file of both Macs' libraries, deflated; empty where `platforms.sh` has made none.
pub fn universal(macs: &[&Path], folder: Option<&Path>) -> Result<Vec<u8>, Box<dyn Error>> {
    let ([one, other], Some(folder)) = (macs, folder) else {
        return Ok(Vec::new());
    };
    let file = universal::universal(&[&fs::read(one)?, &fs::read(other)?]);
    Ok(ready(&file, &folder.join(UNIVERSAL))?.unwrap_or_default())
}

/// What `platforms.sh` has made of a file, with more effort; none where it has not, or of another.
///
/// - `bytes`: the file's
fn ready(bytes: &[u8], packed: &Path) -> Result<Option<Vec<u8>>, Box<dyn Error>> {
    if !packed.is_file() {
        return Ok(None);
    }
    println!("cargo::rerun-if-changed={}", packed.display());
    let deflated = fs::read(packed)?;
    let mut unpacked = Vec::new();
    let read = DeflateDecoder::new(&*deflated).read_to_end(&mut unpacked);
    if read.is_ok() && unpacked == bytes {
        return Ok(Some(deflated));
    }
    let packed = packed.display();
    println!(
        "cargo::warning='{packed}' does not hold the file that it is for; make it again, see \
         docs/platforms.md"
    );
    Ok(None)
}
