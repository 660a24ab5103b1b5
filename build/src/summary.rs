//! The report of `export`: the file, the robot, every assumption.

use crate::info::{around, count, interfaces, parts, short, total_mass};
use crate::stage::{Fmu, Robot};
use std::fmt::Write as _;
use std::path::Path;
use urdf2fmu_core::diagnostic::Severity;
use urdf2fmu_core::spatial::Vec3;
use urdf2fmu_core::variables::Slot;
use urdf2fmu_drawing::picture::{Camera, Look};

/// The report of `picture`: the file, and the camera for whoever wants to take the same picture.
pub fn picture(output: &Path, bytes: usize, look: &Look, camera: &Camera) -> String {
    let vector = |v: &Vec3| {
        let [x, y, z] = [v.x, v.y, v.z].map(|x| rounded(x, 6));
        format!("({x}, {y}, {z})")
    };
    format!(
        "{}  {}, {} by {} pixels\n  camera     at {} m, towards {} m, field of view {} degrees\n",
        output.display(),
        size(bytes),
        look.width,
        look.height,
        vector(&camera.eye),
        vector(&camera.target),
        camera.field_of_view,
    )
}

/// A number without "-0.0".
pub fn rounded(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// The report of `picture --run`.
pub fn film(output: &Path, bytes: usize, look: &Look, pictures: usize) -> String {
    format!(
        "{}  {}, {}, {} by {} pixels\n",
        output.display(),
        size(bytes),
        count(pictures, "picture"),
        look.width,
        look.height,
    )
}

/// A few lines of plain text.
pub fn text(output: &Path, fmu: &Fmu, robot: &Robot) -> String {
    let model = &robot.model;
    let number_of = |f: fn(&Slot) -> bool| robot.table.iter().filter(|v| f(&v.slot)).count();
    let mut out = format!(
        "{}  {}, FMI {} {}, {}\n",
        output.display(),
        size(fmu.bytes.len()),
        robot.settings.fmu.fmi,
        interfaces(model),
        fmu.platforms.join(" "),
    );
    _ = writeln!(
        out,
        "  robot      {}: {} base, {}, {} kg",
        model.name,
        if model.is_floating() {
            "floating"
        } else {
            "fixed"
        },
        parts(model),
        short(total_mass(model)),
    );
    let around = around(model);
    if !around.is_empty() {
        _ = writeln!(out, "  around it  {around}");
    }
    _ = writeln!(
        out,
        "  variables  {}, {}, {}",
        count(number_of(|s| matches!(s, Slot::Input(_))), "input"),
        count(
            number_of(|s| matches!(s, Slot::Output(slot) if !slot.local())),
            "output"
        ),
        count(number_of(|s| matches!(s, Slot::Parameter(_))), "parameter"),
    );
    let assumptions: Vec<_> = robot
        .diagnostics
        .iter()
        // That a tag is read is no assumption.
        .filter(|d| d.severity == Severity::Note && d.code != "U023")
        .collect();
    if !assumptions.is_empty() {
        out.push_str("  assumed (urdf2fmu check says how to change it)\n");
    }
    let urdf = robot.sources.first().map(|path| path.display().to_string());
    for assumption in assumptions {
        let place = assumption.place.as_ref().map_or_else(String::new, |p| {
            if urdf.as_ref() == Some(&p.file) {
                format!(" (line {})", p.line)
            } else {
                format!(" ({}:{})", p.file, p.line)
            }
        });
        let lines = wrap(&format!("{}{place}", assumption.message), 92);
        _ = writeln!(out, "    - {}", lines.join("\n      "));
    }
    out
}

/// Lines of at most `width` characters, broken between words; a longer word stands alone.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is a first line");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// `1.2 MB`
fn size(bytes: usize) -> String {
    let bytes = u32::try_from(bytes).map_or(f64::from(u32::MAX), f64::from);
    if bytes < 1e6 {
        format!("{:.0} kB", (bytes / 1e3).max(1.0))
    } else {
        format!("{:.1} MB", bytes / 1e6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera in front looks along an axis, where sums of products are -1e-17.
    #[test]
    fn places_have_no_negative_zero() {
        let found = [-1e-17, -4e-7, -0.0, -0.5, 0.25].map(|x| rounded(x, 6));
        let expected = ["0.000000", "0.000000", "0.000000", "-0.500000", "0.250000"];
        assert_eq!(found, expected);
    }

    #[test]
    fn wrap_breaks_between_words_only() {
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(wrap("extraordinary a b", 3), ["extraordinary", "a b"]);
    }

    #[test]
    fn size_is_readable() {
        assert_eq!(size(10), "1 kB");
        assert_eq!(size(532_800), "533 kB");
        assert_eq!(size(1_234_567), "1.2 MB");
    }
}
