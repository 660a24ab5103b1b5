//! Places of the robot's own files in `resources/source/`. They are for people; the FMU never reads
//! them.
//!
//! In: paths of this machine and the URDF's text. Out: distinct names inside the zip, without `..`
//! and without paths of the machine, independent of the place of the robot's folder.
//!
//! Files of the same robot keep their places relative to each other, so that relative mesh paths of
//! the unpacked URDF stay valid. A package folder keeps its name where the URDF calls it by
//! `package://`.

use crate::archive::safe_component;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// A URDF further below the common folder than this does not belong together with its meshes (one
/// in a home folder, the others in the system's, say); descriptions nest
/// `robots/<vendor>/<model>/urdf/x.urdf`.
const MAX_DEPTH: usize = 4;

/// Names below `resources/source/`, one per path, in order. The first path is the URDF.
pub fn layout(paths: &[PathBuf], urdf_text: &str) -> Vec<String> {
    let absolute: Vec<PathBuf> = paths.iter().map(|p| normal(p)).collect();
    let Some(urdf) = absolute.first() else {
        return Vec::new();
    };
    let home = folder(urdf);
    let common = absolute
        .iter()
        .fold(home.clone(), |c, p| common(&c, &folder(p)));
    let depth = home.components().count() - common.components().count();
    let together = depth <= MAX_DEPTH && common.file_name().is_some();
    let root = if together { common } else { home };
    // Files from elsewhere share a folder of their own.
    let strangers = absolute
        .iter()
        .filter(|p| !p.starts_with(&root))
        .map(|p| folder(p))
        .reduce(|a, b| self::common(&a, &b));
    let prefix = package_name(&root, urdf_text);

    let mut taken = BTreeSet::new();
    absolute
        .iter()
        .map(|path| {
            let relative = if let Ok(below) = path.strip_prefix(&root) {
                prefix
                    .iter()
                    .map(PathBuf::from)
                    .collect::<PathBuf>()
                    .join(below)
            } else {
                let below = strangers.as_ref().and_then(|s| path.strip_prefix(s).ok());
                Path::new("meshes").join(below.unwrap_or(path))
            };
            unique(&safe_path(&relative), &mut taken)
        })
        .collect()
}

/// The path without `.` and `..`, from the root.
fn normal(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut normal = PathBuf::new();
    for part in absolute.components() {
        match part {
            Component::ParentDir => {
                normal.pop();
            }
            Component::CurDir => {}
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => normal.push(part),
        }
    }
    normal
}

fn folder(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

/// Deepest folder that both lie in.
fn common(a: &Path, b: &Path) -> PathBuf {
    a.components()
        .zip(b.components())
        .take_while(|(x, y)| x == y)
        .map(|(x, _)| x)
        .collect()
}

/// The root's name where the URDF needs it to find its meshes.
fn package_name(root: &Path, urdf_text: &str) -> Option<String> {
    let name = root.file_name()?.to_str()?;
    ["package://", "model://"]
        .iter()
        .any(|scheme| urdf_text.contains(&format!("{scheme}{name}/")))
        .then(|| name.to_owned())
}

/// Slashes between components that every system can store.
fn safe_path(path: &Path) -> String {
    let parts: Vec<String> = path
        .components()
        .filter_map(|part| match part {
            Component::Normal(name) => Some(safe_component(&name.to_string_lossy())),
            _ => None,
        })
        .collect();
    parts.join("/")
}

/// The name, or the first of `name-2.ext`, `name-3.ext` … that is free where case does not count.
fn unique(name: &str, taken: &mut BTreeSet<String>) -> String {
    if taken.insert(name.to_lowercase()) {
        return name.to_owned();
    }
    let (folder, file) = name.rsplit_once('/').map_or(("", name), |(a, b)| (a, b));
    let (stem, extension) = file
        .rsplit_once('.')
        .map_or((file, String::new()), |(a, b)| (a, format!(".{b}")));
    let slash = if folder.is_empty() { "" } else { "/" };
    let mut n = 2;
    loop {
        let candidate = format!("{folder}{slash}{stem}-{n}{extension}");
        if taken.insert(candidate.to_lowercase()) {
            return candidate;
        }
        n += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(paths: &[&str], text: &str) -> Vec<String> {
        let paths: Vec<_> = paths.iter().map(PathBuf::from).collect();
        layout(&paths, text)
    }

    #[test]
    fn a_urdf_without_meshes_is_packed_at_the_top() {
        assert_eq!(
            names(&["/home/someone/robots/r2d2.urdf"], ""),
            ["r2d2.urdf"]
        );
    }

    #[test]
    fn relative_mesh_paths_stay_valid_in_the_package() {
        assert_eq!(
            names(
                &["/x/kuka/model.urdf", "/x/kuka/meshes/a.stl"],
                "meshes/a.stl"
            ),
            ["model.urdf", "meshes/a.stl"]
        );
        assert_eq!(
            names(&["/x/kuka/urdf/model.urdf", "/x/kuka/meshes/a.stl"], ""),
            ["urdf/model.urdf", "meshes/a.stl"]
        );
    }

    #[test]
    fn package_folder_keeps_its_name_only_where_the_urdf_calls_it() {
        let paths = ["/x/anymal/robots/a.urdf", "/x/anymal/meshes/a.stl"];
        assert_eq!(
            names(&paths, "package://anymal/meshes/a.stl"),
            ["anymal/robots/a.urdf", "anymal/meshes/a.stl"]
        );
        assert_eq!(
            names(&paths, "package://other/"),
            ["robots/a.urdf", "meshes/a.stl"]
        );
    }

    #[test]
    fn packed_files_contain_no_path_of_the_machine() {
        assert_eq!(
            names(
                &[
                    "/home/someone/private/deep/er/r.urdf",
                    "/opt/ros/share/a/m/x.stl",
                    "/opt/ros/share/b/m/x.stl"
                ],
                ""
            ),
            ["r.urdf", "meshes/a/m/x.stl", "meshes/b/m/x.stl"]
        );
    }

    #[test]
    fn dots_odd_names_and_clashes_are_made_safe() {
        assert_eq!(
            names(
                &["/x/r.urdf", "/x/m/../m/ä.stl", "/x/m/ö.stl", "/x/M/_.stl"],
                ""
            ),
            ["r.urdf", "m/_.stl", "m/_-2.stl", "M/_-3.stl"]
        );
    }
}
