//! The Python environment of the tests, made at first use.
//!
//! A virtual environment with pinned packages under `target/`, which `environment.py` makes; a
//! change of the pinned versions makes a new one. `PYTHON` names the interpreter to start from
//! (default `python3`).

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[path = "../skipped.rs"]
pub mod skipped;

/// A virtual environment with everything that the tests need.
pub struct Environment {
    /// Its Python.
    pub interpreter: PathBuf,
    /// The robots that come with PyBullet.
    pub pybullet_data: PathBuf,
    /// For files of the tests.
    pub folder: PathBuf,
}

/// The folder of the Python tests.
pub fn tests() -> PathBuf {
    // Used by tests of the workspace's root and of one of its folders.
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = if package.join("tests/python").exists() {
        package
    } else {
        package.parent().expect("a folder of the workspace")
    };
    root.join("tests/python")
}

/// Interpreter to start from.
fn python() -> String {
    std::env::var("PYTHON")
        .unwrap_or_else(|_| if cfg!(windows) { "python" } else { "python3" }.to_owned())
}

/// The environment, made if need be; none, with a message, where there is no Python.
///
/// # Panics
/// If it cannot be made; the message says what to do.
pub fn make() -> Option<Environment> {
    let python = python();
    if let Err(error) = Command::new(&python).arg("--version").output() {
        skipped::skipped(&format!(
            "`{python}` does not start ({error}); install Python 3, or set the environment \
             variable PYTHON"
        ));
        return None;
    }
    let base = Path::new(env!("CARGO_TARGET_TMPDIR"));

    // Two test runs at once: the second waits. The lock ends with the process, whatever becomes of
    // it.
    let lock = File::create(base.join("python.lock")).expect("target/ is writable");
    lock.lock().expect("target/ can be locked");
    let made = Command::new(&python)
        .arg(tests().join("environment.py"))
        .arg(base)
        .stderr(Stdio::inherit())
        .output()
        .expect("python has just run");
    assert!(
        made.status.success(),
        "the Python environment could not be made; the reason stands above"
    );
    let said = String::from_utf8_lossy(&made.stdout);
    let folder = PathBuf::from(said.lines().last().expect("it says where it is"));
    Some(Environment {
        interpreter: folder.join(if cfg!(windows) {
            "Scripts/python.exe"
        } else {
            "bin/python"
        }),
        pybullet_data: folder.join("data/pybullet_data"),
        folder,
    })
}
