//! Heights that are computed.

use urdf2fmu_core::geometry::field::Samples;
use urdf2fmu_core::settings::{GeneratedHeights, HeightForm};

/// Octaves of noise: each has half the wavelength and half the height of the one before.
const OCTAVES: u32 = 4;

/// Heights from 0 to `height`, m, over a rectangle of the extent `size`, m.
pub(super) fn heights(made: &GeneratedHeights, size: [f64; 2], height: f64) -> Samples {
    let counts = size.map(|s| samples(s, made.resolution));
    let (steps, wavelength) = (f64::from(made.steps), made.wavelength);
    let at = |x: f64, y: f64| match made.form {
        HeightForm::Ramp => (3.0 * (x / size[0] + 0.5) - 1.0).clamp(0.0, 1.0),
        // The lowest and the highest are even ground, as long as the treads between them.
        HeightForm::Steps => ((x / size[0] + 0.5) * (steps + 1.0)).floor().min(steps) / steps,
        HeightForm::Waves => wave(x / wavelength),
        HeightForm::Noise => noise([x / wavelength, y / wavelength], made.seed),
    };
    let place = |k: usize, i: usize| (number(i) / number(counts[k] - 1) - 0.5) * size[k];
    let rows = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| (i, j)));
    let mut heights: Vec<f64> = rows.map(|(i, j)| at(place(0, i), place(1, j))).collect();
    if made.form == HeightForm::Noise {
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let extent = (high - low).max(f64::MIN_POSITIVE);
        for h in &mut heights {
            *h = (*h - low) / extent;
        }
    }
    for h in &mut heights {
        *h *= height;
    }
    Samples {
        size,
        counts,
        heights,
    }
}

/// Height of a wave over its trough as a share of its whole height.
///
/// - `way`: from the trough, in wavelengths
pub(super) fn wave(way: f64) -> f64 {
    0.5 - 0.5 * libm::cos(std::f64::consts::TAU * way)
}

/// Samples over an extent, no farther from each other than `resolution`.
fn samples(extent: f64, resolution: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the settings keep it small"
    )]
    let cells = (extent / resolution - 1e-9).ceil().max(1.0) as usize;
    cells + 1
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn number(n: usize) -> f64 {
    n as f64
}

/// Gradient-free noise: random values on a lattice, smoothly joined, in octaves. Source: Perlin
/// 2002 for the polynomial that joins them.
fn noise(at: [f64; 2], seed: u32) -> f64 {
    let (mut sum, mut part, mut scale) = (0.0, 1.0, 1.0);
    for octave in 0..OCTAVES {
        // Shifted, so that no octave has a lattice point in the origin.
        let shift = 0.37 * f64::from(octave + 1);
        sum += part * smooth(at.map(|x| x * scale + shift), seed ^ (octave << 24));
        (part, scale) = (0.5 * part, 2.0 * scale);
    }
    sum
}

fn smooth([x, y]: [f64; 2], seed: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let fade = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (fade(x - i), fade(y - j));
    let value = |di: f64, dj: f64| lattice(i + di, j + dj, seed);
    let low = value(0.0, 0.0) * (1.0 - u) + value(1.0, 0.0) * u;
    let high = value(0.0, 1.0) * (1.0 - u) + value(1.0, 1.0) * u;
    low * (1.0 - v) + high * v
}

/// A value of 0 … 1 for a lattice point. Source: the mixing of Steele, Lea & Flood 2014.
fn lattice(i: f64, j: f64, seed: u32) -> f64 {
    let mut z = u64::from(seed) << 32;
    for x in [i, j] {
        z = z
            .wrapping_add(x.to_bits())
            .wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
    }
    #[expect(clippy::cast_precision_loss, reason = "53 bits")]
    let value = (z >> 11) as f64;
    value / 9_007_199_254_740_992.0
}
