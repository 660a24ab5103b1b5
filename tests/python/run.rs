//! Runs the Python tests (`tests/python`) on the `urdf2fmu` command of this build.
//!
//! They need nothing but Rust and Python 3, see `environment.rs`. pytest's own `PYTEST_ADDOPTS`
//! passes options to it, for example `PYTEST_ADDOPTS="-k r2d2"`.

#[path = "environment.rs"]
mod environment;

use std::process::Command;

/// Tests of what lasts as long as it says, or is measured in seconds: no other test of these runs
/// beside them. They come first, because `.ci/run` has work of less priority at that time.
const ALONE: [&str; 2] = ["test_view.py", "test_view_cost.py"];

#[test]
fn the_python_tests_pass() {
    let Some(environment) = environment::make() else {
        return;
    };
    let tests = environment::tests();
    let run = |folder: &str, arguments: &[String]| {
        let status = Command::new(&environment.interpreter)
            // No files beside the sources.
            .args(["-B", "-m", "pytest", "-p", "no:cacheprovider"])
            .args(["-ra", "--durations=10", "--basetemp"])
            .arg(environment.folder.join(folder))
            .args(arguments)
            .env("URDF2FMU", env!("CARGO_BIN_EXE_urdf2fmu"))
            .env("PYBULLET_DATA", &environment.pybullet_data)
            .env(
                "URDF2FMU_WINE",
                concat!(env!("CARGO_TARGET_TMPDIR"), "/wine"),
            )
            .env_remove("PYTHONPATH")
            .status()
            .expect("the environment has an interpreter");
        status.code()
    };
    let path = |name: &str| tests.join(name).display().to_string();
    let ignored = ALONE.map(|name| format!("--ignore={}", path(name)));
    // Each process begins with the files of one half, whose tests share what they make, and helps
    // the other at the end.
    let mut beside = ["-n", "2", "--dist", "worksteal"]
        .map(String::from)
        .to_vec();
    beside.extend(ignored);
    beside.push(path(""));
    let codes = [
        run("pytest-alone", &ALONE.map(path)),
        run("pytest", &beside),
    ];
    // 5: `PYTEST_ADDOPTS` chooses none of these; some it must choose.
    let passed = codes.iter().all(|code| matches!(code, Some(0 | 5))) && codes.contains(&Some(0));
    assert!(passed, "pytest failed; its report stands above");
}
