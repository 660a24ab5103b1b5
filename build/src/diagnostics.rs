//! Findings for people, with the marked line of the file and advice, or as JSON.

use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::IsTerminal;
use urdf2fmu_core::diagnostic::{Diagnostic, Place, Severity};
use urdf2fmu_core::urdf::Description;
use urdf2fmu_core::variables::TableError;

/// Whether to colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    color: bool,
}

impl Style {
    /// No colours.
    #[cfg(test)]
    pub const PLAIN: Self = Self { color: false };

    /// Colours where standard error is a terminal and `NO_COLOR` is not set.
    pub fn of_stderr() -> Self {
        Self::of(std::io::stderr().is_terminal())
    }

    /// The same for standard output.
    pub fn of_stdout() -> Self {
        Self::of(std::io::stdout().is_terminal())
    }

    fn of(terminal: bool) -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        Self {
            color: terminal && !refused,
        }
    }

    /// Whether to colour.
    pub fn color(self) -> bool {
        self.color
    }

    fn paint(self, code: &str, text: &str) -> String {
        if self.color {
            format!("\x1b[{code}m{text}\x1b[0m")
        } else {
            text.to_owned()
        }
    }
}

/// The word for a severity.
pub fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

/// A finding as text, with a newline at its end:
///
/// ```text
/// error[U104]: mesh not found
///   ╭─[panda.urdf:42:24]
/// 42│   <mesh filename="package://franka/link1.stl"/>
///   ·                  ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
///   help: tried …
/// ```
pub fn render(finding: &Diagnostic, style: Style) -> String {
    let color = match finding.severity {
        Severity::Error => "1;31",
        Severity::Warning => "1;33",
        Severity::Note => "1;36",
    };
    let head = format!("{}[{}]", word(finding.severity), finding.code);
    let mut text = format!("{}: {}\n", style.paint(color, &head), finding.message);
    let mut indent = 2;
    if let Some(place) = &finding.place {
        let number = place.line.to_string();
        indent = number.len();
        let pad = " ".repeat(indent);
        let bar = style.paint("2", "│");
        _ = writeln!(
            text,
            "{pad}{}[{}:{}:{}]",
            style.paint("2", "╭─"),
            place.file,
            place.line,
            place.column
        );
        let (line, before, marked) = window(&place.text, place.column, place.length);
        if !line.trim().is_empty() {
            _ = writeln!(text, "{}{bar} {line}", style.paint("2", &number));
            let marks = "^".repeat(marked);
            _ = writeln!(
                text,
                "{pad}{} {}{}",
                style.paint("2", "·"),
                " ".repeat(before),
                style.paint(color, &marks)
            );
        }
    }
    if let Some(help) = &finding.help {
        let pad = " ".repeat(indent);
        for (i, line) in help.lines().enumerate() {
            let lead = if i == 0 { "help:" } else { "     " };
            _ = writeln!(text, "{pad}{} {line}", style.paint("1", lead));
        }
    }
    text
}

/// Names that become one, with the place of the second.
pub fn clash(description: &Description, error: &TableError) -> Diagnostic {
    let message = error.to_string();
    let links = description.links.iter().map(|link| (&link.name, &link.tag));
    let joints = description.joints.iter();
    let joints = joints.map(|joint| (&joint.name, &joint.tag));
    // The later of those that the message names.
    let tag = links
        .chain(joints)
        .filter(|(name, tag)| tag.line > 0 && message.contains(&format!("'{name}'")))
        .map(|(_, tag)| &tag.at)
        .max_by_key(|at| at.start);
    let file = description.sources.first();
    let place = tag.zip(file).map(|(at, file)| {
        Place::in_text(&file.display().to_string(), &description.text, at.clone())
    });
    Diagnostic {
        severity: Severity::Error,
        code: "A139",
        message,
        help: Some("names of variables keep letters, digits and _ of the URDF's names".to_owned()),
        place,
    }
}

/// Most characters of a source line that are shown.
const SHOWN: usize = 120;

/// The part of a line around the mark, how many characters stand before the mark in it, and how
/// many are marked.
fn window(line: &str, column: usize, length: usize) -> (String, usize, usize) {
    // A tab or a control character would put the mark elsewhere.
    let characters: Vec<char> = line
        .trim_end()
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    let start = column.saturating_sub(1).min(characters.len());
    let (mut from, mut to) = (0, characters.len());
    let (mut head, mut tail) = ("", "");
    if to > SHOWN {
        from = start.saturating_sub(SHOWN / 3);
        to = (from + SHOWN).min(characters.len());
        head = if from > 0 { "…" } else { "" };
        tail = if to < characters.len() { "…" } else { "" };
    }
    let shown: String = characters[from..to].iter().collect();
    let before = start - from + head.chars().count();
    let marked = length.clamp(1, to.saturating_sub(start).max(1));
    (format!("{head}{shown}{tail}"), before, marked)
}

/// A finding for other programs.
pub fn to_json(finding: &Diagnostic) -> Value {
    json!({
        "severity": word(finding.severity),
        "code": finding.code,
        "message": finding.message,
        "help": finding.help,
        "file": finding.place.as_ref().map(|p| &p.file),
        "line": finding.place.as_ref().map(|p| p.line),
        "column": finding.place.as_ref().map(|p| p.column),
        "length": finding.place.as_ref().map(|p| p.length),
    })
}

/// `1 error, 2 warnings and 3 notes`; none where there is nothing.
pub fn tally(findings: &[Diagnostic]) -> Option<String> {
    let parts: Vec<String> = [Severity::Error, Severity::Warning, Severity::Note]
        .into_iter()
        .filter_map(|severity| {
            let n = findings.iter().filter(|d| d.severity == severity).count();
            let plural = if n == 1 { "" } else { "s" };
            (n > 0).then(|| format!("{n} {}{plural}", word(severity)))
        })
        .collect();
    match parts.as_slice() {
        [] => None,
        [one] => Some(one.clone()),
        [most @ .., last] => Some(format!("{} and {last}", most.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use urdf2fmu_core::diagnostic::Place;

    fn finding() -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code: "U104",
            message: "mesh not found".to_owned(),
            help: Some("tried a\npass --package-path DIR".to_owned()),
            place: Some(Place {
                file: "panda.urdf".to_owned(),
                line: 42,
                column: 9,
                length: 8,
                text: "  <mesh filename='x'/>".to_owned(),
            }),
        }
    }

    #[test]
    fn finding_marks_its_place_in_the_line() {
        let text = render(&finding(), Style::PLAIN);
        let expected = "error[U104]: mesh not found\n  ╭─[panda.urdf:42:9]\n42│   <mesh filename='x'/>\n  \
                        ·         ^^^^^^^^\n  help: tried a\n        pass --package-path DIR\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn mark_stays_under_its_text_in_a_very_long_line() {
        let mut finding = finding();
        if let Some(place) = &mut finding.place {
            place.text = format!("{}BROKEN{}", "a".repeat(500), "b".repeat(500));
            place.column = 501;
            place.length = 6;
        }
        let text = render(&finding, Style::PLAIN);
        let lines: Vec<_> = text.lines().collect();
        let (source, marks) = (lines[2], lines[3]);
        let at = source.chars().position(|c| c == 'B');
        assert_eq!(at, marks.chars().position(|c| c == '^'));
        assert!(source.chars().count() < 130);
    }

    #[test]
    fn mark_ends_where_the_shown_part_of_its_line_ends() {
        let mut finding = finding();
        if let Some(place) = &mut finding.place {
            place.text = "x".repeat(1000);
            place.column = 11;
            place.length = 900;
        }
        let text = render(&finding, Style::PLAIN);
        let lines: Vec<_> = text.lines().collect();
        // The last character shown is the ellipsis.
        assert_eq!(lines[3].chars().count(), lines[2].chars().count() - 1);
    }

    #[test]
    fn a_place_beyond_the_line_does_not_panic() {
        let mut finding = finding();
        if let Some(place) = &mut finding.place {
            place.column = 999;
            place.length = 999;
        }
        assert!(render(&finding, Style::PLAIN).contains('^'));
    }

    #[test]
    fn tally_counts_by_severity_and_spells_plurals() {
        let one = finding();
        let warning = Diagnostic {
            severity: Severity::Warning,
            ..finding()
        };
        assert_eq!(tally(&[]), None);
        assert_eq!(
            tally(std::slice::from_ref(&one)).as_deref(),
            Some("1 error")
        );
        assert_eq!(
            tally(&[warning.clone(), one, warning]).as_deref(),
            Some("1 error and 2 warnings")
        );
    }
}
