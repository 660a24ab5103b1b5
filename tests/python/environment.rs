//! The Python environment of the tests, made at first use.
//!
//! A virtual environment with pinned packages under `target/`; a change of the pinned versions
//! makes a new one. `PYTHON` names the interpreter to start from (default `python3`).

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use urdf2fmu_core::hash::Fnv;

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

const REQUIREMENTS: [&str; 3] = [
    include_str!("requirements.txt"),
    include_str!("requirements-data.txt"),
    include_str!("environment.py"),
];

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

/// A short name for what an environment is made from.
fn hash(texts: &[&str]) -> u64 {
    let mut hash = Fnv::default();
    for text in texts {
        hash.add(text.as_bytes());
        hash.add(&[0]);
    }
    hash.value()
}

/// The environment, made if need be; none, with a message, where there is no Python.
///
/// # Panics
/// If it cannot be made; the message says what to do.
pub fn make() -> Option<Environment> {
    let python = python();
    let mut command = Command::new(&python);
    command.args(["-c", "import sys; print(sys.version, sys.prefix)"]);
    let version = match command.output() {
        Ok(version) => version,
        Err(error) => {
            skipped::skipped(&format!(
                "`{python}` does not start ({error}); install Python 3, or set the environment \
                 variable PYTHON"
            ));
            return None;
        }
    };
    assert!(version.status.success(), "`{python}` does not run");
    let version = String::from_utf8_lossy(&version.stdout);
    let name = hash(&[REQUIREMENTS[0], REQUIREMENTS[1], REQUIREMENTS[2], &version]);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("python-{name:016x}"));
    let ready = folder.join("ready");

    // Two test runs at once: the second waits. The lock ends with the process, whatever becomes of
    // it.
    let lock = File::create(folder.with_extension("lock")).expect("target/ is writable");
    lock.lock().expect("target/ can be locked");
    if !ready.exists() {
        if folder.exists() {
            fs::remove_dir_all(&folder).expect("an unfinished environment can be removed");
        }
        let status = Command::new(&python)
            .arg(tests().join("environment.py"))
            .arg(&folder)
            .status()
            .expect("python has just run");
        assert!(
            status.success(),
            "the Python environment could not be made; the reason stands above"
        );
        File::create(ready).expect("target/ is writable");
    }
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
