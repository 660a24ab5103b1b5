//! Text → checked keys and values: syntax, unknown keys, types and ranges, all findings at once.
//!
//! [`super::keys::KEYS`] defines the keys; this module contains no key names.

use super::advice;
use super::compat::Compat;
use super::keys::{self, Key, Takes};
use super::section::{Entry, Node, Section, Span, Value, whole};
use crate::diagnostic::words::did_you_mean;
use crate::diagnostic::{Diagnostic, Place, Severity};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Values of keys that may be left out.
impl Section {
    /// What the file gives, else the table's default.
    pub(super) fn value(&self, name: &str) -> Option<Value> {
        match self.entry(name).map(|entry| &entry.node) {
            Some(Node::Value(value)) => Some(value.clone()),
            _ => DEFAULTS.get(self.child(name).as_str()).cloned(),
        }
    }

    /// What the file gives, else the default under the conventions of `compat`.
    pub(super) fn value_as(&self, name: &str, compat: Compat) -> Option<Value> {
        let given = self.entry(name).is_some();
        let other = compat.default_of(&self.child(name)).filter(|_| !given);
        match (other, keys::find(&self.child(name))) {
            (Some(default), Some(key)) => default_value(&Key {
                default: Some(default),
                ..*key
            }),
            _ => self.value(name),
        }
    }

    pub(super) fn number_as(&self, name: &str, compat: Compat) -> Option<f64> {
        match self.value_as(name, compat) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        match self.value(name) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    pub(super) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        match self.value(name) {
            Some(Value::Numbers(numbers)) => Some(numbers),
            _ => None,
        }
    }

    pub(super) fn flag(&self, name: &str) -> bool {
        self.value(name) == Some(Value::Flag(true))
    }

    pub(super) fn word(&self, name: &str) -> Option<String> {
        match self.value(name) {
            Some(Value::Word(word)) => Some(word),
            _ => None,
        }
    }
}

/// The keys' defaults, by path: each settings file needs nearly all of them.
static DEFAULTS: LazyLock<BTreeMap<&str, Value>> = LazyLock::new(|| {
    let defaults = keys::KEYS.iter();
    defaults
        .filter_map(|key| Some((key.path, default_value(key)?)))
        .collect()
});

/// A key's default, read like the file.
fn default_value(key: &Key) -> Option<Value> {
    let value = DeValue::parse(key.default?).ok()?;
    let mut reader = Reader::new("", "");
    reader.value(key, key.path, &value)
}

/// Reads one text; findings gather in `findings`.
pub(super) struct Reader<'a> {
    file: &'a str,
    pub(super) text: &'a str,
    /// What relative names of files in the text count from.
    pub(super) folder: &'a Path,
    pub(super) findings: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            folder: Path::new(file).parent().unwrap_or(Path::new("")),
            findings: Vec::new(),
        }
    }

    pub(super) fn place(&self, span: &Span) -> Place {
        Place::in_text(self.file, self.text, span.clone())
    }

    /// A file that is named in the text.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub(super) fn error(
        &mut self,
        code: &'static str,
        span: &Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.error_at(code, Some(self.place(span)), message, help);
    }

    pub(super) fn error_at(
        &mut self,
        code: &'static str,
        place: Option<Place>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        let help = help.into();
        let finding = Diagnostic {
            severity: Severity::Error,
            code,
            message: message.into(),
            help: (!help.is_empty()).then_some(help),
            place,
        };
        self.findings.push(finding);
    }

    /// The whole file; after a syntax error what is left of it.
    pub(super) fn read(&mut self) -> Section {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        for error in &errors {
            // A file of such line ends has one for each line.
            if error.message().contains("carriage return") && !self.findings.is_empty() {
                continue;
            }
            let span = error.span().unwrap_or(0..0);
            let found = self.text.get(span.clone()).unwrap_or_default();
            let rest = self.text.get(span.start..).unwrap_or_default();
            let around = (&self.text[..self.text.len() - rest.len()], rest);
            let (message, help) = advice::called_number(rest)
                .unwrap_or_else(|| advice::syntax(found, around, error.message()));
            self.error("S101", &span, message, help);
        }
        self.section("", table.get_ref(), table.span())
    }

    fn section(&mut self, path: &str, table: &DeTable, span: Span) -> Section {
        // What the parser puts in place of a value that is no TOML has no text.
        let written = table.iter().filter(|(_, v)| !v.span().is_empty());
        let mut pairs: Vec<_> = written.collect();
        pairs.sort_by_key(|(name, _)| name.span().start);
        let mut section = Section {
            path: path.to_owned(),
            span,
            ..Section::default()
        };
        let known = keys::children(path);
        let names = pairs.iter().map(|(name, _)| -> &str { name.get_ref() });
        let unknown: Vec<&str> = names.filter(|name| !known.contains(name)).collect();
        for (name, value) in pairs {
            let text: &str = name.get_ref();
            let child = if known == ["*"] {
                section.child("*")
            } else if known.contains(&text) {
                section.child(text)
            } else {
                let is_table = value.get_ref().is_table();
                let message = format!("unknown key '{text}' in {}", advice::shown(path));
                let help = advice::noise_of(path, text)
                    .or_else(|| advice::shape_of(path, text))
                    .or_else(|| advice::error_of_sensor(path, text, table))
                    .unwrap_or_else(|| advice::key(path, text, (&known, &unknown), is_table));
                self.error("S102", &name.span(), message, help);
                section.rejected.push(text.to_owned());
                continue;
            };
            if let Some(node) = self.node(&child, text, value, &name.span()) {
                section.entries.push(Entry {
                    name: text.to_owned(),
                    span: name.span(),
                    node,
                });
            } else {
                section.rejected.push(text.to_owned());
            }
        }
        section
    }

    fn node(
        &mut self,
        path: &str,
        name: &str,
        value: &Spanned<DeValue>,
        name_span: &Span,
    ) -> Option<Node> {
        if let Some(key) = keys::find(path) {
            return self.value(key, name, value).map(Node::Value);
        }
        let element = format!("{path}[]");
        if keys::children(&element).is_empty() {
            let Some(table) = value.get_ref().as_table() else {
                let further = format!("world.{path}[]");
                let several = value.get_ref().is_array();
                let help = if several && !keys::children(&further).is_empty() {
                    format!(
                        "write [{path}], and {} for a further one",
                        advice::shown(&further)
                    )
                } else {
                    advice::table(path)
                };
                self.wrong_type_with(name, "a table", value, &help);
                return None;
            };
            return Some(Node::Table(self.section(path, table, name_span.clone())));
        }
        let Some(array) = value.get_ref().as_array() else {
            let expected = format!("an array of tables, {}", advice::shown(&element));
            self.wrong_type(name, &expected, value);
            return None;
        };
        let mut sections = Vec::new();
        for value in array {
            if let Some(table) = value.get_ref().as_table() {
                sections.push(self.section(&element, table, value.span()));
            } else {
                self.wrong_type(name, "an array of tables", value);
            }
        }
        Some(Node::Tables(sections))
    }

    pub(super) fn wrong_type(&mut self, name: &str, expected: &str, value: &Spanned<DeValue>) {
        let help = value.get_ref().as_str().map(advice::quoted);
        self.wrong_type_with(name, expected, value, &help.unwrap_or_default());
    }

    pub(super) fn wrong_type_with(
        &mut self,
        name: &str,
        expected: &str,
        value: &Spanned<DeValue>,
        help: &str,
    ) {
        let found = value.get_ref().type_str();
        let message = format!(
            "'{name}' must be {expected}, not {} {found}",
            advice::article(found)
        );
        self.error("S103", &value.span(), message, help);
    }

    fn value(&mut self, key: &Key, name: &str, value: &Spanned<DeValue>) -> Option<Value> {
        let told = self.findings.len();
        let read = self.checked(key, name, value);
        for finding in &mut self.findings[told..] {
            finding.help = finding.help.take().or_else(|| advice::meaning(key));
        }
        read
    }

    fn checked(&mut self, key: &Key, name: &str, value: &Spanned<DeValue>) -> Option<Value> {
        match key.takes {
            Takes::Number(range) | Takes::NumberOrRatio(range) => {
                let ratio = matches!(key.takes, Takes::NumberOrRatio(_));
                self.number(name, range, ratio, value).map(Value::Number)
            }
            Takes::Flag => {
                if let Some(flag) = value.get_ref().as_bool() {
                    Some(Value::Flag(flag))
                } else {
                    self.wrong_type(name, "true or false", value);
                    None
                }
            }
            Takes::Word(words) => {
                if let Some(word) = value.get_ref().as_str() {
                    self.word(name, words, word, value)
                } else {
                    self.wrong_type(name, &advice::one_of(words), value);
                    None
                }
            }
            Takes::Pattern => {
                if let Some(text) = value.get_ref().as_str() {
                    Some(Value::Texts(vec![(text.to_owned(), value.span())]))
                } else {
                    self.wrong_type(name, "a name or glob in quotes", value);
                    None
                }
            }
            Takes::Name | Takes::File => match value.get_ref().as_str().map(str::trim) {
                Some("") => {
                    let message = format!("'{name}' must not be empty");
                    self.error("S104", &value.span(), message, "");
                    None
                }
                Some(text) => Some(Value::Texts(vec![(text.to_owned(), value.span())])),
                None => {
                    let file = matches!(key.takes, Takes::File);
                    let what = if file { "file's name" } else { "name" };
                    self.wrong_type(name, &format!("a {what} in quotes"), value);
                    None
                }
            },
            Takes::Count(most) => {
                let found = value.get_ref();
                if !found.is_integer() && !found.is_float() {
                    self.wrong_type(name, "a whole number", value);
                    return None;
                }
                // `1e3` is one, too.
                let float = found
                    .as_float()
                    .and_then(|float| float.as_str().parse().ok());
                let number: Option<f64> = whole(found).map(f64::from).or(float);
                let fits = |n: &f64| n.fract() == 0.0 && (1.0..=f64::from(most)).contains(n);
                if let Some(number) = number.filter(fits) {
                    return Some(Value::Number(number));
                }
                let message = format!("'{name}' must be a whole number from 1 to {most}");
                let help = number.map(|number| advice::count(name, number, most));
                self.error("S104", &value.span(), message, help.unwrap_or_default());
                None
            }
            Takes::Version(versions) => {
                let number = whole(value.get_ref()).filter(|number| versions.contains(number));
                if number.is_none() {
                    let list: Vec<String> = versions.iter().map(ToString::to_string).collect();
                    let message = format!("'{name}' must be {}", list.join(" or "));
                    self.error("S104", &value.span(), message, "");
                }
                number.map(|number| Value::Number(f64::from(number)))
            }
            Takes::PatternOrPatterns if value.get_ref().is_str() => {
                let text = value.get_ref().as_str().unwrap_or_default();
                Some(Value::Texts(vec![(text.to_owned(), value.span())]))
            }
            Takes::PatternOrPatterns | Takes::Patterns | Takes::WordOrPatterns(_) => {
                self.patterns(key, name, value)
            }
            Takes::Numbers(least, most, range) => self.numbers(name, (least, most), range, value),
            Takes::Vectors(count, range) => self.vectors(name, count, range, value),
        }
    }

    fn word(
        &mut self,
        name: &str,
        words: &[&str],
        word: &str,
        value: &Spanned<DeValue>,
    ) -> Option<Value> {
        if words.contains(&word) {
            return Some(Value::Word(word.to_owned()));
        }
        let help = did_you_mean(word, words.iter().copied());
        let message = format!("'{name}' must be {}, not '{word}'", advice::one_of(words));
        self.error("S104", &value.span(), message, help);
        None
    }

    fn patterns(&mut self, key: &Key, name: &str, value: &Spanned<DeValue>) -> Option<Value> {
        let words = match key.takes {
            Takes::WordOrPatterns(words) => words,
            _ => &[],
        };
        let mut expected = match key.takes {
            Takes::PatternOrPatterns => "a name or glob, or a list of them",
            _ => "a list of names or globs",
        }
        .to_owned();
        if !words.is_empty() {
            expected = format!("{} or {expected}", advice::one_of(words));
        }
        let alone = value.get_ref().as_str();
        if let Some(word) = alone.filter(|word| words.contains(word)) {
            return Some(Value::Word(word.to_owned()));
        }
        if let (Some(one), false) = (alone, words.is_empty()) {
            let message = format!("'{name}' must be {expected}, not '{one}'");
            let help = advice::list_of(name, one, words);
            self.error("S104", &value.span(), message, help);
            return None;
        }
        let Some(array) = value.get_ref().as_array() else {
            let help = alone.map_or_else(String::new, |one| advice::list_of(name, one, words));
            self.wrong_type_with(name, &expected, value, &help);
            return None;
        };
        let mut texts = Vec::new();
        for element in array {
            if let Some(text) = element.get_ref().as_str() {
                texts.push((text.to_owned(), element.span()));
            } else {
                self.wrong_type(name, &expected, element);
            }
        }
        (texts.len() == array.len()).then_some(Value::Texts(texts))
    }
}
