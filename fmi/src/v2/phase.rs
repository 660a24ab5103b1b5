//! Calling sequence: the state machines of FMI 2.0 as one table.
//!
//! Source: FMI 2.0.4, sections 3.2.3 and 4.2.4, with two deliberate leniencies: fmi2GetXXX is
//! answered before initialisation too (importers read start values there), and fmi2SetupExperiment
//! may be left out.

use crate::common::Interface;
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
        EventMode "event mode",
        ContinuousTime "continuous-time mode",
    ],
    |_| "no step is ever under way: every step is finished when fmi2DoStep returns",
    |function| match function {
        Function::SetRealInputDerivatives
        | Function::GetRealOutputDerivatives
        | Function::DoStep
        | Function::CancelStep
        | Function::GetStatus
        | Function::GetRealStatus
        | Function::GetIntegerStatus
        | Function::GetBooleanStatus
        | Function::GetStringStatus => Some(Interface::CoSimulation),
        Function::EnterEventMode
        | Function::NewDiscreteStates
        | Function::EnterContinuousTimeMode
        | Function::CompletedIntegratorStep
        | Function::SetTime
        | Function::SetContinuousStates
        | Function::GetDerivatives
        | Function::GetEventIndicators
        | Function::GetContinuousStates
        | Function::GetNominalsOfContinuousStates => Some(Interface::ModelExchange),
        _ => None,
    };
    //                              Instantiated
    //                              | Initialization
    //                              | | StepComplete
    //                              | | | StepFailed
    //                              | | | | Terminated
    //                              | | | | | Error
    //                              | | | | | | EventMode
    //                              | | | | | | | ContinuousTime
    SetDebugLogging                 x x x x x x x x;
    FreeInstance                    x x x x x x x x;
    SetupExperiment                 x o o o o o o o;
    EnterInitializationMode         x o o o o o o o;
    ExitInitializationMode          o x o o o o o o;
    Terminate                       o o x x o o x x;
    Reset                           x x x x x x x x;
    GetReal                         x x x x x o x x;
    GetInteger                      x x x x x o x x;
    GetBoolean                      x x x x x o x x;
    GetString                       x x x x x o x x;
    SetReal                         x x x o o o x x;
    SetInteger                      x x x o o o x x;
    SetBoolean                      x x x o o o x x;
    SetString                       x x x o o o x x;
    GetFMUstate                     x x x x x o x x;
    SetFMUstate                     x x x x x x x x;
    FreeFMUstate                    x x x x x x x x;
    SerializedFMUstateSize          x x x x x x x x;
    SerializeFMUstate               x x x x x x x x;
    DeSerializeFMUstate             x x x x x x x x;
    GetDirectionalDerivative        o x x x x o x x;
    SetRealInputDerivatives         x x x o o o o o;
    GetRealOutputDerivatives        o o x x x o o o;
    DoStep                          o o x o o o o o;
    CancelStep                      o o o o o o o o;
    GetStatus                       o o x x x o o o;
    GetRealStatus                   o o x x x o o o;
    GetIntegerStatus                o o x x x o o o;
    GetBooleanStatus                o o x x x o o o;
    GetStringStatus                 o o x x x o o o;
    EnterEventMode                  o o o o o o o x;
    NewDiscreteStates               o o o o o o x o;
    EnterContinuousTimeMode         o o o o o o x o;
    CompletedIntegratorStep         o o o o o o o x;
    SetTime                         o o o o o o x x;
    SetContinuousStates             o o o o o o o x;
    GetDerivatives                  o x o o x o x x;
    GetEventIndicators              o x o o x o x x;
    GetContinuousStates             o x o o x o x x;
    GetNominalsOfContinuousStates   x x o o x o x x;
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
            Function::CancelStep
                .advice(Phase::StepComplete)
                .contains("finished when fmi2DoStep returns")
        );
        assert_eq!(Function::SetTime.only(), Some(Interface::ModelExchange));
        assert_eq!(Function::DoStep.only(), Some(Interface::CoSimulation));
        assert_eq!(Function::GetReal.only(), None);
    }
}
