//! Words that a misspelt name may have meant.

use crate::folder;
use std::path::{Path, PathBuf};

/// Words longer than this, and more candidates than this, are not compared: the work is their
/// product.
const MOST_COMPARED: (usize, usize) = (100, 5000);

/// What other programs, formats and trades call a thing, and the word of URDF or settings for it.
const SYNONYMS: &[(&str, &str)] = &[
    ("accelerometer", "imu"),
    ("accelerometer", "linear_acceleration"),
    ("ball", "spherical"),
    ("ball", "sphere"),
    ("body", "link"),
    ("bodies", "links"),
    ("body1", "links"),
    ("body2", "links"),
    ("bounce", "restitution"),
    ("box", "size"),
    ("bumper", "contact"),
    ("co-simulation", "cs"),
    ("cosimulation", "cs"),
    ("cube", "box"),
    ("d", "kd"),
    ("d", "damping"),
    ("damp", "damping"),
    ("damping", "dissipation"),
    ("density", "mass"),
    ("dt", "step_size"),
    ("euler", "rpy"),
    ("file", "filename"),
    ("fix", "fixed"),
    ("fixed", "static"),
    ("fixed", "weld"),
    ("fixed_base", "base"),
    ("force", "effort"),
    ("force_torque", "ft"),
    ("free", "floating"),
    ("frequency", "rate"),
    ("gpu_lidar", "ray"),
    ("gpu_ray", "ray"),
    ("gyro", "imu"),
    ("gyro", "angular_velocity"),
    ("heightmap", "heightfield"),
    ("heights", "heightfield"),
    ("height", "length"),
    ("hinge", "revolute"),
    ("k", "stiffness"),
    ("kind", "type"),
    ("laser", "ray"),
    ("lidar", "ray"),
    ("linear", "prismatic"),
    ("link1", "links"),
    ("link2", "links"),
    ("link_a", "links"),
    ("link_b", "links"),
    ("location", "xyz"),
    ("max", "upper"),
    ("max_effort", "effort"),
    ("max_range", "range"),
    ("max_step_size", "step_size"),
    ("min", "lower"),
    ("model-exchange", "me"),
    ("model_exchange", "me"),
    ("mu", "friction"),
    ("mu1", "friction"),
    ("name", "joint"),
    ("name", "link"),
    ("orientation", "rpy"),
    ("origin", "xyz"),
    ("p", "kp"),
    ("parent", "link"),
    ("path", "filename"),
    ("path", "file"),
    ("pin", "hinge"),
    ("pitch", "rpy"),
    ("pos", "xyz"),
    ("pose", "origin"),
    ("position", "xyz"),
    ("ppr", "counts"),
    ("r", "radius"),
    ("resolution", "counts"),
    ("rest_length", "length"),
    ("revolute", "hinge"),
    ("rgb", "rgba"),
    ("rigid", "weld"),
    ("roll", "rpy"),
    ("rotary", "revolute"),
    ("rotation", "rpy"),
    ("rotational", "revolute"),
    ("samples", "rays"),
    ("slide", "prismatic"),
    ("slider", "prismatic"),
    ("speed", "velocity"),
    ("step", "step_size"),
    ("time_step", "step_size"),
    ("timestep", "step_size"),
    ("torque", "effort"),
    ("touch", "contact"),
    ("transform", "origin"),
    ("update_rate", "rate"),
    ("uri", "filename"),
    ("url", "filename"),
    ("val", "value"),
    ("weld", "fixed"),
    ("x", "xyz"),
    ("y", "xyz"),
    ("yaw", "rpy"),
    ("z", "xyz"),
];

/// The word of `known` that is nearest to `word`: the same in other capitals, what others call it,
/// or one that differs by few letters only.
pub fn nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let length = word.chars().count();
    if length > MOST_COMPARED.0 {
        return None;
    }
    let known: Vec<&str> = known.into_iter().take(MOST_COMPARED.1).collect();
    let same = |other: &str| {
        known
            .iter()
            .copied()
            .find(|k| k.eq_ignore_ascii_case(other))
    };
    if let Some(found) = same(word).or_else(|| called(word, &known)) {
        return Some(found);
    }
    let slips = length.div_ceil(3).max(1);
    known
        .iter()
        .copied()
        .filter(|k| k.len().abs_diff(word.len()) <= 4 * slips)
        .map(|k| (strsim::damerau_levenshtein(word, k), k))
        .filter(|&(distance, _)| distance <= slips)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, k)| k)
}

/// The word of `known` for what others call `word`.
pub(crate) fn called<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let mut others = SYNONYMS
        .iter()
        .filter(|(own, _)| own.eq_ignore_ascii_case(word));
    let same = |other: &str| {
        known
            .iter()
            .copied()
            .find(|k| k.eq_ignore_ascii_case(other))
    };
    others.find_map(|(_, other)| same(other))
}

/// What stands in the folder of a file that is not there, with nearly its name.
pub fn near_file(path: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder::of(path))
        .ok()?
        .take(MOST_COMPARED.1);
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    // A symbolic link to nothing is there, and is not.
    let own = path.file_name()?.to_str()?;
    let mut names: Vec<String> = names.filter(|name| name != own).collect();
    // Whatever order the system gives them in.
    names.sort_unstable();
    let near = nearest(own, names.iter().map(String::as_str))?;
    Some(path.with_file_name(near))
}

/// A word of a command line, as a shell takes it for one; a line of a comment has no control
/// characters, whatever a name has.
pub fn shell(word: &str) -> String {
    let word = word.replace(char::is_control, " ");
    let plain = |c: char| c.is_alphanumeric() || "_-./:=,+@%\\".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word;
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Where a symbolic link leads at whose end there is nothing, as advice.
pub fn of_dead_link(path: &Path) -> Option<String> {
    let aim = std::fs::read_link(path).ok().filter(|_| !path.exists())?;
    let aim = folder::of(path).join(aim);
    Some(format!(
        "it is a symbolic link to {}, where there is nothing: put the file there, or give another \
         one",
        aim.display()
    ))
}

/// What is said after "cannot be read" of a file that is not there: which one may be meant.
pub fn instead_of(path: &Path, error: &std::io::Error) -> String {
    if path == Path::new("-") && cfg!(unix) {
        return "the name of standard input is /dev/stdin".to_owned();
    }
    if let Some((scheme, rest)) = path.to_string_lossy().split_once("://") {
        return match scheme {
            "file" => format!("write the path alone: {rest}"),
            "package" => {
                "give the path of the file: only names within it may be of packages".to_owned()
            }
            _ => "nothing is downloaded: fetch the file, and give its path".to_owned(),
        };
    }
    if let Some(advice) = of_dead_link(path) {
        return advice;
    }
    let missing = error.kind() == std::io::ErrorKind::NotFound;
    let near = near_file(path).filter(|_| missing);
    near.map_or_else(String::new, |near| {
        format!("did you mean '{}'?", near.display())
    })
}

/// [`instead_of`] at the end of a message.
pub fn or_meant(path: &Path, error: &std::io::Error) -> String {
    let meant = instead_of(path, error);
    if meant.is_empty() {
        meant
    } else {
        format!("; {meant}")
    }
}

/// ` did you mean 'x'?`, or nothing.
pub(crate) fn did_you_mean<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    nearest(word, known).map_or_else(String::new, |near| {
        let strange = strange(word, near).map(|strange| format!(" {strange}"));
        format!("did you mean '{near}'?{}", strange.unwrap_or_default())
    })
}

/// Which character of a word may be what nobody sees: one that does not show, or that looks like a
/// letter or a digit of ASCII. `meant` has it if it is right.
pub(crate) fn strange(word: &str, meant: &str) -> Option<String> {
    let plain = |c: char| c.is_ascii() && !c.is_control();
    let mut letters = (1..).zip(word.chars());
    let (place, c) = letters.find(|(_, c)| !plain(*c) && !meant.contains(*c))?;
    Some(format!(
        "character {place} of '{}' is {}",
        escaped(word),
        code(c)
    ))
}

/// A character by its number in Unicode.
pub(crate) fn code(c: char) -> String {
    format!("U+{:04X}", u32::from(c))
}

/// A text in which every character shows.
fn escaped(text: &str) -> String {
    let shown = |c: char| c.is_alphanumeric() || c.is_ascii_graphic();
    let letters = text.chars();
    let letters = letters.map(|c| if shown(c) { c.to_string() } else { code(c) });
    letters.collect()
}

/// The candidate that looks most like `name`, however far it is.
pub(crate) fn likeliest<'c>(
    name: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let likeness = strsim::normalized_damerau_levenshtein(name, candidate)
            + 0.5 * strsim::jaro_winkler(name, candidate);
        // The first of equals, so that the answer does not depend on anything but the order.
        if best.is_none_or(|(most, _)| likeness > most) {
            best = Some((likeness, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn did_you_mean_finds_typing_errors_and_nothing_far_away() {
        let known = ["collision", "visual", "inertial"];
        assert_eq!(nearest("colision", known), Some("collision"));
        assert_eq!(nearest("intertial", known), Some("inertial"));
        assert_eq!(nearest("sensor", known), None);
        // The same in other capitals comes before another word of the same length.
        assert_eq!(nearest("B", ["a", "b"]), Some("b"));
        assert_eq!(nearest("Hinge", ["fixed", "revolute"]), Some("revolute"));
        assert_eq!(nearest("hinge", known), None);
    }

    #[test]
    fn what_does_not_show_in_a_word_is_named() {
        let known = ["collision", "größe"];
        for (word, told) in [
            (
                "coll\u{200b}ision",
                "did you mean 'collision'? character 5 of 'collU+200Bision' is U+200B",
            ),
            (
                "collision\u{a0}",
                "did you mean 'collision'? character 10 of 'collisionU+00A0' is U+00A0",
            ),
            (
                "c\u{43e}llision",
                "did you mean 'collision'? character 2 of 'c\u{43e}llision' is U+043E",
            ),
            ("grösse", "did you mean 'größe'?"),
            ("colision", "did you mean 'collision'?"),
        ] {
            assert_eq!(did_you_mean(word, known), told, "{word:?}");
        }
        assert_eq!(strange("1.5", ""), None);
    }
}
