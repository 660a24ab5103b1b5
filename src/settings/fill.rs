//! Checked keys and values → [`Settings`]: what each table means, and which keys contradict each
//! other.
//!
//! In: a [`Section`] from the [`Reader`], with types and ranges checked and defaults at hand. Out:
//! [`Settings`]; findings S106 and S107 in the reader. This module uses neither the text nor a
//! robot.

use super::closures;
use super::common::{pattern, patterns, required, some_required, vector};
use super::compat::Compat;
use super::fmu::{FmiVersion, FmuSettings};
use super::reader::Reader;
use super::section::{Node, Section, Value};
use super::types::{
    ActuatorSettings, BaseChoice, ContactOutputs, GroupSettings, InertiaSource, InitialSettings,
    JointSettings, LinkSettings, ModeChoice, PairSettings, Settings,
};
use super::{sensor, world};
use crate::model::{
    ActuatorMode, Arrays, Combination, ContactDefaults, Ground, Interface, SolverDefaults, World,
};
use crate::pattern::Pattern;
use crate::range::MOST_STEPS;

/// What the file at `root` means; a given `compat` wins over the file's.
///
/// Whatever is missing or was rejected has its default, so that everything else is checked, too;
/// findings go to `reader`.
#[expect(clippy::too_many_lines, reason = "a line or two a key")]
pub(super) fn fill(reader: &mut Reader, root: &Section, compat: Option<Compat>) -> Settings {
    let robot = root.table("robot");
    let compat = compat
        .or_else(|| Compat::from_word(&robot.word("compat")?))
        .unwrap_or_default();
    let outputs = root.table("outputs");
    let (robots, objects) = world::things(reader, &root.table("world"));
    Settings {
        compat,
        base: match robot.word("base").as_deref() {
            Some("floating") => BaseChoice::Floating,
            Some("fixed") => BaseChoice::Fixed,
            _ => BaseChoice::Auto,
        },
        scale: robot.number("scale").unwrap_or(1.0),
        inertia: match robot.value_as("inertia", compat) {
            Some(Value::Word(word)) if word == "nearest" => InertiaSource::Nearest,
            Some(Value::Word(word)) if word == "collision" => InertiaSource::Collision,
            Some(Value::Word(word)) if word == "pybullet" => InertiaSource::PyBullet,
            _ => InertiaSource::Urdf,
        },
        density: robot.number("density"),
        missing_mass: robot.number("missing_mass"),
        self_collision: robot.flag("self_collision"),
        ignored_contacts: root
            .tables("ignore_contact")
            .iter()
            .filter_map(|section| match section.value("links") {
                Some(Value::Texts(texts)) => Some(patterns(reader, texts)),
                _ => None,
            })
            .collect(),
        disabled_contacts: Vec::new(),
        mounting: None,
        fmu: fmu(reader, &root.table("fmu")),
        flat_names: root.table("fmu").word("naming").as_deref() == Some("flat"),
        solver: solver(&root.table("solver"), compat),
        contact: contact(reader, &root.table("contact")),
        world: surroundings(reader, &root.table("world"), compat),
        objects,
        robots,
        initial: initial(reader, &root.table("initial")),
        default_mode: None,
        actuators: root
            .tables("actuator")
            .iter()
            .filter_map(|section| actuator(reader, section))
            .collect(),
        joints: named_tables(reader, &root.table("joint"))
            .map(|(joint, section)| joint_settings(reader, joint, &section))
            .collect(),
        links: named_tables(reader, &root.table("link"))
            .map(|(link, section)| {
                let (wheel_fit, collision) = world::meshes(&section);
                LinkSettings {
                    link,
                    friction: section.number("friction"),
                    static_friction: section.number("static_friction"),
                    rolling_friction: section.number("rolling_friction"),
                    torsional_friction: section.number("torsional_friction"),
                    restitution: section.number("restitution"),
                    stiffness: section.number("stiffness"),
                    dissipation: section.number("dissipation"),
                    mass: section.number("mass"),
                    wheel_fit,
                    collision,
                }
            })
            .collect(),
        contact_outputs: match outputs.value("contacts") {
            Some(Value::Texts(texts)) => ContactOutputs::Links(patterns(reader, texts)),
            Some(Value::Word(word)) if word == "none" => ContactOutputs::Links(Vec::new()),
            _ => ContactOutputs::Auto,
        },
        contact_points: contact_points(reader, &outputs),
        pairs: outputs
            .tables("pair")
            .iter()
            .filter_map(|section| pair(reader, section))
            .collect(),
        link_outputs: match outputs.value("links") {
            Some(Value::Texts(texts)) => patterns(reader, texts),
            _ => Vec::new(),
        },
        conveyor: false,
        driven: false,
        external_wrenches: root
            .tables("external_wrench")
            .iter()
            .filter_map(|section| required(reader, section, "link", "external_wrench"))
            .collect(),
        groups: root
            .tables("group")
            .iter()
            .filter_map(|section| group(reader, section))
            .collect(),
        described_sensors: robot.word("sensors").as_deref() == Some("urdf"),
        loops: closures::loops(reader, root),
        springs: closures::springs(reader, root),
        closure_outputs: closures::outputs(reader, &outputs),
        sensors: root
            .tables("sensor")
            .iter()
            .filter_map(|section| sensor::sensor(reader, section))
            .collect(),
    }
}

/// Whether there are points of contact, which only links with contact outputs have.
fn contact_points(reader: &mut Reader, outputs: &Section) -> bool {
    let wanted = outputs.flag("contact_points");
    if let Some(entry) = outputs.entry("contact_points")
        && wanted
        && outputs.word("contacts").as_deref() == Some("none")
    {
        let message = "'contact_points' has no meaning with contacts = \"none\"";
        let help = "leave it out, or name the links in contacts";
        reader.error("S106", &entry.span.clone(), message, help);
    }
    wanted
}

fn group(reader: &mut Reader, section: &Section) -> Option<GroupSettings> {
    let name = required(reader, section, "name", "group");
    let joints = some_required(reader, section, "joints", "group");
    Some(GroupSettings {
        name: name?,
        joints: joints?,
    })
}

fn pair(reader: &mut Reader, section: &Section) -> Option<PairSettings> {
    let name = required(reader, section, "name", "outputs.pair");
    let first = some_required(reader, section, "first", "outputs.pair");
    let second = some_required(reader, section, "second", "outputs.pair");
    Some(PairSettings {
        name: name?,
        sides: [first?, second?],
    })
}

fn solver(section: &Section, compat: Compat) -> SolverDefaults {
    SolverDefaults {
        step_size: section.number_as("step_size", compat).unwrap_or(0.0),
        // 0 leaves the choice to the importer.
        tolerance: section.number("tolerance").unwrap_or(0.0),
        max_steps: section.number("max_steps").unwrap_or(MOST_STEPS),
    }
}

fn contact(reader: &mut Reader, section: &Section) -> ContactDefaults {
    if let (Some(_), Some(stiffness)) = (section.entry("penetration"), section.entry("stiffness")) {
        let message = "'stiffness' and 'penetration' say the same thing twice";
        let span = stiffness.span.clone();
        reader.error("S106", &span, message, "leave one of them out");
    }
    ContactDefaults {
        penetration: section.number("penetration").unwrap_or(0.0),
        stiffness: section.number("stiffness"),
        dissipation: section.number("dissipation").unwrap_or(0.0),
        stribeck_velocity: section.number("stribeck_velocity").unwrap_or(0.0),
    }
}

fn surroundings(reader: &mut Reader, section: &Section, compat: Compat) -> World {
    let ground = section.table("ground");
    let kind = ground.word("type");
    if kind.as_deref() == Some("none") {
        let idle = ground.entries.iter().filter(|entry| entry.name != "type");
        for entry in idle {
            let message = format!("'{}' has no meaning with type = \"none\"", entry.name);
            let help = "leave it out, or type = \"none\"; terrain has its own";
            reader.error("S106", &entry.span.clone(), message, help);
        }
    }
    // Terrain takes the place of a ground that nobody asked for.
    let replaced = section.entry("ground").is_none() && section.entry("terrain").is_some();
    let friction = ground.number_as("friction", compat).unwrap_or(0.0);
    let static_friction = ground.number("static_friction").unwrap_or(friction);
    let static_excess = static_excess(friction, static_friction).unwrap_or_else(|| {
        let span = ground
            .entry("static_friction")
            .map_or(0..0, |entry| entry.span.clone());
        let message = format!(
            "the friction {static_friction} at rest is below or far above the friction {friction}"
        );
        reader.error("S106", &span, message, STATIC_FRICTION_HELP);
        0.0
    });
    World {
        gravity: vector(section, "gravity"),
        combination: match compat {
            Compat::None => Combination::Mean,
            Compat::PyBullet => Combination::Product,
        },
        drag: compat.drag(),
        ground: (kind.as_deref() != Some("none") && !replaced).then(|| Ground {
            friction,
            restitution: ground.number("restitution").unwrap_or(0.0),
            static_excess,
            rolling_friction: ground.number("rolling_friction").unwrap_or(0.0),
            torsional_friction: ground.number("torsional_friction").unwrap_or(0.0),
        }),
    }
}

/// What to do about a static friction that [`static_excess`] refuses.
pub(crate) const STATIC_FRICTION_HELP: &str = "static_friction must lie between friction and 1000 times friction; leave it out where they are equal";

/// Static over sliding friction, less 1; none where it is negative, or has no sliding friction to
/// go with.
pub(crate) fn static_excess(friction: f64, static_friction: f64) -> Option<f64> {
    #[expect(
        clippy::float_cmp,
        reason = "one is often a copy of the other, and both may be 0"
    )]
    if friction == static_friction {
        return Some(0.0);
    }
    let excess = static_friction / friction - 1.0;
    (0.0..=1e3).contains(&excess).then_some(excess)
}

fn initial(reader: &mut Reader, section: &Section) -> InitialSettings {
    let xyz = section.numbers("xyz").unwrap_or_default();
    let by_name = |key: &str, reader: &Reader| {
        section
            .table(key)
            .entries
            .iter()
            .filter_map(|entry| match &entry.node {
                Node::Value(Value::Number(number)) => {
                    Some((pattern(reader, entry.name.clone(), &entry.span), *number))
                }
                _ => None,
            })
            .collect()
    };
    InitialSettings {
        xy: [
            xyz.first().copied().unwrap_or(0.0),
            xyz.get(1).copied().unwrap_or(0.0),
        ],
        z: xyz.get(2).copied(),
        stands: false,
        rpy: vector(section, "rpy"),
        linear_velocity: vector(section, "linear_velocity"),
        angular_velocity: vector(section, "angular_velocity"),
        state: Vec::new(),
        joints: by_name("joints", reader),
        joint_velocities: by_name("joint_velocities", reader),
        velocity_place: section
            .entry("linear_velocity")
            .or_else(|| section.entry("angular_velocity"))
            .map(|entry| reader.place(&entry.span)),
    }
}

fn actuator(reader: &mut Reader, section: &Section) -> Option<ActuatorSettings> {
    let joint = required(reader, section, "joint", "actuator")?;
    let mode = section
        .word("mode")
        .and_then(|word| ModeChoice::from_word(&word));
    let settings = ActuatorSettings {
        joint,
        mode,
        max_effort: section.number("max_effort"),
        kp: section.number("kp"),
        kd: section.number("kd"),
        no_load_speed: section.number("no_load_speed"),
    };
    for key in ["kp", "kd", "max_effort", "no_load_speed"] {
        let Some(entry) = section.entry(key) else {
            continue;
        };
        let useless = match mode {
            None => false,
            Some(ModeChoice::Passive) => true,
            // The line starts from max_effort, whatever is commanded.
            Some(ModeChoice::Commanded(ActuatorMode::Effort)) => {
                key == "max_effort" && settings.no_load_speed.is_none()
            }
            Some(ModeChoice::Commanded(mode)) => {
                matches!(key, "kp" | "kd") && mode != ActuatorMode::Pd
            }
        };
        if useless {
            let mode = section.word("mode").unwrap_or_default();
            let message = format!("'{key}' has no meaning in mode \"{mode}\"");
            let span = entry.span.clone();
            reader.error("S106", &span, message, "leave it out, or change the mode");
        }
    }
    Some(settings)
}

fn joint_settings(reader: &mut Reader, joint: Pattern, section: &Section) -> JointSettings {
    let limits = section.table("limits");
    let (mut lower, mut upper) = (limits.number("lower"), limits.number("upper"));
    if let (Some(low), Some(high)) = (lower, upper)
        && low > high
    {
        let message = format!("the lower limit {low} lies above the upper limit {high}");
        reader.error("S106", &limits.span, message, "exchange them");
        // The joint would be told to have no range, too.
        (lower, upper) = (None, None);
    }
    JointSettings {
        joint,
        damping: section.number("damping"),
        friction: section.number("friction"),
        armature: section.number("armature"),
        static_friction: section.number("static_friction"),
        stribeck_velocity: section.number("stribeck_velocity"),
        enforce_velocity: section
            .entry("enforce_velocity")
            .map(|_| section.flag("enforce_velocity")),
        lower,
        upper,
        effort: section.number("effort"),
        velocity: section.number("velocity"),
    }
}

/// The tables of `[joint."…"]` or `[link."…"]`, in file order.
fn named_tables(reader: &Reader, section: &Section) -> std::vec::IntoIter<(Pattern, Section)> {
    let tables: Vec<_> = section
        .entries
        .iter()
        .filter_map(|entry| match &entry.node {
            Node::Table(table) => Some((
                pattern(reader, entry.name.clone(), &entry.span),
                table.clone(),
            )),
            Node::Value(_) | Node::Tables(_) => None,
        })
        .collect();
    tables.into_iter()
}

fn fmu(reader: &Reader, section: &Section) -> FmuSettings {
    let text = |name: &str| match section.value(name) {
        Some(Value::Texts(texts)) => texts.first().map(|(text, _)| text.clone()),
        _ => None,
    };
    FmuSettings {
        name: text("name"),
        author: text("author"),
        version: text("version"),
        copyright: text("copyright"),
        license: text("license"),
        stop_time: section.number("stop_time"),
        platforms: match section.value("platforms") {
            Some(Value::Texts(texts)) => patterns(reader, texts),
            _ => Vec::new(),
        },
        undocumented: !section.flag("documentation"),
        reference_run: section.flag("reference_run"),
        fmi: match section.number("fmi") {
            Some(3.0) => FmiVersion::V3,
            _ => FmiVersion::V2,
        },
        interface: match section.word("interface").as_deref() {
            Some("me") => Interface::Me,
            Some("both") => Interface::Both,
            _ => Interface::Cs,
        },
        arrays: match section.word("arrays").as_deref() {
            Some("none") => Arrays::None,
            Some("all") => Arrays::All,
            _ => Arrays::Vectors,
        },
    }
}
