//! JSON for [`super::PreparedModel`]: numbers, texts, lists, objects and the ways in which serde
//! writes enums.
//!
//! Every library in an FMU carries this reader. What serde derives for a general reader of JSON
//! takes three times the machine code: for each struct one way through a list and one through a
//! map, with names compared in it. Here a struct is always read as the list of its fields; the
//! reader brings the fields into order, by code that all structs share.
//!
//! Objects are read in the order of the struct's fields first, as they are written. A text that
//! cannot be read so is read once more with a table of the places of each object's fields, and it
//! is this reading that tells what is wrong.

mod access;
#[cfg(test)]
mod tests;

use serde::de;
use std::borrow::Cow;
use std::fmt;

/// What is wrong with a text; the place is where the reader stands.
#[derive(Debug)]
pub struct Fault(Box<Message>);

/// On the heap, so that a result is no larger than a pointer.
#[derive(Debug)]
struct Message {
    text: String,
}

#[cold]
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn fault<T>(text: String) -> Result<T, Fault> {
    Err(Fault(Box::new(Message { text })))
}

#[cold]
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn expected<T>(what: &str) -> Result<T, Fault> {
    fault(format!("expected {what}"))
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.text)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    #[cold]
    fn custom<T: fmt::Display>(message: T) -> Self {
        let text = message.to_string();
        Self(Box::new(Message { text }))
    }
}

/// How objects are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Fields must come in the struct's order.
    Written,
    /// Fields may come in any order; all must be known.
    Any,
    /// As `Any`, but what is not known is passed over.
    Lenient,
}

/// Reads a text from its beginning.
pub struct Reader<'t> {
    text: &'t str,
    at: usize,
    order: Order,
}

impl<'t> Reader<'t> {
    pub fn new(text: &'t str, order: Order) -> Self {
        Self { text, at: 0, order }
    }

    /// A fault with its place.
    #[cfg_attr(small, optimize(size))]
    pub fn told(&self, fault: &Fault) -> String {
        let before = &self.text.as_bytes()[..self.at.min(self.text.len())];
        let line = before.split(|byte| *byte == b'\n').count();
        let begun = before.iter().rposition(|byte| *byte == b'\n');
        let column = before.len() - begun.map_or(0, |at| at + 1) + 1;
        format!("{fault} at line {line} column {column}")
    }

    /// There must be nothing left but blanks.
    pub fn end(&mut self) -> Result<(), Fault> {
        match self.peek() {
            None => Ok(()),
            Some(_) => expected("the end of the text"),
        }
    }

    fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    /// The next byte that is no blank.
    #[inline(never)]
    fn peek(&mut self) -> Option<u8> {
        loop {
            match self.byte(self.at) {
                Some(b' ' | b'\n' | b'\t' | b'\r') => self.at += 1,
                other => return other,
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn expect(&mut self, byte: u8) -> Result<(), Fault> {
        if self.peek() == Some(byte) {
            self.at += 1;
            return Ok(());
        }
        expected(&format!("`{}`", char::from(byte)))
    }

    /// Whether the next value is this word, which is then behind the reader.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn word(&mut self, word: &str) -> bool {
        let is =
            self.peek().is_some() && self.text.as_bytes()[self.at..].starts_with(word.as_bytes());
        if is {
            self.at += word.len();
        }
        is
    }

    fn boolean(&mut self) -> Result<bool, Fault> {
        if self.word("true") {
            return Ok(true);
        }
        if self.word("false") {
            return Ok(false);
        }
        expected("true or false")
    }

    fn digits(&self, mut at: usize) -> usize {
        while self.byte(at).is_some_and(|byte| byte.is_ascii_digit()) {
            at += 1;
        }
        at
    }

    /// The end of the number that begins here, as JSON writes them.
    #[cfg_attr(small, optimize(size))]
    fn number(&mut self) -> Option<usize> {
        self.peek();
        let whole = self.at + usize::from(self.byte(self.at) == Some(b'-'));
        let mut end = self.digits(whole);
        if end == whole || (self.byte(whole) == Some(b'0') && end > whole + 1) {
            return None;
        }
        if self.byte(end) == Some(b'.') {
            let part = end + 1;
            end = self.digits(part);
            if end == part {
                return None;
            }
        }
        if let Some(b'e' | b'E') = self.byte(end) {
            let sign = matches!(self.byte(end + 1), Some(b'+' | b'-'));
            let power = end + 1 + usize::from(sign);
            end = self.digits(power);
            if end == power {
                return None;
            }
        }
        Some(end)
    }

    /// The standard library's reader of numbers gives the nearest one.
    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn float(&mut self) -> Result<f64, Fault> {
        let Some(end) = self.number() else {
            return expected("a number");
        };
        match self.text[self.at..end].parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at = end;
                Ok(number)
            }
            _ => fault("number out of range".into()),
        }
    }

    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn unsigned(&mut self) -> Result<u64, Fault> {
        if let Some(end) = self.number()
            && let Ok(number) = self.text[self.at..end].parse::<u64>()
        {
            self.at = end;
            return Ok(number);
        }
        expected("a whole number, 0 or more")
    }

    #[inline(never)]
    #[cfg_attr(small, optimize(size))]
    fn string(&mut self) -> Result<Cow<'t, str>, Fault> {
        if self.peek() != Some(b'"') {
            return expected("a text in quotes");
        }
        let mut begun = self.at + 1;
        let mut text = Cow::Borrowed("");
        self.at = begun;
        loop {
            match self.byte(self.at) {
                Some(byte @ (b'"' | b'\\')) => {
                    let piece = &self.text[begun..self.at];
                    if text.is_empty() {
                        text = Cow::Borrowed(piece);
                    } else {
                        text.to_mut().push_str(piece);
                    }
                    self.at += 1;
                    if byte == b'"' {
                        return Ok(text);
                    }
                    text.to_mut().push(self.escaped()?);
                    begun = self.at;
                }
                None | Some(..0x20) => return expected("the end of a text, `\"`"),
                Some(_) => self.at += 1,
            }
        }
    }

    /// The character that stands behind a backslash.
    #[cfg_attr(small, optimize(size))]
    fn escaped(&mut self) -> Result<char, Fault> {
        let byte = self.byte(self.at);
        self.at += 1;
        Ok(match byte {
            Some(same @ (b'"' | b'\\' | b'/')) => char::from(same),
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(b'n') => '\n',
            Some(b'r') => '\r',
            Some(b't') => '\t',
            Some(b'u') => {
                let first = self.unit()?;
                // Characters beyond the first 65536 are two units.
                let pair = (0xD800..0xDC00).contains(&first);
                let mut code = first;
                if pair && self.text.as_bytes()[self.at..].starts_with(b"\\u") {
                    self.at += 2;
                    let second = self.unit()?;
                    code = match second {
                        0xDC00..0xE000 => 0x1_0000 + ((first - 0xD800) << 10) + (second - 0xDC00),
                        _ => first,
                    };
                }
                match char::from_u32(code) {
                    Some(character) => character,
                    None => return expected("a character"),
                }
            }
            _ => return expected("an escaped character"),
        })
    }

    /// Four hexadecimal digits.
    #[cfg_attr(small, optimize(size))]
    fn unit(&mut self) -> Result<u32, Fault> {
        let digits = self.text.get(self.at..self.at + 4);
        let digits = digits.filter(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()));
        match digits.map(|digits| u32::from_str_radix(digits, 16)) {
            Some(Ok(unit)) => {
                self.at += 4;
                Ok(unit)
            }
            _ => expected("four hexadecimal digits"),
        }
    }

    /// Passes over a value. What is in it is looked at where it is read.
    #[cfg_attr(small, optimize(size))]
    fn skip(&mut self) -> Result<(), Fault> {
        let mut depth = 0_usize;
        loop {
            match self.peek() {
                None => return expected("a value"),
                Some(b'"') => drop(self.string()?),
                Some(b'{' | b'[') => {
                    self.at += 1;
                    depth += 1;
                    continue;
                }
                Some(b'}' | b']' | b',' | b':') if depth == 0 => return expected("a value"),
                Some(b'}' | b']') => {
                    self.at += 1;
                    depth -= 1;
                }
                Some(b',' | b':') => {
                    self.at += 1;
                    continue;
                }
                Some(_) => {
                    let rest = &self.text[self.at..];
                    let word =
                        rest.find([',', ':', '}', ']', '{', '[', '"', ' ', '\n', '\r', '\t']);
                    self.at += word.unwrap_or(rest.len()).max(1);
                }
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }
}
