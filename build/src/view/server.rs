//! Listens on this machine alone, sends the page to those who have the key, and connects viewers.
//!
//! A thread for each connection, and a second one for each viewer, which writes. They only pass
//! messages on, so that no browser can delay the simulation.

use super::http::{self, Asked, PATIENCE, Refusal};
use super::hub::{Bytes, Hub};
use super::protocol::Wish;
use super::socket::{Kind, Message, Messages, SocketError, frame};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD as BASE64;
use sha1::{Digest, Sha1};
use std::io::{self, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// Connections at a time.
const MOST: usize = 32;

/// A viewer says something twice a second; after this silence its connection is closed.
const SILENCE: Duration = Duration::from_secs(15);

/// What RFC 6455 appends to a client's key.
const SUFFIX: &str = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";

/// What the simulation hears of viewers.
#[derive(Debug)]
pub enum Event {
    /// One is there.
    Joined,
    /// One has gone.
    Left(u64),
    /// One wishes something, or says that it is still there.
    Wish(u64, Wish),
}

/// A server that runs until the program ends.
#[derive(Debug)]
pub struct Server {
    /// With the key.
    pub address: String,
    /// For a tunnel.
    pub port: u16,
}

/// What all connections share.
struct Shared {
    key: String,
    page: Vec<u8>,
    hub: Hub,
    events: Sender<Event>,
    open: AtomicUsize,
    next: AtomicU64,
}

/// Begins to listen.
///
/// - `port`: 0 for any
/// - `page`: the page for a port
///
/// # Errors
/// The system's, if the port is taken.
pub fn start(
    port: u16,
    page: impl FnOnce(u16) -> String,
    hub: Hub,
    events: Sender<Event>,
) -> io::Result<Server> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
    let port = listener.local_addr()?.port();
    let key = key()?;
    let address = format!("http://127.0.0.1:{port}/?k={key}");
    let shared = Arc::new(Shared {
        key,
        page: page(port).into_bytes(),
        hub,
        events,
        open: AtomicUsize::new(0),
        next: AtomicU64::new(1),
    });
    thread::Builder::new()
        .name("listen".to_owned())
        .spawn(move || {
            for stream in listener.incoming() {
                // Out of file descriptors, for example: later there may be some again.
                let Ok(stream) = stream else {
                    thread::sleep(Duration::from_millis(50));
                    continue;
                };
                if shared.open.fetch_add(1, Ordering::Relaxed) >= MOST {
                    shared.open.fetch_sub(1, Ordering::Relaxed);
                    continue;
                }
                let theirs = shared.clone();
                let spawned =
                    thread::Builder::new()
                        .name("connection".to_owned())
                        .spawn(move || {
                            // A connection that fails is of no interest to anyone else.
                            _ = serve(&stream, &theirs);
                            _ = stream.shutdown(Shutdown::Both);
                            theirs.open.fetch_sub(1, Ordering::Relaxed);
                        });
                if spawned.is_err() {
                    shared.open.fetch_sub(1, Ordering::Relaxed);
                }
            }
        })?;
    Ok(Server { address, port })
}

/// 128 bits that nobody can guess, in hexadecimal digits.
fn key() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    Ok(format!("{:032x}", u128::from_be_bytes(bytes)))
}

fn serve(mut stream: &TcpStream, shared: &Arc<Shared>) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    let head = http::read_head(&mut stream, Instant::now() + PATIENCE);
    match head.and_then(|head| http::judge(&head, &shared.key)) {
        Ok(Asked::Page) => answer(stream, "200 OK", "text/html", &shared.page),
        Ok(Asked::Socket(key)) => socket(stream, &key, shared),
        Err(Refusal::Silent) => Ok(()),
        Err(refusal) => {
            let (status, sentence) = refusal.answer();
            answer(stream, status, "text/plain", sentence.as_bytes())
        }
    }
}

/// An answer that is kept nowhere, framed nowhere and told to nobody.
fn answer(mut stream: &TcpStream, status: &str, kind: &str, body: &[u8]) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\n\
         Content-Type: {kind}; charset=utf-8\r\n\
         Content-Length: {}\r\n\
         Connection: close\r\n\
         Cache-Control: no-store\r\n\
         Referrer-Policy: no-referrer\r\n\
         X-Content-Type-Options: nosniff\r\n\
         X-Frame-Options: DENY\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\n\
         Content-Security-Policy: frame-ancestors 'none'\r\n\
         \r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)
}

fn socket(mut stream: &TcpStream, key: &str, shared: &Arc<Shared>) -> io::Result<()> {
    let accepted = BASE64.encode(Sha1::digest(format!("{key}{SUFFIX}").as_bytes()));
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\n\
         Upgrade: websocket\r\n\
         Connection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accepted}\r\n\
         \r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.set_read_timeout(Some(SILENCE))?;
    let viewer = shared.next.fetch_add(1, Ordering::Relaxed);
    let writing = stream.try_clone()?;
    let (queue, frames) = shared.hub.join(viewer);
    thread::Builder::new()
        .name("viewer".to_owned())
        .spawn(move || write(&writing, &frames))?;
    _ = shared.events.send(Event::Joined);
    let mut messages = Messages::default();
    loop {
        match messages.read(&mut stream) {
            Ok(Message::Text(text)) => {
                // What is no wish is a sign of life all the same.
                let wish = Wish::parse(&text).unwrap_or_default();
                _ = shared.events.send(Event::Wish(viewer, wish));
            }
            Ok(Message::Ping(payload)) => {
                _ = queue.try_send(Arc::new(frame(Kind::Pong, &payload)));
            }
            Ok(Message::Pong) => {}
            Ok(Message::Close) => {
                _ = queue.try_send(Arc::new(frame(Kind::Close, &1000_u16.to_be_bytes())));
                break;
            }
            Err(SocketError::Protocol(code)) => {
                _ = queue.try_send(Arc::new(frame(Kind::Close, &code.to_be_bytes())));
                break;
            }
            Err(SocketError::Io) => break,
        }
    }
    shared.hub.leave(viewer);
    _ = shared.events.send(Event::Left(viewer));
    // The writer ends when all senders have, and closes the connection behind the last frame.
    Ok(())
}

/// Writes what a viewer is sent. One that takes nothing for as long as a write may last is given
/// up.
fn write(mut stream: &TcpStream, frames: &Receiver<Bytes>) {
    for frame in frames {
        if stream.write_all(&frame).is_err() {
            break;
        }
    }
    _ = stream.shutdown(Shutdown::Both);
}
