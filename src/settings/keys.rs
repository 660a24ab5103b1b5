//! Every key of the settings file: type and range, default, purpose.
//!
//! A path names tables by dots; `*` stands for a name that the user chooses (a glob over joints or
//! links), `[]` for the elements of an array of tables.

mod joints;
mod kinds;
mod parts;
mod whole;
mod world;

pub use kinds::{Key, Takes};

/// Keys of a sensor that say how well it measures, and the types that have them.
pub(super) const QUANTITIES: [(&str, &str); 5] = [
    ("imu", "angular_velocity"),
    ("imu", "linear_acceleration"),
    ("ft", "force"),
    ("ft", "torque"),
    ("ray", "distance"),
];

/// The parts of the table, in the order of a file.
const PARTS: [&[Key]; 4] = [whole::KEYS, world::KEYS, joints::KEYS, parts::KEYS];

const COUNT: usize = PARTS[0].len() + PARTS[1].len() + PARTS[2].len() + PARTS[3].len();

/// The table.
pub const KEYS: &[Key] = &joined();

const fn joined() -> [Key; COUNT] {
    let mut all = [PARTS[0][0]; COUNT];
    let (mut part, mut place, mut filled) = (0, 0, 0);
    while filled < COUNT {
        if place == PARTS[part].len() {
            (part, place) = (part + 1, 0);
        } else {
            all[filled] = PARTS[part][place];
            (place, filled) = (place + 1, filled + 1);
        }
    }
    all
}

/// The key at `path`.
pub fn find(path: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.path == path)
}

/// The names that may stand in the table at `path` (`""` is the file itself), each once, in file
/// order; `*` where the user chooses the names.
pub fn children(path: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for key in KEYS {
        let rest = if path.is_empty() {
            Some(key.path)
        } else {
            key.path
                .strip_prefix(path)
                .and_then(|rest| rest.strip_prefix('.'))
        };
        let Some(rest) = rest else { continue };
        let name = rest.split(['.', '[']).next().unwrap_or(rest);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
