//! Runs files through fuzz targets, for the replays.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// The files below a folder.
#[allow(dead_code, reason = "the readers' replay needs it")]
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

/// Runs all entries of a target's corpus, an archive that `fuzz/corpus.py` has packed; says
/// nothing: a target that returns has passed.
pub fn replay(corpus: &Path, target: fn(&[u8])) {
    let mut archive = ZipArchive::new(File::open(corpus).expect("a corpus")).expect("an archive");
    let count = archive.len();
    assert!(count > 10, "{}: {count} entries", corpus.display());
    for i in 0..count {
        let mut bytes = Vec::new();
        let mut entry = archive.by_index(i).expect("an entry");
        entry.read_to_end(&mut bytes).expect("whole entries");
        target(&bytes);
    }
}
