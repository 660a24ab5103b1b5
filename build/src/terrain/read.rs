//! Heights from files: PNG, CSV, NPY.

use super::npy;
use std::io::ErrorKind;
use std::path::Path;
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::diagnostic::words::or_meant;
use urdf2fmu_core::encoding;
use urdf2fmu_core::geometry::field::MOST_SAMPLES;
use urdf2fmu_core::reading;
use urdf2fmu_core::urdf::LFS_POINTER;

/// Files larger than this, in bytes, hold no terrain that could be used.
const LARGEST_FILE: u64 = 256 << 20;

/// Heights over a grid.
#[derive(Debug)]
pub(super) struct Table {
    /// Along x and y.
    pub(super) counts: [usize; 2],
    /// Row by row from the lowest y.
    pub(super) values: Vec<f64>,
    /// What it has beside its heights.
    pub(super) unused: Option<Unused>,
}

/// What a file has that is not used.
#[derive(Debug)]
pub(super) struct Unused {
    pub(super) severity: Severity,
    /// With its verb.
    pub(super) what: String,
    pub(super) help: &'static str,
}

/// What helps where a file cannot be read.
pub(super) const UNREAD: &str =
    "name a file that can be read; a relative one counts from the folder of the settings";

/// What is wrong with a file.
#[derive(Debug)]
pub(super) struct Wrong {
    pub(super) code: &'static str,
    pub(super) message: String,
    pub(super) help: &'static str,
}

fn wrong(message: impl Into<String>, help: &'static str) -> Wrong {
    Wrong {
        code: "T002",
        message: message.into(),
        help,
    }
}

/// Reads the heights of a file, by its ending.
pub(super) fn heights(path: &Path) -> Result<Table, Wrong> {
    let unread = |message: String| Wrong {
        code: "T001",
        message,
        help: UNREAD,
    };
    let read = reading::read_lasting(path, LARGEST_FILE);
    let bytes = read.map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => wrong(error.to_string(), "give it with fewer samples"),
        _ => unread(format!("{error}{}", or_meant(path, &error))),
    })?;
    if bytes.starts_with(LFS_POINTER) {
        let help = "fetch the file itself with 'git lfs pull'";
        return Err(wrong(
            "it is a pointer of Git LFS, not the file itself",
            help,
        ));
    }
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    heights_of(ending, &bytes)
}

/// Heights of a file's bytes, by the ending of its name.
pub(super) fn heights_of(ending: &str, bytes: &[u8]) -> Result<Table, Wrong> {
    let table = match ending.to_ascii_lowercase().as_str() {
        "png" => image(bytes),
        "npy" => array(bytes),
        "csv" | "txt" => table(bytes),
        _ => {
            let message = format!("'{ending}' is no kind of file that heights are read from");
            return Err(wrong(message, "give a .png, .npy or .csv"));
        }
    }?;
    let [nx, ny] = table.counts;
    if nx.min(ny) < 2 || nx.saturating_mul(ny) > MOST_SAMPLES {
        let message = format!("it has {nx} x {ny} heights");
        return Err(wrong(message, "give at least 2 x 2, and at most 4,000,000"));
    }
    if let Some(k) = table.values.iter().position(|h| !h.is_finite()) {
        let message = format!(
            "height {} of row {} is not a finite number",
            k % nx + 1,
            k / nx + 1
        );
        return Err(wrong(message, "give a number for each height"));
    }
    Ok(table)
}

/// Brightness of a grey image, 0 … 1.
fn image(bytes: &[u8]) -> Result<Table, Wrong> {
    let damaged = |error: png::DecodingError| {
        wrong(
            format!("the PNG cannot be read: {error}"),
            "save it again as a grey PNG",
        )
    };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (width, height, colors) = {
        let info = reader.info();
        let palette = info.palette.as_ref().map_or(0, |palette| palette.len());
        (info.width as usize, info.height as usize, palette)
    };
    // The decoder takes each colour for whole.
    if colors % 3 != 0 {
        return Err(wrong(
            format!("the PNG's palette has {colors} bytes, which are no colours of three each"),
            "save it again as a grey PNG",
        ));
    }
    if width.saturating_mul(height) > MOST_SAMPLES {
        let message = format!("it has {width} x {height} pixels");
        return Err(wrong(message, "give at most 4,000,000"));
    }
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let frame = reader.next_frame(&mut pixels).map_err(damaged)?;
    let samples = frame.color_type.samples();
    let wide = frame.bit_depth == png::BitDepth::Sixteen;
    let bytes_each = if wide { 2 } else { 1 };
    let number = |at: usize| {
        if wide {
            f64::from(u16::from_be_bytes([pixels[at], pixels[at + 1]])) / 65535.0
        } else {
            f64::from(pixels[at]) / 255.0
        }
    };
    let mut values = Vec::with_capacity(width * height);
    let mut alpha = false;
    for row in (0..height).rev() {
        for column in 0..width {
            let at = row * frame.line_size + column * samples * bytes_each;
            let grey = number(at);
            if samples >= 3 {
                let others = [1, 2].map(|k| pixels[at + k * bytes_each..][..bytes_each].to_vec());
                if others.iter().any(|o| o[..] != pixels[at..at + bytes_each]) {
                    let message = format!("pixel {} of row {} has a colour", column + 1, row + 1);
                    return Err(wrong(
                        message,
                        "give a grey image: its brightness is the height",
                    ));
                }
            }
            if samples % 2 == 0 {
                alpha |= number(at + (samples - 1) * bytes_each) < 1.0;
            }
            values.push(grey);
        }
    }
    Ok(Table {
        counts: [width, height],
        values,
        unused: alpha.then(|| Unused {
            severity: Severity::Note,
            what: "its alpha is".to_owned(),
            help: "the brightness alone is the height: save it as a grey PNG",
        }),
    })
}

fn array(bytes: &[u8]) -> Result<Table, Wrong> {
    let help = "save an array of floats of two dimensions, rows along y and columns along x: \
                numpy.save(file, heights.astype(float))";
    let array = npy::read(bytes).map_err(|message| wrong(message, help))?;
    Ok(Table {
        counts: [array.columns, array.rows],
        values: array.values,
        unused: (array.behind > 0).then(|| Unused {
            severity: Severity::Warning,
            what: format!("{} bytes behind its array are", array.behind),
            help: "save one array to each file",
        }),
    })
}

/// Numbers between commas, semicolons, blanks or tabs; lines that begin with # are comments.
fn table(bytes: &[u8]) -> Result<Table, Wrong> {
    let text = encoding::text(bytes.to_vec());
    let text = text.map_err(|_| wrong("it is no text", "save the heights as a CSV file"))?;
    let text = text.trim_start_matches('\u{feff}');
    let (mut values, mut columns, mut rows) = (Vec::new(), 0, 0);
    for (k, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let line = line.trim_end_matches([',', ';']);
        if line.contains(',') && line.contains(';') {
            // In some countries 1,5;2,5 are two numbers, in others four.
            return Err(wrong(
                format!("line {} has commas and semicolons", k + 1),
                "write numbers with a point, and one sign between them",
            ));
        }
        let separated: Vec<&str> = if line.contains([',', ';']) {
            line.split([',', ';']).map(str::trim).collect()
        } else {
            line.split_whitespace().collect()
        };
        for (column, part) in separated.iter().enumerate() {
            // Some programs write all cells in quotes.
            let inner = part
                .strip_prefix('"')
                .and_then(|part| part.strip_suffix('"'));
            let part = inner.unwrap_or(part);
            let number: f64 = part.parse().map_err(|_| {
                let message = format!(
                    "line {}, column {}: '{part}' is no number",
                    k + 1,
                    column + 1
                );
                wrong(message, "give heights in m, and no row of names")
            })?;
            values.push(number);
        }
        if rows > 0 && separated.len() != columns {
            let message = format!(
                "line {} has {} heights, the lines before have {columns}",
                k + 1,
                separated.len()
            );
            return Err(wrong(message, "give every row as many heights"));
        }
        columns = separated.len();
        rows += 1;
    }
    Ok(Table {
        counts: [columns, rows],
        values,
        unused: None,
    })
}
