//! The packages and folders below some folders, by their names.

use super::folder::{is_common, manifest_name};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};

/// Files and folders that are looked at: 0.1 s. Without a bound a home folder would be read
/// (`a_search_ends_after_a_number_of_files_and_says_so`).
pub(super) const MOST_ENTRIES: usize = 20_000;

/// Folders that hold what was made, which has the sources' `package.xml` once more
/// (`folders_of_builds_and_hidden_ones_have_no_packages`).
const MADE: [&str; 5] = ["build", "log", "node_modules", "target", "__pycache__"];

/// Packages and folders, the nearest first.
#[derive(Debug, Default)]
pub(super) struct Index {
    /// By the name in `package.xml`, each with the place of its root in the list of roots.
    by_manifest: BTreeMap<String, Vec<(usize, PathBuf)>>,
    /// By their own names.
    by_name: BTreeMap<String, Vec<(usize, PathBuf)>>,
    /// The root in which something was left out.
    cut_short: Option<PathBuf>,
}

/// A folder to look into.
struct Open {
    folder: PathBuf,
    root: usize,
    /// It is in a package.
    inside: bool,
}

impl Index {
    /// Those below `roots`, one root after the other, and each in breadth, so that what is near
    /// comes first; what is inside of packages comes last. Links to folders are followed.
    ///
    /// - `most`: files and folders that are looked at
    pub(super) fn below(roots: &[PathBuf], most: usize) -> Self {
        let mut index = Self::default();
        let mut left = most;
        let mut seen = BTreeSet::new();
        let mut inside = VecDeque::new();
        for (place, root) in roots.iter().enumerate() {
            let mut open = VecDeque::from([Open {
                folder: root.clone(),
                root: place,
                inside: false,
            }]);
            while let Some(next) = open.pop_front() {
                let below = index.read(next, roots, &mut left, &mut seen);
                let of_packages = below.first().is_some_and(|next| next.inside);
                if of_packages {
                    inside.extend(below);
                } else {
                    open.extend(below);
                }
            }
        }
        while let Some(next) = inside.pop_front() {
            inside.extend(index.read(next, roots, &mut left, &mut seen));
        }
        for list in index
            .by_manifest
            .values_mut()
            .chain(index.by_name.values_mut())
        {
            list.sort_by_key(|(root, _)| *root);
        }
        index
    }

    /// Notes a folder, and gives those in it.
    fn read(
        &mut self,
        open: Open,
        roots: &[PathBuf],
        left: &mut usize,
        seen: &mut BTreeSet<PathBuf>,
    ) -> Vec<Open> {
        let Open {
            folder,
            root,
            inside,
        } = open;
        let Ok(real) = fs::canonicalize(&folder) else {
            return Vec::new();
        };
        let top = &roots[root];
        // A link may lead around in a circle, to the whole machine or to another one.
        if seen.contains(&real) || (folder != *top && !may_enter(&folder, &real, top)) {
            return Vec::new();
        }
        if *left == 0 {
            self.cut_short.get_or_insert_with(|| top.clone());
            return Vec::new();
        }
        let Ok(entries) = fs::read_dir(&folder) else {
            return Vec::new();
        };
        let entries: Vec<_> = entries.take(*left + 1).collect();
        // A part of a folder would be another one on each machine. Many such folders have an end.
        let Some(rest) = left.checked_sub(entries.len()) else {
            *left /= 2;
            self.cut_short.get_or_insert_with(|| top.clone());
            return Vec::new();
        };
        *left = rest;
        let mut folders: Vec<PathBuf> = Vec::new();
        let mut package = false;
        for entry in entries.into_iter().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            package |= name == "package.xml";
            let kind = entry.file_type();
            let linked = || entry.path().is_dir();
            let is_folder = kind.is_ok_and(|kind| kind.is_dir() || kind.is_symlink() && linked());
            if is_folder && !name.starts_with('.') && !MADE.contains(&&*name) {
                folders.push(entry.path());
            }
        }
        folders.sort();
        if let Some(name) = package.then(|| manifest_name(&folder)).flatten() {
            let list = self.by_manifest.entry(name).or_default();
            list.push((root, folder.clone()));
        }
        if let Some(name) = folder.file_name() {
            let name = name.to_string_lossy().into_owned();
            self.by_name.entry(name).or_default().push((root, folder));
        }
        seen.insert(real);
        let inside = inside || package;
        let next = |folder| Open {
            folder,
            root,
            inside,
        };
        folders.into_iter().map(next).collect()
    }

    /// The packages whose `package.xml` has one of these names.
    pub(super) fn named(&self, names: &[String]) -> impl Iterator<Item = &Path> {
        of(&self.by_manifest, names).map(|(_, folder)| folder)
    }

    /// The folders that have one of these names.
    pub(super) fn called(&self, names: &[String]) -> impl Iterator<Item = &Path> {
        of(&self.by_name, names).map(|(_, folder)| folder)
    }

    /// Another package with one of these names in the same of the roots as `folder`.
    pub(super) fn as_near(&self, names: &[String], folder: &Path) -> Option<&Path> {
        let mut all = of(&self.by_manifest, names);
        let (own, _) = all.find(|(_, known)| *known == folder)?;
        let (_, other) = all.find(|(root, _)| *root == own)?;
        Some(other)
    }

    /// The root in which not everything was looked at.
    pub(super) fn cut_short(&self) -> Option<&Path> {
        self.cut_short.as_deref()
    }
}

/// What a list has under some names.
fn of<'i>(
    list: &'i BTreeMap<String, Vec<(usize, PathBuf)>>,
    names: &[String],
) -> impl Iterator<Item = (usize, &'i Path)> {
    let lists = names.iter().filter_map(|name| list.get(name));
    let all: Vec<_> = lists
        .flatten()
        .map(|(root, folder)| (*root, folder.as_path()))
        .collect();
    all.into_iter()
}

/// Whether a folder below `top` may be looked into: it is on the same file system, and, behind a
/// link, none that holds the link, nor one of all users.
fn may_enter(folder: &Path, real: &Path, top: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let system = |path: &Path| fs::metadata(path).map(|data| data.dev()).ok();
        if system(real) != system(top) {
            return false;
        }
    }
    let linked = fs::symlink_metadata(folder).is_ok_and(|data| data.is_symlink());
    !linked || !is_common(real) && !top.starts_with(real)
}
