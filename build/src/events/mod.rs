//! Events of a run, as sentences: `simulate` prints them at its end, and the page of a report lists
//! them.
//!
//! In: a scene and columns of values, from any program. An event whose columns are missing is not
//! found. Out: events in the order of time; the same columns give the same sentences. `run` has the
//! columns, `posture` finds falls, `contact` looks at the ground, `joints` at limits of positions
//! and efforts. The definitions stand in `docs/see.md`.

mod contact;
mod joints;
mod posture;
mod run;

pub use run::{Event, moment};

use run::Run;
use std::collections::BTreeMap;
use urdf2fmu_drawing::scene::Scene;

/// Finds what happened.
///
/// - `time`: s, never decreasing
/// - `columns`: values of variables by their names; NaN where there is none
/// - `changed`: parameters and inputs that had other values than the FMU's
pub fn find(
    scene: &Scene,
    time: &[f64],
    columns: &[(String, Vec<f64>)],
    changed: &BTreeMap<String, f64>,
) -> Vec<Event> {
    let columns = columns
        .iter()
        .map(|(name, values)| (name.as_str(), values.as_slice()));
    let run = Run {
        head: &scene.head,
        time,
        columns: columns.collect(),
        changed,
    };
    let mut events = posture::falls(&run);
    events.extend(joints::limits(&run));
    events.extend(joints::efforts(&run));
    events.extend(contact::hardest(&run));
    events.extend(contact::ground(&run, scene));
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    events
}
