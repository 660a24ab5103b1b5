//! What holds the numbers of glTF: the binary chunk, files beside it and `data:` URIs.

use super::super::faces::{LFS_POINTER, MeshError};
use super::json::{Scenes, View};
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

pub(super) fn problem(what: impl Into<String>) -> MeshError {
    MeshError::Content(what.into())
}

/// What a buffer's numbers are.
pub(super) enum Buffer {
    Held(Vec<u8>),
    /// The file of this name is not there; an error once a number of it is wanted.
    Missing(String),
}

/// The JSON and the binary chunk of a `.glb`; a file that does not begin as one is JSON alone.
pub(super) fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), MeshError> {
    let word = |at: usize| {
        let four = bytes.get(at..)?.first_chunk::<4>()?;
        usize::try_from(u32::from_le_bytes(*four)).ok()
    };
    if !bytes.starts_with(b"glTF") {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if !text.trim_ascii_start().starts_with(b"{") {
            return Err(problem("no glTF file"));
        }
        return Ok((text, &[]));
    }
    match word(4) {
        Some(2) => {}
        Some(version) => known_version(&version.to_string())?,
        None => return Err(problem("the file is cut short")),
    }
    let chunk = |at: usize, kind: &[u8; 4]| {
        let length = word(at)?;
        let body = bytes.get(at + 8..)?.get(..length)?;
        (bytes.get(at + 4..at + 8)? == kind).then_some(body)
    };
    let json = chunk(12, b"JSON").ok_or_else(|| problem("the file is cut short"))?;
    // Chunks end on multiples of four bytes.
    let next = 20 + json.len().next_multiple_of(4);
    Ok((json, chunk(next, b"BIN\0").unwrap_or_default()))
}

/// All buffers of a file.
///
/// - `beside`: content of a file that it names, `None` where it cannot be had
pub(super) fn read(
    scenes: &Scenes,
    binary: &[u8],
    mut beside: impl FnMut(&str) -> Option<Result<Vec<u8>, MeshError>>,
) -> Result<Vec<Buffer>, MeshError> {
    let mut list = Vec::with_capacity(scenes.buffers.len());
    for (i, buffer) in scenes.buffers.iter().enumerate() {
        list.push(match &buffer.uri {
            None if i == 0 => Buffer::Held(binary.to_vec()),
            None => Buffer::Held(Vec::new()),
            Some(uri) if is_data(uri) => Buffer::Held(data(uri)?),
            Some(name) => match beside(name) {
                Some(content) => {
                    let content = content?;
                    if content.starts_with(LFS_POINTER) {
                        return Err(MeshError::Pointer);
                    }
                    Buffer::Held(content)
                }
                None => Buffer::Missing(name.clone()),
            },
        });
    }
    Ok(list)
}

/// The bytes of a view.
pub(super) fn view<'d>(buffers: &'d [Buffer], view: &View) -> Result<&'d [u8], MeshError> {
    match buffers.get(view.buffer) {
        Some(Buffer::Held(bytes)) => bytes
            .get(view.byte_offset..)
            .and_then(|rest| rest.get(..view.byte_length))
            .ok_or_else(|| problem("the file is cut short")),
        Some(Buffer::Missing(name)) => Err(problem(format!(
            "its file {name} is not beside it, in the robot's folders"
        ))),
        None => Err(problem(format!("there is no buffer {}", view.buffer))),
    }
}

pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5)
        .is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The bytes of a `data:` URI (RFC 2397) in base64; no exporter writes another one.
pub(super) fn data(uri: &str) -> Result<Vec<u8>, MeshError> {
    // Some exporters leave the padding out.
    const ANY_PADDING: GeneralPurpose = GeneralPurpose::new(
        &STANDARD,
        GeneralPurposeConfig::new()
            .with_decode_padding_mode(DecodePaddingMode::Indifferent)
            .with_decode_allow_trailing_bits(true),
    );
    let (_, content) = uri
        .split_once(";base64,")
        .ok_or_else(|| problem("a data: URI is not in base64"))?;
    ANY_PADDING
        .decode(content.trim())
        .map_err(|error| problem(format!("a data: URI is no base64: {error}")))
}

/// Refuses a version of the standard that is not the second, as `1.0`; one that nobody has written
/// counts as that.
pub(super) fn known_version(version: &str) -> Result<(), MeshError> {
    if version.is_empty() || version == "2" || version.starts_with("2.") {
        return Ok(());
    }
    let what = format!("it is glTF {version}; glTF 2 is read: export it again");
    Err(problem(what))
}
