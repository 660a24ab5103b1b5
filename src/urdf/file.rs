//! A file of text, or why it is none.

use crate::diagnostic::words::instead_of;
use crate::diagnostic::{Diagnostic, Place, Severity};
use crate::encoding::{NoText, xml_replaced, xml_text};
use crate::reading::{self, LARGEST_TEXT};
use std::io::ErrorKind;
use std::path::Path;

/// The text of a file that another one names; what fits no letter in it is replaced.
pub(super) fn lossy_text(path: &Path) -> Option<String> {
    reading::read(path, LARGEST_TEXT).ok().map(xml_replaced)
}

/// What a file is that begins like none of XML in UTF-8, and what to do.
fn other_kind(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let begins = |start: &[u8]| bytes.starts_with(start);
    if begins(&[0x1f, 0x8b]) || begins(b"PK\x03\x04") {
        return Some(("the file is compressed", "unpack it first"));
    }
    if begins(b"ISO-10303-21") {
        return Some((
            "the file is a STEP file, not a URDF",
            "let the program for design export a URDF, and its meshes as STL",
        ));
    }
    if begins(b"#usda") || begins(b"PXR-USDC") {
        return Some(("the file is in USD, not a URDF", "convert it to URDF first"));
    }
    let first = &bytes[..bytes.len().min(200)];
    // Encodings of text use a few of them.
    let control = |byte: &&u8| **byte < 32 && !b"\t\n\x0c\r\x1a\x1b\0".contains(byte);
    if first.iter().filter(control).count() > 2 {
        return Some(("the file is binary, not a URDF", "name the URDF file"));
    }
    let text = String::from_utf8_lossy(first)
        .trim_start()
        .to_ascii_lowercase();
    (text.starts_with("<!doctype html") || text.starts_with("<html")).then_some((
        "the file is a web page, not a URDF",
        "fetch the file itself: pages that show files have a link to their raw text",
    ))
}

/// The text of a file.
pub(super) fn text(path: &Path) -> Result<String, Box<Diagnostic>> {
    let problem = |code, message: String, help: &str| {
        Box::new(Diagnostic {
            severity: Severity::Error,
            code,
            message,
            help: (!help.is_empty()).then(|| help.to_owned()),
            place: None,
        })
    };
    let name = path.display();
    let io = |error: std::io::Error| {
        let message = format!("{name} cannot be read: {error}");
        let help = match error.kind() {
            ErrorKind::FileTooLarge => "no URDF is that large: is it the right file?".to_owned(),
            _ => instead_of(path, &error),
        };
        problem("U001", message, &help)
    };
    if reading::waiting(path) == Some("a folder") {
        let message = format!("{name} is a folder");
        return Err(problem("U001", message, "name the URDF file in it"));
    }
    let bytes = reading::read(path, LARGEST_TEXT).map_err(io)?;
    if let Some((what, help)) = other_kind(&bytes) {
        let mut finding = problem("U002", what.to_owned(), help);
        let shown = String::from_utf8_lossy(&bytes);
        finding.place = Some(Place::in_text(&name.to_string(), &shown, 0..1));
        return Err(finding);
    }
    xml_text(bytes).map_err(|refused| {
        let NoText { bytes, at, .. } = refused;
        let message = format!("the file is not UTF-8 text: byte 0x{:02x}", bytes[at]);
        let help = match refused.declared {
            Some(encoding) => format!("save the file as UTF-8; it says that it is {encoding}"),
            None => "save the file as UTF-8, or let it say what it is, such as <?xml \
                     version=\"1.0\" encoding=\"windows-1252\"?> in its first line"
                .to_owned(),
        };
        let shown = String::from_utf8_lossy(&bytes);
        // What stands before the bad byte is the same in both.
        let mut finding = problem("U002", message, &help);
        finding.place = Some(Place::in_text(&name.to_string(), &shown, at..at + 1));
        finding
    })
}
