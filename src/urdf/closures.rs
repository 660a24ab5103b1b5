//! Loops and springs in notes for other programs: `<loop_joint>` of Isaac Sim and older Drake,
//! `<joint>` of SDF in `<gazebo>`, Drake's `<drake:ball_constraint>` and
//! `<drake:linear_spring_damper>`, and MuJoCo's `<equality>`.
//!
//! What is soft there (MuJoCo's constraints, Gazebo's joints) is exact here. A note that cannot be
//! used is warned of by its name (U022) and left out.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::CheckedRobot;
use super::description::{ClosureDescription, ClosureDescriptionKind as Kind};
use super::scope::Scope;
use super::xml::Node;
use crate::spatial::{Pose, Vec3, rotation_from_quaternion, rotation_to_axis};
use std::collections::BTreeMap;

/// What a robot has that a note may name.
pub(super) struct Names {
    /// Pose of each link at joint zero.
    links: BTreeMap<String, Pose>,
    joints: Vec<String>,
}

impl Names {
    /// Those of a robot.
    pub(super) fn new(robot: &CheckedRobot) -> Self {
        let mut links = BTreeMap::new();
        let is_child = |name: &str| {
            let mut children = robot.joints.iter().filter_map(|j| j.child.as_ref());
            children.any(|child| child.name == name)
        };
        for link in robot.links.iter().filter(|link| !is_child(link.name)) {
            links.insert(link.name.to_owned(), Pose::IDENTITY);
        }
        // Joints may stand in any order.
        for _ in &robot.joints {
            let before = links.len();
            for joint in &robot.joints {
                let (Some(parent), Some(child)) = (&joint.parent, &joint.child) else {
                    continue;
                };
                if let (Some(X), false) = (links.get(parent.name), links.contains_key(child.name)) {
                    let X = X.compose(&Pose::from_xyz_rpy(joint.xyz, joint.rpy));
                    links.insert(child.name.to_owned(), X);
                }
            }
            if links.len() == before {
                break;
            }
        }
        Self {
            links,
            joints: robot.joints.iter().map(|j| j.name.to_owned()).collect(),
        }
    }

    /// Pose of a link at joint zero, or of the world.
    fn pose(&self, name: &str) -> Option<Pose> {
        let own = self.links.get(name).copied();
        own.or_else(|| (name == "world").then_some(Pose::IDENTITY))
    }

    /// A frame of SDF in the axes of a link, at joint zero.
    fn frame(&self, name: &str, link: &str) -> Result<Pose, Refused> {
        let found = match name {
            "__model__" => Some(Pose::IDENTITY),
            _ => self.pose(name),
        };
        let found = found.ok_or(format!(
            "there is no link '{name}' that it could be seen from"
        ))?;
        let link = self.pose(link).ok_or("its links hang nowhere")?;
        Ok(link.inverse().compose(&found))
    }

    /// A frame on the first of two links as one on the second, at joint zero.
    fn across(&self, [from, to]: [&str; 2], X: &Pose) -> Option<Pose> {
        let (from, to) = (self.pose(from)?, self.pose(to)?);
        Some(to.inverse().compose(&from).compose(X))
    }
}

/// Why a note is not used.
type Refused = String;

/// Reads a note that may close a loop.
pub(super) fn read(scope: &mut Scope, names: &Names, node: Node, robot: &mut CheckedRobot) {
    let found = match node.name() {
        "loop_joint" => loop_joint(scope, names, node),
        "joint" if node.attribute("joint1").is_none() => sdf_joint(names, node),
        "drake:ball_constraint" => ball_constraint(names, node),
        "drake:linear_spring_damper" => spring(names, node),
        "connect" => connect(names, node),
        "weld" => weld(names, node),
        _ => joint_equality(names, node),
    };
    match found {
        Ok(kind) => {
            scope.used(node);
            let name = node.value("name").unwrap_or(node.local_name());
            robot.closures.push(ClosureDescription {
                name: name.to_owned(),
                kind,
                tag: scope.tag(node),
            });
        }
        Err(why) => {
            let message = format!("<{}> is not used: {why}", node.name());
            let help = "the robot moves without it; close the loop with [[loop]] in the settings";
            scope.report.warning("U022", node.tag_at(), message, help);
        }
    }
}

/// Reads `<equality>` of MuJoCo.
pub(super) fn equality(scope: &mut Scope, names: &Names, node: Node, robot: &mut CheckedRobot) {
    for child in node.children() {
        let off = child
            .value("active")
            .is_some_and(|value| value.trim() == "false");
        if off {
            scope.ignore(child);
        } else {
            read(scope, names, child, robot);
        }
    }
}

/// So many finite numbers.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], Refused> {
    let numbers: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|x: &f64| x.abs() <= 1e6))
        .collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("'{text}' must be {N} numbers up to 1e6"))
}

/// Numbers of an attribute, or those that hold without it.
fn attribute<const N: usize>(
    node: Node,
    name: &str,
    default: [f64; N],
) -> Result<[f64; N], Refused> {
    node.value(name).map_or(Ok(default), numbers)
}

fn known(names: &Names, name: &str) -> Result<String, Refused> {
    match names.pose(name) {
        Some(_) => Ok(name.to_owned()),
        None => Err(format!("there is no link '{name}'")),
    }
}

/// A frame at a point.
fn at(p: [f64; 3]) -> Pose {
    Pose {
        p: p.into(),
        ..Pose::IDENTITY
    }
}

/// What joins two frames as a joint of a type does; the axis of one that turns is in these.
fn joined(kind: &str, links: [String; 2], X: [Pose; 2], axis: [f64; 3]) -> Result<Kind, Refused> {
    Ok(match kind {
        "spherical" | "ball" => Kind::Ball { links, X },
        "fixed" => Kind::Weld { links, X },
        "revolute" | "continuous" => {
            let axis = Vec3::from(axis).try_normalize(1e-12);
            let turn = rotation_to_axis(&axis.ok_or("its axis is 0")?);
            let X = X.map(|X| Pose { R: X.R * turn, ..X });
            Kind::Hinge { links, X }
        }
        _ => return Err(format!("a joint of type '{kind}' closes no loop here")),
    })
}

fn loop_joint(scope: &mut Scope, names: &Names, node: Node) -> Result<Kind, Refused> {
    let end = |name: &'static str| -> Result<(String, Pose), Refused> {
        let end = node.child(name).ok_or(format!("it has no <{name}>"))?;
        let link = known(names, end.value("link").unwrap_or_default())?;
        let xyz = attribute(end, "xyz", [0.0; 3])?;
        let rpy = attribute(end, "rpy", [0.0; 3])?;
        Ok((link, Pose::from_xyz_rpy(xyz.into(), rpy.into())))
    };
    let ((a, X_a), (b, X_b)) = (end("link1")?, end("link2")?);
    let axis = node.child("axis");
    let axis = axis.map_or(Ok([1.0, 0.0, 0.0]), |axis| {
        attribute(axis, "xyz", [1.0, 0.0, 0.0])
    })?;
    for child in node.children() {
        if !["link1", "link2", "axis"].contains(&child.name()) {
            scope.ignore(child);
        }
    }
    let kind = node.value("type").unwrap_or_default();
    joined(kind, [a, b], [X_a, X_b], axis)
}

/// The pose of a joint is that in its child, and its axis is in its own axes, where no frames are
/// named.
fn sdf_joint(names: &Names, node: Node) -> Result<Kind, Refused> {
    let text = |name: &'static str| {
        let child = node.child(name).ok_or(format!("it has no <{name}>"))?;
        let link = child
            .value("link")
            .map_or_else(|| child.content(), Into::into);
        known(names, link.trim())
    };
    let (parent, child) = (text("parent")?, text("child")?);
    let within = |frame: Option<&str>, default: Pose| match frame {
        None | Some("") => Ok(default),
        Some(frame) => names.frame(frame, &child),
    };
    let pose = node.child("pose").or_else(|| node.child("origin"));
    let given = pose.map_or(Ok([0.0; 6]), |pose| numbers(&pose.content()))?;
    let [x, y, z, roll, pitch, yaw] = given;
    let frame = pose.and_then(|pose| pose.value("relative_to"));
    let X = within(frame, Pose::IDENTITY)?.compose(&Pose::from_xyz_rpy(
        Vec3::new(x, y, z),
        Vec3::new(roll, pitch, yaw),
    ));
    let axis = node.child("axis");
    let xyz = axis.and_then(|axis| axis.child("xyz"));
    let given = xyz.map_or(Ok([0.0, 0.0, 1.0]), |xyz| numbers(&xyz.content()))?;
    // Of SDF before 1.7.
    let old = axis.and_then(|axis| axis.child("use_parent_model_frame"));
    let old = old.is_some_and(|old| ["true", "1"].contains(&old.content().trim()));
    let frame = xyz.and_then(|xyz| xyz.value("expressed_in"));
    let frame = within(frame.or(old.then_some("__model__")), X)?;
    let axis = X.R.tr_mul(&(frame.R * Vec3::from(given))).into();
    let across = names.across([&child, &parent], &X);
    let other = across.ok_or("its links hang nowhere")?;
    let kind = node.value("type").unwrap_or_default();
    joined(kind, [parent, child], [other, X], axis)
}

/// The child of a name, with its attribute.
fn part<'d>(node: Node<'d>, name: &'static str, key: &str) -> Result<&'d str, Refused> {
    let child = node.child(name).ok_or(format!("it has no <{name}>"))?;
    child.value(key).ok_or(format!("<{name}> has no '{key}'"))
}

fn ball_constraint(names: &Names, node: Node) -> Result<Kind, Refused> {
    let a = known(names, part(node, "drake:ball_constraint_body_A", "name")?)?;
    let b = known(names, part(node, "drake:ball_constraint_body_B", "name")?)?;
    let p = numbers(part(node, "drake:ball_constraint_p_AP", "value")?)?;
    let q = numbers(part(node, "drake:ball_constraint_p_BQ", "value")?)?;
    Ok(Kind::Ball {
        links: [a, b],
        X: [at(p), at(q)],
    })
}

fn spring(names: &Names, node: Node) -> Result<Kind, Refused> {
    let a = known(
        names,
        part(node, "drake:linear_spring_damper_body_A", "name")?,
    )?;
    let b = known(
        names,
        part(node, "drake:linear_spring_damper_body_B", "name")?,
    )?;
    let p = numbers(part(node, "drake:linear_spring_damper_p_AP", "value")?)?;
    let q = numbers(part(node, "drake:linear_spring_damper_p_BQ", "value")?)?;
    let number = |name: &'static str| -> Result<f64, Refused> {
        let text = part(node, name, "value")?;
        let number = text.trim().parse().ok();
        let number = number.filter(|x: &f64| (0.0..=1e12).contains(x));
        number.ok_or(format!(
            "<{name}> must be a number of 0 or more, up to 1e12"
        ))
    };
    Ok(Kind::Spring {
        links: [a, b],
        X: [at(p), at(q)],
        length: number("drake:linear_spring_damper_free_length")?,
        stiffness: number("drake:linear_spring_damper_stiffness")?,
        damping: number("drake:linear_spring_damper_damping")?,
    })
}

/// The two bodies of an equality of MuJoCo; the second may be the world.
fn bodies(names: &Names, node: Node) -> Result<[String; 2], Refused> {
    let Some(first) = node.value("body1") else {
        return Err("it names no bodies".to_owned());
    };
    let second = node.value("body2").unwrap_or("world");
    Ok([known(names, first)?, known(names, second)?])
}

fn connect(names: &Names, node: Node) -> Result<Kind, Refused> {
    let links = bodies(names, node)?;
    let Some(anchor) = node.value("anchor") else {
        return Err("it has no anchor".to_owned());
    };
    let X = at(numbers(anchor)?);
    let across = names.across([&links[0], &links[1]], &X);
    let X = [X, across.ok_or("its bodies hang nowhere")?];
    Ok(Kind::Ball { links, X })
}

fn weld(names: &Names, node: Node) -> Result<Kind, Refused> {
    let links = bodies(names, node)?;
    let [x, y, z, turn @ ..] = attribute::<7>(node, "relpose", [0.0; 7])?;
    let given = turn.iter().any(|x| *x != 0.0);
    let first = if given {
        let norm = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        Pose {
            R: rotation_from_quaternion(&turn.map(|x| x / norm)),
            p: Vec3::new(x, y, z),
        }
    } else {
        // As they are at joint zero.
        let across = names.across([&links[1], &links[0]], &Pose::IDENTITY);
        across.ok_or("its bodies hang nowhere")?
    };
    Ok(Kind::Weld {
        links,
        X: [first, Pose::IDENTITY],
    })
}

fn joint_equality(names: &Names, node: Node) -> Result<Kind, Refused> {
    if node.name() != "joint" {
        return Err("equalities of this kind are not read".to_owned());
    }
    let known = |key: &str| -> Result<Option<String>, Refused> {
        let Some(name) = node.value(key) else {
            return Ok(None);
        };
        let found = names.joints.iter().find(|joint| *joint == name);
        let found = found.ok_or(format!("there is no joint '{name}'"))?;
        Ok(Some(found.clone()))
    };
    let first = known("joint1")?.ok_or("it names no joint")?;
    let [constant, linear, higher @ ..] =
        attribute::<5>(node, "polycoef", [0.0, 1.0, 0.0, 0.0, 0.0])?;
    if higher.iter().any(|x| *x != 0.0) {
        return Err("its polynomial is not linear".to_owned());
    }
    let mut joints = vec![(first, 1.0)];
    if let (Some(second), true) = (known("joint2")?, linear != 0.0) {
        joints.push((second, -linear));
    }
    Ok(Kind::Coupler {
        joints,
        sum: Some(constant),
    })
}
