//! PNG: writing images and animations, and the parts that reading needs, too.
//!
//! Source: ISO/IEC 15948 (PNG), and the APNG specification 1.0.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// First bytes of a file.
pub const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The content of a PNG file of 8 bits.
///
/// - `channels`: 3 for colour, 4 with alpha
/// - `raw`: the numbers of all pixels, row by row from the top
pub fn encode(width: usize, height: usize, channels: usize, raw: &[u8]) -> Vec<u8> {
    let mut file = File::new();
    file.header(width, height, if channels == 3 { 2 } else { 6 });
    file.chunk(*b"IDAT", &compressed(raw, width * channels, channels));
    file.end()
}

/// A PNG file in the making.
pub struct File(Vec<u8>);

impl File {
    /// Nothing but the signature.
    pub fn new() -> Self {
        Self(SIGNATURE.to_vec())
    }

    /// The first chunk.
    ///
    /// - `kind`: 2 colour, 3 palette, 6 colour and alpha; all of 8 bits
    pub fn header(&mut self, width: usize, height: usize, kind: u8) {
        let mut data = [width, height].map(big).concat();
        data.extend([8, kind, 0, 0, 0]);
        self.chunk(*b"IHDR", &data);
    }

    /// Appends a chunk with its sum.
    pub fn chunk(&mut self, name: [u8; 4], data: &[u8]) {
        self.0.extend(big(data.len()));
        self.0.extend(name);
        self.0.extend(data);
        let mut check = crc32fast::Hasher::new();
        check.update(&name);
        check.update(data);
        self.0.extend(check.finalize().to_be_bytes());
    }

    /// Appends the last chunk.
    pub fn end(mut self) -> Vec<u8> {
        self.chunk(*b"IEND", &[]);
        self.0
    }
}

/// Four bytes, the highest first; a picture has no number that needs more.
pub fn big(x: usize) -> [u8; 4] {
    u32::try_from(x).unwrap_or(u32::MAX).to_be_bytes()
}

/// Rows of bytes, each with the filter whose differences are smallest, compressed.
///
/// - `row`: bytes of a row
/// - `pixel`: bytes of a pixel; 0 for places in a palette, whose differences mean nothing
pub fn compressed(raw: &[u8], row: usize, pixel: usize) -> Vec<u8> {
    let mut filtered = Vec::with_capacity(raw.len() + raw.len() / row.max(1));
    let nothing = vec![0; row];
    let mut above = nothing.as_slice();
    for line in raw.chunks_exact(row) {
        let kinds = if pixel == 0 { 0..1 } else { 0..5 };
        let candidates = kinds.map(|kind| {
            let mut bytes = vec![kind];
            bytes.extend(
                (0..row).map(|i| line[i].wrapping_sub(expected(kind, line, above, i, pixel))),
            );
            bytes
        });
        let cost = |bytes: &Vec<u8>| -> u32 {
            let sizes = bytes[1..]
                .iter()
                .map(|&b| u32::from(b.min(b.wrapping_neg())));
            sizes.sum()
        };
        filtered.extend(candidates.min_by_key(cost).unwrap_or_default());
        above = line;
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(7));
    // Writing to memory cannot fail.
    _ = encoder.write_all(&filtered);
    encoder.finish().unwrap_or_default()
}

/// What a filter expects at byte `i` of a row whose bytes before it are known.
pub fn expected(kind: u8, line: &[u8], above: &[u8], i: usize, pixel: usize) -> u8 {
    let left = |row: &[u8]| {
        if i >= pixel && pixel > 0 {
            row[i - pixel]
        } else {
            0
        }
    };
    let (a, b, c) = (left(line), above[i], left(above));
    match kind {
        1 => a,
        2 => b,
        3 => a.midpoint(b),
        4 => {
            let [x, y, z] = [a, b, c].map(i16::from);
            let estimate = x + y - z;
            let off = [x, y, z].map(|known| (estimate - known).abs());
            if off[0] <= off[1] && off[0] <= off[2] {
                a
            } else if off[1] <= off[2] {
                b
            } else {
                c
            }
        }
        _ => 0,
    }
}
