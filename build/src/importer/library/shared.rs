//! What instances of both versions of FMI share: errors, messages, the loading of a library.
#![allow(unsafe_code, reason = "loads a library and reads C strings")]

use libloading::Library;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fmt::Write as _;
use std::path::Path;

/// What an FMU has said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// `fmi2Status`, `fmi3Status`
    pub status: i32,
    /// As the FMU calls it.
    pub category: String,
    /// printf's `%%` and FMI's `##` resolved; arguments that were to be put in are not known here.
    pub text: String,
}

/// Why an FMU's functions cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// No library that this system loads.
    #[error(
        "cannot load '{path}': {source}; the FMU's library is damaged, or lacks what this system \
         has not: download or export the FMU once more"
    )]
    Load {
        /// The file.
        path: String,
        /// Why.
        source: libloading::Error,
    },
    /// A function is missing.
    #[error("the library does not export {name}")]
    Missing {
        /// As in the standard.
        name: &'static str,
    },
    /// No instance.
    #[error("{function} failed{said}")]
    Instantiate {
        /// As in the standard.
        function: &'static str,
        /// What it logged, if anything.
        said: String,
    },
    /// A function failed.
    #[error("{function} returned {status}{said}")]
    Status {
        /// As in the standard.
        function: &'static str,
        /// `fmi2Error` …
        status: String,
        /// What it logged, if anything.
        said: String,
    },
}

impl LibraryError {
    /// Whether a call failed that may succeed for other states or a shorter step.
    pub fn is_discard(&self) -> bool {
        matches!(self, Self::Status { status, .. } if status.ends_with("Discard"))
    }

    /// What the FMU said about it, as the end of a sentence; empty where it said nothing.
    pub fn said(&self) -> &str {
        match self {
            Self::Status { said, .. } | Self::Instantiate { said, .. } => said,
            Self::Load { .. } | Self::Missing { .. } => "",
        }
    }
}

/// Takes back the complaints after so many messages: those of a call whose failure is none.
pub(super) fn forget_complaints(heard: &mut Vec<Message>, since: usize) {
    let mut place = 0;
    heard.retain(|message| {
        place += 1;
        place <= since || message.status <= LAST_GOOD
    });
}

/// What an FMU says at an event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Update {
    /// The update has to be done again.
    pub again: bool,
    /// The FMU asks to end the simulation.
    pub ends: bool,
    /// When the next event is due, s.
    pub next: Option<f64>,
}

/// What an FMU says after a step of the importer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Completed {
    /// There is an event.
    pub event: bool,
    /// The FMU asks to end the simulation.
    pub ends: bool,
}

/// What a step came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepped {
    /// It is done.
    Done,
    /// It ended before its end, at this time, s; the simulation goes on from there.
    Early(f64),
    /// It is done so far, to this time, s, at which the FMU asks to end the simulation.
    Over(f64),
    /// It was discarded; the simulation stands at this time, s.
    Discarded(f64),
}

/// The last status of a call that went well: `fmi2OK`, `fmi2Warning`, and those of FMI 3.
pub(super) const LAST_GOOD: c_int = 1;

/// The functions that an importer uses, by their names in the standard.
macro_rules! functions {
    ($(#[$doc:meta])* struct $table:ident;
     $($name:ident: $symbol:literal, fn($($argument:ty),*) -> $result:ty;)*) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        struct $table { $($name: unsafe extern "C" fn($($argument),*) -> $result,)* }

        impl $table {
            /// # Safety
            /// The library's functions are those of the standard.
            unsafe fn find(library: &Library) -> Result<Self, LibraryError> {
                Ok(Self { $($name: {
                    // SAFETY: the caller's promise gives the function its type.
                    let symbol = unsafe { library.get(concat!($symbol, "\0").as_bytes()) };
                    *symbol.map_err(|_| LibraryError::Missing { name: $symbol })?
                },)* })
            }
        }
    };
}
pub(super) use functions;

/// Puts what an FMU says where its instance listens.
///
/// - `resolved`: the text without what the version of FMI doubles
///
/// # Safety
/// `environment` is null or the box of the `Slave` that gave it, which outlives the instance;
/// strings are null or end with a zero.
pub(super) unsafe fn hear(
    environment: *mut c_void,
    status: c_int,
    [category, message]: [*const c_char; 2],
    resolved: impl Fn(String) -> String,
) {
    let text = |pointer: *const c_char| {
        if pointer.is_null() {
            return String::new();
        }
        // SAFETY: not null; the rest is the caller's promise.
        unsafe { CStr::from_ptr(pointer) }
            .to_string_lossy()
            .into_owned()
    };
    // SAFETY: the caller's promise.
    let Some(heard) = (unsafe { environment.cast::<RefCell<Vec<Message>>>().as_ref() }) else {
        return;
    };
    // Never a panic into C: a message that comes while another is looked at is lost.
    if let Ok(mut heard) = heard.try_borrow_mut() {
        heard.push(Message {
            status,
            category: text(category),
            text: resolved(text(message)),
        });
    }
}

/// Text for a C function.
pub(super) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// A `file:` URI (RFC 3986, RFC 8089) of an absolute path.
pub fn uri(path: &Path) -> String {
    let path = path.to_string_lossy().replace('\\', "/");
    let mut uri = String::from(if path.starts_with('/') {
        "file://"
    } else {
        "file:///"
    });
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' | b':' => {
                uri.push(char::from(byte));
            }
            _ => _ = write!(uri, "%{byte:02X}"),
        }
    }
    uri
}

/// Loads a library.
///
/// # Errors
/// [`LibraryError::Load`]
pub(super) fn open(path: &Path) -> Result<Library, LibraryError> {
    // SAFETY: a person asked to run this FMU; its initialisers may do what they like, as in any
    // importer.
    let loaded = unsafe { Library::new(path) };
    loaded.map_err(|source| LibraryError::Load {
        path: path.display().to_string(),
        source,
    })
}

/// Whether a call went well.
///
/// - `fmi`: prefix of the version
///
/// # Errors
/// [`LibraryError::Status`] with the last complaint in `heard`.
pub(super) fn check(
    fmi: &str,
    function: &'static str,
    status: c_int,
    heard: &[Message],
) -> Result<(), LibraryError> {
    if (0..=LAST_GOOD).contains(&status) {
        return Ok(());
    }
    let name = match status {
        2 => "Discard",
        3 => "Error",
        4 => "Fatal",
        5 => "Pending",
        _ => "an unknown status",
    };
    let status = if (2..=5).contains(&status) {
        format!("{fmi}{name}")
    } else {
        name.to_owned()
    };
    Err(LibraryError::Status {
        function,
        status,
        said: said(heard),
    })
}

/// The last complaint, for the end of an error's text.
pub(super) fn said(messages: &[Message]) -> String {
    let complaint = messages.iter().rev().find(|m| m.status > LAST_GOOD);
    complaint.map_or(String::new(), |m| format!(": {}", m.text))
}
