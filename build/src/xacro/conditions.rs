//! Links that a file in xacro writes under a condition: where one of them is missing, the condition
//! may be what left it out.
//!
//! Names are compared as they are written, with anything in the place of an expression: what a
//! condition leaves out is not expanded.

use super::definitions::attribute;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Place;

/// A link under a condition.
struct Link<'t> {
    /// Where its tag starts, bytes.
    at: usize,
    /// As it is written.
    name: String,
    /// The tag of the condition next to it.
    condition: &'t str,
}

/// Where the link is written of which a message says that it does not exist, and under which
/// condition, as advice.
pub(super) fn left_out(texts: &BTreeMap<PathBuf, Rc<str>>, message: &str) -> Option<String> {
    let (_, rest) = message.split_once(" link '")?;
    let (name, _) = rest.split_once("' does not exist")?;
    let mut best: Option<(usize, String)> = None;
    for (file, text) in texts {
        for link in links(text) {
            let Some(letters) = fits(&link.name, name) else {
                continue;
            };
            if best.as_ref().is_some_and(|(most, _)| *most >= letters) {
                continue;
            }
            let shown = file.display().to_string();
            let line = Place::in_text(&shown, text, link.at..link.at + 1).line;
            let advice = format!(
                "{shown}:{line} writes <link name=\"{}\"> under {}, which may have left it out: set \
                 what the condition asks for, with NAME:=VALUE if it is an argument",
                link.name, link.condition
            );
            best = Some((letters, advice));
        }
    }
    best.map(|(_, advice)| advice)
}

/// The links of a text that stand under a condition.
fn links(text: &str) -> Vec<Link<'_>> {
    let mut found = Vec::new();
    let mut conditions: Vec<&str> = Vec::new();
    let mut from = 0;
    while let Some(next) = text[from..].find('<') {
        let at = from + next;
        let rest = &text[at..];
        let length = match rest.strip_prefix("<!--") {
            Some(comment) => comment.find("-->").map_or(rest.len(), |end| end + 7),
            None => tag_length(rest),
        };
        let tag = &rest[..length];
        let is = |word: &str| {
            let behind = tag.strip_prefix(word);
            behind.is_some_and(|b| b.starts_with(|c: char| c.is_whitespace() || c == '>'))
        };
        if (is("<xacro:if") || is("<xacro:unless")) && !tag.ends_with("/>") {
            conditions.push(tag);
        } else if is("</xacro:if") || is("</xacro:unless") {
            conditions.pop();
        } else if is("<link")
            && let Some(condition) = conditions.last()
            && let Some(name) = attribute(&tag["<link".len()..], "name")
        {
            found.push(Link {
                at,
                name,
                condition,
            });
        }
        from = at + length;
    }
    found
}

/// Bytes of a tag with its end; a `>` within quotes is none.
fn tag_length(text: &str) -> usize {
    let mut quote = None;
    for (at, sign) in text.char_indices() {
        match quote {
            Some(open) if sign == open => quote = None,
            Some(_) => {}
            None if sign == '>' => return at + 1,
            None => quote = ['"', '\''].contains(&sign).then_some(sign),
        }
    }
    text.len()
}

/// How many letters of `name` are written in a name with expressions, if it may become this one.
fn fits(written: &str, name: &str) -> Option<usize> {
    let mut parts = Vec::new();
    let mut rest = written;
    while let Some(at) = rest.find("${").into_iter().chain(rest.find("$(")).min() {
        let close = if rest[at..].starts_with("${") {
            '}'
        } else {
            ')'
        };
        parts.push(&rest[..at]);
        rest = rest[at..]
            .split_once(close)
            .map_or("", |(_, behind)| behind);
    }
    if parts.is_empty() {
        return (written == name).then_some(name.len());
    }
    let letters = parts.iter().map(|part| part.len()).sum::<usize>() + rest.len();
    let mut left = name.strip_suffix(rest)?.strip_prefix(parts[0])?;
    for part in &parts[1..] {
        (_, left) = left.split_once(part)?;
    }
    (letters > 0).then_some(letters)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_that_a_condition_leaves_out_is_named_with_file_line_and_condition() {
        let text = "<robot>\n<!-- <xacro:if value='0'> -->\n<link name='free'/>\n\
                    <xacro:if value=\"${1 > 2}\"/>\n<xacro:unless value='$(arg plain)'>\n\
                    <xacro:if value='${a > 1}'>\n<link name='cup'/></xacro:if>\n\
                    <link name='${n}_depth_$(arg k)_frame'/>\n</xacro:unless></robot>";
        let texts = BTreeMap::from([(PathBuf::from("cam.xacro"), Rc::from(text))]);
        let told = |link: &str| left_out(&texts, &format!("parent link '{link}' does not exist"));
        for (link, place, condition) in [
            ("cup", "cam.xacro:7", "<xacro:if value='${a > 1}'>"),
            (
                "d_depth_1_frame",
                "cam.xacro:8",
                "<xacro:unless value='$(arg plain)'>",
            ),
        ] {
            let advice = told(link).expect("advice");
            assert!(
                advice.starts_with(place) && advice.contains(condition),
                "{advice}"
            );
        }
        assert_eq!(
            [told("free"), told("d_depth_frame"), told("saucer")],
            [None, None, None]
        );
    }
}
