//! Files at other places than their names say: in the robot's folders, around them, in packages
//! beside the robot's.

use super::super::nearby::{self, Files};
use super::{
    Candidate, Moved, Resolver, folders, is_package, normal, other_case, percent_decoded,
    spellings, tidy,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

impl Resolver<'_> {
    /// The file that `name` must mean although it is not there: one that differs in upper and lower
    /// case alone, as of a robot that was made on Windows, or one at another place of the robot's
    /// folders.
    pub(super) fn moved(&self, name: &str, candidates: &[Candidate]) -> Option<PathBuf> {
        // Nothing is looked for where the name itself is wrong, or a link leads nowhere.
        let linked = |c: &Candidate| fs::symlink_metadata(&c.path).is_ok();
        if candidates.is_empty() || candidates.iter().any(linked) {
            return None;
        }
        let (path, other_case) = match self.in_other_case(candidates) {
            Some(path) => (path, true),
            None => (self.at_another_place(name)?, false),
        };
        let moved = Moved {
            path: path.clone(),
            other_case,
        };
        self.moved.borrow_mut().insert(name.to_owned(), moved);
        Some(path)
    }

    /// The one file that differs from a candidate in upper and lower case alone; of the first
    /// candidate that has any.
    fn in_other_case(&self, candidates: &[Candidate]) -> Option<PathBuf> {
        let mut some = candidates.iter().filter_map(|candidate| {
            let path = tidy(&candidate.path);
            let files = other_case(&path);
            (!files.is_empty()).then_some((files, candidate.package.as_deref()))
        });
        let (files, package) = some.next()?;
        let [file] = &files[..] else {
            return None;
        };
        // What a symbolic link leads to might lie outside of the robot's folders.
        let regular = fs::symlink_metadata(file).is_ok_and(|data| data.is_file());
        (regular && self.holds(&normal(file), package)).then(|| file.clone())
    }

    fn at_another_place(&self, name: &str) -> Option<PathBuf> {
        let files = self.own_files.get_or_init(|| Files::below(&self.roots));
        let name_of = name.split_once("://").map_or(name, |(_, rest)| rest);
        let path = files.like(&percent_decoded(name_of))?;
        let base = fs::canonicalize(self.base_dir).unwrap_or_else(|_| normal(self.base_dir));
        // As the URDF itself was named, where it is below its folder.
        let shown = path
            .strip_prefix(&base)
            .map_or(path.to_owned(), |below| self.base_dir.join(below));
        Some(shown)
    }

    /// The one file of the robot's folders that has the last part of `name`, wherever it lies: too
    /// little to use it, since many robots have one name for what is seen and what collides.
    pub(super) fn same_name(&self, name: &str) -> Option<PathBuf> {
        let files = self.own_files.get_or_init(|| Files::below(&self.roots));
        files.alone(name).map(Path::to_owned)
    }

    /// Names that mean a file that is not where they say, and that file.
    pub(in crate::urdf) fn moved_files(&self) -> BTreeMap<String, Moved> {
        self.moved.borrow().clone()
    }

    /// The option that makes most of `names` be found, and how many; they are names of one package,
    /// or paths.
    pub(in crate::urdf) fn advice(&self, names: &[&str]) -> Option<(String, usize)> {
        let base = fs::canonicalize(self.base_dir).unwrap_or_else(|_| normal(self.base_dir));
        let files = Files::below(&nearby::around(&base));
        let mut folders: BTreeMap<String, usize> = BTreeMap::new();
        for name in names {
            let name = name.trim().replace('\\', "/");
            let package = ["package://", "model://"].iter().find_map(|scheme| {
                let rest = name.strip_prefix(scheme)?.trim_start_matches('/');
                rest.split_once('/')
            });
            let rest = package.map_or(name.as_str(), |(_, rest)| rest);
            let Some(folder) = files
                .like(rest)
                .and_then(|file| nearby::package_of(file, rest))
            else {
                continue;
            };
            let option = match package {
                Some((package, _)) => format!("--package {package}={}", folder.display()),
                None => format!("--package-path {}", folder.display()),
            };
            *folders.entry(option).or_default() += 1;
        }
        folders.into_iter().max_by_key(|&(_, count)| count)
    }

    /// The folder of a package. A source tree holds several repositories side by side, so those
    /// beside the robot's are looked into, too.
    pub(in crate::urdf) fn package(&self, name: &str) -> Option<PathBuf> {
        /// Folders above the robot's whose neighbours are looked into.
        const HIGHEST: usize = 5;
        let candidates = self.in_package(name, "");
        let found = candidates
            .into_iter()
            .find(|candidate| candidate.path.is_dir());
        if let Some(found) = found {
            return Some(tidy(&found.path));
        }
        let start = fs::canonicalize(self.base_dir).unwrap_or_else(|_| self.base_dir.to_owned());
        let above = start.ancestors().take(HIGHEST);
        let beside = above.flat_map(|dir| {
            let near = folders(dir);
            let below: Vec<PathBuf> = near.iter().flat_map(|dir| folders(dir)).collect();
            near.into_iter().chain(below)
        });
        // Folders of that name first; then those whose package.xml says so.
        let all: Vec<PathBuf> = beside
            .filter(|dir| dir.join("package.xml").is_file())
            .collect();
        let spellings = spellings(name);
        let named = |dir: &&PathBuf| {
            let own = dir
                .file_name()
                .map(|name| name.to_string_lossy().into_owned());
            own.is_some_and(|own| spellings.contains(&own))
        };
        let found = all.iter().find(named);
        found
            .or_else(|| all.iter().find(|dir| is_package(dir, name)))
            .cloned()
    }
}
