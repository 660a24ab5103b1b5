//! Calling sequence: the state machine of FMI 3.0 for co-simulation as one table.
//!
//! Source: FMI 3.0, sections 2.3 and 4.2, with these deliberate leniencies: variables can be got in
//! every phase (importers read start values after instantiation, and outputs after setting inputs),
//! and a call that is refused leaves the phase as it is.

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
    ],
    |function| match function {
        Function::EnterEventMode
        | Function::EnterStepMode
        | Function::UpdateDiscreteStates
        | Function::EvaluateDiscreteStates => {
            "modelDescription.xml says hasEventMode=\"false\": inputs may jump between two steps"
        }
        Function::EnterConfigurationMode | Function::ExitConfigurationMode => {
            "there are no structural parameters"
        }
        Function::GetDirectionalDerivative => {
            "modelDescription.xml says providesDirectionalDerivatives=\"false\""
        }
        Function::GetAdjointDerivative => {
            "modelDescription.xml says providesAdjointDerivatives=\"false\""
        }
        Function::GetNumberOfVariableDependencies | Function::GetVariableDependencies => {
            "modelDescription.xml says providesPerElementDependencies=\"false\"; its ModelStructure \
             lists dependencies"
        }
        Function::ActivateModelPartition => {
            "it belongs to Scheduled Execution; this FMU is for co-simulation only"
        }
        Function::GetIntervalDecimal
        | Function::GetIntervalFraction
        | Function::GetShiftDecimal
        | Function::GetShiftFraction
        | Function::SetIntervalDecimal
        | Function::SetIntervalFraction
        | Function::SetShiftDecimal
        | Function::SetShiftFraction => "there are no clocks",
        _ => "it belongs to Model Exchange; this FMU is for co-simulation only",
    };
    //                              Instantiated
    //                              | Initialization
    //                              | | StepComplete
    //                              | | | IntermediateUpdate
    //                              | | | | Terminated
    //                              | | | | | Error
    SetDebugLogging                 x x x x x x;
    FreeInstance                    x x x o x x;
    EnterInitializationMode         x o o o o o;
    ExitInitializationMode          o x o o o o;
    Terminate                       o o x o o o;
    Reset                           x x x o x x;
    GetFloat32                      x x x x x o;
    GetFloat64                      x x x x x o;
    GetInt8                         x x x x x o;
    GetUInt8                        x x x x x o;
    GetInt16                        x x x x x o;
    GetUInt16                       x x x x x o;
    GetInt32                        x x x x x o;
    GetUInt32                       x x x x x o;
    GetInt64                        x x x x x o;
    GetUInt64                       x x x x x o;
    GetBoolean                      x x x x x o;
    GetString                       x x x x x o;
    GetBinary                       x x x x x o;
    GetClock                        x x x x x o;
    SetFloat32                      x x x x o o;
    SetFloat64                      x x x x o o;
    SetInt8                         x x x x o o;
    SetUInt8                        x x x x o o;
    SetInt16                        x x x x o o;
    SetUInt16                       x x x x o o;
    SetInt32                        x x x x o o;
    SetUInt32                       x x x x o o;
    SetInt64                        x x x x o o;
    SetUInt64                       x x x x o o;
    SetBoolean                      x x x x o o;
    SetString                       x x x x o o;
    SetBinary                       x x x x o o;
    SetClock                        x x x x o o;
    GetFMUState                     x x x o x o;
    SetFMUState                     x x x o x x;
    FreeFMUState                    x x x x x x;
    SerializedFMUStateSize          x x x x x x;
    SerializeFMUState               x x x x x x;
    DeserializeFMUState             x x x x x x;
    GetOutputDerivatives            o o x x x o;
    DoStep                          o o x o o o;
    GetNumberOfVariableDependencies o o o o o o;
    GetVariableDependencies         o o o o o o;
    GetDirectionalDerivative        o o o o o o;
    GetAdjointDerivative            o o o o o o;
    EnterConfigurationMode          o o o o o o;
    ExitConfigurationMode           o o o o o o;
    GetIntervalDecimal              o o o o o o;
    GetIntervalFraction             o o o o o o;
    GetShiftDecimal                 o o o o o o;
    GetShiftFraction                o o o o o o;
    SetIntervalDecimal              o o o o o o;
    SetIntervalFraction             o o o o o o;
    SetShiftDecimal                 o o o o o o;
    SetShiftFraction                o o o o o o;
    EnterEventMode                  o o o o o o;
    EnterStepMode                   o o o o o o;
    EvaluateDiscreteStates          o o o o o o;
    UpdateDiscreteStates            o o o o o o;
    EnterContinuousTimeMode         o o o o o o;
    CompletedIntegratorStep         o o o o o o;
    SetTime                         o o o o o o;
    SetContinuousStates             o o o o o o;
    GetContinuousStateDerivatives   o o o o o o;
    GetEventIndicators              o o o o o o;
    GetContinuousStates             o o o o o o;
    GetNominalsOfContinuousStates   o o o o o o;
    GetNumberOfEventIndicators      o o o o o o;
    GetNumberOfContinuousStates     o o o o o o;
    ActivateModelPartition          o o o o o o;
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
