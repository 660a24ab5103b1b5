//! What fuzzing has found worth keeping runs again: every file of the corpus through its target.

mod targets;

use std::fs;
use std::path::Path;

/// Runs all files of one target; says how many.
fn replay(name: &str, target: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/corpus")
        .join(name);
    let mut count = 0;
    for entry in fs::read_dir(&folder).expect("the corpus is there") {
        let path = entry.expect("a file").path();
        target(&fs::read(&path).expect("a file"));
        count += 1;
    }
    assert!(count > 10, "{name}: {count} files");
}

#[test]
fn the_corpus_of_states_does_no_harm() {
    replay("states", targets::states);
}

#[test]
fn the_corpus_of_models_does_no_harm() {
    replay("model", targets::model);
}

#[test]
fn the_corpus_of_settings_does_no_harm() {
    replay("settings", targets::settings);
}

#[test]
fn the_corpus_of_calls_does_no_harm() {
    replay("calls", targets::calls);
}
