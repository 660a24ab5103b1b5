//! The same importer, compiled for Windows, on the library for Windows, under Wine.

#[path = "../platforms/wine.rs"]
mod wine;

use super::skipped::skipped;
use super::{GUID, TESTS, exchange, exchanges, sources, write_robots};
use std::fs;
use std::path::Path;
use wine::Wine;

#[test]
fn the_windows_library_passes_the_same_tests_under_wine() {
    let Some(library) = option_env!("URDF2FMU_READY_X86_64_WINDOWS") else {
        return skipped(
            "this urdf2fmu was built without a library for win64 in URDF2FMU_LIBRARY_DIR; build/platforms.sh makes it",
        );
    };
    let wine = match Wine::find() {
        Ok(wine) => wine,
        Err(why) => return skipped(&why),
    };
    // A name that must be encoded.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_api_wine");
    let resources = folder.join("100% é #1").join("resources");
    fs::create_dir_all(&resources).expect("a folder for the test");
    write_robots(&folder, &resources);
    let importer = folder.join("importer.exe");
    wine.compile(&importer, &folder, &sources());

    let plain = resources.to_str().expect("Unicode");
    let uri = format!("file:///Z:{}", super::encoded(plain));
    let other = exchange(&resources);
    let other = other.to_str().expect("Unicode");
    let other = format!("file:///Z:{}", super::encoded(other));
    let run = |arguments: &[&str]| {
        let uri = if exchanges(arguments[0]) {
            &other
        } else {
            &uri
        };
        let ended = wine.run(&importer, &[&[library, uri, GUID], arguments].concat());
        assert!(ended.success, "{arguments:?}: {}", ended.said);
        assert_eq!(ended.complained, "", "the library must be silent on stderr");
        ended.said
    };
    // Signals are Unix's, and how little stack a thread may have.
    let unix = |test: &str| matches!(test, "signals" | "stack");
    for test in TESTS.iter().filter(|test| !unix(test)) {
        run(&[test]);
    }

    // Every spelling of the same folder. Wine shows the root of this machine as drive Z.
    let backslashes = plain.replace('/', "\\");
    run(&[
        "locations",
        &uri,
        &format!("{uri}/"),
        &format!("file:///Z:{plain}"),
        &format!("file:///z|{plain}"),
        &format!("file:/Z:{plain}/"),
        &format!("file://localhost/Z:{plain}"),
        &format!("file:Z:{plain}"),
        &format!("file:///Z%3A{}", super::encoded(plain)),
        // é in Windows' Western code page, as an importer has it that knows nothing of UTF-8.
        &format!(
            "file:///Z:{}",
            super::encoded(plain).replace("%C3%A9", "%E9")
        ),
        &format!("Z:{plain}"),
        &format!("Z:{backslashes}"),
        &format!("Z:{backslashes}\\"),
    ]);

    let state = folder.join("state.bin");
    let state = state.to_str().expect("Unicode");
    let first = run(&["save", state]);
    assert!(first.lines().count() > 50, "{first}");
    assert_eq!(run(&["resume", state]), first);
    // What Windows has saved goes on in Linux, bit for bit.
    let Some(bench) = &*super::BENCH else { return };
    assert_eq!(bench.run(&["resume", state]), first);
}
