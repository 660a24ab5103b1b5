//! A settings file for a given robot, for people to edit.
//!
//! The file contains the values that apply without it: exporting with it, or with any of its
//! `#key = value` lines made active, gives the same model. Keys and their meaning come from the
//! table of keys, values from the assembled robot; lines that start with `# ` are prose.

use crate::output::stem;
use crate::world::free_name;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use urdf2fmu_core::assemble::Guest;
use urdf2fmu_core::diagnostic::Diagnostic;
use urdf2fmu_core::diagnostic::words::shell;
use urdf2fmu_core::model::{ActuatorMode, Arrays, Interface, Joint, JointKind, LinkId, Model};
use urdf2fmu_core::settings::keys::{KEYS, Key};
use urdf2fmu_core::settings::{
    Compat, FmuSettings, InertiaSource, InitialSettings, ObjectSettings, ObjectSource, Settings,
};

/// What is written about.
#[derive(Debug)]
pub struct Subject {
    /// As assembled.
    pub model: Model,
    /// As asked for on the command line.
    pub settings: Settings,
    /// Of assembly.
    pub diagnostics: Vec<Diagnostic>,
    /// The URDF's name and what the command line says beside it that has no key, word by word.
    pub command: Vec<String>,
    /// What is around the robot, as asked for on the command line.
    pub objects: Vec<Object>,
}

/// Something around the robot.
#[derive(Debug)]
pub struct Object {
    name: String,
    urdf: PathBuf,
    initial: InitialSettings,
}

/// A name, and the file that it is of.
pub fn named(guest: &Guest) -> (String, Option<PathBuf>) {
    let file = guest.description.sources.first().cloned();
    (guest.name.clone(), file)
}

/// Objects of the command line, with the names that they get there.
///
/// - `named`: of the world that these make
/// - `folder`: that of the settings, from which names of files in it count; none: the current one
pub fn objects(
    asked: &[ObjectSettings],
    named: &[(String, Option<PathBuf>)],
    folder: Option<&Path>,
) -> Vec<Object> {
    let mut taken: Vec<String> = named.iter().map(|(name, _)| name.clone()).collect();
    let mut named = named.iter().peekable();
    let mut objects = Vec::new();
    for object in asked {
        let ObjectSource::Urdf(path) = &object.source else {
            continue;
        };
        let own = named.next_if(|(_, file)| file.as_ref() == Some(path));
        // What has become the ground is no part of the world, but needs a name in the settings.
        let named = own.map(|(name, _)| name.clone());
        let name = named.unwrap_or_else(|| {
            let name = free_name(&stem(path).to_string_lossy(), &taken);
            taken.push(name.clone());
            name
        });
        let elsewhere = folder.is_some_and(|folder| folder != Path::new("."));
        let absolute = elsewhere.then(|| std::path::absolute(path).ok()).flatten();
        objects.push(Object {
            name,
            urdf: absolute.unwrap_or_else(|| path.clone()),
            initial: object.initial.clone(),
        });
    }
    objects
}

/// The file.
pub fn text(subject: &Subject) -> String {
    let words: Vec<String> = subject.command.iter().map(|word| shell(word)).collect();
    let (robot_file, more) = words
        .split_first()
        .map_or(("", String::new()), |(file, more)| {
            let more = more.iter().map(|word| format!(" {word}"));
            (file, more.collect())
        });
    let mut out = format!(
        "# Settings of {}, for: urdf2fmu export {robot_file}{more} -c THIS_FILE\n\
         # Lines that start with # show what holds without them. Remove the # and change the value.\n",
        subject.model.name,
    );
    robot(&mut out, subject);
    for table in ["solver", "contact", "world", "world.ground"] {
        defaults(&mut out, table, subject.settings.compat);
    }
    things(&mut out, &subject.objects);
    initial(&mut out, subject);
    actuators(&mut out, &subject.model);
    joints(&mut out, &subject.model);
    links(&mut out, &subject.model);
    outputs(&mut out, &subject.model);
    out
}

/// A TOML string.
fn quoted(text: &str) -> String {
    // JSON's escapes are a part of TOML's.
    serde_json::Value::from(text).to_string()
}

/// Every digit.
fn exact(value: f64) -> String {
    format!("{value:?}")
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|v| exact(*v)).collect();
    format!("[{}]", values.join(", "))
}

/// Keys of the table at `path`, with their own names.
fn keys_of(path: &str) -> impl Iterator<Item = (&'static Key, &'static str)> {
    KEYS.iter().filter_map(move |key| {
        let (table, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
        (table == path).then_some((key, name))
    })
}

/// What a key is for.
fn about(path: &str) -> &'static str {
    KEYS.iter()
        .find(|key| key.path == path)
        .map_or("", |key| key.about)
}

/// One line each: a key with what holds without it, or prose for a key that something else decides.
fn defaults(out: &mut String, table: &str, compat: Compat) {
    _ = writeln!(out, "\n[{table}]");
    for (key, name) in keys_of(table) {
        match compat.default_of(key.path).or(key.default) {
            Some(default) => _ = writeln!(out, "#{name} = {default}  # {}", key.about),
            None => _ = writeln!(out, "# {name}: {}", key.about),
        }
    }
}

/// Things in the world: those asked for, and how others are written.
fn things(out: &mut String, objects: &[Object]) {
    out.push_str("\n# Things in the world, each a [[world.object]] of its own.\n");
    for table in ["world.object[]", "world.object[].shape"] {
        legend(out, table);
    }
    for object in objects {
        let mut place = object.initial.xy.to_vec();
        place.extend(object.initial.z);
        _ = writeln!(
            out,
            "[[world.object]]\nname = {}\nurdf = {}\nxyz = {}\nrpy = {}",
            quoted(&object.name),
            quoted(&object.urdf.display().to_string()),
            list(&place),
            list(object.initial.rpy.as_slice()),
        );
    }
    out.push_str("# What they stand on besides the ground, each a [[world.terrain]] of its own.\n");
    legend(out, "world.terrain[]");
    out.push_str("# Further robots, each a [[world.robot]] of its own.\n");
    legend(out, "world.robot[]");
}

/// A key that holds: active where the command line asked for it.
fn choice(out: &mut String, table: &str, name: &str, value: &str, active: bool) {
    let mark = if active { "" } else { "#" };
    let about = about(&format!("{table}.{name}"));
    _ = writeln!(out, "{mark}{name} = {value}  # {about}");
}

fn robot(out: &mut String, subject: &Subject) {
    let (model, settings) = (&subject.model, &subject.settings);
    let compat = settings.compat;
    let default = Settings::of(compat);
    out.push_str("\n[robot]\n");
    let base = if model.is_floating() {
        "floating"
    } else {
        "fixed"
    };
    choice(
        out,
        "robot",
        "base",
        &quoted(base),
        settings.base != default.base,
    );
    let bolted =
        |finding: &&Diagnostic| finding.code == "A107" && finding.message.contains("bolted down");
    if let Some(finding) = subject.diagnostics.iter().find(bolted) {
        // A comment has one line, whatever a name in it has.
        let message = finding.message.replace(char::is_control, " ");
        _ = writeln!(out, "# {message}\n# base = \"fixed\" mounts it");
    }
    #[expect(clippy::float_cmp, reason = "the default itself, or another number")]
    let scaled = settings.scale != default.scale;
    choice(out, "robot", "scale", &exact(settings.scale), scaled);
    let inertia = match settings.inertia {
        InertiaSource::Urdf => "urdf",
        InertiaSource::Nearest => "nearest",
        InertiaSource::Collision => "collision",
        InertiaSource::PyBullet => "pybullet",
    };
    let active = settings.inertia != default.inertia;
    choice(out, "robot", "inertia", &quoted(inertia), active);
    let sensors = if settings.described_sensors {
        "urdf"
    } else {
        "none"
    };
    let active = settings.described_sensors;
    choice(out, "robot", "sensors", &quoted(sensors), active);
    if let Some(density) = settings.density {
        choice(out, "robot", "density", &exact(density), true);
    }
    if let Some(mass) = settings.missing_mass {
        choice(out, "robot", "missing_mass", &exact(mass), true);
    }
    let active = compat != Compat::None;
    choice(out, "robot", "compat", &quoted(compat.word()), active);
    out.push_str("\n[fmu]\n");
    let naming = if settings.flat_names {
        "flat"
    } else {
        "structured"
    };
    choice(out, "fmu", "naming", &quoted(naming), settings.flat_names);
    packed(out, &settings.fmu);
}

/// What describes the FMU, and what is in it.
fn packed(out: &mut String, about: &FmuSettings) {
    let default = FmuSettings::default();
    let fmi = about.fmi.major().to_string();
    choice(out, "fmu", "fmi", &fmi, about.fmi != default.fmi);
    let interface = match about.interface {
        Interface::Cs => "cs",
        Interface::Me => "me",
        Interface::Both => "both",
    };
    let active = about.interface != default.interface;
    choice(out, "fmu", "interface", &quoted(interface), active);
    let arrays = match about.arrays {
        Arrays::Vectors => "vectors",
        Arrays::None => "none",
        Arrays::All => "all",
    };
    let active = about.arrays != default.arrays;
    choice(out, "fmu", "arrays", &quoted(arrays), active);
    for (key, text) in [
        ("name", &about.name),
        ("author", &about.author),
        ("version", &about.version),
        ("copyright", &about.copyright),
        ("license", &about.license),
    ] {
        if let Some(text) = text {
            choice(out, "fmu", key, &quoted(text), true);
        }
    }
    if let Some(stop_time) = about.stop_time {
        choice(out, "fmu", "stop_time", &exact(stop_time), true);
    }
    let documented = (!about.undocumented).to_string();
    choice(out, "fmu", "documentation", &documented, about.undocumented);
    let run = about.reference_run;
    choice(out, "fmu", "reference_run", &run.to_string(), run);
    let names = about.platforms.iter().map(|name| quoted(&name.text));
    let names = format!("[{}]", names.collect::<Vec<_>>().join(", "));
    choice(out, "fmu", "platforms", &names, !about.platforms.is_empty());
}

fn initial(out: &mut String, subject: &Subject) {
    let model = &subject.model;
    let initial = &model.initial;
    out.push_str("\n[initial]\n");
    let root = &model.roots[0];
    // A root that stands for the world is placed itself, not the base that the model has.
    let left_out = subject
        .diagnostics
        .iter()
        .any(|d| d.code == "A107" && d.message.contains("left out"));
    if left_out {
        _ = writeln!(out, "# xyz, rpy: m and rad, where the root link is placed");
    } else {
        let xyz = list(root.position.as_slice());
        choice(out, "initial", "xyz", &xyz, false);
        choice(out, "initial", "rpy", &list(root.rpy.as_slice()), false);
    }
    if model.is_floating() {
        let velocity = list(root.linear_velocity.as_slice());
        choice(out, "initial", "linear_velocity", &velocity, false);
        let velocity = list(root.angular_velocity.as_slice());
        choice(out, "initial", "angular_velocity", &velocity, false);
    }
    let free: Vec<usize> = (0..model.joints.len())
        .filter(|&j| is_scalar(&model.joints[j]) && model.joints[j].mimic.is_none())
        .collect();
    if free.is_empty() {
        return;
    }
    for (table, values) in [
        ("joints", &initial.joint_positions),
        ("joint_velocities", &initial.joint_velocities),
    ] {
        let about = about(&format!("initial.{table}.*"));
        _ = writeln!(out, "\n[initial.{table}]  # {about}");
        for &j in &free {
            let name = quoted(&model.joints[j].name);
            _ = writeln!(out, "#{name} = {}", exact(values[j]));
        }
    }
}

fn is_scalar(joint: &Joint) -> bool {
    matches!(
        joint.kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    )
}

/// Prose about all keys of a table.
fn legend(out: &mut String, table: &str) {
    for (key, name) in keys_of(table) {
        _ = writeln!(out, "# {name}: {}", key.about);
    }
}

fn actuators(out: &mut String, model: &Model) {
    if model.actuators.is_empty() {
        return;
    }
    out.push_str("\n# What is commanded. A glob such as \"left_*\" means several joints.\n");
    legend(out, "actuator[]");
    for actuator in &model.actuators {
        let joint = &model.joints[actuator.joint.index()];
        let mode = match actuator.mode {
            ActuatorMode::Velocity => "velocity",
            ActuatorMode::Position => "position",
            ActuatorMode::Effort => "effort",
            ActuatorMode::Pd => "pd",
        };
        _ = writeln!(
            out,
            "[[actuator]]\njoint = {}\nmode = {}",
            quoted(&joint.name),
            quoted(mode)
        );
        if actuator.mode != ActuatorMode::Effort {
            _ = writeln!(out, "max_effort = {}", exact(actuator.max_effort));
        }
        if actuator.mode == ActuatorMode::Pd {
            _ = writeln!(out, "#kp = {}", exact(actuator.kp));
            _ = writeln!(out, "#kd = {}", exact(actuator.kd));
        }
    }
}

fn joints(out: &mut String, model: &Model) {
    let mut scalar = model
        .joints
        .iter()
        .filter(|joint| is_scalar(joint))
        .peekable();
    if scalar.peek().is_none() {
        return;
    }
    out.push_str("\n# Joints. Globs do here, too.\n");
    legend(out, "joint.*");
    for joint in scalar {
        _ = writeln!(out, "[joint.{}]", quoted(&joint.name));
        _ = writeln!(out, "#damping = {}", exact(joint.damping));
        _ = writeln!(out, "#friction = {}", exact(joint.friction));
        _ = writeln!(out, "#armature = {}", exact(joint.armature));
        if let Some(limits) = joint.limits {
            let (lower, upper) = (exact(limits.lower), exact(limits.upper));
            _ = writeln!(out, "#limits = {{ lower = {lower}, upper = {upper} }}");
        }
        for (name, value) in [("effort", joint.effort), ("velocity", joint.velocity)] {
            if let Some(value) = value {
                _ = writeln!(out, "#{name} = {}", exact(value));
            }
        }
    }
}

fn links(out: &mut String, model: &Model) {
    out.push_str("\n# Links. Globs do here, too.\n");
    legend(out, "link.*");
    for (l, link) in model.links.iter().enumerate() {
        let shaped = model.colliders.iter().any(|c| c.link == LinkId::from(l));
        if !shaped && link.inertia.mass <= 0.0 {
            continue;
        }
        _ = writeln!(out, "[link.{}]", quoted(&link.name));
        if shaped {
            _ = writeln!(out, "#friction = {}", exact(link.friction));
            _ = writeln!(out, "#restitution = {}", exact(link.restitution));
        }
        if link.inertia.mass > 0.0 {
            _ = writeln!(out, "#mass = {}", exact(link.inertia.mass));
        }
    }
}

fn outputs(out: &mut String, model: &Model) {
    out.push_str("\n[outputs]\n");
    choice(out, "outputs", "contacts", &quoted("auto"), false);
    choice(out, "outputs", "contact_points", "false", false);
    choice(out, "outputs", "links", "[]", false);
    let link = quoted(&model.links[0].name);
    out.push_str("\n# More inputs and outputs, as wanted:\n");
    out.push_str("# [[outputs.pair]]\n");
    legend(out, "outputs.pair[]");
    _ = writeln!(out, "# [[external_wrench]]\n# link = {link}");
    _ = writeln!(out, "# [[sensor]]\n# type = \"imu\"\n# link = {link}");
    if let Some(joint) = model.joints.last() {
        let joint = quoted(&joint.name);
        _ = writeln!(out, "# [[sensor]]\n# type = \"ft\"\n# joint = {joint}");
    }
    if model.actuators.len() > 1 {
        out.push_str("# [[group]]\n# name = \"drive\"\n# joints = [\"*_wheel_joint\"]\n");
    }
}
