//! What is taken as done in an expansion that looks at what comes next, see `foreseen`.

use super::macros::Macro;
use super::symbols::Entry;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

/// What is taken as done.
#[derive(Default)]
pub(super) struct Proposed {
    pub arguments: BTreeMap<String, String>,
    pub macros: BTreeMap<String, Rc<Macro>>,
    pub properties: BTreeMap<String, Entry>,
    /// Files that define what is missing, included before all else.
    pub files: Vec<PathBuf>,
    /// Paths at which there is no file, and those that are meant.
    pub meant: BTreeMap<PathBuf, PathBuf>,
}

impl Proposed {
    /// How much it is.
    pub fn count(&self) -> usize {
        self.arguments.len()
            + self.macros.len()
            + self.properties.len()
            + self.files.len()
            + self.meant.len()
    }
}

/// Arguments by their names.
pub(super) fn pairs(arguments: &[String]) -> BTreeMap<String, String> {
    let pairs = arguments
        .iter()
        .filter_map(|argument| argument.split_once(":="));
    let pairs = pairs.map(|(name, value)| (name.trim().to_owned(), value.trim().to_owned()));
    pairs.collect()
}
