//! Checks of `<joint>`: type, axis, dynamics, mimic.

use super::checked::{CheckedJoint, CheckedMimic, LinkReference, called};
use super::limit::{self, turns_or_slides};
use super::scope::Scope;
use super::xml::Node;
use crate::diagnostic::words::did_you_mean;
use crate::digits::Digits;
use crate::model::JointKind;
use crate::range::Range as Physical;
use crate::spatial::Vec3;
use std::collections::HashMap;

const CHILDREN: [&str; 10] = [
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "dynamics",
    "mimic",
    "safety_controller",
    "calibration",
    "drake:mimic",
];

/// Written by others, read by others.
const FOREIGN: [&str; 3] = ["joint_properties", "hardwareInterface", "physics"];

/// Squared length of an axis below which it has no direction.
const NO_DIRECTION: f64 = 1e-12;

/// Checks a `<joint>` that has a name.
pub(super) fn check<'d>(scope: &mut Scope, node: Node<'d>, name: &'d str) -> CheckedJoint<'d> {
    scope.owner = called("joint", name);
    scope.known_attributes(node, &["name", "type", "dont_collapse"]);
    scope.known_children(node, &CHILDREN, &FOREIGN);
    let kind = kind(scope, node);
    let (xyz, rpy) = scope.origin(node);
    let parent = link(scope, node, "parent");
    let child = link(scope, node, "child");
    let axis = axis(scope, node, kind);
    let (limits, effort, velocity) = limit::read(scope, node, kind);
    let [damping, friction, armature] = dynamics(scope, node);
    let mimic = mimic(scope, node, kind);
    for unused in ["safety_controller", "calibration"] {
        if let Some(child) = scope.single(node, unused) {
            scope.known_children(child, &[], &[]);
            scope.ignore(child);
        }
    }
    CheckedJoint {
        node,
        tag: scope.tag(node),
        name,
        own_name: true,
        kind,
        parent,
        child,
        xyz,
        rpy,
        axis,
        limits,
        effort,
        velocity,
        damping,
        friction,
        armature,
        interfaces: Vec::new(),
        mimic,
    }
}

/// The type; fixed after a problem was reported, so that the other checks can go on.
fn kind(scope: &mut Scope, node: Node) -> JointKind {
    let types = JointKind::ALL.map(JointKind::name);
    let Some(attribute) = node.attribute("type") else {
        scope.missing_attribute(node, "type", &format!("write one of {}", types.join(", ")));
        return JointKind::Fixed;
    };
    let mut kinds = JointKind::ALL.into_iter();
    if let Some(kind) = kinds.find(|kind| kind.name() == attribute.value) {
        return kind;
    }
    let message = format!("unknown joint type '{}'", attribute.value);
    let help = match did_you_mean(&attribute.value.to_lowercase(), types) {
        help if help.is_empty() => format!("known types are {}", types.join(", ")),
        help => help,
    };
    scope.problem("U040", attribute.at.clone(), &message, help);
    JointKind::Fixed
}

fn link<'d>(scope: &mut Scope, node: Node<'d>, tag: &'static str) -> Option<LinkReference<'d>> {
    let Some(child) = scope.single(node, tag) else {
        let message = format!("<joint> has no <{tag}>");
        let meant = node.value(tag).unwrap_or("…");
        let help = format!("add <{tag} link=\"{meant}\"/>");
        scope.problem("U017", node.tag_at(), &message, help);
        return None;
    };
    scope.leaf(child, &["link"]);
    let Some(attribute) = child.attribute("link") else {
        scope.missing_attribute(child, "link", "write link=\"name of a link\"");
        return None;
    };
    Some(LinkReference {
        name: &attribute.value,
        at: attribute.at.clone(),
    })
}

fn axis(scope: &mut Scope, node: Node, kind: JointKind) -> Vec3 {
    let Some(child) = scope.single(node, "axis") else {
        return Vec3::x();
    };
    scope.leaf(child, &["xyz", "rpy"]);
    let Some(attribute) = child.attribute("xyz") else {
        let message = "<axis> has no attribute 'xyz': \"1 0 0\" is used, as without <axis>";
        scope.warning("U015", child.tag_at(), message, "write xyz=\"0 0 1\"");
        return Vec3::x();
    };
    let Some(axis) = scope.vector::<3>(child, "xyz") else {
        return Vec3::x();
    };
    let axis = Vec3::from(axis);
    if axis.norm_squared() > NO_DIRECTION {
        if matches!(kind, JointKind::Floating | JointKind::Spherical) {
            let message = format!("<axis> is not used: a {} joint has none", kind.name());
            scope.note("U020", child.tag_at(), &message, "");
        }
        return axis;
    }
    // The axis of a fixed or floating joint means nothing; many files write zeros there.
    if !matches!(
        kind,
        JointKind::Fixed | JointKind::Floating | JointKind::Spherical
    ) {
        let help = "write the direction of the axis, such as \"0 0 1\"";
        scope.problem("U041", attribute.at.clone(), "the axis is zero", help);
    }
    Vec3::x()
}

fn not_negative(scope: &mut Scope, node: Node, name: &str) -> Option<f64> {
    let value = scope.number(node, name)?;
    if value >= 0.0 {
        return scope.within(node, name, value, Physical::Coefficient);
    }
    let at = node
        .attribute(name)
        .map_or_else(|| node.tag_at(), |a| a.at.clone());
    let message = format!("<{}> {name} {} is negative", node.name(), Digits(value));
    scope.problem("U033", at, &message, "write its size; 0 or above");
    None
}

/// Attributes of `<dynamics>`.
const DYNAMICS: [&str; 3] = ["damping", "friction", "armature"];

/// Damping, dry friction and rotor inertia; the last is no part of URDF, but written by many tools.
fn dynamics(scope: &mut Scope, node: Node) -> [f64; 3] {
    let Some(child) = scope.single(node, "dynamics") else {
        return [0.0; 3];
    };
    scope.leaf(child, &DYNAMICS);
    DYNAMICS.map(|name| not_negative(scope, child, name).unwrap_or(0.0))
}

fn mimic<'d>(scope: &mut Scope, node: Node<'d>, kind: JointKind) -> Option<CheckedMimic<'d>> {
    let child = if let Some(child) = scope.single(node, "mimic") {
        child
    } else {
        let child = scope.single(node, "drake:mimic")?;
        scope.used(child);
        child
    };
    scope.leaf(child, &["joint", "multiplier", "offset"]);
    let multiplier = scope.number(child, "multiplier");
    let multiplier = multiplier.and_then(|m| scope.within(child, "multiplier", m, Physical::Ratio));
    if let (Some(0.0), Some(attribute)) = (multiplier, child.attribute("multiplier")) {
        let message = "<mimic> multiplier is 0: the joint stays where its offset is";
        let help = "leave multiplier out for 1, or use type=\"fixed\"";
        scope.warning("U033", attribute.at.clone(), message, help);
    }
    let offset = scope.number(child, "offset");
    let offset = offset.and_then(|o| scope.within(child, "offset", o, Physical::Position));
    let Some(joint) = child.attribute("joint") else {
        scope.missing_attribute(child, "joint", "write joint=\"name of a joint\"");
        return None;
    };
    if !turns_or_slides(kind) {
        let message = "<mimic> is ignored: only a turning or sliding joint can follow another";
        scope.warning("U047", child.tag_at(), message, "remove it");
        return None;
    }
    Some(CheckedMimic {
        joint: &joint.value,
        multiplier: multiplier.unwrap_or(1.0),
        offset: offset.unwrap_or(0.0),
        at: joint.at.clone(),
    })
}

/// Checks that every mimic follows a turning or sliding joint and none follows itself; those that
/// do not are left out.
pub(super) fn check_mimics(scope: &mut Scope, joints: &mut [CheckedJoint]) {
    for wrong in wrong_mimics(scope, joints) {
        joints[wrong].mimic = None;
    }
}

fn wrong_mimics(scope: &mut Scope, joints: &[CheckedJoint]) -> Vec<usize> {
    let mut wrong = Vec::new();
    let index: HashMap<&str, usize> = joints
        .iter()
        .enumerate()
        .filter(|(_, j)| j.own_name)
        .map(|(i, j)| (j.name, i))
        .collect();
    let target = |i: usize| -> Option<usize> {
        let mimic = joints[i].mimic.as_ref()?;
        index.get(mimic.joint).copied()
    };
    for (i, joint) in joints.iter().enumerate() {
        let Some(mimic) = &joint.mimic else {
            continue;
        };
        scope.owner = joint.called();
        let at = mimic.at.clone();
        let Some(followed) = target(i) else {
            let message = format!(
                "<mimic> names joint '{}', which does not exist",
                mimic.joint
            );
            let mut help = did_you_mean(mimic.joint, joints.iter().map(|j| j.name));
            if help.is_empty() {
                help = of_this_side(mimic.joint, joint, joints);
            }
            if let Some(mover) = joints.iter().find(|other| moves(other, mimic.joint)) {
                help = format!("that is a link, which joint '{}' moves", mover.name);
            }
            scope.problem("U046", at, &message, help);
            wrong.push(i);
            continue;
        };
        if !turns_or_slides(joints[followed].kind) {
            let message = format!(
                "<mimic> names joint '{}', which neither turns nor slides",
                mimic.joint
            );
            let help = "follow a revolute, continuous or prismatic joint";
            scope.problem("U046", at, &message, help);
            wrong.push(i);
        }
    }
    report_circles(scope, joints, target, &mut wrong);
    wrong
}

/// Whether a link is the child of a joint.
fn moves(joint: &CheckedJoint, link: &str) -> bool {
    let child = joint.child.as_ref();
    child.is_some_and(|child| child.name == link)
}

/// What to do where a joint `joint` mimics `name`, which is none: the joint that is meant has a
/// prefix in front of this name, which that of `joint` begins with. Copies of a hand get one, and
/// what their joints mimic may have been forgotten.
fn of_this_side(name: &str, joint: &CheckedJoint, joints: &[CheckedJoint]) -> String {
    let meant = joints.iter().find(|other| {
        let prefix = other.name.strip_suffix(name);
        prefix.is_some_and(|prefix| !prefix.is_empty() && joint.name.starts_with(prefix))
    });
    meant.map_or_else(String::new, |meant| {
        format!("did you mean '{}'?", meant.name)
    })
}

/// One error for each circle of mimics.
fn report_circles(
    scope: &mut Scope,
    joints: &[CheckedJoint],
    target: impl Fn(usize) -> Option<usize>,
    wrong: &mut Vec<usize>,
) {
    // The walk that came past a joint first; each joint is passed once.
    let mut walk = vec![None; joints.len()];
    for start in 0..joints.len() {
        let mut next = Some(start);
        while let Some(i) = next
            && walk[i].is_none()
        {
            walk[i] = Some(start);
            next = target(i);
        }
        let Some(i) = next.filter(|&i| walk[i] == Some(start) && target(i).is_some()) else {
            continue;
        };
        let (joint, Some(mimic)) = (&joints[i], &joints[i].mimic) else {
            continue;
        };
        scope.owner = joint.called();
        let message = if mimic.joint == joint.name {
            "the joint mimics itself".to_owned()
        } else {
            format!(
                "<mimic> closes a circle: '{}' follows this joint",
                mimic.joint
            )
        };
        scope.problem(
            "U046",
            mimic.at.clone(),
            &message,
            "let one of the joints follow none",
        );
        wrong.push(i);
    }
}
