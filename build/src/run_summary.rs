//! The summary that `simulate` prints at its end: time reached, speed, pose of the robot, events.

use crate::events::{Event, moment};
use crate::importer::run::Outcome;
use crate::progress::times;
use crate::summary::{rounded, wrap};
use std::fmt::Write as _;

/// Columns of a line of text.
const WIDTH: usize = 92;

/// A run that has ended.
#[derive(Debug)]
pub struct Ended<'r> {
    /// The robot's or the file's name.
    pub name: &'r str,
    /// All of it.
    pub outcome: &'r Outcome,
    /// What happened; `None` for an FMU without a scene, where it cannot be known.
    pub events: Option<&'r [Event]>,
}

/// A few lines of plain text.
///
/// - `timed`: whether to tell what the clock says; the rest is the same for each run
pub fn text(ended: &Ended, timed: bool) -> String {
    let outcome = ended.outcome;
    let last = outcome.table.rows.last();
    let reached = last.map_or(outcome.times.start, |row| row[0]);
    let simulated = reached - outcome.times.start;
    let length = outcome.times.stop - outcome.times.start;
    let mut out = format!("{}  {}", plain(ended.name), moment(simulated));
    if outcome.failure.is_some() {
        _ = write!(out, " of {}", moment(length));
    }
    let steps = outcome.took.len();
    let plural = if steps == 1 { "" } else { "s" };
    _ = write!(out, " in {steps} communication step{plural}");
    let took: f64 = outcome
        .took
        .iter()
        .map(std::time::Duration::as_secs_f64)
        .sum();
    if timed && simulated > 0.0 && took > 0.0 {
        _ = write!(out, ", {} times real time", times(simulated / took));
    }
    if outcome.failure.is_some() {
        out.push_str("; it ended early");
    }
    out.push('\n');
    if let Some(pose) = last.and_then(|row| pose(&outcome.table.names, row)) {
        _ = writeln!(out, "  ends at    {pose}");
    }
    match ended.events {
        Some([]) => out.push_str("  events     none\n"),
        Some(events) => out += &list(events),
        None => {}
    }
    out
}

/// Events, a line each; nothing without events.
pub fn list(events: &[Event]) -> String {
    let mut out = String::new();
    if !events.is_empty() {
        out.push_str("  events\n");
    }
    for event in events {
        let lines = wrap(&plain(&event.text), WIDTH);
        _ = writeln!(out, "    - {}", lines.join("\n      "));
    }
    out
}

/// A hint in lines.
pub fn hint(text: &str) -> String {
    format!(
        "  hint       {}\n",
        wrap(&plain(text), WIDTH - 9).join("\n             ")
    )
}

/// Text that cannot steer a terminal: names come from files.
fn plain(text: &str) -> String {
    text.replace(|c: char| c.is_control(), "\u{fffd}")
}

/// Position and attitude of a floating base; names may be flat.
fn pose(names: &[String], row: &[f64]) -> Option<String> {
    let value = |name: &str| {
        let flat = name.replace('.', "_");
        let place = names.iter().position(|n| *n == name || *n == flat)?;
        Some(row[place])
    };
    let position = |axis: &str| value(&format!("base.position.{axis}"));
    let angle = |axis: &str| value(&format!("base.rpy.{axis}")).map(f64::to_degrees);
    Some(format!(
        "x {} m, y {} m, z {} m; roll {}°, pitch {}°, yaw {}°",
        rounded(position("x")?, 3),
        rounded(position("y")?, 3),
        rounded(position("z")?, 3),
        rounded(angle("roll")?, 1),
        rounded(angle("pitch")?, 1),
        rounded(angle("yaw")?, 1),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_terminals_is_shown_as_text() {
        let event = Event {
            time: 0.0,
            text: "Joint '\u{1b}[2J関節' moved.".to_owned(),
        };
        assert_eq!(
            list(&[event]),
            "  events\n    - Joint '\u{fffd}[2J関節' moved.\n"
        );
    }

    #[test]
    fn poses_have_no_negative_zero_and_flat_names_will_do() {
        let names = [
            "time",
            "base_position_x",
            "base_position_y",
            "base_position_z",
        ];
        let names = names
            .into_iter()
            .chain(["base_rpy_roll", "base_rpy_pitch", "base_rpy_yaw"]);
        let names: Vec<String> = names.map(str::to_owned).collect();
        let row = [1.0, -0.0001, 2.0, -0.5, 0.0, -1e-9, -1.0];
        assert_eq!(
            pose(&names, &row).as_deref(),
            Some("x 0.000 m, y 2.000 m, z -0.500 m; roll 0.0°, pitch 0.0°, yaw -57.3°")
        );
        assert_eq!(pose(&names[..4], &row), None);
    }
}
