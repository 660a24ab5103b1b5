//! Frames of a socket (RFC 6455), as a server reads and writes them.
//!
//! Text, ping, pong and close are understood, whole or in parts. Nothing but the standard library
//! is used, and the fuzz target `viewer` runs this file as it is.

use std::io::{self, Read};

/// Longest message of a viewer, bytes.
pub const LONGEST_MESSAGE: usize = 64 << 10;

/// Longest payload of ping, pong and close.
const LONGEST_CONTROL: usize = 125;

/// What a frame holds: the low half of its first byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Text in UTF-8.
    Text = 1,
    /// Bytes.
    Binary = 2,
    /// The end.
    Close = 8,
    /// Asks for the same as a pong.
    Pong = 10,
}

/// What a viewer sends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// Text.
    Text(String),
    /// To be answered with [`Kind::Pong`].
    Ping(Vec<u8>),
    /// An answer to what was not asked.
    Pong,
    /// The end.
    Close,
}

/// Why a socket is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SocketError {
    /// The connection has ended, or nothing came in time.
    Io,
    /// Against the protocol; the code of the close frame.
    Protocol(u16),
}

impl From<io::Error> for SocketError {
    fn from(_: io::Error) -> Self {
        Self::Io
    }
}

/// Against the protocol.
const PROTOCOL: SocketError = SocketError::Protocol(1002);
/// Bytes where text is understood.
const UNSUPPORTED: SocketError = SocketError::Protocol(1003);
/// Text that is no UTF-8.
const NO_TEXT: SocketError = SocketError::Protocol(1007);
/// Too long.
const TOO_LONG: SocketError = SocketError::Protocol(1009);

/// A frame for a viewer.
pub fn frame(kind: Kind, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x80 | kind as u8];
    match payload.len() {
        short @ 0..=125 => frame.push(u8::try_from(short).unwrap_or_default()),
        middle @ 126..=0xffff => {
            frame.push(126);
            frame.extend(u16::try_from(middle).unwrap_or_default().to_be_bytes());
        }
        long => {
            frame.push(127);
            frame.extend((long as u64).to_be_bytes());
        }
    }
    frame.extend_from_slice(payload);
    frame
}

/// Reads messages; keeps the parts of one that is not whole.
#[derive(Debug, Default)]
pub struct Messages {
    parts: Option<Vec<u8>>,
}

impl Messages {
    /// The next message.
    ///
    /// # Errors
    /// [`SocketError`]: the connection is of no further use.
    pub fn read(&mut self, stream: &mut impl Read) -> Result<Message, SocketError> {
        loop {
            let mut start = [0; 2];
            stream.read_exact(&mut start)?;
            let [first, second] = start;
            let (last, code) = (first & 0x80 != 0, first & 0x0f);
            // No extension was agreed on, and a browser masks what it sends.
            if first & 0x70 != 0 || second & 0x80 == 0 {
                return Err(PROTOCOL);
            }
            let length = length(stream, second & 0x7f)?;
            let control = code >= 8;
            if control && (!last || length > LONGEST_CONTROL) {
                return Err(PROTOCOL);
            }
            let before = self.parts.as_ref().map_or(0, Vec::len);
            if !control && before + length > LONGEST_MESSAGE {
                return Err(TOO_LONG);
            }
            let payload = payload(stream, length)?;
            match (code, self.parts.take()) {
                (0, Some(mut parts)) => {
                    parts.extend(payload);
                    if last {
                        return text(parts);
                    }
                    self.parts = Some(parts);
                }
                (1, None) if last => return text(payload),
                (1, None) => self.parts = Some(payload),
                (2, None) => return Err(UNSUPPORTED),
                (8, _) => return Ok(Message::Close),
                (9, parts) => {
                    self.parts = parts;
                    return Ok(Message::Ping(payload));
                }
                (10, parts) => {
                    self.parts = parts;
                    return Ok(Message::Pong);
                }
                _ => return Err(PROTOCOL),
            }
        }
    }
}

/// Length of a payload; its shortest form is required.
fn length(stream: &mut impl Read, short: u8) -> Result<usize, SocketError> {
    match short {
        126 => {
            let mut bytes = [0; 2];
            stream.read_exact(&mut bytes)?;
            let length = usize::from(u16::from_be_bytes(bytes));
            if length < 126 {
                Err(PROTOCOL)
            } else {
                Ok(length)
            }
        }
        127 => {
            let mut bytes = [0; 8];
            stream.read_exact(&mut bytes)?;
            let length = u64::from_be_bytes(bytes);
            if length <= 0xffff || length >> 63 != 0 {
                return Err(PROTOCOL);
            }
            usize::try_from(length).map_err(|_| TOO_LONG)
        }
        short => Ok(usize::from(short)),
    }
}

/// Mask and payload; the length has been checked.
fn payload(stream: &mut impl Read, length: usize) -> Result<Vec<u8>, SocketError> {
    let mut mask = [0; 4];
    stream.read_exact(&mut mask)?;
    let mut payload = vec![0; length];
    stream.read_exact(&mut payload)?;
    for (byte, mask) in payload.iter_mut().zip(mask.iter().cycle()) {
        *byte ^= mask;
    }
    Ok(payload)
}

fn text(bytes: Vec<u8>) -> Result<Message, SocketError> {
    String::from_utf8(bytes)
        .map(Message::Text)
        .map_err(|_| NO_TEXT)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame as a browser sends it.
    fn sent(first: u8, payload: &[u8]) -> Vec<u8> {
        let whole = frame(Kind::Text, payload);
        let head = whole.len() - payload.len();
        let mask = [0x37, 0xfa, 0x21, 0x3d];
        let mut bytes = whole[..head].to_vec();
        bytes[0] = first;
        bytes[1] |= 0x80;
        bytes.extend(mask);
        bytes.extend(payload.iter().zip(mask.iter().cycle()).map(|(b, m)| b ^ m));
        bytes
    }

    fn read(bytes: &[u8]) -> Vec<Result<Message, u16>> {
        let (mut stream, mut messages) = (bytes, Messages::default());
        let mut list = Vec::new();
        loop {
            match messages.read(&mut stream) {
                Ok(message) => list.push(Ok(message)),
                Err(SocketError::Protocol(code)) => {
                    list.push(Err(code));
                    return list;
                }
                Err(SocketError::Io) => return list,
            }
        }
    }

    #[test]
    fn the_masked_hello_of_the_rfc_is_read() {
        // RFC 6455, section 5.7.
        let bytes = [
            0x81, 0x85, 0x37, 0xfa, 0x21, 0x3d, 0x7f, 0x9f, 0x4d, 0x51, 0x58,
        ];
        assert_eq!(read(&bytes), [Ok(Message::Text("Hello".to_owned()))]);
        assert_eq!(frame(Kind::Text, b"Hello"), b"\x81\x05Hello");
        assert_eq!(frame(Kind::Binary, &[0; 256])[..4], [0x82, 0x7e, 1, 0]);
        assert_eq!(
            frame(Kind::Binary, &vec![0; 65536])[..10],
            [0x82, 0x7f, 0, 0, 0, 0, 0, 1, 0, 0]
        );
    }

    #[test]
    fn messages_in_parts_with_a_ping_between_are_put_together() {
        let mut bytes = sent(0x01, b"Hel");
        bytes.extend(sent(0x89, b"ping"));
        bytes.extend(sent(0x80, b"lo"));
        bytes.extend(sent(0x8a, b""));
        bytes.extend(sent(0x88, b"\x03\xe8"));
        let texts = [
            Ok(Message::Ping(b"ping".to_vec())),
            Ok(Message::Text("Hello".to_owned())),
            Ok(Message::Pong),
            Ok(Message::Close),
        ];
        assert_eq!(read(&bytes), texts);
    }

    #[test]
    fn the_longest_message_is_read_and_one_byte_more_is_refused() {
        let longest = vec![b'a'; LONGEST_MESSAGE];
        assert!(matches!(
            &read(&sent(0x81, &longest))[..],
            [Ok(Message::Text(_))]
        ));
        let longer = vec![b'a'; LONGEST_MESSAGE + 1];
        assert_eq!(read(&sent(0x81, &longer)), [Err(1009)]);
        let mut parts = sent(0x01, &longest);
        parts.extend(sent(0x80, b"a"));
        assert_eq!(read(&parts), [Err(1009)]);
        // A length that would fill memory is refused before anything is set aside.
        assert_eq!(
            read(&[0x81, 0xff, 0x7f, 255, 255, 255, 255, 255, 255, 255]),
            [Err(1009)]
        );
    }

    #[test]
    fn what_is_against_the_protocol_ends_the_socket() {
        assert_eq!(read(&[0x81, 0x05]), [Err(1002)], "not masked");
        assert_eq!(read(&sent(0xc1, b"a")), [Err(1002)], "an extension");
        assert_eq!(read(&sent(0x80, b"a")), [Err(1002)], "a part of nothing");
        assert_eq!(read(&sent(0x09, b"a")), [Err(1002)], "a ping in parts");
        assert_eq!(read(&sent(0x89, &[0; 126])), [Err(1002)], "a long ping");
        assert_eq!(read(&sent(0x83, b"a")), [Err(1002)], "an unknown kind");
        assert_eq!(read(&sent(0x82, b"a")), [Err(1003)], "bytes");
        assert_eq!(read(&sent(0x81, b"\xff")), [Err(1007)], "no UTF-8");
        assert_eq!(
            read(&[0x81, 0xfe, 0, 5]),
            [Err(1002)],
            "a length longer than need be"
        );
        let mut two = sent(0x01, b"a");
        two.extend(sent(0x81, b"b"));
        assert_eq!(read(&two), [Err(1002)], "a message within another");
    }
}
