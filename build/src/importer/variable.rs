//! A variable as an importer sees it: a scalar, or an element of an array.

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// As written.
    pub name: String,
    /// Handle: the value reference in FMI 2, the place among the elements of
    /// all variables in FMI 3.
    pub value_reference: u32,
    /// Type.
    pub kind: Kind,
    /// Causality, as written; `local` where nothing is.
    pub causality: String,
    /// Variability, as written; `continuous` where nothing is.
    pub variability: String,
    /// `initial`, as written.
    pub initial: String,
    /// FMI's name of the unit; empty where none is written at the variable.
    pub unit: String,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `Real`, `Float64`
    Real,
    /// `Integer` and `Enumeration`, `Int32`
    Integer,
    /// `Boolean`
    Boolean,
    /// `String`, and other types of FMI 3: not simulated.
    Text,
}

impl Variable {
    /// Whether it is roll, pitch or yaw, under names with points or flat ones, in rad.
    pub fn is_attitude(&self) -> bool {
        self.unit == "rad" && self.name.split(['.', '_', '[']).any(|part| part == "rpy")
    }

    /// Whether it is an input.
    pub fn is_input(&self) -> bool {
        self.causality == "input"
    }

    /// Whether it may be set before or during initialisation.
    pub fn can_start(&self) -> bool {
        self.is_input()
            || self.variability != "constant" && matches!(self.initial.as_str(), "exact" | "approx")
            || self.causality == "parameter"
    }
}
