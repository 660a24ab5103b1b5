//! Files in xacro that include a file: which of them is the robot's, if the given file is only a
//! part of it.
//!
//! They are looked for in the file's package, and if none of its files does, in the workspace or
//! repository that holds it, or else in the folder above.

use super::folders;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use urdf2fmu_core::folder;
use urdf2fmu_core::urdf;

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

/// A file as another one names it.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Named {
    /// By `$(find package)`.
    package: Option<String>,
    /// Without its folders.
    name: String,
}

/// A file in xacro.
struct Text {
    /// The folder of its package, or the one that holds it.
    package: PathBuf,
    named: BTreeSet<Named>,
}

/// The files that include `file`, themselves or through others, and that no file includes in turn;
/// the shortest names first.
fn of(file: &Path) -> Vec<PathBuf> {
    let folder = folder::of(file);
    let package = folders::package_of(folder).unwrap_or(folder);
    let near = among(file, package);
    if !near.is_empty() {
        return near;
    }
    let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let folder = folder::of(&file);
    let package = folders::package_of(folder).unwrap_or(folder);
    let around = urdf::checkout(folder)
        .or_else(|| folders::of_packages(package))
        .or_else(|| urdf::above(package));
    around.map_or_else(Vec::new, |around| among(&file, &around))
}

/// Those among the files below a folder.
fn among(file: &Path, folder: &Path) -> Vec<PathBuf> {
    let Some(own) = file.file_name() else {
        return Vec::new();
    };
    let texts = folders::texts(folder, folders::XACRO);
    let texts = texts.into_iter().map(|(path, text)| {
        let package = folders::package_of(folder::of(&path)).unwrap_or(folder);
        let text = Text {
            package: package.to_owned(),
            named: named(&text),
        };
        (path, text)
    });
    let texts: BTreeMap<PathBuf, Text> = texts.collect();
    let mut known: BTreeMap<PathBuf, Option<String>> = BTreeMap::new();
    for text in texts.values() {
        known
            .entry(text.package.clone())
            .or_insert_with_key(|folder| urdf::package_name(folder));
    }
    let home = folders::package_of(folder::of(file)).unwrap_or(folder);
    // Another package's file is named with its package.
    let includes = |text: &Text, name: &str, package: &Path| {
        let mut of_name = text.named.iter().filter(|named| named.name == name);
        let called = known.get(package).and_then(Option::as_ref);
        of_name.any(|named| {
            text.package == package || named.package.is_some() && named.package.as_ref() == called
        })
    };
    let mut reached: BTreeSet<&PathBuf> = BTreeSet::new();
    let mut open = vec![(own.to_string_lossy().into_owned(), home)];
    while let Some((name, package)) = open.pop() {
        for (path, text) in &texts {
            if includes(text, &name, package) && reached.insert(path) {
                let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
                open.extend(name.map(|name| (name, &*text.package)));
            }
        }
    }
    let called = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
        let mut others = texts.iter().filter(|(other, _)| *other != path);
        name.is_some_and(|name| others.any(|(_, text)| includes(text, &name, &texts[path].package)))
    };
    let mut tops: Vec<PathBuf> = reached
        .into_iter()
        .filter(|path| path.file_name() != Some(own) && !called(path))
        .cloned()
        .collect();
    tops.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    tops
}

/// The files that a text includes, and those that it hands to macros and arguments, which include
/// them.
fn named(text: &str) -> BTreeSet<Named> {
    let mut list = BTreeSet::new();
    for tag in uncommented(text).split("<xacro:").skip(1) {
        let tag = tag.split('>').next().unwrap_or_default();
        let include = tag.starts_with("include");
        for value in tag.split('=').skip(1).map(str::trim_start) {
            let quote = value.chars().next().filter(|c| ['"', '\''].contains(c));
            let Some(value) = quote.and_then(|quote| value[1..].split(quote).next()) else {
                continue;
            };
            let name = value.rsplit('/').next().unwrap_or_default();
            let of_xacro = || {
                let kind = Path::new(name).extension().unwrap_or_default();
                folders::XACRO.iter().any(|own| kind == *own)
            };
            if name.is_empty() || !(include || of_xacro()) {
                continue;
            }
            let package = value.split_once("$(find ");
            let package = package.and_then(|(_, rest)| rest.split_once(')'));
            list.insert(Named {
                package: package.map(|(package, _)| package.trim().to_owned()),
                name: name.to_owned(),
            });
        }
    }
    list
}

/// A text without its comments.
pub fn uncommented(text: &str) -> String {
    let mut parts = text.split("<!--");
    let first = parts.next().unwrap_or_default();
    let rest = parts.filter_map(|part| Some(part.split_once("-->")?.1));
    std::iter::once(first).chain(rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_by_includes_and_values_that_are_handed_on() {
        let text = "<robot><!-- <xacro:include filename='old.xacro'/> -->\
            <xacro:include filename='$(find arm)/urdf/a.inc'/>\
            <xacro:boat layout=\"$(find boat)/layouts/h.xacro\" mass='1'/>\
            <xacro:arg name='tool' default='tool.urdf'/><mesh filename='m.urdf'/></robot>";
        let list = named(text);
        let list: Vec<_> = list
            .iter()
            .map(|named| (named.package.as_deref(), &*named.name))
            .collect();
        let expected = [
            (None, "tool.urdf"),
            (Some("arm"), "a.inc"),
            (Some("boat"), "h.xacro"),
        ];
        assert_eq!(list, expected);
    }
}
