//! Links and joints that a file in xacro writes under a condition: where one of them is missing,
//! the condition may be what left it out.
//!
//! Names are compared as they are written, with anything in the place of an expression: what a
//! condition leaves out is not expanded.

use super::definitions::attribute;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Place;

/// A link, or the child of a joint, under a condition.
struct Link<'t> {
    /// Where its tag starts, bytes.
    at: usize,
    /// As it is written.
    name: String,
    /// The tag of the condition next to it.
    condition: &'t str,
    /// Whether it is the child of a joint.
    child: bool,
}

/// Where the link is written of which a message says that it does not exist, and under which
/// condition, as advice.
pub(super) fn left_out(texts: &BTreeMap<PathBuf, Rc<str>>, message: &str) -> Option<String> {
    let (_, rest) = message.split_once(" link '")?;
    let (name, _) = rest.split_once("' does not exist")?;
    let mut best: Option<(usize, String)> = None;
    for (file, text) in texts {
        for link in links(text).into_iter().filter(|link| !link.child) {
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

/// Where a joint is written that holds one of the roots of which a message says that there are
/// several, and what makes its condition hold, as advice.
pub(super) fn unjoined(texts: &BTreeMap<PathBuf, Rc<str>>, message: &str) -> Option<String> {
    let (_, names) = message.split_once(" root links: ")?;
    let roots: Vec<&str> = names.split(", ").collect();
    texts.iter().find_map(|(file, text)| {
        let mut children = links(text).into_iter().filter(|link| link.child);
        children.find_map(|link| {
            roots.iter().find(|root| fits(&link.name, root).is_some())?;
            let argument = asked(texts, link.condition)?;
            let value = link.condition.starts_with("<xacro:if");
            let shown = file.display().to_string();
            let line = Place::in_text(&shown, text, link.at..link.at + 1).line;
            Some(format!(
                "{shown}:{line} writes a joint that holds '{}' under {}: give it after the file, \
                 {argument}:={value}",
                link.name, link.condition
            ))
        })
    })
}

/// The argument that a condition asks for and nothing else, by itself or through a property.
fn asked(texts: &BTreeMap<PathBuf, Rc<str>>, condition: &str) -> Option<String> {
    let argument = |value: &str| {
        let name = value.trim().strip_prefix("$(arg ")?.strip_suffix(')')?;
        Some(name.trim().to_owned())
    };
    let (_, behind_name) = condition.split_once(char::is_whitespace)?;
    let value = attribute(behind_name, "value")?;
    argument(&value).or_else(|| {
        let name = value.trim().strip_prefix("${")?.strip_suffix('}')?.trim();
        let mut tags = texts
            .values()
            .flat_map(|text| text.split("<xacro:property").skip(1));
        tags.find_map(|tag| {
            let own = attribute(tag, "name").as_deref() == Some(name);
            argument(&own.then(|| attribute(tag, "value"))??)
        })
    })
}

/// The links of a text that stand under a condition, and the children of joints that do.
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
        } else if let Some(condition) = conditions.last() {
            let kinds = [("<link", "name", false), ("<child", "link", true)];
            for (word, key, child) in kinds {
                let name = is(word).then(|| attribute(&tag[word.len()..], key));
                found.extend(name.flatten().map(|name| Link {
                    at,
                    name,
                    condition,
                    child,
                }));
            }
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

    /// Arms of a collection stand on `world` if an argument chooses a cell.
    #[test]
    fn a_joint_that_a_condition_leaves_out_is_named_with_the_argument() {
        let text = "<robot>\n<xacro:property name='cell' value='$(arg cell_1)'/>\n\
                    <xacro:if value='${cell}'><joint><parent link='world'/>\n\
                    <child link='base'/></joint></xacro:if>\n\
                    <xacro:if value='${a > 1}'><child link='hand'/></xacro:if>\n\
                    <xacro:unless value='$(arg free)'><child link='cup'/></xacro:unless></robot>";
        let texts = BTreeMap::from([(PathBuf::from("arm.xacro"), Rc::from(text))]);
        let told = |roots: &str| unjoined(&texts, &format!("the robot has 2 root links: {roots}"));
        assert_eq!(
            told("base, world").as_deref(),
            Some(
                "arm.xacro:4 writes a joint that holds 'base' under <xacro:if value='${cell}'>: give \
                 it after the file, cell_1:=true"
            )
        );
        assert!(told("world, cup").is_some_and(|advice| advice.ends_with("free:=false")));
        assert_eq!([told("hand, world"), told("world, other")], [None, None]);
    }
}
