//! What a folder is: a package, by its `package.xml` or its name, or one of all users.

use std::fs;
use std::path::{Path, PathBuf};

/// `package.xml` files larger than this, in bytes, are not looked into.
const LARGEST_MANIFEST: u64 = 1_000_000;

/// Whether a folder is that of a user or of all, or one above these.
pub(super) fn is_common(dir: &Path) -> bool {
    let users = dir.parent().and_then(Path::file_name);
    let home = ["HOME", "USERPROFILE"]
        .into_iter()
        .filter_map(std::env::var_os);
    let mut common = home
        .map(PathBuf::from)
        .chain([std::env::temp_dir()])
        .map(|folder| fs::canonicalize(&folder).unwrap_or(folder));
    dir.parent().is_none()
        || users.is_some_and(|name| name == "home" || name == "Users")
        || common.any(|folder| folder.starts_with(dir))
}

/// The package's name, and the same with hyphens for underscores and the other way round:
/// repositories are often named `my-robot` where the package is `my_robot`.
pub(super) fn spellings(package: &str) -> Vec<String> {
    let mut list = vec![package.to_owned()];
    for other in [package.replace('_', "-"), package.replace('-', "_")] {
        if !list.contains(&other) {
            list.push(other);
        }
    }
    list
}

/// Whether a folder has one of these names.
pub(super) fn is_called(dir: &Path, names: &[String]) -> bool {
    let own = dir.file_name().and_then(|name| name.to_str());
    own.is_some_and(|own| names.iter().any(|name| name == own))
}

pub(super) fn has_manifest(dir: &Path) -> bool {
    dir.join("package.xml").is_file()
}

/// Whether the `package.xml` of a folder has one of these names.
pub(super) fn manifest_is(dir: &Path, names: &[String]) -> bool {
    manifest_name(dir).is_some_and(|name| names.contains(&name))
}

/// The `<name>` in a folder's `package.xml`.
pub(super) fn manifest_name(dir: &Path) -> Option<String> {
    let path = dir.join("package.xml");
    let size = fs::metadata(&path)
        .ok()
        .filter(fs::Metadata::is_file)?
        .len();
    if size > LARGEST_MANIFEST {
        return None;
    }
    let text = fs::read_to_string(path).ok()?;
    let (_, rest) = text.split_once("<name>")?;
    let (name, _) = rest.split_once("</name>")?;
    Some(name.trim().to_owned())
}
