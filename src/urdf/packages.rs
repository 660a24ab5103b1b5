//! Packages by their names: in the package paths and in the workspace around the robot, without
//! ROS.
//!
//! As in ROS, a package is a folder whose `package.xml` has its name, at any depth. A folder that
//! only has the name comes last: repositories are often called as the package in them.

mod folder;
mod index;
#[cfg(test)]
mod tests;

use super::options::ReadOptions;
use crate::diagnostic::Severity;
use folder::{has_manifest, is_called, is_common, manifest_is, manifest_name, spellings};
use index::{Index, MOST_ENTRIES};
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A folder that may be a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) folder: PathBuf,
    /// Its `package.xml` or an option says that it is.
    pub(super) sure: bool,
}

/// What is to be said of where a package was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// How bad it is.
    pub severity: Severity,
    /// One sentence without a full stop.
    pub message: String,
    /// What to do.
    pub help: String,
}

/// Where packages are looked for.
pub(super) struct Packages<'o> {
    /// Of the URDF, absolute, links followed.
    base: PathBuf,
    paths: &'o [PathBuf],
    named: &'o [(String, PathBuf)],
    /// Packages below the package paths.
    of_paths: OnceCell<Index>,
    workspace: OnceCell<Index>,
    known: RefCell<BTreeMap<String, Rc<[Place]>>>,
}

/// One of the ways to look for a package by its names.
type Find<'o> = fn(&Packages<'o>, &[String]) -> Vec<PathBuf>;

impl<'o> Packages<'o> {
    pub(super) fn new(base_dir: &Path, options: &'o ReadOptions) -> Self {
        let absolute = || std::path::absolute(base_dir).unwrap_or_else(|_| base_dir.to_owned());
        Self {
            base: fs::canonicalize(base_dir).unwrap_or_else(|_| absolute()),
            paths: &options.package_paths,
            named: &options.packages,
            of_paths: OnceCell::new(),
            workspace: OnceCell::new(),
            known: RefCell::default(),
        }
    }

    /// The folders that may be a package, the likeliest first; at most one is sure, the last one.
    pub(super) fn places(&self, name: &str) -> Rc<[Place]> {
        if let Some(known) = self.known.borrow().get(name) {
            return Rc::clone(known);
        }
        let places: Rc<[Place]> = self.look(name).into();
        self.known
            .borrow_mut()
            .insert(name.to_owned(), Rc::clone(&places));
        places
    }

    fn look(&self, name: &str) -> Vec<Place> {
        let mut list: Vec<Place> = Vec::new();
        // A name such as `..` would lead out of the package path.
        if name.is_empty() || name.starts_with('.') {
            return list;
        }
        for place in self.candidates(&spellings(name)) {
            let sure = place.sure;
            list.push(place);
            if sure {
                break;
            }
        }
        list
    }

    /// All folders that may be a package with one of these names, in the order in which they are
    /// asked: what an option names, the package paths, then the surroundings of the robot; of each
    /// of the two, first what `package.xml` says, then what is only called so.
    fn candidates(&self, names: &[String]) -> impl Iterator<Item = Place> {
        let named = self.named.iter().filter(|(own, _)| names.contains(own));
        let named = named.map(|(_, folder)| Place {
            sure: folder.is_dir(),
            folder: folder.clone(),
        });
        let groups: [(bool, Find<'o>); 4] = [
            (true, Self::of_paths_by_manifest),
            (false, Self::of_paths_by_name),
            (true, Self::around_by_manifest),
            (false, Self::around_by_name),
        ];
        // Whoever does not get so far does not look into folders.
        let found = groups.into_iter().flat_map(move |(sure, find)| {
            let folders = find(self, names).into_iter();
            folders.map(move |folder| Place { folder, sure })
        });
        named.chain(found)
    }

    /// A package path, and where it keeps a package: an install prefix (`AMENT_PREFIX_PATH`) does
    /// in `share/`.
    fn near<'n>(path: &'n Path, names: &'n [String]) -> impl Iterator<Item = PathBuf> {
        let below = names
            .iter()
            .flat_map(|name| [path.join(name), path.join("share").join(name)]);
        std::iter::once(path.to_owned()).chain(below)
    }

    fn of_paths_by_manifest(&self, names: &[String]) -> Vec<PathBuf> {
        let mut near = self.paths.iter().flat_map(|path| Self::near(path, names));
        let found = near.find(|folder| manifest_is(folder, names));
        let found = found.or_else(|| self.of_paths().named(names).next().map(Path::to_owned));
        found.into_iter().collect()
    }

    fn of_paths_by_name(&self, names: &[String]) -> Vec<PathBuf> {
        let near = self.paths.iter().flat_map(|path| {
            let own = move |folder: &PathBuf| folder != path || is_called(folder, names);
            Self::near(path, names).filter(own)
        });
        // A source tree keeps them in repositories, one level down.
        let of_repository = |folder: &&Path| {
            let path = folder.parent().and_then(Path::parent);
            path.is_some_and(|path| self.paths.iter().any(|own| own == path))
        };
        let called = self.of_paths().called(names).filter(of_repository);
        near.chain(called.map(Path::to_owned)).collect()
    }

    fn around_by_manifest(&self, names: &[String]) -> Vec<PathBuf> {
        let mut above = self.base.ancestors();
        let found = above.find(|folder| manifest_is(folder, names));
        let found = found.or_else(|| self.workspace().named(names).next());
        found.map(Path::to_owned).into_iter().collect()
    }

    fn around_by_name(&self, names: &[String]) -> Vec<PathBuf> {
        let mut list = Vec::new();
        for dir in self.base.ancestors() {
            list.extend(is_called(dir, names).then(|| dir.to_owned()));
            for name in names {
                // An install tree of colcon has a prefix for each package.
                let installed = dir.join(name).join("share").join(name);
                list.extend(installed.is_dir().then_some(installed));
                list.push(dir.join(name));
            }
        }
        // With another name in its package.xml, as of a repository that was renamed.
        let renamed = self.workspace().called(names);
        list.extend(renamed.filter(|dir| has_manifest(dir)).map(Path::to_owned));
        list
    }

    /// The folder of a package.
    pub(super) fn folder(&self, name: &str) -> Option<PathBuf> {
        let places = self.places(name);
        let there = || places.iter().filter(|place| place.folder.is_dir());
        let found = there()
            .find(|place| place.sure)
            .or_else(|| there().next())?;
        Some(found.folder.clone())
    }

    /// Other folders that have the name of a package, in their `package.xml` or of their own, the
    /// nearest first.
    pub(super) fn others(&self, name: &str) -> Vec<PathBuf> {
        let names = spellings(name);
        let places = self.places(name);
        let indexes = [self.of_paths(), self.workspace()];
        let named = indexes.iter().flat_map(|index| index.named(&names));
        let called = indexes.iter().flat_map(|index| index.called(&names));
        let mut list: Vec<PathBuf> = Vec::new();
        for folder in named.chain(called) {
            let known = places.iter().any(|place| place.folder == folder);
            if !known && !list.iter().any(|other| other == folder) {
                list.push(folder.to_owned());
            }
        }
        list
    }

    /// What is to be said of where a package was found, if it is not plain.
    pub(super) fn remark(&self, name: &str) -> Option<Remark> {
        let places = self.places(name);
        let used = places.iter().find(|place| place.sure)?;
        // Whoever did not need the index has a package above the file, or in a package path.
        let index = self.workspace.get()?;
        let names = spellings(name);
        let help = format!("pass --package {name}=DIR to say which is meant");
        let folder = used.folder.display();
        if let Some(other) = index.as_near(&names, &used.folder) {
            let other = other.display();
            return Some(Remark {
                severity: Severity::Warning,
                message: format!(
                    "package '{name}' is at {folder} and at {other}; the first is used"
                ),
                help,
            });
        }
        let found = index.named(&names).any(|folder| folder == used.folder);
        let own = around(&self.base).own;
        let apart = own.is_none_or(|own| !used.folder.starts_with(own));
        (found && apart).then(|| Remark {
            severity: Severity::Note,
            message: format!(
                "package '{name}' is taken from {folder}, which no workspace or repository of the \
                 robot holds"
            ),
            help,
        })
    }

    /// The folder in which packages were looked for, if it has more than was looked at.
    pub(super) fn cut_short(&self) -> Option<&Path> {
        self.workspace.get().and_then(Index::cut_short)
    }

    fn of_paths(&self) -> &Index {
        let prefix = |path: &&PathBuf| path.join("share/ament_index").is_dir();
        self.of_paths.get_or_init(|| {
            // Of an install prefix `share` alone has packages, and it has been looked at.
            let roots = self.paths.iter().filter(|path| !prefix(path));
            Index::below(&roots.cloned().collect::<Vec<_>>(), MOST_ENTRIES)
        })
    }

    fn workspace(&self) -> &Index {
        self.workspace
            .get_or_init(|| Index::below(&around(&self.base).folders, MOST_ENTRIES))
    }
}

/// The name of the package in a folder.
pub(super) fn name_in(folder: &Path) -> Option<String> {
    manifest_name(folder)
}

/// Where packages are looked for around a robot.
#[derive(Debug)]
pub(super) struct Around {
    /// Folders, each in the next one.
    pub(super) folders: Vec<PathBuf>,
    /// The workspace or the outermost repository that holds the robot.
    pub(super) own: Option<PathBuf>,
}

/// The folders around a robot: up to the outermost workspace, which has the robot in its `src` or
/// `install`; without one some folders up, or to the outermost repository. Not the folders of all
/// users, nor the system's.
pub(super) fn around(base: &Path) -> Around {
    /// How far up packages are looked for outside of a workspace
    /// (`packages_are_found_at_any_depth_of_the_workspace`).
    const HIGHEST: usize = 6;
    let all: Vec<&Path> = base.ancestors().take_while(|dir| !is_common(dir)).collect();
    let holds = |pair: &[&Path]| {
        let [below, dir] = pair else { return false };
        // Sources of a package are in `src`, too.
        (below.ends_with("src") || below.ends_with("install")) && !has_manifest(dir)
    };
    let pairs: Vec<&[&Path]> = all.windows(2).collect();
    let workspace = pairs.iter().rposition(|pair| holds(pair));
    let repository = || all.iter().rposition(|dir| dir.join(".git").exists());
    let own = workspace.map(|place| place + 1).or_else(repository);
    let count = workspace.map_or_else(
        || {
            // A folder directly below the root of the file system is rarely a project.
            let project = |dir: &&&Path| dir.ancestors().count() > 2;
            let near = all.iter().take(HIGHEST + 1).filter(project).count();
            near.max(own.map_or(0, |place| place + 1))
        },
        |place| place + 2,
    );
    Around {
        folders: all
            .iter()
            .take(count)
            .map(|dir| (*dir).to_owned())
            .collect(),
        own: own.map(|place| all[place].to_owned()),
    }
}
