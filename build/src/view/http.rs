//! The head of an HTTP request, read and judged.
//!
//! Only what the page needs is understood: GET of two paths, the second of them to become a socket.
//! Everything else is refused. Nothing but the standard library is used, and the fuzz target
//! `viewer` runs this file as it is.

use std::io::Read;
use std::time::{Duration, Instant};

/// Longest head, bytes.
pub const LONGEST_HEAD: usize = 8 << 10;

/// Why a request is not answered with what it asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// No request at all: nothing is answered.
    Silent,
    /// Not HTTP/1.1, or contradictory.
    Malformed,
    /// A head that does not end.
    TooLong,
    /// Another method than GET.
    Method,
    /// A name that is not this machine's own: DNS rebinding.
    Host,
    /// A socket that another page opens.
    Origin,
    /// No key, or a wrong one.
    Key,
    /// Another path.
    Path,
}

impl Refusal {
    /// Status line and sentence.
    pub fn answer(self) -> (&'static str, &'static str) {
        match self {
            Self::Silent | Self::Malformed => ("400 Bad Request", "this is no request\n"),
            Self::TooLong => (
                "431 Request Header Fields Too Large",
                "the request is too long\n",
            ),
            Self::Method => ("405 Method Not Allowed", "only GET is answered\n"),
            Self::Host => ("403 Forbidden", "this host name is not served\n"),
            Self::Origin => ("403 Forbidden", "another page may not connect\n"),
            Self::Key => (
                "403 Forbidden",
                "open the address that urdf2fmu view printed: it carries a key\n",
            ),
            Self::Path => ("404 Not Found", "there is nothing here\n"),
        }
    }
}

/// What a request asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Asked {
    /// The page.
    Page,
    /// A socket; the client's key for the handshake.
    Socket(String),
}

/// Reads a head up to its empty line.
///
/// - `until`: a client that sends a byte now and then does not keep a thread
///
/// # Errors
/// [`Refusal`]
pub fn read_head(stream: &mut impl Read, until: Instant) -> Result<Vec<u8>, Refusal> {
    let mut head = Vec::new();
    let mut part = [0; 1024];
    loop {
        let count = stream.read(&mut part).map_err(|_| Refusal::Silent)?;
        if count == 0 {
            return Err(Refusal::Silent);
        }
        // The end may lie across two parts.
        let from = head.len().saturating_sub(3);
        head.extend_from_slice(&part[..count]);
        if let Some(end) = head[from..].windows(4).position(|w| w == b"\r\n\r\n") {
            // A client of ours waits for the answer: what comes behind is no part of it.
            head.truncate(from + end + 2);
            return if head.len() > LONGEST_HEAD {
                Err(Refusal::TooLong)
            } else {
                Ok(head)
            };
        }
        if head.len() > LONGEST_HEAD || Instant::now() > until {
            return Err(Refusal::TooLong);
        }
    }
}

/// Judges a head.
///
/// - `key`: what the address must carry
///
/// # Errors
/// [`Refusal`]
pub fn judge(head: &[u8], key: &str) -> Result<Asked, Refusal> {
    let text = std::str::from_utf8(head).map_err(|_| Refusal::Malformed)?;
    let mut lines = text.strip_suffix("\r\n").unwrap_or(text).split("\r\n");
    let mut words = lines.next().unwrap_or_default().split(' ');
    let (Some(method), Some(target), Some("HTTP/1.1"), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return Err(Refusal::Malformed);
    };
    let mut fields = Vec::new();
    for line in lines {
        let (name, value) = line.split_once(':').ok_or(Refusal::Malformed)?;
        if name.is_empty() || name.contains(|c: char| c.is_whitespace() || c.is_control()) {
            return Err(Refusal::Malformed);
        }
        fields.push((name.to_ascii_lowercase(), value.trim_matches([' ', '\t'])));
    }
    let field = |wanted: &str| -> Result<Option<&str>, Refusal> {
        let mut found = fields.iter().filter(|(name, _)| name == wanted);
        match (found.next(), found.next()) {
            (Some((_, value)), None) => Ok(Some(value)),
            (None, _) => Ok(None),
            // Two of a kind are an attempt to be read in two ways.
            (Some(_), Some(_)) => Err(Refusal::Malformed),
        }
    };
    let host = field("host")?.ok_or(Refusal::Malformed)?;
    if !is_own(host) {
        return Err(Refusal::Host);
    }
    if method != "GET" {
        return Err(Refusal::Method);
    }
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let mut keys = query.split('&').filter_map(|part| part.strip_prefix("k="));
    let given = keys.next().unwrap_or_default();
    if keys.next().is_some() || !same(given.as_bytes(), key.as_bytes()) {
        return Err(Refusal::Key);
    }
    match path {
        "/" => Ok(Asked::Page),
        "/live" => {
            // A browser says which page opens a socket, and scripts cannot change that.
            if field("origin")? != Some(&format!("http://{host}")) {
                return Err(Refusal::Origin);
            }
            let is = |name: &str, value: &str| -> Result<bool, Refusal> {
                Ok(field(name)?.is_some_and(|found| found.eq_ignore_ascii_case(value)))
            };
            let key = field("sec-websocket-key")?.unwrap_or_default();
            let sound = key.len() == 24 && key.bytes().all(|b| b.is_ascii_graphic());
            if !(is("upgrade", "websocket")? && is("sec-websocket-version", "13")? && sound) {
                return Err(Refusal::Malformed);
            }
            Ok(Asked::Socket(key.to_owned()))
        }
        _ => Err(Refusal::Path),
    }
}

/// Whether a host is this machine by a name that no other can have; any port, because a tunnel may
/// have another one.
fn is_own(host: &str) -> bool {
    let (name, port) = host.split_once(':').unwrap_or((host, "80"));
    matches!(name, "127.0.0.1" | "localhost")
        && !port.is_empty()
        && port.bytes().all(|b| b.is_ascii_digit())
}

/// Equality in a time that does not depend on where the difference is.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (x, y)| all | (x ^ y)) == 0
}

/// How long a client may take for its head.
pub const PATIENCE: Duration = Duration::from_secs(5);

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "00112233445566778899aabbccddeeff";

    fn asked(line: &str, fields: &str) -> Result<Asked, Refusal> {
        let head = format!("{line} HTTP/1.1\r\n{fields}");
        judge(
            head.replace('\n', "\r\n").replace("\r\r", "\r").as_bytes(),
            KEY,
        )
    }

    const SOCKET: &str = "Host: 127.0.0.1:5\nOrigin: http://127.0.0.1:5\nUpgrade: websocket\n\
                          Connection: Upgrade\nSec-WebSocket-Version: 13\n\
                          Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\n";

    #[test]
    fn the_page_and_the_socket_are_given_to_who_has_the_key() {
        let page = format!("GET /?k={KEY}&theme=dark");
        for host in ["127.0.0.1:5", "localhost:8080", "localhost"] {
            assert_eq!(asked(&page, &format!("Host: {host}\n")), Ok(Asked::Page));
        }
        let socket = Asked::Socket("dGhlIHNhbXBsZSBub25jZQ==".to_owned());
        assert_eq!(asked(&format!("GET /live?k={KEY}"), SOCKET), Ok(socket));
    }

    #[test]
    fn a_wrong_key_is_refused_whatever_is_wrong_with_it() {
        let short = &KEY[1..];
        let other = KEY.replace('f', "e");
        for query in [
            "",
            "?",
            "?k=",
            "?K=x",
            &format!("?k={short}"),
            &format!("?k={other}"),
        ] {
            let line = format!("GET /{query}");
            assert_eq!(
                asked(&line, "Host: 127.0.0.1:5\n"),
                Err(Refusal::Key),
                "{query}"
            );
            let line = format!("GET /live{query}");
            assert_eq!(asked(&line, SOCKET), Err(Refusal::Key), "{query}");
        }
        let twice = format!("GET /?k={KEY}&k=x");
        assert_eq!(asked(&twice, "Host: localhost\n"), Err(Refusal::Key));
    }

    #[test]
    fn a_foreign_host_is_refused_even_with_the_key() {
        for host in [
            "evil.example:5",
            "127.0.0.1.evil.example",
            "localhost.evil.example:5",
            "127.0.0.1:5:6",
            "127.0.0.1:",
            "[::1]:5",
            "127.0.0.2",
            "",
        ] {
            let page = asked(&format!("GET /?k={KEY}"), &format!("Host: {host}\n"));
            assert_eq!(page, Err(Refusal::Host), "{host}");
        }
    }

    #[test]
    fn a_foreign_or_missing_origin_gets_no_socket() {
        for origin in [
            "Origin: http://evil.example\n",
            "Origin: https://127.0.0.1:5\n",
            "Origin: http://localhost:5\n",
            "Origin: http://127.0.0.1:6\n",
            "Origin: null\n",
            "",
        ] {
            let fields = SOCKET.replace("Origin: http://127.0.0.1:5\n", origin);
            let socket = asked(&format!("GET /live?k={KEY}"), &fields);
            assert_eq!(socket, Err(Refusal::Origin), "{origin}");
        }
    }

    #[test]
    fn other_methods_and_paths_are_refused() {
        let host = "Host: localhost\n";
        for method in ["POST", "HEAD", "OPTIONS", "get"] {
            let line = format!("{method} /?k={KEY}");
            assert_eq!(asked(&line, host), Err(Refusal::Method));
        }
        for path in ["/favicon.ico", "//", "/../etc/passwd", "http://localhost/"] {
            assert_eq!(
                asked(&format!("GET {path}?k={KEY}"), host),
                Err(Refusal::Path)
            );
        }
    }

    #[test]
    fn contradictory_heads_are_refused() {
        let page = format!("GET /?k={KEY}");
        for fields in [
            "",
            "Host: localhost\nHost: localhost\n",
            "Host localhost\n",
            "Host : localhost\n",
            ": x\nHost: localhost\n",
            "Host: localhost\n\n",
        ] {
            assert_eq!(asked(&page, fields), Err(Refusal::Malformed), "{fields}");
        }
        assert_eq!(
            asked("GET  /", "Host: localhost\n"),
            Err(Refusal::Malformed)
        );
        assert_eq!(
            judge(b"GET / HTTP/1.0\r\nHost: localhost\r\n", KEY),
            Err(Refusal::Malformed)
        );
        assert_eq!(judge(b"\xff\xfe", KEY), Err(Refusal::Malformed));
        let half = SOCKET.replace("Upgrade: websocket\n", "");
        assert_eq!(
            asked(&format!("GET /live?k={KEY}"), &half),
            Err(Refusal::Malformed)
        );
    }

    /// Gives a byte at a time, as a slow client does.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let Some((first, rest)) = self.0.split_first() else {
                return Ok(0);
            };
            (into[0], self.0) = (*first, rest);
            Ok(1)
        }
    }

    #[test]
    fn a_head_ends_at_its_empty_line_or_is_refused() {
        let later = Instant::now() + PATIENCE;
        let text = b"GET / HTTP/1.1\r\nHost: a\r\n\r\nrest";
        let head = b"GET / HTTP/1.1\r\nHost: a\r\n".to_vec();
        assert_eq!(read_head(&mut &text[..], later), Ok(head.clone()));
        assert_eq!(read_head(&mut Slow(text), later), Ok(head));
        assert_eq!(
            read_head(&mut &b"GET / HT"[..], later),
            Err(Refusal::Silent)
        );
        let endless = vec![b'a'; LONGEST_HEAD + 2000];
        assert_eq!(read_head(&mut &endless[..], later), Err(Refusal::TooLong));
        let past = Instant::now();
        assert_eq!(read_head(&mut Slow(&endless), past), Err(Refusal::TooLong));
    }
}
