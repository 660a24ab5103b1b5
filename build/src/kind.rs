//! Kinds of files that are neither a robot nor an FMU.

use std::path::Path;

/// What an FMU has at its top.
const DESCRIPTION: &str = "modelDescription.xml";

/// Whether a zip has at its top what an FMU has.
fn holds_fmu(path: &Path) -> bool {
    let zip = std::fs::File::open(path).map(zip::ZipArchive::new);
    zip.is_ok_and(|zip| zip.is_ok_and(|zip| zip.index_for_name(DESCRIPTION).is_some()))
}

/// What a file is that cannot be an object of the world.
pub fn no_object(path: &Path) -> Option<&'static str> {
    let ending = path.extension();
    let fmu = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("fmu")) && path.is_file();
    let fmu = fmu.then_some("an FMU: give the URDF that it was made from");
    other_kind(path).or(fmu)
}

/// What a file is that is neither a robot nor an FMU, with what to do about it, if its name or its
/// first bytes say so.
pub fn other_kind(path: &Path) -> Option<&'static str> {
    use std::io::Read as _;
    const SRDF: &str = "an SRDF: give the URDF, and this one with --srdf";
    if path.is_dir() && path.join(DESCRIPTION).is_file() {
        return Some(
            "an FMU that was unpacked: give the .fmu itself, or a zip of what is in this folder \
             with that ending",
        );
    }
    if !path.is_file() {
        return None;
    }
    if path.file_name().is_some_and(|name| name == DESCRIPTION) {
        return Some("a part of an FMU that was unpacked: give the .fmu itself");
    }
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(512).read_to_end(&mut bytes));
    if read.is_err() {
        return None;
    }
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    let ending = ending.unwrap_or_default();
    let stem = path.file_stem().map(Path::new);
    let whole = stem.and_then(Path::extension);
    let zip = bytes.starts_with(b"PK\x03\x04");
    Some(match ending.as_str() {
        "fmu" if zip || bytes.is_empty() => return None,
        "fmu" => "no FMU: an FMU is a zip archive, and this is none",
        _ if zip && holds_fmu(path) => "a zip archive that holds an FMU: end its name with .fmu",
        _ if zip => {
            "a zip archive: an FMU has the ending .fmu, other archives are to be unpacked first"
        }
        _ if bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xff\xd8\xff") => "a picture",
        "stl" | "obj" | "dae" | "ply" | "gltf" | "glb" => "a mesh: give the URDF that uses it",
        "toml" => "a settings file: give the URDF, and this one with -c",
        "csv" => "a table: give the robot or the FMU, and this one with --input-file or --run",
        "srdf" => SRDF,
        "xacro" if whole.is_some_and(|whole| whole.eq_ignore_ascii_case("srdf")) => SRDF,
        "yaml" | "yml" => "a YAML file: give the URDF or the .xacro file",
        "py" => "a Python program",
        _ if bytes.starts_with(b"\x7fELF") || bytes.starts_with(b"MZ") => "a program",
        _ if bytes.starts_with(urdf2fmu_core::urdf::LFS_POINTER) => {
            "a pointer of Git LFS, not the file itself: git lfs pull fetches it"
        }
        _ => return None,
    })
}
