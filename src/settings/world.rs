//! `[[world.object]]` and `[[world.robot]]`: what stands in the world besides the robot.
//!
//! Files are named here and read by whoever builds the world.

use super::advice::SHAPES;
use super::common::{file, file_place, place, required, vector};
use super::reader::Reader;
use super::section::Section;
use super::terrain;
use super::types::{
    InitialSettings, LinkSettings, MeshCollision, ObjectSettings, ObjectSource, RobotSettings,
    WheelFit,
};
use crate::geometry::Shape;
use crate::pattern::Pattern;
use crate::spatial::Vec3;

/// What no robot and no object may be named: these words begin the names of other variables.
const GROUPS: [&str; 16] = [
    "base", "cmd", "contact", "energy", "ext", "initial", "joint", "link", "loop", "object",
    "pair", "robot", "sensor", "solver", "spring", "world",
];

/// What tells two names apart in the names of variables.
fn letters(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    name.chars().map(letter).collect()
}

/// Whether a name would hide a group of variables, or is one of `others` as far as variables show.
pub fn is_taken<'n>(name: &str, others: impl IntoIterator<Item = &'n str>) -> bool {
    let own = letters(name);
    GROUPS.contains(&own.as_str()) || others.into_iter().any(|other| letters(other) == own)
}

/// Robots and objects, each in file order.
pub(super) fn things(
    reader: &mut Reader,
    section: &Section,
) -> (Vec<RobotSettings>, Vec<ObjectSettings>) {
    let mut robots: Vec<_> = section
        .tables("robot")
        .iter()
        .filter_map(|section| robot(reader, section))
        .collect();
    let terrain = terrain::terrain(reader, section);
    let mut objects: Vec<_> = section
        .tables("object")
        .iter()
        .filter_map(|section| object(reader, section))
        .chain(terrain)
        .collect();
    let mut before = Vec::new();
    // A second thing of one name is left out, so that nothing follows from it: it has been told.
    let mut own = |name: &Pattern| has_name(reader, name, &mut before);
    robots.retain(|robot| own(&robot.name));
    objects.retain(|object| object.name.as_ref().is_none_or(&mut own));
    (robots, objects)
}

/// Whether a thing has a name of its own, which is then one of those `before`.
fn has_name(reader: &mut Reader, name: &Pattern, before: &mut Vec<String>) -> bool {
    let text = &name.text;
    let free = !is_taken(text, before.iter().map(String::as_str));
    if is_taken(text, []) {
        let message = format!("'{text}' is the name of a group of variables");
        let help = format!("give it another one, such as '{text}1'");
        reader.error_at("S106", name.place.clone(), message, help);
    } else if !free {
        let message = format!("a second thing in the world is named '{text}'");
        reader.error_at("S106", name.place.clone(), message, "give it another name");
    }
    before.push(text.clone());
    free
}

fn robot(reader: &mut Reader, section: &Section) -> Option<RobotSettings> {
    let name = required(reader, section, "name", "world.robot");
    let urdf = required(reader, section, "urdf", "world.robot");
    let (xy, z) = place(section);
    Some(RobotSettings {
        name: name?,
        urdf: reader.beside(&urdf?.text),
        config: file(reader, section, "config"),
        xy,
        z,
        rpy: section.entry("rpy").map(|_| vector(section, "rpy")),
        fixed_base: section
            .entry("fixed_base")
            .map(|_| section.flag("fixed_base")),
        urdf_place: file_place(reader, section, "urdf"),
        config_place: file_place(reader, section, "config"),
        place: Some(reader.place(&section.span)),
    })
}

fn object(reader: &mut Reader, section: &Section) -> Option<ObjectSettings> {
    let name = required(reader, section, "name", "world.object");
    let fixed = section.flag("static");
    let driven = driven(reader, section, fixed);
    let source = source(reader, section, [fixed, driven]);
    let velocity = section
        .entry("linear_velocity")
        .or_else(|| section.entry("angular_velocity"));
    if let (true, Some(entry)) = (fixed, velocity) {
        let message = "a static object has no velocity";
        let help = "leave it out, or set static = false";
        reader.error("S106", &entry.span, message, help);
    }
    // That of a static one has been told.
    let speed = |key: &str| {
        let own = vector(section, key);
        if fixed { Vec3::zeros() } else { own }
    };
    let (xy, z) = place(section);
    let idle = section.entry("mass").filter(|_| fixed || driven);
    let idle_mass = idle.map(|entry| reader.place(&entry.span));
    Some(ObjectSettings {
        idle_mass,
        name: Some(name?),
        source: source?,
        initial: InitialSettings {
            xy: xy.unwrap_or_default(),
            z,
            rpy: vector(section, "rpy"),
            linear_velocity: speed("linear_velocity"),
            angular_velocity: speed("angular_velocity"),
            velocity_place: velocity.map(|entry| reader.place(&entry.span)),
            ..InitialSettings::default()
        },
        fixed,
        conveyor: conveyor(reader, section, fixed),
        driven,
        surface: surface(reader, section),
        file_place: file_place(reader, section, "urdf"),
        place: Some(reader.place(&section.span)),
    })
}

/// What collision meshes of links roll as, and what they become.
pub(super) fn meshes(section: &Section) -> (Option<WheelFit>, Option<MeshCollision>) {
    let (fit, shapes) = (section.word("wheel_fit"), section.word("collision"));
    (
        fit.and_then(|word| WheelFit::from_word(&word)),
        shapes.and_then(|word| MeshCollision::from_word(&word)),
    )
}

/// Friction and restitution of an object, and what the meshes of its file become.
fn surface(reader: &mut Reader, section: &Section) -> LinkSettings {
    for key in ["wheel_fit", "collision"] {
        if let (Some(entry), true) = (section.entry(key), section.entry("shape").is_some()) {
            let message = format!("'{key}' is of meshes, and this object is a shape");
            let span = entry.span.clone();
            reader.error("S106", &span, message, "leave it out");
        }
    }
    let (wheel_fit, collision) = meshes(section);
    LinkSettings {
        wheel_fit,
        collision,
        ..terrain::surface(reader, section)
    }
}

/// Whether the surface of an object moves.
fn conveyor(reader: &mut Reader, section: &Section, fixed: bool) -> bool {
    let conveyor = section.flag("conveyor");
    if let (true, false, Some(entry)) = (conveyor, fixed, section.entry("conveyor")) {
        let message = "what moves has no conveyor";
        let help = if section.flag("driven") {
            "leave out conveyor or driven: what is driven carries things by its own motion"
        } else {
            "set static = true"
        };
        reader.error("S106", &entry.span.clone(), message, help);
    }
    conveyor && fixed
}

/// Whether an object moves as inputs say.
fn driven(reader: &mut Reader, section: &Section, fixed: bool) -> bool {
    let driven = section.flag("driven");
    if let (true, true, Some(entry)) = (driven, fixed, section.entry("driven")) {
        let message = "a static object is not driven";
        let help = if section.flag("conveyor") {
            "leave out driven: a conveyor is static"
        } else {
            "leave out static: what is driven yields to nothing, either"
        };
        reader.error("S106", &entry.span, message, help);
    }
    driven && !fixed
}

/// What an object is; none after an error.
///
/// - `fixed`, `driven`: such a one needs no mass
fn source(
    reader: &mut Reader,
    section: &Section,
    [fixed, driven]: [bool; 2],
) -> Option<ObjectSource> {
    let rejected = |key: &str| section.rejected.iter().any(|rejected| rejected == key);
    match (section.entry("urdf"), section.entry("shape")) {
        (Some(_), Some(shape)) => {
            let message = "'urdf' and 'shape' say twice what the object is";
            reader.error("S106", &shape.span, message, "leave one of them out");
            None
        }
        (Some(_), None) => {
            if let Some(mass) = section.entry("mass") {
                let message = "'mass' is that of a shape, the links of a URDF have their own";
                let help = "leave it out, or change the file";
                reader.error("S106", &mass.span, message, help);
            }
            Some(ObjectSource::Urdf(file(reader, section, "urdf")?))
        }
        (None, Some(_)) => {
            let shape = shape(reader, &section.table("shape"))?;
            let mass = section.number("mass");
            if mass.is_none() && !(fixed || driven || rejected("mass")) {
                let message = "an object of a shape needs 'mass'";
                let help = "mass = 1.0, or static = true for one that stands still";
                reader.error("S107", &section.span, message, help);
            }
            // That of what is driven plays no part, but what has none stands still.
            let mass = mass.unwrap_or(if driven { 1.0 } else { 0.0 });
            Some(ObjectSource::Solid { shape, mass })
        }
        (None, None) => {
            if !rejected("urdf") && !rejected("shape") {
                let message = "[[world.object]] needs 'urdf' or 'shape'";
                let help = format!("urdf = \"a file\", or {SHAPES}");
                reader.error("S107", &section.span, message, help);
            }
            None
        }
    }
}

fn shape(reader: &mut Reader, section: &Section) -> Option<Shape> {
    let [entry] = &section.entries[..] else {
        if section.rejected.is_empty() || !section.entries.is_empty() {
            let message = "'shape' must be one of box, sphere, cylinder, capsule";
            let help = "shape = { box = [0.1, 0.1, 0.1] }";
            reader.error("S106", &section.span, message, help);
        }
        return None;
    };
    let numbers = section.numbers(&entry.name);
    Some(match (entry.name.as_str(), numbers.as_deref()) {
        ("box", Some(&[x, y, z])) => Shape::Box {
            half: Vec3::new(x, y, z) * 0.5,
        },
        ("cylinder", Some(&[radius, length])) => Shape::Cylinder {
            radius,
            half_length: 0.5 * length,
        },
        ("capsule", Some(&[radius, length])) => Shape::Capsule {
            radius,
            half_length: 0.5 * length,
        },
        _ => Shape::Sphere {
            radius: section.number("sphere")?,
        },
    })
}
