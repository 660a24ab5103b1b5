//! Findings of the assembly, and selection of joints and links by pattern.

use crate::diagnostic::words::{likeliest, nearest};
use crate::diagnostic::{Diagnostic, Place, Severity, TOLD};
use crate::pattern::Pattern;
use crate::urdf::Description;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Findings so far.
pub(super) struct Findings {
    file: Option<String>,
    /// The URDF.
    text: Arc<str>,
    /// Where its lines start.
    starts: Vec<usize>,
    pub(super) list: Vec<Diagnostic>,
}

impl Findings {
    pub(super) fn new(description: &Description) -> Self {
        Self {
            file: description
                .sources
                .first()
                .map(|path| path.display().to_string()),
            starts: std::iter::once(0)
                .chain(description.text.match_indices('\n').map(|(at, _)| at + 1))
                .collect(),
            text: Arc::clone(&description.text),
            list: Vec::new(),
        }
    }

    /// A line of the URDF, its tag marked; none where the robot was not read from a file.
    pub(super) fn line(&self, line: usize) -> Option<Place> {
        let file = self.file.clone().filter(|_| line > 0)?;
        let start = self.starts.get(line - 1).copied();
        let text = start.map_or("", |start| &self.text[start..]);
        let text = text.lines().next().unwrap_or_default();
        // A line that is too long to show is left out.
        let text = if text.len() > 10_000 { "" } else { text };
        let indent = text.len() - text.trim_start().len();
        let tag = text.trim();
        let tag = tag.find('>').map_or(tag, |end| &tag[..=end]);
        Some(Place {
            file,
            line,
            column: text[..indent].chars().count() + 1,
            length: tag.chars().count().max(1),
            text: text.to_owned(),
        })
    }

    /// The place of the link or joint that a message names, where its line has several: of a URDF
    /// in one line, whatever is found would be at its start.
    fn narrowed(&self, place: Place, message: &str) -> Place {
        let start = self.starts.get(place.line.wrapping_sub(1));
        let (Some(&start), true) = (start, self.file.as_ref() == Some(&place.file)) else {
            return place;
        };
        let line = self.text[start..].lines().next().unwrap_or_default();
        let tag_of = |name: &str| {
            let named = ["\"", "'"].map(|quote| format!(" name={quote}{name}{quote}"));
            let begins = line.match_indices('<').map(|(begin, _)| &line[begin..]);
            let mut tags = begins.map(|tag| &tag[..tag.find('>').map_or(tag.len(), |end| end + 1)]);
            tags.find(|tag| {
                let part = ["<link", "<joint"].iter().any(|part| tag.starts_with(part));
                part && named.iter().any(|named| tag.contains(named))
            })
        };
        // What stands in quotation marks.
        let Some(tag) = message.split('\'').skip(1).step_by(2).find_map(tag_of) else {
            return place;
        };
        let begin = tag.as_ptr() as usize - line.as_ptr() as usize;
        Place {
            column: line[..begin].chars().count() + 1,
            length: tag.chars().count(),
            ..place
        }
    }

    fn add(
        &mut self,
        severity: Severity,
        code: &'static str,
        place: Option<Place>,
        message: String,
        help: &str,
    ) {
        let place = place.map(|place| self.narrowed(place, &message));
        self.list.push(Diagnostic {
            severity,
            code,
            message,
            help: (!help.is_empty()).then(|| help.to_owned()),
            place,
        });
    }

    pub(super) fn note(&mut self, code: &'static str, message: String, help: &str) {
        self.add(Severity::Note, code, None, message, help);
    }

    pub(super) fn warning(
        &mut self,
        code: &'static str,
        place: Option<Place>,
        message: String,
        help: &str,
    ) {
        self.add(Severity::Warning, code, place, message, help);
    }

    pub(super) fn error(
        &mut self,
        code: &'static str,
        place: Option<Place>,
        message: String,
        help: &str,
    ) {
        self.add(Severity::Error, code, place, message, help);
    }

    pub(super) fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// Indices of what `pattern` means among `names`, in order. `unsuitable` says why one cannot be
    /// meant: a glob passes over it, a name that means only such ones is an error.
    pub(super) fn select(
        &mut self,
        pattern: &Pattern,
        kind: &str,
        names: &[&str],
        unsuitable: impl Fn(usize) -> Option<String>,
    ) -> Vec<usize> {
        let matching: Vec<usize> = (0..names.len())
            .filter(|&i| pattern.matches(names[i]))
            .collect();
        let Some(&first) = matching.first() else {
            // A glob that is like nothing has no likeliest meaning.
            let near = if pattern.is_glob() {
                nearest(&pattern.text.replace(['*', '?'], ""), names.iter().copied())
            } else {
                likeliest(&pattern.text, names.iter().copied())
            };
            let help = match near {
                Some(name) => Some(format!("the nearest {kind} is '{name}'")),
                None => (!names.is_empty()).then(|| format!("there are {}", listed(names))),
            };
            let help = pattern.help(help);
            let message = format!("no {kind} matches '{}'", pattern.text);
            // Settings for all there are may be meant for other robots, too.
            if pattern.text == "*" {
                let place = pattern.place.clone();
                self.add(Severity::Note, "A101", place, message, "");
                return Vec::new();
            }
            self.error("A101", pattern.place.clone(), message, &help);
            return Vec::new();
        };
        let suitable: Vec<usize> = matching
            .iter()
            .copied()
            .filter(|&i| unsuitable(i).is_none())
            .collect();
        if suitable.is_empty()
            && let Some(reason) = unsuitable(first)
        {
            let message = format!("{kind} '{}' {reason}", names[first]);
            if pattern.text == "*" {
                let place = pattern.place.clone();
                self.add(Severity::Note, "A102", place, message, "");
                return Vec::new();
            }
            self.error("A102", pattern.place.clone(), message, "choose another one");
        }
        suitable
    }
}

/// Of notes on where each thing starts and how it rubs, which differ in names and numbers alone,
/// the first tells how many there are: those of twenty objects hide all others.
pub(super) fn first_of_many(mut findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let key = |note: &Diagnostic| {
        let said = note.message.split('\'').step_by(2);
        let words: String = said
            .flat_map(str::chars)
            .filter(|c| !c.is_ascii_digit())
            .collect();
        (note.code, note.help.clone(), words)
    };
    let counts = |d: &Diagnostic| {
        d.severity == Severity::Note && d.place.is_none() && ["A111", "A116"].contains(&d.code)
    };
    let mut alike: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (at, note) in findings.iter().enumerate().filter(|(_, d)| counts(d)) {
        alike.entry(key(note)).or_default().push(at);
    }
    let mut left_out: BTreeSet<usize> = BTreeSet::new();
    for places in alike.into_values().filter(|places| places.len() > TOLD) {
        let message = &mut findings[places[0]].message;
        *message = format!("{message} (and alike for {} others)", places.len() - 1);
        left_out.extend(&places[1..]);
    }
    let told = findings.into_iter().enumerate();
    told.filter(|(at, _)| !left_out.contains(at))
        .map(|(_, finding)| finding)
        .collect()
}

/// Up to five names in quotes, and how many more there are.
pub(super) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    const MOST: usize = 5;
    let mut shown: Vec<String> = names
        .iter()
        .take(MOST)
        .map(|name| format!("'{}'", name.as_ref()))
        .collect();
    if names.len() > MOST {
        shown.push(format!("{} more", names.len() - MOST));
    }
    shown.join(", ")
}

/// "1 link", "2 links".
pub(super) fn counted(count: usize, noun: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else {
        format!("{count} {noun}s")
    }
}
