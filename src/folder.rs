//! The folders of files.

use std::path::Path;

/// A folder, which is the present one where its path is empty: that of a file that is named without
/// one.
pub fn present(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

/// The folder that a file is in.
pub fn of(file: &Path) -> &Path {
    present(file.parent().unwrap_or(Path::new("")))
}

#[cfg(test)]
mod tests {
    use super::of;
    use std::path::Path;

    #[test]
    fn a_file_that_is_named_without_a_folder_lies_in_the_present_one() {
        for (file, folder) in [
            ("r.urdf", "."),
            ("./r.urdf", "."),
            ("a/r.urdf", "a"),
            ("/r.urdf", "/"),
            ("", "."),
        ] {
            assert_eq!(of(Path::new(file)), Path::new(folder), "{file}");
        }
    }
}
