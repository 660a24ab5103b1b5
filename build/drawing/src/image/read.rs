//! Reading of PNG and JPEG. Files of a kind that nobody uses for textures are not read.

use super::png::{SIGNATURE, expected};
use flate2::read::ZlibDecoder;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most pixels of a file.
const MOST_PIXELS: usize = 64 << 20;

/// What an image shows.
#[derive(Debug, PartialEq)]
pub struct Pixels {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue of each pixel, row by row from the top.
    pub bytes: Vec<u8>,
}

/// The pixels of an image file; none where it is damaged.
///
/// - `kind`: `image/png` or `image/jpeg`
pub fn read(kind: &str, bytes: &[u8]) -> Option<Pixels> {
    match kind {
        "image/png" => read_png(bytes),
        _ => read_jpeg(bytes),
    }
}

fn read_jpeg(bytes: &[u8]) -> Option<Pixels> {
    // Without the instructions of one processor or the other, so that all give the same.
    let options = DecoderOptions::default()
        .set_use_unsafe(false)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().ok()?;
    let (width, height) = decoder.dimensions()?;
    if width == 0 || height == 0 || width.checked_mul(height)? > MOST_PIXELS {
        return None;
    }
    // The decoder panics at some files whose planes do not fit together.
    let decoded = catch_unwind(AssertUnwindSafe(|| decoder.decode()));
    let bytes = decoded.ok()?.ok()?;
    (bytes.len() == 3 * width * height).then_some(Pixels {
        width,
        height,
        bytes,
    })
}

/// What the header of a PNG says of its pixels.
struct Header {
    width: usize,
    height: usize,
    /// Bits of a number.
    depth: usize,
    /// Numbers of a pixel.
    channels: usize,
    palette: bool,
}

/// Reads a PNG that is not interlaced. Alpha is left out.
fn read_png(bytes: &[u8]) -> Option<Pixels> {
    let mut rest = bytes.strip_prefix(SIGNATURE)?;
    let mut header = None;
    let (mut palette, mut packed) = (Vec::new(), Vec::new());
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let length = u32::from_be_bytes(*length) as usize;
        let (name, after) = after.split_first_chunk::<4>()?;
        let data = after.get(..length)?;
        match name {
            b"IHDR" => header = Some(png_header(data)?),
            b"PLTE" => palette = data.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            b"IDAT" => packed.extend(data),
            b"IEND" => break,
            _ => {}
        }
        rest = after.get(length + 4..)?;
    }
    let header = header?;
    let bits = header.depth * header.channels;
    let row = (header.width * bits).div_ceil(8);
    let mut raw = Vec::new();
    let most = (row + 1).checked_mul(header.height)?;
    // What is beyond the last row is of no use.
    let unpacked = ZlibDecoder::new(packed.as_slice()).take(most as u64);
    { unpacked }.read_to_end(&mut raw).ok()?;
    if raw.len() < most {
        return None;
    }
    let pixel = bits.div_ceil(8);
    let mut above = vec![0; row];
    let mut bytes = Vec::with_capacity(3 * header.width * header.height);
    for line in raw.chunks_exact(row + 1) {
        let (&kind, differences) = line.split_first()?;
        let mut line = differences.to_vec();
        for i in 0..row {
            line[i] = line[i].wrapping_add(expected(kind, &line, &above, i, pixel));
        }
        for x in 0..header.width {
            bytes.extend(header.color(&line, x, &palette));
        }
        above = line;
    }
    Some(Pixels {
        width: header.width,
        height: header.height,
        bytes,
    })
}

fn png_header(data: &[u8]) -> Option<Header> {
    let data = data.first_chunk::<13>()?;
    let side = |at: usize| {
        data[at..]
            .first_chunk::<4>()
            .map(|b| u32::from_be_bytes(*b) as usize)
    };
    let (width, height) = (side(0)?, side(4)?);
    let (depth, kind, interlaced) = (usize::from(data[8]), data[9], data[12] != 0);
    let channels = match kind {
        0 | 3 => 1,
        2 => 3,
        4 => 2,
        6 => 4,
        _ => return None,
    };
    let few = width > 0 && height > 0 && width.checked_mul(height)? <= MOST_PIXELS;
    let known = match depth {
        8 => true,
        16 => kind != 3,
        1 | 2 | 4 => channels == 1,
        _ => false,
    };
    (few && known && !interlaced).then_some(Header {
        width,
        height,
        depth,
        channels,
        palette: kind == 3,
    })
}

impl Header {
    fn color(&self, line: &[u8], x: usize, palette: &[[u8; 3]]) -> [u8; 3] {
        // Of 16 bits the upper ones count.
        let number = |channel: usize| -> u8 {
            let bit = (x * self.channels + channel) * self.depth;
            let byte = line[bit / 8];
            if self.depth >= 8 {
                return byte;
            }
            let mask = u8::MAX >> (8 - self.depth);
            (byte >> (8 - self.depth - bit % 8)) & mask
        };
        if self.palette {
            return palette
                .get(usize::from(number(0)))
                .copied()
                .unwrap_or_default();
        }
        if self.channels >= 3 {
            return [number(0), number(1), number(2)];
        }
        let full = u8::MAX >> (8 - self.depth.min(8));
        [number(0) * (u8::MAX / full); 3]
    }
}

#[cfg(test)]
mod tests {
    use super::super::png;
    use super::*;

    /// Red, green, blue and alpha of five by four pixels.
    fn picture() -> Vec<u8> {
        (0..20)
            .flat_map(|k| [k * 12, 255 - k, k % 7 * 30, 255])
            .collect()
    }

    #[test]
    fn a_png_that_was_written_is_read_again() {
        let raw = picture();
        let pixels = read_png(&png::encode(5, 4, 4, &raw)).expect("a PNG");
        assert_eq!((pixels.width, pixels.height), (5, 4));
        let colors: Vec<u8> = raw.chunks_exact(4).flat_map(|p| &p[..3]).copied().collect();
        assert_eq!(pixels.bytes, colors);
    }

    /// Few bits and palettes: the numbers of a row stand side by side in its bytes.
    #[test]
    fn numbers_of_few_bits_and_palettes_are_read() {
        let header = |depth, channels, palette| Header {
            width: 4,
            height: 1,
            depth,
            channels,
            palette,
        };
        let colors = |header: &Header, line: &[u8]| -> Vec<u8> {
            (0..4)
                .map(|x| header.color(line, x, &[[1; 3], [2; 3], [3; 3]])[0])
                .collect()
        };
        assert_eq!(
            colors(&header(1, 1, false), &[0b1010_0000]),
            [255, 0, 255, 0]
        );
        assert_eq!(
            colors(&header(2, 1, false), &[0b0001_1011]),
            [0, 85, 170, 255]
        );
        assert_eq!(
            colors(&header(4, 1, false), &[0x0f, 0x37]),
            [0, 255, 51, 119]
        );
        assert_eq!(colors(&header(2, 1, true), &[0b0001_1011]), [1, 2, 3, 0]);
        assert_eq!(
            colors(&header(16, 1, false), &[9, 0, 8, 0, 7, 0, 6, 0]),
            [9, 8, 7, 6]
        );
        assert_eq!(
            colors(&header(8, 2, false), &[9, 0, 8, 0, 7, 0, 6, 0]),
            [9, 8, 7, 6]
        );
    }

    #[test]
    fn damaged_images_are_no_images_and_no_panic() {
        let bytes = png::encode(5, 4, 4, &picture());
        let mut seed = 7_u64;
        let mut random = |end: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            usize::try_from(seed >> 33).unwrap_or(0) % end
        };
        for _ in 0..20_000 {
            let mut changed = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(changed.len());
                changed[at] = u8::try_from(random(256)).unwrap_or(0);
            }
            changed.truncate(random(changed.len()) + 1);
            if let Some(pixels) = read_png(&changed) {
                assert_eq!(pixels.bytes.len(), 3 * pixels.width * pixels.height);
            }
            // A JPEG of noise behind a true beginning.
            let jpeg = [b"\xff\xd8\xff\xe0", changed.as_slice()].concat();
            assert!(read("image/jpeg", &jpeg).is_none());
        }
    }
}
