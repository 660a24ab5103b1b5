//! Ranges and ticks of axes.

/// Powers of ten up to which numbers are written out.
const WRITTEN_OUT: std::ops::Range<i32> = -3..5;

/// Share of the range that stays free above and below the curves.
const MARGIN: f64 = 0.08;

/// A range in round steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Values of ticks and what stands beside them.
    pub(super) ticks: Vec<(f64, String)>,
    /// Power of ten by which what stands beside the ticks is multiplied.
    pub(super) power: i32,
}

impl Axis {
    /// An axis around values, with some room; `ticks` is about their number.
    pub(super) fn around(values: impl Iterator<Item = f64>, ticks: f64) -> Self {
        let (low, high) = extent(values).unwrap_or((0.0, 1.0));
        let size = low.abs().max(high.abs());
        // What is constant is not shown as the noise of its last digits.
        let margin = MARGIN * (high - low).max(1e-3 * size).max(1e-12);
        Self::new(low - margin, high + margin, ticks)
    }

    /// An axis from the first to the last of times.
    pub(super) fn along(time: &[f64], ticks: f64) -> Self {
        let (low, high) = extent(time.iter().copied()).unwrap_or((0.0, 1.0));
        let high = if high > low { high } else { low + 1.0 };
        Self::new(low, high, ticks)
    }

    fn new(low: f64, high: f64, ticks: f64) -> Self {
        let step = round_step((high - low) / ticks);
        let size = low.abs().max(high.abs());
        let first_digit = order(size);
        let power = if WRITTEN_OUT.contains(&first_digit) {
            0
        } else {
            3 * first_digit.div_euclid(3)
        };
        let scale = ten(power);
        #[expect(clippy::cast_sign_loss, reason = "at least 0")]
        let decimals = (-order(step / scale * 1.000_001)).max(0) as usize;
        let first = (low / step).ceil();
        let count = (high / step).floor() - first;
        let mut list = Vec::new();
        let mut i = 0.0;
        while i <= count {
            let value = (first + i) * step;
            let text = format!("{:.decimals$}", value / scale);
            let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
            // A minus sign, not a hyphen; none before zero.
            let text = match text.strip_prefix('-') {
                Some(digits) if zero => digits.to_owned(),
                Some(digits) => format!("\u{2212}{digits}"),
                None => text,
            };
            list.push((value, text));
            i += 1.0;
        }
        Self {
            low,
            high,
            ticks: list,
            power,
        }
    }

    /// Place of a value between `low` (0) and `high` (1).
    pub(super) fn place(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Least and greatest of the finite values.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|x| x.is_finite()).fold(None, |found, x| {
        let (low, high) = found.unwrap_or((x, x));
        Some((low.min(x), high.max(x)))
    })
}

/// 1, 2 or 5 times a power of ten, not below `least`.
fn round_step(least: f64) -> f64 {
    let unit = ten(order(least));
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * unit);
    let fits = steps.into_iter().find(|step| *step >= least * 0.999_999);
    fits.unwrap_or(10.0 * unit)
}

/// Power of ten of a number's first digit.
fn order(x: f64) -> i32 {
    if !(x > 0.0 && x.is_finite()) {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "-324 … 308")]
    let order = libm::floor(libm::log10(x)) as i32;
    order
}

/// A power of ten, as exactly as there is one.
fn ten(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_within_the_range() {
        let time = [0.0, 10.0];
        assert_eq!(
            texts(&Axis::along(&time, 6.0)),
            ["0", "2", "4", "6", "8", "10"]
        );
        let axis = Axis::around([-0.25, 0.31].into_iter(), 4.0);
        assert_eq!(texts(&axis), ["\u{2212}0.2", "0.0", "0.2"]);
        assert!(axis.low < -0.25 && axis.high > 0.31);
    }

    #[test]
    fn very_large_and_very_small_numbers_have_a_common_power_of_ten() {
        let axis = Axis::around([0.0, 3e7].into_iter(), 4.0);
        assert_eq!((axis.power, texts(&axis)), (6, vec!["0", "10", "20", "30"]));
        let axis = Axis::around([0.0, 2e-6].into_iter(), 4.0);
        assert_eq!(axis.power, -6);
    }

    #[test]
    fn nothing_one_value_and_gaps_have_an_axis_too() {
        for values in [
            &[][..],
            &[f64::NAN],
            &[0.0],
            &[5.0, f64::NAN],
            &[1e300, -1e300],
        ] {
            let axis = Axis::around(values.iter().copied(), 4.0);
            assert!(axis.low < axis.high, "{values:?}: {axis:?}");
            assert!((1..20).contains(&axis.ticks.len()), "{values:?}: {axis:?}");
        }
        assert!(Axis::along(&[2.0], 4.0).high > 2.0);
    }
}
