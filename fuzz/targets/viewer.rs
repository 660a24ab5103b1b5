//! What comes to a live view from outside: heads of requests, frames of sockets, and the wishes in
//! them. The first byte chooses; the files are those of the command itself.

#[path = "../../build/src/view/http.rs"]
mod http;
#[path = "../../build/src/view/socket.rs"]
mod socket;

use http::{Asked, LONGEST_HEAD, PATIENCE, judge, read_head};
use socket::{LONGEST_MESSAGE, Message, Messages, SocketError};
use std::io::Read;
use std::time::Instant;

/// What an attacker does not know.
const KEY: &str = "5f0c";

/// Gives a few bytes at a time, as a network does.
struct Pieces<'a> {
    rest: &'a [u8],
    most: usize,
}

impl Read for Pieces<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.rest.len().min(into.len()).min(self.most);
        let (first, rest) = self.rest.split_at(count);
        into[..count].copy_from_slice(first);
        self.rest = rest;
        Ok(count)
    }
}

pub fn viewer(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else {
        return;
    };
    let most = usize::from(first >> 1) + 1;
    let mut stream = Pieces { rest, most };
    if first & 1 == 0 {
        let Ok(head) = read_head(&mut stream, Instant::now() + PATIENCE) else {
            return;
        };
        assert!(head.len() <= LONGEST_HEAD);
        let Ok(asked) = judge(&head, KEY) else {
            return;
        };
        // Whatever is granted was asked with the key, of this machine by its own name.
        let text = String::from_utf8(head).expect("judged as text");
        assert!(text.contains("k=5f0c"));
        let lower = text.to_lowercase();
        assert!(lower.contains("host:"));
        if let Asked::Socket(key) = asked {
            assert!(key.len() == 24 && lower.contains("origin:"));
        }
        // In one piece the same comes out.
        let mut whole = rest;
        let again = read_head(&mut whole, Instant::now() + PATIENCE).expect("as before");
        assert!(judge(&again, KEY).is_ok());
        return;
    }
    let mut messages = Messages::default();
    loop {
        let left = stream.rest.len();
        match messages.read(&mut stream) {
            Ok(Message::Text(text)) => assert!(text.len() <= LONGEST_MESSAGE),
            Ok(Message::Ping(payload)) => assert!(payload.len() <= 125),
            Ok(Message::Pong) => {}
            Ok(Message::Close) => return,
            Err(SocketError::Io) => {
                assert!(stream.rest.is_empty(), "it waits for more");
                return;
            }
            Err(SocketError::Protocol(code)) => {
                assert!((1002..=1009).contains(&code));
                return;
            }
        }
        assert!(stream.rest.len() < left, "each message takes bytes");
    }
}
