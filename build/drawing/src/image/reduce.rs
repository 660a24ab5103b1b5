//! Images of fewer pixels.

use super::{Pixels, STEPS, linear, png, read, srgb_table};
use jpeg_encoder::{ColorType, Encoder};

/// Of a reduced JPEG, 0 … 100: at this one no difference is seen on a robot.
const QUALITY: u8 = 85;

/// The means of squares of `factor` pixels a side, in linear light; smaller ones at the right and
/// lower edge.
pub fn shrunk(pixels: &Pixels, factor: usize) -> (usize, usize, Vec<[f32; 3]>) {
    let light = light_of_bytes();
    let (columns, rows) = (
        pixels.width.div_ceil(factor),
        pixels.height.div_ceil(factor),
    );
    let mut colors = Vec::with_capacity(columns * rows);
    let line = 3 * pixels.width;
    for lines in pixels.bytes.chunks(factor * line) {
        let high = lines.len() / line;
        for start in (0..line).step_by(3 * factor) {
            let end = line.min(start + 3 * factor);
            let [mut red, mut green, mut blue] = [0.0_f32; 3];
            for line in lines.chunks_exact(line) {
                for pixel in line[start..end].as_chunks::<3>().0 {
                    let [r, g, b] = pixel.map(|byte| light[usize::from(byte)]);
                    (red, green, blue) = (red + r, green + g, blue + b);
                }
            }
            #[allow(clippy::cast_precision_loss, reason = "few pixels")]
            let number = ((end - start) / 3 * high) as f32;
            colors.push([red, green, blue].map(|sum| sum / number));
        }
    }
    (columns, rows, colors)
}

/// Linear light of each number in a file.
pub fn light_of_bytes() -> [f32; 256] {
    let mut light = [0.0; 256];
    for (light, x) in light.iter_mut().zip(0..=u8::MAX) {
        *light = linear(f64::from(x) / 255.0);
    }
    light
}

/// Width, height and file, of the same kind, of an image that is smaller by a whole factor; none
/// where the file cannot be read.
pub fn reduced(kind: &str, bytes: &[u8], factor: u16) -> Option<(u16, u16, Vec<u8>)> {
    let (width, height, colors) = shrunk(&read(kind, bytes)?, usize::from(factor));
    let to_srgb = srgb_table();
    let raw: Vec<u8> = colors
        .iter()
        .flatten()
        .map(|x| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "clamped"
            )]
            let step = (x.clamp(0.0, 1.0) * STEPS as f32 + 0.5) as usize;
            to_srgb[step]
        })
        .collect();
    let side = |side: usize| u16::try_from(side).ok();
    let sides = (side(width)?, side(height)?);
    let file = if kind == "image/png" {
        png::encode(width, height, 3, &raw)
    } else {
        let mut file = Vec::new();
        let encoder = Encoder::new(&mut file, QUALITY);
        encoder
            .encode(&raw, sides.0, sides.1, ColorType::Rgb)
            .ok()?;
        file
    };
    Some((sides.0, sides.1, file))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black and white in turn: half of the light, which is 188 in sRGB and not 128.
    #[test]
    fn light_is_averaged_and_not_its_numbers() {
        let raw: Vec<u8> = (0..64 * 32)
            .flat_map(|k| [if (k % 64 + k / 64) % 2 == 0 { 0 } else { 255 }; 3])
            .collect();
        let file = png::encode(64, 32, 3, &raw);
        let (width, height, small) = reduced("image/png", &file, 4).expect("a PNG");
        assert_eq!((width, height), (16, 8));
        let pixels = read("image/png", &small).expect("a PNG");
        assert_eq!((pixels.width, pixels.height), (16, 8));
        assert!(pixels.bytes.iter().all(|x| *x == 188), "{pixels:?}");
    }

    /// The edge between two colours lies between blocks, so that each block has one colour, which
    /// a JPEG keeps but for rounding.
    #[test]
    fn a_jpeg_stays_a_jpeg_with_its_colours_in_their_places() {
        let color = |x: usize| if x < 48 { [200, 40, 40] } else { [40, 60, 200] };
        let raw: Vec<u8> = (0..96 * 48).flat_map(|k| color(k % 96)).collect();
        let mut file = Vec::new();
        let encoder = Encoder::new(&mut file, 95);
        encoder
            .encode(&raw, 96, 48, ColorType::Rgb)
            .expect("a JPEG");
        let (width, height, small) = reduced("image/jpeg", &file, 3).expect("a JPEG");
        assert_eq!((width, height), (32, 16));
        let pixels = read("image/jpeg", &small).expect("a JPEG");
        assert_eq!((pixels.width, pixels.height), (32, 16));
        for (k, pixel) in pixels.bytes.as_chunks::<3>().0.iter().enumerate() {
            let x = k % 32;
            // Readers mix colours of neighbouring blocks, which have half of the pixels.
            if !(15..17).contains(&x) {
                for (found, expected) in pixel.iter().zip(color(x * 3)) {
                    assert!(found.abs_diff(expected) <= 4, "{pixel:?} at {x}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_read_is_not_reduced() {
        assert!(reduced("image/png", b"no image", 2).is_none());
        assert!(reduced("image/jpeg", b"\xff\xd8\xff\xe0 neither", 2).is_none());
    }
}
