//! `[[loop]]` and `[[spring]]`: closed loops, and springs between two points.

use super::common::{patterns, some_required, two};
use super::reader::Reader;
use super::section::{Section, Value};
use crate::diagnostic::Place;
use crate::pattern::Pattern;
use crate::spatial::Vec3;

/// What closes a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopSettings {
    /// Its name; none: one by its number.
    pub name: Option<Pattern>,
    /// What it holds.
    pub kind: LoopChoice,
    /// Where it was asked for.
    pub place: Option<Place>,
}

/// What a loop holds.
#[derive(Clone, Debug, PartialEq)]
pub enum LoopChoice {
    /// Two frames, as one.
    Weld {
        /// Which links.
        links: [Pattern; 2],
        /// Their origins in these, m.
        origins: [Vec3; 2],
        /// Roll, pitch, yaw in these, rad.
        rpy: [Vec3; 2],
    },
    /// Two points, as one.
    Ball {
        /// Which links.
        links: [Pattern; 2],
        /// The points on these, m.
        origins: [Vec3; 2],
    },
    /// Two points and two axes, as one.
    Hinge {
        /// Which links.
        links: [Pattern; 2],
        /// The points on these, m.
        origins: [Vec3; 2],
        /// Axes in these, of any length but 0.
        axes: [Vec3; 2],
    },
    /// The distance of two points.
    Distance {
        /// Which links.
        links: [Pattern; 2],
        /// The points on these, m.
        origins: [Vec3; 2],
        /// m; none: that at the start.
        length: Option<f64>,
    },
    /// A sum of positions of joints.
    Coupler {
        /// Which joints, and what each is multiplied by.
        terms: Vec<(Pattern, f64)>,
        /// The sum; none: that at the start.
        sum: Option<f64>,
    },
}

impl LoopChoice {
    /// Links or joints that it names.
    pub fn names(&self) -> Vec<&Pattern> {
        match self {
            Self::Weld { links, .. }
            | Self::Ball { links, .. }
            | Self::Hinge { links, .. }
            | Self::Distance { links, .. } => links.iter().collect(),
            Self::Coupler { terms, .. } => terms.iter().map(|(joint, _)| joint).collect(),
        }
    }
}

/// A spring between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringSettings {
    /// Its name; none: one by its number.
    pub name: Option<Pattern>,
    /// Which links.
    pub links: [Pattern; 2],
    /// The points on these, m.
    pub origins: [Vec3; 2],
    /// N/m
    pub stiffness: f64,
    /// N·s/m
    pub damping: f64,
    /// m
    pub length: f64,
    /// Where it was asked for.
    pub place: Option<Place>,
}

/// Keys that have a meaning for a type of loop, beside name and type.
fn meant(kind: &str) -> &'static [&'static str] {
    match kind {
        "weld" => &["links", "origins", "rpy"],
        "ball" => &["links", "origins"],
        "hinge" => &["links", "origins", "axes"],
        "distance" => &["links", "origins", "length"],
        "gear" => &["joints", "ratio"],
        _ => &["joints", "factors", "sum"],
    }
}

/// All loops, in file order.
pub(super) fn loops(reader: &mut Reader, root: &Section) -> Vec<LoopSettings> {
    let sections = root.tables("loop");
    let read = |section| closure(reader, section);
    sections.iter().filter_map(read).collect()
}

/// All springs, in file order.
pub(super) fn springs(reader: &mut Reader, root: &Section) -> Vec<SpringSettings> {
    let sections = root.tables("spring");
    let read = |section| spring(reader, section);
    sections.iter().filter_map(read).collect()
}

/// Loops and springs with outputs.
pub(super) fn outputs(reader: &Reader, section: &Section) -> [Vec<Pattern>; 2] {
    ["loops", "springs"].map(|key| match section.value(key) {
        Some(Value::Texts(texts)) => patterns(reader, texts),
        _ => Vec::new(),
    })
}

fn closure(reader: &mut Reader, section: &Section) -> Option<LoopSettings> {
    let Some(word) = section.word("type") else {
        if !section.rejected.iter().any(|rejected| rejected == "type") {
            let message = "[[loop]] needs 'type'";
            let help =
                "type = \"weld\", \"ball\", \"hinge\", \"distance\", \"gear\" or \"coupler\"";
            reader.error("S107", &section.span.clone(), message, help);
        }
        return None;
    };
    let meant = meant(&word);
    for entry in &section.entries {
        if !["name", "type"].contains(&entry.name.as_str()) && !meant.contains(&entry.name.as_str())
        {
            let message = format!(
                "'{}' has no meaning for a loop of type \"{word}\"",
                entry.name
            );
            let help = format!("it has {}", meant.join(", "));
            reader.error("S106", &entry.span.clone(), message, help);
        }
    }
    let origins = pair(section, "origins", Vec3::zeros());
    let kind = match word.as_str() {
        "weld" => LoopChoice::Weld {
            links: links(reader, section, "loop")?,
            origins,
            rpy: pair(section, "rpy", Vec3::zeros()),
        },
        "ball" => LoopChoice::Ball {
            links: links(reader, section, "loop")?,
            origins,
        },
        "hinge" => LoopChoice::Hinge {
            links: links(reader, section, "loop")?,
            origins,
            axes: axes(reader, section)?,
        },
        "distance" => LoopChoice::Distance {
            links: links(reader, section, "loop")?,
            origins,
            length: section.number("length"),
        },
        "gear" => gear(reader, section)?,
        _ => coupler(reader, section)?,
    };
    Some(LoopSettings {
        name: name(reader, section),
        kind,
        place: Some(reader.place(&section.span)),
    })
}

fn spring(reader: &mut Reader, section: &Section) -> Option<SpringSettings> {
    let [stiffness, damping, length] =
        ["stiffness", "damping", "length"].map(|key| section.number(key).unwrap_or(0.0));
    let rejected = |key: &str| section.rejected.iter().any(|rejected| rejected == key);
    if stiffness == 0.0 && damping == 0.0 && !rejected("stiffness") && !rejected("damping") {
        let message = "[[spring]] needs 'stiffness' or 'damping'";
        reader.error("S107", &section.span.clone(), message, "stiffness = 1000");
    }
    if let (true, false, Some(entry)) = (
        stiffness == 0.0 && damping > 0.0,
        rejected("stiffness"),
        section.entry("length"),
    ) {
        let message = "'length' has no meaning without 'stiffness'";
        let help = "leave it out, or set stiffness, too";
        reader.error("S106", &entry.span.clone(), message, help);
    }
    Some(SpringSettings {
        links: links(reader, section, "spring")?,
        name: name(reader, section),
        origins: pair(section, "origins", Vec3::zeros()),
        stiffness,
        damping,
        length,
        place: Some(reader.place(&section.span)),
    })
}

/// The name, where there is one.
fn name(reader: &Reader, section: &Section) -> Option<Pattern> {
    match section.value("name") {
        Some(Value::Texts(texts)) => patterns(reader, texts).into_iter().next(),
        _ => None,
    }
}

/// Two vectors, or the same twice where the file has none.
fn pair(section: &Section, key: &str, default: Vec3) -> [Vec3; 2] {
    match section.numbers(key).as_deref() {
        Some([a, b, c, d, e, f]) => [Vec3::new(*a, *b, *c), Vec3::new(*d, *e, *f)],
        _ => [default; 2],
    }
}

/// The two links; none after an error.
fn links(reader: &mut Reader, section: &Section, table: &str) -> Option<[Pattern; 2]> {
    let links = some_required(reader, section, "links", table)?;
    let [first, second] = &links[..] else {
        wrong_count(reader, section, "links", "two links");
        return None;
    };
    if first.text == second.text {
        let message = format!("both ends are on '{}'", first.text);
        let help = "name two links that move against each other";
        reader.error_at("S106", second.place.clone(), message, help);
        return None;
    }
    Some([first.clone(), second.clone()])
}

fn wrong_count(reader: &mut Reader, section: &Section, key: &str, what: &str) {
    let span = section.entry(key).map_or(0..0, |entry| entry.span.clone());
    let message = format!("'{key}' must be {what}");
    let axes = || "axes = [[0, 1, 0], [0, 1, 0]]".to_owned();
    let help = if key == "axes" { axes() } else { two(key) };
    reader.error("S104", &span, message, help);
}

/// The axes of a hinge; none after an error.
fn axes(reader: &mut Reader, section: &Section) -> Option<[Vec3; 2]> {
    let axes = pair(section, "axes", Vec3::z());
    if axes.iter().all(|axis| axis.norm() > 1e-12) {
        return Some(axes);
    }
    wrong_count(reader, section, "axes", "two axes of which none is 0");
    None
}

fn gear(reader: &mut Reader, section: &Section) -> Option<LoopChoice> {
    let joints = some_required(reader, section, "joints", "loop")?;
    let [first, second] = &joints[..] else {
        wrong_count(reader, section, "joints", "two joints");
        return None;
    };
    let Some(ratio) = section.number("ratio").filter(|ratio| *ratio != 0.0) else {
        if !section.rejected.iter().any(|rejected| rejected == "ratio") {
            let message = "a gear needs a 'ratio' other than 0";
            let help = "ratio = speed of the first joint over that of the second";
            reader.error("S107", &section.span.clone(), message, help);
        }
        return None;
    };
    Some(LoopChoice::Coupler {
        terms: vec![(first.clone(), 1.0), (second.clone(), -ratio)],
        sum: None,
    })
}

fn coupler(reader: &mut Reader, section: &Section) -> Option<LoopChoice> {
    let joints = some_required(reader, section, "joints", "loop")?;
    let factors = section.numbers("factors").unwrap_or_default();
    if factors.len() != joints.len() || factors.contains(&0.0) {
        if !section
            .rejected
            .iter()
            .any(|rejected| rejected == "factors")
        {
            let message = format!(
                "a coupler of {} joints needs as many 'factors', none of them 0",
                joints.len()
            );
            let help = "factors = what each joint's position is multiplied by";
            reader.error("S107", &section.span.clone(), message, help);
        }
        return None;
    }
    Some(LoopChoice::Coupler {
        terms: joints.into_iter().zip(factors).collect(),
        sum: Some(section.number("sum").unwrap_or(0.0)),
    })
}
