//! XML as a tree that can be taken apart and put together: what xacro works on.

use quick_xml::Reader;
use quick_xml::errors::{Error, SyntaxError};
use quick_xml::escape;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;
use urdf2fmu_core::diagnostic::Place;
use urdf2fmu_core::urdf::HARDWARE;

/// Elements within each other that are read.
const DEEPEST: usize = 200;

/// What helps against an entity that there is not.
const ENTITIES: &str = "write '&' as &amp; and '<' as &lt;";

/// What stands in an element.
#[derive(Clone, Debug)]
pub enum Node {
    /// `<tag …>`
    Element(Rc<Element>),
    /// Between tags.
    Text(String),
}

/// An element.
#[derive(Clone, Debug, Default)]
pub struct Element {
    /// Its name with the prefix.
    pub name: String,
    /// In the order of the file.
    pub attributes: Vec<(String, String)>,
    /// What it contains; comments are left out.
    pub children: Vec<Node>,
    /// Where its tag starts in its file, bytes.
    pub at: usize,
    /// The file in which it is written.
    pub file: Option<Rc<Path>>,
    /// Whether something of it could not be expanded and is left out.
    pub faulty: bool,
}

impl Element {
    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(own, _)| own == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Elements directly in it.
    pub fn elements(&self) -> impl Iterator<Item = &Rc<Element>> {
        self.children.iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            Node::Text(_) => None,
        })
    }
}

/// Declarations of prefixes go to the element around.
pub fn import_namespaces(attributes: &mut Vec<(String, String)>, from: &Element) {
    for (name, value) in &from.attributes {
        if name.starts_with("xmlns:")
            && name != "xmlns:xacro"
            && !attributes.iter().any(|(own, _)| own == name)
        {
            attributes.push((name.clone(), value.clone()));
        }
    }
}

/// Sets an attribute, or replaces it.
pub fn set(attributes: &mut Vec<(String, String)>, name: &str, value: String) {
    match attributes.iter_mut().find(|(own, _)| own == name) {
        Some((_, own)) => *own = value,
        None => attributes.push((name.to_owned(), value)),
    }
}

/// What is wrong with a text.
#[derive(Debug)]
pub struct Wrong {
    pub message: String,
    /// Where, bytes.
    pub at: usize,
    /// Whether a tag is missing, so that elements may be in others than was meant.
    pub of_tags: bool,
    pub help: Option<String>,
}

impl Wrong {
    fn new(message: String, at: usize) -> Self {
        Self {
            message,
            at,
            of_tags: false,
            help: None,
        }
    }

    fn of_tags(message: String, at: usize) -> Self {
        Self {
            of_tags: true,
            ..Self::new(message, at)
        }
    }

    fn with(self, help: impl Into<String>) -> Self {
        let help = Some(help.into());
        Self { help, ..self }
    }
}

/// The root element of a text, and what is wrong with it. What is no XML is read as it may be
/// meant: a tag that is not closed ends with the one around it, an attribute without quotes ends at
/// the next space.
///
/// - `file`: the name of the text
pub fn parse(text: &str, file: &Path) -> (Option<Element>, Vec<Wrong>) {
    let file: Rc<Path> = file.into();
    let element = |tag: &BytesStart, at: usize, wrong: &mut Vec<Wrong>| Element {
        file: Some(Rc::clone(&file)),
        ..element(tag, at, wrong)
    };
    // Where the reader begins, and where it is to go on behind what is no tag. It would skip a byte
    // order mark without counting it.
    let mut base = text.len() - text.trim_start_matches('\u{feff}').len();
    let mut resume = None;
    let mut reader = reader(&text[base..]);
    let mut open: Vec<Element> = Vec::new();
    // Where elements of a name end themselves, the last of each.
    let mut empty: BTreeMap<String, usize> = BTreeMap::new();
    let (mut root, mut wrong, mut broken) = (None, Vec::new(), false);
    loop {
        if let Some(next) = resume.take() {
            base = next;
            reader = self::reader(&text[next..]);
        }
        let position = |of_reader: u64| base + usize::try_from(of_reader).unwrap_or(0);
        let before = position(reader.buffer_position());
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let at = position(reader.error_position()).min(text.len());
                let problem = Wrong::of_tags(format!("not XML: {error}"), at);
                wrong.push(problem.with(malformed(&error)));
                resume = put(text, before, &file, &mut open, &mut root);
                broken = resume.is_none();
                if broken {
                    break;
                }
                continue;
            }
        };
        match event {
            Event::Start(tag) | Event::Empty(tag)
                if tag.contains('<') && tag.attributes().any(|found| found.is_err()) =>
            {
                // A quotation mark or a bracket that is missing takes in the tags behind it.
                let name = tag.name().as_ref().to_owned();
                let message = format!("not XML: <{name}> has no end before the next tag");
                let problem = Wrong::new(message, before);
                wrong.push(Wrong {
                    of_tags: holds_names(&name),
                    ..problem.with("a quotation mark or > is missing in it")
                });
                resume = put(text, before, &file, &mut open, &mut root);
            }
            Event::Start(tag) => {
                if open.len() >= DEEPEST {
                    let message = format!("more than {DEEPEST} elements in each other");
                    wrong.push(Wrong::new(message, before));
                    return (None, wrong);
                }
                open.push(element(&tag, before, &mut wrong));
            }
            Event::Empty(tag) => {
                empty.insert(tag.name().as_ref().to_owned(), before);
                let whole = element(&tag, before, &mut wrong);
                close(whole, &mut open, &mut root);
            }
            Event::End(tag) => {
                let name = tag.name();
                let name: &str = name.as_ref();
                match open.iter().rposition(|element| element.name == name) {
                    Some(place) => end(place, &mut open, &mut root, &mut wrong),
                    None => wrong.push(stray(text, name, before, empty.get(name))),
                }
            }
            Event::Text(part) => add_text(&mut open, &part),
            Event::CData(part) => add_text(&mut open, &part),
            Event::GeneralRef(name) => match escape::unescape(&format!("&{};", &*name)) {
                Ok(text) => add_text(&mut open, &text),
                Err(error) => {
                    let problem = Wrong::new(format!("not XML: {error}"), before);
                    wrong.push(problem.with(ENTITIES));
                }
            },
            Event::Eof => break,
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
        }
    }
    if let Some(outermost) = open.first() {
        let message = format!("not XML: <{}> is never closed", outermost.name);
        let help = format!("add </{}>; is the file complete?", outermost.name);
        let mut unclosed = vec![Wrong::of_tags(message, outermost.at).with(help)];
        end(0, &mut open, &mut root, &mut unclosed);
        if !broken {
            wrong.extend(unclosed);
        }
    }
    if root.is_none() && wrong.is_empty() {
        let none = Wrong::new("not XML: there is no element".to_owned(), 0);
        wrong.push(none.with(
            "a file in xacro has one element around all others: <robot name=\"…\">…</robot>",
        ));
    }
    (root, wrong)
}

/// That an end belongs to no beginning.
///
/// - `empty`: where an element of its name ends itself
fn stray(text: &str, name: &str, at: usize, empty: Option<&usize>) -> Wrong {
    let help = empty.map_or_else(
        || "remove it, or begin the element".to_owned(),
        |&at| {
            format!(
                "write > in place of /> at the end of <{name} …/> in line {}, if it begins what \
                 this ends, or remove it",
                Place::in_text("", text, at..at + 1).line
            )
        },
    );
    let problem = Wrong::new(format!("not XML: </{name}> ends nothing"), at);
    Wrong {
        of_tags: holds_names(name),
        ..problem.with(help)
    }
}

/// Names of ends are compared here.
fn reader(text: &str) -> Reader<&[u8]> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    reader.config_mut().allow_unmatched_ends = true;
    reader
}

/// What helps against what the reader refuses.
fn malformed(error: &Error) -> &'static str {
    match error {
        Error::Syntax(
            SyntaxError::UnclosedSingleQuotedAttributeValue
            | SyntaxError::UnclosedDoubleQuotedAttributeValue,
        ) => "a quotation mark is missing here or before; or is the file cut off?",
        _ => "is the file complete?",
    }
}

/// Adds an element whose tag is not whole, up to the next tag: it holds what comes next if an end
/// of its name comes before another beginning of it. Gives the place of the next tag.
fn put(
    text: &str,
    start: usize,
    file: &Rc<Path>,
    open: &mut Vec<Element>,
    root: &mut Option<Element>,
) -> Option<usize> {
    let behind = text.get(start + 1..)?;
    let next = behind.find('<')?;
    let content = behind[..next].trim_end().trim_end_matches(['/', '>']);
    let part = |c: char| c.is_alphanumeric() || "_-:.".contains(c);
    let length = content.find(|c| !part(c)).unwrap_or(content.len());
    let next = start + 1 + next;
    if !text[start..].starts_with('<') || length == 0 || open.len() >= DEEPEST {
        return Some(next);
    }
    let tag = BytesStart::from_content(content, length);
    let found = Element {
        file: Some(Rc::clone(file)),
        faulty: true,
        ..element(&tag, start, &mut Vec::new())
    };
    let behind = &text[next..];
    let begins = behind.find(&format!("<{}", found.name));
    let ends = behind.find(&format!("</{}", found.name));
    if ends.is_some_and(|ends| begins.is_none_or(|begins| ends < begins)) {
        open.push(found);
    } else {
        close(found, open, root);
    }
    Some(next)
}

/// Whether links, joints or what defines them may be in such an element.
fn holds_names(name: &str) -> bool {
    ["robot", "link", "joint"].contains(&name) || name.starts_with("xacro:")
}

/// Closes the element at `place` with all in it, which are not closed.
fn end(place: usize, open: &mut Vec<Element>, root: &mut Option<Element>, wrong: &mut Vec<Wrong>) {
    for unclosed in &open[place + 1..] {
        let name = &unclosed.name;
        let message = format!("not XML: <{name}> is never closed");
        let problem = Wrong::new(message, unclosed.at);
        wrong.push(Wrong {
            of_tags: holds_names(name),
            ..problem.with(format!(
                "add </{name}> before the end of the element around it"
            ))
        });
    }
    while open.len() > place {
        if let Some(mut whole) = open.pop() {
            // Where it should have ended is not known: at the latest where a link or joint begins.
            let rest = if open.len() > place {
                beyond(&mut whole)
            } else {
                Vec::new()
            };
            close(whole, open, root);
            if let Some(parent) = open.last_mut() {
                parent.children.extend(rest);
            }
        }
    }
}

/// Takes out of an element what cannot be in it.
fn beyond(element: &mut Element) -> Vec<Node> {
    let name = element.name.as_str();
    let holds = name == "robot" || HARDWARE.contains(&name) || name.starts_with("xacro:");
    let part = |node: &Node| match node {
        Node::Element(inner) => ["link", "joint"].contains(&inner.name.as_str()),
        Node::Text(_) => false,
    };
    match element.children.iter().position(part) {
        Some(first) if !holds => element.children.split_off(first),
        _ => Vec::new(),
    }
}

fn add_text(open: &mut [Element], text: &str) {
    let Some(element) = open.last_mut() else {
        return;
    };
    if let Some(Node::Text(before)) = element.children.last_mut() {
        before.push_str(text);
    } else {
        element.children.push(Node::Text(text.to_owned()));
    }
}

fn close(whole: Element, open: &mut [Element], root: &mut Option<Element>) {
    match open.last_mut() {
        Some(parent) => parent.children.push(Node::Element(Rc::new(whole))),
        None => {
            root.get_or_insert(whole);
        }
    }
}

/// An element with its attributes, those that are no XML as they may be meant.
fn element(tag: &BytesStart, at: usize, wrong: &mut Vec<Wrong>) -> Element {
    let name = tag.name().as_ref().to_owned();
    let mut attributes: Vec<(String, String)> = Vec::new();
    let before = wrong.len();
    let mut strict = tag.attributes();
    if let Some(error) = strict.find_map(Result::err) {
        let problem = Wrong::new(format!("not XML: <{name}>: {error}"), at);
        wrong.push(problem.with("an attribute is written name=\"value\", once per element"));
    }
    for attribute in tag.html_attributes().with_checks(false).flatten() {
        let key: &str = attribute.key.as_ref();
        let value: &str = attribute.value.as_ref();
        let value = match escape::unescape(value) {
            Ok(value) => value.into_owned(),
            Err(error) => {
                let message = format!("not XML: <{name}> {key}: {error}");
                wrong.push(Wrong::new(message, at).with(ENTITIES));
                value.to_owned()
            }
        };
        // As XML wants it: white space in attributes is a space.
        let value = value.replace(['\n', '\t', '\r'], " ");
        // Of two the first counts.
        if !attributes.iter().any(|(own, _)| own == key) {
            attributes.push((key.to_owned(), value));
        }
    }
    Element {
        name,
        attributes,
        children: Vec::new(),
        at,
        file: None,
        faulty: wrong.len() > before,
    }
}

/// The text of a document.
#[derive(Debug, Default)]
pub struct Written {
    pub text: String,
    /// Lines in which elements begin that are not whole, with their names.
    pub faulty: BTreeMap<usize, String>,
    /// File and place there, bytes, of the elements that begin in lines.
    pub origins: BTreeMap<usize, (Rc<Path>, usize)>,
    /// Lines of the text up to a place.
    counted: (usize, usize),
}

/// The text of a document, two spaces for each level, attributes sorted as the xacro command does.
pub fn write(root: &Element) -> Written {
    let mut written = Written::default();
    let head = "<?xml version=\"1.0\" ?>\n<!-- expanded from xacro -->\n";
    written.text.push_str(head);
    written.element(root, 0);
    written
}

impl Written {
    /// The line that is written to, from 1.
    fn line(&mut self) -> usize {
        let (lines, at) = self.counted;
        let more = self.text[at..]
            .bytes()
            .filter(|byte| *byte == b'\n')
            .count();
        self.counted = (lines + more, self.text.len());
        lines + more + 1
    }

    fn element(&mut self, element: &Element, depth: usize) {
        let line = self.line();
        if element.faulty {
            self.faulty.insert(line, element.name.clone());
        }
        if let Some(file) = &element.file {
            self.origins.insert(line, (Rc::clone(file), element.at));
        }
        let indent = "  ".repeat(depth);
        let out = &mut self.text;
        out.push_str(&indent);
        out.push('<');
        out.push_str(&element.name);
        let mut attributes: Vec<_> = element.attributes.iter().collect();
        attributes.sort();
        for (name, value) in attributes {
            out.push(' ');
            out.push_str(name);
            out.push_str("=\"");
            out.push_str(&escape::escape(value.as_str()));
            out.push('"');
        }
        let blank = |node: &&Node| matches!(node, Node::Text(text) if text.trim().is_empty());
        let children: Vec<&Node> = element
            .children
            .iter()
            .filter(|node| !blank(node))
            .collect();
        match children[..] {
            [] => out.push_str("/>\n"),
            [Node::Text(text)] => {
                out.push('>');
                out.push_str(&escape::escape(text.as_str()));
                _ = writeln!(out, "</{}>", element.name);
            }
            _ => {
                out.push_str(">\n");
                for child in children {
                    match child {
                        Node::Element(child) => self.element(child, depth + 1),
                        Node::Text(text) => {
                            let out = &mut self.text;
                            out.push_str(&"  ".repeat(depth + 1));
                            out.push_str(&escape::escape(text.trim()));
                            out.push('\n');
                        }
                    }
                }
                _ = writeln!(self.text, "{indent}</{}>", element.name);
            }
        }
    }
}
