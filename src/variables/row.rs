//! A row of the table of variables.

use crate::model::StateId;
use crate::slots::{InputSlot, OutputSlot, ParameterSlot};

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Structured name, or the flat one where the model asks for it.
    pub name: String,
    /// FMI value reference; equals the position in the table, unique across types.
    pub value_reference: u32,
    /// Says whose quantity it is, in the URDF's own names.
    pub description: String,
    /// Causality, and where the value lives.
    pub slot: Slot,
    /// FMI type.
    pub kind: Kind,
    /// Whether it changes in steps; integers and flags do anyway.
    pub stepped: bool,
    /// Value at the start for inputs and parameters.
    pub start: Option<f64>,
    /// Allowed range for inputs and parameters, where there is one.
    pub min: Option<f64>,
    /// See `min`.
    pub max: Option<f64>,
    /// Unit.
    pub unit: Unit,
    /// The vector or matrix that it is an element of, if any.
    pub part: Option<Part>,
    /// The continuous state that it is, if any.
    pub state: Option<StateId>,
    /// The unit that people read it in, where it is another one.
    pub display: Option<Display>,
    /// Size of the values to expect, in the unit, where it is known and not 1.
    pub nominal: Option<f64>,
}

impl Variable {
    /// Whose the value is, in FMI's terms.
    pub fn causality(&self) -> Causality {
        match self.slot {
            Slot::Input(_) => Causality::Input,
            Slot::Parameter(_) => Causality::Parameter,
            Slot::Output(slot) if slot.local() => Causality::Local,
            Slot::Output(_) => Causality::Output,
        }
    }

    /// Whether an importer of FMI 3 may ask for it within a step. By the standard only continuous
    /// variables may be asked for; flags and held samples are answered, too, because there are
    /// importers, fmusim for one, that record all outputs there.
    pub fn within_steps(&self) -> bool {
        matches!(self.causality(), Causality::Input | Causality::Output)
    }
}

/// Whose a value is, in FMI's terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Of whoever drives the robot.
    Input,
    /// Of the user, before the start or now and then.
    Parameter,
    /// Of the robot.
    Output,
    /// Of the robot, and nothing that another model is connected to.
    Local,
}

/// Place of a variable in a vector or matrix, whose elements follow each other in the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the whole.
    pub whole: String,
    /// What the whole is, without the element.
    pub description: String,
    /// Place among the elements, rows before columns.
    pub index: u32,
    /// Number of elements, or of rows and columns.
    pub shape: Vec<u32>,
}

/// Where a variable's value lives; gives its causality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// `causality="input"`
    Input(InputSlot),
    /// `causality="parameter"`; tunable or fixed by [`ParameterSlot::tunable`].
    Parameter(ParameterSlot),
    /// `causality="output"`, or `"local"` by [`OutputSlot::local`].
    Output(OutputSlot),
}

/// FMI type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `<Real>`
    Real,
    /// `<Integer>`
    Integer,
    /// `<Boolean>`
    Boolean,
}

/// Units in use. Their names and exponents are FMI's business, see the packager.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Unit {
    One,
    Meter,
    Radian,
    Second,
    Kilogram,
    MeterPerSecond,
    RadianPerSecond,
    MeterPerSecondSquared,
    RadianPerSecondSquared,
    Newton,
    NewtonMeter,
    NewtonPerMeter,
    NewtonMeterPerRadian,
    NewtonSecondPerMeter,
    NewtonMeterSecondPerRadian,
    Joule,
    PerSecond,
}

/// Units that people read. Their names and factors are FMI's business, see the packager.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// Of angles.
    Degree,
    /// Of angular velocities.
    DegreePerSecond,
    /// Of what turns without end: wheels, propellers.
    TurnPerMinute,
}

impl Unit {
    /// That of the derivative of a continuous state in this unit.
    #[must_use]
    pub fn rate(self) -> Self {
        match self {
            Self::Meter => Self::MeterPerSecond,
            Self::Radian => Self::RadianPerSecond,
            Self::MeterPerSecond => Self::MeterPerSecondSquared,
            Self::RadianPerSecond => Self::RadianPerSecondSquared,
            _ => Self::PerSecond,
        }
    }

    /// What people read quantities of this unit in.
    pub fn display(self) -> Option<Display> {
        match self {
            Self::Radian => Some(Display::Degree),
            Self::RadianPerSecond => Some(Display::DegreePerSecond),
            _ => None,
        }
    }
}

/// Why a table cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Two URDF names become one variable name.
    #[error(
        "{first} and {second} both become the variable '{name}'; rename one of them in the URDF"
    )]
    Clash {
        /// Whose variable, with the URDF's name.
        first: String,
        /// Whose variable, with the URDF's name.
        second: String,
        /// Variable name
        name: String,
    },
}
