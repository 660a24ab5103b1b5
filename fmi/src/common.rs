//! What both versions of FMI have in common: status, callbacks, and how each version spells things.

use std::ffi::{c_char, c_void};
use std::fmt;
use urdf2fmu_core::variables::Kind;

/// What a function returns: `fmi2Status` and `fmi3Status`, which agree in these numbers.
/// `fmi2Fatal`, `fmi3Fatal` and `fmi2Pending` are never returned: one instance cannot spoil
/// another, and every step is finished when the function returns.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// `fmi2OK`, `fmi3OK`
    OK = 0,
    /// `fmi2Warning`, `fmi3Warning`
    Warning = 1,
    /// `fmi2Discard`, `fmi3Discard`
    Discard = 2,
    /// `fmi2Error`, `fmi3Error`
    Error = 3,
}

/// The logger of FMI 2; variadic, the message is a printf format.
pub type LoggerOfFmi2 =
    unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char, ...);

/// The logger of FMI 3: environment, status, category, message.
pub type LoggerOfFmi3 = unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char);

/// The intermediate update of FMI 3: environment, time, whether inputs may be set, whether outputs
/// may be read, whether the step is accepted, whether it can return early; then whether it shall,
/// and when. Flags are bytes: 0 is false.
pub type IntermediateUpdate =
    unsafe extern "C" fn(*mut c_void, f64, u8, u8, u8, u8, *mut u8, *mut f64);

/// Version of FMI that an instance speaks. Displayed as the prefix of its functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Version {
    /// FMI 2.0
    V2 = 2,
    /// FMI 3.0
    V3 = 3,
}

/// Who integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interface {
    /// The FMU takes the steps.
    CoSimulation,
    /// The importer takes the steps.
    ModelExchange,
}

impl fmt::Display for Interface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CoSimulation => "co-simulation",
            Self::ModelExchange => "Model Exchange",
        })
    }
}

impl Version {
    /// The version with this number, as saved states hold it.
    pub(crate) fn from_number(number: u16) -> Option<Self> {
        [Self::V2, Self::V3]
            .into_iter()
            .find(|version| *version as u16 == number)
    }

    /// Name of a type of variables.
    pub(crate) fn name_of(self, kind: Kind) -> &'static str {
        match (self, kind) {
            (Self::V2, Kind::Real) => "Real",
            (Self::V2, Kind::Integer) => "Integer",
            (Self::V3, Kind::Real) => "Float64",
            (Self::V3, Kind::Integer) => "Int32",
            (_, Kind::Boolean) => "Boolean",
        }
    }

    /// Function that announces times and tolerance.
    pub(crate) fn setup(self) -> &'static str {
        match self {
            Self::V2 => "fmi2SetupExperiment",
            Self::V3 => "fmi3EnterInitializationMode",
        }
    }

    /// Function that continues from a saved state.
    pub(crate) fn set_state(self) -> &'static str {
        match self {
            Self::V2 => "fmi2SetFMUstate",
            Self::V3 => "fmi3SetFMUState",
        }
    }

    /// Argument with the folder of resources, and what to pass.
    pub(crate) fn location(self) -> (&'static str, &'static str) {
        match self {
            Self::V2 => (
                "fmuResourceLocation",
                "pass the URI of the unzipped FMU's folder 'resources', such as \
                 file:///C:/fmu/resources",
            ),
            Self::V3 => (
                "resourcePath",
                "pass the path of the unzipped FMU's folder 'resources', such as C:\\fmu\\resources\\",
            ),
        }
    }

    /// Argument that identifies the FMU.
    pub(crate) fn identity(self) -> &'static str {
        match self {
            Self::V2 => "fmuGUID",
            Self::V3 => "instantiationToken",
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::V2 => "fmi2",
            Self::V3 => "fmi3",
        })
    }
}
