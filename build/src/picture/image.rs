//! Textures: PNG and JPEG files → linear colours in halves of halves of their size.
//!
//! A file that is damaged, or of a kind that nobody uses for textures, is no image: the surface
//! keeps its plain colour.

use super::camera::count;
use super::color::linear;
use super::png::{SIGNATURE, expected};

use flate2::read::ZlibDecoder;
use std::io::Read;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most pixels of a texture's file.
const MOST_PIXELS: usize = 64 << 20;

/// Pixels that the textures of a robot are reduced to, all together: a picture shows no more.
pub(super) const ALL_PIXELS: usize = 8 << 20;

/// A texture in several sizes.
pub(super) struct Image {
    /// The largest first, each half of the one before.
    levels: Vec<Level>,
}

struct Level {
    width: usize,
    height: usize,
    /// Row by row from the top.
    colors: Vec<[f32; 3]>,
}

impl Image {
    /// - `most`: pixels that are kept; a larger image is reduced by a whole factor
    pub(super) fn read(kind: &str, bytes: &[u8], most: usize) -> Option<Self> {
        let (width, height, pixels) = match kind {
            "image/png" => read_png(bytes)?,
            _ => read_jpeg(bytes)?,
        };
        let light: Vec<f32> = (0..=255).map(|x| linear(f64::from(x) / 255.0)).collect();
        let (mut factor, mut kept) = (1, width * height);
        while kept > most.max(1) && factor < width.max(height) {
            factor += 1;
            kept = width.div_ceil(factor) * height.div_ceil(factor);
        }
        let mean = |x: usize, y: usize| {
            let (mut sum, mut number) = ([0.0; 3], 0.0);
            for y in y * factor..((y + 1) * factor).min(height) {
                for x in x * factor..((x + 1) * factor).min(width) {
                    for (sum, byte) in sum.iter_mut().zip(pixels[y * width + x]) {
                        *sum += light[usize::from(byte)];
                    }
                    number += 1.0;
                }
            }
            sum.map(|x| x / number)
        };
        let (columns, rows) = (width.div_ceil(factor), height.div_ceil(factor));
        let first = Level {
            width: columns,
            height: rows,
            colors: (0..columns * rows)
                .map(|k| mean(k % columns, k / columns))
                .collect(),
        };
        let mut levels = vec![first];
        while let Some(next) = levels.last().and_then(Level::half) {
            levels.push(next);
        }
        Some(Self { levels })
    }

    /// The colour at texture coordinates, mixed from the four nearest of the size in which `pixel`
    /// (a part of the side) is about one.
    pub(super) fn at(&self, [u, v]: [f64; 2], pixel: f64) -> [f32; 3] {
        let fits = |level: &&Level| pixel * count(level.width.max(level.height)) <= 1.5;
        let level = self.levels.iter().find(fits).or(self.levels.last());
        level.map_or([1.0; 3], |level| level.mixed([u, 1.0 - v]))
    }
}

impl Level {
    /// `None` for one pixel.
    fn half(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut colors = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| {
                    let x = (2 * x + i).min(self.width - 1);
                    let y = (2 * y + j).min(self.height - 1);
                    self.colors[y * self.width + x]
                });
                colors.push(std::array::from_fn(|k| {
                    0.25 * (four[0][k] + four[1][k] + four[2][k] + four[3][k])
                }));
            }
        }
        Some(Self {
            width,
            height,
            colors,
        })
    }

    /// - `at`: parts of the sides from the upper left corner; the texture repeats
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the sides"
    )]
    fn mixed(&self, at: [f64; 2]) -> [f32; 3] {
        let sides = [self.width, self.height];
        let near: [(usize, usize, f32); 2] = std::array::from_fn(|i| {
            let side = sides[i];
            let x = (at[i] - at[i].floor()) * count(side) - 0.5;
            let low = x.floor();
            let first = if low < 0.0 {
                side - 1
            } else {
                (low as usize).min(side - 1)
            };
            (first, (first + 1) % side, (x - low) as f32)
        });
        let [(left, right, u), (top, bottom, v)] = near;
        let color = |x: usize, y: usize, k: usize| self.colors[y * self.width + x][k];
        std::array::from_fn(|k| {
            let upper = color(left, top, k) * (1.0 - u) + color(right, top, k) * u;
            let lower = color(left, bottom, k) * (1.0 - u) + color(right, bottom, k) * u;
            upper * (1.0 - v) + lower * v
        })
    }
}

/// Width, height, and red, green, blue of each pixel.
type Pixels = (usize, usize, Vec<[u8; 3]>);

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
    let raw = decoder.decode().ok()?;
    let pixels: Vec<[u8; 3]> = raw.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (pixels.len() == width * height).then_some((width, height, pixels))
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
    let mut pixels = Vec::with_capacity(header.width * header.height);
    for line in raw.chunks_exact(row + 1) {
        let (&kind, differences) = line.split_first()?;
        let mut line = differences.to_vec();
        for i in 0..row {
            line[i] = line[i].wrapping_add(expected(kind, &line, &above, i, pixel));
        }
        for x in 0..header.width {
            pixels.push(header.color(&line, x, &palette));
        }
        above = line;
    }
    Some((header.width, header.height, pixels))
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
    use super::*;
    use crate::picture::look::Picture;
    use crate::picture::png::encode;

    fn picture() -> Picture {
        Picture {
            width: 5,
            height: 4,
            pixels: (0..20)
                .map(|k| [k * 12, 255 - k, k % 7 * 30, 255])
                .collect(),
        }
    }

    #[test]
    fn a_png_that_was_written_is_read_again() {
        let picture = picture();
        let (width, height, pixels) = read_png(&encode(&picture)).expect("a PNG");
        assert_eq!((width, height), (5, 4));
        let colors: Vec<[u8; 3]> = picture.pixels.iter().map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(pixels, colors);
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
        let bytes = encode(&picture());
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
            if let Some((width, height, pixels)) = read_png(&changed) {
                assert_eq!(pixels.len(), width * height);
            }
            // A JPEG of noise behind a true beginning.
            let jpeg = [b"\xff\xd8\xff\xe0", changed.as_slice()].concat();
            assert!(Image::read("image/jpeg", &jpeg, 64).is_none());
        }
    }

    #[test]
    fn textures_repeat_and_begin_at_the_lower_left() {
        let picture = Picture {
            width: 2,
            height: 2,
            pixels: vec![
                [255, 0, 0, 255],
                [0, 255, 0, 255],
                [0, 0, 255, 255],
                [0, 0, 0, 255],
            ],
        };
        let image = Image::read("image/png", &encode(&picture), 4).expect("a PNG");
        let near = |found: [f32; 3], expected: [f32; 3]| {
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-6)
        };
        for shift in [-3.0, 0.0, 2.0] {
            assert!(near(image.at([shift + 0.25, 0.25], 0.0), [0.0, 0.0, 1.0]));
            assert!(near(image.at([0.25, shift + 0.75], 0.0), [1.0, 0.0, 0.0]));
            assert!(near(image.at([shift + 0.75, 0.75], 0.0), [0.0, 1.0, 0.0]));
        }
        // From afar all four are one, and so they are where no more may be kept.
        assert!(near(image.at([0.1, 0.9], 1.0), [0.25; 3]));
        let small = Image::read("image/png", &encode(&picture), 1).expect("a PNG");
        assert!(near(small.at([0.1, 0.9], 0.0), [0.25; 3]));
    }
}
