//! The libraries of all platforms, as packed in an FMU: needed libraries, exported names, and equal
//! results to the last bit.
//!
//! Of a command that was built with the libraries of `build/platforms.sh`; else skipped, with a
//! message on standard error that says what is missing. Those that `build/platforms.sh --all` adds
//! are tested where they are: `tests/platforms/all.sh` makes them and runs everything here.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

#[allow(dead_code, reason = "only the robots of PyBullet are used")]
#[path = "../python/environment.rs"]
mod environment;
mod foreign;
mod mach;
mod wine;

use environment::skipped::skipped;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use wine::Wine;

/// A library of `build/platforms.sh`, if this command was built with it: the build script says so.
///
/// - `platform`: FMI 3.0's name
fn made(platform: &str) -> Option<&'static str> {
    let made = match platform {
        "x86_64-linux" => option_env!("URDF2FMU_READY_X86_64_LINUX"),
        "x86_64-windows" => option_env!("URDF2FMU_READY_X86_64_WINDOWS"),
        "aarch64-linux" => option_env!("URDF2FMU_READY_AARCH64_LINUX"),
        "x86_64-darwin" => option_env!("URDF2FMU_READY_X86_64_DARWIN"),
        _ => option_env!("URDF2FMU_READY_AARCH64_DARWIN"),
    };
    let usual = platform == "x86_64-linux" || platform == "x86_64-windows";
    let why = format!(
        "this urdf2fmu was built without a library for {platform} in URDF2FMU_LIBRARY_DIR; build/platforms.sh{} \
         makes it",
        if usual { "" } else { " --all" }
    );
    if made.is_none() && usual {
        skipped(&why);
    } else if made.is_none() {
        // Built on request only: no fault of a machine that runs all tests.
        _ = writeln!(std::io::stderr(), "not tested: {why}");
    }
    made
}

/// An FMU of a robot, unpacked.
struct Fmu {
    folder: PathBuf,
    name: String,
    guid: String,
    /// As `urdf2fmu info --json --variables` tells.
    variables: Vec<Value>,
    _temporary: tempfile::TempDir,
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
}

fn output(program: &mut Command) -> String {
    let output = program.output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

impl Fmu {
    fn of(urdf: &Path, options: &[&str]) -> Self {
        let temporary = tempfile::tempdir().unwrap();
        let folder = temporary.path().to_owned();
        let fmu = folder.join("robot.fmu");
        let urdf2fmu = || Command::new(env!("CARGO_BIN_EXE_urdf2fmu"));
        output(
            urdf2fmu()
                .args(["export", "--no-documentation"])
                .arg(urdf)
                .arg("-o")
                .arg(&fmu)
                .args(options),
        );
        let mut zip = zip::ZipArchive::new(fs::File::open(&fmu).unwrap()).unwrap();
        for i in 0..zip.len() {
            let mut entry = zip.by_index(i).unwrap();
            let place = folder.join(entry.enclosed_name().unwrap());
            fs::create_dir_all(place.parent().unwrap()).unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            fs::write(place, bytes).unwrap();
        }
        let info = output(
            urdf2fmu()
                .arg("info")
                .arg(&fmu)
                .args(["--json", "--variables"]),
        );
        let info: Value = serde_json::from_str(&info).unwrap();
        let xml = fs::read_to_string(folder.join("modelDescription.xml")).unwrap();
        let attribute = |name: &str| {
            let from = xml.find(&format!("{name}=\"")).unwrap() + name.len() + 2;
            xml[from..].split('"').next().unwrap().to_owned()
        };
        Self {
            name: attribute("modelIdentifier"),
            guid: attribute("guid"),
            variables: info["variables"].as_array().unwrap().clone(),
            folder,
            _temporary: temporary,
        }
    }

    /// The library for a platform, if [`made`].
    fn library(&self, platform: &str) -> Option<PathBuf> {
        made(platform)?;
        let (folder, end) = match platform.split_once('-').map(|(_, system)| system) {
            Some("linux") => ("linux64", "so"),
            Some("windows") => ("win64", "dll"),
            _ => ("darwin64", "dylib"),
        };
        let file = self
            .folder
            .join("binaries")
            .join(folder)
            .join(format!("{}.{end}", self.name));
        assert!(file.is_file(), "{}", file.display());
        Some(file)
    }

    fn resources(&self) -> String {
        format!("file://{}", self.folder.join("resources").display())
    }

    /// The Reals of a causality: value references, names and start values.
    fn reals(&self, causality: &str) -> Vec<(u64, &str, f64)> {
        self.variables
            .iter()
            .filter(|v| v["causality"] == causality && v["type"] == "Real")
            .map(|v| {
                let reference = v["value_reference"].as_u64().unwrap();
                let start = v["start"].as_f64().unwrap_or(0.0);
                (reference, v["name"].as_str().unwrap(), start)
            })
            .collect()
    }

    /// Two seconds of commands that wander, in steps of changing size, and how many states there
    /// are; the format is in `trace.c`.
    fn script(&self) -> String {
        use std::fmt::Write as _;
        const SIZES: [f64; 4] = [1.0 / 240.0, 0.01, 1e-3, 1.0 / 30.0];
        const STEPS: u32 = 164;
        let (inputs, outputs) = (self.reals("input"), self.reals("output"));
        let mut text = String::new();
        for list in [&inputs, &outputs] {
            _ = write!(text, "{}", list.len());
            for (reference, ..) in list {
                _ = write!(text, " {reference}");
            }
            text.push('\n');
        }
        _ = writeln!(text, "{STEPS}");
        let mut time = 0.0;
        for (step, h) in (0..STEPS).zip(SIZES.iter().cycle()) {
            _ = write!(text, "{:016x}", h.to_bits());
            for (i, (_, name, start)) in (1_u32..).zip(&inputs) {
                let amplitude = match name.rsplit('.').next() {
                    Some("velocity") => 3.0,
                    Some("position") => 0.3,
                    Some("effort") => 1.0,
                    _ => 0.0,
                };
                // Between −1 and 1, with a period of its own for every input; now and then a jump.
                let phase = time * (0.3 + 0.1 * f64::from(i % 7)) + f64::from(step / 50) * 0.2;
                let wave = 4.0 * (phase - phase.floor() - 0.5).abs() - 1.0;
                _ = write!(text, " {:016x}", (start + amplitude * wave).to_bits());
            }
            text.push('\n');
            time += h;
        }
        let names = self.variables.iter().filter_map(|v| v["name"].as_str());
        let states = names.filter(|name| name.starts_with("der(")).count();
        _ = writeln!(text, "{states}");
        text
    }
}

/// `objdump -p` and the dynamic symbols.
fn objdump(option: &str, library: &Path) -> Option<String> {
    if Command::new("objdump").arg("--version").output().is_err() {
        skipped("there is no objdump; on Debian: apt-get install binutils");
        return None;
    }
    Some(output(Command::new("objdump").arg(option).arg(library)))
}

/// FMI 2.0.4: 25 common functions, 10 of Model Exchange, 9 of co-simulation.
fn assert_all_of_fmi<'a>(names: impl Iterator<Item = &'a str>) {
    let names: Vec<&str> = names.collect();
    for (prefix, count) in [("fmi2", 44), ("fmi3", 75)] {
        let of_version = names.iter().filter(|name| name.starts_with(prefix));
        assert_eq!(of_version.count(), count, "{names:?}");
    }
    assert_eq!(names.len(), 44 + 75, "{names:?}");
}

#[test]
fn the_linux_library_needs_glibc_2_17_and_nothing_else() {
    let fmu = Fmu::of(&example("rover.urdf"), &[]);
    if let Some(library) = fmu.library("x86_64-linux") {
        assert_glibc_2_17_and_nothing_else(&library, "ld-linux-x86-64.so.2");
    }
}

/// - `loader`: glibc's part that loads libraries, which has another name on each processor
fn assert_glibc_2_17_and_nothing_else(library: &Path, loader: &str) {
    let Some(text) = objdump("-p", library) else {
        return;
    };
    let needed: BTreeSet<&str> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("NEEDED"))
        .map(str::trim)
        .collect();
    // libm.so.6 would do no harm to loading, but its functions differ between releases and so would
    // results.
    let allowed = ["libc.so.6", loader];
    assert!(needed.contains("libc.so.6"), "{text}");
    assert!(
        needed.iter().all(|name| allowed.contains(name)),
        "{needed:?}"
    );
    // Neither a search path nor relocations in the code.
    for tag in ["RPATH", "RUNPATH", "TEXTREL"] {
        assert!(!text.contains(tag), "{text}");
    }

    let Some(symbols) = objdump("-T", library) else {
        return;
    };
    let versions: Vec<(u32, u32)> = symbols
        .split("(GLIBC_")
        .skip(1)
        .map(|rest| {
            let mut parts = rest.split([')', '.']).map(|part| part.parse().unwrap());
            (parts.next().unwrap(), parts.next().unwrap())
        })
        .collect();
    assert!(versions.len() > 20, "{symbols}");
    assert!(
        versions.iter().all(|version| *version <= (2, 17)),
        "{symbols}"
    );
    // FMI's functions are all that is defined.
    let defined = symbols.lines().filter(|line| line.contains(" g "));
    assert_all_of_fmi(defined.filter_map(|line| line.split_whitespace().last()));
}

#[test]
fn the_windows_library_needs_windows_and_nothing_else() {
    let fmu = Fmu::of(&example("rover.urdf"), &[]);
    let Some(library) = fmu.library("x86_64-windows") else {
        return;
    };
    let Some(text) = objdump("-p", &library) else {
        return;
    };
    let dlls: Vec<String> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("DLL Name: "))
        .map(str::to_lowercase)
        .collect();
    assert!(dlls.iter().any(|dll| dll == "kernel32.dll"), "{text}");
    assert!(dlls.iter().all(|dll| is_of_windows(dll)), "{dlls:?}");
    // On Windows the C library holds these.
    for name in text.split_whitespace() {
        assert!(!OF_MATH_H.contains(&name), "{name} is imported");
    }
    let names = text
        .split_once("[Ordinal/Name Pointer] Table")
        .unwrap()
        .1
        .lines()
        .skip(1)
        .map_while(|line| line.split_whitespace().last());
    assert_all_of_fmi(names);
    // May be loaded anywhere in memory, and not run from its data.
    assert!(
        text.contains("DYNAMIC_BASE") && text.contains("NX_COMPAT"),
        "{text}"
    );
}

/// C11, 7.12: functions that not every C library rounds correctly, and that Rust's methods call.
const OF_MATH_H: [&str; 34] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "ceil", "cos", "cosh",
    "erf", "exp", "exp2", "expm1", "floor", "fma", "fmod", "hypot", "ldexp", "lgamma", "log",
    "log10", "log1p", "log2", "pow", "rint", "round", "sin", "sinh", "sqrt", "tan", "tanh",
    "tgamma",
];

/// Parts of every Windows since 10: the kernel, its C library of old, and the sets that they are
/// also known by.
fn is_of_windows(dll: &str) -> bool {
    ["kernel32.dll", "ntdll.dll", "msvcrt.dll", "ucrtbase.dll"].contains(&dll)
        || dll.starts_with("api-ms-win-")
}

/// Ten robots, four of them in worlds: terrain, things to grasp, a closed loop, sensors.
fn robots() -> Option<Vec<(PathBuf, Vec<String>)>> {
    let data = environment::make()?.pybullet_data;
    let with = |settings: &str| vec!["-c".to_owned(), example(settings).display().to_string()];
    let both = || vec!["--interface".to_owned(), "both".to_owned()];
    let world = |robot: &str, settings: &str| {
        let settings = with(&format!("worlds/{settings}.toml"));
        (example("worlds").join(robot), settings)
    };
    Some(vec![
        (data.join("r2d2.urdf"), both()),
        (data.join("kuka_iiwa/model.urdf"), both()),
        (data.join("a1/a1.urdf"), both()),
        (example("arm.urdf"), both()),
        (
            example("quadruped.urdf"),
            [with("quadruped.toml"), both()].concat(),
        ),
        (example("rover.urdf"), both()),
        world("../quadruped.urdf", "rough_ground"),
        world("gripper.urdf", "gripper_cup"),
        world("delta.urdf", "delta"),
        world("../rover.urdf", "lidar_maze"),
    ])
}

/// `trace.c` for this machine.
fn native_trace(folder: &Path) -> PathBuf {
    let program = folder.join("trace");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    compile_trace(&compiler, &program);
    program
}

fn compile_trace(compiler: &str, program: &Path) {
    let mut command = Command::new(compiler);
    let command = command.args(["-std=gnu11", "-O1", "-o"]).arg(program);
    output(command.arg(trace_source()).arg("-ldl"));
}

fn trace_source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/platforms/trace.c")
}

/// That another system's library gives what the one for Linux on `x86_64` gives, on every robot.
///
/// - `folder`: for programs, of this test alone
/// - `run`: runs the trace on a library there
fn assert_same_bits(folder: &Path, platform: &str, run: impl Fn(&[String; 4]) -> wine::Ended) {
    fs::create_dir_all(folder).unwrap();
    let native = native_trace(folder);
    let Some(robots) = robots() else {
        return;
    };
    for (urdf, options) in robots {
        let options: Vec<&str> = options.iter().map(String::as_str).collect();
        let export = |platform| Fmu::of(&urdf, &[&options[..], &["--platform", platform]].concat());
        let (here, there) = (export("x86_64-linux"), export(platform));
        let (Some(own), Some(other)) = (here.library("x86_64-linux"), there.library(platform))
        else {
            return;
        };
        let arguments = |fmu: &Fmu, library: PathBuf| {
            let script = fmu.folder.join("script");
            fs::write(&script, fmu.script()).unwrap();
            [
                library.to_str().unwrap().to_owned(),
                fmu.resources(),
                fmu.guid.clone(),
                script.to_str().unwrap().to_owned(),
            ]
        };
        let expected = output(Command::new(&native).args(arguments(&here, own)));
        let ended = run(&arguments(&there, other));
        assert!(ended.success, "{}: {}", urdf.display(), ended.said);
        assert_eq!(ended.complained, "", "the library must be silent on stderr");

        let states = expected.lines().filter(|line| !line.starts_with("message"));
        let states: BTreeSet<&str> = states.map(|line| &line[17..]).collect();
        // Of 164 steps: a gripper that holds rests in some of them.
        assert!(
            states.len() > 150,
            "{}: {} states",
            urdf.display(),
            states.len()
        );
        for (step, (ours, theirs)) in expected.lines().zip(ended.said.lines()).enumerate() {
            assert_eq!(ours, theirs, "{}, line {step}", urdf.display());
        }
        assert_eq!(expected, ended.said);
    }
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn linux_and_windows_calculate_the_same_bits() {
    if made("x86_64-windows").is_none() || made("x86_64-linux").is_none() {
        return;
    }
    let wine = match Wine::find() {
        Ok(wine) => wine,
        Err(why) => return skipped(&why),
    };
    let folder = folder("platforms");
    fs::create_dir_all(&folder).unwrap();
    let program = folder.join("trace.exe");
    wine.compile(&program, &folder, &[trace_source()]);
    assert_same_bits(&folder, "x86_64-windows", |arguments| {
        wine.run(&program, arguments)
    });
}
