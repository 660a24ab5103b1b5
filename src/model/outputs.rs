//! What the FMU shows, and by which interfaces it is run.

use super::{ActuatorId, LinkId, RootId, Sensor};
use serde::{Deserialize, Serialize};

/// What the FMU shows beyond what it always shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSelection {
    /// Flat variable names (`_` instead of `.`).
    pub flat_names: bool,
    /// What is an array in FMI 3.
    #[serde(default, skip_serializing_if = "Arrays::is_default")]
    pub arrays: Arrays,
    /// By which interfaces of FMI it can be run.
    #[serde(default, skip_serializing_if = "Interface::is_default")]
    pub interface: Interface,
    /// Links with a `contact.*` output.
    pub contacts: Vec<LinkId>,
    /// Whether these outputs include where the forces act.
    #[serde(default)]
    pub contact_points: bool,
    /// Two sides each with `pair.*` outputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<ContactPair>,
    /// Links with `link.*` outputs.
    pub links: Vec<LinkId>,
    /// Links with `ext.*` inputs.
    pub external_wrenches: Vec<LinkId>,
    /// What stands still and has a `surface.velocity` input.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conveyors: Vec<RootId>,
    /// What floats and has a base that moves as inputs say, whatever pushes it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub driven: Vec<RootId>,
    /// Actuators that share their inputs.
    pub groups: Vec<Group>,
    /// Sensors with `sensor.*` outputs.
    pub sensors: Vec<Sensor>,
}

/// What FMI 3 lists as arrays; FMI 2 has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Arrays {
    /// Vectors of outputs and parameters, and rays.
    #[default]
    Vectors,
    /// Nothing: every element is a variable, as in FMI 2.
    None,
    /// Vectors of inputs, too, and vectors over all joints.
    All,
}

impl Arrays {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Interfaces of FMI by which the FMU can be run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interface {
    /// Co-simulation: the FMU takes the steps.
    #[default]
    Cs,
    /// Model Exchange: the importer takes the steps, and the FMU computes derivatives.
    Me,
    /// Both.
    Both,
}

impl Interface {
    /// Whether continuous states and their derivatives are listed.
    pub fn exchanges(self) -> bool {
        self != Self::Cs
    }

    /// Whether it steps by itself.
    pub fn steps(self) -> bool {
        self != Self::Me
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Two sides whose contacts with each other are outputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactPair {
    /// In the names of its outputs.
    pub name: String,
    /// Links of the first side, whose force it is, and of the second one; none: the ground.
    /// Ascending, at least one, and none on both sides.
    pub sides: [Vec<Option<LinkId>>; 2],
}

/// Actuators that are told the same: they share the inputs, and the gains, of the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Takes the joint's place in the names of the inputs.
    pub name: String,
    /// Ascending, at least one; of one mode, all turning or all sliding, with equal start values.
    pub actuators: Vec<ActuatorId>,
}
