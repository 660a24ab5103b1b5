//! Which numbers a setting or a parameter may be.

/// Which numbers are legal; finite in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Every finite one.
    Any,
    /// From 0 on.
    NotNegative,
    /// Above 0.
    Positive,
    /// From 0 to 1.
    Share,
    /// A fixed step, s, or 0 for error control.
    Step,
}

/// Shortest fixed step, s. A shorter one is a mistake, and would keep the host waiting for ever; what a model asks for is
/// raised to it.
pub(crate) const SHORTEST_FIXED_STEP: f64 = 1e-7;

impl Range {
    /// Whether `value` is legal.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Share => (0.0..=1.0).contains(&value),
                Self::Step => value == 0.0 || value >= SHORTEST_FIXED_STEP,
            }
    }

    /// What a legal number is.
    pub fn expected(self) -> &'static str {
        match self {
            Self::Any => "a finite number",
            Self::NotNegative => "a finite number that is not negative",
            Self::Positive => "a finite number above 0",
            Self::Share => "a number from 0 to 1",
            Self::Step => "0, or at least 1e-7 s",
        }
    }
}
