//! Colours: sRGB as files have it, and linear light.
//!
//! Source: IEC 61966-2-1.

use super::camera::count;

/// Linear light of a number in sRGB.
#[allow(clippy::cast_possible_truncation, reason = "colours")]
pub(super) fn linear(x: f64) -> f32 {
    (if x <= 0.04045 {
        x / 12.92
    } else {
        libm::pow((x + 0.055) / 1.055, 2.4)
    }) as f32
}

/// Steps of linear light that are told apart.
const STEPS: usize = 8192;

/// sRGB of linear light in equal steps.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 … 255"
)]
pub(super) fn srgb_table() -> Vec<u8> {
    (0..=STEPS)
        .map(|i| {
            let x = count(i) / count(STEPS);
            let y = if x <= 0.003_130_8 {
                12.92 * x
            } else {
                1.055 * libm::pow(x, 1.0 / 2.4) - 0.055
            };
            (y * 255.0 + 0.5) as u8
        })
        .collect()
}

/// sRGB and alpha in bytes.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped"
)]
pub(super) fn finish([red, green, blue, alpha]: [f32; 4], to_srgb: &[u8]) -> [u8; 4] {
    let byte = (alpha * 255.0 + 0.5) as u8;
    if byte == 0 {
        return [0; 4];
    }
    let [red, green, blue] = [red, green, blue].map(|x| {
        let x = (x / alpha).clamp(0.0, 1.0);
        to_srgb[(x * STEPS as f32 + 0.5) as usize]
    });
    [red, green, blue, byte]
}
