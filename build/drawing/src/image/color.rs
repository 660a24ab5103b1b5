//! Colours: sRGB as files have it, and linear light.
//!
//! Source: IEC 61966-2-1.

/// Linear light of a number in sRGB.
#[allow(clippy::cast_possible_truncation, reason = "colours")]
pub fn linear(x: f64) -> f32 {
    (if x <= 0.04045 {
        x / 12.92
    } else {
        libm::pow((x + 0.055) / 1.055, 2.4)
    }) as f32
}

/// Steps of linear light that are told apart.
pub const STEPS: usize = 8192;

/// sRGB of linear light in equal steps.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 … 255"
)]
pub fn srgb_table() -> Vec<u8> {
    (0..=STEPS)
        .map(|i| {
            #[allow(clippy::cast_precision_loss, reason = "few steps")]
            let x = i as f64 / STEPS as f64;
            let y = if x <= 0.003_130_8 {
                12.92 * x
            } else {
                1.055 * libm::pow(x, 1.0 / 2.4) - 0.055
            };
            (y * 255.0 + 0.5) as u8
        })
        .collect()
}
