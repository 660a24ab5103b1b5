//! Names and globs by which settings and files name links and joints.

use crate::diagnostic::Place;

/// A name or glob (`*`: any characters, `?`: one) and where it was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// As given.
    pub text: String,
    /// Where; none for one that came from the command line.
    pub place: Option<Place>,
}

impl From<&str> for Pattern {
    fn from(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            place: None,
        }
    }
}

impl Pattern {
    /// Whether it is more than a plain name.
    pub fn is_glob(&self) -> bool {
        self.text.contains(['*', '?'])
    }

    /// What helps where it matches nothing: what it has of other patterns, else `nearest`, which
    /// names what is most like it.
    pub fn help(&self, nearest: Option<String>) -> String {
        if self.text.contains(['[', ']', '{', '}']) {
            "patterns have * for any characters and ? for one, and no brackets: give a list".into()
        } else {
            nearest.unwrap_or_default()
        }
    }

    /// Whether it means `name`.
    pub fn matches(&self, name: &str) -> bool {
        self.text == name || wildmatch::WildMatch::new(&self.text).matches(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globs_match_any_characters_and_one() {
        let matches = |pattern: &str, name: &str| Pattern::from(pattern).matches(name);
        assert!(matches("*_wheel_joint", "left_wheel_joint"));
        assert!(matches("leg?", "leg1") && !matches("leg?", "leg10"));
        assert!(!matches("wheel", "left_wheel"));
        assert!(matches("*", ""));
        assert!(Pattern::from("a*").is_glob() && !Pattern::from("a").is_glob());
    }
}
