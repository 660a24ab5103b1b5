//! Calling sequence: the state machines of FMI 3.0 as one table.
//!
//! Source: FMI 3.0, sections 2.3, 3.2 and 4.2, with these deliberate leniencies: variables can be
//! got in every phase (importers read start values after instantiation, and outputs after setting
//! inputs), and a call that is refused leaves the phase as it is.

use crate::common::Interface;
use crate::phase::table;

table! {
    V3 "fmi3",
    [
        Instantiated "instantiated",
        Initialization "initialization mode",
        StepComplete "step mode",
        IntermediateUpdate "intermediate update mode",
        Terminated "terminated",
        Error "error",
        EventMode "event mode",
        ContinuousTime "continuous-time mode",
    ],
    |function| match function {
        Function::EnterStepMode => {
            "modelDescription.xml says hasEventMode=\"false\": inputs may jump between two steps"
        }
        Function::EvaluateDiscreteStates => {
            "modelDescription.xml does not say providesEvaluateDiscreteStates: there are no discrete \
             states"
        }
        Function::EnterConfigurationMode | Function::ExitConfigurationMode => {
            "there are no structural parameters"
        }
        Function::GetAdjointDerivative => {
            "modelDescription.xml says providesAdjointDerivatives=\"false\""
        }
        Function::GetNumberOfVariableDependencies | Function::GetVariableDependencies => {
            "modelDescription.xml says providesPerElementDependencies=\"false\"; its ModelStructure \
             lists dependencies"
        }
        Function::ActivateModelPartition => {
            "it belongs to Scheduled Execution, which this FMU does not offer"
        }
        Function::GetIntervalDecimal
        | Function::GetIntervalFraction
        | Function::GetShiftDecimal
        | Function::GetShiftFraction
        | Function::SetIntervalDecimal
        | Function::SetIntervalFraction
        | Function::SetShiftDecimal
        | Function::SetShiftFraction => "there are no clocks",
        _ => "this FMU does not offer it",
    },
    |function| match function {
        Function::GetOutputDerivatives | Function::DoStep | Function::EnterStepMode => {
            Some(Interface::CoSimulation)
        }
        Function::GetDirectionalDerivative
        | Function::EnterEventMode
        | Function::UpdateDiscreteStates
        | Function::EnterContinuousTimeMode
        | Function::CompletedIntegratorStep
        | Function::SetTime
        | Function::SetContinuousStates
        | Function::GetContinuousStateDerivatives
        | Function::GetEventIndicators
        | Function::GetContinuousStates
        | Function::GetNominalsOfContinuousStates
        | Function::GetNumberOfEventIndicators
        | Function::GetNumberOfContinuousStates => Some(Interface::ModelExchange),
        _ => None,
    };
    //                              Instantiated
    //                              | Initialization
    //                              | | StepComplete
    //                              | | | IntermediateUpdate
    //                              | | | | Terminated
    //                              | | | | | Error
    //                              | | | | | | EventMode
    //                              | | | | | | | ContinuousTime
    SetDebugLogging                 x x x x x x x x;
    FreeInstance                    x x x o x x x x;
    EnterInitializationMode         x o o o o o o o;
    ExitInitializationMode          o x o o o o o o;
    Terminate                       o o x o o o x x;
    Reset                           x x x o x x x x;
    GetFloat32                      x x x x x o x x;
    GetFloat64                      x x x x x o x x;
    GetInt8                         x x x x x o x x;
    GetUInt8                        x x x x x o x x;
    GetInt16                        x x x x x o x x;
    GetUInt16                       x x x x x o x x;
    GetInt32                        x x x x x o x x;
    GetUInt32                       x x x x x o x x;
    GetInt64                        x x x x x o x x;
    GetUInt64                       x x x x x o x x;
    GetBoolean                      x x x x x o x x;
    GetString                       x x x x x o x x;
    GetBinary                       x x x x x o x x;
    GetClock                        x x x x x o x x;
    SetFloat32                      x x x x o o x x;
    SetFloat64                      x x x x o o x x;
    SetInt8                         x x x x o o x x;
    SetUInt8                        x x x x o o x x;
    SetInt16                        x x x x o o x x;
    SetUInt16                       x x x x o o x x;
    SetInt32                        x x x x o o x x;
    SetUInt32                       x x x x o o x x;
    SetInt64                        x x x x o o x x;
    SetUInt64                       x x x x o o x x;
    SetBoolean                      x x x x o o x x;
    SetString                       x x x x o o x x;
    SetBinary                       x x x x o o x x;
    SetClock                        x x x x o o x x;
    GetFMUState                     x x x o x o x x;
    SetFMUState                     x x x o x x x x;
    FreeFMUState                    x x x x x x x x;
    SerializedFMUStateSize          x x x x x x x x;
    SerializeFMUState               x x x x x x x x;
    DeserializeFMUState             x x x x x x x x;
    GetOutputDerivatives            o o x x x o o o;
    DoStep                          o o x o o o o o;
    GetNumberOfVariableDependencies o o o o o o o o;
    GetVariableDependencies         o o o o o o o o;
    GetDirectionalDerivative        o x o o x o x x;
    GetAdjointDerivative            o o o o o o o o;
    EnterConfigurationMode          o o o o o o o o;
    ExitConfigurationMode           o o o o o o o o;
    GetIntervalDecimal              o o o o o o o o;
    GetIntervalFraction             o o o o o o o o;
    GetShiftDecimal                 o o o o o o o o;
    GetShiftFraction                o o o o o o o o;
    SetIntervalDecimal              o o o o o o o o;
    SetIntervalFraction             o o o o o o o o;
    SetShiftDecimal                 o o o o o o o o;
    SetShiftFraction                o o o o o o o o;
    EnterEventMode                  o o o o o o o x;
    EnterStepMode                   o o o o o o o o;
    EvaluateDiscreteStates          o o o o o o o o;
    UpdateDiscreteStates            o o o o o o x o;
    EnterContinuousTimeMode         o o o o o o x o;
    CompletedIntegratorStep         o o o o o o o x;
    SetTime                         o o o o o o o x;
    SetContinuousStates             o o o o o o o x;
    GetContinuousStateDerivatives   o x o o x o x x;
    GetEventIndicators              o x o o x o x x;
    GetContinuousStates             o x o o x o x x;
    GetNominalsOfContinuousStates   o x o o x o x x;
    GetNumberOfEventIndicators      x x o o x o x x;
    GetNumberOfContinuousStates     x x o o x o x x;
    ActivateModelPartition          o o o o o o o o;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Function as _, Phase};

    #[test]
    fn every_function_of_the_header_that_takes_an_instance_has_a_row() {
        // Of 75, GetVersion and the three that make instances take none.
        assert_eq!(Function::ALL.len(), 71);
    }

    #[test]
    fn nothing_ends_an_instance_while_the_importer_is_called_within_a_step() {
        for function in [
            Function::FreeInstance,
            Function::Reset,
            Function::SetFMUState,
            Function::DoStep,
            Function::Terminate,
        ] {
            assert!(
                !function.allowed_in(Phase::IntermediateUpdate),
                "{function:?}"
            );
        }
    }

    #[test]
    fn a_refused_function_says_why() {
        assert_eq!(
            Function::DoStep.advice(Phase::Instantiated),
            "allowed in 'step mode'"
        );
        for function in Function::ALL {
            assert!(
                !function.advice(Phase::Terminated).is_empty(),
                "{function:?}"
            );
        }
        let advice = Function::GetFloat64.advice(Phase::Error);
        assert!(advice.contains("fmi3SetFMUState"), "{advice}");
    }
}
