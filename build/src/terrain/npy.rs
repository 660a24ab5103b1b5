//! NPY files of one or two dimensions.
//!
//! The header is one line, so this is read here: a package for it brings a generator of parsers.
//! Source: `NumPy` Enhancement Proposal 1.

/// A table of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct Array {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Row by row.
    pub(super) values: Vec<f64>,
    /// Bytes behind it.
    pub(super) behind: usize,
}

/// What is wrong with a file.
pub(super) type Wrong = &'static str;

/// Reads a file.
pub(super) fn read(bytes: &[u8]) -> Result<Array, Wrong> {
    let rest = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or("it is no NPY file")?;
    let (&[major, _], rest) = rest.split_first_chunk::<2>().ok_or("it ends early")?;
    let (length, rest) = if major == 1 {
        let (length, rest) = rest.split_first_chunk::<2>().ok_or("it ends early")?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk::<4>().ok_or("it ends early")?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (header, data) = rest.split_at_checked(length).ok_or("it ends early")?;
    let header = std::str::from_utf8(header).map_err(|_| "its header is no text")?;
    let kind = after(header, "'descr'").ok_or("its header has no 'descr'")?;
    let kind = kind.split('\'').nth(1).ok_or("its header has no 'descr'")?;
    let columns_first = after(header, "'fortran_order'")
        .ok_or("its header has no 'fortran_order'")?
        .trim_start_matches([':', ' '])
        .starts_with("True");
    let shape = after(header, "'shape'").ok_or("its header has no 'shape'")?;
    let shape = shape
        .split_once('(')
        .and_then(|(_, rest)| rest.split_once(')'))
        .ok_or("its header has no 'shape'")?;
    let shape: Result<Vec<usize>, _> = shape
        .0
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .map(str::parse)
        .collect();
    let [rows, columns] = shape.map_err(|_| "its shape is no list of numbers")?[..] else {
        return Err("it needs two dimensions");
    };
    let count = rows.checked_mul(columns).ok_or("its shape is too large")?;
    let (numbers, width) = numbers(kind, data)?;
    if numbers.len() < count {
        return Err("it ends early");
    }
    let values = (0..count).map(|k| {
        let at = if columns_first {
            (k % columns) * rows + k / columns
        } else {
            k
        };
        numbers[at]
    });
    Ok(Array {
        rows,
        columns,
        values: values.collect(),
        behind: data.len() - count * width,
    })
}

fn after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    header.split_once(key).map(|(_, rest)| rest)
}

/// The numbers of a file by the name of their kind, and the bytes of each.
fn numbers(kind: &str, data: &[u8]) -> Result<(Vec<f64>, usize), Wrong> {
    fn all<const N: usize>(
        data: &[u8],
        big: bool,
        number: impl Fn([u8; N]) -> f64,
    ) -> (Vec<f64>, usize) {
        let (chunks, _) = data.as_chunks::<N>();
        let turned = |mut bytes: [u8; N]| {
            if big {
                bytes.reverse();
            }
            bytes
        };
        let numbers = chunks.iter().map(|bytes| number(turned(*bytes)));
        (numbers.collect(), N)
    }
    let (order, name) = kind
        .split_at_checked(1)
        .ok_or("its kind of numbers is empty")?;
    let big = order == ">";
    #[expect(clippy::cast_precision_loss, reason = "heights have few digits")]
    Ok(match name {
        "f8" => all(data, big, f64::from_le_bytes),
        "f4" => all(data, big, |b| f64::from(f32::from_le_bytes(b))),
        "f2" => all(data, big, |b| half(u16::from_le_bytes(b))),
        "i8" => all(data, big, |b| i64::from_le_bytes(b) as f64),
        "u8" => all(data, big, |b| u64::from_le_bytes(b) as f64),
        "i4" => all(data, big, |b| f64::from(i32::from_le_bytes(b))),
        "u4" => all(data, big, |b| f64::from(u32::from_le_bytes(b))),
        "i2" => all(data, big, |b| f64::from(i16::from_le_bytes(b))),
        "u2" => all(data, big, |b| f64::from(u16::from_le_bytes(b))),
        "i1" => all(data, big, |b| f64::from(i8::from_le_bytes(b))),
        "u1" => all(data, big, |[b]| f64::from(b)),
        _ => return Err("its numbers are neither integers nor of 2, 4 or 8 bytes with a point"),
    })
}

/// A number of the IEEE 754 format binary16.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    match exponent {
        0 => sign * fraction * 2.0_f64.powi(-14),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * (1.0 + fraction) * 2.0_f64.powi(exponent - 15),
    }
}
