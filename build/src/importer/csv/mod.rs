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

/// Where the names of a table's columns and its rows stand in its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// Their line, from 1.
    pub line: u64,
    /// Lines of the rows, from 1.
    pub rows: Vec<u64>,
    /// In the file, from 1: the elements of an array stand in one.
    pub columns: Vec<usize>,
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
    /// An array with another number of elements.
    #[error(
        "line {line}, column {column}: {found} numbers, but '{name}' is an array of {expected}; they \
         stand with spaces between them"
    )]
    Elements {
        /// From 1.
        line: u64,
        /// From 1.
        column: usize,
        /// Of the column.
        name: String,
        /// Numbers.
        found: usize,
        /// Elements.
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
    /// A quotation mark without another one.
    #[error("line {line}: a quotation mark in a name is never closed: write another one, or none")]
    Quote {
        /// From 1.
        line: u64,
    },
    /// Names alone.
    #[error("it has no values: the line of names must be followed by at least one row")]
    NoRows,
}

/// Where a cell is.
struct Cell<'a> {
    line: u64,
    header: u64,
    column: usize,
    name: &'a str,
}

impl Cell<'_> {
    fn read(&self, text: &str) -> Result<f64, CsvError> {
        advice::number(text).ok_or_else(|| CsvError::Number {
            line: self.line,
            header: self.header,
            column: self.column,
            name: self.name.to_owned(),
            text: text.to_owned(),
        })
    }

    /// Reads the elements of an array, of which there are `expected`.
    fn read_array(&self, text: &str, expected: usize, row: &mut Vec<f64>) -> Result<(), CsvError> {
        let found = text.split_whitespace().count();
        if found != expected {
            return Err(CsvError::Elements {
                line: self.line,
                column: self.column,
                name: self.name.to_owned(),
                found,
                expected,
            });
        }
        for text in text.split_whitespace() {
            row.push(self.read(text)?);
        }
        Ok(())
    }
}

impl Table {
    /// Reads a table; tells where its names stand, too. The column of an array has all of its
    /// elements in each cell, with spaces between them, and becomes a column for each.
    ///
    /// - `elements`: names of the elements of what is called so; none where it is no array
    ///
    /// # Errors
    /// [`CsvError`] with line and column.
    pub fn parse<'e>(
        text: &str,
        elements: impl Fn(&str) -> Option<&'e [String]>,
    ) -> Result<(Self, Names), CsvError> {
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
        if names.iter().any(|name| name.contains('\n')) {
            return Err(CsvError::Quote { line: header });
        }
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
        let wholes: Vec<Option<&[String]>> = names.iter().map(|name| elements(name)).collect();
        let (mut single, mut columns): (Vec<String>, Vec<usize>) = (Vec::new(), Vec::new());
        for (column, (name, whole)) in names.iter().zip(&wholes).enumerate() {
            for name in whole.unwrap_or(std::slice::from_ref(name)) {
                if single.contains(name) {
                    let (line, column, name) = (header, column + 1, name.clone());
                    return Err(CsvError::Twice { line, column, name });
                }
                single.push(name.clone());
                columns.push(column + 1);
            }
        }
        let (mut rows, mut lines): (Vec<Vec<f64>>, Vec<u64>) = (Vec::new(), Vec::new());
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
            let cells = record.iter().zip(&names).zip(&wholes).enumerate();
            let mut row = Vec::with_capacity(single.len());
            for (column, ((cell, name), whole)) in cells {
                let place = Cell {
                    line,
                    header,
                    column: column + 1,
                    name,
                };
                match whole {
                    Some(whole) => place.read_array(cell, whole.len(), &mut row)?,
                    None => row.push(place.read(cell)?),
                }
            }
            if let Some(before) = rows.last().map(|row| row[0]).filter(|&t| row[0] < t) {
                let time = row[0];
                return Err(CsvError::Back { line, time, before });
            }
            rows.push(row);
            lines.push(line);
        }
        if rows.is_empty() {
            return Err(CsvError::NoRows);
        }
        let names = Names {
            line: header,
            rows: lines,
            columns,
        };
        let table = Self {
            names: single,
            rows,
        };
        Ok((table, names))
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
mod tests;
