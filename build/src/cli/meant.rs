//! What is said of a wrong command line in place of what the parser of options guesses.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;

/// The same error with advice that leads to a command line that is taken.
pub(crate) fn instead(mut answer: clap::Error) -> clap::Error {
    let text = |kind| match answer.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let tip = match answer.kind() {
        ErrorKind::InvalidSubcommand => text(ContextKind::InvalidSubcommand)
            .filter(|name| Path::new(name).is_file())
            .map(|file| format!("a command comes first, such as urdf2fmu check {file}")),
        ErrorKind::WrongNumberOfValues => text(ContextKind::InvalidArg)
            .filter(|option| option.starts_with("--start-value"))
            .map(|_| "the name and the value are two words: --start-value NAME VALUE".to_owned()),
        _ => None,
    };
    if answer.kind() == ErrorKind::UnknownArgument {
        // It offers to pass the option as a value, which no command takes.
        answer.remove(ContextKind::Suggested);
    }
    if let Some(tip) = tip {
        let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
        answer.insert(ContextKind::Suggested, tips);
    }
    answer
}
