//! What the settings say of the FMU itself.

use crate::model::{Arrays, Interface};
use crate::pattern::Pattern;
use std::fmt;

/// What an FMU says of itself in modelDescription.xml.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FmuSettings {
    /// `modelName`; without it the robot's.
    pub name: Option<String>,
    /// `author`
    pub author: Option<String>,
    /// `version`
    pub version: Option<String>,
    /// `copyright`
    pub copyright: Option<String>,
    /// `license`
    pub license: Option<String>,
    /// End of the default experiment, s.
    pub stop_time: Option<f64>,
    /// Version of the standard.
    pub fmi: FmiVersion,
    /// Who integrates.
    pub interface: Interface,
    /// What is an array in FMI 3.
    pub arrays: Arrays,
    /// Names of the systems that the FMU has libraries for; without any, of all that there are.
    pub platforms: Vec<Pattern>,
    /// Without the pictures and pages that people look at.
    pub undocumented: bool,
    /// With what it gives in a run of two seconds.
    pub reference_run: bool,
}

/// Version of the Functional Mock-up Interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FmiVersion {
    /// 2.0
    #[default]
    V2,
    /// 3.0
    V3,
}

impl fmt::Display for FmiVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::V2 => "2.0",
            Self::V3 => "3.0",
        })
    }
}

impl FmiVersion {
    /// The major version.
    pub fn major(self) -> u8 {
        match self {
            Self::V2 => 2,
            Self::V3 => 3,
        }
    }
}
