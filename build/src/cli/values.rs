//! Values of options, from their texts.

use clap::ValueEnum;
use std::path::PathBuf;
use urdf2fmu_core::range::{Range, number_or_ratio};
use urdf2fmu_drawing::picture::{Look, Toward};

/// Longest side of a picture, pixels.
const LONGEST_SIDE: usize = 4096;

/// `name:=value`.
pub(super) fn xacro_argument(text: &str) -> Result<String, String> {
    match text.split_once(":=") {
        Some((name, _)) if !name.is_empty() && !name.starts_with('-') => Ok(text.to_owned()),
        _ => Err(of_file(text).unwrap_or(
            "it belongs to no option, and arguments of xacro are written name:=value; an option \
             that takes one value is repeated for another one, as in --output-variable A \
             --output-variable B",
        )
        .to_owned()),
    }
}

/// What to do about a file that stands where arguments of xacro do.
fn of_file(text: &str) -> Option<&'static str> {
    let ending = std::path::Path::new(text).extension()?.to_str()?;
    Some(match ending.to_ascii_lowercase().as_str() {
        "csv" => {
            "a table of inputs is given by --input-file; report takes the results first and the \
             robot by --model: urdf2fmu report run.csv --model robot.urdf"
        }
        "toml" => "settings are given by --config; init writes them to --output",
        "urdf" | "xacro" | "fmu" => {
            "one robot is taken: report has it by --model, objects stand by --object, and further \
             robots in [[world.robot]] of the settings"
        }
        "srdf" => "an SRDF is given by --srdf",
        "html" | "png" | "svg" => "what is written is named by --output",
        _ => return None,
    })
}

/// A folder that is there.
pub(super) fn folder(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.is_dir() {
        Ok(path)
    } else if path.exists() {
        Err(format!("'{text}' is a file: give the folder"))
    } else {
        Err(format!("there is no folder '{text}'"))
    }
}

/// `name=folder`.
pub(super) fn package(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, dir)) if !name.is_empty() && !dir.is_empty() => {
            Ok((name.to_owned(), folder(dir)?))
        }
        _ => Err("write the name of the package and its folder, NAME=DIR".to_owned()),
    }
}

/// A number of a range.
fn number(range: Range, text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if range.contains(number) => Ok(number),
        _ => Err(format!("must be {}", range.expected())),
    }
}

pub(super) fn density(text: &str) -> Result<f64, String> {
    number(Range::Density, text)
}

pub(super) fn mass(text: &str) -> Result<f64, String> {
    number(Range::Mass, text)
}

pub(super) fn factor(text: &str) -> Result<f64, String> {
    number(Range::Scale, text)
}

pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    number(Range::Tolerance, text)
}

/// A time in s: a number, or a ratio such as `1/240`.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let time = number_or_ratio(text).filter(|time| !time.is_nan());
    time.ok_or_else(|| "must be a number of seconds, such as 0.01 or 1/240".to_owned())
}

/// `640x480`, or `512` for a square.
pub(super) fn size(text: &str) -> Result<[usize; 2], String> {
    let side = |text: &str| {
        let side = text.trim().parse::<usize>().ok();
        side.filter(|side| (16..=LONGEST_SIDE).contains(side))
    };
    let (width, height) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
    side(width)
        .and_then(|width| Some([width, side(height)?]))
        .ok_or_else(|| {
            format!(
                "give width x height in pixels, or one number for both, each 16 to {LONGEST_SIDE}, \
                 such as 640x480"
            )
        })
}

/// Pictures a second.
pub(super) fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (1.0..=60.0).contains(&rate) => Ok(rate),
        _ => Err("must be 1 to 60".to_owned()),
    }
}

/// A named place, or azimuth and elevation.
pub(super) fn place(text: &str) -> Result<Toward, String> {
    let at = |azimuth, elevation| Toward { azimuth, elevation };
    Ok(match text {
        // Robots look along x.
        "front" => at(0.0, 8.0),
        "back" => at(180.0, 8.0),
        "left" => at(90.0, 8.0),
        "right" => at(-90.0, 8.0),
        "top" => at(-90.0, 89.0),
        "corner" => Look::default().from,
        _ => {
            let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
            let numbers = text
                .split_once(',')
                .and_then(|(azimuth, elevation)| Some((number(azimuth)?, number(elevation)?)));
            match numbers {
                Some((azimuth, elevation)) if azimuth.abs() <= 360.0 && elevation.abs() <= 90.0 => {
                    at(azimuth, elevation)
                }
                _ => {
                    return Err(
                        "give front, back, left, right, top, corner, or azimuth (-360 … 360) and \
                         elevation (-90 … 90) in degrees, such as 120,15"
                            .to_owned(),
                    );
                }
            }
        }
    })
}

/// A speed of `view`.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let number = number.filter(|x| (0.01..=100.0).contains(x));
    number.ok_or_else(|| "must be 0.01 … 100".to_owned())
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum InterfaceChoice {
    /// Co-simulation
    Cs,
    /// Model Exchange
    Me,
    /// Both in one FMU
    Both,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ArrayStyle {
    /// Vectors of outputs and parameters
    Vectors,
    /// Nothing: the variables of FMI 2
    None,
    /// Vectors of inputs, too, and vectors over all joints
    All,
}
