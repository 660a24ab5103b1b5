//! What is told of a file in xacro that cannot be expanded.

use super::command;
use super::includers;
use super::problem::{Lacking, Problem};
use super::sources::NAMELESS;
use super::texts::Texts;
use std::collections::BTreeSet;
use std::path::Path;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity, nearest};

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

/// A finding for each problem, and one for all arguments together.
pub(super) fn all(
    path: &Path,
    arguments: &[String],
    texts: &Texts,
    problems: &[Problem],
) -> Vec<Diagnostic> {
    let absent = |problem: &Problem| match &problem.lacking {
        Some(Lacking::Argument(name)) => Some(name.clone()),
        _ => None,
    };
    let absent: Vec<String> = problems.iter().filter_map(absent).collect();
    // What a file that includes this one may have.
    let of_others = |problem: &Problem| {
        matches!(
            problem.lacking,
            Some(Lacking::Argument(_) | Lacking::Property(_) | Lacking::Macro(_))
        )
    };
    let part = problems.iter().any(of_others);
    let part = part.then(|| includers::advice(path)).flatten();
    let program = command::advice(path, arguments);
    let mut list = Vec::new();
    let (mut advised, mut parted) = (false, false);
    let mut of_arguments = 0;
    for problem in problems {
        if let Some(Lacking::Argument(_)) = problem.lacking {
            of_arguments += 1;
            if of_arguments > 1 {
                continue;
            }
        }
        let mut finding = finding(path, arguments, texts, (problem, &absent));
        // The files that include this one, and the other program, are named once.
        if let Some(meant) = &problem.meant {
            finding.help = Some(match (&problem.lacking, finding.help) {
                (Some(Lacking::Argument(_)), Some(help)) => format!("{meant}\nor {help}"),
                _ => meant.clone(),
            });
        }
        if let (Some(part), true) = (&part, of_others(problem)) {
            finding.help = match (&problem.lacking, finding.help) {
                (_, help) if parted => help.filter(|help| *help != program),
                (Some(Lacking::Argument(_)), Some(help)) => Some(format!("{help}\nor {part}")),
                (_, Some(help)) if problem.meant.is_some() => Some(format!("{help}\nor {part}")),
                _ => Some(part.clone()),
            };
            parted = true;
        }
        if finding.help.as_ref() == Some(&program) {
            finding.help = finding.help.filter(|_| !advised);
            advised = true;
        }
        list.push(finding);
    }
    list
}

/// What may follow from the problems that are told: names that a file may define which cannot be
/// read.
pub(super) fn maybe(texts: &Texts, problems: &[Problem]) -> Vec<Diagnostic> {
    let finding = |problem: &Problem| Diagnostic {
        severity: Severity::Warning,
        code: "U068",
        message: problem.message.clone(),
        help: problem.meant.clone(),
        place: place(texts, problem),
    };
    problems.iter().map(finding).collect()
}

/// Advice on a file that is not there, where a part of its path is the value of an argument.
fn of_argument(texts: &Texts, message: &str) -> Option<String> {
    /// More names than these are not shown.
    const MOST: usize = 8;
    let (path, _) = message.split_once(" cannot be read")?;
    let path = Path::new(path.strip_prefix("the included file ").unwrap_or(path));
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
    let known = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let known: BTreeSet<String> = known.filter(|name| !name.starts_with('.')).collect();
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

/// The tag of a problem.
fn place(texts: &Texts, problem: &Problem) -> Option<Place> {
    let text = texts.sources.read.get(&problem.file)?;
    let end = text[problem.at.min(text.len())..].find('>');
    let end = end.map_or(problem.at + 1, |end| problem.at + end + 1);
    let file = problem.file.display().to_string();
    Some(Place::in_text(&file, text, problem.at..end))
}

fn finding(
    path: &Path,
    arguments: &[String],
    texts: &Texts,
    (problem, absent): (&Problem, &[String]),
) -> Diagnostic {
    let name = path.display();
    let (message, help) = if let Some(Lacking::Argument(_)) = problem.lacking {
        // All that the files use and nobody gives.
        let used = texts
            .sources
            .read
            .values()
            .flat_map(|text| named(text, "$(arg "));
        let declared: BTreeSet<String> = texts
            .sources
            .read
            .values()
            .flat_map(|text| declared_arguments(text))
            .collect();
        let lacking: Vec<String> = used
            .collect::<BTreeSet<_>>()
            .into_iter()
            .filter(|name| {
                // A default that stands after the first use comes too late.
                absent.contains(name)
                    || !declared.contains(name) && !texts.arguments.contains_key(name)
            })
            .collect();
        let listed: Vec<String> = lacking.iter().map(|name| format!("'{name}'")).collect();
        let call: Vec<String> = lacking.iter().map(|name| format!("{name}:=…")).collect();
        let before: String = arguments
            .iter()
            .flat_map(|argument| [" ", argument])
            .collect();
        let message = if lacking.len() > 1 {
            format!(
                "the arguments {} of {name} have no values",
                listed.join(", ")
            )
        } else {
            format!("{name}: {}", problem.message)
        };
        let help = format!(
            "give them after the file: {name}{before} {}",
            call.join(" ")
        );
        (message, help)
    } else if let Some(Lacking::Package(package)) = &problem.lacking {
        (
            format!("{name} cannot be expanded: {}", problem.message),
            format!(
                "pass --package {package}=DIR, or --package-path DIR where DIR holds the folder '{package}'"
            ),
        )
    } else {
        let empty = empty_arguments(texts, arguments);
        let help = match problem.lacking {
            // No other program finds it either.
            Some(Lacking::File) if !empty.is_empty() && problem.message.contains(NAMELESS) => {
                let call: Vec<String> = empty.iter().map(|name| format!("{name}:=FILE")).collect();
                format!(
                    "arguments that are empty unless they are given: {}; call {name} {}, or give a \
                     file that includes this one with names of files",
                    empty.join(", "),
                    call.join(" ")
                )
            }
            Some(Lacking::File) => of_argument(texts, &problem.message).unwrap_or_else(|| {
                "put the file there, or correct the path; a relative one counts from the folder \
                 of the file that is read"
                    .to_owned()
            }),
            _ => command::advice(path, arguments),
        };
        (
            format!("{name} cannot be expanded: {}", problem.message),
            help,
        )
    };
    Diagnostic {
        severity: Severity::Error,
        code: "U006",
        message,
        help: Some(help),
        place: place(texts, problem),
    }
}

/// Warnings of arguments that are given and that no file asks for: a name that is wrong would
/// change nothing.
pub(super) fn unasked(arguments: &[String], texts: &Texts) -> Vec<Diagnostic> {
    let read = || texts.sources.read.values();
    let mut asked: BTreeSet<String> = read().flat_map(|text| declared_arguments(text)).collect();
    asked.extend(read().flat_map(|text| named(text, "$(arg ")));
    // Expressions ask for arguments in more ways.
    let by_name = |name: &str| {
        let mut texts = read().filter(|text| text.contains("eval ") || text.contains(".arg("));
        texts.any(|text| text.contains(name))
    };
    let names = arguments
        .iter()
        .filter_map(|argument| argument.split_once(":="));
    let names = names.map(|(name, _)| name.trim());
    let unasked = names.filter(|name| !asked.contains(*name) && !by_name(name));
    let warning = |name: &str| Diagnostic {
        severity: Severity::Warning,
        code: "U006",
        message: format!("no file in xacro has an argument '{name}', so that it changes nothing"),
        help: match (nearest(name, asked.iter().map(String::as_str)), asked.len()) {
            (Some(near), _) => Some(format!("did you mean '{near}'?")),
            (None, 0) => Some("leave it out".to_owned()),
            (None, _) => {
                let asked: Vec<&str> = asked.iter().map(String::as_str).collect();
                Some(format!("there are: {}", asked.join(", ")))
            }
        },
        place: None,
    };
    unasked.map(warning).collect()
}

/// Arguments that nobody gives and whose default is empty.
fn empty_arguments(texts: &Texts, arguments: &[String]) -> Vec<String> {
    let read = texts.sources.read.values();
    let tags = read.flat_map(|text| text.split("<xacro:arg").skip(1));
    let empty = tags.filter(|tag| attribute(tag, "default").is_some_and(|value| value.is_empty()));
    let names: BTreeSet<String> = empty.filter_map(|tag| attribute(tag, "name")).collect();
    let given = |name: &str| {
        arguments
            .iter()
            .any(|a| a.starts_with(&format!("{name}:=")))
    };
    names.into_iter().filter(|name| !given(name)).collect()
}

/// Names of `<xacro:arg name="…">`.
fn declared_arguments(text: &str) -> BTreeSet<String> {
    let tags = text.split("<xacro:arg").skip(1);
    tags.filter_map(|tag| attribute(tag, "name")).collect()
}

/// The value of an attribute in the text of a tag behind its name. What is searched may be a
/// comment, and anything may stand there.
fn attribute(mut tag: &str, wanted: &str) -> Option<String> {
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
