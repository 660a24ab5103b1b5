//! Numbers in messages.

use std::fmt;

/// A number as messages write it: the shortest digits that mean it, with an exponent where it is
/// below 1e-4 or 1e16 and above, which would else be up to 320 digits long.
#[derive(Clone, Copy, Debug)]
pub struct Digits(pub f64);

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || !size.is_finite() || (1e-4..1e16).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.5, "-0.5"),
            (1e6, "1000000"),
            (1e-4, "0.0001"),
            (1.5e-5, "1.5e-5"),
            (1e16, "1e16"),
            (-1e300, "-1e300"),
            (1e-320, "1e-320"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Digits(value).to_string(), text);
        }
    }
}
