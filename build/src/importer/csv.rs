//! Tables of numbers as separated text: a row of names, `time` first, then one row a time.
//!
//! Written as `FMPy` writes them: commas, quoted names, the shortest digits that read back to the
//! same number. Read with or without quotes; Boolean values may be `true` and `false`, too, and are
//! written as 1 and 0. Semicolons and tabs may stand in place of the commas, as spreadsheets write
//! them where the comma is the decimal sign, see `tabular.rs`. A decimal comma is refused: the
//! command of a motor must not depend on whether `1,234` is somewhat more than one or somewhat more
//! than a thousand.

use super::advice;
use super::tabular::{delimiter, is_announcement, name_and_unit};

/// A table in columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names of the columns, `time` first.
    pub names: Vec<String>,
    /// Rows; each has as many numbers as there are names.
    pub rows: Vec<Vec<f64>>,
}

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// Nothing in it.
    #[error("it is empty; the first line names the columns: time,<input>,…")]
    Empty,
    /// Another kind of file, or two bytes for each letter.
    #[error("it is no text in UTF-8, as tables have to be")]
    NotText,
    /// The first column.
    #[error(
        "line {line}: the first column must be 'time', not '{}'{}",
        advice::cut(found),
        advice::first_name(found)
    )]
    NoTime {
        /// From 1.
        line: u64,
        /// As written.
        found: String,
    },
    /// A column twice.
    #[error("line {line}, column {column}: '{name}' stands there twice")]
    Twice {
        /// From 1.
        line: u64,
        /// From 1.
        column: usize,
        /// Which.
        name: String,
    },
    /// A row that is too short or too long.
    #[error("line {line}: {found} values, but line {header} names {expected} columns")]
    Width {
        /// From 1.
        line: u64,
        /// That of the names, from 1.
        header: u64,
        /// Values.
        found: usize,
        /// Names.
        expected: usize,
    },
    /// Not a finite number.
    #[error(
        "line {line}, column {column} ('{name}'): {}",
        advice::no_number(text, *column, *line == header + 1)
    )]
    Number {
        /// From 1.
        line: u64,
        /// That of the names, from 1.
        header: u64,
        /// From 1.
        column: usize,
        /// Of the column.
        name: String,
        /// As written.
        text: String,
    },
    /// Times that go back.
    #[error(
        "line {line}: time {} s comes after {} s; times must not go back",
        urdf2fmu_core::digits::Digits(*time),
        urdf2fmu_core::digits::Digits(*before)
    )]
    Back {
        /// From 1.
        line: u64,
        /// s
        time: f64,
        /// s
        before: f64,
    },
    /// Not separated text.
    #[error("line {line}: this cannot be read as separated values")]
    Unreadable {
        /// From 1.
        line: u64,
    },
    /// Names alone.
    #[error("it has no values: the line of names must be followed by at least one row")]
    NoRows,
}

impl Table {
    /// Reads a table; gives the line of its names, from 1, too.
    ///
    /// # Errors
    /// [`CsvError`] with line and column.
    pub fn parse(text: &str) -> Result<(Self, u64), CsvError> {
        let text = text.trim_start_matches('\u{feff}');
        if text.contains('\0') {
            return Err(CsvError::NotText);
        }
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .delimiter(delimiter(text))
            .from_reader(text.as_bytes());
        let mut records = reader.records().map(|record| {
            record.map_err(|error| CsvError::Unreadable {
                line: error.position().map_or(1, csv::Position::line),
            })
        });
        let mut names = records.next().ok_or(CsvError::Empty)??;
        if is_announcement(&names) {
            names = records.next().ok_or(CsvError::Empty)??;
        }
        let header = line_of(&names, text);
        let mut names: Vec<String> = names.iter().map(unquoted).collect();
        // Separators behind the last name are no columns; neither are those of the rows below.
        let named = names.iter().rposition(|name| !name.is_empty());
        names.truncate(named.ok_or(CsvError::Empty)? + 1);
        match name_and_unit(&names[0]) {
            (time, None | Some("s")) if time.eq_ignore_ascii_case("time") => {
                "time".clone_into(&mut names[0]);
            }
            _ => {
                let (line, found) = (header, names[0].clone());
                return Err(CsvError::NoTime { line, found });
            }
        }
        for (index, name) in names.iter().enumerate() {
            if names[..index].contains(name) {
                let (line, column, name) = (header, index + 1, name.clone());
                return Err(CsvError::Twice { line, column, name });
            }
        }
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for record in records {
            let record = record?;
            // A line of spaces, or of empty cells behind the last row.
            if record.iter().all(str::is_empty) {
                continue;
            }
            let line = line_of(&record, text);
            let more = record.iter().skip(names.len());
            if record.len() < names.len() || more.into_iter().any(|cell| !cell.is_empty()) {
                let (found, expected) = (record.len(), names.len());
                return Err(CsvError::Width {
                    line,
                    header,
                    found,
                    expected,
                });
            }
            let mut row = Vec::with_capacity(names.len());
            for (column, (cell, name)) in record.iter().zip(&names).enumerate() {
                row.push(advice::number(cell).ok_or_else(|| CsvError::Number {
                    line,
                    header,
                    column: column + 1,
                    name: name.clone(),
                    text: cell.to_owned(),
                })?);
            }
            if let Some(before) = rows.last().map(|row| row[0]).filter(|&t| row[0] < t) {
                let time = row[0];
                return Err(CsvError::Back { line, time, before });
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(CsvError::NoRows);
        }
        Ok((Self { names, rows }, header))
    }

    /// As text.
    pub fn to_text(&self) -> String {
        self.to_text_of(&(0..self.names.len()).collect::<Vec<_>>())
    }

    /// Some of the columns as text.
    pub fn to_text_of(&self, columns: &[usize]) -> String {
        let mut writer = csv::WriterBuilder::new()
            .quote_style(csv::QuoteStyle::NonNumeric)
            .from_writer(Vec::new());
        let names = columns.iter().map(|&i| self.names[i].clone()).collect();
        let values = |row: &Vec<f64>| columns.iter().map(|&i| written(row[i])).collect();
        let done = std::iter::once(names)
            .chain(self.rows.iter().map(values))
            .try_for_each(|row: Vec<String>| writer.write_record(row));
        // Writing rows of equal length to memory does not fail.
        debug_assert!(done.is_ok());
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }
}

/// The numbers of a row as they are written.
pub fn cells(row: &[f64]) -> Vec<String> {
    row.iter().map(|value| written(*value)).collect()
}

/// 1-based line of a record; its position may be that of empty lines before it.
fn line_of(record: &csv::StringRecord, text: &str) -> u64 {
    let Some(position) = record.position() else {
        return 1;
    };
    let start = usize::try_from(position.byte()).unwrap_or(text.len());
    let before = text.as_bytes().get(start..).unwrap_or_default();
    let line_ends = before
        .iter()
        .take_while(|byte| matches!(byte, b'\r' | b'\n'));
    (position.line()..)
        .zip(line_ends.filter(|byte| **byte == b'\n'))
        .last()
        .map_or(position.line(), |(line, _)| line + 1)
}

/// A name that is in quotes behind a space, which the format does not know as quotes.
fn unquoted(cell: &str) -> String {
    let inner = cell.strip_prefix('"').and_then(|c| c.strip_suffix('"'));
    inner.unwrap_or(cell).to_owned()
}

/// The shortest digits that read back to `value`, as Python writes them: `0.1`, `1e-05`, `1.5e+16`.
fn written(value: f64) -> String {
    let scientific = format!("{value:e}");
    let exponent = scientific
        .split_once('e')
        .and_then(|(digits, power)| Some((digits, power.parse::<i32>().ok()?)));
    match exponent {
        Some((digits, power)) if value != 0.0 && !(-4..16).contains(&power) => {
            let sign = if power < 0 { '-' } else { '+' };
            format!("{digits}e{sign}{:02}", power.abs())
        }
        _ => format!("{value:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Python 3.11: `[str(x) for x in …]`.
    #[test]
    fn numbers_are_written_as_python_writes_them() {
        for (value, expected) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.3333333333333333"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (1.25e-7, "1.25e-07"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (-1.5e300, "-1.5e+300"),
            (5e-324, "5e-324"),
        ] {
            assert_eq!(written(value), expected);
        }
    }

    #[test]
    fn a_written_table_reads_back_to_the_same_bits() {
        let table = Table {
            names: vec!["time".into(), "a.b[1]".into()],
            rows: vec![vec![0.0, 1.0 / 3.0], vec![0.1, -2e-300], vec![0.1, 5e22]],
        };
        assert!(
            table
                .to_text()
                .starts_with("\"time\",\"a.b[1]\"\n0.0,0.3333333333333333\n")
        );
        assert_eq!(Table::parse(&table.to_text()), Ok((table, 1)));
    }

    /// What is in a table, wherever it stands.
    fn read(text: &str) -> Table {
        let read = Table::parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        read.0
    }

    #[test]
    fn tables_of_spreadsheets_are_read_whatever_separates_their_columns() {
        let expected = read("time,a,b\n0,1,2\n0.5,-1,3\n");
        for text in [
            "time;a;b\r\n0;1;2\r\n0.5;-1;3\r\n",
            "time\ta\tb\n0\t1\t2\n0.5\t-1\t3\n",
            "\u{feff}\r\n\"time\";\"a\";\"b\"\r\n0;1;2\r\n0.5;-1;3",
        ] {
            assert_eq!(read(text), expected, "{text:?}");
        }
        // What is in quotes belongs to a name.
        let table = read("time,\"a;b;c\"\n0,1\n");
        assert_eq!(table.names, ["time", "a;b;c"]);
    }

    #[test]
    fn a_decimal_comma_is_refused_and_a_lack_of_separators_told() {
        let told = |text: &str| Table::parse(text).expect_err("faulty").to_string();
        for text in [
            "time;a\n0;1,5\n",
            "time\ta\n0\t1,234\n",
            "time,a\n0,\"1,5\"\n",
        ] {
            let told = told(text);
            assert!(told.starts_with("line 2, column 2 ('a'): '1,"), "{told}");
            assert!(
                told.contains("the decimal sign of these tables is a point"),
                "{told}"
            );
        }
        for text in ["time;a\n0;on\n", "time;a\n0;1,5,0\n"] {
            assert!(!told(text).contains("decimal"), "{}", told(text));
        }
        assert!(told("time a\n0 1\n").contains("by commas, semicolons or tabs"));
        assert!(!told("t,a\n0,1\n").contains("commas"));
    }

    #[test]
    fn what_spreadsheets_add_to_a_table_is_no_part_of_it() {
        let expected = read("time,a,b\n0,1,2\n0.5,-1,3\n");
        for text in [
            "sep=;\ntime;a;b\n0;1;2\n0.5;-1;3\n",
            "\u{feff}\"sep=\t\"\r\ntime\ta\tb\r\n0\t1\t2\r\n0.5\t-1\t3\r\n",
            "SEP=,\ntime,a,b\n0,1,2\n0.5,-1,3\n",
            "time,a,b,,\n0,1,2,,\n0.5,-1,3,,\n,,,,\n",
            "Time [s],a,b\n0,1,2,\n0.5,-1,3\n",
        ] {
            assert_eq!(read(text), expected, "{text:?}");
        }
        let line = |text: &str| Table::parse(text).expect("a table").1;
        assert_eq!(line("sep=;\n\ntime;a\n0;1\n"), 3);
        assert_eq!(line("time,a\n0,1\n"), 1);
        let told = |text: &str| Table::parse(text).expect_err("faulty").to_string();
        assert_eq!(
            told("sep=;\ntime;a;a\n0;1;1\n"),
            "line 2, column 3: 'a' stands there twice"
        );
        assert_eq!(
            told("time,a\n0,1,2\n"),
            "line 2: 3 values, but line 1 names 2 columns"
        );
        // Milliseconds must not become seconds.
        assert!(told("time [ms],a\n0,1\n").contains("must be 'time', not 'time [ms]'"));
    }

    #[test]
    fn spaces_quotes_line_ends_and_booleans_of_others_are_read() {
        let text = "\u{feff}\"time\", \"on\" ,x\r\n0,True,1\r\n1,false,+2.5E1\r\n\r\n";
        let (table, _) = Table::parse(text).expect("legal");
        assert_eq!(table.names, ["time", "on", "x"]);
        assert_eq!(table.rows, [[0.0, 1.0, 1.0], [1.0, 0.0, 25.0]]);
    }

    #[test]
    fn faults_are_reported_with_line_and_column() {
        let message = |text: &str| Table::parse(text).expect_err("faulty").to_string();
        assert!(message("").contains("empty"));
        assert!(message("PK\u{3}\u{4}\0\0").contains("no text"));
        assert_eq!(
            message("t,x\n0,1"),
            "line 1: the first column must be 'time', not 't'"
        );
        assert_eq!(
            message("time,x,x\n0,1,1"),
            "line 1, column 3: 'x' stands there twice"
        );
        assert_eq!(
            message("time,x\n\n0,1\r\n  \n1"),
            "line 5: 1 values, but line 1 names 2 columns"
        );
        assert_eq!(
            message("time,x\n0,1\n1,nan"),
            "line 3, column 2 ('x'): 'nan' is no finite number"
        );
        assert_eq!(
            message("time,x\n1,1\n0.5,2"),
            "line 3: time 0.5 s comes after 1 s; times must not go back"
        );
        assert!(message("time,x\n").contains("no values"));
    }
}
