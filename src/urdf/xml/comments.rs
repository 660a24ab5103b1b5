//! Where a comment that does not end may be meant to.

use crate::diagnostic::Report;

/// Advice on a comment whose `-->` is missing, where a line of it ends with what may be meant:
/// `->`, `-- >`, `--` or a dash of typography before the `>`.
///
/// - `text`: of the comment
/// - `start`: where that is in the file
pub(super) fn advice(text: &str, start: usize, report: &Report) -> Option<String> {
    let mut at = start;
    for line in text.split_inclusive('\n') {
        let plain = line.trim_end();
        let before = plain.strip_suffix('>').map(str::trim_end);
        let dash = |before: &str| before.ends_with(['-', '\u{2013}', '\u{2014}']);
        if before.is_some_and(dash) && !plain.ends_with("-->") {
            let words = plain.split_whitespace().rev().take(2);
            let mut words: Vec<&str> = words.collect();
            words.retain(|word| !word.chars().any(char::is_alphanumeric));
            words.reverse();
            let end = words.join(" ");
            let line = report.line(at);
            return Some(format!(
                "a comment ends with -->: write that for the '{end}' of line {line}, if it is meant"
            ));
        }
        at += line.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::Report;
    use crate::urdf::xml::Document;

    /// The advice on the first fault.
    fn help(text: &str) -> String {
        let mut report = Report::new("t", text);
        let _ = Document::parse(text, &mut report);
        let found = report.finish().into_iter().next();
        found.and_then(|found| found.help).unwrap_or_default()
    }

    #[test]
    fn an_end_of_a_comment_with_a_slip_is_told_with_its_line() {
        for end in ["->", "-- >", "\u{2014}>", "- >"] {
            let open = format!("<a>\n <!-- one -> two\n three {end}\n <b/>\n");
            let told = format!("write that for the '{end}' of line 3, if it is meant");
            let cut = help(&format!("{open}</a>"));
            assert!(cut.contains(&told), "{cut}");
            let next = help(&format!("{open} <!-- four -->\n</a>"));
            assert!(next.contains(&told), "{next}");
        }
        // No end, or one comment within another.
        assert_eq!(help("<a>\n <!-- one -> two\n</a>"), "is the file complete?");
        let inner = help("<a>\n <!-- <b/> <!-- two -->\n <c/> -->\n</a>");
        assert!(inner.contains("remove the inner <!--"), "{inner}");
    }
}
