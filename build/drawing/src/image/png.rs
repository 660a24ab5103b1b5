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
    let data = compressed(raw, width * channels, channels);
    of_compressed(width, height, channels, &data)
}

/// The same of what [`compressed`] gives.
pub fn of_compressed(width: usize, height: usize, channels: usize, data: &[u8]) -> Vec<u8> {
    let mut file = File::new();
    file.header(width, height, if channels == 3 { 2 } else { 6 });
    file.chunk(*b"IDAT", data);
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
    let mut rows = Rows::new(row, pixel);
    rows.push(raw);
    rows.end()
}

/// The same, of rows that come one after the other.
pub struct Rows {
    pixel: usize,
    above: Vec<u8>,
    /// The least that is known of a row, and another try.
    best: Vec<u8>,
    tried: Vec<u8>,
    encoder: ZlibEncoder<Vec<u8>>,
}

impl Rows {
    /// The arguments are those of [`compressed`].
    pub fn new(row: usize, pixel: usize) -> Self {
        Self {
            pixel,
            above: vec![0; row],
            best: vec![0; row],
            tried: vec![0; row],
            encoder: ZlibEncoder::new(Vec::new(), Compression::new(7)),
        }
    }

    /// Appends whole rows.
    pub fn push(&mut self, raw: &[u8]) {
        let row = self.above.len();
        let mut filtered = Vec::with_capacity(raw.len() + raw.len() / row.max(1));
        for line in raw.chunks_exact(row) {
            let kinds = if self.pixel == 0 { 1 } else { 5 };
            let mut least = None;
            for kind in 0..kinds {
                filter(kind, line, &self.above, self.pixel, &mut self.tried);
                let sizes = self.tried.iter();
                let cost: u32 = sizes.map(|&b| u32::from(b.min(b.wrapping_neg()))).sum();
                if least.is_none_or(|(_, known)| cost < known) {
                    least = Some((kind, cost));
                    std::mem::swap(&mut self.best, &mut self.tried);
                }
            }
            filtered.extend(least.map(|(kind, _)| kind));
            filtered.extend(&self.best);
            self.above.copy_from_slice(line);
        }
        // Writing to memory cannot fail.
        _ = self.encoder.write_all(&filtered);
    }

    /// All of them.
    pub fn end(self) -> Vec<u8> {
        self.encoder.finish().unwrap_or_default()
    }
}

/// The differences of a row to what a filter expects.
fn filter(kind: u8, line: &[u8], above: &[u8], pixel: usize, out: &mut [u8]) {
    let start = pixel.min(line.len());
    for i in 0..start {
        out[i] = line[i].wrapping_sub(expected(kind, line, above, i, pixel));
    }
    let (now, out) = (&line[start..], &mut out[start..]);
    let left = &line[..now.len()];
    let (up, up_left) = (&above[start..], &above[..now.len()]);
    // One loop for each kind, which the compiler makes fast.
    match kind {
        1 => {
            for ((out, x), a) in out.iter_mut().zip(now).zip(left) {
                *out = x.wrapping_sub(*a);
            }
        }
        2 => {
            for ((out, x), b) in out.iter_mut().zip(now).zip(up) {
                *out = x.wrapping_sub(*b);
            }
        }
        3 => {
            for (((out, x), a), b) in out.iter_mut().zip(now).zip(left).zip(up) {
                *out = x.wrapping_sub(a.midpoint(*b));
            }
        }
        4 => {
            for ((((out, x), a), b), c) in out.iter_mut().zip(now).zip(left).zip(up).zip(up_left) {
                *out = x.wrapping_sub(nearest(*a, *b, *c));
            }
        }
        _ => out.copy_from_slice(now),
    }
}

/// Paeth's: of left, above and above left the one nearest to their sum and difference.
fn nearest(a: u8, b: u8, c: u8) -> u8 {
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
        4 => nearest(a, b, c),
        _ => 0,
    }
}
