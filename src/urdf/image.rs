//! Image files: which format, and how large. Pixels are not read here.
//!
//! Sources: ISO/IEC 15948 (PNG), section 11.2.2; ITU-T T.81 (JPEG), annex B.

use super::description::{ImageFormat, Texture};
use crate::reading;
use std::io::ErrorKind;
use std::path::Path;

/// Image files larger than this, in bytes, are not packed.
const LARGEST_FILE: u64 = 32 << 20;

/// Longest side of an image, in pixels: what graphics cards take.
const LONGEST_SIDE: u32 = 8192;

/// Why an image cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum ImageError {
    #[error("the file cannot be read: {0}")]
    Io(String),
    #[error("the file has more than {LARGEST_FILE} bytes")]
    TooLarge,
    #[error("it is neither a JPEG nor a PNG")]
    Format,
    #[error("it is {0} by {1} pixels, more than {LONGEST_SIDE} a side, or none")]
    Size(u32, u32),
}

/// Reads an image file as far as it takes to know its format and size.
pub(super) fn texture(path: &Path) -> Result<Texture, ImageError> {
    let bytes = reading::read(path, LARGEST_FILE).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => ImageError::TooLarge,
        _ => ImageError::Io(error.to_string()),
    })?;
    texture_of(path, bytes)
}

/// The image file that these bytes are; `path` is the file that they are from.
pub(super) fn texture_of(path: &Path, bytes: Vec<u8>) -> Result<Texture, ImageError> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(ImageError::TooLarge);
    }
    let png = || Some((ImageFormat::Png, png_size(&bytes)?));
    let jpeg = || Some((ImageFormat::Jpeg, jpeg_size(&bytes)?));
    let (format, [width, height]) = png().or_else(jpeg).ok_or(ImageError::Format)?;
    let range = 1..=LONGEST_SIDE;
    if !range.contains(&width) || !range.contains(&height) {
        return Err(ImageError::Size(width, height));
    }
    Ok(Texture {
        path: path.to_owned(),
        format,
        width,
        height,
        bytes,
    })
}

fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let header = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
    // Length, then the chunk's name.
    let size = header.get(4..)?.strip_prefix(b"IHDR")?;
    let number = |at: usize| Some(u32::from_be_bytes(*size.get(at..)?.first_chunk::<4>()?));
    Some([number(0)?, number(4)?])
}

/// Goes from segment to segment to the first that begins a frame.
fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let mut rest = bytes.strip_prefix(b"\xff\xd8")?;
    loop {
        let &[mark, kind, high, low] = rest.first_chunk::<4>()?;
        if mark != 0xff {
            return None;
        }
        // Any number of 0xff may stand before a marker.
        if kind == 0xff {
            rest = &rest[1..];
            continue;
        }
        let frame = matches!(kind, 0xc0..=0xcf) && !matches!(kind, 0xc4 | 0xc8 | 0xcc);
        if frame {
            let number = |at: usize| {
                let two = *rest.get(at..)?.first_chunk::<2>()?;
                Some(u32::from(u16::from_be_bytes(two)))
            };
            return Some([number(7)?, number(5)?]);
        }
        rest = rest.get(2 + usize::from(u16::from_be_bytes([high, low]))..)?;
    }
}
