//! A run in the form in which events are searched in it, and the format of numbers in sentences.

use std::collections::BTreeMap;
use urdf2fmu_drawing::scene::Head;

/// Events of one kind that are told one by one; the rest is summed up.
pub(super) const TOLD: usize = 3;

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When it began, s.
    pub time: f64,
    /// A sentence or two.
    pub text: String,
}

/// Where events are looked for.
pub(super) struct Run<'r> {
    pub(super) head: &'r Head,
    /// s
    pub(super) time: &'r [f64],
    pub(super) columns: BTreeMap<&'r str, &'r [f64]>,
    pub(super) changed: &'r BTreeMap<String, f64>,
}

impl Run<'_> {
    /// All columns, or none where one is missing.
    pub(super) fn all(&self, names: &[String]) -> Option<Vec<&[f64]>> {
        let column = |name: &String| self.columns.get(name.as_str()).copied();
        names.iter().map(column).collect()
    }

    /// Values of an input or parameter by rows.
    pub(super) fn setting(&self, name: &str) -> impl Fn(usize) -> Option<f64> {
        let column = self.columns.get(name).copied();
        let start = || {
            let mut variables = self.head.variables.iter();
            variables.find(|v| v.name == name).and_then(|v| v.start)
        };
        let constant = self.changed.get(name).copied().or_else(start);
        move |row| match column {
            Some(column) => Some(column[row]).filter(|x| x.is_finite()),
            None => constant,
        }
    }

    /// Unit of a variable as it stands behind a number.
    pub(super) fn unit(&self, name: &str) -> &str {
        let mut variables = self.head.variables.iter();
        let variable = variables.find(|v| v.name == name);
        variable.map_or("", |v| v.unit.as_str())
    }

    /// Time from the row before each of `rows` to that row, s, in all. Outputs are those at the end
    /// of a step, so each stands for the step before it.
    pub(super) fn spent(&self, rows: impl Iterator<Item = usize>) -> f64 {
        rows.filter(|&row| row > 0)
            .map(|row| self.time[row] - self.time[row - 1])
            .sum()
    }
}

/// `10.917 s`: to the millisecond, without zeros at the end.
pub fn moment(time: f64) -> String {
    let text = format!("{time:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format!("{} s", if text == "-0" { "0" } else { text })
}

/// Three digits.
pub(super) fn three(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    format!("{}", rounded + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        assert_eq!(moment(10.916_666), "10.917 s");
        assert_eq!(moment(2.0), "2 s");
        assert_eq!(moment(-1e-9), "0 s");
        assert_eq!(three(12345.6), "12300");
        assert_eq!(three(0.001_234_5), "0.00123");
        assert_eq!(three(-0.0), "0");
    }
}
