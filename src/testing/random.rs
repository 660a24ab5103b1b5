//! Random numbers for tests and benches.

/// Numbers that look random and are the same everywhere (`SplitMix64`).
pub struct Random(pub u64);

impl Random {
    /// Uniform in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (z >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * share
    }
}
