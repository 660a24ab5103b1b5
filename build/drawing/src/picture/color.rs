//! Colours of pixels.

use crate::image::STEPS;

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
