//! What may have been meant by a key that does not exist, and by text that is no TOML.

use super::keys;
use crate::diagnostic::words::{called, nearest};
use crate::range::number_or_ratio;

/// A table as a file writes it.
pub(super) fn shown(path: &str) -> String {
    let name = path.replace(".*", ".\"…\"").replace("[].", ".");
    match name.strip_suffix("[]") {
        _ if path.is_empty() => "the settings".to_owned(),
        Some(array) => format!("[[{array}]]"),
        None => format!("[{name}]"),
    }
}

/// What a table takes, where something else stands in its place.
pub(super) fn table(path: &str) -> String {
    let known = keys::children(path);
    if known == ["*"] {
        let header = shown(&format!("{path}.*"));
        return format!("write {header}, and below it the keys of one");
    }
    format!("{} has the keys {}", shown(path), known.join(", "))
}

/// What to do about a text in quotes that may be meant as a number or a flag.
pub(super) fn quoted(name: &str, text: &str) -> String {
    let plain = text.trim();
    let unit = plain.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    let digits = &plain[..unit.unwrap_or(plain.len())];
    let is_number = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    let flag = match plain.to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" => Some("true"),
        "false" | "no" | "off" => Some("false"),
        _ => None,
    };
    if is_number(plain) {
        format!("write {name} = {plain}, without quotes")
    } else if is_number(digits) {
        format!("write the number alone, without quotes, in SI units: {name} = {digits}")
    } else if let Some(flag) = flag {
        format!("write {name} = {flag}, without quotes")
    } else {
        String::new()
    }
}

/// What a key may mean that is none of `known`.
pub(super) fn key(name: &str, known: &[&str]) -> String {
    let one_of_many = |known: &&&str| {
        known.strip_suffix('s') == Some(name) || name.strip_suffix('s') == Some(known)
    };
    if let Some(known) = known.iter().find(one_of_many) {
        return format!("did you mean '{known}'?");
    }
    let all = format!("known are {}", known.join(", "));
    if let Some(own) = called(name, known) {
        return format!("did you mean '{own}'? {all}");
    }
    // The same key in another table is likelier meant than another key here.
    for key in keys::KEYS {
        match key.path.rsplit_once('.') {
            Some((table, last)) if last == name => {
                return format!("'{last}' belongs into {}", shown(table));
            }
            _ => {}
        }
    }
    // So is a table inside of another one.
    let mut paths = keys::KEYS.iter().map(|key| key.path);
    let inside = paths.find_map(|path| {
        let at = path.find(&format!(".{name}"))? + 1 + name.len();
        let end = path[at..].starts_with("[].").then_some(at + 2);
        end.or(path[at..].starts_with('.').then_some(at))
            .map(|end| &path[..end])
    });
    if let Some(table) = inside {
        return format!("write {}", shown(table));
    }
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean '{near}'? {all}"),
        // A guess that is far away would mislead.
        None => all,
    }
}

/// Such as `1/240`.
fn is_ratio(word: &str) -> bool {
    word.contains('/') && number_or_ratio(word).is_some()
}

/// The message and the advice for a number as a program prints it: `np.float64(1.0)`.
pub(super) fn called_number(rest: &str) -> Option<(String, String)> {
    let (name, inner) = rest.lines().next()?.split_once('(')?;
    let (number, _) = inner.split_once(')')?;
    let is_name = name.starts_with(|c: char| c.is_alphabetic())
        && name
            .chars()
            .all(|c| c.is_alphanumeric() || "_.".contains(c));
    let is_number = number.trim().parse::<f64>().is_ok_and(f64::is_finite);
    (is_name && is_number).then(|| {
        let message = format!("'{name}({number})' is no value of TOML");
        (
            message,
            format!("write the number alone: {}", number.trim()),
        )
    })
}

/// The message and the advice for text that is no TOML.
///
/// - `found`: the text; `message`: what the parser says of it
pub(super) fn syntax(found: &str, message: &str) -> (String, String) {
    let word = found.trim();
    let is_word = word.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && word
            .chars()
            .all(|c| c.is_alphanumeric() || "_-./".contains(c));
    if message.contains("duplicate") {
        let help = "it stands twice: leave one out, or put all keys of a table below one header";
        return (message.to_owned(), help.to_owned());
    }
    match word.to_lowercase().as_str() {
        "null" | "none" | "nil" => (
            format!("'{word}' is no value of TOML"),
            "leave the key out".to_owned(),
        ),
        flag @ ("true" | "false") if flag != word => {
            (message.to_owned(), format!("TOML writes it {flag}"))
        }
        flag @ ("yes" | "no" | "on" | "off") => {
            let truth = matches!(flag, "yes" | "on");
            (
                message.to_owned(),
                format!("write {truth}, or \"{word}\" for a text"),
            )
        }
        _ if is_ratio(word) => (
            format!("'{word}' is no value of TOML"),
            format!("a ratio stands in quotes: \"{word}\""),
        ),
        _ if message.contains("escape") => (
            message.to_owned(),
            "in \"…\" a backslash begins a character that is written with it; write it twice, \
             or write '…' around the text"
                .to_owned(),
        ),
        _ if is_word => (
            format!("'{word}' is no value of TOML"),
            format!("a text stands in quotes: \"{word}\""),
        ),
        _ => (message.to_owned(), habit(word, message).to_owned()),
    }
}

/// What to do about the habits of other languages.
fn habit(word: &str, message: &str) -> &'static str {
    let number = ["mantissa", "fraction", "float", "leading zero"];
    if word.contains(['“', '”', '„', '‘', '’', '`']) {
        "write straight quotes: \"…\""
    } else if word.starts_with("//") || word.starts_with(';') {
        "a comment begins with #"
    } else if word.starts_with('*') {
        "a name with signs in it stands in quotes, as in [joint.\"*\"]"
    } else if word.starts_with(':') {
        "a key and its value are joined by ="
    } else if word.starts_with(|c: char| c.is_ascii_digit() || ".,".contains(c))
        || number.iter().any(|number| message.contains(number))
    {
        "a number is written as 0.5 or 1e-3: with a point between digits, without a unit"
    } else {
        "the file must be TOML 1.0"
    }
}
