//! Inputs between the rows of a table: linear for Real inputs, in steps for everything else.
//!
//! Before the first row and after the last row the values are constant. Two rows at one time are a
//! jump: a step of the simulation ends there, and the second row applies.

use super::csv::{Names, Table};
use super::variable::{Kind, Variable};
use std::path::{Path, PathBuf};
use urdf2fmu_core::clock;
use urdf2fmu_core::digits::Digits;

/// Milliseconds in a second. A table in ms that is at least half as long as the run seems so many
/// times longer.
const MILLI: f64 = 1000.0;

/// A column of the table and the variable that it is for.
#[derive(Clone, Debug)]
pub struct Signal {
    /// The variable.
    pub variable: Variable,
    /// Column of the table.
    pub column: usize,
}

impl Signal {
    /// Whether it goes straight from row to row; else it is constant in between.
    pub fn is_continuous(&self) -> bool {
        self.variable.kind == Kind::Real
            && !matches!(self.variable.variability.as_str(), "discrete" | "tunable")
    }
}

/// Signals over time.
#[derive(Clone, Debug)]
pub struct Signals {
    /// One per column but `time`.
    pub list: Vec<Signal>,
    table: Table,
    /// Times at which a step must end.
    events: Vec<f64>,
    /// How far apart, s, a time and that of a row may lie that are taken for the same.
    allowed: f64,
    /// The file, and where its columns and rows stand.
    file: Option<(PathBuf, Names)>,
}

impl Signals {
    /// `list` names the columns of `table` that are used; times that differ by at most `allowed`,
    /// s, beside their round-off, are taken for the same.
    pub fn new(table: Table, list: Vec<Signal>, allowed: f64) -> Self {
        let mut events = Vec::new();
        for pair in table.rows.windows(2) {
            let jump = pair[0][0].to_bits() == pair[1][0].to_bits();
            let switched = list
                .iter()
                .filter(|signal| !signal.is_continuous())
                .any(|signal| pair[0][signal.column].to_bits() != pair[1][signal.column].to_bits());
            if jump || switched {
                events.push(pair[1][0]);
            }
        }
        Self {
            list,
            table,
            events,
            allowed,
            file: None,
        }
    }

    /// The same, read from a file.
    pub fn of_file(self, path: &Path, names: Names) -> Self {
        let file = Some((path.to_owned(), names));
        Self { file, ..self }
    }

    /// Where the value stands that an FMU has refused at `time`, as file, line and column: of the
    /// variable that it has named in quotes, in the row from which or towards which the value went.
    pub fn place_of(&self, said: &str, time: f64) -> Option<String> {
        let (path, names) = self.file.as_ref()?;
        let named = |signal: &&Signal| said.contains(&format!("'{}'", signal.variable.name));
        let signal = self.list.iter().find(named)?;
        let (next, ..) = self.around(signal, time);
        let row = match self.current(time) {
            Some(row) if !signal.is_continuous() => row,
            _ => next.min(self.table.rows.len() - 1),
        };
        let (line, column) = (names.rows.get(row)?, names.columns.get(signal.column)?);
        let path = path.display();
        Some(format!("'{path}', line {line}, column {column}"))
    }

    /// What to tell of a table whose times miss those of the run, or hold it many times: nearly
    /// always they are of another clock or in another unit.
    pub fn misses(&self, start: f64, stop: f64) -> Option<String> {
        let rows = &self.table.rows;
        let (first, last) = (rows.first()?[0], rows.last()?[0]);
        let run = format!("the run from {} s to {} s", Digits(start), Digits(stop));
        #[expect(clippy::float_cmp, reason = "one time, or several")]
        let one = first == last;
        if one || self.list.is_empty() {
            // Values for all times: of several rows of one time the last one.
            None
        } else if first >= stop || last <= start {
            let (kept, end) = if first >= stop {
                ("first", format!("begins at {} s, after", Digits(first)))
            } else {
                ("last", format!("ends at {} s, before", Digits(last)))
            };
            let later = Digits(first + (stop - start));
            Some(format!(
                "the table of inputs {end} {run}, so that each input keeps its {kept} value: times \
                 are in s of the simulation. Subtract {0} from all of them, or simulate with \
                 --start-time {0} --stop-time {later}",
                Digits(first)
            ))
        } else if last - start >= 0.5 * MILLI * (stop - start) {
            Some(format!(
                "the table of inputs ends at {} s, long after {run}: times are in s. If these are in \
                 ms, divide them by 1000",
                Digits(last)
            ))
        } else {
            None
        }
    }

    fn is_same(&self, a: f64, b: f64) -> bool {
        clock::is_same(a, b, self.allowed)
    }

    /// The next time after `time` at which a step must end.
    pub fn next_event(&self, time: f64) -> f64 {
        let later = self.events.iter().copied();
        later
            .filter(|&event| event > time && !self.is_same(event, time))
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether something jumps at `time`.
    pub fn jumps_at(&self, time: f64) -> bool {
        self.events.iter().any(|&event| self.is_same(event, time))
    }

    /// Value of a signal at `time`; at a jump the one before it.
    pub fn value_before(&self, signal: &Signal, time: f64) -> f64 {
        let (right, t, value) = self.around(signal, time);
        let last = self.table.rows.len() - 1;
        if right > last {
            value(last)
        } else if right == 0 {
            value(0)
        } else {
            let before = (t(right) - time) / (t(right) - t(right - 1));
            before * value(right - 1) + (1.0 - before) * value(right)
        }
    }

    /// Value of a signal at `time`; at a jump the one after it.
    pub fn value(&self, signal: &Signal, time: f64) -> f64 {
        let (right, t, value) = self.around(signal, time);
        let last = self.table.rows.len() - 1;
        if right > last {
            return value(last);
        }
        let current = self.current(time);
        let jump = current.is_some_and(|row| {
            row > 0 && clock::is_same(t(row - 1), t(row), 0.0) && self.is_same(time, t(row))
        });
        match current {
            None => value(0),
            Some(row) if jump || !signal.is_continuous() => value(row),
            Some(_) if right == 0 => value(0),
            Some(_) => {
                let left = right - 1;
                // The weights as FMPy has them: bits agree.
                let before = (t(right) - time) / (t(right) - t(left));
                let after = 1.0 - before;
                before * value(left) + after * value(right)
            }
        }
    }

    /// Slope of a signal after `time`.
    pub fn slope(&self, signal: &Signal, time: f64) -> f64 {
        let (_, t, value) = self.around(signal, time);
        let last = self.table.rows.len() - 1;
        match self.current(time) {
            Some(row) if row < last && signal.is_continuous() => {
                (value(row + 1) - value(row)) / (t(row + 1) - t(row))
            }
            _ => 0.0,
        }
    }

    /// The first row at or after `time`; times and values of rows.
    fn around(
        &self,
        signal: &Signal,
        time: f64,
    ) -> (usize, impl Fn(usize) -> f64, impl Fn(usize) -> f64) {
        let rows = &self.table.rows;
        let column = signal.column;
        (
            rows.partition_point(|row| row[0] < time),
            |row: usize| rows[row][0],
            move |row: usize| rows[row][column],
        )
    }

    /// The last row that counts at `time`; none before the first.
    fn current(&self, time: f64) -> Option<usize> {
        let rows = &self.table.rows;
        let begun = rows.partition_point(|row| row[0] <= time || self.is_same(row[0], time));
        begun.checked_sub(1)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "values of rows are exact")]
mod tests {
    use super::*;

    /// Between the rows a value goes towards the next one; at a row it is that of the row.
    #[test]
    fn a_value_that_is_refused_has_the_place_of_its_row() {
        let text = "time,v,u\n\n0,0,1\n1,0,2\n\n2,0,-5\n";
        for (variability, time, line) in [
            ("continuous", 0.0, 3),
            ("continuous", 0.5, 4),
            ("continuous", 1.0, 4),
            ("continuous", 1.7, 6),
            ("continuous", 3.0, 6),
            ("discrete", 1.7, 4),
            ("discrete", 2.0, 6),
        ] {
            let (table, names) = Table::parse(text, |_| None).expect("legal");
            let signal = Signal {
                column: 2,
                ..signals(text, variability).list.remove(0)
            };
            let signals = Signals::new(table, vec![signal], 1e-9);
            let signals = signals.of_file(Path::new("in.csv"), names);
            let place = signals.place_of("variable 'u' must be above 0", time);
            let expected = format!("'in.csv', line {line}, column 3");
            assert_eq!(place, Some(expected), "{variability} {time}");
            assert_eq!(
                signals.place_of("variable 'uv' must be above 0", time),
                None
            );
        }
    }

    fn signals(text: &str, variability: &str) -> Signals {
        let (table, _) = Table::parse(text, |_| None).expect("legal");
        let variable = Variable {
            name: "u".into(),
            value_reference: 0,
            kind: Kind::Real,
            causality: "input".into(),
            variability: variability.into(),
            initial: String::new(),
            unit: String::new(),
        };
        let signal = Signal {
            variable,
            column: 1,
        };
        Signals::new(table, vec![signal], 1e-9)
    }

    #[test]
    fn real_inputs_are_linear_between_rows_and_constant_outside() {
        let s = signals("time,u\n1,10\n2,20\n4,0", "continuous");
        let at = |time| (s.value(&s.list[0], time), s.slope(&s.list[0], time));
        assert_eq!(at(0.0), (10.0, 0.0));
        assert_eq!(at(1.0), (10.0, 10.0));
        assert_eq!(at(1.5), (15.0, 10.0));
        assert_eq!(at(2.0), (20.0, -10.0));
        assert_eq!(at(3.0), (10.0, -10.0));
        assert_eq!(at(9.0), (0.0, 0.0));
        assert_eq!(s.next_event(0.0), f64::INFINITY);
    }

    #[test]
    fn a_step_ends_at_a_jump_and_uses_the_value_after_it() {
        let s = signals("time,u\n0,0\n1,0\n1,5\n2,7", "continuous");
        let at = |time| (s.value(&s.list[0], time), s.slope(&s.list[0], time));
        assert_eq!(at(1.0), (5.0, 2.0));
        assert_eq!(at(0.5), (0.0, 0.0));
        let before = |time| s.value_before(&s.list[0], time);
        assert_eq!(
            (before(0.0), before(1.0), before(1.5), before(3.0)),
            (0.0, 0.0, 6.0, 7.0)
        );
        assert!(s.jumps_at(1.0) && !s.jumps_at(1.5));
        assert_eq!(s.next_event(0.2), 1.0);
        assert_eq!(s.next_event(1.0), f64::INFINITY);
    }

    #[test]
    fn rows_far_from_the_time_zero_are_told_apart() {
        let s = signals(
            "time,u\n1700000000,0\n1700000000.5,0\n1700000000.5,5\n1700000001,5",
            "continuous",
        );
        let at = |time| s.value(&s.list[0], 1.7e9 + time);
        assert_eq!((at(0.0), at(0.4), at(0.5), at(0.6)), (0.0, 0.0, 5.0, 5.0));
        assert_eq!(s.next_event(1.7e9), 1.7e9 + 0.5);
        assert!(!s.jumps_at(1.7e9 + 0.4));
    }

    #[test]
    fn a_jump_at_the_start_uses_the_value_after_it() {
        let s = signals("time,u\n0,0\n0,5\n1,5", "continuous");
        assert_eq!(s.value(&s.list[0], 0.0), 5.0);
    }

    #[test]
    fn a_table_of_another_clock_or_unit_is_told() {
        let told = |text: &str, start, stop| signals(text, "continuous").misses(start, stop);
        let unix = told("time,u\n1700000000,0\n1700000010,1", 0.0, 10.0).expect("told");
        assert!(
            unix.contains("begins at 1700000000 s, after the run from 0 s to 10 s"),
            "{unix}"
        );
        assert!(
            unix.contains("--start-time 1700000000 --stop-time 1700000010"),
            "{unix}"
        );
        let before = told("time,u\n0,0\n4,1", 5.0, 10.0).expect("told");
        assert!(before.contains("ends at 4 s, before") && before.contains("its last value"));
        let ms = told("time,u\n0,0\n10,1\n10000,1", 0.0, 10.0).expect("told");
        assert!(ms.contains("divide them by 1000"), "{ms}");
        for (text, start, stop) in [
            // One row holds for all times; a part of a table may be simulated.
            ("time,u\n1700000000,1", 0.0, 10.0),
            ("time,u\n0,0\n60,1", 0.0, 1.0),
            ("time,u\n1700000000,0\n1700000010,1", 1.7e9, 1.7e9 + 10.0),
        ] {
            assert_eq!(told(text, start, stop), None, "{text}");
        }
    }

    #[test]
    fn parameters_change_in_steps() {
        let s = signals("time,u\n0,1\n1,1\n2,3", "tunable");
        let at = |time| s.value(&s.list[0], time);
        assert_eq!((at(0.0), at(1.5), at(2.0), at(3.0)), (1.0, 1.0, 3.0, 3.0));
        assert_eq!(s.next_event(0.0), 2.0);
    }
}
