//! What fuzzing has found worth keeping runs again: every entry of a corpus through its target.

mod files;
mod targets;

use std::path::Path;

/// Runs all files of one target.
fn replay(name: &str, target: fn(&[u8])) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    files::replay(&corpus.join(format!("{name}.zip")), target);
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

#[test]
fn the_corpus_of_calls_of_fmi_3_does_no_harm() {
    replay("calls3", targets::calls3);
}

#[test]
fn the_corpus_of_viewers_does_no_harm() {
    replay("viewer", targets::viewer);
}
