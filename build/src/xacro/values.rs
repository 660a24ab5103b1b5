//! Values for arguments that have none: those that the launch files of the package give, and
//! folders that have what is named below them.

use super::definitions::attribute;
use super::folders;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use urdf2fmu_core::folder;

/// Endings of files that may give values.
const GIVING: &[&str] = &["launch", "xml", "py", "xacro"];

/// How a condition of xacro begins.
const CONDITIONS: [&str; 2] = ["<xacro:if", "<xacro:unless"];

/// A value that an argument may have.
#[derive(Debug, PartialEq)]
pub(super) struct Known {
    pub value: String,
    /// Why it may have it.
    pub reason: String,
}

/// Files of a package that may give values, with their texts, once they are asked for.
#[derive(Default)]
pub(super) struct Launches(Option<BTreeMap<PathBuf, String>>);

impl Launches {
    fn all(&mut self, path: &Path) -> &BTreeMap<PathBuf, String> {
        self.0.get_or_insert_with(|| {
            let folder = folders::package(path);
            folders::texts(&folder.unwrap_or_default(), GIVING)
        })
    }

    /// A value of the argument `name` of the file `path`.
    ///
    /// - `read`: texts that use the argument
    pub(super) fn known<'t>(
        &mut self,
        path: &Path,
        name: &str,
        mut read: impl Iterator<Item = &'t str> + Clone,
    ) -> Option<Known> {
        // A package may have several robots, each with launch files of its own.
        let own = path.file_name().unwrap_or_default().to_string_lossy();
        let all = self.all(path);
        for of_it in [true, false] {
            for way in [called, declared, of_xacro] {
                let files = all.iter().filter(|(_, text)| text.contains(&*own) == of_it);
                let found = files.into_iter().find_map(|(file, text)| {
                    let value = way(text, name)?;
                    let reason = format!("{name}:={value} is what {} gives", file.display());
                    Some(Known { value, reason })
                });
                if found.is_some() {
                    return found;
                }
            }
        }
        if let Some(folder) = having(path, name, read.clone()) {
            return Some(Known {
                reason: format!("{} has what {name} names", folder.display()),
                value: folder.display().to_string(),
            });
        }
        read.any(|text| is_condition(text, name)).then(|| Known {
            value: "false".to_owned(),
            reason: format!("{name} is a condition: true or false"),
        })
    }
}

/// The one folder that has all files that texts name below the value of an argument; of several the
/// one that is nearest to the file.
fn having<'t>(path: &Path, name: &str, read: impl Iterator<Item = &'t str>) -> Option<PathBuf> {
    let start = format!("$(arg {name})/");
    let rests = read.flat_map(|text| {
        let behind = text.split(&*start).skip(1);
        behind.filter_map(|behind| behind.split(['"', '\'']).next())
    });
    let rests: BTreeSet<&str> = rests.filter(|rest| !rest.contains('$')).collect();
    let first = *rests.first()?;
    let path = std::path::absolute(path).ok()?;
    let home = folders::package(&path).unwrap_or_else(|| folder::of(&path).to_owned());
    let folders = folders::files(&home).into_iter().filter_map(|file| {
        let above = Path::new(first).components().count();
        file.ends_with(first)
            .then(|| file.ancestors().nth(above).map(Path::to_owned))?
    });
    let all = |folder: &PathBuf| rests.iter().all(|rest| folder.join(rest).is_file());
    let shared = |folder: &PathBuf| {
        let pairs = folder.components().zip(path.components());
        pairs.take_while(|(a, b)| a == b).count()
    };
    let mut found: Vec<(usize, PathBuf)> = folders
        .filter(all)
        .map(|folder| (shared(&folder), folder))
        .collect();
    found.sort();
    let (most, nearest) = found.pop()?;
    let alone = found.last().is_none_or(|(next, _)| *next < most);
    alone.then_some(nearest)
}

/// What a call of the xacro program gives.
fn called(text: &str, name: &str) -> Option<String> {
    places(text, &format!("{name}:=")).find_map(|behind| {
        let behind = behind.strip_prefix(['"', '\'']).unwrap_or(behind);
        let end = behind.find(|c: char| c.is_whitespace() || "\"'>,)".contains(c));
        plain(&behind[..end?])
    })
}

/// The default of an argument of a launch file that a call passes on.
fn declared(text: &str, name: &str) -> Option<String> {
    places(text, &format!("{name}:=")).next()?;
    let quoted = ['"', '\''].map(|quote| format!("{quote}{name}{quote}"));
    let mut behind = quoted.iter().flat_map(|name| text.split(name).skip(1));
    behind.find_map(|behind| {
        let own = behind.split(['>', ')']).next()?;
        let value = own.split_once("default")?.1;
        let value = value.strip_prefix("_value").unwrap_or(value).trim_start();
        let value = value.strip_prefix('=')?.trim_start();
        let quote = value.chars().next().filter(|c| "\"'".contains(*c))?;
        plain(value[1..].split(quote).next()?)
    })
}

/// The default that another file in xacro declares.
fn of_xacro(text: &str, name: &str) -> Option<String> {
    let mut tags = text.split("<xacro:arg").skip(1);
    tags.find_map(|tag| {
        let own = attribute(tag, "name").as_deref() == Some(name);
        plain(&own.then(|| attribute(tag, "default"))??)
    })
}

/// Whether a text has a condition that is an argument and nothing else.
fn is_condition(text: &str, name: &str) -> bool {
    let wanted = format!("$(arg {name})");
    CONDITIONS.iter().any(|start| {
        let mut tags = text.split(start).skip(1);
        tags.any(|tag| attribute(tag, "value").as_ref() == Some(&wanted))
    })
}

/// A value with which a condition compares a variable of the environment, or a property or an
/// argument that takes its value from there.
///
/// - `read`: texts that use it
pub(super) fn compared<'t, T: Iterator<Item = &'t str>>(
    read: impl Fn() -> T,
    name: &str,
) -> Option<String> {
    const HOLDERS: [(&str, &str); 2] = [("<xacro:property", "value"), ("<xacro:arg", "default")];
    let own = format!("$(env {name})");
    let mut names = vec![own.clone()];
    for (text, (start, value)) in read().flat_map(|text| HOLDERS.map(|holder| (text, holder))) {
        let tags = text.split(start).skip(1);
        let holders = tags.filter(|tag| attribute(tag, value).as_ref() == Some(&own));
        names.extend(holders.filter_map(|tag| attribute(tag, "name")));
    }
    let tags = read().flat_map(|text| {
        let tags = CONDITIONS
            .iter()
            .flat_map(|start| text.split(start).skip(1));
        tags.filter_map(|tag| attribute(tag, "value"))
    });
    tags.into_iter().find_map(|condition| {
        let mut behind = names.iter().flat_map(|name| places(&condition, name));
        behind.find_map(|behind| {
            // What stands between two values is no word.
            let quoted = behind.split(['\'', '"']);
            quoted.skip(1).find_map(plain)
        })
    })
}

/// What stands behind a word, not behind another one that ends alike.
fn places<'t>(text: &'t str, word: &'t str) -> impl Iterator<Item = &'t str> {
    let whole = |at: usize| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    let found = text.match_indices(word).filter(move |(at, _)| whole(*at));
    found.map(|(at, word)| &text[at + word.len()..])
}

/// A value that is neither empty nor computed.
fn plain(value: &str) -> Option<String> {
    let letters = |c: char| c.is_alphanumeric() || "_-+./".contains(c);
    (!value.is_empty() && value.chars().all(letters)).then(|| value.to_owned())
}
