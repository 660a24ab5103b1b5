//! What a key is, and what it takes.

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

/// An entry of the table.
pub(super) const fn key(
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
