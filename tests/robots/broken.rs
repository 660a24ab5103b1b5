//! The broken robots of `tests/robots/broken/robots.txt`, which says how it is written.

use std::path::Path;

/// A robot whose findings are known.
pub struct Broken {
    /// What is wrong with it, in a word.
    pub name: String,
    /// Lines of findings: severity, code, line, part of the message.
    pub expected: Vec<String>,
    /// Bytes of the URDF.
    pub urdf: Vec<u8>,
}

/// All of them, by name.
///
/// # Panics
/// Where the table is not written as its first lines say.
pub fn read(root: &Path) -> Vec<Broken> {
    let path = root.join("tests/robots/broken/robots.txt");
    let text = std::fs::read_to_string(path).expect("the table of broken robots");
    let sections = text
        .split_inclusive('\n')
        .fold(Vec::new(), |mut list, line| {
            if let Some(name) = line.strip_prefix("==== ") {
                list.push((name.trim_end(), Vec::new()));
            } else if let Some((_, lines)) = list.last_mut() {
                lines.push(line);
            }
            list
        });
    sections
        .into_iter()
        .map(|(name, lines)| section(name, &lines))
        .collect()
}

fn section(name: &str, lines: &[&str]) -> Broken {
    let end = lines.iter().position(|line| line.starts_with("----"));
    let end = end.unwrap_or_else(|| panic!("'{name}' has no URDF"));
    let body = lines[end + 1..].concat();
    Broken {
        name: name.to_owned(),
        expected: lines[..end]
            .iter()
            .map(|line| line.trim_end().to_owned())
            .collect(),
        urdf: match lines[end].trim_end() {
            "----" => body.into_bytes(),
            "---- escaped" => unescaped(&body),
            other => panic!("'{name}': '{other}' is not known"),
        },
    }
}

fn unescaped(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut signs = text.bytes().filter(|&byte| byte != b'\n');
    while let Some(byte) = signs.next() {
        if byte != b'\\' {
            bytes.push(byte);
            continue;
        }
        match signs.next() {
            Some(b'n') => bytes.push(b'\n'),
            Some(b'\\') => bytes.push(b'\\'),
            Some(b'x') => {
                let digits: String = signs.by_ref().take(2).map(char::from).collect();
                bytes.push(u8::from_str_radix(&digits, 16).expect("two hexadecimal digits"));
            }
            other => panic!("\\{other:?} is no escape"),
        }
    }
    bytes
}
