//! What an FMU is called: its `modelIdentifier`, a C identifier that is a file name on every
//! system, and its guid.

use crate::archive::is_device;
use crate::library::Binary;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use urdf2fmu_core::model::Model;
use urdf2fmu_core::prepared::{PreparedModel, PreparedModelError};
use urdf2fmu_core::settings::FmiVersion;
use urdf2fmu_core::variables::Variable;

/// Longest identifier; paths inside an unpacked FMU stay short enough for Windows.
const MAX_LENGTH: usize = 64;

/// Words that C or C++ keeps for itself.
const KEYWORDS: &str = "alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl \
    concept const const_cast consteval constexpr constinit continue co_await co_return co_yield decltype default \
    delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long \
    main mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register \
    reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch \
    template this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile \
    wchar_t while xor xor_eq";

/// An identifier made of the robot's name, or of the file's where that holds no letter or digit.
pub fn model_identifier(robot: &str, file_stem: &str) -> String {
    [robot, file_stem]
        .into_iter()
        .find_map(identifier)
        .unwrap_or_else(|| "robot".to_owned())
}

fn identifier(name: &str) -> Option<String> {
    let mut text: String = name
        .trim()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if !text.contains(|c: char| c.is_ascii_alphanumeric()) {
        return None;
    }
    // Leading underscores are the compiler's.
    if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        text = format!("robot_{}", text.trim_start_matches('_'));
    }
    text.truncate(MAX_LENGTH);
    if KEYWORDS.split_whitespace().any(|word| word == text) || is_device(&text) {
        text.push_str("_robot");
    }
    Some(text)
}

/// Identifies what the FMU is: version of FMI, model, table and library. Written as FMI 2 likes it,
/// a UUID (version 8) in braces.
///
/// # Errors
/// [`PreparedModelError`] if the model cannot be written.
pub fn guid(
    fmi: FmiVersion,
    model_identifier: &str,
    model: &Model,
    table: &[Variable],
    libraries: &[Binary],
) -> Result<String, PreparedModelError> {
    let mut hash = Sha256::new();
    // Lengths keep neighbouring parts apart.
    let mut part = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    part(model_identifier.as_bytes());
    if fmi == FmiVersion::V3 {
        part(b"FMI 3.0");
    }
    // The guid stands in the prepared model, so an empty one is hashed.
    part(
        PreparedModel::new(String::new(), model.clone())
            .to_json()?
            .as_bytes(),
    );
    for v in table {
        part(format!("{v:?}").as_bytes());
    }
    for library in libraries {
        part(library.folder.as_bytes());
        part(&library.file);
    }
    let mut bytes = [0_u8; 16];
    bytes.copy_from_slice(&hash.finalize()[..16]);
    bytes[6] = (bytes[6] & 0x0f) | 0x80;
    bytes[8] = (bytes[8] & 0x3f) | 0x80;
    let mut text = String::from("{");
    for (i, byte) in bytes.iter().enumerate() {
        if [4, 6, 8, 10].contains(&i) {
            text.push('-');
        }
        _ = write!(text, "{byte:02x}");
    }
    text.push('}');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_names_are_not_changed() {
        assert_eq!(model_identifier("r2d2", "x"), "r2d2");
        assert_eq!(model_identifier("kuka_iiwa", "x"), "kuka_iiwa");
    }

    #[test]
    fn every_name_becomes_a_c_identifier() {
        for (name, expected) in [
            ("my robot-1.2", "my_robot_1_2"),
            ("3dof", "robot_3dof"),
            ("__x", "robot_x"),
            ("while", "while_robot"),
            ("con", "con_robot"),
            ("Ärm", "robot_rm"),
            ("", "file"),
            ("***", "file"),
        ] {
            assert_eq!(model_identifier(name, "file"), expected, "{name:?}");
        }
        assert_eq!(model_identifier("日本", "機"), "robot");
        assert_eq!(model_identifier(&"a".repeat(500), "x").len(), MAX_LENGTH);
    }
}
