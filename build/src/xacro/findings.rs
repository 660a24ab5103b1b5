//! What is told of a file in xacro that cannot be expanded.

use super::command;
use super::definitions::{self, Unread, attribute, named};
use super::evaluate::NO_KEY;
use super::folders;
use super::includers;
use super::paths;
use super::problem::{Lacking, Meant, Problem};
use super::sources::NAMELESS;
use super::texts::Texts;
use super::values::{self, Known, Launches};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use urdf2fmu_core::diagnostic::words::{of_dead_link, shell};
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity, nearest};
use urdf2fmu_core::folder;

/// What helps where a macro is nowhere to be found.
const DEFINE: &str = "define it, or include the file that does";

/// Whether a file that includes this one may have what a problem lacks.
fn of_others(problem: &Problem) -> bool {
    matches!(
        problem.lacking,
        Some(Lacking::Argument(_) | Lacking::Property(_) | Lacking::Macro(_))
    )
}

/// Whether a file that includes this one may have what it lacks.
pub(super) fn may_be_part(problems: &[Problem]) -> bool {
    problems.iter().any(of_others)
}

/// Arguments without a value, all that the files use and nobody gives, and what may be meant.
pub(super) fn lacking_arguments(
    path: &Path,
    texts: &Texts,
    problems: &[Problem],
) -> Vec<(String, Option<Known>)> {
    let absent = |name: &String| {
        let mut lacking = problems.iter().map(|problem| &problem.lacking);
        lacking.any(|lacking| matches!(lacking, Some(Lacking::Argument(own)) if own == name))
    };
    let any = |problem: &Problem| matches!(problem.lacking, Some(Lacking::Argument(_)));
    if !problems.iter().any(any) {
        return Vec::new();
    }
    let read = || texts.sources.read.values().map(|text| &**text);
    // What stands in a comment neither asks for a value nor gives one.
    let plain: Vec<String> = read().map(includers::uncommented).collect();
    let used: BTreeSet<String> = plain.iter().flat_map(|t| named(t, "$(arg ")).collect();
    let declared: BTreeSet<String> = plain.iter().flat_map(|t| declared_arguments(t)).collect();
    // A default that stands after the first use comes too late.
    let lacking = |name: &String| {
        absent(name) || !declared.contains(name) && !texts.arguments.contains_key(name)
    };
    let mut launches = Launches::default();
    let lacking = used.into_iter().filter(lacking).map(|name| {
        let known = launches.known(path, &name, read());
        (name, known)
    });
    lacking.collect()
}

/// A finding for each problem, and one for all arguments together.
///
/// - `maybe`: what may follow from the problems
pub(super) fn all(
    path: &Path,
    arguments: &[String],
    texts: &Texts,
    (problems, maybe): (&[Problem], &[Problem]),
) -> Vec<Diagnostic> {
    // Nor is it known what a package or a file that is missing has of it.
    let of_files = |problem: &Problem| {
        matches!(
            problem.lacking,
            Some(Lacking::Package(_) | Lacking::File(_))
        )
    };
    let certain = may_be_part(problems);
    let part = certain || problems.iter().any(of_files);
    let part = part.then(|| includers::advice(path)).flatten();
    let mut unread = Unread::default();
    let program = command::advice(path, arguments);
    // What is said of every problem of its kind is said once.
    let general = |help: &String| *help == program || help == DEFINE;
    let mut told = BTreeSet::new();
    let mut list = Vec::new();
    let mut parted = false;
    let mut of_arguments = 0;
    for problem in problems {
        if let Some(Lacking::Argument(_)) = problem.lacking {
            of_arguments += 1;
            if of_arguments > 1 {
                continue;
            }
        }
        let mut finding = finding(path, arguments, texts, (problem, problems));
        if let Some(meant) = &problem.meant {
            finding.help = Some(match (&problem.lacking, finding.help) {
                (Some(Lacking::Argument(_)), Some(help)) => format!("{meant}\nor {help}"),
                _ => meant.to_string(),
            });
        }
        if let (Some(Lacking::Package(_)), Some(unknown)) = (&problem.lacking, of_unknown(maybe)) {
            let help = finding.help.unwrap_or_default();
            finding.help = Some(format!("{help}\n{unknown}"));
        }
        let defined = definitions::advice(path, texts, problem, part.is_some(), &mut unread);
        let known = defined.is_some();
        finding.help = defined.or(finding.help);
        if let (Some(part), false, false, true) = (&part, certain, parted, of_files(problem)) {
            let help = finding.help.unwrap_or_default();
            finding.help = Some(format!("{help}\nor, if this is a part of a robot, {part}"));
            parted = true;
        }
        if let (Some(part), true) = (&part, of_others(problem)) {
            finding.help = match (&problem.lacking, finding.help) {
                (_, help) if parted => help.filter(|help| !general(help)),
                (Some(Lacking::Argument(_)), Some(help)) => Some(format!("{help}\nor {part}")),
                (_, Some(help)) if problem.meant.is_some() || known => {
                    Some(format!("{help}\nor {part}"))
                }
                _ => Some(part.clone()),
            };
            parted = true;
        }
        let help = finding.help;
        finding.help = help.filter(|help| !general(help) || told.insert(help.clone()));
        list.push(finding);
    }
    list
}

/// What to pass with a package that is missing and has macros: what these write is seen only with
/// it, and links of propellers or wheels without a mass would be told next. Where none lacks one,
/// the option changes nothing.
fn of_unknown(maybe: &[Problem]) -> Option<String> {
    /// More names than these are not shown.
    const MOST: usize = 3;
    let names = maybe.iter().filter_map(|problem| match &problem.lacking {
        Some(Lacking::Macro(name)) => Some(format!("'{name}'")),
        _ => None,
    });
    let names: Vec<String> = names.collect();
    let more = if names.len() > MOST { ", …" } else { "" };
    (!names.is_empty()).then(|| {
        format!(
            "what its macros write is not known without it ({}{more}): with --missing-mass 0.1 in \
             the same call, links of them that cannot move without a mass get one",
            names[..names.len().min(MOST)].join(", ")
        )
    })
}

/// What may follow from the problems that are told: names that a file may define which cannot be
/// read.
pub(super) fn maybe(texts: &Texts, problems: &[Problem]) -> Vec<Diagnostic> {
    let finding = |problem: &Problem| Diagnostic {
        severity: Severity::Warning,
        code: "U068",
        message: problem.message.clone(),
        help: problem.meant.as_ref().map(Meant::to_string),
        place: place(texts, problem),
    };
    problems.iter().map(finding).collect()
}

/// The one file that has the name of a file that is not there.
pub(super) fn namesake(path: &Path) -> Option<PathBuf> {
    let mut found = folders::namesakes(path);
    found.pop().filter(|_| found.is_empty())
}

/// Advice on a file that is not there, where files of its name are, or one of a name that is near.
fn of_its_name(path: &Path) -> Option<String> {
    let found = folders::namesakes(path);
    match &found[..] {
        [] => {
            let entries = std::fs::read_dir(folder::of(path)).ok()?.flatten();
            let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
            let names: BTreeSet<String> = names.collect();
            let own = path.file_name()?.to_string_lossy();
            let near = nearest(&own, names.iter().map(String::as_str))?;
            if near == own {
                return None;
            }
            Some(format!(
                "did you mean '{}'?",
                path.with_file_name(near).display()
            ))
        }
        [only] => Some(format!("did you mean '{}'?", only.display())),
        _ => Some(format!(
            "did you mean one of the files of this name?\n{}",
            folders::listed(&found)
        )),
    }
}

/// Warnings of files that are at other places than their names say.
pub(super) fn moved(texts: &Texts) -> Vec<Diagnostic> {
    const CORRECT: &str =
        "correct the path in the file, or pass --package NAME=DIR to say where the package is";
    let finding = |(severity, problem): &(Severity, Problem)| Diagnostic {
        severity: *severity,
        code: "U118",
        message: problem.message.clone(),
        help: Some(match &problem.meant {
            Some(meant) => meant.to_string(),
            None => CORRECT.to_owned(),
        }),
        place: place(texts, problem),
    };
    texts.sources.moved.iter().map(finding).collect()
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
    (problem, problems): (&Problem, &[Problem]),
) -> Diagnostic {
    let name = path.display();
    let (message, help) = if let Some(Lacking::Argument(_)) = problem.lacking {
        let lacking = lacking_arguments(path, texts, problems);
        let listed: Vec<String> = lacking
            .iter()
            .map(|(name, _)| format!("'{name}'"))
            .collect();
        let mut reasons = String::new();
        let mut call = Vec::new();
        for (name, known) in &lacking {
            let value = known
                .as_ref()
                .map_or_else(|| "…".to_owned(), |known| shell(&known.value));
            call.push(format!("{name}:={value}"));
            if let Some(known) = known {
                reasons.push('\n');
                reasons.push_str(&known.reason);
            }
        }
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
            "give them after the file: {}{before} {}{reasons}",
            shell(&name.to_string()),
            call.join(" ")
        );
        (message, help)
    } else if let Some(Lacking::Package(package)) = &problem.lacking {
        (
            format!("{name} cannot be expanded: {}", problem.message),
            of_package(texts, package),
        )
    } else {
        let empty = empty_arguments(texts, arguments);
        let help = match &problem.lacking {
            // No other program finds it either.
            Some(Lacking::File(_)) if !empty.is_empty() && problem.message.contains(NAMELESS) => {
                let call: Vec<String> = empty.iter().map(|name| format!("{name}:=FILE")).collect();
                format!(
                    "arguments that are empty unless they are given: {}; call {name} {}, or give a \
                     file that includes this one with names of files",
                    empty.join(", "),
                    call.join(" ")
                )
            }
            Some(Lacking::File(path)) => of_address(path)
                .or_else(|| of_dead_link(path))
                .or_else(|| paths::of_argument(texts, path))
                .or_else(|| of_its_name(path))
                .or_else(|| paths::of_parts(texts, problem))
                .unwrap_or_else(|| {
                    "put the file there, or correct the path; a relative one counts from the \
                     folder of the file that is read"
                        .to_owned()
                }),
            // No other program knows it either.
            Some(Lacking::Macro(_)) => DEFINE.to_owned(),
            Some(Lacking::Variable(name)) => setting(texts, name),
            None if problem.message.starts_with(NO_KEY) => {
                "correct the key, or the file that the dictionary is read from".to_owned()
            }
            // What is no expression to Python is none to the program, either.
            _ => own(&problem.message).unwrap_or_else(|| command::advice(path, arguments)),
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

/// What to do about what is wrong by the rules of xacro and Python themselves, so that no other
/// program knows more.
fn own(message: &str) -> Option<String> {
    const RULES: [(&str, &str); 9] = [
        (
            "needs a block for",
            "write an element for it between the tags of the call",
        ),
        (
            "$(find-pkg-share",
            "that is of launch files: xacro writes $(find NAME)",
        ),
        ("is not known: there are", "write one of these"),
        ("division by zero", "correct what it is divided by"),
        (
            "neither true nor false",
            "write true, false, 1, 0 or a comparison",
        ),
        ("' is missing in '", "write it"),
        (
            "the expression ends too early",
            "write the rest of it, or leave its last sign out",
        ),
        (
            "there is no block",
            "hand it to the macro, whose params have it as *NAME",
        ),
        (
            "in a circle",
            "leave out the <xacro:include> that leads back",
        ),
    ];
    let rule = RULES.iter().find(|(part, _)| message.contains(part));
    rule.map(|(_, help)| (*help).to_owned())
}

/// What to write for a file that is named as meshes are.
fn of_address(path: &Path) -> Option<String> {
    let name = path.to_str()?;
    let (_, inside) = name.split_once("package://")?;
    let (package, rest) = inside.split_once('/')?;
    Some(format!("xacro names it $(find {package})/{rest}"))
}

/// The call that sets a variable of the environment.
fn setting(texts: &Texts, name: &str) -> String {
    let read = || texts.sources.read.values().map(|text| &**text);
    let value = values::compared(read, name);
    let reason = value.as_ref().map_or("", |_| ", a value of its conditions");
    let value = value.unwrap_or_else(|| "…".to_owned());
    format!("set it in the call{reason}: {name}={value} urdf2fmu …")
}

/// The option that says where a package is.
fn of_package(texts: &Texts, package: &str) -> String {
    match texts.sources.package_in_small_letters(package) {
        Some(folder) => {
            let given = format!("{package}={}", folder.display());
            format!("pass --package {}", shell(&given))
        }
        None => format!(
            "pass --package {package}=DIR, or --package-path DIR where DIR holds the folder \
             '{package}'"
        ),
    }
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
