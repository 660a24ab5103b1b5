//! Candidate folders for the resource location that an importer passes.
//!
//! The standard asks for a URI (RFC 3986). Importers pass `file:///…`, `file:/…`, `file:////…`,
//! `file://localhost/…` and plain paths, percent-encoded or not, with or without a trailing slash,
//! and folders may have `%`, `#` or `?` in their names. Therefore nothing is removed, only valid
//! `%HH` is decoded, and both readings are returned where they differ. The caller takes the folder
//! that exists.

use std::path::PathBuf;

/// Why a resource location names no folder.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum UriError {
    /// NULL or "".
    #[error("is empty")]
    Empty,
    /// `http:` and the like.
    #[error("is '{uri}' with the scheme '{scheme}', but only 'file' can be read")]
    Scheme {
        /// As passed.
        uri: String,
        /// Its scheme.
        scheme: String,
    },
    /// `file://host/…` on a system without network paths.
    #[error("is '{uri}' with the host '{host}', but only files of this machine can be read")]
    Host {
        /// As passed.
        uri: String,
        /// Its authority.
        host: String,
    },
}

/// Folders that `uri` may mean, the likeliest first.
///
/// # Errors
/// [`UriError`] if it can mean none.
pub(crate) fn folders(uri: &[u8]) -> Result<Vec<PathBuf>, UriError> {
    Ok(paths(uri, cfg!(windows))?
        .iter()
        .map(|path| to_path(path))
        .collect())
}

#[cfg(unix)]
fn to_path(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    PathBuf::from(std::ffi::OsStr::from_bytes(bytes))
}

/// FMI's strings are UTF-8, but some importers on Windows pass, or percent-encode, bytes of the
/// machine's code page.
#[cfg(windows)]
fn to_path(bytes: &[u8]) -> PathBuf {
    use std::os::windows::ffi::OsStringExt;
    match std::str::from_utf8(bytes) {
        Ok(text) => PathBuf::from(text),
        Err(_) => std::ffi::OsString::from_wide(&code_page::decode(bytes)).into(),
    }
}

#[cfg(not(any(unix, windows)))]
fn to_path(bytes: &[u8]) -> PathBuf {
    PathBuf::from(String::from_utf8_lossy(bytes).into_owned())
}

#[cfg(windows)]
mod code_page {
    #![allow(unsafe_code, reason = "only Windows knows its code page")]

    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn MultiByteToWideChar(
            code_page: u32,
            flags: u32,
            bytes: *const u8,
            bytes_length: i32,
            wide: *mut u16,
            wide_length: i32,
        ) -> i32;
    }

    /// The machine's own, as Windows' functions without W take it.
    const ACTIVE: u32 = 0;

    /// UTF-16; empty where the bytes are too many for a path, which then is not found.
    pub(super) fn decode(bytes: &[u8]) -> Vec<u16> {
        // No code page makes more than two units of a byte.
        let mut wide = vec![0_u16; 2 * bytes.len()];
        let length = |length: usize| i32::try_from(length).unwrap_or(0);
        // SAFETY: both pointers are good for the lengths that are passed with them.
        let written = unsafe {
            MultiByteToWideChar(
                ACTIVE,
                0,
                bytes.as_ptr(),
                length(bytes.len()),
                wide.as_mut_ptr(),
                length(wide.len()),
            )
        };
        wide.truncate(usize::try_from(written).unwrap_or(0));
        wide
    }
}

/// [`folders`] as bytes, for either family of systems.
fn paths(uri: &[u8], windows: bool) -> Result<Vec<Vec<u8>>, UriError> {
    if uri.is_empty() {
        return Err(UriError::Empty);
    }
    let raw = match scheme(uri) {
        None => return Ok(vec![uri.to_vec()]),
        Some(scheme) if scheme.eq_ignore_ascii_case(b"file") => {
            local_part(uri, &uri[scheme.len() + 1..], windows)?
        }
        Some(scheme) => {
            return Err(UriError::Scheme {
                uri: text(uri),
                scheme: text(scheme),
            });
        }
    };
    let mut readings = Vec::with_capacity(2);
    for reading in [percent_decoded(&raw), raw] {
        let reading = if windows {
            without_slash_before_drive(&reading)
        } else {
            reading
        };
        if !readings.contains(&reading) {
            readings.push(reading);
        }
    }
    Ok(readings)
}

/// What stands before the first colon, if that is a scheme; a single letter is a drive.
fn scheme(uri: &[u8]) -> Option<&[u8]> {
    let scheme = &uri[..uri.iter().position(|&byte| byte == b':')?];
    let legal = |byte: &u8| byte.is_ascii_alphanumeric() || b"+-.".contains(byte);
    (scheme.len() > 1 && scheme[0].is_ascii_alphabetic() && scheme.iter().all(legal))
        .then_some(scheme)
}

/// The path in what follows `file:`.
fn local_part(uri: &[u8], rest: &[u8], windows: bool) -> Result<Vec<u8>, UriError> {
    let Some(after) = rest.strip_prefix(b"//") else {
        // file:/path, file:C:/path
        return Ok(rest.to_vec());
    };
    if after.starts_with(b"/") {
        // file:///path. Of more slashes, as in file:////path, one is left, but for a Windows
        // network path.
        let path = &after[after.iter().take_while(|&&byte| byte == b'/').count()..];
        let slashes: &[u8] = if windows && after.starts_with(b"//") && !is_drive(path) {
            b"//"
        } else {
            b"/"
        };
        return Ok([slashes, path].concat());
    }
    let end = after
        .iter()
        .position(|byte| b"/\\".contains(byte))
        .unwrap_or(after.len());
    let (host, path) = after.split_at(end);
    if is_drive(after) {
        // file://C:/path is wrong but common.
        Ok(after.to_vec())
    } else if host.eq_ignore_ascii_case(b"localhost") || host == b"127.0.0.1" {
        Ok(path.to_vec())
    } else if is_rooted(&percent_decoded(after)) {
        // file://%2Ftmp%2Ffmu, all of the path percent-encoded.
        Ok(after.to_vec())
    } else if windows {
        Ok([b"//", after].concat())
    } else {
        Err(UriError::Host {
            uri: text(uri),
            host: text(host),
        })
    }
}

/// Whether a path begins at the top of a file system.
fn is_rooted(path: &[u8]) -> bool {
    path.starts_with(b"/") || is_drive(path)
}

/// `C:` or `C|` at the start.
fn is_drive(path: &[u8]) -> bool {
    matches!(path, [letter, b':' | b'|', ..] if letter.is_ascii_alphabetic())
}

/// `/C:/fmu` and `/C|/fmu` as `C:/fmu`.
fn without_slash_before_drive(path: &[u8]) -> Vec<u8> {
    let mut path = match path {
        [b'/', rest @ ..] if is_drive(rest) => rest.to_vec(),
        _ => path.to_vec(),
    };
    if is_drive(&path) {
        path[1] = b':';
    }
    path
}

/// Replaces `%HH`; a `%` that is not followed by two hexadecimal digits stays, and so does `%00`.
#[cfg_attr(small, optimize(size))]
fn percent_decoded(path: &[u8]) -> Vec<u8> {
    let digit = |byte: u8| u8::try_from(char::from(byte).to_digit(16)?).ok();
    let mut decoded = Vec::with_capacity(path.len());
    let mut rest = path;
    while let [byte, tail @ ..] = rest {
        rest = tail;
        decoded.push(*byte);
        if let (b'%', [high, low, after @ ..]) = (byte, tail)
            && let (Some(high), Some(low)) = (digit(*high), digit(*low))
            && high + low > 0
        {
            decoded.pop();
            decoded.push(16 * high + low);
            rest = after;
        }
    }
    decoded
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(uri: &str, windows: bool) -> Vec<String> {
        paths(uri.as_bytes(), windows)
            .expect("a file location")
            .iter()
            .map(|path| text(path))
            .collect()
    }

    #[test]
    fn every_spelling_of_a_unix_path_gives_the_path() {
        for uri in [
            "file:///opt/fmu/resources",
            "file:/opt/fmu/resources",
            "file:////opt/fmu/resources",
            "file://localhost/opt/fmu/resources",
            "FILE:///opt/fmu/resources",
            "/opt/fmu/resources",
        ] {
            assert_eq!(read(uri, false), ["/opt/fmu/resources"], "{uri}");
        }
        assert_eq!(
            read("file:///opt/fmu/resources/", false),
            ["/opt/fmu/resources/"]
        );
    }

    #[test]
    fn every_spelling_of_a_windows_path_gives_the_path() {
        for uri in [
            "file:///C:/fmu/resources",
            "file:/C:/fmu/resources",
            "file:////C:/fmu/resources",
            "file://C:/fmu/resources",
            "file:C:/fmu/resources",
            "file:///C|/fmu/resources",
            "file://localhost/C:/fmu/resources",
            "C:/fmu/resources",
        ] {
            assert_eq!(read(uri, true), ["C:/fmu/resources"], "{uri}");
        }
        assert_eq!(read("file:///C%3A/a", true)[0], "C:/a");
        assert_eq!(read("C:\\fmu", true), ["C:\\fmu"]);
    }

    #[test]
    fn windows_network_paths_keep_their_host() {
        assert_eq!(
            read("file://server/share/fmu", true),
            ["//server/share/fmu"]
        );
        assert_eq!(
            read("file:////server/share/fmu", true),
            ["//server/share/fmu"]
        );
    }

    #[test]
    fn encoded_and_plain_characters_are_both_understood() {
        assert_eq!(read("file:///a%20b/caf%C3%A9/%23", false)[0], "/a b/café/#");
        assert_eq!(read("file:///a b/café/#?", false), ["/a b/café/#?"]);
    }

    #[test]
    fn a_path_whose_separators_are_encoded_is_no_host() {
        assert_eq!(read("file://%2Ftmp%2Ffmu", false)[0], "/tmp/fmu");
        assert_eq!(read("file://%2FC%3A%2Ffmu", true)[0], "C:/fmu");
        assert_eq!(read("file://C%3A%5Cfmu", true)[0], "C:\\fmu");
        assert!(paths(b"file://server%2Fb", false).is_err());
    }

    #[test]
    fn a_percent_sign_that_encodes_nothing_stays() {
        assert_eq!(read("file:///100%/50%zz/%4", false), ["/100%/50%zz/%4"]);
        assert_eq!(read("file:///a%00b", false), ["/a%00b"]);
    }

    #[test]
    fn a_folder_whose_name_looks_encoded_is_found() {
        assert_eq!(read("file:///a%20b", false), ["/a b", "/a%20b"]);
    }

    #[test]
    fn a_uri_that_names_no_local_file_is_refused() {
        assert_eq!(paths(b"", false), Err(UriError::Empty));
        assert!(matches!(
            paths(b"https://a/b", false),
            Err(UriError::Scheme { .. })
        ));
        assert!(matches!(
            paths(b"file://server/b", false),
            Err(UriError::Host { .. })
        ));
    }
}
