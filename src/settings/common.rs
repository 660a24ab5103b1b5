//! Values that several tables of a settings file take.

use super::reader::Reader;
use super::section::{Section, Span, Value};
use crate::pattern::Pattern;
use crate::spatial::Vec3;

pub(super) fn unsupported(reader: &mut Reader, section: &Section, key: &str, what: &str) {
    let span = section.entry(key).map_or(0..0, |entry| entry.span.clone());
    let message = format!("{what} is not supported yet");
    reader.error("S105", &span, message, "leave it out");
}

/// A text that must be there; `table` is its array of tables.
pub(super) fn required(
    reader: &mut Reader,
    section: &Section,
    key: &str,
    table: &str,
) -> Option<Pattern> {
    some_required(reader, section, key, table)?
        .into_iter()
        .next()
}

/// One text or more that must be there; `table` is their array of tables.
pub(super) fn some_required(
    reader: &mut Reader,
    section: &Section,
    key: &str,
    table: &str,
) -> Option<Vec<Pattern>> {
    if let Some(Value::Texts(texts)) = section.value(key)
        && !texts.is_empty()
    {
        Some(patterns(reader, texts))
    } else {
        if !section.rejected.iter().any(|rejected| rejected == key) {
            let span = section.span.clone();
            let message = format!("[[{table}]] needs '{key}'");
            let help = match key {
                "urdf" => "urdf = \"a file of a robot\"".to_owned(),
                "name" => "name = \"a name of your own\"".to_owned(),
                "joints" => "joints = [\"names or globs\"]".to_owned(),
                _ => format!("{key} = \"a name or glob\""),
            };
            reader.error("S107", &span, message, help);
        }
        None
    }
}

pub(super) fn pattern(reader: &Reader, text: String, span: &Span) -> Pattern {
    Pattern {
        text,
        place: Some(reader.place(span)),
    }
}

pub(super) fn patterns(reader: &Reader, texts: Vec<(String, Span)>) -> Vec<Pattern> {
    texts
        .into_iter()
        .map(|(text, span)| pattern(reader, text, &span))
        .collect()
}

pub(super) fn vector(section: &Section, key: &str) -> Vec3 {
    match section.numbers(key).as_deref() {
        Some([x, y, z]) => Vec3::new(*x, *y, *z),
        _ => Vec3::zeros(),
    }
}
