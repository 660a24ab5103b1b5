//! Builds `fmi/` as a shared library and embeds it into the `urdf2fmu` command.
//!
//! A package that is both cdylib and rlib would be built without link-time optimisation, so `fmi/`
//! is an rlib and this script runs `cargo rustc --crate-type cdylib` on it, in a target directory
//! of its own (the outer build holds the lock of the usual one) and with a profile of its own: a
//! debug `urdf2fmu` exports the same library as a released one.
//!
//! | variable | effect |
//! |---|---|
//! | `URDF2FMU_LIBRARY` | a ready library for the target platform; `none`: this platform is left out |
//! | `URDF2FMU_LIBRARY_DIR` | a folder with `<platform>/` folders, named as FMI 3.0 or 2.0 does, each with one library, such as `platforms.sh` makes; all are embedded, deflated as they lie there, if they do |

#[path = "src/library/header.rs"]
#[allow(dead_code, reason = "the command uses the rest")]
mod header;
mod pack;
#[path = "src/library/target.rs"]
#[allow(dead_code, reason = "the command uses the rest")]
mod target;
#[path = "src/library/universal.rs"]
mod universal;

use pack::deflated;
use std::env;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// The code of the page, deflated by `platforms.sh`, in the folder of libraries.
const PAGE: &str = "page.js.deflate";

/// A library to embed.
struct Library {
    platform: &'static target::Target,
    file: PathBuf,
    /// From the folder of libraries.
    ready: bool,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("cargo::error={error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let target = Target::from_environment()?;
    let mut libraries = match variable("URDF2FMU_LIBRARY_DIR") {
        Some(folder) => ready_libraries(Path::new(&folder))?,
        None => Vec::new(),
    };
    let own = match variable("URDF2FMU_LIBRARY").as_deref() {
        Some("none") => None,
        Some(file) => Some(existing(Path::new(file))?),
        None if libraries
            .iter()
            .any(|library| library.platform == target.platform) =>
        {
            None
        }
        None => Some(nested_build(&target)?),
    };
    if let Some(file) = own {
        libraries.retain(|library| library.platform != target.platform);
        libraries.push(Library {
            platform: target.platform,
            file,
            ready: false,
        });
    }
    libraries.sort_by_key(|library| target::TARGETS.iter().position(|t| t == library.platform));
    for library in libraries.iter().filter(|library| library.ready) {
        // For the tests of what `platforms.sh` makes.
        let platform = library.platform.platform.replace('-', "_").to_uppercase();
        let file = library.file.display();
        println!("cargo::rustc-env=URDF2FMU_READY_{platform}={file}");
        warn_if_old(&library.file)?;
    }
    if let Some(library) = libraries
        .iter()
        .find(|library| library.platform == target.platform)
    {
        // For the tests that drive the library through its C functions.
        println!(
            "cargo::rustc-env=URDF2FMU_HOST_LIBRARY={}",
            library.file.display()
        );
    }
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("libraries.rs"), source(&libraries, &out)?)?;
    println!("cargo::rerun-if-changed=page/dist/page.js");
    let folder = variable("URDF2FMU_LIBRARY_DIR").map(PathBuf::from);
    let packed = folder.as_ref().map(|folder| folder.join(PAGE));
    let page = deflated(Path::new("page/dist/page.js"), packed.as_deref())?;
    fs::write(out.join("page.deflate"), page)?;
    let macs = libraries.iter().filter(|l| l.platform.fmi2 == "darwin64");
    let macs: Vec<&Path> = macs.map(|library| &*library.file).collect();
    let both = pack::universal(&macs, folder.as_deref())?;
    fs::write(out.join("universal.deflate"), both)?;
    Ok(())
}

/// Where a library lies that `platforms.sh` has deflated.
fn beside(library: &Path) -> PathBuf {
    let mut name = library.as_os_str().to_owned();
    name.push(".deflate");
    name.into()
}

/// An environment variable on which the result depends; empty counts as unset.
fn variable(name: &str) -> Option<String> {
    println!("cargo::rerun-if-env-changed={name}");
    env::var(name).ok().filter(|value| !value.is_empty())
}

/// An absolute path to a file that is there.
fn existing(file: &Path) -> Result<PathBuf, Box<dyn Error>> {
    println!("cargo::rerun-if-changed={}", file.display());
    file.canonicalize()
        .map_err(|error| format!("library '{}': {error}", file.display()).into())
}

/// The one shared library in each `<platform>/` folder.
fn ready_libraries(folder: &Path) -> Result<Vec<Library>, Box<dyn Error>> {
    println!("cargo::rerun-if-changed={}", folder.display());
    let list = |folder: &Path| -> Result<Vec<PathBuf>, Box<dyn Error>> {
        let entries = fs::read_dir(folder)
            .map_err(|error| format!("folder of libraries '{}': {error}", folder.display()))?;
        Ok(entries
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<Result<_, _>>()?)
    };
    let mut libraries = Vec::new();
    for platform in list(folder)?.into_iter().filter(|path| path.is_dir()) {
        let mut files = list(&platform)?;
        files.retain(|file| {
            file.extension()
                .is_some_and(|end| ["so", "dll", "dylib"].iter().any(|known| end == *known))
        });
        let [file] = files.as_slice() else {
            let (folder, count) = (platform.display(), files.len());
            return Err(
                format!("'{folder}' holds {count} shared libraries; it must hold one").into(),
            );
        };
        let name = platform.file_name().unwrap_or_default();
        libraries.push(Library {
            platform: platform_of(&name.to_string_lossy(), file)?,
            file: existing(file)?,
            ready: true,
        });
        let platform = libraries.last().map(|library| library.platform);
        if libraries
            .iter()
            .filter(|library| Some(library.platform) == platform)
            .count()
            > 1
        {
            let name = platform.map_or("", |platform| platform.platform);
            return Err(format!("'{}' holds two libraries for {name}", folder.display()).into());
        }
    }
    Ok(libraries)
}

/// The system that a folder's library is for: the folder's name and the file must agree.
fn platform_of(name: &str, file: &Path) -> Result<&'static target::Target, Box<dyn Error>> {
    let names: Vec<&str> = target::TARGETS.iter().map(|t| t.platform).collect();
    if target::named(name).next().is_none() {
        let (file, names) = (file.display(), names.join(", "));
        return Err(format!("'{file}': '{name}' is no platform; names are {names}").into());
    }
    let found = header::platforms(&fs::read(file)?);
    let [one] = found.as_slice() else {
        let (file, count) = (file.display(), found.len());
        return Err(format!(
            "'{file}' holds libraries for {count} platforms; it must be one library for {name}"
        )
        .into());
    };
    target::named(name)
        .find(|target| target.platform == *one)
        .ok_or_else(|| format!("'{}' is for {one} and not for {name}", file.display()).into())
}

/// Tells that a ready library is older than the sources that lie here.
fn warn_if_old(library: &Path) -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("..");
    let mut folders = vec![workspace.join("src"), workspace.join("fmi/src")];
    let made = fs::metadata(library)?.modified()?;
    while let Some(folder) = folders.pop() {
        if !folder.is_dir() {
            continue;
        }
        println!("cargo::rerun-if-changed={}", folder.display());
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            if entry.file_type()?.is_dir() {
                folders.push(entry.path());
            } else if entry.metadata()?.modified()? > made {
                println!(
                    "cargo::warning=the ready library '{}' is older than '{}'; make it again, see docs/platforms.md",
                    library.display(),
                    entry.path().display()
                );
                return Ok(());
            }
        }
    }
    Ok(())
}

/// What the command is built for; its library is for the same.
struct Target {
    triple: String,
    platform: &'static target::Target,
    /// File of the library as cargo names it.
    file: String,
    /// What only the linker of this system understands.
    link_args: &'static [&'static str],
}

impl Target {
    fn from_environment() -> Result<Self, Box<dyn Error>> {
        let triple = env::var("TARGET")?;
        let system = env::var("CARGO_CFG_TARGET_OS")?;
        let processor = env::var("CARGO_CFG_TARGET_ARCH")?;
        let platform = target::of(&system, &processor).ok_or_else(|| {
            format!("FMI has no name for {system} on {processor}; URDF2FMU_LIBRARY=none builds a command without a library")
        })?;
        let prefix = if system == "windows" { "" } else { "lib" };
        let file = format!("{prefix}urdf2fmu_fmi.{}", platform.extension);
        // A host that defines a function of the same name must not get its own in our calls, and
        // must not see what the static parts of the library bring along.
        let gnu = env::var("CARGO_CFG_TARGET_ENV")? == "gnu";
        let link_args: &[&str] = match system.as_str() {
            // Without the time of day the same sources make the same library.
            "windows" if gnu => &["-Wl,--no-insert-timestamp"],
            "windows" | "macos" => &[],
            _ => &[
                "-Wl,-Bsymbolic",
                "-Wl,--exclude-libs,ALL",
                "-Wl,-z,relro,-z,now",
            ],
        };
        Ok(Self {
            triple,
            platform,
            file,
            link_args,
        })
    }
}

/// Runs cargo on `fmi/`.
fn nested_build(target: &Target) -> Result<PathBuf, Box<dyn Error>> {
    // What the other build script said is cached and goes stale when the workspace moves with its
    // target folder.
    let beside = Path::new(&env::var("CARGO_MANIFEST_DIR")?).with_file_name("fmi");
    let package = if beside.join("Cargo.toml").is_file() {
        beside
    } else {
        PathBuf::from(
            env::var("DEP_URDF2FMU_FMI_MANIFEST_DIR")
                .map_err(|_| "the build script of urdf2fmu-fmi has not said where it lies")?,
        )
    };
    let out = PathBuf::from(env::var("OUT_DIR")?);
    // Beside the folders of all build scripts (target/<profile>/build/<package>/out), not inside of
    // this one: the outer profiles `dev` and `test` have an OUT_DIR each and would build the same
    // library twice.
    let folder = out
        .ancestors()
        .nth(3)
        .unwrap_or(&out)
        .join("urdf2fmu-library");
    let mut cargo = Command::new(env::var("CARGO")?);
    let sources = Sources::find(&package, &out)?;
    isolate(&mut cargo, &sources.package);
    cargo
        .args(["rustc", "--lib", "--crate-type", "cdylib", "--release"])
        .args(&sources.options)
        .arg("--manifest-path")
        .arg(sources.package.join("Cargo.toml"))
        .args(["--target", &target.triple, "--target-dir"])
        .arg(&folder)
        .arg("--")
        .args(
            target
                .link_args
                .iter()
                .map(|arg| format!("-Clink-arg={arg}")),
        );
    let status = cargo
        .status()
        .map_err(|error| format!("cannot run cargo: {error}"))?;
    if !status.success() {
        return Err(format!(
            "building the FMU's library failed ({status}); cargo's messages are above. URDF2FMU_LIBRARY=<file> \
             embeds a ready library instead"
        )
        .into());
    }
    let built = folder.join(&target.triple).join("release");
    watch(&built.join(&target.file).with_extension("d"), &package)?;
    // A copy of its own, which stays as it is when another outer profile builds the library anew.
    let copy = out.join(&target.file);
    let made = built.join(&target.file);
    fs::copy(&made, &copy)
        .map_err(|error| format!("cargo has not made '{}': {error}", made.display()))?;
    Ok(copy)
}

/// Where `fmi/` is built from.
struct Sources {
    package: PathBuf,
    /// Further options for cargo.
    options: Vec<String>,
}

impl Sources {
    /// In its workspace the package is built as it lies there, with the workspace's lock file. From
    /// a registry it comes without either, and its folder must not be written to: a copy is built.
    /// All that it needs has been fetched with it (the command depends on it, too), so the network
    /// stays off; the core of the same version lies beside it, which matters as long as that
    /// version is not published.
    fn find(package: &Path, out: &Path) -> Result<Self, Box<dyn Error>> {
        let workspace = fs::read_to_string(package.join("../Cargo.toml")).unwrap_or_default();
        if workspace.contains("[workspace]") {
            return Ok(Self {
                package: package.to_owned(),
                options: Vec::new(),
            });
        }
        let copy = out.join("urdf2fmu-fmi");
        if copy.exists() {
            fs::remove_dir_all(&copy)?;
        }
        copy_folder(&package.join("src"), &copy.join("src"))?;
        fs::copy(package.join("build.rs"), copy.join("build.rs"))?;
        let manifest = fs::read_to_string(package.join("Cargo.toml"))?;
        fs::write(copy.join("Cargo.toml"), manifest + "\n[workspace]\n")?;
        let mut options = vec!["--offline".to_owned()];
        let core =
            package.with_file_name(format!("urdf2fmu-core-{}", env::var("CARGO_PKG_VERSION")?));
        if core.is_dir() {
            options.push("--config".to_owned());
            let path = core.to_str().ok_or("the path of the core is not Unicode")?;
            options.push(format!("patch.crates-io.urdf2fmu-core.path={path:?}"));
        }
        Ok(Self {
            package: copy,
            options,
        })
    }
}

fn copy_folder(from: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let place = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &place)?;
        } else {
            fs::copy(entry.path(), place)?;
        }
    }
    Ok(())
}

/// Takes away what the outer build has set and what would make another library of the same sources.
fn isolate(cargo: &mut Command, package: &Path) {
    const PREFIXES: [&str; 9] = [
        "CARGO_CFG_",
        "CARGO_FEATURE_",
        "CARGO_MANIFEST_",
        "CARGO_PKG_",
        "CARGO_PROFILE_",
        "CARGO_BUILD_",
        "CARGO_BIN_",
        "DEP_",
        "RUSTFLAGS",
    ];
    const NAMES: [&str; 11] = [
        "CARGO_TARGET_DIR",
        "CARGO_ENCODED_RUSTFLAGS",
        "RUSTC_WORKSPACE_WRAPPER",
        "OUT_DIR",
        "TARGET",
        "HOST",
        "PROFILE",
        "OPT_LEVEL",
        "DEBUG",
        "NUM_JOBS",
        "CARGO_PRIMARY_PACKAGE",
    ];
    for (name, _) in env::vars_os() {
        let text = name.to_string_lossy();
        let target_flags = text.starts_with("CARGO_TARGET_") && text.ends_with("_RUSTFLAGS");
        if target_flags
            || NAMES.contains(&&*text)
            || PREFIXES.iter().any(|prefix| text.starts_with(prefix))
        {
            cargo.env_remove(&name);
        }
    }
    // Set, so that flags of a configuration file, such as `target-cpu=native`, do not count either.
    // Messages of panics name sources; without the folders of this machine the same sources make
    // the same library anywhere.
    let mut flags = Vec::new();
    if let Some(workspace) = package.parent() {
        flags.push(format!(
            "--remap-path-prefix={}=urdf2fmu",
            workspace.display()
        ));
    }
    let home = env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(env::home_dir()?.join(".cargo")));
    if let Some(home) = home {
        flags.push(format!("--remap-path-prefix={}=cargo", home.display()));
    }
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    // The workspace's release profile, for the case that the package lies outside of its workspace.
    for (name, value) in [
        ("OPT_LEVEL", "3"),
        ("LTO", "fat"),
        ("CODEGEN_UNITS", "1"),
        ("STRIP", "true"),
        ("PANIC", "unwind"),
        ("DEBUG", "false"),
        ("DEBUG_ASSERTIONS", "false"),
        ("OVERFLOW_CHECKS", "false"),
        ("INCREMENTAL", "false"),
    ] {
        cargo.env(format!("CARGO_PROFILE_RELEASE_{name}"), value);
    }
}

/// Makes cargo run this script again when a source of the library changes; `list` is cargo's list
/// of them.
fn watch(list: &Path, package: &Path) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(list)
        .map_err(|error| format!("cargo's list of sources '{}': {error}", list.display()))?;
    // `library: source source …`, blanks in names escaped by a backslash.
    let sources = text
        .split_once(": ")
        .map_or("", |(_, sources)| sources)
        .trim();
    for source in sources.replace("\\ ", "\0").split(' ') {
        println!("cargo::rerun-if-changed={}", source.replace('\0', " "));
    }
    let workspace = package.join("..");
    for file in [
        package.join("Cargo.toml"),
        workspace.join("Cargo.toml"),
        workspace.join("Cargo.lock"),
    ] {
        if file.is_file() {
            println!("cargo::rerun-if-changed={}", file.display());
        }
    }
    Ok(())
}

/// The list of libraries as Rust code; deflated, they lie in `out`.
fn source(libraries: &[Library], out: &Path) -> Result<String, Box<dyn Error>> {
    let mut code = String::from("&[\n");
    for Library { platform, file, .. } in libraries {
        let target::Target {
            platform,
            extension,
            ..
        } = platform;
        let packed = out.join(format!("{platform}.deflate"));
        fs::write(&packed, deflated(file, Some(&beside(file)))?)?;
        let path = packed
            .to_str()
            .ok_or("the path of a library is not Unicode")?;
        writeln!(
            code,
            "    Library {{ platform: {platform:?}, extension: {extension:?}, deflated: include_bytes!({path:?}) }},"
        )?;
    }
    code.push_str("]\n");
    Ok(code)
}
