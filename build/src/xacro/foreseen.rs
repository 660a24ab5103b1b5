//! What comes next once that is done which is proposed: a document is expanded again as if it were.
//!
//! A person who follows one message should not meet the next one behind it. What is taken as done
//! is what the messages themselves write out: the value of an argument, a definition before its
//! use, the file of a name. What depends on a guess, such as a name that is near, is not.

use super::definitions::{self, Unread};
use super::expand::Expansion;
use super::findings;
use super::includers;
use super::macros::Macro;
use super::problem::{Lacking, Problem};
use super::sources::Find;
use super::symbols::Entry;
use super::tree::Element;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Diagnostic;

/// Expansions after the first one. Each costs as much as the first, and what is behind three
/// messages is rarely a robot.
const MOST: usize = 3;

/// What is taken as done.
#[derive(Default)]
pub(super) struct Proposed {
    pub arguments: BTreeMap<String, String>,
    pub macros: BTreeMap<String, Rc<Macro>>,
    pub properties: BTreeMap<String, Entry>,
    /// Files that define what is missing, included before all else.
    pub files: Vec<PathBuf>,
    /// Paths at which there is no file, and those that are meant.
    pub meant: BTreeMap<PathBuf, PathBuf>,
}

impl Proposed {
    /// Adds what is proposed for the problems of an expansion; whether that is anything.
    fn add(&mut self, path: &Path, expansion: &Expansion, unread: &mut Unread) -> bool {
        let before = self.count();
        let texts = &expansion.texts;
        let problems = &expansion.problems;
        for (name, known) in findings::lacking_arguments(path, texts, problems) {
            let value = known.map(|known| known.value);
            self.arguments.extend(value.map(|value| (name, value)));
        }
        for problem in problems {
            match &problem.lacking {
                Some(Lacking::Macro(name)) => {
                    let own = expansion.macros.own(name);
                    self.macros.extend(own.map(|own| (name.clone(), own)));
                }
                Some(Lacking::Property(name)) => {
                    let own = texts.symbols.own(name).cloned();
                    self.properties.extend(own.map(|own| (name.clone(), own)));
                }
                Some(Lacking::File(absent)) => {
                    let meant = findings::namesake(absent);
                    self.meant
                        .extend(meant.map(|meant| (absent.clone(), meant)));
                }
                _ => {}
            }
            let file = definitions::not_included(path, texts, problem, unread);
            let file = file.filter(|file| !self.files.contains(file));
            self.files.extend(file);
        }
        self.count() > before
    }

    fn count(&self) -> usize {
        self.arguments.len()
            + self.macros.len()
            + self.properties.len()
            + self.files.len()
            + self.meant.len()
    }
}

/// Findings of an expansion that is refused, and of what comes next; the last of the expansions,
/// and whether it stands for what is proposed.
pub(super) fn all<'f>(
    path: &Path,
    arguments: &[String],
    find: &'f Find<'f>,
    (mut expansion, mut root): (Expansion<'f>, Option<Element>),
) -> (Vec<Diagnostic>, Expansion<'f>, Option<Element>, bool) {
    let mut told = findings::all(path, arguments, &expansion.texts, &expansion.problems);
    told.extend(findings::moved(&expansion.texts));
    let mut proposed = Proposed::default();
    let mut unread = Unread::default();
    let mut known: Vec<Problem> = Vec::new();
    let mut foreseen = false;
    // Who is to give another file needs no more of this one.
    let part = findings::may_be_part(&expansion.problems) && includers::advice(path).is_some();
    for _ in 0..MOST {
        if part || !proposed.add(path, &expansion, &mut unread) {
            break;
        }
        let mut given: Vec<String> = arguments.to_vec();
        let pairs = proposed.arguments.iter();
        given.extend(pairs.map(|(name, value)| format!("{name}:={value}")));
        let mut next = Expansion::new(super::pairs(&given), find);
        let Some(next_root) = next.document_with(path, &proposed) else {
            break;
        };
        known.append(&mut expansion.problems);
        (expansion, root, foreseen) = (next, Some(next_root), true);
        let new = |problem: &Problem| !known.iter().any(|known| known.is_as(problem));
        expansion.problems.retain(new);
        told.extend(findings::all(
            path,
            &given,
            &expansion.texts,
            &expansion.problems,
        ));
        expansion.maybe.retain(new);
    }
    told.extend(findings::maybe(&expansion.texts, &expansion.maybe));
    (told, expansion, root, foreseen)
}
