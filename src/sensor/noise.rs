//! Random numbers as functions of seed, sensor, channel and sample: no generator has a state, so a
//! restored state continues with the same noise.
//!
//! Source: Salmon et al. 2011, Parallel Random Numbers: As Easy as 1, 2, 3 (Philox 4×32, ten
//! rounds); Box and Muller 1958 for the normal distribution.

use crate::hash::fnv1a;

/// Which stream of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
}

impl Stream {
    /// That of a sensor: another one for each seed and for each name.
    pub fn new(seed: u32, name: &str) -> Self {
        let hash = fnv1a(name.as_bytes());
        #[expect(clippy::cast_possible_truncation, reason = "32 of 64 bits are enough")]
        let name = (hash ^ (hash >> 32)) as u32;
        Self { key: [seed, name] }
    }

    /// A number of the normal distribution with mean 0 and variance 1.
    ///
    /// - `sample`: which one in time
    /// - `channel`: of which number of the sensor
    pub fn normal(self, sample: u64, channel: u32) -> f64 {
        #[expect(clippy::cast_possible_truncation, reason = "both halves are used")]
        let counter = [sample as u32, (sample >> 32) as u32, channel, 0];
        let [a, b, c, d] = philox(counter, self.key);
        // 53 bits each. The first is above 0: it has a logarithm.
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = |high: u32, low: u32, more: u64| {
            ((((u64::from(high) << 32) | u64::from(low)) >> 11) + more) as f64
                / (1_u64 << 53) as f64
        };
        let radius = (-2.0 * libm::log(share(a, b, 1))).sqrt();
        radius * libm::cos(std::f64::consts::TAU * share(c, d, 0))
    }
}

/// A bijection of counters for each key.
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const FACTORS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let product = |i: usize| u64::from(FACTORS[i]) * u64::from(counter[2 * i]);
        #[expect(clippy::cast_possible_truncation, reason = "both halves are used")]
        let halves = |x: u64| ((x >> 32) as u32, x as u32);
        let ((high_0, low_0), (high_1, low_1)) = (halves(product(0)), halves(product(1)));
        counter = [
            high_1 ^ counter[1] ^ key[0],
            low_1,
            high_0 ^ counter[3] ^ key[1],
            low_0,
        ];
        key = [key[0].wrapping_add(STEPS[0]), key[1].wrapping_add(STEPS[1])];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers that come with Random123, the authors' own program.
    #[test]
    fn philox_gives_the_known_answers_of_its_authors() {
        let cases = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox(counter, key), expected);
        }
    }

    /// Of `n` samples the mean has a standard deviation of `1/√n`, the variance one of `√(2/n)`,
    /// the fourth moment (3) one of `√(96/n)`, and so has the correlation of two streams `1/√n`;
    /// all of them stay within four of these.
    #[test]
    fn noise_has_mean_zero_and_variance_one() {
        const SAMPLES: u32 = 100_000;
        let n = f64::from(SAMPLES);
        let (stream, other) = (Stream::new(7, "imu"), Stream::new(8, "imu"));
        let (mut sum, mut square, mut fourth, mut lag, mut apart) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for k in 0..u64::from(SAMPLES) {
            let x = stream.normal(k, 3);
            sum += x;
            square += x * x;
            fourth += x * x * x * x;
            lag += x * stream.normal(k + 1, 3);
            apart += x * (stream.normal(k, 4) + other.normal(k, 3)) / std::f64::consts::SQRT_2;
        }
        let deviation = 1.0 / n.sqrt();
        assert!((sum / n).abs() < 4.0 * deviation, "{}", sum / n);
        assert!(
            (square / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt(),
            "{}",
            square / n
        );
        assert!(
            (fourth / n - 3.0).abs() < 4.0 * (96.0 / n).sqrt(),
            "{}",
            fourth / n
        );
        assert!((lag / n).abs() < 4.0 * deviation, "{}", lag / n);
        assert!((apart / n).abs() < 4.0 * deviation, "{}", apart / n);
    }
}
