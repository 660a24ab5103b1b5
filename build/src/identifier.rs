//! The FMU's `modelIdentifier`: a C identifier that is a file name on every system.

use crate::archive::is_device;

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
