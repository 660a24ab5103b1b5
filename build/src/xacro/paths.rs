//! Files that are not there because their paths are made of arguments: what to give.

use super::definitions::{attribute, named};
use super::problem::Problem;
use super::texts::Texts;
use std::collections::BTreeSet;
use std::path::Path;

/// Advice on a file that is not there, where a part of its path is the value of an argument.
pub(super) fn of_argument(texts: &Texts, path: &Path) -> Option<String> {
    /// More names than these are not shown.
    const MOST: usize = 8;
    // The first part that is not there.
    let there = path.ancestors().find(|folder| folder.is_dir())?;
    let part = path.strip_prefix(there).ok()?.iter().next()?;
    let part = part.to_string_lossy();
    let mut arguments = texts.arguments.iter();
    let (name, value) = arguments.find(|(_, value)| {
        let stem = part.strip_prefix(value.as_str());
        !value.is_empty() && stem.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })?;
    let entries = std::fs::read_dir(there).ok()?.flatten();
    // What stands behind the part: only some of the names may lead to it.
    let rest = path.strip_prefix(there.join(&*part)).ok()?;
    let stem = |name: String| match part.strip_prefix(value.as_str()) {
        Some("") | None => there.join(&name).join(rest).is_file().then_some(name),
        Some(ending) => name.strip_suffix(ending).map(str::to_owned),
    };
    let known = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let known: BTreeSet<String> = known
        .filter(|name| !name.starts_with('.'))
        .filter_map(stem)
        .collect();
    if known.is_empty() {
        return None;
    }
    let mut listed: Vec<&str> = known.iter().take(MOST).map(String::as_str).collect();
    if known.len() > MOST {
        listed.push("…");
    }
    Some(format!(
        "the argument '{name}' is '{value}': give another one after the file, {name}:=…; {} has {}",
        there.display(),
        listed.join(", ")
    ))
}

/// Advice on a file that is not there, whose path is made of arguments: all that it is made of.
pub(super) fn of_parts(texts: &Texts, problem: &Problem) -> Option<String> {
    let text = texts.sources.read.get(&problem.file)?;
    let tag = text[problem.at.min(text.len())..].split('>').next()?;
    let read = || texts.sources.read.values();
    let tags: Vec<&str> = read()
        .flat_map(|text| text.split("<xacro:arg").skip(1))
        .collect();
    // An argument may be made of others.
    let mut made: Vec<String> = Vec::new();
    let mut open: Vec<String> = named(tag, "$(arg ").into_iter().collect();
    let mut seen: BTreeSet<String> = BTreeSet::new();
    while let Some(name) = open.pop() {
        if !seen.insert(name.clone()) {
            continue;
        }
        let own = tags
            .iter()
            .find(|tag| attribute(tag, "name").as_ref() == Some(&name));
        let default = own.and_then(|tag| attribute(tag, "default"));
        let others = named(&default.unwrap_or_default(), "$(arg ");
        if others.is_empty() {
            made.push(name);
        }
        open.extend(others);
    }
    made.sort();
    let value = |name: &String| {
        let value = texts.arguments.get(name);
        format!("{name} ('{}')", value.map_or("", String::as_str))
    };
    let shown: Vec<String> = made.iter().map(value).collect();
    let call: Vec<String> = made.iter().map(|name| format!("{name}:=…")).collect();
    (!made.is_empty()).then(|| {
        format!(
            "its path is made of arguments, {}: give other ones after the file, {}",
            shown.join(", "),
            call.join(" ")
        )
    })
}
