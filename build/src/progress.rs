//! One line about a simulation that runs, at a terminal only.

use crate::output::tell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Between two lines: quick enough to be seen moving, and no work to speak of.
const PAUSE: Duration = Duration::from_millis(100);

/// Columns of a terminal that does not tell.
const USUAL_WIDTH: usize = 80;

/// The line. It is there only where standard error is a terminal.
pub struct Progress {
    begun: Instant,
    /// When the next line is due; never without a terminal.
    due: Option<Instant>,
    /// Columns that the last line takes.
    shown: usize,
}

impl Progress {
    /// Begins with nothing shown: what ends at once needs no progress.
    ///
    /// - `wanted`: whether any is
    pub fn new(wanted: bool) -> Self {
        let begun = Instant::now();
        Self {
            begun,
            due: (wanted && std::io::stderr().is_terminal()).then(|| begun + PAUSE),
            shown: 0,
        }
    }

    /// Tells how far the simulation is, if it is time for that.
    ///
    /// - `time`, `start`, `stop`: s
    pub fn at(&mut self, time: f64, start: f64, stop: f64) {
        let now = Instant::now();
        if self.due.is_none_or(|due| now < due) {
            return;
        }
        self.due = Some(now + PAUSE);
        let speed = (time - start) / (now - self.begun).as_secs_f64();
        self.show(&line(time, start, stop, speed, width()));
    }

    /// Takes the line away.
    pub fn clear(&mut self) {
        self.show("");
        self.due = None;
    }

    /// Writes over the last line. Spaces and carriage returns work on every terminal.
    fn show(&mut self, line: &str) {
        if self.shown == 0 && line.is_empty() {
            return;
        }
        let length = line.chars().count();
        let rest = " ".repeat(self.shown.saturating_sub(length));
        let back = if line.is_empty() { "\r" } else { "" };
        // A terminal that is gone needs no progress; what matters is told elsewhere.
        if tell(&format!("\r{line}{rest}{back}")).is_err() {
            self.due = None;
        }
        self.shown = length;
    }
}

/// Columns that a line may take; in the last one some terminals begin a new line.
fn width() -> usize {
    #[cfg(unix)]
    let width = crate::process::terminal_width();
    #[cfg(not(unix))]
    let width: Option<usize> = None;
    width.unwrap_or(USUAL_WIDTH) - 1
}

/// The longest of several lines that fits; nothing if none does.
fn line(time: f64, start: f64, stop: f64, speed: f64, width: usize) -> String {
    // As many decimals as the run needs to be seen moving.
    let decimals = match stop - start {
        length if length < 0.1 => 4,
        length if length < 1.0 => 3,
        length if length < 10.0 => 2,
        _ => 1,
    };
    let share = format!("{:.0} %", 100.0 * (time - start) / (stop - start));
    let speed = times(speed);
    [
        format!("{time:.decimals$} of {stop} s  {share}  {speed} times real time"),
        format!("{time:.decimals$} s  {share}  {speed}×"),
        share,
    ]
    .into_iter()
    .find(|line| line.chars().count() <= width)
    .unwrap_or_default()
}

/// A ratio with about three digits.
pub fn times(ratio: f64) -> String {
    let decimals = match ratio {
        ratio if ratio < 1.0 => 3,
        ratio if ratio < 10.0 => 2,
        ratio if ratio < 100.0 => 1,
        _ => 0,
    };
    format!("{ratio:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_as_long_as_the_terminal_allows() {
        let at = |width| line(8.4, 0.0, 14.0, 120.4, width);
        assert_eq!(at(79), "8.4 of 14 s  60 %  120 times real time");
        assert_eq!(at(20), "8.4 s  60 %  120×");
        assert_eq!(at(5), "60 %");
        assert_eq!(at(3), "");
        assert_eq!(
            line(1.0, 1.0, 1.05, 0.0, 79),
            "1.0000 of 1.05 s  0 %  0.000 times real time"
        );
    }
}
