//! Files that match a path with wildcards.

use std::path::{Component, Path, PathBuf};
use urdf2fmu_core::folder;

/// Signs that make a name of a file a pattern.
pub const SIGNS: [char; 3] = ['*', '?', '['];

/// Files that match a path with `*`, `?` and `[…]` in its parts, sorted. As in Python's `glob`, `*`
/// means no hidden file.
///
/// - `folder`: from which the path counts; empty is the present one
pub fn matching(folder: &Path, path: &str) -> Vec<PathBuf> {
    let mut found = vec![folder.to_owned()];
    for part in Path::new(path).components() {
        let glob = part.as_os_str().to_string_lossy();
        if matches!(part, Component::Normal(_)) && glob.contains(SIGNS) {
            found = found
                .iter()
                .flat_map(|in_it| within(in_it, &glob))
                .collect();
        } else {
            for path in &mut found {
                path.push(part);
            }
        }
    }
    found.retain(|path| path.exists());
    found.sort();
    found
}

/// What of a folder has a name that fits.
fn within(folder: &Path, glob: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder::present(folder));
    let names = entries.into_iter().flatten().flatten();
    let names = names.map(|entry| entry.file_name());
    let fitting = names.filter(|name| {
        let name = name.to_string_lossy();
        fits(glob, &name) && (glob.starts_with('.') || !name.starts_with('.'))
    });
    fitting.map(|name| folder.join(name)).collect()
}

fn fits(glob: &str, name: &str) -> bool {
    let mut letters = glob.chars();
    let Some(sign) = letters.next() else {
        return name.is_empty();
    };
    if sign == '*' {
        return (0..=name.len())
            .filter(|&at| name.is_char_boundary(at))
            .any(|at| fits(letters.as_str(), &name[at..]));
    }
    let mut rest = name.chars();
    let Some(first) = rest.next() else {
        return false;
    };
    let (fit, glob) = match set(letters.as_str()) {
        Some((set, behind)) if sign == '[' => (has(set, first), behind),
        _ => (sign == '?' || sign == first, letters.as_str()),
    };
    fit && fits(glob, rest.as_str())
}

/// What stands in brackets and behind them; a bracket that comes first is one of the letters.
fn set(glob: &str) -> Option<(&str, &str)> {
    let start = usize::from(glob.starts_with('!'));
    let letters = glob.get(start..)?.char_indices();
    let (at, _) = letters.skip(1).find(|(_, letter)| *letter == ']')?;
    Some((&glob[..start + at], &glob[start + at + 1..]))
}

/// Whether a letter is one of those in brackets, `a-z` or `!0` for instance.
fn has(set: &str, letter: char) -> bool {
    let listed = set.strip_prefix('!');
    let mut rest = listed.unwrap_or(set).chars();
    let mut found = false;
    while let Some(low) = rest.next() {
        let mut ahead = rest.clone();
        let high = match (ahead.next(), ahead.next()) {
            (Some('-'), Some(high)) => {
                rest = ahead;
                high
            }
            _ => low,
        };
        found |= (low..=high).contains(&letter);
    }
    found != listed.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: `fnmatch.fnmatchcase` of Python 3.11.
    #[test]
    fn signs_stand_for_any_letters() {
        for (glob, name, fit) in [
            ("*.xacro", "arm.xacro", true),
            ("*.xacro", "arm.urdf", false),
            ("a?m*", "arm", true),
            ("a?m", "am", false),
            ("*", "", true),
            ("a[1].xacro", "a1.xacro", true),
            ("a[1].xacro", "a[1].xacro", false),
            ("a[0-3b]*", "a2c", true),
            ("a[0-3b]*", "ab", true),
            ("a[0-3b]", "a4", false),
            ("a[!0-3]", "a4", true),
            ("a[!0-3]", "a0", false),
            ("a[]]", "a]", true),
            ("a[", "a[", true),
            ("a[]", "a[]", true),
            ("a[-x]", "a-", true),
            ("[äö]x", "öx", true),
        ] {
            assert_eq!(fits(glob, name), fit, "{glob} {name}");
        }
    }
}
