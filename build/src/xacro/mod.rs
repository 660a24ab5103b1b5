//! Files in xacro, expanded.
//!
//! xacro is XML with macros and expressions in Python. The part of both that robots use is expanded
//! here, so that neither ROS nor Python is needed; the result is the same as that of the xacro
//! command, element by element. Other expressions are left to the xacro command, where it is
//! installed.
//!
//! Findings of later stages give places in the expanded text.

mod bind;
mod command;
mod conditions;
mod definitions;
mod evaluate;
mod expand;
mod files;
mod findings;
mod folders;
mod foreseen;
mod format;
mod functions;
mod includers;
mod macros;
mod numbers;
mod origins;
mod parameter;
mod parse;
mod paths;
mod problem;
mod proposed;
mod recover;
mod sources;
mod symbols;
mod texts;
mod tree;
mod value;
mod values;
mod yaml;

pub use command::urdf_name;

use expand::Expansion;
use origins::Origins;
use problem::Lacking;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use urdf2fmu_core::diagnostic::{Diagnostic, Severity};
use urdf2fmu_core::encoding::xml_replaced;
use urdf2fmu_core::folder;
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
    /// Where its lines are written; none of what the xacro command has expanded.
    pub origins: Option<Origins>,
    /// Why it is no robot, where the file only defines macros for others.
    pub lone: Option<Box<Diagnostic>>,
}

/// Why a file in xacro cannot be expanded.
#[derive(Debug)]
pub struct Refused {
    /// All that is wrong with it, and what may follow from it.
    pub findings: Vec<Diagnostic>,
    /// What can be expanded of it.
    pub rest: Option<Rest>,
}

/// A URDF without what could not be expanded.
#[derive(Debug)]
pub struct Rest {
    /// The URDF.
    pub text: String,
    /// Lines in which elements begin of which something is left out, and their names.
    pub faulty: BTreeMap<usize, String>,
    /// Whether all elements are there and have their names.
    pub whole: bool,
    /// Packages that the files name.
    pub packages: Vec<(String, PathBuf)>,
    /// Where its lines are written.
    pub origins: Origins,
    /// That lines are those of the text.
    pub note: Diagnostic,
    /// Whether it has what is proposed.
    pub foreseen: bool,
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
    if !small || !["urdf", "srdf", "xml"].into_iter().any(named) {
        return false;
    }
    let text = xml_replaced(std::fs::read(path).unwrap_or_default());
    defines(&text) || asks(&text)
}

/// Whether meshes in a text are named by an argument, which only xacro knows: so it is in parts
/// that other files include.
fn asks(text: &str) -> bool {
    let text = includers::uncommented(text);
    let mut tags = text.split("<mesh").skip(1);
    tags.any(|tag| {
        let tag = tag.split('>').next().unwrap_or_default();
        tag.contains("$(arg ")
    })
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
/// All that stands against the expansion, and what helps.
pub fn expand(
    path: &Path,
    arguments: &[String],
    options: &ReadOptions,
) -> Result<Expanded, Box<Refused>> {
    let find = urdf::package_finder(folder::of(path), options);
    let mut expansion = Expansion::new(proposed::pairs(arguments), &find);
    let shown = command::command_line(path, arguments);
    let note = |message: String| Diagnostic {
        severity: Severity::Note,
        code: "U024",
        message,
        help: None,
        place: None,
    };
    let root = expansion.document(path);
    let sources = &expansion.texts.sources;
    let mut packages = sources.packages.clone();
    let problems = &expansion.problems;
    if let (Some(root), []) = (&root, &problems[..]) {
        let mut notes = vec![note(format!(
            "expanded from xacro: lines are those of the expanded text, as of {shown}"
        ))];
        notes.extend(findings::moved(&expansion.texts));
        notes.extend(findings::unasked(arguments, &expansion.texts));
        let names = expansion.macro_names();
        let written = tree::write(root);
        let origins = Origins {
            lines: written.origins,
            texts: sources.read.clone(),
            macros: names.clone(),
        };
        let lone = root.elements().all(|element| element.name != "link") && !names.is_empty();
        return Ok(Expanded {
            text: written.text,
            notes,
            packages: packages.into_iter().collect(),
            origins: Some(origins),
            lone: lone.then(|| Box::new(only_macros(path, &names))),
        });
    }
    for name in sources
        .read
        .values()
        .flat_map(|text| definitions::named(text, "$(find "))
    {
        if let Some(found) = find(&name) {
            let folder = std::path::absolute(&found.folder).unwrap_or(found.folder);
            packages.entry(name).or_insert(folder);
        }
    }
    let of_argument =
        |problem: &problem::Problem| matches!(problem.lacking, Some(Lacking::Argument(_)));
    if !problems.iter().any(of_argument)
        && let Some(text) = command::expand(path, arguments, &packages)
    {
        return Ok(Expanded {
            text,
            notes: vec![note(format!(
                "expanded by the xacro command: lines are those of the expanded text, see {shown}"
            ))],
            packages: packages.into_iter().collect(),
            origins: None,
            lone: None,
        });
    }
    let (findings, expansion, root, foreseen) =
        foreseen::all(path, arguments, &find, (expansion, root));
    let macros = expansion.macro_names();
    Err(Box::new(Refused {
        findings,
        rest: root.map(|root| {
            let written = tree::write(&root);
            let origins = Origins {
                lines: written.origins,
                texts: expansion.texts.sources.read.clone(),
                macros,
            };
            Rest {
                text: written.text,
                faulty: written.faulty,
                origins,
                whole: expansion.whole,
                packages: packages.into_iter().collect(),
                foreseen,
                note: note(format!(
                    "expanded from xacro as far as possible{}: lines of its elements are those of \
                     the expanded text",
                    if foreseen {
                        ", as if what is proposed were done"
                    } else {
                        ""
                    }
                )),
            }
        }),
    }))
}

/// Names the files that include this one where a finding is about what they may have: links.
pub fn name_includers(path: &Path, findings: &mut [Diagnostic]) {
    let of_links = |finding: &&mut Diagnostic| ["U007", "U010", "U016"].contains(&finding.code);
    if let Some(first) = findings.iter_mut().find(of_links)
        && let Some(advice) = includers::advice(path)
    {
        first.help = Some(match (first.code, first.help.take()) {
            // A name that is near to the one that does not exist, or what else the file may be.
            ("U007" | "U016", Some(help)) => format!("{help}\nor {advice}"),
            _ => advice,
        });
    }
}

/// A file of macros is no robot: which files call them.
fn only_macros(path: &Path, names: &[String]) -> Diagnostic {
    /// More names than these are not shown.
    const MOST: usize = 8;
    let defined = names.iter().take(MOST).cloned().collect::<Vec<_>>();
    let more = if names.len() > MOST { ", …" } else { "" };
    let help = includers::advice(path).unwrap_or_else(|| {
        format!(
            "give the file that includes this one and calls them, as <xacro:{} …/> does",
            names[0]
        )
    });
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

#[cfg(test)]
mod tests;
