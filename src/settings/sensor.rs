//! `[[sensor]]`: what a sensor measures, where, how often and how well.

use super::common::{is_rejected, pattern, patterns, required, vector, whole};
use super::keys::QUANTITIES;
use super::reader::Reader;
use super::section::{Section, Value};
use crate::pattern::Pattern;
use crate::spatial::Vec3;

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Its name; none: that of its link or joint.
    pub name: Option<Pattern>,
    /// The link, or the joint of a force–torque sensor or an encoder.
    pub on: Pattern,
    /// Origin in the link, m.
    pub xyz: Vec3,
    /// Roll, pitch, yaw in the link, rad.
    pub rpy: Vec3,
    /// What it measures.
    pub kind: SensorSettingsKind,
    /// Samples a second; none: it follows the state.
    pub rate: Option<f64>,
    /// Of its noise.
    pub seed: u32,
    /// Bias and noise: of the angular velocity and the specific force of an inertial unit, of force
    /// and torque, or of the distance along rays.
    pub errors: Vec<Errors>,
}

/// What is added to a quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// In the quantity's own unit, per axis; of a number the first one.
    pub bias: [f64; 3],
    /// Standard deviation of each sample, likewise.
    pub noise: [f64; 3],
}

/// What a sensor measures.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorSettingsKind {
    /// Orientation, angular velocity and specific force.
    Imu,
    /// Force and torque in a joint, in the axes of its parent or its child.
    ForceTorque {
        /// Whether in those of its parent.
        in_parent: bool,
        /// Whether it tells what the child does to the parent.
        reversed: bool,
    },
    /// Distances to whatever is in the way.
    Ray {
        /// Rays of a row, about z.
        columns: Fan,
        /// Rows, about y: upwards.
        rows: Fan,
        /// Where rays begin, m.
        near: f64,
        /// Largest distance, m.
        range: f64,
        /// Whether it tells what is hit.
        hits: bool,
        /// Links that its rays go through.
        ignored: Vec<Pattern>,
    },
    /// Position of a joint in whole steps.
    Encoder {
        /// Steps in a turn, or in a metre.
        counts: f64,
    },
    /// What presses on a link.
    Contact {
        /// Extents, m, of the box in which contacts count; none: all of the link's.
        size: Option<Vec3>,
    },
}

/// Directions from one angle to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// How many.
    pub count: u32,
    /// The first and the last angle, rad.
    pub angles: [f64; 2],
}

impl Fan {
    /// So many over an angle about 0, rad.
    pub fn symmetric(count: u32, angle: f64) -> Self {
        Self {
            count,
            angles: [-0.5 * angle, 0.5 * angle],
        }
    }

    /// The angle of each, rad; the middle one of a single one.
    pub fn directions(&self) -> impl Iterator<Item = f64> + use<> {
        let Self {
            count,
            angles: [first, last],
        } = *self;
        (0..count).map(move |i| match count {
            1 => 0.5 * (first + last),
            _ => first + (last - first) * (f64::from(i) / f64::from(count - 1)),
        })
    }
}

/// Most rays of one sensor.
const MOST_RAYS: u32 = 10_000;

/// Keys that not every type has, and those that have them.
const OWN: [(&str, &[&str]); 15] = [
    ("link", &["imu", "ray", "contact"]),
    ("xyz", &["imu", "ray", "contact"]),
    ("rpy", &["imu", "ray", "contact"]),
    ("joint", &["ft", "encoder"]),
    ("frame", &["ft"]),
    ("direction", &["ft"]),
    ("rays", &["ray"]),
    ("fov", &["ray"]),
    ("rows", &["ray"]),
    ("vertical_fov", &["ray"]),
    ("range", &["ray"]),
    ("min_range", &["ray"]),
    ("hits", &["ray"]),
    ("ignore", &["ray"]),
    ("counts", &["encoder"]),
];

pub(super) fn sensor(reader: &mut Reader, section: &Section) -> Option<SensorSettings> {
    let Some(word) = section.word("type") else {
        if !section.rejected.iter().any(|rejected| rejected == "type") {
            let message = "[[sensor]] needs 'type'";
            let help = "type = \"imu\", \"ft\", \"ray\", \"encoder\" or \"contact\"";
            reader.error("S107", &section.span.clone(), message, help);
        }
        return None;
    };
    check_keys(reader, section, &word);
    let errors = errors(reader, section, &word);
    let on = match word.as_str() {
        "ft" | "encoder" => "joint",
        _ => "link",
    };
    let kind = kind(reader, section, &word);
    Some(SensorSettings {
        on: required(reader, section, on, "sensor")?,
        name: match section.value("name") {
            Some(Value::Texts(texts)) => patterns(reader, texts).into_iter().next(),
            _ => None,
        },
        xyz: vector(section, "xyz"),
        rpy: vector(section, "rpy"),
        kind: kind?,
        rate: section.number("rate"),
        seed: whole(section, "seed").unwrap_or(1),
        errors,
    })
}

/// Keys that the type has no use for, or only together with others.
fn check_keys(reader: &mut Reader, section: &Section, word: &str) {
    let own = OWN
        .iter()
        .map(|(key, types)| (*key, types.contains(&word)))
        .chain([("size", word == "contact")])
        .chain(QUANTITIES.map(|(kind, key)| (key, kind == word)));
    for (key, has) in own {
        if let (false, Some(entry)) = (has, section.entry(key)) {
            let message = format!("'{key}' has no meaning for a sensor of type \"{word}\"");
            reader.error("S106", &entry.span.clone(), message, "leave it out");
        }
    }
    for (angle, count, what) in [
        ("fov", "rays", "one ray"),
        ("vertical_fov", "rows", "one row"),
    ] {
        let told = is_rejected(section, count);
        let angled = section.entry(angle).map(|entry| entry.span.clone());
        // One that is refused goes on as none, and would be told of after it was mended.
        let angled = angled.or(is_rejected(section, angle).then(|| section.span.clone()));
        if let (None | Some(1), Some(span), false) = (whole(section, count), angled, told) {
            let message = format!("'{angle}' has no meaning for {what}");
            let help = format!("set {count} above 1, too, or leave {angle} out");
            reader.error("S106", &span, message, help);
        }
    }
    let rate = section.entry("rate").is_some() || is_rejected(section, "rate");
    let noisy = QUANTITIES.iter().filter(|(kind, _)| *kind == word);
    let noisy = noisy.map(|(_, key)| *key).any(|quantity| {
        let table = section.table(quantity);
        let has = |key| table.entry(key).is_some() || is_rejected(&table, key);
        has("noise") || has("noise_density") || is_rejected(section, quantity)
    });
    if let (false, Some(entry)) = (rate && noisy, section.entry("seed")) {
        let message = "'seed' has no meaning for a sensor without noise";
        let help = "give it a noise and a rate, or leave it out";
        reader.error("S106", &entry.span.clone(), message, help);
    }
}

/// Bias and noise of each quantity of a sensor of type `word`.
fn errors(reader: &mut Reader, section: &Section, word: &str) -> Vec<Errors> {
    let own = QUANTITIES.iter().filter(|(kind, _)| *kind == word);
    own.map(|(_, key)| of_quantity(reader, section, key))
        .collect()
}

fn of_quantity(reader: &mut Reader, section: &Section, key: &str) -> Errors {
    let table = section.table(key);
    let list = |key: &str| -> Option<[f64; 3]> {
        let one = table.number(key).map(|x| [x; 3]);
        one.or_else(|| table.numbers(key)?.try_into().ok())
    };
    let (mut noise, mut density) = (list("noise"), list("noise_density"));
    let rate = section.number("rate");
    for name in ["noise", "noise_density"] {
        let Some(entry) = table.entry(name) else {
            continue;
        };
        if rate.is_none() && !is_rejected(section, "rate") {
            let message = format!("'{key}.{name}' needs 'rate': each sample has its own noise");
            let help = "rate = 100.0 takes a hundred samples a second";
            reader.error("S107", &entry.span.clone(), message, help);
        }
        if name == "noise_density" && noise.is_some() {
            let message = "'noise' and 'noise_density' say the same thing twice";
            let help = "leave one of them out";
            reader.error("S106", &entry.span.clone(), message, help);
        }
    }
    // What an error has been told of is left out: the model would be told to be wrong, too.
    if rate.is_none() {
        (noise, density) = (None, None);
    }
    let root = rate.unwrap_or(0.0).sqrt();
    Errors {
        bias: list("bias").unwrap_or_default(),
        noise: noise
            .or_else(|| density.map(|density| density.map(|x| x * root)))
            .unwrap_or_default(),
    }
}

fn kind(reader: &mut Reader, section: &Section, word: &str) -> Option<SensorSettingsKind> {
    Some(match word {
        "imu" => SensorSettingsKind::Imu,
        "ft" => SensorSettingsKind::ForceTorque {
            in_parent: section.word("frame").as_deref() == Some("parent"),
            reversed: section.word("direction").as_deref() == Some("child_to_parent"),
        },
        "encoder" => {
            let Some(counts) = section.number("counts") else {
                if !is_rejected(section, "counts") {
                    let message = "[[sensor]] of type \"encoder\" needs 'counts'";
                    let help = "counts = 4096, in a turn or in a metre";
                    reader.error("S107", &section.span.clone(), message, help);
                }
                return None;
            };
            SensorSettingsKind::Encoder { counts }
        }
        "contact" => SensorSettingsKind::Contact {
            size: section.entry("size").map(|_| vector(section, "size")),
        },
        _ => rays(reader, section),
    })
}

fn rays(reader: &mut Reader, section: &Section) -> SensorSettingsKind {
    let columns = whole(section, "rays").unwrap_or(1);
    let mut rows = whole(section, "rows").unwrap_or(1);
    if let (true, Some(entry)) = (
        columns.saturating_mul(rows) > MOST_RAYS,
        section.entry("rows"),
    ) {
        let message = format!("{rows} rows of {columns} rays are more than {MOST_RAYS} rays");
        let help = "make rows or rays less, or use several sensors";
        reader.error("S106", &entry.span.clone(), message, help);
        rows = 1;
    }
    let mut near = section.number("min_range").unwrap_or(0.0);
    let range = section.number("range").unwrap_or(10.0);
    if let (true, Some(entry)) = (near >= range, section.entry("min_range")) {
        let message = format!("'min_range' {near} is not below the range {range}");
        reader.error("S106", &entry.span.clone(), message, "make it smaller");
        near = 0.0;
    }
    SensorSettingsKind::Ray {
        columns: Fan::symmetric(columns, section.number("fov").unwrap_or(0.0)),
        rows: Fan::symmetric(rows, section.number("vertical_fov").unwrap_or(0.0)),
        near,
        range,
        hits: section.flag("hits"),
        ignored: match section.value("ignore") {
            Some(Value::Texts(texts)) => texts
                .into_iter()
                .map(|(text, span)| pattern(reader, text, &span))
                .collect(),
            _ => Vec::new(),
        },
    }
}
