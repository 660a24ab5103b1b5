//! Replays the kept corpus: every file through its target, and the robots and meshes of
//! tests/robots, whole and truncated at many places.

#[path = "../../tests/robots/broken.rs"]
#[allow(dead_code, reason = "the expected findings are another test's")]
mod broken;
#[path = "../files.rs"]
mod files;
mod targets;

use std::fs;
use std::path::Path;

/// The stack of a command's main thread on Linux, bytes. A thread of tests has a quarter of it,
/// which files that nest deeply need more of where nothing is optimised.
const STACK: usize = 8 << 20;

/// The repository.
fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Runs a file and its beginnings.
fn replay_parts(bytes: &[u8], target: fn(&[u8])) {
    for part in 0..=32 {
        target(&bytes[..bytes.len() * part / 32]);
    }
}

/// Runs all files with one ending, and their beginnings; says nothing: a target that returns has
/// passed.
fn replay(ending: &str, target: fn(&[u8])) {
    let folder = root().join("tests/robots");
    let mut count = 0;
    for path in files::below(&folder) {
        if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
        {
            replay_parts(&fs::read(&path).expect("a file"), target);
            count += 1;
        }
    }
    assert!(count > 1, "{ending}: {count} files");
}

#[test]
fn urdfs_and_their_prefixes_do_not_panic() {
    replay("urdf", targets::urdf);
    for robot in broken::read(root()) {
        replay_parts(&robot.urdf, targets::urdf);
    }
}

#[test]
fn stl_files_and_their_prefixes_do_not_panic() {
    replay("stl", targets::stl);
}

#[test]
fn obj_files_and_their_prefixes_do_not_panic() {
    replay("obj", targets::obj);
}

#[test]
fn collada_files_and_their_prefixes_do_not_panic() {
    replay("dae", targets::collada);
}

/// Runs all files of a target's corpus.
fn replay_corpus(name: &str, target: fn(&[u8])) {
    let corpus = root().join("fuzz/readers/corpus");
    files::replay(&corpus.join(format!("{name}.zip")), target);
}

#[test]
fn the_corpus_of_meshes_does_no_harm() {
    replay_corpus("stl", targets::stl);
    replay_corpus("obj", targets::obj);
    replay_corpus("ply", targets::ply);
    replay_corpus("collada", targets::collada);
    replay_corpus("gltf", targets::gltf);
}

#[test]
fn the_corpus_of_urdfs_does_no_harm() {
    replay_corpus("urdf", targets::urdf);
}

#[test]
fn the_corpus_of_srdfs_does_no_harm() {
    replay_corpus("srdf", targets::srdf);
}

#[test]
fn the_corpus_of_scenes_does_no_harm() {
    replay_corpus("scene", targets::scene);
}

#[test]
fn the_corpus_of_xacro_does_no_harm() {
    let replay = || replay_corpus("xacro", targets::xacro);
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(replay);
    thread.expect("a thread").join().expect("no panic");
}

#[test]
fn the_corpus_of_terrain_does_no_harm() {
    replay_corpus("heights", targets::heights);
    replay_corpus("surface", targets::surface);
}

#[test]
fn the_corpus_of_textures_does_no_harm() {
    replay_corpus("image", targets::image);
}

#[test]
fn the_corpus_of_tables_does_no_harm() {
    replay_corpus("tables", targets::tables);
}

#[test]
fn the_corpus_of_fmus_does_no_harm() {
    replay_corpus("fmu", targets::fmu);
}

#[test]
fn the_corpus_of_small_meshes_is_decomposed_without_harm() {
    replay_corpus("decomposition", targets::decomposition);
}
