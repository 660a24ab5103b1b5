//! The message about a file that was not found.

use crate::diagnostic::words::{near_file, shell};
use std::path::{Path, PathBuf};

/// A mesh file that was not found.
#[derive(Debug, PartialEq, Eq)]
pub struct NotFound {
    /// Every place that was looked at, in order.
    pub tried: Vec<PathBuf>,
    /// What to do.
    pub advice: String,
    /// The folder where it is looked for first, if all places are outside of the robot's folders.
    pub outside: Option<PathBuf>,
}

impl NotFound {
    pub fn help(&self) -> String {
        self.help_with(self.outside.as_deref())
    }

    /// The message with another folder in place of [`Self::outside`].
    pub fn help_with(&self, outside: Option<&Path>) -> String {
        use std::fmt::Write as _;
        /// More lines than this hide the advice.
        const MOST_SHOWN: usize = 5;
        let mut text = String::new();
        // Where there is a folder, somebody may have meant it.
        let near = |path: &&PathBuf| path.parent().is_some_and(Path::is_dir);
        let others = self.tried.iter().filter(|path| !near(path));
        let shown = self.tried.iter().filter(near).chain(others);
        for (i, path) in shown.take(MOST_SHOWN).enumerate() {
            let lead = if i == 0 { "tried " } else { "      " };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{lead}{}", path.display());
        }
        if self.tried.len() > MOST_SHOWN {
            let more = self.tried.len() - MOST_SHOWN;
            let s = if more == 1 { "" } else { "s" };
            let _ = writeln!(text, "      and {more} more place{s}");
        }
        text.push_str(&self.advice);
        // Who puts the file there would be told next that it is not read from there.
        if let Some(folder) = outside {
            let _ = write!(
                text,
                "\nthat is outside of the robot's folders: with the file, pass --package-path {}",
                shell(&folder.display().to_string())
            );
        }
        text
    }
}

/// Advice on a name whose last part alone is that of one of the robot's files.
pub(super) fn same_name(path: &Path) -> String {
    format!(
        "the robot's folders have one file of that name, {}: if it is meant, correct the path in the URDF",
        path.display()
    )
}

/// Advice on a name of a form that means no file here, whatever lies in the folders.
pub(super) fn unusual(name: &str) -> Option<String> {
    let file = name.rsplit('/').next().unwrap_or_default();
    let beside = format!("put the file beside the URDF, and write filename=\"{file}\"");
    if let Some((package, rest)) = name.strip_prefix("$(find").and_then(|n| n.split_once(')')) {
        let package = package.trim_start_matches("-pkg-share").trim();
        let rest = rest.trim_start_matches('/');
        return Some(format!(
            "$(find …) is of xacro and of launch files: write package://{package}/{rest}"
        ));
    }
    let (scheme, _) = name.split_once("://").unwrap_or_default();
    if ["http", "https"].contains(&scheme.to_lowercase().as_str()) {
        return Some(format!("nothing is downloaded: {beside}"));
    }
    let address = name.strip_prefix("file://");
    let path = address
        .or_else(|| name.strip_prefix("file:"))
        .unwrap_or(name);
    let mut letters = path.trim_start_matches('/').chars();
    let drive = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    let drive = drive && letters.next() == Some(':') && letters.next() == Some('/');
    if drive && !cfg!(windows) {
        return Some(format!("that is a path of a Windows machine: {beside}"));
    }
    if path.starts_with(['~', '$', '%']) && path.contains('/') && !name.contains("$(") {
        let start = path.split('/').next().unwrap_or_default();
        return Some(format!("'{start}' is not replaced here: {beside}"));
    }
    let scheme = ["package", "model"].into_iter().find_map(|scheme| {
        let rest = name.strip_prefix(scheme)?.strip_prefix(":")?;
        Some((scheme, rest))
    });
    let (scheme, rest) = scheme?;
    let inside = rest.trim_start_matches('/');
    let parts = inside.split('/').filter(|part| !part.is_empty()).count();
    if parts < 2 {
        let package = if inside.is_empty() {
            "NAME"
        } else {
            inside.trim_end_matches('/')
        };
        let message = "that names no file of a package";
        return Some(format!(
            "{message}: write {scheme}://{package}/ and the file's path in it"
        ));
    }
    (!rest.starts_with("//")).then(|| format!("write two slashes: {scheme}://{inside}"))
}

/// Advice on a package that was not found.
///
/// - `cut_short`: a folder that has more than was looked at
pub(super) fn package(name: &str, cut_short: Option<&Path>) -> String {
    let more = cut_short.map_or_else(String::new, |folder| {
        let folder = folder.display();
        format!("\n{folder} has more files than are looked at: the package may be there")
    });
    format!(
        "pass --package {name}=DIR, or --package-path DIR where DIR holds the folder '{name}'{more}"
    )
}

/// Advice on a file that is not in its package.
pub(super) fn in_package(name: &str, folder: &Path, file: &str) -> String {
    let at = folder.display();
    let near = near_file(&folder.join(file));
    let near = near.map_or_else(String::new, |near| {
        format!(" did you mean '{}'?", near.display())
    });
    format!(
        "package '{name}' is at {at}; there is no '{file}' in it:{near} put it there, or pass \
         --package {name}=DIR if another one is meant"
    )
}
