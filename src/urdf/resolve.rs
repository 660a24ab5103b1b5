//! Mesh file names → files: `package://`, `model://`, `file://`, relative and absolute paths.
//!
//! Where a package is found, its files are in it or nowhere; what else a name may mean is asked
//! only where there is no such package.
//!
//! A URDF may come from anybody. The files that it names are read only if they lie in the robot's
//! own folders or in a package path, so that no other file of the machine gets into an FMU. The
//! robot's own folders are the URDF's, the one of the `package.xml` above it, and its parent where
//! its name says that it is one part of a robot's (`urdf`, `robots` …).

use crate::diagnostic::words::near_file;
use crate::reading;
use not_found::same_name;

pub(super) use not_found::NotFound;

use super::nearby::Files;
use super::options::ReadOptions;
use super::packages::{Packages, Place};
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Entries of a folder that are looked at for one in other upper and lower case.
const MOST_ENTRIES: usize = 2000;

/// Where meshes are looked for.
pub(super) struct Resolver<'o> {
    base_dir: &'o Path,
    package_paths: &'o [PathBuf],
    packages: Packages<'o>,
    /// `<mujoco><compiler meshdir>`, counted from the URDF's folder.
    mesh_dir: Option<&'o str>,
    /// Where files may lie, absolute.
    roots: Vec<PathBuf>,
    /// The files of the robot's own folders, once a name has been missing.
    own_files: OnceCell<Files>,
    /// Names that mean a file at another place in the robot's folders, or one in other case.
    moved: RefCell<BTreeMap<String, Moved>>,
}

/// Names of a folder that holds a robot's URDF beside others that hold its meshes.
const PART_OF_A_ROBOT: [&str; 9] = [
    "description",
    "model",
    "models",
    "robot",
    "robots",
    "sdf",
    "urdf",
    "urdfs",
    "xacro",
];

/// How far up the robot's `package.xml` may be.
const DEEPEST_IN_PACKAGE: usize = 6;

/// A mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) path: PathBuf,
    /// A symbolic link leads to it from inside the robot's folders: it is read, but not packed.
    pub(super) linked: bool,
}

/// A file that a name means although it is not there.
#[derive(Clone, Debug)]
pub(super) struct Moved {
    pub(super) path: PathBuf,
    /// It lies where the name says, and differs in upper and lower case alone.
    pub(super) other_case: bool,
}

/// Why there is no mesh file.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Missing {
    NotFound(NotFound),
    /// It is there, but outside of the robot's folders.
    Outside(PathBuf),
    /// What is there is a folder or a pipe.
    NoFile(PathBuf, &'static str),
}

impl<'o> Resolver<'o> {
    pub(super) fn new(
        base_dir: &'o Path,
        options: &'o ReadOptions,
        mesh_dir: Option<&'o str>,
    ) -> Self {
        Self {
            base_dir,
            package_paths: &options.package_paths,
            packages: Packages::new(base_dir, options),
            mesh_dir,
            roots: roots(base_dir, options),
            own_files: OnceCell::new(),
            moved: RefCell::default(),
        }
    }

    /// The file that `name` means.
    pub(super) fn find(&self, name: &str) -> Result<Found, Missing> {
        // Windows tools write backslashes.
        let name = name.trim().replace('\\', "/");
        let (candidates, advice) = self.candidates(&name);
        let unusual = not_found::unusual(&name);
        let package = candidates.iter().find(|c| c.sure);
        let package = package.and_then(|c| c.package.as_deref());
        let mut outside = None;
        for candidate in candidates.iter().filter(|c| c.path.is_file()) {
            let path = tidy(&candidate.path);
            let root = candidate.package.as_deref();
            if self.holds(&normal(&path), root) {
                let linked = fs::canonicalize(&path).is_ok_and(|real| {
                    !self.holds(
                        &real,
                        root.and_then(|r| fs::canonicalize(r).ok()).as_deref(),
                    )
                });
                return Ok(Found { path, linked });
            }
            outside.get_or_insert(path);
        }
        if let Some(path) = self.moved(&name, &candidates, package) {
            return Ok(Found {
                path,
                linked: false,
            });
        }
        if let Some(path) = outside {
            return Err(Missing::Outside(path));
        }
        let there = candidates.iter().find_map(|candidate| {
            let there = fs::metadata(&candidate.path).ok()?;
            let what = reading::special(there.file_type())?;
            Some(Missing::NoFile(tidy(&candidate.path), what))
        });
        if let Some(there) = there {
            return Err(there);
        }
        let tried = distinct(candidates.iter().map(|c| tidy(&c.path)));
        let hint =
            |path: PathBuf| format!("there is {}: upper and lower case matter", path.display());
        let looped = tried
            .iter()
            .find(|path| fs::symlink_metadata(path).is_ok_and(|m| m.is_symlink()));
        let advice = match looped {
            Some(path) => format!("{} is a symbolic link that leads nowhere", path.display()),
            None => match tried
                .iter()
                .find_map(|path| other_case(path).into_iter().next())
            {
                Some(path) => hint(path),
                None => match self.same_name(&name, package) {
                    Some(path) if package.is_none() => same_name(&path),
                    Some(path) => format!("{advice}\n{}", same_name(&path)),
                    None => advice,
                },
            },
        };
        let apart = |c: &Candidate| !self.holds(&normal(&tidy(&c.path)), c.package.as_deref());
        let first = candidates.first().filter(|_| candidates.iter().all(apart));
        // Nor does a file come to such a place by what is said of other ones.
        let first = first.filter(|_| unusual.is_none());
        let advice = unusual.unwrap_or(advice);
        let outside = first.and_then(|c| Some(tidy(&c.path).parent()?.to_owned()));
        Err(Missing::NotFound(NotFound {
            tried,
            advice,
            outside,
        }))
    }

    /// A file that the mesh file `mesh` names, such as a texture: from the mesh's folder, or by its
    /// last part in that folder, because many meshes name a path of the machine they were made on.
    /// `None` if there is none in the robot's folders.
    pub(super) fn beside(&self, mesh: &Path, name: &str) -> Option<PathBuf> {
        let name = percent_decoded(&name.trim().replace('\\', "/"));
        let name = name.strip_prefix("file://").unwrap_or(&name);
        let folder = mesh.parent()?;
        let named = Path::new(name);
        let candidates = [
            Some(folder.join(named)),
            Some(folder.join(named.file_name()?)),
        ];
        let roots: Vec<PathBuf> = self
            .package_paths
            .iter()
            .chain([&folder.to_owned()])
            .filter_map(|root| fs::canonicalize(root).ok())
            .collect();
        candidates.into_iter().flatten().find_map(|path| {
            let path = tidy(&path);
            // What a symbolic link leads out of the robot's folders to is not packed.
            let real = fs::canonicalize(&path).ok().filter(|real| real.is_file())?;
            let own = self.holds(&real, None) || roots.iter().any(|root| real.starts_with(root));
            own.then_some(path)
        })
    }

    /// Whether a file lies in the robot's folders, in a package path or in the package that was
    /// found for it.
    fn holds(&self, file: &Path, package: Option<&Path>) -> bool {
        let package = package.map(normal);
        self.roots
            .iter()
            .chain(&package)
            .any(|root| file.starts_with(root))
    }

    fn candidates(&self, name: &str) -> (Vec<Candidate>, String) {
        if name.is_empty() {
            return (Vec::new(), "give the file's name".to_owned());
        }
        if name.contains("$(") || name.contains("${") {
            let advice =
                "the name contains xacro code: give the .xacro file itself, it is expanded here";
            return (Vec::new(), advice.to_owned());
        }
        let (scheme, rest) = match name.split_once("://") {
            Some((scheme, rest)) => (scheme.to_ascii_lowercase(), rest.to_owned()),
            // The short form of a file's address, RFC 8089.
            None if name.starts_with("file:/") => ("file".to_owned(), name[5..].to_owned()),
            None => (String::new(), name.to_owned()),
        };
        match scheme.as_str() {
            "" => {
                let plain = self.plain(&rest);
                let near = plain.first().and_then(|found| near_file(&found.path));
                let near = near.map_or_else(String::new, |near| {
                    format!("did you mean '{}'? ", near.display())
                });
                let advice = format!("{near}a relative name counts from the URDF's folder");
                (plain, advice)
            }
            "file" => {
                let path = percent_decoded(&rest);
                let path = path.strip_prefix("localhost").unwrap_or(&path);
                (self.plain(path), "file:// takes a path".to_owned())
            }
            "package" | "model" => {
                let rest = rest.trim_start_matches('/');
                let (package, file) = rest.split_once('/').unwrap_or((rest, ""));
                let candidates = self.in_package(package, file);
                let sure = candidates.iter().find(|c| c.sure);
                let advice = match sure.and_then(|c| c.package.as_deref()) {
                    Some(folder) => not_found::in_package(package, folder, file),
                    None => not_found::package(package, self.packages.cut_short()),
                };
                (candidates, advice)
            }
            _ => (
                Vec::new(),
                format!("'{scheme}://' is not supported: use a path or package://"),
            ),
        }
    }

    fn plain(&self, path: &str) -> Vec<Candidate> {
        let mut list = vec![self.base_dir.join(path)];
        if let Some(dir) = self.mesh_dir {
            let dir = self.base_dir.join(dir.replace('\\', "/"));
            list.push(dir.join(path));
            // MuJoCo strips the path by default.
            list.extend(Path::new(path).file_name().map(|name| dir.join(name)));
        }
        if Path::new(path).is_relative() {
            list.extend(self.package_paths.iter().map(|dir| dir.join(path)));
        }
        let candidate = |path| Candidate {
            path,
            package: None,
            sure: false,
        };
        list.into_iter().map(candidate).collect()
    }

    /// Every place where `file` of `package` may be.
    fn in_package(&self, package: &str, file: &str) -> Vec<Candidate> {
        let places = self.packages.places(package);
        let candidate = |place: &Place| Candidate {
            path: place.folder.join(file.trim_start_matches('/')),
            package: Some(place.folder.clone()),
            sure: place.sure,
        };
        places.iter().map(candidate).collect()
    }
}

/// A place where a file may be.
struct Candidate {
    path: PathBuf,
    /// The package's folder, where the name has a package.
    package: Option<PathBuf>,
    /// The folder is that package.
    sure: bool,
}

/// Folders that a robot's files may lie in, absolute.
fn roots(base_dir: &Path, options: &ReadOptions) -> Vec<PathBuf> {
    let mut list = vec![normal(base_dir)];
    let real = fs::canonicalize(base_dir).unwrap_or_else(|_| normal(base_dir));
    let package = real
        .ancestors()
        .take(DEEPEST_IN_PACKAGE)
        .find(|dir| dir.join("package.xml").is_file());
    list.extend(package.map(Path::to_owned));
    let part = |dir: &Path| {
        let name = dir
            .file_name()
            .map(|name| name.to_string_lossy().to_lowercase());
        name.is_some_and(|name| PART_OF_A_ROBOT.contains(&name.as_str()))
    };
    for dir in [list[0].clone(), real] {
        if part(&dir) {
            list.extend(dir.parent().map(Path::to_owned));
        }
        list.push(dir);
    }
    let packages = options.packages.iter().map(|(_, dir)| dir);
    for path in options.package_paths.iter().chain(packages) {
        list.push(normal(path));
        list.extend(fs::canonicalize(path).ok());
    }
    // The root of the file system is not a folder of the robot.
    list.retain(|root| root.parent().is_some());
    list
}

/// Absolute and without `.` and `..`, links not followed.
fn normal(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut normal = PathBuf::new();
    for part in absolute.components() {
        match part {
            Component::ParentDir => drop(normal.pop()),
            Component::CurDir => {}
            other => normal.push(other),
        }
    }
    normal
}

/// The files that differ from this one in upper and lower case only, sorted.
fn other_case(path: &Path) -> Vec<PathBuf> {
    let Some((folder, name)) = path.parent().zip(path.file_name()) else {
        return Vec::new();
    };
    let wanted = name.to_string_lossy().to_lowercase();
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut same: Vec<PathBuf> = entries
        .take(MOST_ENTRIES)
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().to_lowercase() == wanted)
        .map(|entry| entry.path())
        .filter(|other| other.is_file())
        .collect();
    same.sort();
    same
}

/// Without `.`, and with `name/..` taken out.
pub(super) fn tidy(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(tidy.components().next_back(), Some(Component::Normal(_))) =>
            {
                tidy.pop();
            }
            other => tidy.push(other),
        }
    }
    // `a/link/..` is not `a` where `link` is a symbolic link.
    if path.exists() == tidy.exists() {
        tidy
    } else {
        path.to_owned()
    }
}

fn distinct(paths: impl Iterator<Item = PathBuf>) -> Vec<PathBuf> {
    let mut list = Vec::new();
    for path in paths {
        if !list.contains(&path) {
            list.push(path);
        }
    }
    list
}

/// `%20` → space; anything that is not an escape stays.
fn percent_decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let escaped = (bytes[i] == b'%')
            .then(|| text.get(i + 1..i + 3))
            .flatten()
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        if let Some(byte) = escaped {
            out.push(byte);
            i += 3;
        } else {
            out.push(bytes[i]);
            i += 1;
        }
    }
    String::from_utf8(out).unwrap_or_else(|_| text.to_owned())
}

mod elsewhere;
mod not_found;
#[cfg(test)]
mod tests;
