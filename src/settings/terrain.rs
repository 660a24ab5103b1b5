//! `[[world.terrain]]`: what robots stand on besides the ground.
//!
//! Files are named here and read by whoever builds the world.

use super::common::{file, file_place, is_rejected, place, required, vector, whole};
use super::reader::Reader;
use super::section::Section;
use super::types::{
    GeneratedHeights, HeightForm, HeightSource, InitialSettings, LinkSettings, ObjectSettings,
    ObjectSource, TerrainSettings,
};
use crate::tuning::{FINEST_TERRAIN, TERRAIN_CELLS};
use std::path::PathBuf;

/// Which keys belong to which word of `type` or `generate`.
const KEYS: [(&str, &[&str]); 3] = [
    ("plane", &[]),
    (
        "heightfield",
        &[
            "file",
            "generate",
            "size",
            "height",
            "resolution",
            "wavelength",
            "seed",
            "steps",
        ],
    ),
    ("mesh", &["file", "scale"]),
];

/// Which of them belong to which form of heights that are generated.
const FORMS: [(&str, &[HeightForm]); 3] = [
    ("wavelength", &[HeightForm::Waves, HeightForm::Noise]),
    ("seed", &[HeightForm::Noise]),
    ("steps", &[HeightForm::Steps]),
];

/// All terrain in file order, each as an object that never moves.
pub(super) fn terrain(reader: &mut Reader, section: &Section) -> Vec<ObjectSettings> {
    let tables = section.tables("terrain");
    tables
        .iter()
        .filter_map(|section| one(reader, section))
        .collect()
}

fn one(reader: &mut Reader, section: &Section) -> Option<ObjectSettings> {
    let name = required(reader, section, "name", "world.terrain");
    let Some(kind) = section.word("type") else {
        if !is_rejected(section, "type") {
            let message = "[[world.terrain]] needs 'type'";
            let help = "type = \"plane\", \"heightfield\" or \"mesh\"";
            reader.error("S107", &section.span, message, help);
        }
        return None;
    };
    check_keys(reader, section, &kind);
    let source = match kind.as_str() {
        "plane" => Some(TerrainSettings::Plane),
        "mesh" => {
            surface_file(reader, section, "a triangle mesh").map(|file| TerrainSettings::Mesh {
                file,
                scale: section.number("scale").unwrap_or(1.0),
            })
        }
        _ => heights(reader, section),
    };
    let (xy, z) = place(section);
    Some(ObjectSettings {
        idle_mass: None,
        name: Some(name?),
        source: ObjectSource::Terrain(source?),
        initial: InitialSettings {
            xy: xy.unwrap_or_default(),
            z: Some(z.unwrap_or(0.0)),
            rpy: vector(section, "rpy"),
            ..InitialSettings::default()
        },
        fixed: true,
        conveyor: section.flag("conveyor"),
        driven: false,
        surface: surface(reader, section),
        file_place: file_place(reader, section, "file"),
        place: Some(reader.place(&section.span)),
    })
}

/// Friction and restitution of all that a table describes.
pub(super) fn surface(reader: &Reader, section: &Section) -> LinkSettings {
    let mut all = LinkSettings::new("*");
    all.link.place = Some(reader.place(&section.span));
    LinkSettings {
        friction: section.number("friction"),
        static_friction: section.number("static_friction"),
        rolling_friction: section.number("rolling_friction"),
        torsional_friction: section.number("torsional_friction"),
        restitution: section.number("restitution"),
        ..all
    }
}

/// Tells of keys that mean nothing for this kind of terrain.
fn check_keys(reader: &mut Reader, section: &Section, kind: &str) {
    for entry in &section.entries {
        let key = entry.name.as_str();
        let mut of = KEYS.iter().filter(|(_, keys)| keys.contains(&key));
        if of.clone().next().is_some() && of.all(|(word, _)| *word != kind) {
            let message = format!("'{key}' means nothing for a {kind}");
            reader.error(
                "S106",
                &entry.span,
                message,
                "leave it out, or correct 'type'",
            );
        }
    }
}

/// The file of a terrain, which must be there.
fn surface_file(reader: &mut Reader, section: &Section, what: &str) -> Option<PathBuf> {
    let found = file(reader, section, "file");
    if found.is_none() && !is_rejected(section, "file") {
        let message = format!("this terrain needs 'file', {what}");
        reader.error("S107", &section.span, message, "file = \"hills.stl\"");
    }
    found
}

fn heights(reader: &mut Reader, section: &Section) -> Option<TerrainSettings> {
    let rejected = |key: &str| is_rejected(section, key);
    let size = section
        .numbers("size")
        .and_then(|size| size.try_into().ok());
    if size.is_none() && !rejected("size") {
        let message = "a heightfield needs 'size'";
        let help = "size = [20, 20], its extent along x and y in m";
        reader.error("S107", &section.span, message, help);
    }
    let source = match (section.entry("file"), section.word("generate")) {
        (Some(file), Some(_)) => {
            let message = "'file' and 'generate' say twice where the heights come from";
            reader.error("S106", &file.span, message, "leave one of them out");
            return None;
        }
        (Some(_), None) => {
            for key in ["resolution", "wavelength", "seed", "steps"] {
                if let Some(entry) = section.entry(key) {
                    let message = format!("'{key}' is of heights that are generated");
                    let span = entry.span.clone();
                    reader.error("S106", &span, message, "leave it out, or 'file'");
                }
            }
            HeightSource::File(surface_file(reader, section, "an image, CSV or NPY")?)
        }
        (None, Some(word)) => {
            let form = HeightForm::from_word(&word)?;
            HeightSource::Generated(generated(reader, section, form, size?))
        }
        (None, None) => {
            if !rejected("file") && !rejected("generate") {
                let message = "a heightfield needs 'file' or 'generate'";
                let help = "file = \"hills.png\" (or .csv, .npy), or generate = \"noise\"";
                reader.error("S107", &section.span, message, help);
            }
            return None;
        }
    };
    Some(TerrainSettings::Heights {
        source,
        size: size?,
        height: section.number("height"),
    })
}

fn generated(
    reader: &mut Reader,
    section: &Section,
    form: HeightForm,
    size: [f64; 2],
) -> GeneratedHeights {
    for (key, forms) in FORMS {
        if let (false, Some(entry)) = (forms.contains(&form), section.entry(key)) {
            let word = section.word("generate").unwrap_or_default();
            let message = format!("'{key}' means nothing for generate = \"{word}\"");
            let help = "leave it out, or correct 'generate'";
            reader.error("S106", &entry.span.clone(), message, help);
        }
    }
    let longest = size[0].max(size[1]);
    let wavelength = section.number("wavelength").unwrap_or(longest / 10.0);
    let has_waves = matches!(form, HeightForm::Waves | HeightForm::Noise);
    let mut usual = longest / TERRAIN_CELLS;
    if has_waves {
        // As many samples a wave as there are by default.
        usual = usual.min(wavelength / 10.0).max(longest / FINEST_TERRAIN);
    }
    let mut resolution = section.number("resolution").unwrap_or(usual);
    if let (true, Some(entry)) = (
        longest / resolution > FINEST_TERRAIN,
        section
            .entry("resolution")
            .or_else(|| section.entry("size")),
    ) {
        let message = format!("{resolution} m is too fine for an extent of {longest} m");
        let help = format!("at least {:.3e} m", longest / FINEST_TERRAIN);
        let span = entry.span.clone();
        reader.error("S106", &span, message, help);
        // What is left is still built to find other errors, which takes a time for each sample.
        resolution = longest / TERRAIN_CELLS;
    }
    if let (true, Some(entry)) = (
        has_waves && wavelength < 2.0 * resolution,
        section
            .entry("wavelength")
            .or_else(|| section.entry("resolution")),
    ) {
        let message = format!(
            "heights {resolution} m apart do not show waves of {wavelength} m: that takes two a wave"
        );
        let help = "a longer wavelength, a smaller resolution or a smaller size";
        let span = entry.span.clone();
        reader.error("S106", &span, message, help);
    }
    GeneratedHeights {
        form,
        wavelength,
        seed: whole(section, "seed").unwrap_or(1),
        steps: whole(section, "steps").unwrap_or(5),
        resolution,
    }
}
