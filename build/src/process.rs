//! Which standard streams were open when this process started, and whether it is to end.
//!
//! The standard library opens `/dev/null` in the place of a standard stream that was closed
//! (`>&-`), before `main` is called, so that a result printed there would vanish without an error.
//! Whether the streams are open is therefore checked earlier, when the program is loaded.
//!
//! The same place ignores SIGXFSZ, as it is done for SIGPIPE: a file that would grow beyond the
//! limit of its size (`ulimit -f`) is then an error that can be reported, and no file is left
//! incomplete.
#![allow(unsafe_code, reason = "runs before main and calls the C library")]

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, Ordering};
use std::sync::{Mutex, Once, PoisonError};
use std::time::Duration;

/// Bit `1 << n` is set where stream `n` (1 output, 2 error) was closed.
static CLOSED: AtomicU8 = AtomicU8::new(0);

// SAFETY: the linker collects addresses of C functions without arguments in this section, and the
// loader calls each once before `main`.
#[used]
#[cfg_attr(not(target_vendor = "apple"), unsafe(link_section = ".init_array"))]
#[cfg_attr(
    target_vendor = "apple",
    unsafe(link_section = "__DATA,__mod_init_func")
)]
static AT_LOAD: extern "C" fn() = at_load;

extern "C" fn at_load() {
    for stream in [1, 2] {
        // SAFETY: asks for a descriptor's flags; a closed one is answered with -1.
        if unsafe { libc::fcntl(stream, libc::F_GETFD) } == -1 {
            CLOSED.fetch_or(1 << stream, Ordering::Relaxed);
        }
    }
    // SAFETY: sets no handler, only that the signal is ignored; no thread runs yet.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Whether the stream could be written when the process began.
///
/// # Errors
/// "Bad file descriptor" where it was closed.
pub fn check_open(stream: u8) -> io::Result<()> {
    if CLOSED.load(Ordering::Relaxed) & (1 << stream) == 0 {
        Ok(())
    } else {
        Err(io::Error::from_raw_os_error(libc::EBADF))
    }
}

/// Whether SIGINT, SIGTERM or SIGHUP has come.
static ENDED: AtomicBool = AtomicBool::new(false);

/// Whether somebody asks [`ended`] and finishes then.
static FINISHES: AtomicBool = AtomicBool::new(false);

/// Whether files are being finished, which may take as long as it takes.
static FINISHING: AtomicBool = AtomicBool::new(false);

/// How long after SIGTERM or SIGHUP somebody has to ask [`ended`]. Who sends these sends one and
/// waits, and an FMU may never come back from a call; who presses Ctrl-C can do so again.
const GRACE: Duration = Duration::from_secs(1);

/// The end of a pipe by which the handler wakes the thread that removes; -1 where there is none.
static WAKES: AtomicI32 = AtomicI32::new(-1);

/// What goes with the process.
static PASSING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

extern "C" fn end(signal: libc::c_int) {
    ENDED.store(true, Ordering::Relaxed);
    let wakes = WAKES.load(Ordering::Relaxed);
    // SAFETY: both calls are allowed in a handler. The next signal ends the process at once, should
    // it hang.
    unsafe {
        libc::signal(signal, libc::SIG_DFL);
        if wakes >= 0 {
            let byte = signal.to_ne_bytes();
            libc::write(wakes, byte.as_ptr().cast(), byte.len());
        }
    }
}

/// From now on Ctrl-C, and a terminal that is closed, are told by [`ended`] the first time, so that
/// files can be finished.
pub fn watch_end() {
    FINISHES.store(true, Ordering::Relaxed);
    handle();
}

/// Makes a folder that goes, too, where a signal ends the process before somebody asks [`ended`].
///
/// # Errors
/// Those of `make`.
pub fn passing<F: AsRef<Path>>(make: impl FnOnce() -> io::Result<F>) -> io::Result<F> {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let mut pipe = [-1; 2];
        // SAFETY: fills both numbers, or fails; then all is as without this function.
        if unsafe { libc::pipe(pipe.as_mut_ptr()) } != 0 {
            return;
        }
        for stream in pipe {
            // SAFETY: a browser that is opened shall not get it.
            unsafe { libc::fcntl(stream, libc::F_SETFD, libc::FD_CLOEXEC) };
        }
        let remove = move || remove_at_signal(pipe[0]);
        if std::thread::Builder::new().spawn(remove).is_ok() {
            WAKES.store(pipe[1], Ordering::Relaxed);
            handle();
        }
    });
    // Who removes waits until a folder that is there is known.
    let mut passing = PASSING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = make()?;
    passing.push(folder.as_ref().to_owned());
    Ok(folder)
}

/// Waits for the handler's signal, and ends the process by it if nobody else does.
fn remove_at_signal(pipe: libc::c_int) {
    let mut byte = [0; size_of::<libc::c_int>()];
    // SAFETY: reads at most so many bytes as there are.
    while unsafe { libc::read(pipe, byte.as_mut_ptr().cast(), byte.len()) } > 0 {
        let signal = libc::c_int::from_ne_bytes(byte);
        if FINISHES.load(Ordering::Relaxed) {
            if signal == libc::SIGINT {
                continue;
            }
            std::thread::sleep(GRACE);
            if FINISHING.load(Ordering::Relaxed) {
                continue;
            }
        }
        let passing = PASSING.lock().unwrap_or_else(PoisonError::into_inner);
        for folder in &*passing {
            // The process may write into it while it goes.
            for _ in 0..10 {
                if fs::remove_dir_all(folder).is_ok() || !folder.exists() {
                    break;
                }
            }
        }
        // SAFETY: the handler has set the action of this signal to the usual one, which ends the
        // process.
        unsafe { libc::raise(signal) };
    }
}

/// Waits for the end where a signal has come and what goes with the process is being removed: what
/// fails meanwhile fails for that, and the signal is how the process ends.
pub fn leave_to_signal() {
    let removes = WAKES.load(Ordering::Relaxed) >= 0 && !FINISHES.load(Ordering::Relaxed);
    if removes && ended() {
        std::thread::sleep(std::time::Duration::from_secs(10));
    }
}

fn handle() {
    let handler = end as extern "C" fn(libc::c_int);
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        // SAFETY: the handler only stores to an atomic and sets a signal's action.
        let before = unsafe { libc::signal(signal, handler as libc::sighandler_t) };
        if signal == libc::SIGHUP && before == libc::SIG_IGN {
            // `nohup` wants the process to outlive its terminal.
            // SAFETY: sets no handler, only that the signal is ignored, as it was.
            unsafe { libc::signal(signal, libc::SIG_IGN) };
        }
    }
}

/// Whether the user wants the process to end; who learns it finishes the files.
pub fn ended() -> bool {
    let ended = ENDED.load(Ordering::Relaxed);
    if ended {
        finish();
    }
    ended
}

/// From now on a signal lets the process finish its files, however long that takes.
pub fn finish() {
    FINISHING.store(true, Ordering::Relaxed);
}

/// Columns of the terminal at standard error; `None` where it does not say.
pub fn terminal_width() -> Option<usize> {
    let mut size = libc::winsize {
        ws_row: 0,
        ws_col: 0,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    // SAFETY: fills the structure, or fails and leaves it as it is.
    let asked = unsafe { libc::ioctl(2, libc::TIOCGWINSZ, &raw mut size) };
    (asked == 0 && size.ws_col > 0).then_some(usize::from(size.ws_col))
}
