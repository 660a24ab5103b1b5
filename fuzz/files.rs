//! Files through fuzz targets, for the replays.

use std::fs;
use std::path::{Path, PathBuf};

/// The files below a folder.
pub fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(below(&path));
        } else {
            found.push(path);
        }
    }
    found
}

/// Runs all files of a target's corpus; says nothing: a target that returns has passed.
pub fn replay(corpus: &Path, target: fn(&[u8])) {
    let files = below(corpus);
    for path in &files {
        target(&fs::read(path).expect("a file"));
    }
    assert!(
        files.len() > 10,
        "{}: {} files",
        corpus.display(),
        files.len()
    );
}
