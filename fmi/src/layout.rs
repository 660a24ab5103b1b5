//! From value references to rows of the table of variables.
//!
//! In FMI 2 each row is a variable. In FMI 3 a variable may have several rows, its elements, and
//! there is the independent variable.

use crate::common::Version;
use crate::error::FmiError;
use std::ops::Range;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::variables::{Kind, TableError, Variable, entries, time_reference};

/// A variable as the importer sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Its number among all variables.
    pub(crate) number: u32,
    /// Its type, which all its elements have.
    pub(crate) kind: Kind,
    first: u32,
    /// Number of elements; 0 for a value reference that is no variable.
    len: u32,
}

impl Place {
    /// Where its elements are in the list of all variables' elements.
    pub(crate) fn elements(self) -> Range<usize> {
        self.first as usize..(self.first + self.len) as usize
    }

    /// Number of its elements.
    pub(crate) fn len(self) -> usize {
        self.len as usize
    }
}

/// All variables by value reference.
#[derive(Debug)]
pub(crate) struct Layout {
    version: Version,
    /// By value reference.
    places: Vec<Place>,
    /// As in modelDescription.xml, by number.
    names: Vec<String>,
    /// Rows of all variables' elements; the number of rows stands for time.
    rows: Vec<u32>,
}

const NOWHERE: Place = Place {
    number: 0,
    kind: Kind::Real,
    first: 0,
    len: 0,
};

impl Layout {
    /// That of one version.
    ///
    /// # Errors
    /// [`TableError`] if names clash.
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn new(
        version: Version,
        model: &Model,
        table: &[Variable],
    ) -> Result<Self, TableError> {
        let mut layout = Self {
            version,
            places: Vec::with_capacity(table.len() + 1),
            names: Vec::with_capacity(table.len() + 1),
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

    #[cfg_attr(small, optimize(size))]
    fn add(&mut self, name: &str, kind: Kind, reference: u32, rows: &[u32]) {
        let number = |n: usize| u32::try_from(n).expect("a robot has fewer than 2^32 variables");
        let reference = reference as usize;
        if self.places.len() <= reference {
            self.places.resize(reference + 1, NOWHERE);
        }
        self.places[reference] = Place {
            number: number(self.names.len()),
            kind,
            first: number(self.rows.len()),
            len: number(rows.len()),
        };
        self.rows.extend(rows);
        self.names.push(name.to_owned());
    }

    /// Number of variables.
    pub(crate) fn len(&self) -> usize {
        self.names.len()
    }

    /// The variable behind a value reference; without elements if there is none.
    #[inline]
    pub(crate) fn find(&self, reference: u32) -> Place {
        let place = self.places.get(reference as usize);
        place.copied().unwrap_or(NOWHERE)
    }

    /// Name of a variable.
    pub(crate) fn name(&self, place: Place) -> &str {
        &self.names[place.number as usize]
    }

    /// Rows of all elements, one variable after the other.
    pub(crate) fn all_rows(&self) -> &[u32] {
        &self.rows
    }

    /// Rows of a variable.
    #[inline]
    pub(crate) fn rows(&self, place: Place) -> &[u32] {
        &self.rows[place.elements()]
    }

    /// The variable behind a value reference, if it has the type asked for.
    #[inline]
    pub(crate) fn of_kind(&self, reference: u32, kind: Kind) -> Result<Place, FmiError> {
        let place = self.find(reference);
        if place.len > 0 && place.kind == kind {
            Ok(place)
        } else {
            Err(self.wrong(reference, self.version.name_of(kind)))
        }
    }

    /// Why a value reference is no variable of the type asked for.
    #[cold]
    #[cfg_attr(small, optimize(size))]
    pub(crate) fn wrong(&self, value_reference: u32, asked: &'static str) -> FmiError {
        let place = self.find(value_reference);
        if place.len > 0 {
            return FmiError::Kind {
                name: self.name(place).to_owned(),
                value_reference,
                is: self.version.name_of(place.kind),
                asked,
            };
        }
        let mut wholes = self.places.iter().filter(|place| place.len > 0);
        match wholes.find(|place| self.rows(**place).contains(&value_reference)) {
            Some(whole) => FmiError::Element {
                value_reference,
                name: self.name(*whole).to_owned(),
            },
            None => FmiError::ValueReference {
                value_reference,
                count: self.places.len(),
            },
        }
    }
}
