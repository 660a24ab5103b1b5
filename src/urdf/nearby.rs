//! Mesh files that lie elsewhere in the robot's folders than their names say, and folders around it
//! that would be the right package path.
//!
//! Packages are renamed, taken out of their repositories and moved from other machines, and the
//! names in the URDF stay: `package://old_name/meshes/arm.stl`, `file:///home/someone/…/arm.stl`,
//! paths that count from a folder of assets. The end of such a name still fits one file.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Entries of folders that are looked at in one search.
const MOST_ENTRIES: usize = 20_000;

/// Folders below each other that are looked into.
const DEEPEST: usize = 8;

/// How far above the robot's folders advice looks.
const HIGHEST: usize = 3;

/// Parts at the end of a name that a file must have: its own name and that of its folder.
const LEAST_PARTS: usize = 2;

/// The files of some folders, by their own names.
#[derive(Debug, Default)]
pub(super) struct Files {
    by_name: BTreeMap<String, Vec<PathBuf>>,
    /// The folders that have been looked into.
    folders: BTreeSet<PathBuf>,
}

impl Files {
    /// Those below `roots`; links are not followed.
    pub(super) fn below(roots: &[PathBuf]) -> Self {
        let mut files = Self::default();
        let mut left = MOST_ENTRIES;
        let mut open: Vec<(PathBuf, usize)> = roots.iter().map(|root| (root.clone(), 0)).collect();
        open.reverse();
        while let Some((folder, depth)) = open.pop() {
            if files.folders.contains(&folder) {
                continue;
            }
            let Ok(entries) = fs::read_dir(&folder) else {
                continue;
            };
            files.folders.insert(folder);
            let mut entries: Vec<fs::DirEntry> = entries.take(left).flatten().collect();
            left -= entries.len().min(left);
            entries.sort_by_key(fs::DirEntry::file_name);
            for entry in entries {
                let Ok(kind) = entry.file_type() else {
                    continue;
                };
                let name = entry.file_name().to_string_lossy().into_owned();
                if kind.is_dir() && depth < DEEPEST && !name.starts_with('.') {
                    open.push((entry.path(), depth + 1));
                } else if kind.is_file() {
                    let list = files.by_name.entry(name.to_lowercase()).or_default();
                    list.push(entry.path());
                }
            }
        }
        files
    }

    /// The one file that ends with more parts of `name` than every other, at least its own name and
    /// that of its folder; where there is none, without regard to upper and lower case. None where
    /// the folder that `name` means is there without the file: what has its name in another folder
    /// is of another robot of the series.
    ///
    /// - `of_package`: the first part is the name of a package; without it, what has other case is
    ///   of another one
    pub(super) fn like(&self, name: &str, of_package: bool) -> Option<&Path> {
        let same = |a: &String, b: &String| a == b;
        let wanted = parts(Path::new(name));
        let least = if of_package {
            wanted.len()
        } else {
            LEAST_PARTS
        };
        let exact = self.alike(&wanted, LEAST_PARTS, same);
        exact.or_else(|| self.alike(&wanted, least, folded))
    }

    fn alike(
        &self,
        wanted: &[String],
        least: usize,
        same: impl Fn(&String, &String) -> bool,
    ) -> Option<&Path> {
        let (own, folder) = wanted.split_last()?;
        let list = self.by_name.get(&own.to_lowercase())?;
        let common = |file: &Path| shared(wanted, file, &same);
        let most = list.iter().map(|file| common(file)).max()?;
        let mut best = list.iter().filter(|file| common(file) == most);
        let found = best.next()?;
        // A bare name has no folder to compare.
        let enough = most >= least.min(wanted.len());
        if !enough || best.next().is_some() {
            return None;
        }
        // The folder of the file has one part less in common than the file itself.
        let mut others = self.folders.iter();
        let missing = others.any(|other| shared(folder, other, folded) >= most);
        (!missing).then_some(found.as_path())
    }

    /// The one file with the last part of `name`.
    pub(super) fn alone(&self, name: &str) -> Option<&Path> {
        let wanted = parts(Path::new(name));
        match &self.by_name.get(&wanted.last()?.to_lowercase())?[..] {
            [file] => Some(file),
            _ => None,
        }
    }
}

/// Folders from where advice looks: those above the robot's, as far as they belong to somebody.
pub(super) fn around(base: &Path) -> Vec<PathBuf> {
    let above = base.ancestors().skip(1).take(HIGHEST);
    // Not the folders of all users, nor the system's.
    let own = above.filter(|folder| folder.components().count() > 3);
    own.last().map(Path::to_owned).into_iter().collect()
}

/// The folder that the package `name` is, if `file` is its `rest`.
pub(super) fn package_of(file: &Path, rest: &str) -> Option<PathBuf> {
    let rest = parts(Path::new(rest));
    let mut folder = file;
    for part in rest.iter().rev() {
        if folder.file_name()?.to_str()? != part {
            return None;
        }
        folder = folder.parent()?;
    }
    Some(folder.to_owned())
}

/// Whether two names differ in upper and lower case alone.
#[expect(
    clippy::ptr_arg,
    reason = "for parts of paths, as they are compared otherwise"
)]
fn folded(a: &String, b: &String) -> bool {
    a.to_lowercase() == b.to_lowercase()
}

/// How many parts the end of a path shares with the end of a name.
fn shared(wanted: &[String], path: &Path, same: impl Fn(&String, &String) -> bool) -> usize {
    let have = parts(path);
    let pairs = wanted.iter().rev().zip(have.iter().rev());
    pairs.take_while(|(a, b)| same(a, b)).count()
}

/// Names of folders and files, without `.`, `..` and roots.
fn parts(path: &Path) -> Vec<String> {
    let parts = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As in the packages of robot makers, which hold a series with a folder for each robot, where
    /// single files stand in other packages or in Git LFS.
    #[test]
    fn a_mesh_of_another_robot_of_the_series_is_not_taken() {
        let root = std::env::temp_dir().join(format!("urdf2fmu-series-{}", std::process::id()));
        for file in [
            "kr240/visual/link_1.dae",
            "kr560/visual/link_1.dae",
            "kr560/visual/link_3.dae",
        ] {
            let file = root.join("meshes").join(file);
            fs::create_dir_all(file.parent().expect("a folder")).expect("folder");
            fs::write(file, "").expect("file");
        }
        let files = Files::below(&[root.join("meshes")]);
        let like = |name: &str| {
            let found = files.like(name, true)?.strip_prefix(&root).ok()?;
            Some(found.to_string_lossy().replace('\\', "/"))
        };
        assert_eq!(like("arms/meshes/kr240/visual/link_3.dae"), None);
        // The folder that is meant has another name here, and the file is in it.
        let other = Some("meshes/kr560/visual/link_3.dae".to_owned());
        assert_eq!(like("arms/meshes/kr560_r3100/visual/link_3.dae"), other);
        assert_eq!(like("old/kr560/visual/link_3.dae"), other);
        fs::remove_dir_all(&root).expect("removed");
    }
}
