//! What may have been meant by a key that does not exist, and by text that is no TOML.

use super::keys;
use crate::diagnostic::words::likeliest;

/// A table as a file writes it.
pub(super) fn shown(path: &str) -> String {
    let name = path.replace(".*", ".\"…\"").replace("[].", ".");
    match name.strip_suffix("[]") {
        _ if path.is_empty() => "the settings".to_owned(),
        Some(array) => format!("[[{array}]]"),
        None => format!("[{name}]"),
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
    let near = likeliest(name, known.iter().copied());
    near.map_or_else(String::new, |near| {
        format!("did you mean '{near}'? known are {}", known.join(", "))
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
    match word.to_lowercase().as_str() {
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
        _ if is_word => (
            format!("'{word}' is no value of TOML"),
            format!("a text stands in quotes: \"{word}\""),
        ),
        _ => (message.to_owned(), "the file must be TOML 1.0".to_owned()),
    }
}
