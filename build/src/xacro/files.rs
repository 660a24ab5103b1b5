//! Files that match a path with wildcards.

use std::path::{Path, PathBuf};

/// Files that match a path with `*`, `?` in its last part, sorted.
pub fn matching(path: &Path) -> Vec<PathBuf> {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
        return Vec::new();
    };
    let glob = name.to_string_lossy();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            fits(&glob, &name) && !name.starts_with('.')
        })
        .collect();
    found.sort();
    found
}

fn fits(glob: &str, name: &str) -> bool {
    match glob.chars().next() {
        None => name.is_empty(),
        Some('*') => (0..=name.len())
            .filter(|&at| name.is_char_boundary(at))
            .any(|at| fits(&glob[1..], &name[at..])),
        Some(c) => name.chars().next().is_some_and(|first| {
            (c == '?' || c == first) && fits(&glob[c.len_utf8()..], &name[first.len_utf8()..])
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_stand_for_any_letters() {
        for (glob, name, fit) in [
            ("*.xacro", "arm.xacro", true),
            ("*.xacro", "arm.urdf", false),
            ("a?m*", "arm", true),
            ("a?m", "am", false),
            ("*", "", true),
        ] {
            assert_eq!(fits(glob, name), fit, "{glob} {name}");
        }
    }
}
