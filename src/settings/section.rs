//! Tables of a settings file, read and checked.

use std::ops;
use toml::de::DeValue;

/// Bytes of the text.
pub(super) type Span = ops::Range<usize>;

/// Keys of one table, in file order.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    pub(super) entries: Vec<Entry>,
    /// Keys that are there but wrong; they have been reported.
    pub(super) rejected: Vec<String>,
    /// Path of the table in [`super::keys::KEYS`].
    pub(super) path: String,
    /// Its header, or its key.
    pub(super) span: Span,
}

#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) span: Span,
    pub(super) node: Node,
}

#[derive(Clone, Debug)]
pub(super) enum Node {
    Value(Value),
    Table(Section),
    Tables(Vec<Section>),
}

/// A value that passed the checks of its key.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Flag(bool),
    Word(String),
    Numbers(Vec<f64>),
    Texts(Vec<(String, Span)>),
}

impl Section {
    /// Path of the key `name` of this table.
    pub(super) fn child(&self, name: &str) -> String {
        if self.path.is_empty() {
            name.to_owned()
        } else {
            format!("{}.{name}", self.path)
        }
    }

    pub(super) fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// The table `name`; an empty one where the file has none.
    pub(super) fn table(&self, name: &str) -> Section {
        match self.entry(name).map(|entry| &entry.node) {
            Some(Node::Table(section)) => section.clone(),
            _ => Section {
                path: self.child(name),
                ..Section::default()
            },
        }
    }

    /// The array of tables `name`.
    pub(super) fn tables(&self, name: &str) -> Vec<Section> {
        match self.entry(name).map(|entry| &entry.node) {
            Some(Node::Tables(sections)) => sections.clone(),
            _ => Vec::new(),
        }
    }
}

/// A whole number that is not negative.
pub(super) fn whole(value: &DeValue) -> Option<u32> {
    let number = value.as_integer()?;
    u32::from_str_radix(number.as_str(), number.radix()).ok()
}
