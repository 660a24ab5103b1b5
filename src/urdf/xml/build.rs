//! XML text → [`Document`], by quick-xml, with a finding at its place for what is no XML.
//!
//! Constructs that let a small file grow without bound are refused: DOCTYPE and entities, deep
//! nesting, very many elements.
//!
//! Over 500 lines because each construct that is no XML has its finding and its recovery beside the
//! one that is.

use super::{Attribute, Document, Element, HARDWARE, comments, is_forbidden};
use crate::diagnostic::Report;
use crate::diagnostic::words::{code, strange};
use quick_xml::Reader;
use quick_xml::errors::{Error, SyntaxError};
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
        let mut builder = Builder {
            kind: "an SRDF",
            ..Builder::new(text, &[])
        };
        builder.run(report).filter(|_| !report.has_errors())
    }

    /// Reads the text of a robot as far as it is XML, so that what else is wrong is told, too;
    /// `None` after reporting why nothing can be made of it.
    ///
    /// A tag that is not closed ends with the one around it, at the latest where a further link or
    /// joint of the robot begins.
    pub(in crate::urdf) fn parse_rest(text: &'t str, report: &mut Report) -> Option<Self> {
        let mut builder = Builder::new(text, &[]);
        let document = builder.run(report);
        if !builder.unmatched {
            return document;
        }
        report.clear();
        let unclosed = std::mem::take(&mut builder.unclosed);
        let mut builder = Builder::new(text, &["link", "joint"]);
        builder.unclosed = unclosed;
        builder.run(report)
    }
}

/// Parts of a link, which never lie in each other.
const PARTS: [&str; 3] = ["inertial", "visual", "collision"];

#[expect(clippy::struct_excessive_bools, reason = "each is found out by itself")]
struct Builder<'t> {
    text: &'t str,
    /// What begins with a robot, for advice; whoever reads another document has its own.
    kind: &'static str,
    elements: Vec<Element>,
    open: Vec<usize>,
    /// Whether the root has ended.
    closed: bool,
    /// Children of the root that never lie in each other.
    apart: &'static [&'static str],
    /// Where elements begin that are never closed, as far as another run has found.
    unclosed: Vec<usize>,
    /// Where the element begins of which it was told that its end is another one.
    told: Option<usize>,
    /// Where the link or joint begins in which this was told last.
    told_in: Option<usize>,
    /// Whether the tags do not match somewhere: what follows from that is not told again.
    unmatched: bool,
    /// Whether entities may be declared that are not read.
    declared: bool,
    /// Where to go on after a tag that is not one.
    resume: Option<usize>,
    /// Whether what comes next is another document.
    over: bool,
    /// Whether two hyphens in a comment were told.
    hyphens: bool,
}

/// The first line by which git marks where two versions of a file differ, outside of comments.
fn conflict(text: &str) -> Option<Range<usize>> {
    let last = text.rfind("\n>>>>>>> ")?;
    let mut at = 0;
    while let Some(next) = text[at..last].find('<') {
        at += next;
        let rest = &text[at..last];
        let first = matches!(
            text[..at].chars().next_back(),
            None | Some('\n' | '\u{feff}')
        );
        if first && rest.starts_with("<<<<<<< ") {
            return Some(at..at + rest.lines().next().map_or(0, str::len));
        }
        at += if rest.starts_with("<!--") {
            rest.find("-->")?
        } else {
            1
        };
    }
    None
}

impl<'t> Builder<'t> {
    fn new(text: &'t str, apart: &'static [&'static str]) -> Self {
        Self {
            text,
            kind: "a URDF",
            elements: Vec::new(),
            open: Vec::new(),
            closed: false,
            apart,
            unclosed: Vec::new(),
            told: None,
            told_in: None,
            unmatched: false,
            declared: false,
            resume: None,
            over: false,
            hyphens: false,
        }
    }

    /// How the file begins.
    fn beginning(&self) -> String {
        format!("{} starts with <robot name=\"…\">", self.kind)
    }

    fn run(&mut self, report: &mut Report) -> Option<Document<'t>> {
        if let Some(at) = other_text(self.text) {
            let what = "not XML: the file begins with text, not with a tag";
            let help = format!("{}: is it the right file?", self.beginning());
            report.error("U003", at, what, help);
            return None;
        }
        if let Some(at) = conflict(self.text) {
            let what = "not XML: a conflict of a merge by git was left in the file";
            let help = "keep one side of each, without the lines that begin with <<<<<<<, ======= and \
                        >>>>>>>";
            report.error("U003", at, what, help);
            return None;
        }
        // The reader skips a byte order mark without counting it.
        let body = self.text.trim_start_matches('\u{feff}');
        let first = self.text.len() - body.len();
        let mut mark = first;
        let mut reader = reader(body);
        loop {
            if self.over {
                return self.end(report);
            }
            if let Some(at) = self.resume.take() {
                mark = at;
                reader = self::reader(&self.text[at..]);
            }
            let position = |in_body: u64| mark + position(in_body);
            let start = position(reader.buffer_position());
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    let end = position(reader.buffer_position());
                    let at = position(reader.error_position());
                    let at = at.min(self.text.len());
                    Self::malformed(self.text, &error, at, end, report);
                    if matches!(error, Error::IllFormed(_)) && end > start {
                        continue;
                    }
                    self.broken(start, report)?;
                    continue;
                }
            };
            let end = position(reader.buffer_position());
            match event {
                Event::Start(tag) => self.start(&tag, start..end, false, report)?,
                Event::Empty(tag) => self.start(&tag, start..end, true, report)?,
                Event::End(tag) => self.finish(tag.name().as_ref(), start..end, report),
                Event::Text(_) | Event::GeneralRef(_) => self.content(start..end, report),
                Event::CData(_) => {
                    // `<![CDATA[` and `]]>`
                    self.content((start + 9).min(end)..end.saturating_sub(3), report);
                }
                Event::Decl(_) if start > first => report.warning(
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
                    self.declared = true;
                }
                Event::Comment(_) => self.comment(start..end, report),
                Event::Decl(_) | Event::PI(_) => {}
                Event::Eof => return self.end(report),
            }
        }
    }

    /// Tells of hyphens in a comment, which XML 1.0 forbids (2.5) so that its end is seen: a
    /// comment within a comment ends both, and what was to be left out behind it is read.
    fn comment(&mut self, at: Range<usize>, report: &mut Report) {
        let first = at.start + "<!--".len();
        let text = &self.text[first..at.end];
        if let Some(inner) = text.find("<!--") {
            let line = report.line(at.start);
            let message = format!("not XML: a comment within the comment of line {line}");
            let help = comments::advice(&text[..inner], first, report);
            let help = help.unwrap_or_else(|| {
                "the first --> ends both: remove the inner <!-- and its -->".to_owned()
            });
            let inner = first + inner;
            report.error("U003", inner..inner + "<!--".len(), message, help);
        } else if let Some(hyphens) = text.find("--").filter(|&i| first + i + 3 < at.end)
            && !std::mem::replace(&mut self.hyphens, true)
        {
            let hyphens = first + hyphens;
            report.warning(
                "U008",
                hyphens..hyphens + 2,
                "two hyphens within a comment",
                "write others in their place: strict XML readers refuse the file",
            );
        }
    }

    fn name(&self, element: usize) -> &'t str {
        &self.text[self.elements[element].name.clone()]
    }

    /// Ends the innermost element, or one around it.
    fn finish(&mut self, name: &str, at: Range<usize>, report: &mut Report) {
        let Some(&last) = self.open.last() else {
            if !std::mem::replace(&mut self.unmatched, true) {
                let help = "remove it, or begin the element";
                report.error("U003", at, format!("not XML: </{name}> ends nothing"), help);
            }
            return;
        };
        let expected = self.name(last);
        if expected == name {
            self.open.pop();
        } else {
            // Each link and joint ends what is open in the one before it.
            let around = self.open.get(1).map(|&part| self.elements[part].tag.start);
            let around = around.filter(|_| !self.apart.is_empty());
            let other = around.is_some() && around != self.told_in;
            if !std::mem::replace(&mut self.unmatched, true) || other {
                self.told_in = around;
                let begins = self.elements[last].tag.start;
                self.told = Some(begins);
                let line = report.line(begins);
                let message =
                    format!("not XML: expected `</{expected}>`, but `</{name}>` was found");
                let odd = strange(name, expected).or_else(|| strange(expected, name));
                let odd = odd.map_or_else(String::new, |odd| format!("; {odd}"));
                let help = format!("<{expected}> of line {line} is still open{odd}");
                report.error("U003", at, message, help);
            }
            let meant = |&&open: &&usize| self.name(open) == name;
            match self.open.iter().rposition(|open| meant(&open)) {
                // What lies between is not closed.
                Some(depth) => {
                    let inner = self.open.drain(depth..).skip(1);
                    let starts = inner.map(|open| self.elements[open].tag.start);
                    self.unclosed.extend(starts);
                }
                None if alike(name, expected) => _ = self.open.pop(),
                None => {}
            }
        }
        self.closed = self.open.is_empty();
    }

    /// Ends what is still open where an element begins that cannot lie in it.
    fn part(&mut self, name: &str, report: &mut Report) {
        let Some(&around) = self.open.get(1) else {
            return;
        };
        let outer = self.name(around);
        if let Some(&part) = self.open.get(2)
            && self.apart.contains(&outer)
            && [name, self.name(part)]
                .iter()
                .all(|name| PARTS.contains(name))
        {
            let outer = self.name(part);
            let message = format!("not XML: <{outer}> is never closed");
            let help = format!("add </{outer}> before the next <{name}>");
            report.error("U003", self.elements[part].tag.clone(), message, help);
            self.unmatched = true;
            self.open.truncate(2);
            return;
        }
        let holds = HARDWARE.contains(&outer);
        let begins = self.elements[around].tag.start;
        let ends = self.apart.contains(&outer) || self.unclosed.contains(&begins) && !holds;
        if !(ends && self.apart.contains(&name)) {
            return;
        }
        // Each is a fault of its own.
        if self.told != Some(begins) {
            let message = format!("not XML: <{outer}> is never closed");
            let help = format!("add </{outer}> before the next <{name}>");
            report.error("U003", self.elements[around].tag.clone(), message, help);
        }
        self.unmatched = true;
        self.open.truncate(1);
    }

    fn end(&mut self, report: &mut Report) -> Option<Document<'t>> {
        if let Some(&last) = self.open.last()
            && !self.unmatched
        {
            let element = &self.elements[last];
            let name = &self.text[element.name.clone()];
            report.error(
                "U003",
                element.tag.clone(),
                format!("not XML: <{name}> is never closed"),
                format!("add </{name}>; is the file complete?"),
            );
            self.unmatched = true;
        }
        if self.elements.is_empty() {
            let what = if self.text.trim().is_empty() {
                "the file is empty"
            } else {
                "not XML: there is no element"
            };
            if !report.has_errors() {
                report.error("U003", 0..0, what, self.beginning());
            }
            return None;
        }
        Some(Document {
            text: self.text,
            elements: std::mem::take(&mut self.elements),
        })
    }

    fn content(&mut self, at: Range<usize>, report: &mut Report) {
        if at.is_empty() {
            return;
        }
        if let Some(&parent) = self.open.last() {
            self.elements[parent].content.push(at);
            return;
        }
        let text = &self.text[at.clone()];
        let blank = |c: char| c.is_whitespace() || is_forbidden(c) || c == '\u{feff}';
        let solid = text.trim_matches(blank);
        if !solid.is_empty() {
            if std::mem::replace(&mut self.unmatched, true) {
                return;
            }
            let from = at.start + text.find(solid).unwrap_or(0);
            let what = "not XML: text outside the root element";
            let help = "a URDF is one <robot> element; remove the text or make it a comment";
            report.error("U003", from..from + solid.len(), what, help);
            return;
        }
        if let Some(found) = text.find(is_forbidden) {
            let found = at.start + found;
            let code = self.text[found..]
                .chars()
                .next()
                .map_or_else(String::new, code);
            report.warning(
                "U008",
                found..found + 1,
                format!("a control character, {code}, outside the root element"),
                "remove it: strict XML readers refuse the file",
            );
        }
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
            if !std::mem::replace(&mut self.unmatched, true) {
                report.error(
                    "U003",
                    at,
                    "not XML: a second root element",
                    "a URDF is one <robot> element; put one robot into a file",
                );
                self.over = true;
                return Some(());
            }
            // The root ended too early.
            self.open.push(0);
        }
        self.part(&self.text[name.clone()], report);
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
        let cut = self.resume.map(|end| at.start..end);
        let empty = match &cut {
            Some(at) => self.text[at.clone()].trim_end().ends_with("/>"),
            None => empty,
        };
        let at = cut.unwrap_or(at);
        self.push(name, at, attributes, empty);
        Some(())
    }

    /// Goes on behind what is no tag: with the element that it may be meant as.
    fn broken(&mut self, start: usize, report: &mut Report) -> Option<()> {
        let text = &self.text[start..];
        let next = text.get(1..).and_then(|rest| rest.find('<'));
        let end = next.map_or(self.text.len(), |next| start + 1 + next);
        self.resume = Some(end);
        let name = text.get(1..).unwrap_or_default();
        let name = name.split(|c: char| !(c.is_alphanumeric() || "_-:.".contains(c)));
        let name = name.into_iter().next().unwrap_or_default();
        if name.is_empty() || !text.starts_with('<') {
            // A comment that does not end, or the like.
            (self.over, self.unmatched) = (next.is_none(), true);
            return Some(());
        }
        if self.open.len() >= DEEPEST || self.elements.len() >= MOST_ELEMENTS {
            return None;
        }
        if self.open.is_empty() && self.closed {
            self.over = true;
            return Some(());
        }
        self.part(name, report);
        let at = start..end;
        let attributes = self.meant(start + 1 + name.len()..end);
        let empty = self.text[at.clone()].trim_end().ends_with("/>");
        self.push(start + 1..start + 1 + name.len(), at, attributes, empty);
        if next.is_none() {
            (self.over, self.unmatched) = (true, true);
        }
        Some(())
    }

    /// Attributes as they may be meant in what is not written as such.
    fn meant(&self, within: Range<usize>) -> Vec<Attribute> {
        let mut list: Vec<Attribute> = Vec::new();
        let text = &self.text[..within.end];
        let mut at = within.start;
        while list.len() < MOST_ATTRIBUTES {
            let rest = &text[at..];
            let space = rest.len() - rest.trim_start().len();
            let start = at + space;
            let rest = &text[start..];
            let ends = |c: char| c.is_whitespace() || "=>/".contains(c);
            let length = rest.find(ends).unwrap_or(rest.len());
            let behind = rest[length..].trim_start();
            let Some(value) = behind.strip_prefix('=').map(str::trim_start) else {
                let step = length.max(1);
                if rest.len() <= step || !text.is_char_boundary(start + step) {
                    return list;
                }
                at = start + step;
                continue;
            };
            let from = text.len() - value.len();
            let quote = value.chars().next().filter(|c| "'\"".contains(*c));
            let inner = &value[quote.map_or(0, char::len_utf8)..];
            let from = from + (value.len() - inner.len());
            let closed = quote.and_then(|quote| inner.find(quote));
            let open = || {
                let plain = |c: char| c == '>' || quote.is_none() && c.is_whitespace();
                let end = inner.find(plain).unwrap_or(inner.len());
                inner[..end].trim_end_matches('/').len()
            };
            let length_of_value = closed.unwrap_or_else(open);
            let name = start..start + length;
            let range = from..from + length_of_value;
            let known = |a: &Attribute| self.text[a.name.clone()] == self.text[name.clone()];
            if length > 0 && !list.iter().any(known) {
                let raw = &self.text[range.clone()];
                let value = escape::unescape(raw).map_or(raw.into(), |value| value);
                list.push(Attribute {
                    name,
                    at: range.clone(),
                    value: value.into_owned(),
                });
            }
            at = (range.end + usize::from(closed.is_some())).min(text.len());
            if at >= text.len() || at <= start {
                return list;
            }
        }
        list
    }

    fn push(
        &mut self,
        name: Range<usize>,
        at: Range<usize>,
        attributes: Vec<Attribute>,
        empty: bool,
    ) {
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
    }

    fn attributes(
        &mut self,
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
                    let typeset = |c: char| "“”„‟«»‘’‚".contains(c);
                    let help = if self.text[at.clone()].contains(typeset) {
                        "XML takes \" and ', not the quotation marks of texts, such as “ and ”"
                    } else if self.text[at.clone()].contains("<!--") {
                        "a comment within a tag is none: write it before the tag"
                    } else {
                        "an attribute is written name=\"value\", once per element"
                    };
                    report.error("U003", from..from + 1, format!("not XML: {what}"), help);
                    // A quotation mark that is missing takes in the tags behind it.
                    let behind = name_start..at.end;
                    let next = self.text[behind].find('<').map(|next| name_start + next);
                    self.resume = next;
                    let end = next.unwrap_or(at.end);
                    let name = tag.name().as_ref().len();
                    return Some(self.meant((name_start + name).min(end)..end));
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
                    let mut help = "write '&' as &amp; and '<' as &lt;";
                    let message = match error {
                        EscapeError::UnterminatedEntity(_) => {
                            "not XML: '&' begins an entity, and no ';' ends it".to_owned()
                        }
                        EscapeError::UnrecognizedEntity(_, name) => {
                            help = "write the character itself: XML has &amp;, &lt;, &gt;, &quot;, \
                                    &apos; and numbers such as &#160; alone";
                            format!("not XML: there is no entity &{name};")
                        }
                        other => format!("not XML: {other}"),
                    };
                    if !self.declared {
                        report.error("U003", value.clone(), message, help);
                    }
                    let raw = self.text[value.clone()].to_owned();
                    list.push(Attribute {
                        name,
                        at: value,
                        value: raw,
                    });
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

    fn malformed(text: &str, error: &Error, at: usize, end: usize, report: &mut Report) {
        let help = match error {
            Error::Syntax(
                SyntaxError::UnclosedSingleQuotedAttributeValue
                | SyntaxError::UnclosedDoubleQuotedAttributeValue,
            ) => "a quotation mark is missing here or before; or is the file cut off?",
            Error::Syntax(_) => "is the file complete?",
            _ => "",
        };
        let open = matches!(error, Error::Syntax(SyntaxError::UnclosedComment));
        let inside = open.then(|| text.get(at..)).flatten();
        let meant = inside.and_then(|inside| comments::advice(inside, at, report));
        let help = meant.unwrap_or_else(|| help.to_owned());
        report.error("U003", at..end.max(at), format!("not XML: {error}"), help);
    }
}

/// Names of ends are compared by the builder, which goes on where they differ.
fn reader(text: &str) -> Reader<&[u8]> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    reader.config_mut().allow_unmatched_ends = true;
    reader
}

/// Whether a name is another one with a slip.
fn alike(name: &str, other: &str) -> bool {
    strsim::osa_distance(name, other) <= 2
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

/// The first line of a text that neither begins with a tag nor has a robot further down. What looks
/// like tags in such a text, as in a page of Markdown, says nothing about a robot.
fn other_text(text: &str) -> Option<Range<usize>> {
    let blank = |c: char| c.is_whitespace() || c == '\0' || c == '\u{feff}';
    let solid = text.trim_start_matches(blank);
    let robot = |line: &str| ["<robot", "<?xml"].iter().any(|tag| line.starts_with(tag));
    if solid.is_empty() || solid.starts_with('<') || solid.lines().any(|l| robot(l.trim_start())) {
        return None;
    }
    let start = text.len() - solid.len();
    let line = solid.lines().next().unwrap_or_default().trim_end();
    Some(start..start + line.len())
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
    fn a_text_of_another_kind_is_one_finding() {
        let page = "\n# A page\n\nAn <b>old</i> & <img src=x> tag, `<link name=...>`.\n</p>\n";
        for text in [
            page,
            "{\"a\": \"<b\"}",
            "[solver]\nx = '<a'",
            "\u{feff}a <b> & c",
        ] {
            let mut report = Report::new("t", text);
            assert!(Document::parse_rest(text, &mut report).is_none());
            let found = report.finish();
            assert_eq!(found.len(), 1, "{text}: {found:?}");
            assert!(found[0].code == "U003" && found[0].message.contains("begins with text"));
            let help = found[0].help.as_deref().unwrap_or_default();
            assert!(help.contains("<robot name") && help.lines().count() == 1);
        }
        assert_eq!(problem(page), "U003 2:1");
        // A robot that text stands before is still read as far as possible.
        let text = "wrapped:\n<robot name='r'><link name=a/></robot>";
        let mut report = Report::new("t", text);
        assert!(Document::parse_rest(text, &mut report).is_some());
        assert_eq!(report.finish().len(), 2);
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
