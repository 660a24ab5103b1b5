//! What a scene tells beside shapes: variables in the words of FMI, and findings.

use crate::describe::{causality, variability};
use crate::documentation::Remark;
use crate::units;
use urdf2fmu_core::variables::{Kind, Unit, Variable};
use urdf2fmu_drawing::scene;

/// A row of the table of variables.
pub(super) fn variable(row: &Variable) -> scene::Variable {
    scene::Variable {
        name: row.name.clone(),
        reference: row.value_reference,
        causality: causality(row).to_owned(),
        variability: variability(row).to_owned(),
        kind: match row.kind {
            Kind::Real => "real",
            Kind::Integer => "integer",
            Kind::Boolean => "boolean",
        }
        .to_owned(),
        unit: match row.unit {
            Unit::One => "",
            unit => units::facts(unit).name,
        }
        .to_owned(),
        description: row.description.clone(),
        start: row.start,
        min: row.min,
        max: row.max,
    }
}

/// A finding.
pub(super) fn note(remark: &Remark) -> scene::Note {
    scene::Note {
        severity: remark.severity.to_string(),
        code: remark.code.to_owned(),
        message: remark.message.clone(),
        help: remark.help.clone().unwrap_or_default(),
        place: remark.place.clone().unwrap_or_default(),
    }
}
