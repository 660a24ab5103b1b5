//! Tags of other programs that affect the motion: PyBullet's `<contact>`, Gazebo's `<gazebo>`,
//! ROS's `<transmission>` and `<ros2_control>`, Drake's `<drake:…>`, MuJoCo's `<mujoco>`.
//!
//! Loops and springs are read in `closures`.
//!
//! Read: friction (sliding, at rest, rolling, about the normal), restitution, rotor inertia with
//! its gear ratio, and which quantity a joint's hardware takes. A tag that would change the motion
//! in its own program and is not used here causes a warning (U022). Tags that are read (U023) or
//! ignored (U020) are counted.

use super::checked::{CheckedRobot, Surface};
use super::closures;
use super::habits;
use super::scope::Scope;
use super::xml::Node;
use crate::diagnostic::words::did_you_mean;
use crate::model::ActuatorMode;
use crate::range::Range;
use std::collections::HashMap;

/// Top-level tags that are read here, or warned about.
pub(super) const TOP_LEVEL: [&str; 11] = [
    "drake:ball_constraint",
    "drake:joint",
    "drake:linear_bushing_rpy",
    "drake:linear_spring_damper",
    "drake:tendon_constraint",
    "gazebo",
    "loop",
    "loop_joint",
    "mujoco",
    "ros2_control",
    "transmission",
];

/// What PyBullet and others write into `<contact>`.
const CONTACT: [&str; 12] = [
    "collision",
    "contact_cfm",
    "contact_erp",
    "damping",
    "friction_anchor",
    "inertia_scaling",
    "lateral_friction",
    "ode",
    "restitution",
    "rolling_friction",
    "spinning_friction",
    "stiffness",
];

/// PyBullet's `<contact>`.
pub(super) fn contact(scope: &mut Scope, link: Node) -> Surface {
    let mut surface = Surface::default();
    let Some(contact) = scope.single(link, "contact") else {
        return surface;
    };
    scope.known_children(contact, &CONTACT, &[]);
    let known = |child: &Node| CONTACT.contains(&child.name());
    for child in contact.children().filter(known) {
        let (slot, range) = match child.name() {
            "lateral_friction" => (&mut surface.friction, Range::Friction),
            "rolling_friction" => (&mut surface.rolling_friction, Range::Friction),
            "spinning_friction" => (&mut surface.torsional_friction, Range::Friction),
            "restitution" => (&mut surface.restitution, Range::Restitution),
            "inertia_scaling" if scope.pybullet => (&mut surface.inertia_scaling, Range::Friction),
            "stiffness" if scope.pybullet => (&mut surface.stiffness, Range::Coefficient),
            "damping" if scope.pybullet => (&mut surface.damping, Range::Coefficient),
            _ => {
                scope.ignore(child);
                continue;
            }
        };
        scope.leaf(child, &["value"]);
        let Some(value) = scope.required_number(child, "value") else {
            continue;
        };
        if range.contains(value) {
            *slot = Some(value);
            scope.used(child);
        } else {
            let message = format!("<{}> {value} is out of range", child.name());
            let help = format!("it must be {}", range.expected());
            scope.problem("U071", child.tag_at(), &message, help);
        }
    }
    surface
}

/// Drake's `<drake:proximity_properties>` of a collision shape; the link's other shapes share them.
pub(super) fn proximity(scope: &mut Scope, collision: Node, surface: &mut Surface) {
    let Some(properties) = collision.child("drake:proximity_properties") else {
        return;
    };
    for child in properties.children() {
        let slot = match child.name() {
            "drake:mu_dynamic" => &mut surface.friction,
            "drake:mu_static" => &mut surface.static_friction,
            _ => {
                scope.ignore(child);
                continue;
            }
        };
        if let Some(value) = coefficient(scope, child) {
            slot.get_or_insert(value);
        }
    }
    // One of them alone stands for both.
    surface.friction = surface.friction.or(surface.static_friction);
}

/// A number of 0 or more in the attribute `value` or between the tags; else a warning, and it is
/// left out.
fn coefficient(scope: &mut Scope, node: Node) -> Option<f64> {
    let (text, at) = match node.attribute("value") {
        Some(attribute) => (attribute.value.clone(), attribute.at.clone()),
        None => (node.content().trim().to_owned(), node.content_at()),
    };
    match text.trim().parse::<f64>() {
        Ok(value) if Range::Friction.contains(value) => {
            scope.used(node);
            Some(value)
        }
        _ => {
            let message = format!(
                "<{}> '{text}' is not a number of 0 or more, up to 1e6",
                node.name()
            );
            scope.warning("U071", at, &message, "it is ignored");
            None
        }
    }
}

/// Whether a tag that is a switch is on.
fn is_on(node: Node) -> bool {
    matches!(node.content().trim(), "1" | "true" | "True")
}

/// Whether a tag holds a number other than zero.
fn is_something(node: Node) -> bool {
    let content = node.content();
    let text = node.value("value").unwrap_or(content.trim());
    text.parse::<f64>().is_ok_and(|value| value != 0.0)
}

/// Everything at the top level.
pub(super) fn read(scope: &mut Scope, root: Node, robot: &mut CheckedRobot) {
    let links: HashMap<String, usize> = (0..)
        .zip(&robot.links)
        .map(|(i, link)| (link.name.to_owned(), i))
        .collect();
    let joints: HashMap<String, usize> = (0..)
        .zip(&robot.joints)
        .map(|(i, joint)| (joint.name.to_owned(), i))
        .collect();
    let names = closures::Names::new(robot);
    for node in root.children() {
        match node.name() {
            "gazebo" => {
                for joint in node.children_named("joint") {
                    closures::read(scope, &names, joint, robot);
                }
                gazebo(scope, node, robot, &links, &joints);
            }
            "transmission" => transmission(scope, node, robot, &joints),
            "ros2_control" => ros2_control(scope, node, robot, &joints),
            "mujoco" => {
                mujoco(scope, node);
                for equality in node.children_named("equality") {
                    closures::equality(scope, &names, equality, robot);
                }
            }
            "loop_joint" | "drake:ball_constraint" | "drake:linear_spring_damper" => {
                closures::read(scope, &names, node, robot);
            }
            "drake:joint" => {
                let name = node.value("name").unwrap_or_default();
                let kind = node.value("type").unwrap_or_default();
                scope.owner = format!("joint '{name}'");
                let message = format!("<drake:joint> of type '{kind}' is not read");
                let help = "write it as <joint> of a type of URDF, or of type \"spherical\"";
                scope.problem("U040", node.tag_at(), &message, help);
            }
            // The others tie links together or pull at them.
            name if TOP_LEVEL.contains(&name) => {
                let message = format!("<{name}> is not used: the robot moves without it");
                let help = "close the loop with [[loop]], or pull with [[spring]], in the settings";
                scope.report.warning("U022", node.tag_at(), message, help);
            }
            _ => {}
        }
    }
}

/// `<gazebo reference="link or joint">`.
fn gazebo(
    scope: &mut Scope,
    node: Node,
    robot: &mut CheckedRobot,
    links: &HashMap<String, usize>,
    joints: &HashMap<String, usize>,
) {
    let Some(attribute) = node.attribute("reference") else {
        let still = node.child("static");
        if let Some(still) = still {
            robot.stands_still = is_on(still);
            scope.used(still);
        }
        if node.child("joint").is_none() && still.is_none() {
            scope.ignore(node);
        }
        return;
    };
    let name = attribute.value.as_str();
    scope.owner = format!("<gazebo> of '{name}'");
    if !links.contains_key(name) && !joints.contains_key(name) {
        let message = format!("<gazebo> refers to '{name}', which does not exist");
        let help = habits::name(name).map_or_else(
            || did_you_mean(name, links.keys().map(String::as_str)),
            str::to_owned,
        );
        scope
            .report
            .warning("U021", attribute.at.clone(), message, help);
        // Nothing of it is read.
        return;
    }
    let (mut mu, mut mu2) = (None, None);
    for child in node.children() {
        match child.name() {
            "mu1" | "mu" => mu = coefficient(scope, child),
            "mu2" => mu2 = coefficient(scope, child),
            "collision" => {
                // As SDF has it: collision/surface/friction/ode/mu.
                for inner in child.descendants() {
                    match inner.name() {
                        "mu" => mu = coefficient(scope, inner),
                        "mu2" => mu2 = coefficient(scope, inner),
                        _ => {}
                    }
                }
            }
            "turnGravityOff" if is_on(child) => weightless(scope, child),
            // Closes a loop: read before.
            "joint" => {}
            "gravity" if matches!(child.content().trim(), "0" | "false") => {
                weightless(scope, child);
            }
            "springStiffness" | "spring_stiffness" if is_something(child) => {
                let message = format!("<{}> is not used: the joint has no spring", child.name());
                let help = "command the joint in pd mode with the spring's kp";
                scope.warning("U022", child.tag_at(), &message, help);
            }
            // Read by themselves.
            "sensor" if scope.sensors => {}
            _ => scope.ignore(child),
        }
    }
    #[expect(clippy::float_cmp, reason = "one is mostly a copy of the other")]
    if let (Some(first), Some(second)) = (mu, mu2)
        && first != second
    {
        let message = format!(
            "friction {first} in one direction and {second} in the other: {first} is used in both"
        );
        scope.warning("U022", node.tag_at(), &message, "");
    }
    if let (Some(&i), Some(friction)) = (links.get(name), mu.or(mu2)) {
        robot.links[i].surface.friction.get_or_insert(friction);
    }
}

fn weightless(scope: &mut Scope, node: Node) {
    let message = format!("<{}> is not used: the link has weight", node.name());
    scope.warning(
        "U022",
        node.tag_at(),
        &message,
        "gravity is the whole world's",
    );
}

/// The quantity that a hardware interface takes, from its name in ROS 1 or 2.
fn interface(name: &str) -> Option<ActuatorMode> {
    let name = name.trim().to_ascii_lowercase();
    let name = name.rsplit('/').next().unwrap_or_default();
    [
        ("effort", ActuatorMode::Effort),
        ("velocity", ActuatorMode::Velocity),
        ("position", ActuatorMode::Position),
    ]
    .into_iter()
    .find(|(word, _)| name.starts_with(word))
    .map(|(_, mode)| mode)
}

/// `<transmission>`: interfaces, and Drake's rotors.
fn transmission(
    scope: &mut Scope,
    node: Node,
    robot: &mut CheckedRobot,
    joints: &HashMap<String, usize>,
) {
    let (mut ratio, mut rotor) = (None, None);
    for actuator in node.children_named("actuator") {
        for child in actuator.children() {
            match child.name() {
                "drake:gear_ratio" => ratio = coefficient(scope, child),
                "drake:rotor_inertia" => rotor = coefficient(scope, child),
                // Efforts are the joint's.
                "hardwareInterface" | "mechanicalReduction" => {}
                _ => scope.ignore(child),
            }
        }
    }
    let mut named = 0;
    for joint in node.children_named("joint") {
        let Some(attribute) = joint.attribute("name") else {
            continue;
        };
        let Some(&j) = joints.get(&attribute.value) else {
            unknown_joint(scope, node, &attribute.value, attribute.at.clone(), joints);
            continue;
        };
        named += 1;
        let words = joint.children_named("hardwareInterface").chain(
            node.children_named("actuator")
                .flat_map(|a| a.children_named("hardwareInterface")),
        );
        for word in words {
            if let Some(mode) = interface(&word.content()) {
                scope.used(word);
                robot.joints[j].interfaces.push(mode);
            }
        }
        if let Some(rotor) = rotor {
            let ratio = ratio.unwrap_or(1.0);
            robot.joints[j].armature += rotor * ratio * ratio;
        }
    }
    if named == 0 {
        scope.ignore(node);
    }
}

/// `<ros2_control>`: command interfaces of its joints.
fn ros2_control(
    scope: &mut Scope,
    node: Node,
    robot: &mut CheckedRobot,
    joints: &HashMap<String, usize>,
) {
    for joint in node.children_named("joint") {
        let Some(attribute) = joint.attribute("name") else {
            continue;
        };
        let Some(&j) = joints.get(&attribute.value) else {
            unknown_joint(scope, node, &attribute.value, attribute.at.clone(), joints);
            continue;
        };
        for command in joint.children_named("command_interface") {
            match command.value("name").and_then(interface) {
                Some(mode) => {
                    scope.used(command);
                    robot.joints[j].interfaces.push(mode);
                }
                None => scope.ignore(command),
            }
        }
    }
    for child in node.children().filter(|child| child.name() != "joint") {
        scope.ignore(child);
    }
}

fn unknown_joint(
    scope: &mut Scope,
    node: Node,
    name: &str,
    at: std::ops::Range<usize>,
    joints: &HashMap<String, usize>,
) {
    let message = format!(
        "<{}> names joint '{name}', which does not exist",
        node.name()
    );
    let mut names: Vec<&str> = joints.keys().map(String::as_str).collect();
    names.sort_unstable();
    let help = habits::name(name).map_or_else(|| did_you_mean(name, names), str::to_owned);
    scope.report.warning("U021", at, message, help);
}

/// `<mujoco>`: the mesh folder is the resolver's business; some switches would change masses.
fn mujoco(scope: &mut Scope, node: Node) {
    for child in node.children() {
        if child.name() != "compiler" {
            if child.name() != "equality" {
                scope.ignore(child);
            }
            continue;
        }
        scope.used(child);
        for (name, at) in child.attribute_names() {
            let value = child.value(name).unwrap_or_default().trim();
            let acts = match name {
                "balanceinertia" | "inertiafromgeom" => value == "true",
                "boundmass" | "boundinertia" => value.parse::<f64>().is_ok_and(|v| v > 0.0),
                "settotalmass" => value.parse::<f64>().is_ok_and(|v| v > 0.0),
                _ => false,
            };
            if acts {
                let message = format!(
                    "<compiler> {name}=\"{value}\" is not used: masses and inertias are those of the links"
                );
                let help = match name {
                    "inertiafromgeom" => {
                        "--inertia collision does the same with the collision shapes"
                    }
                    _ => "",
                };
                scope.report.warning("U022", at, message, help);
            }
        }
    }
}
