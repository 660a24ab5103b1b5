//! XML as a tree that can be taken apart and put together: what xacro works on.

use quick_xml::Reader;
use quick_xml::escape;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::rc::Rc;

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

/// The root element of a text; else what is wrong with it, and where.
pub fn parse(text: &str) -> Result<Element, (String, usize)> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = true;
    let mut open: Vec<Element> = Vec::new();
    let mut root = None;
    loop {
        let before = usize::try_from(reader.buffer_position()).unwrap_or(0);
        let event = reader.read_event().map_err(|error| {
            let at = usize::try_from(reader.error_position()).unwrap_or(0);
            (format!("not XML: {error}"), at)
        })?;
        match event {
            Event::Start(tag) => {
                if open.len() >= DEEPEST {
                    return Err((
                        format!("more than {DEEPEST} elements in each other"),
                        before,
                    ));
                }
                open.push(element(&tag, before).map_err(|what| (what, before))?);
            }
            Event::Empty(tag) => {
                let whole = element(&tag, before).map_err(|what| (what, before))?;
                close(whole, &mut open, &mut root);
            }
            Event::End(_) => {
                if let Some(whole) = open.pop() {
                    close(whole, &mut open, &mut root);
                }
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
                let text = escape::unescape(&format!("&{name};"))
                    .map(std::borrow::Cow::into_owned)
                    .map_err(|error| (format!("not XML: {error}"), before))?;
                add_text(&mut open, &text);
            }
            Event::Eof => break,
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
        }
    }
    if let Some(unclosed) = open.last() {
        return Err((
            format!("not XML: <{}> is never closed", unclosed.name),
            unclosed.at,
        ));
    }
    root.ok_or_else(|| ("not XML: there is no element".to_owned(), 0))
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

fn element(tag: &BytesStart, at: usize) -> Result<Element, String> {
    let name = tag.name().as_ref().to_owned();
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|error| format!("not XML: <{name}>: {error}"))?;
        let key = attribute.key.as_ref().to_owned();
        let value = attribute.value.as_ref().to_owned();
        let value = escape::unescape(&value)
            .map_err(|error| format!("not XML: <{name}> {key}: {error}"))?;
        // As XML wants it: white space in attributes is a space.
        let value = value.replace(['\n', '\t', '\r'], " ");
        attributes.push((key, value));
    }
    Ok(Element {
        name,
        attributes,
        children: Vec::new(),
        at,
        faulty: false,
    })
}

/// The text of a document, two spaces for each level, attributes sorted as the xacro command does.
pub fn write(root: &Element) -> String {
    write_marked(root).0
}

/// The text of a document, and the lines in which elements begin that are not whole, with their
/// names.
pub fn write_marked(root: &Element) -> (String, BTreeMap<usize, String>) {
    let mut out = String::from("<?xml version=\"1.0\" ?>\n<!-- expanded from xacro -->\n");
    let mut faulty = BTreeMap::new();
    write_element(root, 0, &mut out, &mut faulty);
    (out, faulty)
}

fn write_element(
    element: &Element,
    depth: usize,
    out: &mut String,
    faulty: &mut BTreeMap<usize, String>,
) {
    if element.faulty {
        faulty.insert(out.split('\n').count(), element.name.clone());
    }
    let indent = "  ".repeat(depth);
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
                    Node::Element(child) => write_element(child, depth + 1, out, faulty),
                    Node::Text(text) => {
                        out.push_str(&"  ".repeat(depth + 1));
                        out.push_str(&escape::escape(text.trim()));
                        out.push('\n');
                    }
                }
            }
            _ = writeln!(out, "{indent}</{}>", element.name);
        }
    }
}
