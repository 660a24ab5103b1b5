//! When two times are the same.
//!
//! Importers add up or multiply the lengths of their steps, each in its own way, so that numbers
//! for one time differ by round-off. It grows with the distance from zero: at a Unix time of
//! 1.7e9 s two neighbouring numbers are 0.24 µs apart.

/// Round-off of a time, as a share of it. A sum and a product for one time are one or two spaces
/// between numbers apart, of at most an epsilon each. At 0 fails
/// `times_that_are_computed_in_two_ways_are_the_same`.
const SHARE: f64 = 8.0 * f64::EPSILON;

/// By how much numbers for the time `time`, s, may differ, s.
pub fn round_off(time: f64) -> f64 {
    SHARE * time.abs()
}

/// Whether two times, s, are the same but for round-off, or differ by at most `allowed`, s.
pub fn is_same(a: f64, b: f64, allowed: f64) -> bool {
    a.to_bits() == b.to_bits() || (a - b).abs() <= allowed + round_off(a.abs().min(b.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_are_computed_in_two_ways_are_the_same() {
        for start in [0.0, 1e5, 1e6, 1.7e9, -1e10] {
            for step in [1.0 / 240.0, 1e-3, 0.1] {
                let mut last = start;
                for k in 1..1000 {
                    let product = start + f64::from(k) * step;
                    assert!(is_same(last + step, product, 0.0), "{start} {step} {k}");
                    assert!(!is_same(last, product, 0.0), "{start} {step} {k}");
                    last = product;
                }
            }
        }
    }

    #[test]
    fn times_apart_are_not_the_same() {
        assert!(is_same(0.0, 1e-9, 1e-9) && !is_same(0.0, 1e-9, 0.9e-9));
        assert!(!is_same(1.7e9, 1.7e9 + 1e-4, 0.0));
        assert!(!is_same(1.0, f64::INFINITY, 0.0) && !is_same(1.0, f64::NAN, 1.0));
        assert!(is_same(f64::INFINITY, f64::INFINITY, 0.0));
    }
}
