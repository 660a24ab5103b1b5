//! Textures of as many pixels as a page can use.
//!
//! A robot fills a window of some 1000 pixels, so that more pixels in one texture are never
//! visible; and a browser unpacks all of them into the memory of the graphics card, where a pixel
//! takes 5.3 bytes with its smaller copies (mipmaps).

use super::format::Texture;
use super::mesh::align;
use crate::image;
use urdf2fmu_core::urdf::{self, ImageFormat};

/// Pixels along the longest side of a texture.
const LONGEST_SIDE: u32 = 1024;

/// Pixels of all textures of a robot: 45 MB of a graphics card.
const ALL_PIXELS: u64 = 8 << 20;

/// Pixels along a side below which textures are not reduced, however many there are.
const SHORTEST_SIDE: u32 = 64;

/// Pixels along the longest side of each texture of a robot: as many as let all of them fit.
pub(super) fn longest_side(textures: &[urdf::Texture]) -> u32 {
    let mut side = LONGEST_SIDE;
    let pixels = |side: u32| -> u64 {
        let of = |texture: &urdf::Texture| {
            let factor = factor(texture, side);
            u64::from(texture.width.div_ceil(factor)) * u64::from(texture.height.div_ceil(factor))
        };
        textures.iter().map(of).sum()
    };
    while side > SHORTEST_SIDE && pixels(side) > ALL_PIXELS {
        side /= 2;
    }
    side
}

/// By which a texture has to be smaller.
fn factor(texture: &urdf::Texture, side: u32) -> u32 {
    texture.width.max(texture.height).div_ceil(side).max(1)
}

fn kind(texture: &urdf::Texture) -> &'static str {
    match texture.format {
        ImageFormat::Png => "image/png",
        ImageFormat::Jpeg => "image/jpeg",
    }
}

/// Width, height and file of a texture that has to be smaller. One that cannot be read stays as it
/// is, because a browser may know better.
pub(super) type Reduced = Option<(u16, u16, Vec<u8>)>;

pub(super) fn reduced(texture: &urdf::Texture, side: u32) -> Reduced {
    match factor(texture, side) {
        1 => None,
        factor => image::reduced(kind(texture), &texture.bytes, u16::try_from(factor).ok()?),
    }
}

/// Appends a texture to a body: as it was found, or reduced.
pub(super) fn append(body: &mut Vec<u8>, texture: &urdf::Texture, reduced: &Reduced) -> Texture {
    let (width, height, bytes) = match reduced {
        Some((width, height, bytes)) => (u32::from(*width), u32::from(*height), bytes),
        None => (texture.width, texture.height, &texture.bytes),
    };
    align(body);
    let packed = Texture {
        at: body.len(),
        bytes: bytes.len(),
        kind: kind(texture).to_owned(),
        width,
        height,
    };
    body.extend(bytes);
    packed
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn texture(width: u32, height: u32) -> urdf::Texture {
        urdf::Texture {
            path: PathBuf::new(),
            format: ImageFormat::Png,
            bytes: b"no image".to_vec(),
            width,
            height,
        }
    }

    #[test]
    fn a_few_textures_have_at_most_1024_pixels_a_side() {
        let few = [texture(2048, 512), texture(300, 200), texture(1100, 1)];
        let side = longest_side(&few);
        assert_eq!(side, 1024);
        assert_eq!(few.map(|texture| factor(&texture, side)), [2, 1, 2]);
    }

    /// Eight of 1024 pixels a side are 8 Mi pixels, nine are more.
    #[test]
    fn many_textures_share_eight_mi_pixels() {
        let of = |number: usize| longest_side(&vec![texture(2048, 2048); number]);
        assert_eq!([8, 9, 32, 33, 1_000_000].map(of), [1024, 512, 512, 256, 64]);
    }

    #[test]
    fn what_cannot_be_read_stays_as_it_is() {
        let mut body = vec![1];
        let texture = texture(4096, 4096);
        let packed = append(&mut body, &texture, &reduced(&texture, 1024));
        assert_eq!((packed.at, packed.bytes, packed.width), (4, 8, 4096));
        assert_eq!(body[4..], *b"no image");
    }
}
