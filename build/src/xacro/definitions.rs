//! Where a name is defined that a file in xacro uses and does not know.

use super::folders;
use super::problem::{Lacking, Meant, Problem};
use super::texts::Texts;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use urdf2fmu_core::diagnostic::{Place, nearest};
use urdf2fmu_core::folder;

/// How a property begins.
const PROPERTY: &str = "<xacro:property";

/// Files of a package that are not read, with their texts, once they are asked for.
#[derive(Default)]
pub(super) struct Unread(Option<BTreeMap<PathBuf, String>>);

impl Unread {
    fn all(&mut self, path: &Path, texts: &Texts) -> &BTreeMap<PathBuf, String> {
        self.0.get_or_insert_with(|| {
            let package = folders::package(path);
            let all = package.as_deref().unwrap_or(folder::of(path));
            let mut files = folders::texts(all, folders::XACRO);
            let read = texts.sources.read.keys();
            for read in read.filter_map(|read| std::path::absolute(read).ok()) {
                files.remove(&read);
            }
            files
        })
    }

    /// Those that define a macro or a property, and could be included.
    fn defining(&mut self, path: &Path, texts: &Texts, tag: &str, name: &str) -> Vec<PathBuf> {
        // Who has the links that are there already is another robot, and no part of this one.
        let links: BTreeSet<String> = texts.sources.read.values().flat_map(|t| links(t)).collect();
        let files = self.all(path, texts).iter();
        let defines = files.filter(|(_, text)| {
            definition(text, tag, name).is_some() && links.is_disjoint(&self::links(text))
        });
        defines.map(|(file, _)| file.clone()).collect()
    }
}

/// Names of the links that stand in a text, but for those that are computed.
fn links(text: &str) -> BTreeSet<String> {
    let tags = text.split("<link").skip(1);
    let names = tags.filter_map(|tag| attribute(tag, "name"));
    names.filter(|name| !name.contains('$')).collect()
}

/// The tag and the name of the definition that a problem lacks.
fn lacking(problem: &Problem) -> Option<(&'static str, &str)> {
    match &problem.lacking {
        Some(Lacking::Macro(name)) => Some(("<xacro:macro", name)),
        Some(Lacking::Property(name)) => Some((PROPERTY, name)),
        _ => None,
    }
}

/// The one file of the package that defines what a problem lacks, if nothing that is read does.
pub(super) fn not_included(
    path: &Path,
    texts: &Texts,
    problem: &Problem,
    unread: &mut Unread,
) -> Option<PathBuf> {
    let (tag, name) = lacking(problem)?;
    if defined(texts, problem, tag, name).is_some() {
        return None;
    }
    let mut files = unread.defining(path, texts, tag, name);
    files.pop().filter(|_| files.is_empty())
}

/// Where the macro or property is defined that a problem lacks, as advice.
///
/// - `path`: the file that is expanded
/// - `part`: whether files include it, which have what it lacks
pub(super) fn advice(
    path: &Path,
    texts: &Texts,
    problem: &Problem,
    part: bool,
    unread: &mut Unread,
) -> Option<String> {
    let (tag, name) = lacking(problem)?;
    if let Some(defined) = defined(texts, problem, tag, name) {
        return Some(defined);
    }
    let of_property = || unprefixed(texts, name).or_else(|| nearer(texts, problem, name));
    if let Some(told) = (tag == PROPERTY).then(of_property).flatten() {
        return Some(told);
    }
    if part {
        return None;
    }
    let files = unread.defining(path, texts, tag, name);
    let [file] = &files[..] else {
        let files = (!files.is_empty()).then(|| folders::listed(&files));
        return files.map(|files| format!("include one of the files that define it:\n{files}"));
    };
    let folder = std::path::absolute(folder::of(path)).ok();
    let below = folder.and_then(|folder| file.strip_prefix(folder).ok());
    Some(format!(
        "it is defined in a file that is not included, put before its use: \
         <xacro:include filename=\"{}\"/>",
        below.unwrap_or(file).display()
    ))
}

/// Why a name that a file defines, which is read, is not known where it is used.
fn defined(texts: &Texts, problem: &Problem, tag: &str, name: &str) -> Option<String> {
    for (file, text) in &texts.sources.read {
        let Some(at) = definition(text, tag, name) else {
            continue;
        };
        let shown = file.display().to_string();
        let line = Place::in_text(&shown, text, at..at + 1).line;
        // Properties of macros can be handed out.
        let scope = if tag == PROPERTY {
            "; scope=\"parent\" makes what a macro defines known where it is called"
        } else {
            ""
        };
        return Some(if *file == problem.file && at > problem.at {
            format!("it is defined behind this, in line {line}: put the definition before its use")
        } else {
            format!(
                "{shown}:{line} defines it, but later, in another macro or under a condition that \
                 does not hold: put the definition before its use{scope}"
            )
        });
    }
    None
}

/// The parameter of a macro that is written without its prefix, so that it is none.
fn unprefixed(texts: &Texts, name: &str) -> Option<String> {
    let mut read = texts.sources.read.values();
    read.find_map(|text| {
        let mut tags = text.split("<macro").skip(1);
        tags.find_map(|tag| {
            let params = attribute(tag, "params")?;
            let mut params = params.split_whitespace();
            let has = params.any(|param| param.split(":=").next() == Some(name));
            let own = attribute(tag, "name").filter(|_| has)?;
            Some(format!(
                "the macro that has it needs its prefix: write <xacro:macro name=\"{own}\" …>, \
                 and call it by <xacro:{own} …/>"
            ))
        })
    })
}

/// A property of a file that is read whose name is nearer than what was offered.
fn nearer(texts: &Texts, problem: &Problem, name: &str) -> Option<String> {
    let mut names: Vec<String> = Vec::new();
    for text in texts.sources.read.values() {
        let tags = text.split(PROPERTY).skip(1);
        names.extend(tags.filter_map(|tag| attribute(tag, "name")));
    }
    let offered = match &problem.meant {
        Some(Meant::Name(name)) => Some(&**name),
        _ => None,
    };
    let near = nearest(name, names.iter().map(String::as_str).chain(offered))?;
    if offered == Some(near) {
        return None;
    }
    let defined = defined(texts, problem, PROPERTY, near)?;
    Some(format!("did you mean '{near}'? {defined}"))
}

/// Where a text defines a name, bytes, if it does outside of comments.
fn definition(text: &str, tag: &str, name: &str) -> Option<usize> {
    let mut tags = text.match_indices(tag);
    let found = tags.find(|(at, _)| {
        let behind = &text[at + tag.len()..];
        let own = attribute(behind, "name");
        let own = own
            .as_deref()
            .map(|own| own.strip_prefix("xacro:").unwrap_or(own));
        let comment = text[..*at].rfind("<!--");
        // Without a value a property is a block.
        let block = tag == PROPERTY
            && ["value", "default"]
                .iter()
                .all(|key| attribute(behind, key).is_none());
        own == Some(name) && !block && comment.is_none_or(|open| text[open..*at].contains("-->"))
    });
    found.map(|(at, _)| at)
}

/// The words that follow `start` in a text, up to a bracket.
pub(super) fn named(text: &str, start: &str) -> BTreeSet<String> {
    let parts = text.split(start).skip(1);
    let words = parts.filter_map(|part| Some(part.split_once(')')?.0.trim().to_owned()));
    let plain = |word: &String| {
        word.chars()
            .all(|c| c.is_alphanumeric() || "_-".contains(c))
    };
    words
        .filter(|word| !word.is_empty() && plain(word))
        .collect()
}

/// The value of an attribute in the text of a tag behind its name. What is searched may be a
/// comment, and anything may stand there.
pub(super) fn attribute(mut tag: &str, wanted: &str) -> Option<String> {
    loop {
        let (before, rest) = tag.split_once('=')?;
        // The tag ends before it.
        if before.contains('>') {
            return None;
        }
        let rest = rest.trim_start();
        let quote = rest.chars().next().filter(|c| ['"', '\''].contains(c))?;
        let (value, behind) = rest[1..].split_once(quote)?;
        if before.trim() == wanted {
            return Some(value.to_owned());
        }
        tag = behind;
    }
}
