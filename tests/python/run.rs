//! Runs the Python tests (`tests/python`) on the `urdf2fmu` command of this build.
//!
//! They need nothing but Rust and Python 3, see `environment.rs`. pytest's own `PYTEST_ADDOPTS`
//! passes options to it, for example `PYTEST_ADDOPTS="-k r2d2"`.

#[path = "environment.rs"]
mod environment;

use std::process::Command;

#[test]
fn the_python_tests_pass() {
    let Some(environment) = environment::make() else {
        return;
    };
    let status = Command::new(environment.interpreter)
        // No files beside the sources.
        .args([
            "-B",
            "-m",
            "pytest",
            "-p",
            "no:cacheprovider",
            "-ra",
            "--durations=10",
        ])
        .arg("--basetemp")
        .arg(environment.folder.join("pytest"))
        .arg(environment::tests())
        .env("URDF2FMU", env!("CARGO_BIN_EXE_urdf2fmu"))
        .env("PYBULLET_DATA", environment.pybullet_data)
        .env(
            "URDF2FMU_WINE",
            concat!(env!("CARGO_TARGET_TMPDIR"), "/wine"),
        )
        .env_remove("PYTHONPATH")
        .status()
        .expect("the environment has an interpreter");
    assert!(status.success(), "pytest failed; its report stands above");
}
