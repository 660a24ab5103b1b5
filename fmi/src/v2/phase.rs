//! Calling sequence: the state machine of FMI 2.0 for co-simulation as one table.
//!
//! Source: FMI 2.0.4, section 4.2.4, with two deliberate leniencies: fmi2GetXXX is answered before
//! initialisation too (importers read start values there), and fmi2SetupExperiment may be left out.

use crate::phase::table;

table! {
    V2 "fmi2",
    [
        Instantiated "instantiated",
        Initialization "initialization mode",
        StepComplete "step complete",
        StepFailed "step failed",
        Terminated "terminated",
        Error "error",
    ],
    |function| match function {
        Function::CancelStep => {
            "no step is ever under way: every step is finished when fmi2DoStep returns"
        }
        _ => "it belongs to Model Exchange; this FMU is for co-simulation only",
    };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Function as _, Phase};

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
