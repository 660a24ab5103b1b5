//! Kinds of files that are neither a robot nor an FMU.

use std::path::Path;

/// What a file is that is neither a robot nor an FMU, with what to do about it, if its name or its
/// first bytes say so.
pub fn other_kind(path: &Path) -> Option<&'static str> {
    use std::io::Read as _;
    const SRDF: &str = "an SRDF: give the URDF, and this one with --srdf";
    if !path.is_file() {
        return None;
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
