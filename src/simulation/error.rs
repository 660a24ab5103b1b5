//! Why a simulation cannot go on.

use crate::snapshot::SavedStateError;

/// Why a simulation cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A value that cannot be set.
    #[error("{what} must be {expected}, not {}", crate::digits::Digits(*value))]
    Value {
        /// Which quantity.
        what: String,
        /// What would be legal.
        expected: &'static str,
        /// What came.
        value: f64,
    },
    /// The state is no longer finite.
    #[error("the state is not finite after t = {time} s; {hint}")]
    NotFinite {
        /// Last good time, s.
        time: f64,
        /// What to try.
        hint: &'static str,
    },
    /// A communication step that takes too much work.
    #[error(
        "the step from t = {time} s takes more than {most} tries of a solver step; raise \
         solver.max_steps or solver.tolerance, take shorter steps, or look for masses, stiffnesses or \
         speeds that are out of proportion"
    )]
    Work {
        /// Start of the step, s.
        time: f64,
        /// Tries that were allowed.
        most: f64,
    },
    /// Loops that do not close in the initial state.
    #[error(
        "loop '{name}' cannot be closed from the initial state: {distance:.3e} m and {angle:.3e} rad \
         are left; change initial positions, or the loop's origins"
    )]
    Open {
        /// The widest of them.
        name: String,
        /// m, or that of a coupler in its own unit.
        distance: f64,
        /// rad
        angle: f64,
    },
    /// A loop that is pulled farther than it reaches.
    #[error(
        "loop '{name}' cannot stay closed after t = {time} s: what it ties is pulled farther apart \
         than it reaches; change the commands, or the loop's length or origins"
    )]
    Apart {
        /// The widest of them.
        name: String,
        /// Last good time, s.
        time: f64,
    },
    /// Bytes that are not a saved state of this model.
    #[error(transparent)]
    State(#[from] SavedStateError),
}
