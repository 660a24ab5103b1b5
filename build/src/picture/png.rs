//! A picture as a PNG.

use super::look::Picture;
use crate::image::png;

/// The content of a PNG file; without alpha where nothing shines through.
pub fn encode(picture: &Picture) -> Vec<u8> {
    let opaque = picture.pixels.iter().all(|pixel| pixel[3] == 255);
    let channels = if opaque { 3 } else { 4 };
    let raw: Vec<u8> = picture
        .pixels
        .iter()
        .flat_map(|pixel| &pixel[..channels])
        .copied()
        .collect();
    png::encode(picture.width, picture.height, channels, &raw)
}
