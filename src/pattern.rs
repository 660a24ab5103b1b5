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

/// Entries in the order in which they count, the last one most: globs before plain names, and each
/// as given. A file's tables have no order of their own that could decide between the two.
pub fn names_last<T>(entries: &[T], pattern: impl Fn(&T) -> &Pattern) -> impl Iterator<Item = &T> {
    let (globs, names): (Vec<&T>, Vec<&T>) =
        entries.iter().partition(|entry| pattern(entry).is_glob());
    globs.into_iter().chain(names)
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

    #[test]
    fn plain_names_come_after_globs_and_each_in_its_order() {
        let given = ["w1", "w*", "w0", "*"].map(Pattern::from);
        let order: Vec<&str> = names_last(&given, |pattern| pattern)
            .map(|pattern| pattern.text.as_str())
            .collect();
        assert_eq!(order, ["w*", "*", "w1", "w0"]);
    }
}
