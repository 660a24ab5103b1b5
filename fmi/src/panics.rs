//! Panics are not printed; they are kept until the guard has logged them.
//!
//! A panic is a bug of this library. The default hook would print to the host's stderr, so a hook
//! of this library stores place and message instead. In the shared library this hook is private:
//! the library links a standard library of its own whose symbols are hidden, so another Rust
//! library or a Rust host keeps its own hook and its own stderr. The message is kept in a
//! thread-local without destructor (one with a destructor would keep the library mapped).

use std::any::Any;
use std::cell::Cell;
use std::panic::PanicHookInfo;

/// Bytes of a file name that are kept; the end of a path says most.
const FILE: usize = 64;

#[derive(Clone, Copy)]
struct Place {
    file: [u8; FILE],
    len: usize,
    line: u32,
}

thread_local! {
    static LAST: Cell<Option<Place>> = const { Cell::new(None) };
}

/// Makes this library's panics silent. Allocates nothing: the hook has no size.
#[cfg_attr(small, optimize(size))]
pub(crate) fn silence() {
    // In unit tests the hook would be the test program's, whose messages are wanted.
    if cfg!(not(test)) {
        std::panic::set_hook(Box::new(note));
    }
}

#[cfg_attr(small, optimize(size))]
fn note(info: &PanicHookInfo<'_>) {
    // The libraries of a release are built without places: they have no lines.
    let known = info.location().filter(|location| location.line() > 0);
    let place = known.map(|location| {
        let path = location.file().as_bytes();
        let end = &path[path.len().saturating_sub(FILE)..];
        let mut file = [0; FILE];
        file[..end.len()].copy_from_slice(end);
        Place {
            file,
            len: end.len(),
            line: location.line(),
        }
    });
    LAST.set(place);
}

/// What a caught panic said, and where.
#[cfg_attr(small, optimize(size))]
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("unknown");
    match LAST.take() {
        Some(Place { file, len, line }) => {
            format!(
                "{text}, at {}:{line}",
                String::from_utf8_lossy(&file[..len])
            )
        }
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caught_panic_reports_its_message_and_place() {
        std::panic::set_hook(Box::new(note));
        let line = line!() + 1;
        let caught = std::panic::catch_unwind(|| panic!("wheel {} is square", 3));
        drop(std::panic::take_hook());
        let message = message(caught.expect_err("it panicked").as_ref());
        assert!(message.starts_with("wheel 3 is square, at "), "{message}");
        assert!(message.ends_with(&format!("panics.rs:{line}")), "{message}");
    }
}
