//! What comes next once that is done which is proposed: a document is expanded again as if it were.
//!
//! A person who follows one message should not meet the next one behind it. What is taken as done
//! is what the messages themselves write out: the value of an argument, a definition before its
//! use, the file of a name. What depends on a guess, such as a name that is near, is not.

use super::definitions::{self, Unread};
use super::expand::{Expansion, MOST_AFTER};
use super::findings;
use super::includers;
use super::problem::{Lacking, Problem};
use super::proposed::{Proposed, pairs};
use super::sources::Find;
use super::symbols::Entry;
use super::tree::Element;
use std::path::Path;
use urdf2fmu_core::diagnostic::Diagnostic;

/// Expansions after the first one. Each costs as much as the first, and what is behind three
/// messages is rarely a robot.
const MOST: usize = 3;

/// Adds what is proposed for the problems of an expansion; whether that is anything.
fn add(proposed: &mut Proposed, path: &Path, expansion: &Expansion, unread: &mut Unread) -> bool {
    let before = proposed.count();
    let texts = &expansion.texts;
    let problems = &expansion.problems;
    for (name, known) in findings::lacking_arguments(path, texts, problems) {
        let value = known.map(|known| known.value);
        proposed.arguments.extend(value.map(|value| (name, value)));
    }
    for problem in problems {
        match &problem.lacking {
            Some(Lacking::Macro(name)) => {
                let own = expansion.macros.own(name);
                proposed.macros.extend(own.map(|own| (name.clone(), own)));
            }
            Some(Lacking::Property(name)) => {
                let own = texts.symbols.own(name);
                let own = own.filter(|own| !matches!(own, Entry::Value(v) if v.holds_scope()));
                proposed
                    .properties
                    .extend(own.map(|own| (name.clone(), own.clone())));
            }
            Some(Lacking::File(absent)) => {
                let meant = findings::namesake(absent);
                proposed
                    .meant
                    .extend(meant.map(|meant| (absent.clone(), meant)));
            }
            _ => {}
        }
        let file = definitions::not_included(path, texts, problem, unread);
        let file = file.filter(|file| !proposed.files.contains(file));
        proposed.files.extend(file);
    }
    proposed.count() > before
}

/// Findings of an expansion that is refused, and of what comes next; the last of the expansions,
/// and whether it stands for what is proposed.
pub(super) fn all<'f>(
    path: &Path,
    arguments: &[String],
    find: &'f Find<'f>,
    (mut expansion, mut root): (Expansion<'f>, Option<Element>),
) -> (Vec<Diagnostic>, Expansion<'f>, Option<Element>, bool) {
    let list = (&expansion.problems[..], &expansion.maybe[..]);
    let mut told = findings::all(path, arguments, &expansion.texts, list);
    told.extend(findings::moved(&expansion.texts));
    let mut proposed = Proposed::default();
    let mut unread = Unread::default();
    let mut known: Vec<Problem> = Vec::new();
    let mut foreseen = false;
    // Who is to give another file needs no more of this one.
    let part = findings::may_be_part(&expansion.problems) && includers::advice(path).is_some();
    for _ in 0..MOST {
        // Nor is what goes on for long looked at again.
        if part
            || expansion.after > MOST_AFTER
            || !add(&mut proposed, path, &expansion, &mut unread)
        {
            break;
        }
        let mut given: Vec<String> = arguments.to_vec();
        let more = proposed.arguments.iter();
        given.extend(more.map(|(name, value)| format!("{name}:={value}")));
        let mut next = Expansion::new(pairs(&given), find);
        // Of all expansions the files are the same.
        let read = &expansion.texts.sources.read;
        next.texts.sources.read.clone_from(read);
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
            (&expansion.problems, &expansion.maybe),
        ));
        expansion.maybe.retain(new);
    }
    told.extend(findings::maybe(&expansion.texts, &expansion.maybe));
    (told, expansion, root, foreseen)
}
