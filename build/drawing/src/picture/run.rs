//! The table of a run → poses of all links at equal steps of time.

use crate::scene::{Head, link_poses};
use std::collections::BTreeMap;
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

/// The poses of all links, one entry for each picture of a run; straight lines between its rows.
///
/// What has no column, or no value in one of the two rows, stays where it starts.
///
/// - `time`: of its rows, s, never decreasing
/// - `columns`: numbers with the names of the scene's variables, one in each row
/// - `rate`: pictures a second
///
/// # Errors
/// [`ShowError`].
pub fn poses(
    head: &Head,
    time: &[f64],
    columns: &[(String, Vec<f64>)],
    rate: f64,
) -> Result<Vec<Vec<Pose>>, ShowError> {
    let tracks = head.tracks().map(|track| track.variables.as_slice());
    let tracks: Vec<&[String]> = tracks.collect();
    let Some(example) = tracks.iter().copied().flatten().next() else {
        return Err(ShowError::Still);
    };
    let mut known: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (name, values) in columns {
        if tracks.iter().copied().flatten().any(|moved| moved == name) {
            known.insert(name, values.clone());
        }
    }
    let (Some(first), Some(last), false) = (time.first(), time.last(), known.is_empty()) else {
        let example = example.clone();
        return Err(ShowError::Foreign { example });
    };
    for names in tracks.iter().filter(|names| names.len() == 4) {
        turn_the_short_way(&mut known, names);
    }
    let seconds = last - first;
    let steps = (seconds * rate).floor();
    if steps >= MOST_PICTURES {
        return Err(ShowError::Long { seconds, rate });
    }
    let mut poses = Vec::new();
    let (mut after, mut step) = (0, 0.0);
    while step <= steps {
        let now = first + step / rate;
        while after + 1 < time.len() && time[after] <= now {
            after += 1;
        }
        let before = after.saturating_sub(1);
        let [a, b] = [before, after].map(|row| time[row]);
        let part = if b > a {
            ((now - a) / (b - a)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let value = |name: &str| {
            let column = known.get(name)?;
            // On a row, the other one does not matter, even if it has no value.
            Some(match part {
                0.0 => column[before],
                1.0 => column[after],
                _ => column[before] + (column[after] - column[before]) * part,
            })
        };
        poses.push(link_poses(head, value));
        step += 1.0;
    }
    Ok(poses)
}

/// A quaternion and its opposite are the same rotation: of the two the one is taken that is nearer
/// to that of the row before, so that the way between them is the short one.
fn turn_the_short_way(columns: &mut BTreeMap<&str, Vec<f64>>, names: &[String]) {
    let Some(first) = names.first().and_then(|name| columns.get(name.as_str())) else {
        return;
    };
    for row in 1..first.len() {
        let near = names.iter().map(|name| {
            let column = columns.get(name.as_str());
            column.map_or(0.0, |column| column[row - 1] * column[row])
        });
        if near.sum::<f64>() < 0.0 {
            for name in names {
                if let Some(column) = columns.get_mut(name.as_str()) {
                    column[row] = -column[row];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn about z by 40° in two rows, the second of which has the opposite quaternion: halfway
    /// it is one by 20°, and not one by 200°.
    #[test]
    fn between_two_quaternions_of_opposite_signs_the_short_way_is_taken() {
        let names = ["a", "b", "c", "d"].map(str::to_owned);
        let half = |degrees: f64| libm::sincos(0.5 * degrees.to_radians());
        let ((sin_a, cos_a), (sin_b, cos_b)) = (half(0.0), half(40.0));
        let mut columns = BTreeMap::from([
            ("a", vec![0.0, 0.0]),
            ("b", vec![0.0, 0.0]),
            ("c", vec![sin_a, -sin_b]),
            ("d", vec![cos_a, -cos_b]),
        ]);
        turn_the_short_way(&mut columns, &names);
        let middle = |name: &str| 0.5 * (columns[name][0] + columns[name][1]);
        let angle = 2.0 * libm::atan2(middle("c"), middle("d"));
        assert!((angle.to_degrees() - 20.0).abs() < 1e-9, "{angle}");
    }
}
