//! What stands against the expansion of a file in xacro.

use super::tree::Element;
use std::path::PathBuf;
use urdf2fmu_core::diagnostic::nearest;

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
    /// What may have been meant.
    pub meant: Option<Meant>,
    pub weight: Weight,
}

/// What may have been meant.
#[derive(Clone, Debug, PartialEq)]
pub enum Meant {
    /// A name that is near.
    Name(Box<str>),
    /// What to do.
    Advice(Box<str>),
}

impl Meant {
    /// What to do.
    pub fn advice(text: String) -> Self {
        Self::Advice(text.into())
    }
}

impl std::fmt::Display for Meant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Name(name) => write!(f, "did you mean '{name}'?"),
            Self::Advice(advice) => f.write_str(advice),
        }
    }
}

/// What a document needs and does not have.
#[derive(Debug, PartialEq)]
pub enum Lacking {
    /// The value of an argument, by its name.
    Argument(String),
    /// A file, by its path.
    File(PathBuf),
    /// A package, by its name.
    Package(String),
    /// A property.
    Property(String),
    /// A macro.
    Macro(String),
    /// A parameter of a macro that uses it and does not list it, by the names of both.
    Parameter(String),
    /// A variable of the environment, by its name.
    Variable(String),
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
    /// The expansion goes on. It is told as what may follow from another one that was told.
    May,
    /// It is told, and the expansion ends: there would be no end, or no end of memory.
    Ends,
    /// The expansion ends, because enough was told.
    Enough,
}

impl Problem {
    /// With the name of `known` that is nearest to `word`, if one is near.
    pub fn meant<'k>(self, word: &str, known: impl IntoIterator<Item = &'k str>) -> Self {
        let meant = nearest(word, known).map(|near| Meant::Name(near.into()));
        let meant = self.meant.clone().or(meant);
        Self { meant, ..self }
    }

    /// With what may be meant, where nothing is known of it yet.
    pub fn or_meant(self, meant: impl FnOnce() -> Option<String>) -> Self {
        let meant = self.meant.clone().or_else(|| meant().map(Meant::advice));
        Self { meant, ..self }
    }

    /// With the attribute of an element that may be meant to be `name`.
    pub fn misspelt(self, name: &str, element: &Element) -> Self {
        let own = element.attributes.iter().map(|(own, _)| own.as_str());
        let near = nearest(name, own.filter(|own| *own != "name"));
        let meant = near.map(|near| format!("did you mean '{name}' by '{near}'?"));
        let meant = meant.map(Meant::advice);
        Self { meant, ..self }
    }

    /// As what follows, if it is of an element of whose tag it was told that it is no XML.
    pub fn after_that_of(self, element: &Element) -> Self {
        let own = self.weight == Weight::Own && self.at == element.at;
        let weight = if element.faulty && own {
            Weight::Follows
        } else {
            self.weight
        };
        Self { weight, ..self }
    }

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
                Some(Lacking::File(_)) => self.message == other.message,
                Some(_) => true,
            }
    }
}

/// A result of the expansion.
pub type Done<T> = Result<T, Problem>;
