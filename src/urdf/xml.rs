//! XML text → a tree with the place of every element and attribute.
//!
//! Namespaces are not resolved; a prefix is part of the name. The tree is built by `build`.

mod build;
mod comments;

use quick_xml::escape;
use std::borrow::Cow;
use std::ops::Range;

/// Tags of hardware, whose `<joint>` names a joint and does not describe one: one that begins in
/// them does not show that they are not closed.
pub const HARDWARE: [&str; 2] = ["transmission", "ros2_control"];

/// A tree of elements over the text that it was read from. Element 0 is the root.
pub(super) struct Document<'t> {
    text: &'t str,
    elements: Vec<Element>,
}

struct Element {
    name: Range<usize>,
    /// The start tag with its brackets.
    tag: Range<usize>,
    attributes: Vec<Attribute>,
    children: Vec<usize>,
    content: Vec<Range<usize>>,
}

/// An attribute and where it stands.
pub(super) struct Attribute {
    name: Range<usize>,
    /// The value between its quotes.
    pub(super) at: Range<usize>,
    /// The value with its entities resolved.
    pub(super) value: String,
}

/// An element of a document.
#[derive(Clone, Copy)]
pub(super) struct Node<'d> {
    document: &'d Document<'d>,
    index: usize,
}

impl Document<'_> {
    /// All of it, with comments.
    pub(super) fn text(&self) -> &str {
        self.text
    }

    pub(super) fn root(&self) -> Node<'_> {
        Node {
            document: self,
            index: 0,
        }
    }
}

impl<'d> Node<'d> {
    fn element(self) -> &'d Element {
        &self.document.elements[self.index]
    }

    pub(super) fn name(self) -> &'d str {
        &self.document.text[self.element().name.clone()]
    }

    /// The name without its prefix.
    pub(super) fn local_name(self) -> &'d str {
        let name = self.name();
        name.rsplit_once(':').map_or(name, |(_, local)| local)
    }

    /// Where the name stands in the start tag.
    pub(super) fn name_at(self) -> Range<usize> {
        self.element().name.clone()
    }

    /// Where the start tag stands.
    pub(super) fn tag_at(self) -> Range<usize> {
        self.element().tag.clone()
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'d Attribute> {
        self.element()
            .attributes
            .iter()
            .find(|a| &self.document.text[a.name.clone()] == name)
    }

    /// The value of an attribute.
    pub(super) fn value(self, name: &str) -> Option<&'d str> {
        self.attribute(name).map(|a| a.value.as_str())
    }

    /// Names of the attributes and where they stand.
    pub(super) fn attribute_names(self) -> impl Iterator<Item = (&'d str, Range<usize>)> {
        self.element()
            .attributes
            .iter()
            .map(move |a| (&self.document.text[a.name.clone()], a.name.clone()))
    }

    pub(super) fn children(self) -> impl Iterator<Item = Node<'d>> {
        self.element().children.iter().map(move |&index| Node {
            document: self.document,
            index,
        })
    }

    pub(super) fn children_named(self, name: &'static str) -> impl Iterator<Item = Node<'d>> {
        self.children().filter(move |c| c.name() == name)
    }

    pub(super) fn child(self, name: &'static str) -> Option<Node<'d>> {
        self.children_named(name).next()
    }

    /// The element's own text, not that of its children.
    pub(super) fn content(self) -> Cow<'d, str> {
        let text = self.document.text;
        let raw = match self.element().content.as_slice() {
            [] => return Cow::Borrowed(""),
            [one] => Cow::Borrowed(&text[one.clone()]),
            several => Cow::Owned(several.iter().map(|r| &text[r.clone()]).collect()),
        };
        if !raw.contains('&') {
            return raw;
        }
        match escape::unescape(&raw) {
            Ok(resolved) => Cow::Owned(resolved.into_owned()),
            Err(_) => raw,
        }
    }

    /// Where the element's text stands; the start tag if it has none.
    pub(super) fn content_at(self) -> Range<usize> {
        self.element()
            .content
            .first()
            .cloned()
            .unwrap_or_else(|| self.tag_at())
    }

    /// The first part of the element's own text that is not blank, and where it stands.
    pub(super) fn first_text(self) -> Option<(&'d str, Range<usize>)> {
        self.element().content.iter().find_map(|part| {
            let text = &self.document.text[part.clone()];
            let solid = text.trim_matches(|c: char| c.is_whitespace() && !is_forbidden(c));
            let start = part.start + text.find(solid)?;
            (!solid.is_empty()).then_some((solid, start..start + solid.len()))
        })
    }

    /// Whether what begins here is the text of a `<![CDATA[…]]>`.
    pub(super) fn is_cdata(self, start: usize) -> bool {
        self.document.text[..start]
            .trim_end()
            .ends_with("<![CDATA[")
    }

    /// Whether two elements without children have the same attributes.
    pub(super) fn same_as(self, other: Self) -> bool {
        let attributes = |node: Self| {
            let mut list: Vec<(&str, &str)> = node
                .element()
                .attributes
                .iter()
                .map(|a| (&node.document.text[a.name.clone()], a.value.as_str()))
                .collect();
            list.sort_unstable();
            list
        };
        let plain = self.element().children.is_empty() && other.element().children.is_empty();
        plain && attributes(self) == attributes(other)
    }

    /// Every element of the tree below, this one first, in file order.
    pub(super) fn descendants(self) -> impl Iterator<Item = Node<'d>> {
        let mut open = vec![self];
        std::iter::from_fn(move || {
            let next = open.pop()?;
            let below = next.element().children.iter().rev();
            open.extend(below.map(|&index| Node {
                document: next.document,
                index,
            }));
            Some(next)
        })
    }
}

/// Control characters that XML 1.0 has nowhere (2.2).
pub(super) fn is_forbidden(c: char) -> bool {
    c.is_ascii_control() && !matches!(c, '\t' | '\n' | '\r')
}

/// Characters that names must not have: XML forbids most of them, and none of them shows.
pub(super) fn is_unprintable(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}
