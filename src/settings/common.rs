//! Values that several tables of a settings file take.

use super::reader::Reader;
use super::section::{Section, Span, Value};
use crate::diagnostic::Place;
use crate::pattern::Pattern;
use crate::spatial::Vec3;
use std::path::PathBuf;

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
                "links" => two("links"),
                "joints" if table == "loop" => two("joints"),
                "joints" => "joints = [\"names or globs\"]".to_owned(),
                _ => format!("{key} = \"a name or glob\""),
            };
            reader.error("S107", &span, message, help);
        }
        None
    }
}

/// How two names are written, for what takes no globs.
pub(super) fn two(key: &str) -> String {
    format!("{key} = [\"a name\", \"another name\"]")
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

/// The file that a key names.
pub(super) fn file(reader: &Reader, section: &Section, key: &str) -> Option<PathBuf> {
    match section.value(key) {
        Some(Value::Texts(texts)) => Some(reader.beside(&texts.first()?.0)),
        _ => None,
    }
}

/// Where a file is named that a key may name.
pub(super) fn file_place(reader: &Reader, section: &Section, key: &str) -> Option<Place> {
    match section.value(key) {
        Some(Value::Texts(texts)) => Some(reader.place(&texts.first()?.1)),
        _ => None,
    }
}

/// x and y, and z where it is given.
pub(super) fn place(section: &Section) -> (Option<[f64; 2]>, Option<f64>) {
    match section.numbers("xyz").as_deref() {
        Some([x, y, rest @ ..]) => (Some([*x, *y]), rest.first().copied()),
        _ => (None, None),
    }
}

/// Whether a key was there, but wrong: that has been told.
pub(super) fn is_rejected(section: &Section, key: &str) -> bool {
    section.rejected.iter().any(|rejected| rejected == key)
}

/// A whole number.
pub(super) fn whole(section: &Section, key: &str) -> Option<u32> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked: a whole number of the range of the key"
    )]
    section.number(key).map(|number| number as u32)
}
