//! Opens the page in the browser of the user.
//!
//! The key does not go on a command line, which other users of the machine can read: the browser
//! gets a file that only this user can read, and that leads to the address.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// Opens an address; false where there is no screen.
///
/// - `folder`: private, and there for as long as the program runs
///
/// # Errors
/// The system's, where no browser can be started.
pub fn open(address: &str, folder: &Path) -> io::Result<bool> {
    let screen = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let unix = cfg!(all(unix, not(target_os = "macos")));
    if unix && !screen("DISPLAY") && !screen("WAYLAND_DISPLAY") {
        return Ok(false);
    }
    let file = folder.join("open.html");
    std::fs::write(
        &file,
        format!(
            "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" \
             content=\"no-referrer\"><meta http-equiv=\"refresh\" content=\"0;url={address}\">\
             <a href=\"{address}\">robot</a>\n"
        ),
    )?;
    let mut command = if cfg!(windows) {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        command
    } else {
        Command::new(if unix { "xdg-open" } else { "open" })
    };
    let quiet = command
        .arg(&file)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    quiet.spawn()?;
    Ok(true)
}
