//! Files in xacro that include a file: which of them is the robot's, if the given file is only a
//! part of it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use urdf2fmu_core::encoding::xml_replaced;

/// How far above a file the folder of its package may be.
const HIGHEST: usize = 6;

/// Files and folders that are looked at.
const MOST_ENTRIES: usize = 5000;

/// Folders below each other that are looked into.
const DEEPEST: usize = 8;

/// Largest file that is looked into, bytes.
const LARGEST: u64 = 4 << 20;

/// What to give in place of a part: nothing, if no file includes it.
pub fn advice(file: &Path) -> Option<String> {
    /// More files than these are not shown.
    const MOST: usize = 4;
    let files = of(file);
    let shown = files.iter().take(MOST);
    let mut shown: Vec<String> = shown.map(|file| file.display().to_string()).collect();
    if shown.is_empty() {
        return None;
    }
    if let more @ 1.. = files.len().saturating_sub(MOST) {
        shown.push(format!("and {more} more"));
    }
    let shown = shown.join("\n");
    Some(format!("give a file that includes this one:\n{shown}"))
}

/// The files of the same package that include `file`, themselves or through others, and that no
/// file includes in turn; the shortest names first.
fn of(file: &Path) -> Vec<PathBuf> {
    let Some(own) = file.file_name() else {
        return Vec::new();
    };
    let folder = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let package = folder
        .ancestors()
        .take(HIGHEST)
        .find(|above| above.join("package.xml").is_file());
    let included = included_names(package.unwrap_or(folder));
    let mut reached: BTreeSet<&PathBuf> = BTreeSet::new();
    let mut open = vec![own.to_string_lossy().into_owned()];
    while let Some(name) = open.pop() {
        for (path, names) in &included {
            if names.contains(&name) && reached.insert(path) {
                open.extend(path.file_name().map(|n| n.to_string_lossy().into_owned()));
            }
        }
    }
    let called = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
        let mut others = included.iter().filter(|(other, _)| *other != path);
        name.is_some_and(|name| others.any(|(_, names)| names.contains(&name)))
    };
    let mut tops: Vec<PathBuf> = reached
        .into_iter()
        .filter(|path| path.file_name() != Some(own) && !called(path))
        .cloned()
        .collect();
    tops.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    tops
}

/// The files in xacro below a folder, and the names of the files that each includes.
fn included_names(folder: &Path) -> BTreeMap<PathBuf, BTreeSet<String>> {
    let mut found = BTreeMap::new();
    let mut open = vec![(folder.to_owned(), 0)];
    let mut left = MOST_ENTRIES;
    while let Some((folder, depth)) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        for entry in entries.flatten() {
            let Some(rest) = left.checked_sub(1) else {
                return found;
            };
            left = rest;
            let (path, Ok(kind)) = (entry.path(), entry.file_type()) else {
                continue;
            };
            let named = |ending| path.extension().is_some_and(|own| own == ending);
            if kind.is_dir() && depth < DEEPEST {
                open.push((path, depth + 1));
            } else if kind.is_file()
                && (named("xacro") || named("urdf"))
                && entry.metadata().is_ok_and(|file| file.len() <= LARGEST)
            {
                let text = xml_replaced(fs::read(&path).unwrap_or_default());
                found.insert(path, includes(&text));
            }
        }
    }
    found
}

/// Names of the files that a text includes, without their folders.
fn includes(text: &str) -> BTreeSet<String> {
    let tags = text.split("<xacro:include").skip(1);
    let names = tags.filter_map(|tag| {
        let value = tag.split('>').next()?.split_once("filename")?.1;
        let value = value.trim_start().strip_prefix('=')?.trim_start();
        let quote = value.chars().next()?;
        let name = value[quote.len_utf8()..].split(quote).next()?;
        Some(name.rsplit('/').next()?.to_owned())
    });
    names.filter(|name| !name.is_empty()).collect()
}
