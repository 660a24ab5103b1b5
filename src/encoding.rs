//! Bytes of a file to text.
//!
//! Texts are in UTF-8, or in UTF-16 with its mark, as Windows PowerShell writes what `>` redirects
//! and Excel its "Unicode text". In XML its standard says more (XML 1.0, appendix F): UTF-16 is
//! known by the zero beside the first `<`, too, and other encodings are declared. Of those with one
//! byte for each letter the ones of western Europe are read; ISO 8859-1 is taken as Windows-1252,
//! which has letters in place of its controls, as browsers take it.

/// Windows-1252 from 0x80 to 0x9f; the five bytes without a letter stay controls.
const WINDOWS: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Why bytes are no text.
#[derive(Clone, Debug, PartialEq)]
pub struct NoText {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// The first that fits no letter.
    pub at: usize,
    /// The encoding that the file declares, where it is not UTF-8.
    pub declared: Option<String>,
}

/// How two bytes make a number.
type Order = fn([u8; 2]) -> u16;

/// The order of the bytes of UTF-16 that begins with its mark.
fn marked(bytes: &[u8]) -> Option<Order> {
    match *bytes {
        // Four bytes for each letter.
        [0xff, 0xfe, 0, 0, ..] => None,
        [0xff, 0xfe, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

fn wide(bytes: Vec<u8>, number: Order) -> Result<String, NoText> {
    let units = bytes.chunks(2).map(|pair| match *pair {
        [first, second] => number([first, second]),
        // Half a letter at the end.
        _ => 0xd800,
    });
    let mut at = 0;
    let mut text = String::with_capacity(bytes.len() / 2);
    for letter in char::decode_utf16(units) {
        let Ok(letter) = letter else {
            let declared = Some("UTF-16".to_owned());
            return Err(NoText {
                bytes,
                at,
                declared,
            });
        };
        at += 2 * letter.len_utf16();
        text.push(letter);
    }
    Ok(text)
}

/// A text in UTF-8, or in UTF-16 with its mark, which stays in front.
///
/// # Errors
/// [`NoText`] for anything else.
pub fn text(bytes: Vec<u8>) -> Result<String, NoText> {
    if let Some(order) = marked(&bytes) {
        return wide(bytes, order);
    }
    String::from_utf8(bytes).map_err(|error| NoText {
        at: error.utf8_error().valid_up_to(),
        bytes: error.into_bytes(),
        declared: None,
    })
}

/// The text of an XML file.
///
/// # Errors
/// [`NoText`] where its encoding is not read, or is not the one of its bytes.
pub fn xml_text(bytes: Vec<u8>) -> Result<String, NoText> {
    let unmarked: Option<Order> = match *bytes.as_slice() {
        [b'<', 0, _, 0, ..] => Some(u16::from_le_bytes),
        [0, b'<', 0, ..] => Some(u16::from_be_bytes),
        _ => None,
    };
    if let Some(order) = unmarked {
        return wide(bytes, order);
    }
    let NoText { bytes, at, .. } = match text(bytes) {
        Err(refused) if refused.declared.is_none() => refused,
        read => return read,
    };
    let declared = declared_of(&bytes);
    let western = declared.as_deref().is_some_and(|name| {
        let western = [
            "iso-8859-1",
            "iso8859-1",
            "latin1",
            "windows-1252",
            "cp1252",
        ];
        western.contains(&name.to_ascii_lowercase().as_str())
    });
    if !western {
        return Err(NoText {
            bytes,
            at,
            declared,
        });
    }
    let letter = |byte: &u8| match byte {
        0x80..=0x9f => WINDOWS[usize::from(byte - 0x80)],
        other => char::from(*other),
    };
    Ok(bytes.iter().map(letter).collect())
}

/// The same for a file that is searched and not read: what fits no letter is replaced.
pub fn xml_replaced(bytes: Vec<u8>) -> String {
    let replaced = |refused: NoText| String::from_utf8_lossy(&refused.bytes).into_owned();
    xml_text(bytes).unwrap_or_else(replaced)
}

/// The encoding that the XML declaration names, where it is not UTF-8.
fn declared_of(bytes: &[u8]) -> Option<String> {
    let start = bytes.strip_prefix(b"<?xml")?;
    let end = start.iter().position(|byte| *byte == b'>')?;
    let text = std::str::from_utf8(&start[..end]).ok()?;
    let (_, value) = text.split_once("encoding")?;
    let value = value.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let name = value[1..].split(quote).next()?;
    (!name.eq_ignore_ascii_case("utf-8")).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_in_the_encoding_that_xml_declares_are_read() {
        let text = "<?xml version='1.0' encoding=\"UTF-16\"?><robot name='grün — 机'/>";
        let marked = format!("\u{feff}{text}");
        for source in [text, marked.as_str()] {
            let units: Vec<u16> = source.encode_utf16().collect();
            let little: Vec<u8> = units.iter().flat_map(|u| u.to_le_bytes()).collect();
            let big: Vec<u8> = units.iter().flat_map(|u| u.to_be_bytes()).collect();
            assert_eq!(xml_text(little.clone()).as_deref(), Ok(source));
            assert_eq!(xml_text(big).as_deref(), Ok(source));
            assert!(xml_text(little[..little.len() - 1].to_vec()).is_err());
        }
        let mut bytes = b"<?xml version=\"1.0\" encoding='ISO-8859-1' ?><robot name='".to_vec();
        bytes.extend([b'g', b'r', 0xfc, b'n', 0x96, b'\'', b'/', b'>']);
        let read = xml_text(bytes).expect("declared");
        assert!(read.ends_with("<robot name='grün–'/>"), "{read}");
    }

    #[test]
    fn texts_that_windows_has_redirected_are_read() {
        let source = "\u{feff}robot.base = \"fixed\" # grün \u{1f916}";
        let bytes: Vec<u8> = source.encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(text(bytes.clone()).as_deref(), Ok(source));
        assert_eq!(text(source.as_bytes().to_vec()).as_deref(), Ok(source));
        let cut = text(bytes[..bytes.len() - 2].to_vec()).expect_err("half a letter");
        assert_eq!(cut.at, bytes.len() - 4);
        assert_eq!(text(b"gr\xfcn".to_vec()).expect_err("one byte").at, 2);
    }

    #[test]
    fn other_encodings_are_named() {
        let refused = xml_text(b"<?xml version=\"1.0\" encoding=\"GBK\"?><r n='\xbb'/>".to_vec());
        let refused = refused.expect_err("not read");
        assert_eq!((refused.declared.as_deref(), refused.at), (Some("GBK"), 42));
        let refused = xml_text(b"<r n='\xfc'/>".to_vec()).expect_err("not declared");
        assert_eq!((refused.declared, refused.at), (None, 6));
        assert!(xml_text(b"\xff\xfe\0\0<\0\0\0".to_vec()).is_err());
    }
}
