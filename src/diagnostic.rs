//! Findings with their place in the file, and how they are printed.
//!
//! Codes are stable; a number is never given a second meaning:
//!
//! | code | about |
//! |---|---|
//! | U001–U009 | the file: reading, encoding, XML, xacro |
//! | U010–U029 | the tree: links, joints, names, tags |
//! | U030–U039 | numbers |
//! | U040–U059 | joints |
//! | U060–U069 | mass and inertia |
//! | U070–U079 | shapes and surfaces |
//! | U100–U119 | meshes |

pub mod angles;
pub mod codes;
pub mod gravity;
pub mod words;

pub use words::nearest;

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// An assumption that was taken.
    Note,
    /// Legal but suspicious.
    Warning,
    /// Stops the export.
    Error,
}

/// A finding with its place.
///
/// `Display` prints it with the marked line, over several lines and without a line end.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad.
    pub severity: Severity,
    /// Stable code, such as `U104`.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// File, 1-based line and column, length of the marked text; none for findings without a place.
    pub place: Option<Place>,
}

/// Where in a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// File name as given.
    pub file: String,
    /// 1-based.
    pub line: usize,
    /// 1-based, in characters.
    pub column: usize,
    /// Characters marked.
    pub length: usize,
    /// The whole line, for display.
    pub text: String,
}

/// Lines longer than this, in bytes, are not kept for display: a hundred findings in a file that is
/// one long line must not take a hundred times its size.
const LONGEST_LINE: usize = 100_000;

/// Characters of a long line that are shown around the mark.
const SHOWN: usize = 100;

impl Place {
    /// The place of `range` (bytes) in `text`; a range over several lines marks the rest of the
    /// first.
    pub fn in_text(file: &str, text: &str, range: Range<usize>) -> Self {
        let start = floor_char(text, range.start);
        let end = floor_char(text, range.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let line = text[line_start..line_end].trim_end_matches('\r');
        Self {
            file: file.to_owned(),
            line: text[..line_start].bytes().filter(|&b| b == b'\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            length: text[start..end.min(line_end)].chars().count().max(1),
            text: if line.len() <= LONGEST_LINE {
                line.to_owned()
            } else {
                String::new()
            },
        }
    }
}

/// The nearest character boundary at or before `at`.
fn floor_char(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]: {}", self.severity, self.code, self.message)?;
        if let Some(place) = &self.place {
            let number = place.line.to_string();
            let margin = " ".repeat(number.len());
            write!(
                f,
                "\n{margin}╭─[{}:{}:{}]",
                place.file, place.line, place.column
            )?;
            if !place.text.is_empty() {
                let (line, mark) = excerpt(place);
                write!(f, "\n{number}│ {line}")?;
                write!(f, "\n{margin}│ {mark}")?;
            }
        }
        if let Some(help) = &self.help {
            for (i, line) in help.lines().enumerate() {
                let lead = if i == 0 { "help:" } else { "     " };
                write!(f, "\n  {lead} {line}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

/// The shown part of the line, and the line of marks below it. Tabs and control characters become
/// spaces so that the marks stay below the marked text.
fn excerpt(place: &Place) -> (String, String) {
    let characters: Vec<char> = place.text.chars().collect();
    let mark = (place.column - 1).min(characters.len());
    let from = if characters.len() <= SHOWN {
        0
    } else {
        mark.saturating_sub(SHOWN / 4)
    };
    let to = characters.len().min(from + SHOWN);
    let mut line = String::new();
    let mut marks = String::new();
    if from > 0 {
        line.push('…');
        marks.push(' ');
    }
    for (i, &c) in characters[from..to].iter().enumerate() {
        line.push(if c.is_control() { ' ' } else { c });
        if from + i < mark {
            marks.push(' ');
        }
    }
    if to < characters.len() {
        line.push('…');
    }
    marks.push_str(&"^".repeat(place.length.min((to - mark).max(1))));
    (line, marks)
}

/// So many findings that differ in their link or joint alone are told one by one; of more the first
/// tells their number. A name that is misspelt in two places is mended in both, but what a program
/// writes into each joint fills the screen and hides what matters.
pub(crate) const TOLD: usize = 3;

/// What findings have in common that differ in their link or joint alone: the kind of that, code,
/// message and help.
type Alike = (String, &'static str, String, String);

/// What follows the message of the first of so many findings that are alike.
pub(crate) fn times(count: usize) -> String {
    match count {
        ..2 => String::new(),
        _ => format!(" ({count} times, first here)"),
    }
}

/// After this many errors the rest of a file is noise.
const MOST_ERRORS: usize = 100;

/// Collects the findings of one file.
pub(crate) struct Report<'a> {
    file: &'a str,
    text: &'a str,
    /// Where each line starts, once someone asks: meshes have many lines and hardly any findings.
    lines: OnceCell<Vec<usize>>,
    list: Vec<Diagnostic>,
    /// How many findings are alike, and which of them are listed.
    alike: BTreeMap<Alike, (usize, Vec<usize>)>,
    /// Errors not listed for want of room.
    more: usize,
}

impl<'a> Report<'a> {
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            lines: OnceCell::new(),
            list: Vec::new(),
            alike: BTreeMap::new(),
            more: 0,
        }
    }

    pub(crate) fn error(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(Severity::Error, code, at, message.into(), help.into());
    }

    pub(crate) fn warning(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(Severity::Warning, code, at, message.into(), help.into());
    }

    pub(crate) fn note(
        &mut self,
        code: &'static str,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(Severity::Note, code, at, message.into(), help.into());
    }

    /// A warning or a note about `owner`, such as `joint 'elbow'`. Many that say the same of others
    /// of its kind become one.
    pub(crate) fn about(
        &mut self,
        owner: &str,
        severity: Severity,
        code: &'static str,
        at: Range<usize>,
        message: &str,
        help: String,
    ) {
        let kind = owner.split('\'').next().unwrap_or_default().to_owned();
        let alike = (kind, code, message.to_owned(), help.clone());
        let room = self.has_room(severity);
        let (count, listed) = self.alike.entry(alike).or_default();
        *count += 1;
        if *count > TOLD {
            return;
        }
        // Where there is no room, what comes to this place next is another finding.
        if room {
            listed.push(self.list.len());
        }
        self.add(severity, code, at, format!("{owner}: {message}"), help);
    }

    /// Whether one more finding is listed.
    fn has_room(&self, severity: Severity) -> bool {
        let same = |d: &&Diagnostic| d.severity == severity;
        self.list.iter().filter(same).count() < MOST_ERRORS
    }

    /// Makes one of many findings that are alike.
    fn gather(&mut self) {
        let mut spare = BTreeSet::new();
        for (count, listed) in std::mem::take(&mut self.alike).into_values() {
            let line = |index: &usize| self.list[*index].place.as_ref().map(|place| place.line);
            let Some(&first) = listed.iter().min_by_key(|&index| line(index)) else {
                continue;
            };
            if count > TOLD {
                self.list[first].message.push_str(&times(count));
                spare.extend(listed.into_iter().filter(|&index| index != first));
            }
        }
        let mut index = 0..;
        self.list
            .retain(|_| index.next().is_none_or(|i| !spare.contains(&i)));
    }

    /// The place of a part of the text.
    pub(crate) fn place(&self, at: Range<usize>) -> Place {
        Place::in_text(self.file, self.text, at)
    }

    /// 1-based line of a byte.
    pub(crate) fn line(&self, at: usize) -> usize {
        let ends = || self.text.match_indices('\n').map(|(end, _)| end + 1);
        let lines = || std::iter::once(0).chain(ends()).collect::<Vec<_>>();
        let lines = self.lines.get_or_init(lines);
        lines.partition_point(|&start| start <= at)
    }

    /// An empty `help` means none.
    pub(crate) fn add(
        &mut self,
        severity: Severity,
        code: &'static str,
        at: Range<usize>,
        message: String,
        help: String,
    ) {
        if !self.has_room(severity) {
            self.more += usize::from(severity == Severity::Error);
            return;
        }
        // What a file says may be of any length.
        let (message, help) = (cut(message, 1_000), cut(help, 10_000));
        self.list.push(Diagnostic {
            severity,
            code,
            message,
            help: (!help.is_empty()).then_some(help),
            place: Some(Place::in_text(self.file, self.text, at)),
        });
    }

    /// Forgets all findings.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.alike.clear();
        self.more = 0;
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// Findings in file order.
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.gather();
        self.list.sort_by_key(|d| {
            d.place
                .as_ref()
                .map_or((0, 0), |place| (place.line, place.column))
        });
        if self.more > 0 {
            self.list.push(Diagnostic {
                severity: Severity::Error,
                code: "U001",
                message: format!("{} more errors are not listed", self.more),
                help: None,
                place: None,
            });
        }
        self.list
    }
}

/// The text, or its first `most` bytes or so and an ellipsis.
fn cut(mut text: String, most: usize) -> String {
    if text.len() > most {
        text.truncate(floor_char(&text, most));
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(text: &str, marked: &str) -> Diagnostic {
        let at = text.find(marked).expect("marked text");
        Diagnostic {
            severity: Severity::Error,
            code: "U104",
            message: "mesh not found".to_owned(),
            help: Some("tried a\ntried b".to_owned()),
            place: Some(Place::in_text("a.urdf", text, at..at + marked.len())),
        }
    }

    #[test]
    fn display_marks_the_text_below_the_line() {
        let text = "<robot>\n\t<mesh filename=\"ä/x.stl\"/>\r\n</robot>";
        let expected = "error[U104]: mesh not found\n \
                        ╭─[a.urdf:2:18]\n\
                        2│  <mesh filename=\"ä/x.stl\"/>\n \
                        │                  ^^^^^^^\n  \
                        help: tried a\n        tried b";
        assert_eq!(finding(text, "ä/x.stl").to_string(), expected);
    }

    #[test]
    fn what_differs_in_its_link_or_joint_alone_is_told_once() {
        let text = "a\nb\nc\nd\ne\nf\n";
        let said = |count: usize, owner: &str| -> Vec<String> {
            let mut report = Report::new("f", text);
            for i in 0..count {
                let owner = format!("{owner} '{i}'");
                let at = 2 * (count - 1 - i)..2 * (count - i) - 1;
                let message = "<limit> attribute 'x' is unknown";
                report.about(
                    &owner,
                    Severity::Warning,
                    "U019",
                    at,
                    message,
                    String::new(),
                );
            }
            report.warning("U019", 10..11, "joint '9': another", "");
            report.finish().into_iter().map(|d| d.message).collect()
        };
        let few = said(TOLD, "joint");
        assert_eq!(few.len(), TOLD + 1, "{few:?}");
        assert!(few.iter().all(|message| !message.contains("times")));
        let many = said(TOLD + 2, "joint");
        assert_eq!(many.len(), 2, "{many:?}");
        assert!(
            many[0].ends_with("is unknown (5 times, first here)"),
            "{many:?}"
        );
        assert_eq!(many[1], "joint '9': another");
    }

    /// Of the warnings there is no room for more, but of the errors: these were taken for warnings
    /// that are alike, and two of three left out.
    #[test]
    fn errors_behind_more_warnings_than_are_listed_are_all_told() {
        let mut report = Report::new("f", "a");
        for i in 0..MOST_ERRORS {
            report.warning("U020", 0..1, format!("{i}"), "");
        }
        for i in 0..=TOLD {
            let (owner, help) = (format!("joint '{i}'"), String::new());
            report.about(&owner, Severity::Warning, "U019", 0..1, "unknown", help);
            report.error("U015", 0..1, format!("error {i}"), "");
        }
        let list = report.finish().into_iter();
        let errors = list.filter(|finding| finding.severity == Severity::Error);
        let told: Vec<String> = errors.map(|finding| finding.message).collect();
        assert_eq!(told, ["error 0", "error 1", "error 2", "error 3"]);
    }

    #[test]
    fn a_long_line_is_shown_around_the_mark() {
        let text = format!("{}HERE{}", "a".repeat(5000), "b".repeat(5000));
        let shown = finding(&text, "HERE").to_string();
        assert!(shown.contains("[a.urdf:1:5001]"), "{shown}");
        let lines: Vec<&str> = shown.lines().collect();
        assert!(lines[2].chars().count() < 120, "{shown}");
        // Both lines count from the same margin.
        let at = lines[2].chars().position(|c| c == 'H');
        assert_eq!(at, lines[3].chars().position(|c| c == '^'), "{shown}");
    }

    #[test]
    fn a_mark_past_the_end_or_inside_a_character_is_moved_not_a_panic() {
        let text = "ä\nö";
        for start in 0..8 {
            for end in 0..8 {
                let place = Place::in_text("f", text, start..end);
                let finding = Diagnostic {
                    severity: Severity::Note,
                    code: "U001",
                    message: String::new(),
                    help: None,
                    place: Some(place),
                };
                assert!(finding.to_string().contains("[f:"));
            }
        }
    }
}
