//! Tables of other programs: any text with separated values, a row of names, and one of them time.
//!
//! Commas, semicolons (then a comma may be the decimal sign) or tabs separate; units in brackets
//! behind names, quotes, empty cells, columns in any order and rows out of order are understood.
//! So are arrays of FMI 3 as `FMPy` and fmusim write them: the elements in one cell, with spaces
//! between them. Notes say what is left out or corrected.

use super::super::importer::tabular::{delimiter, is_announcement, name_and_unit, wrong_unit};
use super::names;
use urdf2fmu_drawing::scene::Scene;

/// Columns of numbers; what is missing is NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// s, never decreasing.
    pub time: Vec<f64>,
    /// Names and values.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Sentences about what was left out or mended.
    pub notes: Vec<String>,
    /// Why it may be of another robot.
    pub doubt: Option<String>,
    /// Names of columns whose cells held several numbers, and how many; their columns are called
    /// `name[1]` and so on.
    pub lists: Vec<(String, usize)>,
    /// The unit behind the name of each column and where it stands.
    pub units: Vec<Option<Written>>,
}

/// A unit in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    unit: String,
    /// From 1.
    line: u64,
    /// From 1.
    column: usize,
}

impl Written {
    /// Refuses a unit that is not that of the variable.
    fn compare(&self, name: &str, of_variable: &str) -> Result<(), ResultsError> {
        let (line, column) = (self.line, self.column);
        let wrong = wrong_unit(name, &self.unit, of_variable);
        wrong.map_or(Ok(()), |what| {
            let what = format!("line {line}, column {column}: {what}");
            Err(ResultsError::Unit { what })
        })
    }
}

/// Why a table cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// Nothing in it.
    #[error("it is empty; the first line names the columns, one of them 'time'")]
    Empty,
    /// Another kind of file, or two bytes for each letter.
    #[error("it is no text in UTF-8, as tables have to be")]
    NotText,
    /// No column of times.
    #[error("line 1: no column is called 'time'; it has: {found}")]
    NoTime {
        /// The first names.
        found: String,
    },
    /// A unit that is not that of its variable.
    #[error("{what}")]
    Unit {
        /// As a sentence, with line and column.
        what: String,
    },
    /// Not separated text.
    #[error("line {line}: this cannot be read as separated values")]
    Unreadable {
        /// From 1.
        line: u64,
    },
    /// A row that is too short or too long.
    #[error("line {line}: {found} values, but line 1 names {expected} columns")]
    Width {
        /// From 1.
        line: u64,
        /// Values.
        found: usize,
        /// Names.
        expected: usize,
    },
    /// No row with a time.
    #[error("no row below line 1 has a time")]
    NoRows,
}

/// Names of the column of times, in small letters.
const TIMES: [&str; 4] = ["time", "t", "tout", "timestamp"];

/// Numbers beyond this are not shown: the page's numbers have 32 bits.
const GREATEST: f64 = 1e38;

impl Table {
    /// The same with the names of the scene's variables.
    pub fn named(mut self, scene: &Scene) -> Self {
        names::rename_lists(&mut self.columns, &self.lists, scene);
        self.doubt = names::rename(&mut self.columns, scene, &mut self.notes);
        self
    }

    /// Compares the units of columns that have the names of the scene's variables.
    ///
    /// # Errors
    /// A unit that is not that of the variable.
    pub fn in_units_of(self, scene: &Scene) -> Result<Self, ResultsError> {
        for ((name, _), written) in self.columns.iter().zip(&self.units) {
            let variable = scene.head.variables.iter().find(|v| v.name == *name);
            if let (Some(written), Some(variable)) = (written, variable) {
                written.compare(name, &variable.unit)?;
            }
        }
        Ok(self)
    }

    /// Reads a table.
    ///
    /// # Errors
    /// [`ResultsError`] with line and column.
    pub fn parse(text: &str) -> Result<Self, ResultsError> {
        let text = text.trim_start_matches('\u{feff}');
        if text.contains('\0') {
            return Err(ResultsError::NotText);
        }
        let delimiter = delimiter(text);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .delimiter(delimiter)
            .from_reader(text.as_bytes());
        let mut records = reader.records().map(|record| {
            let line = |error: &csv::Error| error.position().map_or(1, csv::Position::line);
            record.map_err(|error| ResultsError::Unreadable { line: line(&error) })
        });
        let mut header = records.next().ok_or(ResultsError::Empty)??;
        if is_announcement(&header) {
            header = records.next().ok_or(ResultsError::Empty)??;
        }
        let line = header.position().map_or(1, csv::Position::line);
        let (names, units): (Vec<String>, Vec<Option<Written>>) = (1..)
            .zip(&header)
            .map(|(column, cell)| {
                let (name, unit) = name(cell);
                let unit = unit.map(str::to_owned);
                let written = unit.map(|unit| Written { unit, line, column });
                (name.to_owned(), written)
            })
            .unzip();
        let time = TIMES
            .iter()
            .find_map(|time| names.iter().position(|name| name.to_lowercase() == *time))
            .ok_or_else(|| ResultsError::NoTime {
                found: names[..names.len().min(8)].join(", "),
            })?;
        if let Some(written) = &units[time] {
            written.compare(&names[time], "s")?;
        }
        let mut reading = Reading {
            decimal_comma: delimiter != b',',
            widths: Vec::new(),
            columns: Vec::new(),
            strange: Vec::new(),
            untimed: 0,
        };
        let mut notes = Vec::new();
        let mut cut = None;
        for record in records {
            let record = record?;
            if record.iter().all(str::is_empty) {
                continue;
            }
            let line = record.position().map_or(1, csv::Position::line);
            if let Some(error) = cut.take() {
                return Err(error);
            }
            if record.len() == names.len() {
                reading.row(&record, time, line);
            } else {
                // A program that was ended leaves half a line; anywhere else it is an error.
                let (found, expected) = (record.len(), names.len());
                cut = Some(ResultsError::Width {
                    line,
                    found,
                    expected,
                });
            }
        }
        if let Some(ResultsError::Width { line, .. }) = cut {
            notes.push(format!(
                "Line {line}, the last one, is not complete and is left out."
            ));
        }
        let lists = names.iter().zip(&reading.widths);
        let lists: Vec<(String, usize)> = lists
            .filter(|(_, width)| **width > 1)
            .map(|(name, width)| (name.clone(), *width))
            .collect();
        // Elements are columns of their own.
        let elements = |(name, width): (&String, &usize)| -> Vec<String> {
            match width {
                1 => vec![name.clone()],
                _ => (1..=*width).map(|k| format!("{name}[{k}]")).collect(),
            }
        };
        let time = reading.widths.iter().take(time).sum();
        let units = units.iter().zip(&reading.widths);
        let units: Vec<Option<Written>> = units
            .flat_map(|(unit, width)| vec![unit.clone(); *width])
            .collect();
        let names: Vec<String> = names
            .iter()
            .zip(&reading.widths)
            .flat_map(elements)
            .collect();
        let table = reading.finish(&names, &units, time, notes)?;
        Ok(Self { lists, ..table })
    }

    /// The result of a simulation: `time` first, all numbers there.
    pub fn of(names: &[String], rows: &[Vec<f64>]) -> Self {
        let column = |i: usize| rows.iter().map(|row| row[i]).collect();
        Self {
            time: column(0),
            columns: (1..names.len())
                .map(|i| (names[i].clone(), column(i)))
                .collect(),
            units: vec![None; names.len() - 1],
            ..Self::default()
        }
    }
}

struct Reading {
    decimal_comma: bool,
    /// Numbers in each cell of a row, by the first row.
    widths: Vec<usize>,
    columns: Vec<Vec<f64>>,
    /// For each column how many cells are no numbers, and the first of them with its line.
    strange: Vec<Option<(usize, String, u64)>>,
    /// Rows without a time.
    untimed: usize,
}

impl Reading {
    fn row(&mut self, record: &csv::StringRecord, time: usize, line: u64) {
        if self.widths.is_empty() {
            self.widths = record.iter().map(|cell| self.width(cell)).collect();
            let count = self.widths.iter().sum();
            self.columns = vec![Vec::new(); count];
            self.strange = vec![None; count];
        }
        let moment = self.number(&record[time]).flatten();
        if moment.is_none() {
            self.untimed += 1;
            return;
        }
        let widths = self.widths.clone();
        let cells = record.iter().zip(widths).flat_map(|(cell, width)| {
            let words = cell.split_whitespace();
            let fits = width > 1 && words.clone().count() == width;
            let list = words.take(if fits { width } else { 0 });
            list.chain(std::iter::repeat_n(cell, if fits { 0 } else { width }))
        });
        for (i, cell) in cells.enumerate() {
            let value = self.number(cell);
            if value.is_none() {
                let entry = self.strange[i].get_or_insert_with(|| (0, cell.to_owned(), line));
                entry.0 += 1;
            }
            self.columns[i].push(value.flatten().unwrap_or(f64::NAN));
        }
    }

    /// A number, nothing where the cell has none, or `None` for anything else.
    #[expect(
        clippy::option_option,
        reason = "no number and no cell are different things"
    )]
    fn number(&self, cell: &str) -> Option<Option<f64>> {
        let lower = cell.to_lowercase();
        match lower.as_str() {
            "" | "nan" | "na" | "null" | "none" => return Some(None),
            "true" => return Some(Some(1.0)),
            "false" => return Some(Some(0.0)),
            _ => {}
        }
        let parsed = match cell.parse::<f64>() {
            Err(_) if self.decimal_comma => cell.replace(',', ".").parse().ok()?,
            other => other.ok()?,
        };
        Some(Some(parsed).filter(|x| x.abs() < GREATEST))
    }

    /// How many numbers a cell has: several with spaces between them, or one.
    fn width(&self, cell: &str) -> usize {
        let words = cell.split_whitespace();
        if words.clone().all(|word| self.number(word).is_some()) {
            words.count().max(1)
        } else {
            1
        }
    }

    fn finish(
        mut self,
        names: &[String],
        units: &[Option<Written>],
        time: usize,
        mut notes: Vec<String>,
    ) -> Result<Table, ResultsError> {
        let rows = self.columns.get(time).map_or(0, Vec::len);
        if rows == 0 {
            return Err(ResultsError::NoRows);
        }
        if self.untimed > 0 {
            notes.push(format!(
                "Rows without a time are left out: {}.",
                self.untimed
            ));
        }
        self.sort(time, &mut notes);
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        let mut of_columns = Vec::new();
        for (i, (name, values)) in names.iter().zip(&mut self.columns).enumerate() {
            let strange = self.strange[i].take();
            if i == time {
                continue;
            }
            if name.is_empty() || columns.iter().any(|(other, _)| other == name) {
                notes.push(format!(
                    "Column {} {} and is left out.",
                    i + 1,
                    if name.is_empty() {
                        "has no name".to_owned()
                    } else {
                        format!("is called '{name}' like another one")
                    }
                ));
                continue;
            }
            if let Some((count, first, line)) = strange {
                notes.push(format!(
                    "Cells of column '{name}' that are no numbers: {count}, the first in line \
                     {line}: '{first}'."
                ));
                if count == rows {
                    continue;
                }
            }
            columns.push((name.clone(), std::mem::take(values)));
            of_columns.push(units[i].clone());
        }
        Ok(Table {
            time: std::mem::take(&mut self.columns[time]),
            columns,
            notes,
            doubt: None,
            lists: Vec::new(),
            units: of_columns,
        })
    }

    /// Puts rows in the order of time.
    fn sort(&mut self, time: usize, notes: &mut Vec<String>) {
        let times = &self.columns[time];
        if times.is_sorted() {
            return;
        }
        notes.push("Rows were not in the order of time and have been sorted.".to_owned());
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        for values in &mut self.columns {
            *values = order.iter().map(|&row| values[row]).collect();
        }
    }
}

/// A name without quotes, and its unit in brackets behind it.
fn name(cell: &str) -> (&str, Option<&str>) {
    let inner = cell
        .strip_prefix('"')
        .and_then(|c| c.strip_suffix('"'))
        .unwrap_or(cell);
    let (name, unit) = name_and_unit(inner);
    (name.trim(), unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_many_programs_are_read() {
        let same = |text: &str| {
            let table = Table::parse(text).expect("legal");
            assert_eq!(table.time, [0.0, 0.5], "{text}");
            assert_eq!(
                table.columns,
                [("a.b".to_owned(), vec![1.0, -0.25])],
                "{text}"
            );
            assert!(table.notes.is_empty(), "{text}: {:?}", table.notes);
        };
        same("time,a.b\n0,1\n0.5,-0.25\n");
        same("\u{feff}\"time\", \"a.b\"\r\n0.0,1.0\r\n\r\n5e-1,-2.5e-01\r\n");
        same("a.b;time\n1;0\n-0,25;0,5\n");
        same("sep=;\ntime;a.b\n0;1\n0,5;-0,25\n");
        same("Time [s]\ta.b [m]\n0\ttrue\n.5\t-.25\n");
    }

    /// `FMPy`'s `write_csv` and fmusim's `--output-file`, of FMI 3.
    #[test]
    fn arrays_in_one_cell_are_columns_of_their_elements() {
        let table = Table::parse("time,p,on\n0,1 -2 3e-1,true\n1,4 5 6,false\n2,7 8,true\n");
        let table = table.expect("legal");
        assert_eq!(table.lists, [("p".to_owned(), 3)]);
        let names: Vec<&str> = table.columns.iter().map(|c| c.0.as_str()).collect();
        assert_eq!(names, ["p[1]", "p[2]", "p[3]", "on"]);
        assert_eq!(table.columns[1].1[..2], [-2.0, 5.0]);
        assert!(table.columns[1].1[2].is_nan());
        assert_eq!(table.columns[3].1, [1.0, 0.0, 1.0]);
        assert!(table.notes[0].contains("'7 8'"), "{:?}", table.notes);
    }

    #[test]
    fn what_is_missing_is_a_gap_and_what_is_mended_is_said() {
        let table = Table::parse(
            "a,time,note,a,b\n1,2,x,9,\n,1,y,9,nan\n5,,z,9,1\n3,0,w,9,inf\n4,0.5,v,9,oh\n7,",
        );
        let table = table.expect("legal");
        assert_eq!(table.time, [0.0, 0.5, 1.0, 2.0]);
        let names: Vec<&str> = table
            .columns
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(table.columns[0].1[..2], [3.0, 4.0]);
        assert!(table.columns[0].1[2].is_nan() && table.columns[1].1.iter().all(|x| x.is_nan()));
        assert_eq!(
            table.notes,
            [
                "Line 7, the last one, is not complete and is left out.",
                "Rows without a time are left out: 1.",
                "Rows were not in the order of time and have been sorted.",
                "Cells of column 'note' that are no numbers: 4, the first in line 2: 'x'.",
                "Column 4 is called 'a' like another one and is left out.",
                "Cells of column 'b' that are no numbers: 1, the first in line 6: 'oh'.",
            ]
        );
    }

    #[test]
    fn faults_are_reported_with_their_place() {
        let message = |text: &str| Table::parse(text).expect_err("faulty").to_string();
        assert!(message("").contains("empty"));
        assert!(message("PK\u{3}\u{4}\0\0").contains("no text"));
        assert_eq!(
            message("x,y\n0,1"),
            "line 1: no column is called 'time'; it has: x, y"
        );
        assert_eq!(
            message("time,x\n0\n1,2"),
            "line 2: 1 values, but line 1 names 2 columns"
        );
        assert_eq!(
            message("sep=;\nx [m];time [ms]\n0;1\n"),
            "line 2, column 2: the values of 'time' must be in s, not in ms"
        );
        assert_eq!(message("time,x\n"), "no row below line 1 has a time");
    }
}
