//! Words of a URDF → numbers, with what is wrong with those that are none.

use crate::diagnostic::words::code;
use std::borrow::Cow;

/// Numbers beyond this are refused: squares and products of smaller ones stay finite. Limits of
/// 1e16 for "none" are in use.
pub(super) const LARGEST: f64 = 1e30;

/// The value with `$(optenv NAME default)` replaced by the default, and whether there was one. Some
/// published files still contain it; the environment is not read, so that a file means the same
/// everywhere.
pub(super) fn without_optenv(value: &str) -> (Cow<'_, str>, bool) {
    let parts = || {
        let (before, rest) = value.split_once("$(optenv")?;
        let (inner, after) = rest.split_once(')')?;
        let (_, default) = inner.trim_start().split_once(char::is_whitespace)?;
        Some(format!("{before}{}{after}", default.trim()))
    };
    match parts() {
        Some(replaced) => (Cow::Owned(replaced), true),
        None => (Cow::Borrowed(value), false),
    }
}

/// Words of an attribute that a finding names.
pub(super) const MOST_WORDS: usize = 5;

/// Units as people write them behind a number.
const UNITS: [&str; 8] = ["mm", "cm", "m", "deg", "rad", "g", "kg", "°"];

/// Why a word is not taken as a number.
#[derive(Debug, PartialEq)]
pub(super) struct Unread {
    pub(super) code: &'static str,
    /// "… is …"
    pub(super) what: &'static str,
    pub(super) help: &'static str,
}

/// A finite decimal number.
pub(super) fn parse(word: &str) -> Result<f64, Unread> {
    let unread = |code, what, help| Err(Unread { code, what, help });
    let no_number = |help| unread("U030", "not a number", help);
    let digits = word.contains(|c: char| c.is_ascii_digit());
    // Rust also reads "inf" and "NaN"; URDF does not.
    match word.parse::<f64>() {
        Ok(number) if number.abs() > LARGEST && digits => {
            unread("U032", "beyond 1e30", "check its digits and its unit")
        }
        Ok(number) if !number.is_finite() => {
            let help = "write a number; what has no limit gets a large one, up to 1e30";
            unread("U032", "not a finite number", help)
        }
        Ok(number) => Ok(number),
        Err(_) if ["x", "y", "z"].contains(&word.trim_start_matches('-')) => {
            no_number("an axis is written as three numbers: \"1 0 0\" is x, \"0 0 -1\" is -z")
        }
        Err(_) if word.contains(',') => {
            no_number("the decimal sign is a point, and numbers are separated by spaces")
        }
        Err(_) if word.starts_with('&') => no_number("write out what the entity stands for"),
        Err(_) if word.contains(';') => no_number("numbers are separated by spaces"),
        Err(_) if word.to_ascii_lowercase().contains("0x") => no_number("write it in decimal"),
        Err(_) if word.contains("${") || word.contains("$(") => no_number(
            "this is xacro code: give the file a name that ends in .xacro, and it is expanded",
        ),
        Err(_) if word.to_ascii_lowercase().contains("pi") => no_number(
            "write its value, such as 1.5708 for pi/2; in a file whose name ends in .xacro, ${pi/2} \
             is expanded",
        ),
        // Of `30 deg` the second word.
        Err(_) if number_with_letters(word) || UNITS.contains(&word) => {
            no_number("write the number alone: lengths are in m, angles in rad, masses in kg")
        }
        Err(_) => no_number("write a decimal number such as 0.5 or 1e-3"),
    }
}

/// Hyphens and signs that word processors write in place of a minus.
const DASHES: [char; 6] = [
    '\u{2010}', '\u{2011}', '\u{2012}', '\u{2013}', '\u{2014}', '\u{2212}',
];

/// How a number is written whose sign is one of a word processor.
pub(super) fn hyphenated(word: &str) -> Option<String> {
    let dash = word.chars().find(|c| DASHES.contains(c))?;
    let plain = word.replace(DASHES, "-");
    let told = || format!("its sign is {}, not a hyphen: write {plain}", code(dash));
    parse(&plain).is_ok().then(told)
}

/// Whether letters follow a number, as in `2kg` and `30°`.
fn number_with_letters(word: &str) -> bool {
    let number = word.trim_end_matches(|c: char| c.is_alphabetic() || "°%²³/".contains(c));
    number.len() < word.len() && number.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_of_optenv_is_taken() {
        let value = |text| without_optenv(text).0.into_owned();
        assert_eq!(
            value("$(optenv IMU_RPY 0 -1.5708 3.1416)"),
            "0 -1.5708 3.1416"
        );
        assert_eq!(value("1 $(optenv Y 2) 3"), "1 2 3");
        for unchanged in ["1 2 3", "$(optenv Y)", "$(optenv Y 2", "$(find pkg)"] {
            assert_eq!(without_optenv(unchanged), (Cow::Borrowed(unchanged), false));
        }
    }

    #[test]
    fn numbers_are_plain_decimal() {
        for (text, value) in [("1", 1.0), ("-.5", -0.5), ("+2.", 2.0), ("1e-3", 1e-3)] {
            assert_eq!(parse(text), Ok(value), "{text}");
        }
        for text in ["", "1,0", "0x10", "1.0f", "one", "--1", "1e", "${r}"] {
            assert_eq!(parse(text).map_err(|e| e.code), Err("U030"), "{text}");
        }
        for text in ["nan", "NaN", "inf", "-INF", "infinity", "1e999", "1e31"] {
            assert_eq!(parse(text).map_err(|e| e.code), Err("U032"), "{text}");
        }
        for (text, fits) in [("2kg", true), ("30°", true), ("0.1m", true), ("kg", false)] {
            assert_eq!(number_with_letters(text), fits, "{text}");
        }
    }
}
