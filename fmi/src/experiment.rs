//! Times and tolerance that the importer announces.

/// What fmi2SetupExperiment says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Experiment {
    /// s
    pub(crate) start: f64,
    /// s; infinite if undefined.
    pub(crate) stop: f64,
    /// 0 if undefined.
    pub(crate) tolerance: f64,
}

impl Experiment {
    /// Where fmi2SetupExperiment is not called.
    pub(crate) const DEFAULT: Self = Self {
        start: 0.0,
        stop: f64::INFINITY,
        tolerance: 0.0,
    };

    /// Whether fmi2SetupExperiment could have said it.
    pub(crate) fn is_legal(&self) -> bool {
        self.start.is_finite()
            && self.stop >= self.start
            && self.tolerance.is_finite()
            && self.tolerance >= 0.0
    }
}
