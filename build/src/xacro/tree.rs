//! XML as a tree that can be taken apart and put together: what xacro works on.

use quick_xml::Reader;
use quick_xml::escape;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;
use urdf2fmu_core::urdf::HARDWARE;

/// Elements within each other that are read.
const DEEPEST: usize = 200;

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
}

impl Wrong {
    fn new(message: String, at: usize) -> Self {
        let of_tags = false;
        Self {
            message,
            at,
            of_tags,
        }
    }

    fn of_tags(message: String, at: usize) -> Self {
        let of_tags = true;
        Self {
            message,
            at,
            of_tags,
        }
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
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    reader.config_mut().allow_unmatched_ends = true;
    let mut open: Vec<Element> = Vec::new();
    let (mut root, mut wrong, mut broken) = (None, Vec::new(), false);
    loop {
        let before = usize::try_from(reader.buffer_position()).unwrap_or(0);
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let at = usize::try_from(reader.error_position()).unwrap_or(0);
                wrong.push(Wrong::of_tags(format!("not XML: {error}"), at));
                broken = true;
                break;
            }
        };
        match event {
            Event::Start(tag) => {
                if open.len() >= DEEPEST {
                    let message = format!("more than {DEEPEST} elements in each other");
                    wrong.push(Wrong::new(message, before));
                    return (None, wrong);
                }
                open.push(element(&tag, before, &mut wrong));
            }
            Event::Empty(tag) => {
                let whole = element(&tag, before, &mut wrong);
                close(whole, &mut open, &mut root);
            }
            Event::End(tag) => {
                let name = tag.name();
                let name: &str = name.as_ref();
                let Some(place) = open.iter().rposition(|element| element.name == name) else {
                    wrong.push(Wrong {
                        message: format!("not XML: </{name}> ends nothing"),
                        at: before,
                        of_tags: holds_names(name),
                    });
                    continue;
                };
                end(place, &mut open, &mut root, &mut wrong);
            }
            Event::Text(part) => {
                let part = part.to_string();
                add_text(&mut open, &part);
            }
            Event::CData(part) => {
                let part = part.to_string();
                add_text(&mut open, &part);
            }
            Event::GeneralRef(name) => {
                let name = name.to_string();
                match escape::unescape(&format!("&{name};")) {
                    Ok(text) => add_text(&mut open, &text),
                    Err(error) => wrong.push(Wrong::new(format!("not XML: {error}"), before)),
                }
            }
            Event::Eof => break,
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
        }
    }
    if let Some(outermost) = open.first() {
        let message = format!("not XML: <{}> is never closed", outermost.name);
        let mut unclosed = vec![Wrong::of_tags(message, outermost.at)];
        end(0, &mut open, &mut root, &mut unclosed);
        if !broken {
            wrong.extend(unclosed);
        }
    }
    if root.is_none() && wrong.is_empty() {
        wrong.push(Wrong::new("not XML: there is no element".to_owned(), 0));
    }
    (root, wrong)
}

/// Whether links, joints or what defines them may be in such an element.
fn holds_names(name: &str) -> bool {
    ["robot", "link", "joint"].contains(&name) || name.starts_with("xacro:")
}

/// Closes the element at `place` with all in it, which are not closed.
fn end(place: usize, open: &mut Vec<Element>, root: &mut Option<Element>, wrong: &mut Vec<Wrong>) {
    for unclosed in &open[place + 1..] {
        wrong.push(Wrong {
            message: format!("not XML: <{}> is never closed", unclosed.name),
            at: unclosed.at,
            of_tags: holds_names(&unclosed.name),
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
        wrong.push(Wrong::new(format!("not XML: <{name}>: {error}"), at));
    }
    for attribute in tag.html_attributes().with_checks(false).flatten() {
        let key: &str = attribute.key.as_ref();
        let value: &str = attribute.value.as_ref();
        let value = match escape::unescape(value) {
            Ok(value) => value.into_owned(),
            Err(error) => {
                let message = format!("not XML: <{name}> {key}: {error}");
                wrong.push(Wrong::new(message, at));
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
