//! Every key of the settings file: type and range, default, purpose.
//!
//! A path names tables by dots; `*` stands for a name that the user chooses (a glob over joints or
//! links), `[]` for the elements of an array of tables.

mod joints;
mod parts;
mod whole;
mod world;

use crate::range::Range;

/// One key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Where it stands, such as `solver.tolerance` or `actuator[].joint`.
    pub path: &'static str,
    /// What may be given.
    pub takes: Takes,
    /// What holds where it is not given, in TOML; none where something else decides (see `about`).
    pub default: Option<&'static str>,
    /// What it is for, with its unit.
    pub about: &'static str,
}

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    /// A finite number of a range.
    Number(Range),
    /// The same, or a text like `"1/240"`.
    NumberOrRatio(Range),
    /// `true` or `false`.
    Flag,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A name or glob.
    Pattern,
    /// A name of the user's own.
    Name,
    /// A file; a relative one counts from the folder of the settings.
    File,
    /// A whole number from 1 on, with its greatest.
    Count(u32),
    /// One of some whole numbers.
    Version(&'static [u32]),
    /// A list of names or globs.
    Patterns,
    /// A name or glob, or a list of them.
    PatternOrPatterns,
    /// One of some words, or a list of names or globs.
    WordOrPatterns(&'static [&'static str]),
    /// A list of numbers of a range, with its least and greatest length.
    Numbers(usize, usize, Range),
    /// So many lists of three numbers of a range.
    Vectors(usize, Range),
}

impl Takes {
    /// The range of each number.
    pub fn range(self) -> Option<Range> {
        match self {
            Self::Number(range)
            | Self::NumberOrRatio(range)
            | Self::Numbers(_, _, range)
            | Self::Vectors(_, range) => Some(range),
            _ => None,
        }
    }
}

const fn key(
    path: &'static str,
    takes: Takes,
    default: Option<&'static str>,
    about: &'static str,
) -> Key {
    Key {
        path,
        takes,
        default,
        about,
    }
}

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
