//! Files in xacro that include a file: which of them is the robot's, if the given file is only a
//! part of it.

use super::folders::{self, HIGHEST};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use urdf2fmu_core::encoding::xml_replaced;

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
    let in_xacro = |path: &PathBuf| {
        let named = |ending| path.extension().is_some_and(|own| own == ending);
        (named("xacro") || named("urdf"))
            && fs::metadata(path).is_ok_and(|file| file.len() <= LARGEST)
    };
    let files = folders::files(folder).into_iter().filter(in_xacro);
    let included = files.map(|path| {
        let text = xml_replaced(fs::read(&path).unwrap_or_default());
        (path, includes(&text))
    });
    included.collect()
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
