//! The `urdf2fmu` command from outside: files, output and exit codes.

#![allow(clippy::unwrap_used, reason = "a test may fail")]
#![allow(missing_docs, reason = "tests say it in their names")]

mod arguments;
mod check;
mod cli;
mod elsewhere;
#[cfg(target_os = "linux")]
mod ends;
mod export;
mod faults;
mod followed;
mod foreseen;
mod forums;
mod inertias;
mod info;
mod init;
mod meant;
mod model_description;
mod newcomers;
mod obeyed;
mod offers;
#[cfg(unix)]
mod output;
mod packages;
mod parts;
mod people;
#[cfg(unix)]
mod pipes;
mod ranges;
mod semantics;
mod unclosed;
mod workspaces;
mod world;
#[cfg(unix)]
mod xacro;
mod xacro_faults;

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Robots in `examples/`.
const EXAMPLES: [&str; 3] = ["rover", "arm", "quadruped"];

/// What a run of the command left behind.
#[derive(Debug)]
struct Run {
    code: i32,
    out: String,
    err: String,
}

fn urdf2fmu<const N: usize>(args: [&str; N]) -> Run {
    run_in(Path::new("."), &args, &[])
}

/// As many arguments as there are.
fn run(args: &[&str]) -> Run {
    run_in(Path::new("."), args, &[])
}

fn run_in(folder: &Path, args: &[&str], environment: &[(&str, &str)]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_urdf2fmu"))
        .args(args)
        .current_dir(folder)
        .env_remove("SOURCE_DATE_EPOCH")
        .env_remove("ROS_PACKAGE_PATH")
        .env_remove("AMENT_PREFIX_PATH")
        .envs(environment.iter().copied())
        .output()
        .unwrap();
    Run {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Exports `urdf` into a new folder; gives the folder and the FMU, which has no pictures and pages
/// for people: these take most of the time of an export.
fn export(urdf: &Path, options: &[&str]) -> (TempDir, PathBuf) {
    export_documented(urdf, &[options, &["--no-documentation"]].concat())
}

/// The same with pictures and pages.
fn export_documented(urdf: &Path, options: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let fmu = folder.path().join("robot.fmu");
    let mut args = vec!["export", text(urdf), "-o", text(&fmu)];
    args.extend(options);
    let run = run_in(Path::new("."), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    (folder, fmu)
}

/// Entries by name, in the order of the zip.
fn entries(fmu: &Path) -> (Vec<String>, BTreeMap<String, Vec<u8>>) {
    let mut zip = zip::ZipArchive::new(fs::File::open(fmu).unwrap()).unwrap();
    let mut names = Vec::new();
    let mut contents = BTreeMap::new();
    for i in 0..zip.len() {
        let mut entry = zip.by_index(i).unwrap();
        let name = entry.name().unwrap().into_owned();
        assert!(entry.is_file(), "{name}");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        names.push(name.clone());
        contents.insert(name, bytes);
    }
    (names, contents)
}

fn description(fmu: &Path) -> String {
    String::from_utf8(entries(fmu).1.remove("modelDescription.xml").unwrap()).unwrap()
}

/// What `info --json --variables` says.
fn info(urdf: &Path, options: &[&str]) -> Value {
    let mut args = vec!["info", text(urdf), "--json", "--variables"];
    args.extend(options);
    let run = run_in(Path::new("."), &args, &[]);
    assert_eq!(run.code, 0, "{run:?}");
    serde_json::from_str(&run.out).unwrap()
}
