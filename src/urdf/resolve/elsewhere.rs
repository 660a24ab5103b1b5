//! Files at other places than their names say: in the robot's folders and around them.

use super::super::nearby::{self, Files};
use super::super::packages::Remark;
use super::{Candidate, Moved, Resolver, normal, other_case, percent_decoded, tidy};
use crate::diagnostic::words::shell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

impl Resolver<'_> {
    /// The file that `name` must mean although it is not there: one that differs in upper and lower
    /// case alone, as of a robot that was made on Windows, or one at another place of the robot's
    /// folders.
    ///
    /// - `package`: the folder of its package, where that was found: the file can be nowhere else
    pub(super) fn moved(
        &self,
        name: &str,
        candidates: &[Candidate],
        package: Option<&Path>,
    ) -> Option<PathBuf> {
        // Nothing is looked for where the name itself is wrong, or a link leads nowhere.
        let linked = |c: &Candidate| fs::symlink_metadata(&c.path).is_ok();
        if candidates.is_empty() || candidates.iter().any(linked) {
            return None;
        }
        let (path, other_case) = match self.in_other_case(candidates) {
            Some(path) => (path, true),
            None => (self.at_another_place(name, package)?, false),
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

    fn at_another_place(&self, name: &str, package: Option<&Path>) -> Option<PathBuf> {
        let files = self.own_files.get_or_init(|| Files::below(&self.roots));
        let (of_package, name_of) = match name.split_once("://") {
            Some((scheme, rest)) => (!scheme.eq_ignore_ascii_case("file"), rest),
            None => (false, name),
        };
        let path = files.like(&percent_decoded(name_of), of_package)?;
        if !is_in(path, package) {
            return None;
        }
        let base = fs::canonicalize(self.base_dir).unwrap_or_else(|_| normal(self.base_dir));
        // As the URDF itself was named, where it is below its folder.
        let shown = path
            .strip_prefix(&base)
            .map_or(path.to_owned(), |below| self.base_dir.join(below));
        Some(shown)
    }

    /// The one file of the robot's folders that has the last part of `name`, wherever it lies: too
    /// little to use it, since many robots have one name for what is seen and what collides.
    pub(in crate::urdf) fn same_name(&self, name: &str, package: Option<&Path>) -> Option<PathBuf> {
        let files = self.own_files.get_or_init(|| Files::below(&self.roots));
        let found = files.alone(name)?;
        is_in(found, package).then(|| found.to_owned())
    }

    /// Names that mean a file that is not where they say, and that file.
    pub(in crate::urdf) fn moved_files(&self) -> BTreeMap<String, Moved> {
        self.moved.borrow().clone()
    }

    /// What is to be said of where a package was found, if it is not plain.
    pub(in crate::urdf) fn remark(&self, package: &str) -> Option<Remark> {
        self.packages.remark(package)
    }

    /// The option that makes most of `names` be found, and how many; they are names of one package,
    /// or paths.
    pub(in crate::urdf) fn advice(&self, names: &[&str]) -> Option<(String, usize)> {
        // Each with how many it finds, and whether they are in another package.
        let mut options: Vec<(String, usize, bool)> = Vec::new();
        let mut count = |option: String, foreign: bool| match options
            .iter_mut()
            .find(|(own, ..)| *own == option)
        {
            Some((_, count, _)) => *count += 1,
            None => options.push((option, 1, foreign)),
        };
        let base = fs::canonicalize(self.base_dir).unwrap_or_else(|_| normal(self.base_dir));
        let mut around = None;
        for name in names {
            let name = name.trim().replace('\\', "/");
            let package = ["package://", "model://"].iter().find_map(|scheme| {
                let rest = name.strip_prefix(scheme)?.trim_start_matches('/');
                rest.split_once('/')
            });
            if let Some((package, file)) = package {
                let others = self.packages.others(package).into_iter();
                for folder in others.filter(|folder| folder.join(file).is_file()) {
                    let given = format!("{package}={}", folder.display());
                    count(format!("--package {}", shell(&given)), false);
                }
                continue;
            }
            let files = around.get_or_insert_with(|| Files::below(&nearby::around(&base)));
            let found = files.like(&name, false);
            if let Some(folder) = found.and_then(|file| nearby::package_of(file, &name)) {
                let package = folder.ancestors().find(|above| is_package(above));
                let foreign = package.is_some_and(|package| !base.starts_with(package));
                let folder = folder.display().to_string();
                count(format!("--package-path {}", shell(&folder)), foreign);
            }
        }
        // What another package has in part are meshes of another robot under the same names.
        let whole = |(_, count, foreign): &(String, usize, bool)| !foreign || *count == names.len();
        let options = options.into_iter().filter(whole);
        let options: Vec<_> = options.map(|(option, count, _)| (option, count)).collect();
        // Of equals the nearest, which comes first.
        options.into_iter().rev().max_by_key(|&(_, count)| count)
    }
}

/// Whether a folder is a package.
fn is_package(folder: &Path) -> bool {
    folder.join("package.xml").is_file()
}

/// Whether a file is in a package, if there is one.
fn is_in(file: &Path, package: Option<&Path>) -> bool {
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| normal(path));
    package.is_none_or(|package| real(file).starts_with(real(package)))
}
