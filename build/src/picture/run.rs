//! The table of a run → poses of all links at equal steps of time.

use crate::importer::csv::Table;
use crate::scene::{Head, link_poses};
use std::collections::HashMap;
use urdf2fmu_core::spatial::Pose;

/// Most pictures of an animation.
const MOST_PICTURES: f64 = 1200.0;

/// Why a run cannot be shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShowError {
    /// No column moves anything.
    #[error(
        "no column says where this robot is: is it a run of this robot? One of them should be '{example}'"
    )]
    Foreign {
        /// A name that would do.
        example: String,
    },
    /// A robot without moving parts.
    #[error("nothing of this robot can move, so there is no run to show")]
    Still,
    /// Very many pictures.
    #[error(
        "{seconds} s of run at {rate} pictures a second are more than {MOST_PICTURES} pictures; give a lower --rate"
    )]
    Long {
        /// s
        seconds: f64,
        /// 1/s
        rate: f64,
    },
}

/// A run as it is shown.
#[derive(Debug)]
pub struct Shown {
    /// Poses of all links, one entry for each picture.
    pub poses: Vec<Vec<Pose>>,
    /// Outputs that would move the robot and have no column.
    pub missing: Vec<String>,
}

/// The poses of a run; straight lines between its rows.
///
/// Columns are found by the names of the outputs, or by these with `_` for `.`, as tools write them
/// that know no dots. What has no column stays where it starts.
///
/// - `rate`: pictures a second
///
/// # Errors
/// [`ShowError`].
pub fn poses(head: &Head, table: &Table, rate: f64) -> Result<Shown, ShowError> {
    let motions = head.joints.iter().flat_map(|joint| &joint.motions);
    let tracks = [&head.base.position, &head.base.orientation].into_iter();
    let tracks = tracks.chain(motions.map(|motion| &motion.track));
    let names: Vec<&String> = tracks.flat_map(|track| &track.variables).collect();
    let column_of: HashMap<&str, usize> = table
        .names
        .iter()
        .enumerate()
        .map(|(i, name)| (name.as_str(), i))
        .collect();
    let mut columns = HashMap::new();
    let mut missing = Vec::new();
    for name in &names {
        let flat = name.replace('.', "_");
        match column_of
            .get(name.as_str())
            .or_else(|| column_of.get(flat.as_str()))
        {
            Some(&column) => _ = columns.insert(name.as_str(), column),
            None => missing.push((*name).clone()),
        }
    }
    let Some(example) = names.first() else {
        return Err(ShowError::Still);
    };
    let (Some(first), Some(last), false) =
        (table.rows.first(), table.rows.last(), columns.is_empty())
    else {
        let example = (*example).clone();
        return Err(ShowError::Foreign { example });
    };
    let seconds = last[0] - first[0];
    let steps = (seconds * rate).floor();
    if steps >= MOST_PICTURES {
        return Err(ShowError::Long { seconds, rate });
    }
    let mut poses = Vec::new();
    let (mut after, mut step) = (0, 0.0);
    while step <= steps {
        let time = first[0] + step / rate;
        while after + 1 < table.rows.len() && table.rows[after][0] <= time {
            after += 1;
        }
        let (a, b) = (&table.rows[after.saturating_sub(1)], &table.rows[after]);
        let part = if b[0] > a[0] {
            ((time - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let value = |name: &str| {
            let &column = columns.get(name)?;
            Some(a[column] + (b[column] - a[column]) * part)
        };
        poses.push(link_poses(head, value));
        step += 1.0;
    }
    Ok(Shown { poses, missing })
}
