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

    /// What to say where it matches nothing and has signs of other patterns.
    pub fn advice(&self) -> Option<&'static str> {
        let foreign = self.text.contains(['[', ']', '{', '}']);
        foreign.then_some(
            "patterns have * for any characters and ? for one, and no brackets: give a list",
        )
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
