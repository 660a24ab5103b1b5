//! Numbers in cells of tables, and what to do about those that are none.

/// Letters of a file that a message shows at most.
const MOST_SHOWN: usize = 80;

/// The beginning of a text of any length.
pub fn cut(text: &str) -> String {
    match text.char_indices().nth(MOST_SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A finite number, or 1 and 0 for `true` and `false`.
pub fn number(text: &str) -> Option<f64> {
    if text.eq_ignore_ascii_case("true") {
        return Some(1.0);
    }
    if text.eq_ignore_ascii_case("false") {
        return Some(0.0);
    }
    text.parse().ok().filter(|x: &f64| x.is_finite())
}

/// What to do about another name than `time` in the first column.
pub fn first_name(found: &str) -> &'static str {
    if found.is_empty() {
        "; tables of pandas are saved without their index, index=False"
    } else if found.starts_with(['#', '%']) {
        "; tables have no comments: take out what is before the names"
    } else if found
        .get(..4)
        .is_some_and(|t| t.eq_ignore_ascii_case("time"))
        && found.contains('[')
    {
        "; times are in s"
    } else if found.contains([' ', '|']) {
        "; columns are separated by commas, semicolons or tabs"
    } else {
        ""
    }
}

/// Says that a cell has no finite number, and what to do about it.
pub fn no_number(text: &str, column: usize, below_names: bool) -> String {
    if text.is_empty() {
        return "the cell is empty; each row needs a value in each column, such as that of the row \
                before"
            .to_owned();
    }
    let without = |signs: &[char]| number(&text.replace(signs, "")).is_some();
    let begins = text.starts_with(|c: char| c.is_ascii_digit());
    let advice = if number(&text.replacen(',', ".", 1)).is_some() {
        "; the decimal sign of these tables is a point: save it with one, or replace the commas"
    } else if without(&[',', '\'', '’', '_', ' ', '\u{a0}', '\u{202f}']) {
        "; write it without signs between thousands"
    } else if number(&text.replace('\u{2212}', "-")).is_some() {
        "; its minus is another sign than '-'"
    } else if column == 1 && begins && text.contains([':', '-', '/']) {
        "; times are numbers of seconds, such as 0.5, and not times of day"
    } else if below_names && !text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        "; below the names numbers begin; units may stand in brackets behind names: 'time [s]'"
    } else if begins && text.ends_with(|c: char| c.is_alphabetic() || "%°²³".contains(c)) {
        "; numbers stand without units, and are in SI units"
    } else {
        ""
    };
    format!("'{}' is no finite number{advice}", cut(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_without_a_number_are_told_what_to_do() {
        for (text, column, advice) in [
            ("", 2, "such as that of the row before"),
            ("1,5", 2, "the decimal sign"),
            ("1,000.5", 2, "thousands"),
            ("1'000", 2, "thousands"),
            ("\u{2212}5", 2, "its minus"),
            ("00:00:01", 1, "seconds"),
            ("2024-01-01 00:00:00", 1, "seconds"),
            ("10 rad/s", 2, "without units"),
            ("10°", 2, "without units"),
        ] {
            let told = no_number(text, column, false);
            assert!(told.contains(advice), "{text}: {told}");
        }
        assert!(no_number("rad/s", 2, true).contains("in brackets behind names"));
        assert_eq!(no_number("nan", 2, false), "'nan' is no finite number");
        assert!(first_name("# a table").contains("no comments"));
        assert!(first_name("time [ms]").contains("in s"));
    }
}
