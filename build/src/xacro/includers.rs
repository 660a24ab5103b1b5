//! Files in xacro that include a file: which of them is the robot's, if the given file is only a
//! part of it.

use super::folders;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use urdf2fmu_core::folder;

/// What to give in place of a part: nothing, if no file includes it.
pub fn advice(file: &Path) -> Option<String> {
    let files = of(file);
    let shown = || {
        format!(
            "give a file that includes this one:\n{}",
            folders::listed(&files)
        )
    };
    (!files.is_empty()).then(shown)
}

/// The files of the same package that include `file`, themselves or through others, and that no
/// file includes in turn; the shortest names first.
fn of(file: &Path) -> Vec<PathBuf> {
    let Some(own) = file.file_name() else {
        return Vec::new();
    };
    let folder = folder::of(file);
    let texts = folders::texts(
        folders::package_of(folder).unwrap_or(folder),
        folders::XACRO,
    );
    let included = texts
        .into_iter()
        .map(|(path, text)| (path, includes(&text)));
    let included: BTreeMap<PathBuf, BTreeSet<String>> = included.collect();
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
