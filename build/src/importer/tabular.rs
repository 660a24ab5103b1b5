//! What tables of numbers are written in: the encoding, what separates columns, and units behind
//! names.
//!
//! Excel writes three things that plain separated values do not have: a line `sep=;` before the
//! names, UTF-16 with its mark ("Unicode text"), and separators behind the last column.

use urdf2fmu_core::encoding::text;

/// Largest table, in bytes: a run of 25 variables with three million rows.
pub const LARGEST: u64 = 1 << 30;

/// The text of a file; bytes that are none become U+FFFD.
pub fn decoded(bytes: Vec<u8>) -> String {
    text(bytes).unwrap_or_else(|refused| String::from_utf8_lossy(&refused.bytes).into_owned())
}

/// What a line `sep=;`, which may be in quotes, says.
fn announced(line: &str) -> Option<u8> {
    let inner = line.trim_matches(|c| matches!(c, '"' | '\r' | '\n' | ' '));
    match *inner.as_bytes() {
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator]
            if matches!(separator, b',' | b';' | b'\t' | b'|') =>
        {
            Some(separator)
        }
        _ => None,
    }
}

/// Whether the first record of a table is a line such as `sep=;`.
pub fn is_announcement(record: &csv::StringRecord) -> bool {
    record.get(0).is_some_and(|cell| {
        cell.trim_matches('"')
            .get(..4)
            .is_some_and(|start| start.eq_ignore_ascii_case("sep="))
    }) && record.iter().skip(1).all(str::is_empty)
}

/// What stands between the columns: what `sep=;` says, else the comma, semicolon or tab behind
/// the first name. Names of arrays, `m[1,1]`, have commas in them, but no table begins with one.
pub fn delimiter(text: &str) -> u8 {
    let header = text.lines().find(|line| !line.trim().is_empty());
    if let Some(separator) = header.and_then(announced) {
        return separator;
    }
    let mut quoted = false;
    let mut bytes = header.unwrap_or_default().trim().bytes();
    let first = bytes.find(|byte| {
        quoted ^= *byte == b'"';
        !quoted && matches!(byte, b',' | b';' | b'\t')
    });
    first.unwrap_or(b',')
}

/// A name and the unit in brackets behind it: `a.b [rad/s]`, `time (s)`. Brackets without a space
/// before them belong to the name, as in `ray[1]`.
pub fn name_and_unit(name: &str) -> (&str, Option<&str>) {
    let open = [" [", " ("]
        .iter()
        .filter_map(|open| name.rfind(open))
        .max();
    let unit = open.and_then(|at| name[at + 2..].strip_suffix([']', ')']));
    match (open, unit) {
        (Some(at), Some(unit)) => (name[..at].trim_end(), Some(unit.trim())),
        _ => (name, None),
    }
}

/// Whether two texts mean one unit: `N·m`, `N*m` and `N.m`; `kg m²` and `kg.m2`.
pub fn same_unit(a: &str, b: &str) -> bool {
    let plain = |unit: &str| -> String {
        let letters = unit.chars().filter(|c| !matches!(c, '^'));
        let letters = letters.map(|c| match c {
            '·' | '⋅' | '*' | ' ' => '.',
            '²' => '2',
            '³' => '3',
            other => other,
        });
        letters.collect()
    };
    let unitless = |unit: String| if unit == "-" { "1".to_owned() } else { unit };
    let (a, b) = (unitless(plain(a)), unitless(plain(b)));
    a == b || (a.is_empty() && b == "1") || (b.is_empty() && a == "1")
}

/// What is wrong with the unit behind the name of a column, which must be that of the variable:
/// values are never converted.
///
/// - `unit`: as written
/// - `of_variable`: empty for a number without one
pub fn wrong_unit(name: &str, unit: &str, of_variable: &str) -> Option<String> {
    let expected = match of_variable {
        "" => "no unit",
        unit => unit,
    };
    (!same_unit(unit, of_variable))
        .then(|| format!("the values of '{name}' must be in {expected}, not in {unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_in_brackets_behind_a_space() {
        assert_eq!(name_and_unit("time [s]"), ("time", Some("s")));
        assert_eq!(name_and_unit("a.b (rad/s)"), ("a.b", Some("rad/s")));
        assert_eq!(name_and_unit("ray[1]"), ("ray[1]", None));
        assert_eq!(name_and_unit("ray[1] [m]"), ("ray[1]", Some("m")));
        for (a, b) in [
            ("N·m", "N.m"),
            ("N*m", "N.m"),
            ("kg m²", "kg.m2"),
            ("-", ""),
        ] {
            assert!(same_unit(a, b), "{a} {b}");
        }
        assert!(!same_unit("deg", "rad") && !same_unit("ms", "s") && !same_unit("", "m"));
    }
}
