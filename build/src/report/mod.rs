//! A report: one page that plays a run and plots its variables.
//!
//! In: a scene and a table of values, from any program. Out: the page, notes about the table, and
//! the events of the run; the page's Notes contain both. `encode` packs columns.

mod encode;

use crate::events::{self, Event};
use crate::page;
use crate::results::Table;
use std::collections::BTreeMap;
use urdf2fmu_drawing::scene::Scene;

/// Numbers of a run, beyond which rows are left out: the page would be larger than mail takes.
const MOST_NUMBERS: usize = 12_000_000;

/// A page and what was found on the way.
#[derive(Debug)]
pub struct Report {
    /// The file's content.
    pub html: String,
    /// Sentences about the table.
    pub notes: Vec<String>,
    /// Why the table may be of another robot.
    pub doubt: Option<String>,
    /// What happened in the run.
    pub events: Vec<Event>,
}

/// Makes a report.
///
/// - `packed`: the scene as bytes
/// - `table`: with the names of the scene's variables
/// - `changed`: parameters and inputs that the run had other values of
pub fn make(scene: &Scene, packed: &[u8], table: Table, changed: &BTreeMap<String, f64>) -> Report {
    let Table {
        mut time,
        mut columns,
        mut notes,
        doubt,
        ..
    } = table;
    notes.extend(forces_without_columns(scene, &columns));
    let events = events::find(scene, &time, &columns, changed);
    let rows = time.len();
    let stride = (rows * (columns.len() + 1)).div_ceil(MOST_NUMBERS).max(1);
    if stride > 1 {
        let thin = |values: &mut Vec<f64>| {
            let mut row = 0;
            values.retain(|_| {
                row += 1;
                (row - 1) % stride == 0 || row == rows
            });
        };
        thin(&mut time);
        for (_, values) in &mut columns {
            thin(values);
        }
        notes.push(left_out(rows, stride));
    }
    let happened = events.iter().map(|event| &event.text);
    let said: Vec<&String> = happened.chain(&doubt).chain(&notes).collect();
    let run = encode::run(scene, &time, &columns, &said, changed);
    Report {
        html: page::html(&scene.head.robot, packed, Some(&run), "'none'"),
        notes,
        doubt,
        events,
    }
}

/// What is said of a run that is too long for a page.
fn left_out(rows: usize, stride: usize) -> String {
    format!("The run has {rows} rows; to keep the page small it shows one in {stride}.")
}

/// Says how many contact forces cannot be shown.
fn forces_without_columns(scene: &Scene, columns: &[(String, Vec<f64>)]) -> Option<String> {
    let lacks = |name: &String| !columns.iter().any(|(column, _)| column == name);
    let contacts = scene.head.contacts.iter();
    match contacts.filter(|c| c.force.iter().any(lacks)).count() {
        0 => None,
        n => Some(format!(
            "The contact forces of {n} {} are not shown: their columns are missing.",
            if n == 1 { "link" } else { "links" }
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ordinal numbers would need an ending for each of 2, 3 and 4.
    #[test]
    fn rows_that_are_left_out_are_told_as_a_share() {
        let told = left_out(700_000, 2);
        assert!(told.ends_with("it shows one in 2."), "{told}");
    }
}
