//! The libraries that `build/platforms.sh --all` adds: 64-bit ARM Linux, and both Macs.

use super::mach::{Mach, SIGNED_PAGE};
use super::{
    Fmu, assert_all_of_fmi, assert_glibc_2_17_and_nothing_else, assert_same_bits, compile_trace,
    example, folder, made, output, skipped, wine,
};
use std::collections::BTreeSet;
use std::fs;
use std::io::Read as _;
use std::path::Path;
use std::process::Command;

#[test]
fn the_library_for_linux_on_arm_needs_glibc_2_17_and_nothing_else() {
    if made("aarch64-linux").is_none() {
        return;
    }
    let fmu = Fmu::of(&example("rover.urdf"), &["--platform", "aarch64-linux"]);
    if let Some(library) = fmu.library("aarch64-linux") {
        assert_glibc_2_17_and_nothing_else(&library, "ld-linux-aarch64.so.1");
    }
}

#[test]
fn linux_on_arm_calculates_the_same_bits() {
    const COMPILER: &str = "aarch64-linux-gnu-gcc";
    const EMULATOR: &str = "qemu-aarch64";
    if made("aarch64-linux").is_none() {
        return;
    }
    for (program, package) in [
        (COMPILER, "gcc-aarch64-linux-gnu libc6-dev-arm64-cross"),
        (EMULATOR, "qemu-user"),
    ] {
        if Command::new(program).arg("--version").output().is_err() {
            return skipped(&format!(
                "there is no {program}; on Debian: apt-get install {package}"
            ));
        }
    }
    let folder = folder("platforms-arm");
    fs::create_dir_all(&folder).unwrap();
    let program = folder.join("trace-arm");
    compile_trace(COMPILER, &program);
    assert_same_bits(&folder, "aarch64-linux", |arguments| {
        let mut command = Command::new(EMULATOR);
        let ended = command
            .args(["-L", "/usr/aarch64-linux-gnu"])
            .arg(&program)
            .args(arguments)
            .output()
            .unwrap();
        wine::Ended {
            success: ended.status.success(),
            said: String::from_utf8(ended.stdout).unwrap(),
            complained: String::from_utf8(ended.stderr).unwrap(),
        }
    });
}

/// One file for both Macs, of which each part must be loadable by itself.
#[test]
fn the_libraries_for_macs_need_macos_11_and_nothing_else() {
    let Some((intel, arm)) = made("x86_64-darwin").zip(made("aarch64-darwin")) else {
        return;
    };
    let fmu = Fmu::of(&example("rover.urdf"), &["--platform", "darwin64"]);
    let Some(library) = fmu.library("aarch64-darwin") else {
        return;
    };
    let file = fs::read(&library).unwrap();
    let parts = Mach::parts(&file);
    let processors: Vec<&str> = parts.iter().map(|(processor, _)| *processor).collect();
    assert_eq!(processors, ["x86_64", "arm64"]);
    for (processor, part) in parts {
        let mach = Mach::read(part);
        assert_eq!(mach.minimum, Some((11, 0)), "{processor}");
        assert_eq!(mach.name, "@rpath/liburdf2fmu_fmi.dylib");
        assert_eq!(mach.needed, ["/usr/lib/libSystem.B.dylib"]);
        assert!(mach.search_paths.is_empty(), "{:?}", mach.search_paths);
        let (fmi, others): (Vec<&str>, Vec<&str>) = mach
            .defined
            .iter()
            .map(|name| name.trim_start_matches('_'))
            .partition(|name| name.starts_with("fmi"));
        assert_all_of_fmi(fmi.into_iter());
        // A library's names are its own on this system, so what the linker adds disturbs nobody:
        // these two and symbols of Rust's standard library, mangled (RFC 2603) or not.
        for name in others {
            let of_linker = ["mh_dylib_header", "dso_handle"].contains(&name);
            assert!(
                of_linker || name.contains("rust") || name.starts_with("RN"),
                "{name}"
            );
        }
        for name in super::OF_MATH_H {
            let name = format!("_{name}");
            assert!(!mach.undefined.contains(&name), "{name} is imported");
        }
        // Apple's own processors load nothing without a signature, be it of nobody; Intel's do.
        match mach.signature {
            Some(signature) => {
                assert!(signature.of_nobody, "{processor}");
                assert!(signature.pages > part.len() / SIGNED_PAGE / 2);
                assert_eq!(signature.damaged_pages, 0, "{processor}");
            }
            None => assert_eq!(processor, "x86_64"),
        }
    }
    // An independent program makes the same file.
    let tools = [
        "llvm-lipo",
        "llvm-lipo-19",
        "/usr/lib/llvm-19/bin/llvm-lipo",
        "llvm-lipo-14",
    ];
    let lipo = tools
        .into_iter()
        .find(|t| Command::new(t).arg("--version").output().is_ok());
    let Some(lipo) = lipo else {
        return skipped("there is no llvm-lipo; on Debian: apt-get install llvm");
    };
    let other = fmu.folder.join("other.dylib");
    let mut command = Command::new(lipo);
    let command = command.arg("-create").args([intel, arm]);
    output(command.arg("-output").arg(&other));
    assert!(fs::read(other).unwrap() == file, "as lipo makes it");
}

/// Libraries lie in an FMU as `platforms.sh` has deflated them, also the universal one of two.
fn copied(fmu: &Path, fmi: &str) {
    let mut zip = zip::ZipArchive::new(fs::File::open(fmu).unwrap()).unwrap();
    for (platform, of_fmi_2) in [
        ("x86_64-linux", Some("linux64")),
        ("x86_64-windows", Some("win64")),
        ("aarch64-linux", None),
        ("x86_64-darwin", None),
        ("aarch64-darwin", None),
    ] {
        let Some(folder) = (if fmi == "2" { of_fmi_2 } else { Some(platform) }) else {
            continue;
        };
        let library = made(platform).unwrap();
        let packed = fs::metadata(format!("{library}.deflate")).unwrap().len();
        let ending = Path::new(library).extension().unwrap().to_str().unwrap();
        let name = format!("binaries/{folder}/rover.{ending}");
        let mut entry = zip.by_name(&name).unwrap();
        assert_eq!(entry.compressed_size(), packed, "{name}");
        // The reader checks its sum.
        let mut file = Vec::new();
        entry.read_to_end(&mut file).unwrap();
        assert!(file == fs::read(library).unwrap(), "{name}");
    }
    if fmi == "2" {
        let library = Path::new(made("x86_64-darwin").unwrap());
        let folder = library.ancestors().nth(2).unwrap();
        let packed = fs::metadata(folder.join("universal.dylib.deflate")).unwrap();
        let entry = zip.by_name("binaries/darwin64/rover.dylib").unwrap();
        assert_eq!(entry.compressed_size(), packed.len(), "the universal file");
    }
}

#[test]
fn an_fmu_for_all_platforms_is_small() {
    if made("aarch64-darwin").is_none() {
        return;
    }
    // docs/platforms.md says what of it is what; pictures and documents take 0.4 MB. FMI 3 has a
    // folder for 64-bit ARM Linux beside that for x86-64.
    let folder = folder("platforms-size");
    fs::create_dir_all(&folder).unwrap();
    let of_fmi_2 = ["darwin64", "linux64", "win64"];
    let of_fmi_3 = [
        "aarch64-darwin",
        "aarch64-linux",
        "x86_64-darwin",
        "x86_64-linux",
        "x86_64-windows",
    ];
    for (fmi, most, platforms) in [("2", 3_300_000, &of_fmi_2[..]), ("3", 4_000_000, &of_fmi_3)] {
        let fmu = folder.join(format!("rover{fmi}.fmu"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_urdf2fmu"));
        let command = command.arg("export").arg(example("rover.urdf"));
        output(command.args(["--fmi", fmi, "-o"]).arg(&fmu));
        let size = fs::metadata(&fmu).unwrap().len();
        assert!(size <= most, "FMI {fmi}: {size} bytes");
        let zip = zip::ZipArchive::new(fs::File::open(&fmu).unwrap()).unwrap();
        copied(&fmu, fmi);
        let names: Vec<_> = zip.file_names().map(|name| name.unwrap()).collect();
        let inside = names.iter().filter_map(|name| {
            let (folder, file) = name.strip_prefix("binaries/")?.split_once('/')?;
            (!file.is_empty()).then_some(folder)
        });
        let inside: BTreeSet<&str> = inside.collect();
        assert!(
            inside.into_iter().eq(platforms.iter().copied()),
            "FMI {fmi}"
        );
    }
}
