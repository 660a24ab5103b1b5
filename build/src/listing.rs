//! The variables of an FMU as its file lists them, for people: FMI 3 has arrays where FMI 2 has
//! scalars. What every FMI 3 file has, `time`, is left out.

use crate::columns::Columns;
use crate::describe::{causality, variability};
use crate::info::{role, short, unit};
use serde_json::{Value, json};
use urdf2fmu_core::model::Model;
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::variables::{TableError, Variable, entries};

/// A scalar, or an array.
#[derive(Debug)]
pub struct Listed<'a> {
    /// FMI's number of it.
    pub value_reference: u32,
    /// As in the file.
    pub name: String,
    /// As in the file.
    pub description: String,
    /// Empty for a scalar; else number of elements, or of rows and columns.
    pub shape: Vec<u32>,
    /// The elements, which have one type, causality and variability.
    pub rows: Vec<&'a Variable>,
}

/// All of them, in the order of the file.
///
/// # Errors
/// [`TableError`] if the name of an array is that of another variable.
pub fn listed<'a>(
    fmi: FmiVersion,
    model: &Model,
    table: &'a [Variable],
) -> Result<Vec<Listed<'a>>, TableError> {
    match fmi {
        FmiVersion::V2 => Ok(table.iter().map(Listed::scalar).collect()),
        FmiVersion::V3 => {
            let entries = entries(model, table)?.into_iter();
            let listed = entries.map(|entry| Listed {
                value_reference: entry.value_reference,
                name: entry.name,
                description: entry.description,
                shape: entry.shape,
                rows: entry.rows.iter().map(|row| &table[*row as usize]).collect(),
            });
            Ok(listed.collect())
        }
    }
}

impl<'a> Listed<'a> {
    fn scalar(row: &'a Variable) -> Self {
        Self {
            value_reference: row.value_reference,
            name: row.name.clone(),
            description: row.description.clone(),
            shape: Vec::new(),
            rows: vec![row],
        }
    }

    /// What all elements share is that of the first one.
    pub fn first(&self) -> &'a Variable {
        self.rows[0]
    }

    /// `3`, `4 x 9`; empty for a scalar.
    pub fn size(&self) -> String {
        let sizes: Vec<String> = self.shape.iter().map(ToString::to_string).collect();
        sizes.join(" x ")
    }

    /// Start values of the elements; none where one has none.
    pub fn starts(&self) -> Option<Vec<f64>> {
        self.rows.iter().map(|row| row.start).collect()
    }

    /// A bound that holds for all elements.
    pub fn bound(&self, of: fn(&Variable) -> Option<f64>) -> Option<f64> {
        let bound = of(self.first());
        bound.filter(|_| self.rows.iter().all(|row| of(row) == bound))
    }

    /// The unit of all elements; empty where they have several, as in the file.
    pub fn unit(&self) -> &'static str {
        let first = self.first();
        let same = self.rows.iter().all(|row| row.unit == first.unit);
        if same { unit(first) } else { "" }
    }
}

/// A table for people.
pub fn text(listed: &[Listed]) -> String {
    let mut rows = Columns::new(&[
        "vr", "variable", "size", "kind", "start", "min", "max", "unit",
    ]);
    for v in listed {
        let optional = |x: Option<f64>| x.map_or_else(String::new, short);
        let starts = v.starts().unwrap_or_default().into_iter().map(short);
        rows.row([
            v.value_reference.to_string(),
            v.name.clone(),
            v.size(),
            role(v.first()),
            starts.collect::<Vec<_>>().join(" "),
            optional(v.bound(|row| row.min)),
            optional(v.bound(|row| row.max)),
            v.unit().to_owned(),
        ]);
    }
    rows.indented()
}

/// The same for other programs; numbers exact.
pub fn json(listed: &[Listed]) -> Value {
    listed.iter().map(variable).collect()
}

fn variable(v: &Listed) -> Value {
    let first = v.first();
    let mut value = json!({
        "name": v.name,
        "value_reference": v.value_reference,
        "causality": causality(first),
        "variability": variability(first),
        "type": format!("{:?}", first.kind),
        "unit": v.unit(),
        "start": first.start,
        "min": v.bound(|row| row.min),
        "max": v.bound(|row| row.max),
        "description": v.description,
    });
    if !v.shape.is_empty() {
        let elements: Vec<&str> = v.rows.iter().map(|row| row.name.as_str()).collect();
        value["start"] = json!(v.starts());
        value["dimensions"] = json!(v.shape);
        value["elements"] = json!(elements);
    }
    value
}
