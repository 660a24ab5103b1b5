//! Textures: PNG and JPEG files → linear colours, in a series of images of half the size of the
//! last (mipmaps).
//!
//! A file that is damaged, or of a kind that nobody uses for textures, is no image: the surface
//! keeps its plain colour.

use super::camera::count;
use crate::image::{light_of_bytes, read, shrunk};

/// Pixels that the textures of a robot are reduced to, all together: a picture shows no more.
pub(super) const ALL_PIXELS: usize = 8 << 20;

/// A texture in several sizes.
pub(super) struct Image {
    /// The largest first, each half of the one before.
    levels: Vec<Level>,
    /// What bytes mean.
    light: [f32; 256],
}

struct Level {
    width: usize,
    height: usize,
    /// Row by row from the top.
    colors: Colors,
}

/// Linear colours.
enum Colors {
    /// Those of a file: a quarter of the memory, whose first use takes longer than looking them up.
    File(Vec<u8>),
    Light(Vec<[f32; 3]>),
}

impl Colors {
    fn get(&self, k: usize, light: &[f32; 256]) -> [f32; 3] {
        match self {
            Self::File(bytes) => [0, 1, 2].map(|i| light[usize::from(bytes[3 * k + i])]),
            Self::Light(colors) => colors[k],
        }
    }
}

impl Image {
    /// - `most`: pixels that are kept; a larger image is reduced by a whole factor
    pub(super) fn read(kind: &str, bytes: &[u8], most: usize) -> Option<Self> {
        let pixels = read(kind, bytes)?;
        let (width, height) = (pixels.width, pixels.height);
        let (mut factor, mut kept) = (1, width * height);
        while kept > most.max(1) && factor < width.max(height) {
            factor += 1;
            kept = width.div_ceil(factor) * height.div_ceil(factor);
        }
        let (width, height, colors) = if factor == 1 {
            (width, height, Colors::File(pixels.bytes))
        } else {
            let (width, height, colors) = shrunk(&pixels, factor);
            (width, height, Colors::Light(colors))
        };
        let light = light_of_bytes();
        let first = Level {
            width,
            height,
            colors,
        };
        let mut levels = vec![first];
        while let Some(next) = levels.last().and_then(|level| level.half(&light)) {
            levels.push(next);
        }
        Some(Self { levels, light })
    }

    /// The colour at texture coordinates, mixed from the four nearest of the size in which `pixel`
    /// (a part of the side) is about one.
    pub(super) fn at(&self, [u, v]: [f64; 2], pixel: f64) -> [f32; 3] {
        let fits = |level: &&Level| pixel * count(level.width.max(level.height)) <= 1.5;
        let level = self.levels.iter().find(fits).or(self.levels.last());
        level.map_or([1.0; 3], |level| level.mixed([u, 1.0 - v], &self.light))
    }
}

impl Level {
    /// `None` for one pixel.
    fn half(&self, light: &[f32; 256]) -> Option<Self> {
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
                    self.colors.get(y * self.width + x, light)
                });
                colors.push(std::array::from_fn(|k| {
                    0.25 * (four[0][k] + four[1][k] + four[2][k] + four[3][k])
                }));
            }
        }
        Some(Self {
            width,
            height,
            colors: Colors::Light(colors),
        })
    }

    /// - `at`: parts of the sides from the upper left corner; the texture repeats
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the sides"
    )]
    fn mixed(&self, at: [f64; 2], light: &[f32; 256]) -> [f32; 3] {
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
        let color = |x: usize, y: usize| self.colors.get(y * self.width + x, light);
        let [upper, lower] = [top, bottom].map(|y| [color(left, y), color(right, y)]);
        std::array::from_fn(|k| {
            let upper = upper[0][k] * (1.0 - u) + upper[1][k] * u;
            let lower = lower[0][k] * (1.0 - u) + lower[1][k] * u;
            upper * (1.0 - v) + lower * v
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::look::Picture;
    use crate::picture::png::encode;

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
