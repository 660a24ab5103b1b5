//! What stops the expansion of a file in xacro.

use std::path::PathBuf;

/// What stopped it.
#[derive(Debug)]
pub struct Problem {
    pub message: String,
    /// Of the element.
    pub file: PathBuf,
    /// Where its tag starts there, bytes.
    pub at: usize,
    /// What kind of thing is missing, where the advice depends on it.
    pub lacking: Option<Lacking>,
}

/// What a document needs and does not have.
#[derive(Debug)]
pub enum Lacking {
    /// The value of an argument.
    Argument,
    /// A file.
    File,
    /// A package, by its name.
    Package(String),
}

/// A result of the expansion.
pub type Done<T> = Result<T, Problem>;
