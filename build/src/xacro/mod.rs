//! Files in xacro, expanded.
//!
//! xacro is XML with macros and expressions in Python. The part of both that robots use is expanded
//! here, so that neither ROS nor Python is needed; the result is the same as that of the xacro
//! command, element by element. Other expressions are left to the xacro command, where it is
//! installed.
//!
//! Findings of later stages give places in the expanded text.

mod command;
mod evaluate;
mod expand;
mod files;
mod format;
mod functions;
mod includers;
mod macros;
mod numbers;
mod parameter;
mod parse;
mod problem;
mod sources;
mod symbols;
mod texts;
mod tree;
mod value;
mod yaml;

pub use command::urdf_name;

use expand::Expansion;
use problem::{Lacking, Problem};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use texts::Texts;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::urdf::{self, ReadOptions};

/// Largest file that is looked into for xacro code, bytes.
const LARGEST: u64 = 64 << 20;

/// What a file in xacro stands for.
#[derive(Debug)]
pub struct Expanded {
    /// The URDF.
    pub text: String,
    /// That it was expanded, and what it may lack.
    pub notes: Vec<Diagnostic>,
    /// Packages that the files name.
    pub packages: Vec<(String, PathBuf)>,
    /// Why it is no robot, where the file only defines macros for others.
    pub lone: Option<Box<Diagnostic>>,
}

/// Whether a file is to be expanded: by its name, or because it defines something in xacro.
pub fn is_xacro(path: &Path) -> bool {
    let named = |ending: &str| {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
    };
    if named("xacro") {
        return true;
    }
    let small = std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() <= LARGEST);
    if !small || !named("urdf") && !named("xml") {
        return false;
    }
    let text = std::fs::read(path).unwrap_or_default();
    defines(&String::from_utf8_lossy(&text))
}

/// Whether a text has tags that only xacro understands. A call alone cannot be expanded: what it
/// calls is nowhere.
fn defines(text: &str) -> bool {
    const TAGS: [&str; 6] = ["include", "macro", "property", "arg", "if", "unless"];
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("<xacro:") {
        // Not in a comment.
        let open = before.rfind("<!--").map(|at| before[at..].contains("-->"));
        if open == Some(false) {
            rest = after.split_once("-->").map_or("", |(_, rest)| rest);
            continue;
        }
        let name = after
            .split(|c: char| !c.is_alphanumeric() && c != '_')
            .next();
        if name.is_some_and(|name| TAGS.contains(&name)) {
            return true;
        }
        rest = after;
    }
    false
}

/// The expanded text, and a note that says so.
///
/// - `arguments`: `name:=value`
/// - `options`: where `$(find package)` looks
///
/// # Errors
/// One finding: what stops the expansion, and what helps.
pub fn expand(
    path: &Path,
    arguments: &[String],
    options: &ReadOptions,
) -> Result<Expanded, Box<Diagnostic>> {
    let pairs = arguments
        .iter()
        .filter_map(|argument| argument.split_once(":="));
    let pairs = pairs.map(|(name, value)| (name.trim().to_owned(), value.trim().to_owned()));
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let find = |name: &str| urdf::find_package(name, folder, options);
    let mut expansion = Expansion::new(pairs.collect(), &find);
    let shown = command::command_line(path, arguments);
    let note = |message: String| Diagnostic {
        severity: Severity::Note,
        code: "U024",
        message,
        help: None,
        place: None,
    };
    let done = expansion.document(path);
    let sources = &expansion.texts.sources;
    let packages = sources.packages.clone();
    match done {
        Ok(root) => {
            let notes = vec![note(format!(
                "expanded from xacro: lines are those of the expanded text, as of {shown}"
            ))];
            let names = expansion.macro_names();
            let lone = root.elements().all(|element| element.name != "link") && !names.is_empty();
            Ok(Expanded {
                text: tree::write(&root),
                notes,
                packages: packages.into_iter().collect(),
                lone: lone.then(|| Box::new(only_macros(path, &names))),
            })
        }
        Err(problem) => {
            let mut known = packages;
            for name in sources
                .read
                .values()
                .flat_map(|text| named(text, "$(find "))
            {
                if let Some(folder) = find(&name) {
                    let folder = std::path::absolute(&folder).unwrap_or(folder);
                    known.entry(name).or_insert(folder);
                }
            }
            if !matches!(problem.lacking, Some(Lacking::Argument))
                && let Some(text) = command::expand(path, arguments, &known)
            {
                return Ok(Expanded {
                    text,
                    notes: vec![note(format!(
                        "expanded by the xacro command: lines are those of the expanded text, see {shown}"
                    ))],
                    packages: known.into_iter().collect(),
                    lone: None,
                });
            }
            Err(Box::new(finding(
                path,
                arguments,
                &expansion.texts,
                &problem,
            )))
        }
    }
}

/// A file of macros is no robot: which files call them.
fn only_macros(path: &Path, names: &[String]) -> Diagnostic {
    /// More names or files than these are not shown.
    const MOST: usize = 8;
    const MOST_FILES: usize = 4;
    let defined = names.iter().take(MOST).cloned().collect::<Vec<_>>();
    let more = if names.len() > MOST { ", …" } else { "" };
    let files = includers::of(path);
    let help = if files.is_empty() {
        format!(
            "give the file that includes this one and calls them, as <xacro:{} …/> does",
            names[0]
        )
    } else {
        let shown: Vec<String> = files
            .iter()
            .take(MOST_FILES)
            .map(|file| file.display().to_string())
            .collect();
        let more = match files.len().saturating_sub(MOST_FILES) {
            0 => String::new(),
            n => format!("\nand {n} more"),
        };
        format!(
            "give a file that includes this one:\n{}{more}",
            shown.join("\n")
        )
    };
    Diagnostic {
        severity: Severity::Error,
        code: "U010",
        message: format!(
            "the robot has no links: {} only defines macros for other files, {}{more}",
            path.display(),
            defined.join(", ")
        ),
        help: Some(help),
        place: None,
    }
}

/// The words that follow `start` in a text, up to a bracket.
fn named(text: &str, start: &str) -> BTreeSet<String> {
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

fn finding(path: &Path, arguments: &[String], texts: &Texts, problem: &Problem) -> Diagnostic {
    let name = path.display();
    let (message, help) = if let Some(Lacking::Argument) = problem.lacking {
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
                let first = problem.message.contains(&format!("'{name}'"));
                first || !declared.contains(name) && !texts.arguments.contains_key(name)
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
        let help = match problem.lacking {
            // No other program finds it either.
            Some(Lacking::File) => {
                "put the file there, or correct the path; a relative one counts from the folder \
                 of the file that is read"
                    .to_owned()
            }
            _ => command::advice(path, arguments),
        };
        (
            format!("{name} cannot be expanded: {}", problem.message),
            help,
        )
    };
    let text = texts.sources.read.get(&problem.file);
    Diagnostic {
        severity: Severity::Error,
        code: "U006",
        message,
        help: Some(help),
        place: text.map(|text| {
            let end = text[problem.at.min(text.len())..].find('>');
            let end = end.map_or(problem.at + 1, |end| problem.at + end + 1);
            Place::in_text(&problem.file.display().to_string(), text, problem.at..end)
        }),
    }
}

/// Names of `<xacro:arg name="…">`.
fn declared_arguments(text: &str) -> BTreeSet<String> {
    let tags = text.split("<xacro:arg").skip(1);
    let names = tags.filter_map(|tag| {
        let tag = tag.split('>').next()?;
        let value = tag
            .split_once("name")?
            .1
            .trim_start()
            .strip_prefix('=')?
            .trim_start();
        let quote = value.chars().next()?;
        Some(value[1..].split(quote).next()?.to_owned())
    });
    names.collect()
}

#[cfg(test)]
mod tests;
