//! FMI's words for a variable, its numbers as text, and the default experiment.

use urdf2fmu_core::tuning::DEFAULT_TOLERANCE;
use urdf2fmu_core::variables::{Causality, Kind, Slot, Variable};

/// Type of the annotation that names the elements of arrays: in each line the value reference of an
/// array, then the names.
pub const ELEMENTS: &str = "io.github.urdf2fmu.elements";
/// Seconds of the default experiment.
pub const STOP_TIME: f64 = 10.0;
/// Communication step of the default experiment, s: what users of 240 Hz simulators are used to.
pub const STEP_SIZE: f64 = 1.0 / 240.0;
/// Tolerance of the default experiment: the solver's if neither settings nor importer give one.
pub const TOLERANCE: f64 = DEFAULT_TOLERANCE;
/// The same where Model Exchange is offered: at 1e-3 integrators such as CVODE swing between the
/// caps of forces and give up, and finer ones take hardly more steps.
pub const EXCHANGE_TOLERANCE: f64 = 1e-4;

/// FMI's word for whose the value is.
pub fn causality(v: &Variable) -> &'static str {
    match v.causality() {
        Causality::Input => "input",
        Causality::Parameter => "parameter",
        Causality::Output => "output",
        Causality::Local => "local",
    }
}

/// FMI's word for when the value may change.
pub fn variability(v: &Variable) -> &'static str {
    match (v.slot, v.kind) {
        (Slot::Parameter(slot), _) if slot.tunable() => "tunable",
        (Slot::Parameter(_), _) => "fixed",
        (_, Kind::Real) if !v.stepped => "continuous",
        _ => "discrete",
    }
}

/// Shortest text that reads back as the same double.
pub fn number(x: f64) -> String {
    // A negative zero would only puzzle readers.
    let text = format!("{:?}", if x == 0.0 { 0.0 } else { x });
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
