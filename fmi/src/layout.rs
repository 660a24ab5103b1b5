//! From value references to rows of the table of variables.
//!
//! In FMI 2 each row is a variable. In FMI 3 a variable may have several rows, its elements, and
//! there is the independent variable.

use crate::common::Version;
use crate::error::FmiError;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::variables::{Kind, TableError, Variable, entries, time_reference};

/// A variable as the importer sees it.
#[derive(Debug)]
pub(crate) struct Place {
    /// As in modelDescription.xml.
    pub(crate) name: String,
    /// Its type, which all its elements have.
    pub(crate) kind: Kind,
    first: usize,
    end: usize,
}

/// All variables by value reference.
#[derive(Debug)]
pub(crate) struct Layout {
    version: Version,
    /// Per value reference the index of its variable, or [`NONE`].
    index: Vec<u32>,
    places: Vec<Place>,
    /// Rows of all variables, one after the other; the number of rows stands for time.
    rows: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Layout {
    /// That of one version.
    ///
    /// # Errors
    /// [`TableError`] if names clash.
    pub(crate) fn new(
        version: Version,
        model: &Model,
        table: &[Variable],
    ) -> Result<Self, TableError> {
        let mut layout = Self {
            version,
            index: Vec::with_capacity(table.len() + 1),
            places: Vec::with_capacity(table.len() + 1),
            rows: Vec::with_capacity(table.len() + 1),
        };
        if version == Version::V2 {
            for row in table {
                let reference = row.value_reference;
                layout.add(&row.name, row.kind, reference, &[reference]);
            }
            return Ok(layout);
        }
        let time = time_reference(table);
        layout.add("time", Kind::Real, time, &[time]);
        for entry in entries(model, table)? {
            let kind = table[entry.rows[0] as usize].kind;
            layout.add(&entry.name, kind, entry.value_reference, &entry.rows);
        }
        Ok(layout)
    }

    fn add(&mut self, name: &str, kind: Kind, reference: u32, rows: &[u32]) {
        let reference = reference as usize;
        if self.index.len() <= reference {
            self.index.resize(reference + 1, NONE);
        }
        self.index[reference] = u32::try_from(self.places.len()).unwrap_or(NONE);
        let first = self.rows.len();
        self.rows.extend(rows);
        self.places.push(Place {
            name: name.to_owned(),
            kind,
            first,
            end: self.rows.len(),
        });
    }

    /// Number of variables.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Index of the variable behind a value reference, if there is one.
    pub(crate) fn find(&self, reference: u32) -> Option<usize> {
        let index = *self.index.get(reference as usize)?;
        (index != NONE).then_some(index as usize)
    }

    /// The variable of an index from [`Self::find`].
    pub(crate) fn place(&self, index: usize) -> &Place {
        &self.places[index]
    }

    /// Its rows.
    pub(crate) fn rows(&self, place: &Place) -> &[u32] {
        &self.rows[place.first..place.end]
    }

    /// The variable behind a value reference, if it has the type asked for, with its index.
    pub(crate) fn of_kind(&self, reference: u32, kind: Kind) -> Result<(usize, &Place), FmiError> {
        match self.find(reference) {
            Some(index) if self.places[index].kind == kind => Ok((index, &self.places[index])),
            _ => Err(self.wrong(reference, self.version.name_of(kind))),
        }
    }

    /// Why a value reference is no variable of the type asked for.
    pub(crate) fn wrong(&self, value_reference: u32, asked: &'static str) -> FmiError {
        if let Some(index) = self.find(value_reference) {
            let place = &self.places[index];
            return FmiError::Kind {
                name: place.name.clone(),
                value_reference,
                is: self.version.name_of(place.kind),
                asked,
            };
        }
        let mut wholes = self.places.iter();
        match wholes.find(|place| self.rows(place).contains(&value_reference)) {
            Some(whole) => FmiError::Element {
                value_reference,
                name: whole.name.clone(),
            },
            None => FmiError::ValueReference {
                value_reference,
                count: self.index.len(),
            },
        }
    }
}
