//! Sensors in a URDF, read on request: SDF's `<sensor>` in `<gazebo reference>`, and URDF's own at
//! the top level.
//!
//! Read: inertial units, rays (`ray`, `gpu_ray`, `lidar`, `gpu_lidar`), `force_torque`, `contact`,
//! with rate, pose, angles, ranges and Gaussian noise; a number may be an attribute or an element.
//! What a sensor has besides, and sensors of other types, are named in a warning (U022).
//!
//! Sources: SDF 1.11, `sensor.sdf` and the files that it includes; the URDF proposal
//! `<sensor>` of ROS.

use super::checked::CheckedRobot;
use super::scope::Scope;
use super::sensed::{SensedKind, SensorDescription};
use super::xml::Node;
use crate::pattern::Pattern;
use crate::range::Range;
use crate::spatial::Vec3;

/// Tags that change nothing in what a sensor measures.
const QUIET: [&str; 6] = [
    "always_on",
    "enable_metrics",
    "plugin",
    "ros",
    "topic",
    "visualize",
];
/// Most rays of one sensor.
const MOST_RAYS: f64 = 10_000.0;
/// Largest distance where none is given, m.
const REACH: f64 = 10.0;

/// All sensors of a file, in its order.
pub(super) fn read(
    scope: &mut Scope,
    root: Node,
    robot: &CheckedRobot,
    scale: f64,
) -> Vec<SensorDescription> {
    let mut sensors = Vec::new();
    for node in root.children() {
        if node.name() == "sensor" {
            sensors.extend(sensor(scope, node, None, robot, scale));
        } else if node.name() == "gazebo" {
            let reference = node.attribute("reference");
            for child in node.children() {
                if child.name().starts_with("sensor:") {
                    "<gazebo>".clone_into(&mut scope.owner);
                    let message = format!("<{}> of early versions is not read", child.name());
                    let help = "write it as <sensor> of SDF";
                    scope.warning("U022", child.tag_at(), &message, help);
                }
            }
            for child in node.children_named("sensor") {
                let on = reference.map(|a| (a.value.as_str(), a.at.clone()));
                sensors.extend(sensor(scope, child, on, robot, scale));
            }
        }
    }
    sensors
}

/// A sensor; None after a finding. `on` is what it is fixed to, unless it says so itself.
fn sensor(
    scope: &mut Scope,
    node: Node,
    on: Option<(&str, std::ops::Range<usize>)>,
    robot: &CheckedRobot,
    scale: f64,
) -> Option<SensorDescription> {
    let name = node.value("name").unwrap_or_default();
    scope.owner = format!("sensor '{name}'");
    if name.is_empty() {
        let message = "<sensor> has no name";
        scope.problem("U016", node.tag_at(), message, "write name=\"…\"");
        return None;
    }
    let mut used = vec!["update_rate", "pose", "origin", "parent"];
    let kind = kind(scope, node, &mut used)?;
    let in_joint = matches!(kind, SensedKind::ForceTorque { .. });
    let (on, at) = match (on, node.child("parent")) {
        (Some(on), _) => on,
        (None, Some(parent)) => {
            let attribute = parent.attribute(if in_joint { "joint" } else { "link" })?;
            (attribute.value.as_str(), attribute.at.clone())
        }
        (None, None) => {
            let message = "<sensor> says nowhere what it is fixed to";
            let help =
                "write <parent link=\"…\"/>, or put it into <gazebo reference=\"a link or joint\">";
            scope.warning("U022", node.tag_at(), message, help);
            return None;
        }
    };
    let exists = if in_joint {
        robot.joints.iter().any(|joint| joint.name == on)
    } else {
        robot.links.iter().any(|link| link.name == on)
    };
    if !exists {
        let what = if in_joint { "joint" } else { "link" };
        let message = format!("it is on the {what} '{on}', which does not exist");
        scope.warning("U021", at, &message, "the sensor is left out");
        return None;
    }
    let rate = number(scope, node, "update_rate", Range::Rate, Some(0.0));
    let (mut xyz, mut rpy) = pose(scope, node);
    if in_joint {
        // It measures at its joint, in the axes of a link or in its own.
        let in_own = of_force(node, "frame").as_deref() == Some("sensor");
        let turned = if in_own { rpy } else { Vec3::zeros() };
        if (xyz, rpy) != (Vec3::zeros(), turned) {
            let part = if in_own { "position" } else { "pose" };
            let message = format!("its {part} is not used: it has the frame of its joint");
            scope.warning("U022", node.tag_at(), &message, "");
        }
        (xyz, rpy) = (Vec3::zeros(), turned);
    }
    let errors = errors(scope, node, &kind, rate.is_some(), &mut used);
    report_unused(scope, node, &used);
    scope.used(node);
    let pattern = |scope: &Scope, text: &str, at| Pattern {
        text: text.to_owned(),
        place: Some(scope.report.place(at)),
    };
    Some(SensorDescription {
        name: pattern(scope, name, node.tag_at()),
        on: pattern(scope, on, at),
        xyz: xyz * scale,
        rpy,
        kind: match kind {
            SensedKind::Ray {
                columns,
                rows,
                range,
            } => SensedKind::Ray {
                columns,
                rows,
                range: range.map(|x| x * scale),
            },
            kind => kind,
        },
        rate,
        errors,
    })
}

/// What a `<force_torque>` of a sensor says.
fn of_force(node: Node, name: &'static str) -> Option<String> {
    let own = node.child("force_torque").and_then(|own| own.child(name));
    own.map(|child| child.content().trim().to_owned())
}

/// What a sensor measures; None after a finding.
fn kind<'d>(scope: &mut Scope, node: Node<'d>, used: &mut Vec<&'d str>) -> Option<SensedKind> {
    // URDF's own have no type: what they hold says it.
    let held = ["ray", "lidar", "imu", "force_torque", "contact"]
        .into_iter()
        .find(|name| node.child(name).is_some());
    match node.value("type").or(held) {
        Some("imu" | "imu_sensor") => Some(SensedKind::Imu),
        Some("ray" | "gpu_ray" | "lidar" | "gpu_lidar") => rays(scope, node, used),
        Some("force_torque") => {
            used.push("force_torque");
            let text = |name| of_force(node, name);
            Some(SensedKind::ForceTorque {
                in_parent: text("frame").as_deref() == Some("parent"),
                // SDF's default.
                reversed: text("measure_direction").as_deref() != Some("parent_to_child"),
            })
        }
        Some("contact") => {
            used.push("contact");
            Some(SensedKind::Contact)
        }
        other => {
            let what = other.map_or_else(|| "no type".to_owned(), |word| format!("type '{word}'"));
            let message = format!("a sensor of {what} is not read");
            let help = "imu, ray, lidar, force_torque and contact are";
            scope.warning("U022", node.tag_at(), &message, help);
            None
        }
    }
}

fn rays<'d>(scope: &mut Scope, node: Node<'d>, used: &mut Vec<&'d str>) -> Option<SensedKind> {
    let own = node.child("ray").or_else(|| node.child("lidar"));
    let Some(own) = own else {
        let message = "a sensor with rays needs <ray> or <lidar>";
        scope.warning("U022", node.tag_at(), message, "it is left out");
        return None;
    };
    used.push(own.name());
    let scan = own.child("scan").unwrap_or(own);
    let mut fan = |name| -> Option<(u32, [f64; 2])> {
        let Some(fan) = scan.child(name) else {
            return Some((1, [0.0, 0.0]));
        };
        let samples = number(scope, fan, "samples", Range::Count, None);
        let factor = number(scope, fan, "resolution", Range::Near, None);
        let count = (samples.unwrap_or(1.0) * factor.unwrap_or(1.0)).round();
        if !(1.0..=MOST_RAYS).contains(&count) {
            let message = format!("<{name}> has {count} rays, not 1 to {MOST_RAYS}");
            scope.problem("U032", fan.tag_at(), &message, "correct its samples");
            return None;
        }
        let mut angle = |name| number(scope, fan, name, Range::Position, None).unwrap_or(0.0);
        let angles = [angle("min_angle"), angle("max_angle")];
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number up to ten thousand"
        )]
        let count = count as u32;
        Some((count, angles))
    };
    let (columns, rows) = (fan("horizontal")?, fan("vertical")?);
    if f64::from(columns.0) * f64::from(rows.0) > MOST_RAYS {
        let message = format!("it has more than {MOST_RAYS} rays");
        scope.problem("U032", own.tag_at(), &message, "correct its samples");
        return None;
    }
    let reach = own.child("range");
    let mut distance = |name, range| reach.and_then(|node| number(scope, node, name, range, None));
    let near = distance("min", Range::Near).unwrap_or(0.0);
    let far = distance("max", Range::Length).unwrap_or(REACH);
    if near >= far {
        let message = format!("its least distance {near} m is not below its largest, {far} m");
        scope.problem("U032", own.tag_at(), &message, "correct its range");
        return None;
    }
    Some(SensedKind::Ray {
        columns,
        rows,
        range: [near, far],
    })
}

/// A number in an attribute or between the tags of an element of this name; None where there is
/// none, after a finding, and for `unset`.
fn number(
    scope: &mut Scope,
    node: Node,
    name: &'static str,
    range: Range,
    unset: Option<f64>,
) -> Option<f64> {
    let (text, at) = match (node.attribute(name), node.child(name)) {
        (Some(attribute), _) => (attribute.value.clone(), attribute.at.clone()),
        (None, Some(child)) => (child.content().into_owned(), child.content_at()),
        (None, None) => return None,
    };
    let value = text.trim().parse::<f64>().ok();
    match value {
        Some(value) if Some(value) == unset => None,
        Some(value) if range.contains(value) => Some(value),
        _ => {
            let message = format!("{name} '{}' is not {}", text.trim(), range.expected());
            scope.problem("U032", at, &message, "correct it");
            None
        }
    }
}

/// `<pose>` of SDF or `<origin>` of URDF.
fn pose(scope: &mut Scope, node: Node) -> (Vec3, Vec3) {
    let Some(pose) = node.child("pose") else {
        return scope.origin(node);
    };
    if pose.attribute_names().next().is_some() {
        let message = "attributes of <pose> are not used: it is in the link's frame, in m and rad";
        scope.warning("U022", pose.tag_at(), message, "");
    }
    let content = pose.content();
    let numbers = content.split_whitespace().map(str::parse::<f64>);
    let numbers = numbers.collect::<Result<Vec<_>, _>>().unwrap_or_default();
    if let Ok([x, y, z, roll, pitch, yaw]) = <[f64; 6]>::try_from(numbers)
        && [x, y, z, roll, pitch, yaw]
            .iter()
            .all(|&value| Range::Position.contains(value))
    {
        return (Vec3::new(x, y, z), Vec3::new(roll, pitch, yaw));
    }
    let message = format!("<pose> '{}' is not six numbers", content.trim());
    let help = "x y z in m, roll pitch yaw in rad";
    scope.problem("U030", pose.content_at(), &message, help);
    (Vec3::zeros(), Vec3::zeros())
}

/// Bias and noise of a sensor's quantities.
fn errors<'d>(
    scope: &mut Scope,
    node: Node<'d>,
    kind: &SensedKind,
    has_rate: bool,
    used: &mut Vec<&'d str>,
) -> Vec<[[f64; 3]; 2]> {
    let errors = match kind {
        SensedKind::Imu => {
            used.push("imu");
            let own = node.child("imu");
            let old = own.and_then(|own| own.child("noise"));
            [
                ("angular_velocity", "rate"),
                ("linear_acceleration", "accel"),
            ]
            .map(|(name, before)| {
                let axes = own.and_then(|own| own.child(name));
                let before = old.and_then(|noise| noise.child(before));
                of_axes(scope, axes, before)
            })
            .to_vec()
        }
        SensedKind::ForceTorque { .. } => {
            let own = node.child("force_torque");
            ["force", "torque"]
                .map(|name| of_axes(scope, own.and_then(|own| own.child(name)), None))
                .to_vec()
        }
        SensedKind::Ray { .. } => {
            let own = node.child("ray").or_else(|| node.child("lidar"));
            let noise = own.and_then(|own| own.child("noise"));
            vec![of_axes(scope, None, noise)]
        }
        SensedKind::Contact => Vec::new(),
    };
    let noisy = errors
        .iter()
        .any(|[_, noise]| noise.iter().any(|x| *x > 0.0));
    if noisy && !has_rate {
        let message = "its noise is not used, because it has no update_rate";
        let help = "each sample has its own noise: give it an <update_rate>";
        scope.warning("U022", node.tag_at(), message, help);
        return errors.iter().map(|[bias, _]| [*bias, [0.0; 3]]).collect();
    }
    errors
}

/// Bias and noise of three axes, each with a `<noise>` of its own, or of all of them together.
fn of_axes(scope: &mut Scope, axes: Option<Node>, all: Option<Node>) -> [[f64; 3]; 2] {
    let common = all.map_or([0.0; 2], |noise| gaussian(scope, noise));
    let each = ["x", "y", "z"].map(|name| {
        let own = axes.and_then(|axes| axes.child(name)?.child("noise"));
        own.map_or(common, |noise| gaussian(scope, noise))
    });
    [each.map(|[bias, _]| bias), each.map(|[_, noise]| noise)]
}

/// Mean and standard deviation of a `<noise>`.
fn gaussian(scope: &mut Scope, noise: Node) -> [f64; 2] {
    let mut of = |name, range| number(scope, noise, name, range, None).unwrap_or(0.0);
    let mean = of("mean", Range::Bias) + of("bias_mean", Range::Bias);
    let deviation = of("stddev", Range::Noise);
    if of("bias_stddev", Range::Noise) > 0.0 {
        let message = "<bias_stddev> is not used: a bias is the same in every run";
        let help = "bias_mean is used";
        scope.warning("U022", noise.tag_at(), message, help);
    }
    [mean, deviation]
}

/// Names what a sensor has and nothing is made of.
fn report_unused(scope: &mut Scope, node: Node, used: &[&str]) {
    let mut unused: Vec<&str> = Vec::new();
    for child in node.children() {
        let name = child.name();
        if QUIET.contains(&name) {
            scope.ignore(child);
        } else if !used.contains(&name) && !unused.contains(&name) {
            unused.push(name);
        }
    }
    if !unused.is_empty() {
        let message = format!("<{}> of it is not used", unused.join(">, <"));
        scope.warning("U022", node.tag_at(), &message, "");
    }
}

#[cfg(test)]
mod tests;
