//! Settings that change nothing.
//!
//! A key whose effect depends on another one, in a table of its own or in the URDF, is judged here,
//! when all of them are known. What one table says in vain by itself is an error of the settings.

use super::findings::Findings;
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::SensorKind;
use crate::model::{Arrays, Combination, Interface, Joint, JointKind, Link, Model};
use crate::pattern::Pattern;
use crate::settings::{
    ActuatorSettings, Compat, FmiVersion, ModeChoice, SensorSettingsKind, Settings, WheelFit,
};
use crate::urdf::{CollisionDescription, Description};
use std::collections::BTreeSet;

/// Warns of the tables of joints and links that have a key in vain, each at its place.
///
/// - `shapes`: of each link
pub(super) fn report(
    model: &Model,
    shapes: &[Vec<CollisionDescription>],
    settings: &Settings,
    findings: &mut Findings,
) {
    if findings.has_errors() {
        // They may be about the very keys that are missing.
        return;
    }
    for entry in &settings.joints {
        let moves = |joint: &&Joint| joint.kind != JointKind::Fixed;
        let mut meant = matching(&entry.joint, &model.joints, |joint| &joint.name).filter(moves);
        if entry.stribeck_velocity.is_some() && meant.all(|joint| joint.static_excess <= 0.0) {
            let message = format!(
                "'stribeck_velocity' of [joint.\"{}\"] changes nothing: friction falls from \
                 static_friction, which is not above friction here",
                entry.joint.text
            );
            let help = "set static_friction of the joint above its friction, or leave it out";
            findings.warning("A144", entry.joint.place.clone(), message, help);
        }
    }
    of_ignored_contacts(model, settings, findings);
    of_self_collision(model, shapes, settings, findings);
    of_velocity_limits(model, settings, findings);
    of_surfaces(model, shapes, settings, findings);
    for entry in &settings.links {
        let rolls = matches!(entry.wheel_fit, Some(WheelFit::Cylinder | WheelFit::Sphere));
        let mut meant = model.links.iter().zip(shapes);
        let meshes = meant.any(|(link, shapes)| {
            entry.link.matches(&link.name) && shapes.iter().any(|shape| shape.mesh.is_some())
        });
        if rolls && !meshes {
            let message = format!(
                "'wheel_fit' of [link.\"{}\"] changes nothing: no collision shape there is a mesh",
                entry.link.text
            );
            findings.warning("A144", entry.link.place.clone(), message, "leave it out");
        }
    }
    if settings.fmu.arrays == Arrays::All && settings.fmu.fmi == FmiVersion::V2 {
        let message = "'arrays' of [fmu] changes nothing: FMI 2 has no arrays".to_owned();
        findings.warning(
            "A144",
            None,
            message,
            "leave it out, or set fmi = 3, or --fmi 3",
        );
    }
    // Where coefficients are multiplied, the other side may keep a link from bouncing.
    let own_counts = model.world.combination == Combination::Mean;
    for entry in settings.links.iter().filter(|_| own_counts) {
        let mut meant = matching(&entry.link, &model.links, |link: &Link| &link.name);
        if entry.dissipation.is_some() && meant.all(|link| link.restitution > 0.0) {
            let message = format!(
                "'dissipation' of [link.\"{}\"] changes nothing: restitution takes its place, which \
                 is not 0 here",
                entry.link.text
            );
            let help = "leave one of the two out; restitution = 0 keeps the dissipation";
            findings.warning("A144", entry.link.place.clone(), message, help);
        }
    }
}

/// Warns of joints that are held at a velocity limit which they do not have.
fn of_velocity_limits(model: &Model, settings: &Settings, findings: &mut Findings) {
    for entry in &settings.joints {
        let moves = |joint: &&Joint| joint.kind != JointKind::Fixed;
        let mut meant = matching(&entry.joint, &model.joints, |joint| &joint.name).filter(moves);
        if entry.enforce_velocity == Some(true) && meant.all(|joint| joint.velocity.is_none()) {
            let message = format!(
                "'enforce_velocity' of [joint.\"{}\"] changes nothing: there is no velocity limit",
                entry.joint.text
            );
            let help = "set a velocity above 0 there, or leave it out";
            findings.warning("A144", entry.joint.place.clone(), message, help);
        }
    }
}

/// Warns of the surface of links that have none.
fn of_surfaces(
    model: &Model,
    shapes: &[Vec<CollisionDescription>],
    settings: &Settings,
    findings: &mut Findings,
) {
    // What is said of all links may be meant for other robots, too.
    for entry in settings.links.iter().filter(|entry| entry.link.text != "*") {
        let keys = [
            ("friction", entry.friction),
            ("static_friction", entry.static_friction),
            ("rolling_friction", entry.rolling_friction),
            ("torsional_friction", entry.torsional_friction),
            ("restitution", entry.restitution),
            ("stiffness", entry.stiffness),
            ("dissipation", entry.dissipation),
        ];
        let Some((key, _)) = keys.iter().find(|(_, value)| value.is_some()) else {
            continue;
        };
        let mut meant = model.links.iter().zip(shapes);
        if !meant.any(|(link, shapes)| entry.link.matches(&link.name) && !shapes.is_empty()) {
            let message = format!(
                "'{key}' of [link.\"{}\"] changes nothing: there is no collision shape that \
                 touches anything",
                entry.link.text
            );
            let help = "leave it out, or name the link that has the shapes";
            findings.warning("A144", entry.link.place.clone(), message, help);
        }
    }
}

/// Warns of entries of `[[actuator]]` whose keys later ones replace for each of their joints.
pub(super) fn of_actuators(model: &Model, settings: &Settings, findings: &mut Findings) {
    if findings.has_errors() {
        return;
    }
    let keys = |entry: &ActuatorSettings| {
        let numbers = [entry.max_effort, entry.kp, entry.kd, entry.no_load_speed];
        let mode = entry.mode.is_some();
        [mode].into_iter().chain(numbers.map(|key| key.is_some()))
    };
    for (i, entry) in settings.actuators.iter().enumerate() {
        // Those of an SRDF come first so that the settings may drive them.
        if entry.mode == Some(ModeChoice::Passive) || !keys(entry).any(|set| set) {
            continue;
        }
        let later = &settings.actuators[i + 1..];
        let replaced = |joint: &Joint| {
            let mut own = keys(entry).enumerate().filter(|(_, set)| *set);
            let mut others = later
                .iter()
                .filter(|other| other.joint.matches(&joint.name));
            own.all(|(key, _)| others.any(|other| keys(other).nth(key) == Some(true)))
        };
        let mut meant = matching(&entry.joint, &model.joints, |joint| &joint.name).peekable();
        // A name of no joint is an error, and nothing follows from it.
        if meant.peek().is_some() && meant.all(replaced) {
            let message = format!(
                "[[actuator]] of '{}' changes nothing: a later one sets the same for all of its \
                 joints",
                entry.joint.text
            );
            let help = "the last entry counts: put that of a glob before those of single joints";
            findings.warning("A144", entry.joint.place.clone(), message, help);
        }
    }
}

/// Notes that the sensors of a file without any are asked for.
pub(super) fn of_described_sensors(
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) {
    if settings.described_sensors && description.sensors.is_empty() {
        let message =
            "sensors = \"urdf\" changes nothing: the URDF has none that is read".to_owned();
        findings.note("A144", message, "leave [robot] sensors, or --sensors, out");
    }
}

/// Warns of links that are kept from touching each other where none do.
fn of_ignored_contacts(model: &Model, settings: &Settings, findings: &mut Findings) {
    for patterns in &settings.ignored_contacts {
        let meant = |link: &&Link| patterns.iter().any(|pattern| pattern.matches(&link.name));
        let mut links = model.links.iter().filter(meant);
        let (why, help) = match (links.next(), links.next()) {
            _ if !settings.self_collision => (
                "links of one robot do not touch each other without self_collision".to_owned(),
                "leave it out, or set self_collision = true in [robot]",
            ),
            (Some(only), None) => (
                format!("'{}' alone is no pair", only.name),
                "name both links that do not touch each other, or use a glob",
            ),
            _ => continue,
        };
        let place = patterns.first().and_then(|pattern| pattern.place.clone());
        let message = format!("[[ignore_contact]] changes nothing: {why}");
        findings.warning("A144", place, message, help);
    }
}

/// Warns of a robot whose links are to touch each other and are one body.
fn of_self_collision(
    model: &Model,
    shapes: &[Vec<CollisionDescription>],
    settings: &Settings,
    findings: &mut Findings,
) {
    let links = model.links.iter().zip(shapes);
    let shaped = links.filter(|(_, shapes)| !shapes.is_empty());
    let bodies: BTreeSet<_> = shaped.map(|(link, _)| link.body).collect();
    if settings.self_collision && bodies.len() < 2 {
        let message = "'self_collision' of [robot] changes nothing: all links with collision \
                       shapes are one body"
            .to_owned();
        let help = "leave it out, or give collision shapes to what moves against them";
        findings.warning("A144", None, message, help);
    }
}

/// What a pattern means.
fn matching<'m, T>(
    pattern: &'m Pattern,
    all: &'m [T],
    name: impl Fn(&T) -> &String + 'm,
) -> impl Iterator<Item = &'m T> {
    all.iter().filter(move |one| pattern.matches(name(one)))
}

/// Warnings of keys that nothing in the world has a use for: of the law of contact, and of the
/// solver.
pub(super) fn of_world(model: &Model, settings: &Settings) -> Vec<Diagnostic> {
    let cases = of_contact(model, settings).into_iter();
    let cases = cases.map(|(key, why, help)| ("contact", key, why, help));
    let solver = of_solver(model, settings).into_iter();
    let all = cases.chain(solver.map(|(key, why, help)| ("solver", key, why, help)));
    let keys = all.map(|(table, key, why, help)| Diagnostic {
        severity: Severity::Warning,
        code: "A144",
        message: format!("'{key}' of [{table}] changes nothing: {why}"),
        help: Some(help.to_owned()),
        place: None,
    });
    keys.chain(of_contact_sensors(model, settings)).collect()
}

/// Warnings of contact sensors on which nothing can press: links of a mounted base touch neither
/// the ground, which does not move against them, nor anything else.
fn of_contact_sensors(model: &Model, settings: &Settings) -> Vec<Diagnostic> {
    let [root] = &model.roots[..] else {
        return Vec::new();
    };
    if settings.self_collision || model.is_floating() {
        return Vec::new();
    }
    let sensors = model.outputs.sensors.iter().filter(|sensor| {
        let on_base = model.links[sensor.link.index()].body == root.body;
        on_base && matches!(sensor.kind, SensorKind::Contact { .. })
    });
    sensors
        .map(|sensor| {
            let link = &model.links[sensor.link.index()].name;
            let asked = settings.sensors.iter().find(|own| {
                let contact = matches!(own.kind, SensorSettingsKind::Contact { .. });
                contact && own.on.matches(link)
            });
            Diagnostic {
                severity: Severity::Warning,
                code: "A144",
                message: format!(
                    "contact sensor '{}' measures 0: link '{link}' is mounted in the world, and \
                     nothing else can touch it",
                    sensor.name
                ),
                help: Some(
                    "put it on a link that moves, or add objects or self_collision; a \
                     sensor of type ft measures what a mounted robot is held by"
                        .to_owned(),
                ),
                place: asked.and_then(|own| own.on.place.clone()),
            }
        })
        .collect()
}

/// A key in vain, why it is, and what helps.
type Vain = (&'static str, &'static str, &'static str);

/// Keys of the solver where it is the importer who integrates.
fn of_solver(model: &Model, settings: &Settings) -> Vec<Vain> {
    if model.outputs.interface != Interface::Me {
        return Vec::new();
    }
    let (set, own) = (&settings.solver, Settings::of(settings.compat).solver);
    let keys = [
        ("step_size", differ(set.step_size, own.step_size)),
        ("max_steps", differ(set.max_steps, own.max_steps)),
    ];
    let why = "in Model Exchange the importer takes the steps";
    let help = "leave it out, or set interface = \"both\" or \"cs\" in [fmu]";
    all_for_one_reason(&keys, why, help)
}

/// Whether a number was set, as it is not the one that stands for none.
fn differ(set: f64, own: f64) -> bool {
    set.to_bits() != own.to_bits()
}

/// Keys that were set, all in vain for one reason.
fn all_for_one_reason(
    keys: &[(&'static str, bool)],
    why: &'static str,
    help: &'static str,
) -> Vec<Vain> {
    let given = keys.iter().filter(|(_, given)| *given);
    given.map(|(key, _)| (*key, why, help)).collect()
}

/// Keys of the law of contact.
fn of_contact(model: &Model, settings: &Settings) -> Vec<Vain> {
    let (set, own) = (&model.contact, Settings::of(settings.compat).contact);
    let ground = model.world.ground.iter().map(|ground| ground.static_excess);
    let mut excess = model.links.iter().map(|l| l.static_excess).chain(ground);
    let touching: Vec<&Link> = model
        .colliders
        .iter()
        .map(|collider| &model.links[collider.link.index()])
        .collect();
    let each =
        |has: fn(&Link) -> bool| !touching.is_empty() && touching.iter().all(|link| has(link));
    let lone = model.world.ground.is_none() && model.roots.len() == 1 && !settings.self_collision;
    if touching.is_empty() || lone {
        let keys = [
            ("penetration", differ(set.penetration, own.penetration)),
            ("stiffness", set.stiffness.is_some()),
            ("dissipation", differ(set.dissipation, own.dissipation)),
            (
                "stribeck_velocity",
                differ(set.stribeck_velocity, own.stribeck_velocity),
            ),
        ];
        let why = "there is nothing that touches anything";
        let help = "leave it out, or add a ground, collision shapes, objects or self_collision";
        return all_for_one_reason(&keys, why, help);
    }
    let stiff = each(|link| link.stiffness.is_some());
    // Where coefficients are multiplied, the other side may keep a link from bouncing.
    let own_counts = model.world.combination == Combination::Mean;
    let damped = each(|link| link.dissipation.is_some() || link.restitution > 0.0) && own_counts;
    let cases = [
        (
            "stribeck_velocity",
            differ(set.stribeck_velocity, own.stribeck_velocity)
                && excess.all(|excess| excess <= 0.0),
            "friction falls from static_friction, and neither a link nor the ground has one above \
             its friction",
            "set static_friction in [link.\"…\"] or [world.ground], or leave it out",
        ),
        (
            "penetration",
            differ(set.penetration, own.penetration) && stiff,
            "each link that touches anything has a stiffness of its own",
            "leave it out, or the stiffness of the links",
        ),
        (
            "stiffness",
            set.stiffness.is_some() && stiff,
            "each link that touches anything has one of its own",
            "leave it out, or that of the links",
        ),
        (
            "dissipation",
            differ(set.dissipation, own.dissipation) && damped,
            "each link that touches anything has one of its own, or a restitution in its place",
            "leave it out, or that of the links",
        ),
    ];
    let idle = cases.into_iter().filter(|(_, idle, ..)| *idle);
    idle.map(|(key, _, why, help)| (key, why, help)).collect()
}

/// Notes that the density of links without mass is of none.
pub(super) fn of_density(settings: &Settings, findings: &mut Findings) {
    if let Some(density) = settings.density {
        let message = format!(
            "the density of {density} kg/m³ changes nothing: no link with collision shapes lacks a \
             mass"
        );
        findings.note("A144", message, "leave [robot] density, or --density, out");
    }
}

/// Notes that a mass of links that could not move without is of none.
pub(super) fn of_missing_mass(settings: &Settings, findings: &mut Findings) {
    if let Some(mass) = settings.missing_mass {
        let why = match settings.compat {
            Compat::None => "each link that moves has inertia, or what hangs on it",
            Compat::PyBullet => "links without mass have 1 kg, as in PyBullet",
        };
        let message = format!("the missing_mass of {mass} kg changes nothing: {why}");
        let help = "leave [robot] missing_mass, or --missing-mass, out";
        findings.note("A144", message, help);
    }
}
