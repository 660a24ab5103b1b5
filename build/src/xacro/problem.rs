//! What stands against the expansion of a file in xacro.

use std::path::PathBuf;

/// One thing that is wrong.
#[derive(Debug)]
pub struct Problem {
    pub message: String,
    /// Of the element.
    pub file: PathBuf,
    /// Where its tag starts there, bytes.
    pub at: usize,
    /// What kind of thing is missing, where the advice depends on it.
    pub lacking: Option<Lacking>,
    pub weight: Weight,
}

/// What a document needs and does not have.
#[derive(Debug, PartialEq)]
pub enum Lacking {
    /// The value of an argument, by its name.
    Argument(String),
    /// A file.
    File,
    /// A package, by its name.
    Package(String),
    /// A property.
    Property(String),
    /// A macro.
    Macro(String),
    /// A tag that begins or ends an element.
    Tag,
}

/// What becomes of the expansion after a problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// It is told, and the expansion goes on without what cannot be expanded.
    Own,
    /// The expansion goes on. It is not told, because it follows from one that was.
    Follows,
    /// It is told, and the expansion ends: there would be no end, or no end of memory.
    Ends,
    /// The expansion ends, because enough was told.
    Enough,
}

impl Problem {
    /// Without an end, or too large.
    pub fn that_ends(self) -> Self {
        let weight = Weight::Ends;
        Self { weight, ..self }
    }

    /// Whether it is the same thing to mend.
    pub fn is_as(&self, other: &Self) -> bool {
        let here = self.at == other.at && self.file == other.file;
        self.lacking == other.lacking
            && match self.lacking {
                None | Some(Lacking::Tag) => here && self.message == other.message,
                Some(Lacking::File) => self.message == other.message,
                Some(_) => true,
            }
    }
}

/// A result of the expansion.
pub type Done<T> = Result<T, Problem>;
