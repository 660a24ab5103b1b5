//! Calling sequence: the state machine of FMI 2.0 for co-simulation as one table.
//!
//! Source: FMI 2.0.4, section 4.2.4, with two deliberate leniencies: fmi2GetXXX is answered before
//! initialisation too (importers read start values there), and fmi2SetupExperiment may be left out.

use std::fmt;

/// Where an instance stands in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Phase {
    /// After fmi2Instantiate or fmi2Reset.
    Instantiated = 0,
    /// Between fmi2EnterInitializationMode and fmi2ExitInitializationMode.
    Initialization = 1,
    /// Initialised, no step under way.
    StepComplete = 2,
    /// The last step was discarded.
    StepFailed = 3,
    /// After fmi2Terminate.
    Terminated = 4,
    /// After an internal error.
    Error = 5,
}

impl Phase {
    /// All of them, in the order of the table's columns.
    pub(crate) const ALL: [Self; 6] = [
        Self::Instantiated,
        Self::Initialization,
        Self::StepComplete,
        Self::StepFailed,
        Self::Terminated,
        Self::Error,
    ];

    /// Whether the simulation has begun.
    pub(crate) fn is_initialized(self) -> bool {
        matches!(
            self,
            Self::StepComplete | Self::StepFailed | Self::Terminated
        )
    }

    /// The phase with this number, as saved states hold it.
    pub(crate) fn from_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|phase| *phase as u32 == number)
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "instantiated",
            Self::Initialization => "initialization mode",
            Self::StepComplete => "step complete",
            Self::StepFailed => "step failed",
            Self::Terminated => "terminated",
            Self::Error => "error",
        })
    }
}

/// One column of a row: `x` allowed, `o` not.
macro_rules! mark {
    (x) => {
        true
    };
    (o) => {
        false
    };
}

macro_rules! table {
    ($($name:ident $($mark:ident)*;)*) => {
        /// A function that needs an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Function { $($name),* }

        impl Function {
            /// All of them.
            #[cfg(test)]
            pub(crate) const ALL: &[Self] = &[$(Self::$name),*];

            /// As in the FMI headers.
            pub(crate) fn name(self) -> &'static str {
                match self { $(Self::$name => concat!("fmi2", stringify!($name))),* }
            }

            /// The function's row.
            const fn row(self) -> [bool; 6] {
                match self { $(Self::$name => [$(mark!($mark)),*]),* }
            }
        }
    };
}

table! {
    //                              Instantiated
    //                              | Initialization
    //                              | | StepComplete
    //                              | | | StepFailed
    //                              | | | | Terminated
    //                              | | | | | Error
    SetDebugLogging                 x x x x x x;
    FreeInstance                    x x x x x x;
    SetupExperiment                 x o o o o o;
    EnterInitializationMode         x o o o o o;
    ExitInitializationMode          o x o o o o;
    Terminate                       o o x x o o;
    Reset                           x x x x x x;
    GetReal                         x x x x x o;
    GetInteger                      x x x x x o;
    GetBoolean                      x x x x x o;
    GetString                       x x x x x o;
    SetReal                         x x x o o o;
    SetInteger                      x x x o o o;
    SetBoolean                      x x x o o o;
    SetString                       x x x o o o;
    GetFMUstate                     x x x x x o;
    SetFMUstate                     x x x x x x;
    FreeFMUstate                    x x x x x x;
    SerializedFMUstateSize          x x x x x x;
    SerializeFMUstate               x x x x x x;
    DeSerializeFMUstate             x x x x x x;
    GetDirectionalDerivative        o x x x x o;
    SetRealInputDerivatives         x x x o o o;
    GetRealOutputDerivatives        o o x x x o;
    DoStep                          o o x o o o;
    CancelStep                      o o o o o o;
    GetStatus                       o o x x x o;
    GetRealStatus                   o o x x x o;
    GetIntegerStatus                o o x x x o;
    GetBooleanStatus                o o x x x o;
    GetStringStatus                 o o x x x o;
    EnterEventMode                  o o o o o o;
    NewDiscreteStates               o o o o o o;
    EnterContinuousTimeMode         o o o o o o;
    CompletedIntegratorStep         o o o o o o;
    SetTime                         o o o o o o;
    SetContinuousStates             o o o o o o;
    GetDerivatives                  o o o o o o;
    GetEventIndicators              o o o o o o;
    GetContinuousStates             o o o o o o;
    GetNominalsOfContinuousStates   o o o o o o;
}

impl Function {
    /// Whether it may be called in `phase`.
    pub(crate) fn allowed_in(self, phase: Phase) -> bool {
        self.row()[phase as usize]
    }

    /// What to say when it is called in a phase that does not allow it.
    pub(crate) fn advice(self, phase: Phase) -> String {
        if !self.row().contains(&true) {
            return match self {
                Self::CancelStep => {
                    "no step is ever under way: every step is finished when fmi2DoStep returns"
                        .into()
                }
                _ => "it belongs to Model Exchange; this FMU is for co-simulation only".into(),
            };
        }
        if phase == Phase::Error {
            return "after an internal error only fmi2Reset, fmi2SetFMUstate and fmi2FreeInstance help"
                .into();
        }
        let allowed: Vec<String> = Phase::ALL
            .into_iter()
            .filter(|phase| self.allowed_in(*phase))
            .map(|phase| format!("'{phase}'"))
            .collect();
        format!("allowed in {}", allowed.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_convert_to_numbers_and_back() {
        for phase in Phase::ALL {
            assert_eq!(Phase::from_number(phase as u32), Some(phase));
        }
        assert_eq!(Phase::from_number(6), None);
    }

    #[test]
    fn after_an_error_only_reset_set_state_and_free_are_allowed() {
        let allowed: Vec<&str> = Function::ALL
            .iter()
            .filter(|function| function.allowed_in(Phase::Error))
            .map(|function| function.name())
            .collect();
        // FMI 2.0.4, table in section 4.2.4, column "error".
        assert_eq!(
            allowed,
            [
                "fmi2SetDebugLogging",
                "fmi2FreeInstance",
                "fmi2Reset",
                "fmi2SetFMUstate",
                "fmi2FreeFMUstate",
                "fmi2SerializedFMUstateSize",
                "fmi2SerializeFMUstate",
                "fmi2DeSerializeFMUstate",
            ]
        );
    }

    #[test]
    fn a_rejected_call_is_answered_with_advice() {
        assert_eq!(
            Function::DoStep.advice(Phase::Instantiated),
            "allowed in 'step complete'"
        );
        assert!(
            Function::SetTime
                .advice(Phase::StepComplete)
                .contains("Model Exchange")
        );
    }
}
