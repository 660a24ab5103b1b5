//! The files of a package, and those that are meant by a path at which there is none.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use urdf2fmu_core::encoding::xml_replaced;
use urdf2fmu_core::{folder, urdf};

/// How far above a file the folder of its package may be.
const HIGHEST: usize = 6;

/// Files and folders that are looked at.
const MOST_ENTRIES: usize = 5000;

/// Folders below each other that are looked into.
const DEEPEST: usize = 8;

/// Largest file that is looked into, bytes.
const LARGEST: u64 = 4 << 20;

/// The folder of the package in which a path is, whether or not there is something at it.
pub fn package(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    package_of(path.parent()?).map(Path::to_owned)
}

/// The folder of the package to which a folder belongs, by the names in its path alone.
pub fn package_of(folder: &Path) -> Option<&Path> {
    let mut above = folder.ancestors().take(HIGHEST);
    above.find(|folder| folder.join("package.xml").is_file())
}

/// The folder that holds a package beside others: of a repository that was unpacked, nothing else
/// tells how far it goes.
pub fn of_packages(package: &Path) -> Option<PathBuf> {
    let above = package.parent()?.to_owned();
    let entries = fs::read_dir(&above).ok()?.flatten().take(MOST_ENTRIES);
    let packages = entries.filter(|entry| entry.path().join("package.xml").is_file());
    (packages.take(2).count() > 1).then_some(above)
}

/// The files below a folder, no more than are looked at.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
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
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && depth < DEEPEST => {
                    open.push((entry.path(), depth + 1));
                }
                Ok(kind) if kind.is_file() => found.push(entry.path()),
                _ => {}
            }
        }
    }
    found
}

/// Endings of files that may be in xacro.
pub const XACRO: &[&str] = &["xacro", "urdf"];

/// The files below a folder that have one of these endings, and their texts.
pub fn texts(folder: &Path, endings: &[&str]) -> BTreeMap<PathBuf, String> {
    let wanted = |path: &PathBuf| {
        let own = path.extension().unwrap_or_default();
        endings.iter().any(|ending| own == *ending)
            && fs::metadata(path).is_ok_and(|file| file.len() <= LARGEST)
    };
    let files = files(folder).into_iter().filter(wanted);
    let texts = files.map(|path| {
        let text = xml_replaced(fs::read(&path).unwrap_or_default());
        (path, text)
    });
    texts.collect()
}

/// Paths below each other; the first four, and how many more there are.
pub fn listed(files: &[PathBuf]) -> String {
    const MOST: usize = 4;
    let shown = files.iter().take(MOST);
    let mut shown: Vec<String> = shown.map(|file| file.display().to_string()).collect();
    if let more @ 1.. = files.len().saturating_sub(MOST) {
        shown.push(format!("and {more} more"));
    }
    shown.join("\n")
}

/// The one file that a path means at which there is none: with the other slash, below another
/// folder of the package, where it is before the package is installed, or in other upper and lower
/// case.
pub fn meant(path: &Path) -> Option<PathBuf> {
    let shown = path.to_string_lossy();
    if shown.contains('\\') {
        let turned = PathBuf::from(shown.replace('\\', "/"));
        if turned.is_file() {
            return Some(turned);
        }
    }
    let path = std::path::absolute(path).ok()?;
    let Some(package) = package(&path) else {
        return in_other_case(&path);
    };
    let rest = path.strip_prefix(&package).ok()?;
    let mut found = files(&package)
        .into_iter()
        .filter(|file| file.ends_with(rest));
    match (found.next(), found.next()) {
        (None, _) => in_other_case(&path),
        (only, None) => only,
        _ => None,
    }
}

/// The one file of a folder whose name is that of a path in other upper and lower case.
fn in_other_case(path: &Path) -> Option<PathBuf> {
    let own = path.file_name()?.to_string_lossy().to_lowercase();
    let entries = fs::read_dir(path.parent()?).ok()?.flatten();
    let mut found = entries.map(|entry| entry.path()).filter(|path| {
        let name = path.file_name();
        path.is_file() && name.is_some_and(|name| name.to_string_lossy().to_lowercase() == own)
    });
    let only = found.next()?;
    found.next().is_none().then_some(only)
}

/// Files of the package in which a path is that have its name; if there is none, those of the
/// checkout, whose packages need not hold all of its files.
pub fn namesakes(path: &Path) -> Vec<PathBuf> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let of_name = |home: PathBuf| {
        let named = |file: &PathBuf| file.file_name() == path.file_name();
        let mut found: Vec<PathBuf> = files(&home).into_iter().filter(named).collect();
        found.sort();
        (!found.is_empty()).then_some(found)
    };
    let found = package(&path).and_then(of_name);
    let around = || urdf::checkout(folder::of(&path)).and_then(of_name);
    found.or_else(around).unwrap_or_default()
}
