//! Findings of the assembly, and selection of joints and links by pattern.

use crate::diagnostic::words::{likeliest, nearest};
use crate::diagnostic::{Diagnostic, Place, Severity, TOLD};
use crate::pattern::Pattern;
use crate::urdf::{Description, Tag};
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

    /// The place of a tag of the URDF; none where the robot was not read from a file.
    pub(super) fn tag(&self, tag: &Tag) -> Option<Place> {
        let file = self.file.as_ref().filter(|_| tag.line > 0)?;
        // From the start of its line on, so that none is counted again.
        let start = self.starts.get(tag.line - 1).copied();
        let start = start.filter(|start| *start <= tag.at.start && tag.at.end <= self.text.len());
        let (text, at) = start.map_or(("", 0..0), |start| {
            (
                &self.text[start..],
                tag.at.start - start..tag.at.end - start,
            )
        });
        Some(Place {
            line: tag.line,
            ..Place::in_text(file, text, at)
        })
    }

    fn add(
        &mut self,
        severity: Severity,
        code: &'static str,
        place: Option<Place>,
        message: String,
        help: &str,
    ) {
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
