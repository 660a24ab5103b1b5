//! XML text → [`Document`], by quick-xml, with a finding at its place for what is no XML.
//!
//! Constructs that let a small file grow without bound are refused: DOCTYPE and entities, deep
//! nesting, very many elements.

use super::{Attribute, Document, Element};
use crate::diagnostic::Report;
use quick_xml::Reader;
use quick_xml::errors::{Error, IllFormedError, SyntaxError};
use quick_xml::escape::{self, EscapeError};
use quick_xml::events::attributes::AttrError;
use quick_xml::events::{BytesStart, Event};
use std::ops::Range;

/// Deepest nesting that is read. URDF needs 6, COLLADA's node trees may be deeper.
const DEEPEST: usize = 200;

/// Most elements that are read: a hundred times the largest robot, and some hundred MB.
const MOST_ELEMENTS: usize = 1_000_000;

/// Most attributes of one element; that no name stands twice is found out by comparing all pairs.
const MOST_ATTRIBUTES: usize = 1_000;

impl<'t> Document<'t> {
    /// Reads `text`; `None` after reporting why it is not XML.
    pub(in crate::urdf) fn parse(text: &'t str, report: &mut Report) -> Option<Self> {
        Builder {
            text,
            elements: Vec::new(),
            open: Vec::new(),
            closed: false,
        }
        .run(report)
    }
}

struct Builder<'t> {
    text: &'t str,
    elements: Vec<Element>,
    open: Vec<usize>,
    /// Whether the root has ended.
    closed: bool,
}

impl<'t> Builder<'t> {
    fn run(mut self, report: &mut Report) -> Option<Document<'t>> {
        // The reader skips a byte order mark without counting it.
        let body = self.text.trim_start_matches('\u{feff}');
        let mark = self.text.len() - body.len();
        let position = |in_body: u64| mark + position(in_body);
        let mut reader = Reader::from_str(body);
        loop {
            let start = position(reader.buffer_position());
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    let end = position(reader.buffer_position());
                    let at = position(reader.error_position());
                    self.malformed(&error, at, end, report);
                    return None;
                }
            };
            let end = position(reader.buffer_position());
            match event {
                Event::Start(tag) => self.start(&tag, start..end, false, report)?,
                Event::Empty(tag) => self.start(&tag, start..end, true, report)?,
                Event::End(_) => {
                    self.open.pop();
                    self.closed = self.open.is_empty();
                }
                Event::Text(_) | Event::GeneralRef(_) => self.content(start..end, report)?,
                Event::CData(_) => {
                    // `<![CDATA[` and `]]>`
                    self.content((start + 9).min(end)..end.saturating_sub(3), report)?;
                }
                Event::Decl(_) if start > mark => report.warning(
                    "U008",
                    start..end,
                    "the XML declaration is not at the start of the file",
                    "remove what stands before it: strict XML readers refuse the file",
                ),
                Event::DocType(_) => {
                    report.error(
                        "U004",
                        start..end,
                        "DOCTYPE and entity declarations are not read",
                        "remove the declaration and write the text out where an entity is used",
                    );
                    return None;
                }
                Event::Decl(_) | Event::Comment(_) | Event::PI(_) => {}
                Event::Eof => return self.end(report),
            }
        }
    }

    fn end(self, report: &mut Report) -> Option<Document<'t>> {
        if let Some(&last) = self.open.last() {
            let element = &self.elements[last];
            let name = &self.text[element.name.clone()];
            report.error(
                "U003",
                element.tag.clone(),
                format!("not XML: <{name}> is never closed"),
                format!("add </{name}>; is the file complete?"),
            );
            return None;
        }
        if self.elements.is_empty() {
            let what = if self.text.trim().is_empty() {
                "the file is empty"
            } else {
                "not XML: there is no element"
            };
            report.error("U003", 0..0, what, "a URDF starts with <robot name=\"…\">");
            return None;
        }
        Some(Document {
            text: self.text,
            elements: self.elements,
        })
    }

    fn content(&mut self, at: Range<usize>, report: &mut Report) -> Option<()> {
        if at.is_empty() {
            return Some(());
        }
        if let Some(&parent) = self.open.last() {
            self.elements[parent].content.push(at);
            return Some(());
        }
        let text = &self.text[at.clone()];
        let solid = text.trim_matches(|c: char| c.is_whitespace() || c == '\0' || c == '\u{feff}');
        if !solid.is_empty() {
            let from = at.start + text.find(solid).unwrap_or(0);
            let what = "not XML: text outside the root element";
            let help = "a URDF is one <robot> element; remove the text or make it a comment";
            report.error("U003", from..from + solid.len(), what, help);
            return None;
        }
        if let Some(zero) = text.find('\0') {
            report.warning(
                "U008",
                at.start + zero..at.start + zero + 1,
                "a NUL byte outside the root element",
                "remove it: strict XML readers refuse the file",
            );
        }
        Some(())
    }

    fn start(
        &mut self,
        tag: &BytesStart,
        at: Range<usize>,
        empty: bool,
        report: &mut Report,
    ) -> Option<()> {
        // Right behind the opening bracket.
        let name_start = at.start + 1;
        let name = name_start..name_start + tag.name().as_ref().len();
        if self.open.is_empty() && self.closed {
            report.error(
                "U003",
                at,
                "not XML: a second root element",
                "a URDF is one <robot> element; put one robot into a file",
            );
            return None;
        }
        if self.open.len() >= DEEPEST || self.elements.len() >= MOST_ELEMENTS {
            let what = if self.open.len() >= DEEPEST {
                format!("elements are nested more than {DEEPEST} deep")
            } else {
                format!("more than {MOST_ELEMENTS} elements")
            };
            report.error(
                "U005",
                at,
                what,
                "a robot needs far fewer; the file is refused",
            );
            return None;
        }
        let attributes = self.attributes(tag, name_start, &at, report)?;
        let index = self.elements.len();
        self.elements.push(Element {
            name,
            tag: at,
            attributes,
            children: Vec::new(),
            content: Vec::new(),
        });
        if let Some(&parent) = self.open.last() {
            self.elements[parent].children.push(index);
        }
        if empty {
            self.closed = self.open.is_empty();
        } else {
            self.open.push(index);
        }
        Some(())
    }

    fn attributes(
        &self,
        tag: &BytesStart,
        name_start: usize,
        at: &Range<usize>,
        report: &mut Report,
    ) -> Option<Vec<Attribute>> {
        let mut list = Vec::new();
        for attribute in tag.attributes() {
            if list.len() >= MOST_ATTRIBUTES {
                report.error(
                    "U005",
                    at.start..name_start,
                    format!("an element with more than {MOST_ATTRIBUTES} attributes"),
                    "a robot needs far fewer; the file is refused",
                );
                return None;
            }
            let attribute = match attribute {
                Ok(attribute) => attribute,
                Err(error) => {
                    let (offset, what) = attribute_problem(&error);
                    let from = (name_start + offset).min(at.end);
                    report.error(
                        "U003",
                        from..from + 1,
                        format!("not XML: {what}"),
                        "an attribute is written name=\"value\", once per element",
                    );
                    return None;
                }
            };
            let name = self.range_of(attribute.key.as_ref(), at);
            let value = self.range_of(&attribute.value, at);
            match escape::unescape(&self.text[value.clone()]) {
                Ok(resolved) => list.push(Attribute {
                    name,
                    at: value,
                    value: resolved.into_owned(),
                }),
                Err(error) => {
                    let message = match error {
                        EscapeError::UnterminatedEntity(_) => {
                            "not XML: '&' begins an entity, and no ';' ends it".to_owned()
                        }
                        other => format!("not XML: {other}"),
                    };
                    let help = "write '&' as &amp; and '<' as &lt;";
                    report.error("U003", value, message, help);
                    return None;
                }
            }
        }
        Some(list)
    }

    /// Where a part of the text stands that quick-xml borrowed from it.
    fn range_of(&self, part: &str, within: &Range<usize>) -> Range<usize> {
        let offset = (part.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        if within.contains(&offset) && offset + part.len() <= within.end {
            offset..offset + part.len()
        } else {
            // Not borrowed, which quick-xml does not do for a text in memory: the start of the tag.
            within.start..within.start
        }
    }

    fn malformed(&self, error: &Error, at: usize, end: usize, report: &mut Report) {
        let help = match error {
            Error::IllFormed(IllFormedError::MismatchedEndTag { expected, .. }) => {
                match self.open.last() {
                    Some(&open) => {
                        let line = self.text[..self.elements[open].tag.start]
                            .bytes()
                            .filter(|&b| b == b'\n')
                            .count();
                        format!("<{expected}> of line {} is still open", line + 1)
                    }
                    None => String::new(),
                }
            }
            Error::Syntax(
                SyntaxError::UnclosedSingleQuotedAttributeValue
                | SyntaxError::UnclosedDoubleQuotedAttributeValue,
            ) => "a quotation mark is missing here or before; or is the file cut off?".to_owned(),
            Error::Syntax(_) => "is the file complete?".to_owned(),
            _ => String::new(),
        };
        let at = at.min(self.text.len());
        report.error("U003", at..end.max(at), format!("not XML: {error}"), help);
    }
}

fn position(at: u64) -> usize {
    usize::try_from(at).unwrap_or(usize::MAX)
}

/// Offset from the start of the tag's name, and what is wrong.
fn attribute_problem(error: &AttrError) -> (usize, &'static str) {
    match *error {
        AttrError::ExpectedEq(at) => (at, "'=' is missing after the attribute's name"),
        AttrError::ExpectedValue(at) => (at, "the attribute has no value"),
        AttrError::UnquotedValue(at) => (at, "the attribute's value is not in quotes"),
        AttrError::ExpectedQuote(at, _) => (at, "the attribute's value lacks its closing quote"),
        AttrError::Duplicated(at, _) => (at, "the attribute stands twice in one element"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Node;
    use super::*;

    fn problem(text: &str) -> String {
        let mut report = Report::new("t", text);
        assert!(Document::parse(text, &mut report).is_none(), "{text}");
        let list = report.finish();
        let place = list[0].place.as_ref().expect("a place");
        format!("{} {}:{}", list[0].code, place.line, place.column)
    }

    #[test]
    fn elements_and_attributes_know_their_places() {
        let text =
            "<?xml version='1.0'?>\n<a>\n <b x = 'ä' y=\"1 &lt; 2\"/><c>7<!-- . -->8</c></a>\n";
        let mut report = Report::new("t", text);
        let document = Document::parse(text, &mut report).expect("XML");
        let root = document.root();
        let b = root.child("b").expect("b");
        let y = b.attribute("y").expect("y");
        assert_eq!(&text[y.at.clone()], "1 &lt; 2");
        assert_eq!(y.value, "1 < 2");
        assert_eq!(&text[b.tag_at()], "<b x = 'ä' y=\"1 &lt; 2\"/>");
        assert_eq!(root.child("c").expect("c").content(), "78");
        let names: Vec<&str> = root.descendants().map(Node::name).collect();
        assert_eq!(names, ["a", "b", "c"]);
        assert!(report.finish().is_empty());
    }

    #[test]
    fn text_that_is_not_xml_is_reported_with_its_place() {
        assert_eq!(problem(""), "U003 1:1");
        assert_eq!(problem("hello"), "U003 1:1");
        assert_eq!(problem("<a>\n <b>\n</a>"), "U003 3:1");
        assert_eq!(problem("<a>\n <b>\n"), "U003 2:2");
        assert_eq!(problem("<a>\n <b x=1/></a>"), "U003 2:7");
        assert_eq!(problem("<a>\n <b x='1' x='2'/></a>"), "U003 2:11");
        assert_eq!(problem("<a>\n <b x='&bomb;'/></a>"), "U003 2:8");
        assert_eq!(problem("<a/>\n<a/>"), "U003 2:1");
        assert_eq!(problem("<a/>\n text"), "U003 2:2");
        assert_eq!(problem("<!DOCTYPE a [<!ENTITY b 'c'>]>\n<a/>"), "U004 1:1");
        assert_eq!(problem(&"<a>".repeat(300)), "U005 1:601");
    }

    #[test]
    fn a_late_declaration_and_a_nul_at_the_end_are_warnings() {
        let text = "\n<?xml version='1.0'?><a/>\0";
        let mut report = Report::new("t", text);
        assert!(Document::parse(text, &mut report).is_some());
        let codes: Vec<_> = report.finish().iter().map(|d| d.code).collect();
        assert_eq!(codes, ["U008", "U008"]);
    }
}
