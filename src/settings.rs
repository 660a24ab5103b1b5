//! The settings file: base, actuators, contact, world, initial state, outputs.
//!
//! TOML text → [`Settings`]. Everything that can be wrong without knowing the robot is found here, with its
//! place; names and globs are matched when the model is built (see [`crate::assemble`]).
//! Defaults and ranges are in [`keys::KEYS`].
//!
//! | code | about |
//! |---|---|
//! | S101 | not TOML |
//! | S102 | unknown key |
//! | S103 | wrong type |
//! | S104 | value outside its range |
//! | S105 | not supported yet |
//! | S106 | keys that contradict each other |
//! | S107 | a key that must be there is missing |
//! | S108 | the file cannot be read |

mod compat;
pub mod keys;
mod reader;

pub use compat::Compat;

pub(crate) use reader::nearest;

use crate::model::{ActuatorMode, Combination, ContactDefaults, Ground, SolverDefaults, World};
use crate::spatial::Vec3;
use crate::urdf::{Diagnostic, Place, ReadOptions, Severity};
use reader::{Node, Reader, Section, Span, Value};
use std::path::Path;

/// A settings file, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Whose conventions hold where nothing says otherwise.
    pub compat: Compat,
    /// Whether the base can move.
    pub base: BaseChoice,
    /// Every length times this; masses stay.
    pub scale: f64,
    /// Where rotational inertia comes from.
    pub inertia: InertiaSource,
    /// Variable names with `_` instead of `.`.
    pub flat_names: bool,
    /// Step and tolerance.
    pub solver: SolverDefaults,
    /// Contact law.
    pub contact: ContactDefaults,
    /// Gravity and ground.
    pub world: World,
    /// Initial state.
    pub initial: InitialSettings,
    /// What is commanded where no entry of `actuators` says so; none: position for limited joints, velocity
    /// for the others.
    pub default_mode: Option<ModeChoice>,
    /// Commanded joints; where several match a joint, each key is the last one's.
    pub actuators: Vec<ActuatorSettings>,
    /// Overrides of the file's joints, as above.
    pub joints: Vec<JointSettings>,
    /// Overrides of the file's links, as above.
    pub links: Vec<LinkSettings>,
    /// Links with contact outputs.
    pub contact_outputs: ContactOutputs,
    /// Links with pose and velocity outputs.
    pub link_outputs: Vec<Pattern>,
    /// Links with force and torque inputs.
    pub external_wrenches: Vec<Pattern>,
    /// Joints that share a command.
    pub groups: Vec<GroupSettings>,
    /// Sensors.
    pub sensors: Vec<SensorSettings>,
}

/// Joints that share a command.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSettings {
    /// Its name, and where it was given.
    pub name: Pattern,
    /// Which joints.
    pub joints: Vec<Pattern>,
}

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Its name; none: that of its link or joint.
    pub name: Option<Pattern>,
    /// The link, or the joint of a force–torque sensor.
    pub on: Pattern,
    /// Origin in the link, m.
    pub xyz: Vec3,
    /// Roll, pitch, yaw in the link, rad.
    pub rpy: Vec3,
    /// What it measures.
    pub kind: SensorSettingsKind,
}

/// What a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorSettingsKind {
    /// Orientation, angular velocity and specific force.
    Imu,
    /// Force and torque in a joint, in the axes of its parent or its child.
    ForceTorque {
        /// Whether in those of its parent.
        in_parent: bool,
    },
    /// Distances to the ground.
    Ray {
        /// How many.
        rays: u32,
        /// Angle from the first to the last, rad.
        fov: f64,
        /// Largest distance, m.
        range: f64,
    },
}

/// A name or glob (`*`: any characters, `?`: one) and where it was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// As given.
    pub text: String,
    /// Where; none for one that came from the command line.
    pub place: Option<Place>,
}

impl From<&str> for Pattern {
    fn from(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            place: None,
        }
    }
}

impl Pattern {
    /// Whether it is more than a plain name.
    pub fn is_glob(&self) -> bool {
        self.text.contains(['*', '?'])
    }

    /// Whether it means `name`.
    pub fn matches(&self, name: &str) -> bool {
        self.text == name || wildmatch::WildMatch::new(&self.text).matches(name)
    }
}

/// Whether the base can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseChoice {
    /// Fixed where the root is named `world` or has no mass and a moving child.
    Auto,
    /// It can.
    Floating,
    /// It cannot.
    Fixed,
}

/// Where rotational inertia comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InertiaSource {
    /// `<inertia>`.
    Urdf,
    /// The collision shapes, as solids of the link's mass.
    Collision,
    /// The box around the collision shapes, as `PyBullet` takes it.
    PyBullet,
}

/// Initial state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialSettings {
    /// Base x and y, m.
    pub xy: [f64; 2],
    /// Base z, m; none: the lowest collision point touches the ground.
    pub z: Option<f64>,
    /// Base roll, pitch, yaw, rad.
    pub rpy: Vec3,
    /// m/s, world axes.
    pub linear_velocity: Vec3,
    /// rad/s, world axes.
    pub angular_velocity: Vec3,
    /// rad or m.
    pub joints: Vec<(Pattern, f64)>,
    /// Of an SRDF's state, rad or m: for joints that `joints` leaves open.
    pub state: Vec<(Pattern, f64)>,
    /// rad/s or m/s.
    pub joint_velocities: Vec<(Pattern, f64)>,
    /// Where `linear_velocity` or `angular_velocity` was given.
    pub velocity_place: Option<Place>,
}

/// Commanded joints.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorSettings {
    /// Which joints.
    pub joint: Pattern,
    /// What is commanded; none: as without this entry.
    pub mode: Option<ModeChoice>,
    /// N·m or N.
    pub max_effort: Option<f64>,
    /// N·m/rad or N/m.
    pub kp: Option<f64>,
    /// N·m·s/rad or N·s/m.
    pub kd: Option<f64>,
    /// rad/s or m/s.
    pub no_load_speed: Option<f64>,
}

impl ActuatorSettings {
    /// An entry that changes nothing.
    pub fn new(joint: &str) -> Self {
        Self {
            joint: joint.into(),
            mode: None,
            max_effort: None,
            kp: None,
            kd: None,
            no_load_speed: None,
        }
    }

    /// Nothing drives the joint.
    pub fn passive(joint: Pattern) -> Self {
        Self {
            joint,
            mode: Some(ModeChoice::Passive),
            ..Self::new("")
        }
    }
}

/// What is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModeChoice {
    /// Nothing: the joint moves as the forces want.
    Passive,
    /// See [`ActuatorMode`].
    Commanded(ActuatorMode),
}

impl ModeChoice {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "velocity" => Self::Commanded(ActuatorMode::Velocity),
            "position" => Self::Commanded(ActuatorMode::Position),
            "effort" => Self::Commanded(ActuatorMode::Effort),
            "pd" => Self::Commanded(ActuatorMode::Pd),
            "none" => Self::Passive,
            _ => return None,
        })
    }
}

/// Overrides of the file's joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSettings {
    /// Which joints.
    pub joint: Pattern,
    /// N·m·s/rad or N·s/m.
    pub damping: Option<f64>,
    /// N·m or N.
    pub friction: Option<f64>,
    /// kg·m² or kg.
    pub armature: Option<f64>,
    /// N·m or N, dry, at rest.
    pub static_friction: Option<f64>,
    /// rad/s or m/s.
    pub stribeck_velocity: Option<f64>,
    /// Whether the velocity limit binds.
    pub enforce_velocity: Option<bool>,
    /// rad or m.
    pub lower: Option<f64>,
    /// rad or m.
    pub upper: Option<f64>,
    /// N·m or N.
    pub effort: Option<f64>,
    /// rad/s or m/s; 0: no limit.
    pub velocity: Option<f64>,
}

impl JointSettings {
    /// An entry that changes nothing.
    pub fn new(joint: &str) -> Self {
        Self {
            joint: joint.into(),
            damping: None,
            friction: None,
            armature: None,
            static_friction: None,
            stribeck_velocity: None,
            enforce_velocity: None,
            lower: None,
            upper: None,
            effort: None,
            velocity: None,
        }
    }
}

/// What the collision mesh of a wheel becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelFit {
    /// A cylinder or a ball where it is one, on a continuous joint.
    Auto,
    /// A cylinder.
    Cylinder,
    /// A ball.
    Sphere,
    /// The hull of the mesh.
    None,
}

impl WheelFit {
    /// From its word in the settings.
    pub fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "auto" => Self::Auto,
            "cylinder" => Self::Cylinder,
            "sphere" => Self::Sphere,
            "none" => Self::None,
            _ => return None,
        })
    }
}

/// Overrides of the file's links.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkSettings {
    /// Which links.
    pub link: Pattern,
    /// Coulomb coefficient.
    pub friction: Option<f64>,
    /// Coulomb coefficient at rest.
    pub static_friction: Option<f64>,
    /// m
    pub rolling_friction: Option<f64>,
    /// m
    pub torsional_friction: Option<f64>,
    /// Newton's coefficient.
    pub restitution: Option<f64>,
    /// N/m of a contact point.
    pub stiffness: Option<f64>,
    /// s/m
    pub dissipation: Option<f64>,
    /// kg; the inertia scales with it.
    pub mass: Option<f64>,
    /// What its collision meshes roll as.
    pub wheel_fit: Option<WheelFit>,
    /// Whether its collision meshes become several convex parts each, not one.
    pub decompose: Option<bool>,
}

impl LinkSettings {
    /// An entry that changes nothing.
    pub fn new(link: &str) -> Self {
        Self {
            link: link.into(),
            friction: None,
            static_friction: None,
            rolling_friction: None,
            torsional_friction: None,
            restitution: None,
            stiffness: None,
            dissipation: None,
            mass: None,
            wheel_fit: None,
            decompose: None,
        }
    }
}

/// Links with contact outputs.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactOutputs {
    /// Those with collision shapes at the end of the tree.
    Auto,
    /// These.
    Links(Vec<Pattern>),
}

impl Default for Settings {
    /// What an empty file means.
    fn default() -> Self {
        let mut reader = Reader::new("", "");
        fill(&mut reader, &Section::default(), None)
    }
}

impl Settings {
    /// What an empty file means under the conventions of another simulator.
    pub fn of(compat: Compat) -> Self {
        let mut reader = Reader::new("", "");
        fill(&mut reader, &Section::default(), Some(compat))
    }

    /// Reads a settings file.
    ///
    /// # Errors
    /// Everything that is wrong with it, see the module's table of codes.
    pub fn read(path: &Path) -> Result<Self, Vec<Diagnostic>> {
        Self::read_as(path, None)
    }

    /// Reads a settings file; a given `compat` wins over the file's.
    ///
    /// # Errors
    /// As [`Settings::read`].
    pub fn read_as(path: &Path, compat: Option<Compat>) -> Result<Self, Vec<Diagnostic>> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| {
            vec![Diagnostic {
                severity: Severity::Error,
                code: "S108",
                message: format!("cannot read the settings '{name}': {error}"),
                help: Some("the settings are a TOML file in UTF-8".to_owned()),
                place: None,
            }]
        })?;
        Self::parse_as(&text, &name, compat)
    }

    /// What the settings mean for the reader of the URDF: `options` with scale, source of inertia and
    /// links whose meshes become several parts.
    pub fn read_options(&self, options: ReadOptions) -> ReadOptions {
        ReadOptions {
            scale: self.scale,
            ignore_inertia: self.inertia != InertiaSource::Urdf,
            pybullet: self.compat == Compat::PyBullet || self.inertia == InertiaSource::PyBullet,
            decomposed: self
                .links
                .iter()
                .filter_map(|entry| Some((entry.link.clone(), entry.decompose?)))
                .collect(),
            ..options
        }
    }

    /// Reads the text of a settings file; `file_name` is for the findings.
    ///
    /// # Errors
    /// Everything that is wrong with it, see the module's table of codes.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::parse_as(text, file_name, None)
    }

    fn parse_as(
        text: &str,
        file_name: &str,
        compat: Option<Compat>,
    ) -> Result<Self, Vec<Diagnostic>> {
        let mut reader = Reader::new(file_name, text);
        let root = reader.read();
        let settings = root.map(|root| fill(&mut reader, &root, compat));
        match settings {
            Some(settings) if reader.findings.is_empty() => Ok(settings),
            _ => {
                let mut findings = reader.findings;
                findings.sort_by_key(|d| d.place.as_ref().map_or((0, 0), |p| (p.line, p.column)));
                Err(findings)
            }
        }
    }
}

fn fill(reader: &mut Reader, root: &Section, compat: Option<Compat>) -> Settings {
    let robot = root.table("robot");
    let compat = compat
        .or_else(|| Compat::from_word(&robot.word("compat")?))
        .unwrap_or_default();
    if robot.flag("self_collision") {
        unsupported(reader, &robot, "self_collision", "self_collision = true");
    }
    let outputs = root.table("outputs");
    Settings {
        compat,
        base: match robot.word("base").as_deref() {
            Some("floating") => BaseChoice::Floating,
            Some("fixed") => BaseChoice::Fixed,
            _ => BaseChoice::Auto,
        },
        scale: robot.number("scale").unwrap_or(1.0),
        inertia: match robot.value_as("inertia", compat) {
            Some(Value::Word(word)) if word == "collision" => InertiaSource::Collision,
            Some(Value::Word(word)) if word == "pybullet" => InertiaSource::PyBullet,
            _ => InertiaSource::Urdf,
        },
        flat_names: root.table("fmu").word("naming").as_deref() == Some("flat"),
        solver: solver(&root.table("solver"), compat),
        contact: contact(reader, &root.table("contact")),
        world: world(reader, &root.table("world"), compat),
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
            .map(|(link, section)| LinkSettings {
                link,
                friction: section.number("friction"),
                static_friction: section.number("static_friction"),
                rolling_friction: section.number("rolling_friction"),
                torsional_friction: section.number("torsional_friction"),
                restitution: section.number("restitution"),
                stiffness: section.number("stiffness"),
                dissipation: section.number("dissipation"),
                mass: section.number("mass"),
                wheel_fit: section
                    .word("wheel_fit")
                    .and_then(|word| WheelFit::from_word(&word)),
                decompose: section
                    .word("collision")
                    .map(|word| word == "decomposition"),
            })
            .collect(),
        contact_outputs: match outputs.value("contacts") {
            Some(Value::Texts(texts)) => ContactOutputs::Links(patterns(reader, texts)),
            Some(Value::Word(word)) if word == "none" => ContactOutputs::Links(Vec::new()),
            _ => ContactOutputs::Auto,
        },
        link_outputs: match outputs.value("links") {
            Some(Value::Texts(texts)) => patterns(reader, texts),
            _ => Vec::new(),
        },
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
        sensors: root
            .tables("sensor")
            .iter()
            .filter_map(|section| sensor(reader, section))
            .collect(),
    }
}

fn group(reader: &mut Reader, section: &Section) -> Option<GroupSettings> {
    let name = required(reader, section, "name", "group")?;
    let joints = match section.value("joints") {
        Some(Value::Texts(texts)) if !texts.is_empty() => patterns(reader, texts),
        _ => {
            required(reader, section, "joints", "group")?;
            return None;
        }
    };
    Some(GroupSettings { name, joints })
}

fn sensor(reader: &mut Reader, section: &Section) -> Option<SensorSettings> {
    let Some(word) = section.word("type") else {
        if !section.rejected.iter().any(|rejected| rejected == "type") {
            let message = "[[sensor]] needs 'type'";
            let help = "type = \"imu\", \"ft\" or \"ray\"";
            reader.error("S107", &section.span.clone(), message, help);
        }
        return None;
    };
    let (on, foreign): (&str, &[&str]) = match word.as_str() {
        "imu" => ("link", &["joint", "frame", "rays", "fov", "range"]),
        "ft" => ("joint", &["link", "xyz", "rpy", "rays", "fov", "range"]),
        _ => ("link", &["joint", "frame"]),
    };
    for key in foreign {
        if let Some(entry) = section.entry(key) {
            let message = format!("'{key}' has no meaning for a sensor of type \"{word}\"");
            reader.error("S106", &entry.span.clone(), message, "leave it out");
        }
    }
    let (rays, fov) = (section.number("rays"), section.number("fov"));
    if let (None | Some(1.0), Some(entry)) = (rays, section.entry("fov")) {
        let message = "'fov' has no meaning for one ray";
        reader.error("S106", &entry.span.clone(), message, "set rays, too");
    }
    Some(SensorSettings {
        on: required(reader, section, on, "sensor")?,
        name: match section.value("name") {
            Some(Value::Texts(texts)) => patterns(reader, texts).into_iter().next(),
            _ => None,
        },
        xyz: vector(section, "xyz"),
        rpy: vector(section, "rpy"),
        kind: match word.as_str() {
            "imu" => SensorSettingsKind::Imu,
            "ft" => SensorSettingsKind::ForceTorque {
                in_parent: section.word("frame").as_deref() == Some("parent"),
            },
            _ => SensorSettingsKind::Ray {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "checked: a whole number from 1 to ten thousand"
                )]
                rays: rays.unwrap_or(1.0) as u32,
                fov: fov.unwrap_or(0.0),
                range: section.number("range").unwrap_or(10.0),
            },
        },
    })
}

fn unsupported(reader: &mut Reader, section: &Section, key: &str, what: &str) {
    let span = section.entry(key).map_or(0..0, |entry| entry.span.clone());
    let message = format!("{what} is not supported yet");
    reader.error("S105", &span, message, "leave it out");
}

fn solver(section: &Section, compat: Compat) -> SolverDefaults {
    SolverDefaults {
        step_size: section.number_as("step_size", compat).unwrap_or(0.0),
        // 0 leaves the choice to the importer.
        tolerance: section.number("tolerance").unwrap_or(0.0),
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

fn world(reader: &mut Reader, section: &Section, compat: Compat) -> World {
    let ground = section.table("ground");
    let kind = ground.word("type");
    if kind.as_deref() == Some("heightfield") {
        unsupported(reader, &ground, "type", "a heightfield");
    }
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
        ground: (kind.as_deref() != Some("none")).then(|| Ground {
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

/// Static over sliding friction, less 1; none where it is negative, or has no sliding friction to go with.
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
    let (lower, upper) = (limits.number("lower"), limits.number("upper"));
    if let (Some(lower), Some(upper)) = (lower, upper)
        && lower > upper
    {
        let message = format!("the lower limit {lower} lies above the upper limit {upper}");
        reader.error("S106", &limits.span, message, "exchange them");
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

fn required(reader: &mut Reader, section: &Section, key: &str, table: &str) -> Option<Pattern> {
    if let Some(Value::Texts(texts)) = section.value(key) {
        patterns(reader, texts).into_iter().next()
    } else {
        if !section.rejected.iter().any(|rejected| rejected == key) {
            let span = section.span.clone();
            let message = format!("[[{table}]] needs '{key}'");
            let help = match key {
                "name" => "name = \"a name of your own\"".to_owned(),
                "joints" => "joints = [\"names or globs\"]".to_owned(),
                _ => format!("{key} = \"a name or glob\""),
            };
            reader.error("S107", &span, message, help);
        }
        None
    }
}

fn pattern(reader: &Reader, text: String, span: &Span) -> Pattern {
    Pattern {
        text,
        place: Some(reader.place(span)),
    }
}

fn patterns(reader: &Reader, texts: Vec<(String, Span)>) -> Vec<Pattern> {
    texts
        .into_iter()
        .map(|(text, span)| pattern(reader, text, &span))
        .collect()
}

fn vector(section: &Section, key: &str) -> Vec3 {
    match section.numbers(key).as_deref() {
        Some([x, y, z]) => Vec3::new(*x, *y, *z),
        _ => Vec3::zeros(),
    }
}

#[cfg(test)]
mod tests;
