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
use folder::{has_manifest, is_called, is_common, manifest_is, spellings};
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
        let bare = |folder: PathBuf| Place {
            folder,
            sure: false,
        };
        let sure = |folder: PathBuf| Place { folder, sure: true };
        let names = spellings(name);
        for (_, folder) in self.named.iter().filter(|(own, _)| names.contains(own)) {
            let place = bare(folder.clone());
            if folder.is_dir() {
                list.push(sure(place.folder));
                return list;
            }
            list.push(place);
        }
        let manifest = |folder: &PathBuf| manifest_is(folder, &names);
        let near = |path: &PathBuf| -> Vec<PathBuf> {
            let below = names.iter().flat_map(|name| {
                // An install prefix (AMENT_PREFIX_PATH) keeps packages in share/.
                [path.join(name), path.join("share").join(name)]
            });
            std::iter::once(path.clone()).chain(below).collect()
        };
        let found = self.paths.iter().flat_map(near).find(manifest);
        let found = found.or_else(|| self.of_paths().named(&names).next().map(Path::to_owned));
        if let Some(folder) = found {
            list.push(sure(folder));
            return list;
        }
        for path in self.paths {
            let own = |folder: &PathBuf| folder != path || is_called(folder, &names);
            list.extend(near(path).into_iter().filter(own).map(bare));
        }
        // A source tree keeps them in repositories, one level down.
        let of_repository = |folder: &&Path| {
            let path = folder.parent().and_then(Path::parent);
            path.is_some_and(|path| self.paths.iter().any(|own| own == path))
        };
        let called = self.of_paths().called(&names).filter(of_repository);
        list.extend(called.map(Path::to_owned).map(bare));
        let mut above = self.base.ancestors().map(Path::to_owned);
        let found = above.find(manifest);
        let found = found.or_else(|| self.workspace().named(&names).next().map(Path::to_owned));
        if let Some(folder) = found {
            list.push(sure(folder));
            return list;
        }
        for dir in self.base.ancestors() {
            if is_called(dir, &names) {
                list.push(bare(dir.to_owned()));
            }
            for name in &names {
                // An install tree of colcon has a prefix for each package.
                let installed = dir.join(name).join("share").join(name);
                list.extend(installed.is_dir().then(|| bare(installed)));
                list.push(bare(dir.join(name)));
            }
        }
        // With another name in its package.xml, as of a repository that was renamed.
        let workspace = self.workspace();
        let renamed = workspace.called(&names).filter(|dir| has_manifest(dir));
        list.extend(renamed.map(Path::to_owned).map(bare));
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

    /// The other package of that name that is as near as the one in `folder`.
    pub(super) fn as_near(&self, name: &str, folder: &Path) -> Option<PathBuf> {
        // Whoever did not need the index has a package above the file, or in a package path.
        let index = self.workspace.get()?;
        index.as_near(&spellings(name), folder).map(Path::to_owned)
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
            .get_or_init(|| Index::below(&around(&self.base), MOST_ENTRIES))
    }
}

/// The folders around a robot in which packages are looked for, each in the next one: up to the
/// outermost workspace, which has the robot in its `src` or `install`; without one some folders
/// up, or to the outermost repository. Not the folders of all users, nor the system's.
fn around(base: &Path) -> Vec<PathBuf> {
    /// How far up packages are looked for outside of a workspace
    /// (`packages_are_found_at_any_depth_of_the_workspace`).
    const HIGHEST: usize = 6;
    let own: Vec<&Path> = base.ancestors().take_while(|dir| !is_common(dir)).collect();
    let holds = |pair: &[&Path]| {
        let [below, dir] = pair else { return false };
        // Sources of a package are in `src`, too.
        (below.ends_with("src") || below.ends_with("install")) && !has_manifest(dir)
    };
    let pairs: Vec<&[&Path]> = own.windows(2).collect();
    let count = pairs.iter().rposition(|pair| holds(pair)).map_or_else(
        || {
            // A folder directly below the root of the file system is rarely a project.
            let project = |dir: &&&Path| dir.ancestors().count() > 2;
            let near = own.iter().take(HIGHEST + 1).filter(project).count();
            let repository = own.iter().rposition(|dir| dir.join(".git").exists());
            near.max(repository.map_or(0, |place| place + 1))
        },
        |place| place + 2,
    );
    own.into_iter().take(count).map(Path::to_owned).collect()
}
