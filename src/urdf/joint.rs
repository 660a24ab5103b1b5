//! Checks of `<joint>`: type, axis, limits, dynamics, mimic.

use super::checked::{CheckedJoint, CheckedMimic, LinkReference, called};
use super::numbers::LARGEST;
use super::scope::{Scope, Version};
use super::xml::Node;
use crate::diagnostic::angles::{self, HELP};
use crate::diagnostic::words::did_you_mean;
use crate::digits::Digits;
use crate::model::JointKind;
use crate::range::Range as Physical;
use crate::spatial::Vec3;
use std::collections::HashMap;
use std::f64::consts::TAU;

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

/// Lower and upper limits that PyBullet's own files write for a joint without limits: its solver
/// takes a lower limit above the upper one for none.
const NO_LIMITS: [(f64, f64); 2] = [(1.0, -1.0), (0.0, -1.0)];

/// Squared length of an axis below which it has no direction.
const NO_DIRECTION: f64 = 1e-12;

fn turns_or_slides(kind: JointKind) -> bool {
    matches!(
        kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    )
}

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
    let (limits, effort, velocity) = limit(scope, node, kind);
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
        line: scope.report.line(node.tag_at().start),
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
        let help = format!("add <{tag} link=\"…\"/>");
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

type Limit = (Option<(f64, f64)>, Option<f64>, Option<f64>);

fn limit(scope: &mut Scope, node: Node, kind: JointKind) -> Limit {
    let limited = matches!(kind, JointKind::Revolute | JointKind::Prismatic);
    let Some(child) = scope.single(node, "limit") else {
        if limited {
            let word = if kind == JointKind::Prismatic {
                "prismatic"
            } else {
                "revolute"
            };
            let message =
                format!("a {word} joint needs a <limit>: without it the joint counts as unlimited");
            let mut help =
                "add <limit lower=\"…\" upper=\"…\" effort=\"…\" velocity=\"…\"/>".to_owned();
            if kind == JointKind::Revolute {
                help += ", or use type=\"continuous\"";
            }
            scope.warning("U044", node.tag_at(), &message, help);
        }
        return (None, None, None);
    };
    let rest: &[&str] = if scope.version >= Version(1, 2) {
        &["acceleration", "deceleration", "jerk"]
    } else {
        &[]
    };
    for (name, at) in child.attribute_names().filter(|(a, _)| rest.contains(a)) {
        scope.note("U020", at, &format!("<limit> {name} is not used"), "");
    }
    scope.leaf(
        child,
        &[&["lower", "upper", "effort", "velocity"], rest].concat(),
    );
    let lower = limit_number(scope, child, "lower");
    let upper = limit_number(scope, child, "upper");
    let effort = limit_size(scope, child, "effort");
    let velocity = limit_size(scope, child, "velocity");
    if turns_or_slides(kind) && scope.version < Version(1, 2) {
        for name in ["effort", "velocity"] {
            if child.attribute(name).is_none() {
                let message = format!("<limit> has no {name}");
                scope.warning("U045", child.tag_at(), &message, "it counts as unlimited");
            }
        }
    }
    if !limited {
        return (None, effort, velocity);
    }
    if kind == JointKind::Revolute
        && let Some(told) = angles::limits([lower, upper])
        && let Some(attribute) = child.attribute(told.name)
    {
        let at = attribute.at.clone();
        if told.certain {
            scope.warning("U035", at, &told.message, HELP);
        } else {
            scope.note("U035", at, &told.message, HELP);
        }
    }
    let range = range(scope, child, lower, upper);
    if let (Some((lower, upper)), Some(speed)) = (range, velocity) {
        warn_slow(scope, child, upper - lower, (kind, speed));
    }
    (range, effort, velocity)
}

/// Warns of a velocity limit by which a joint needs hours for its range, as of a rounded 0.
/// Position servos keep to it, and give way to a load. A range of more than a turn or 6 m may stand
/// for none.
fn warn_slow(scope: &mut Scope, limit: Node, range: f64, (kind, speed): (JointKind, f64)) {
    let (range, turns) = (range.min(TAU), kind == JointKind::Revolute);
    let unit = if turns { "rad" } else { "m" };
    let hours = range / speed / 3600.0;
    if let Some(attribute) = limit.attribute("velocity")
        && speed > 0.0
        && hours >= 1.0
    {
        let message = format!(
            "<limit> velocity {} {unit}/s means {hours:.1} hours for {range:.3} {unit}: the position servo \
             keeps to it, and can hardly move or hold the joint",
            Digits(speed)
        );
        let help = format!("write the velocity in {unit}/s; small servos turn by 5 rad/s");
        scope.warning("U045", attribute.at.clone(), &message, help);
    }
}

fn range(
    scope: &mut Scope,
    node: Node,
    lower: Option<f64>,
    upper: Option<f64>,
) -> Option<(f64, f64)> {
    let given = (
        node.attribute("lower").is_some(),
        node.attribute("upper").is_some(),
    );
    if scope.version >= Version(1, 2) {
        match given {
            (false, false) => return None,
            (true, true) => {}
            _ => {
                let help = "give both lower and upper, or neither";
                let message = "a limit on one side only is not supported";
                scope.problem("U044", node.tag_at(), message, help);
                return None;
            }
        }
    }
    if given == (false, false) {
        // By the letter both are 0 and the joint is locked; Drake, MuJoCo and PyBullet all take it
        // as free.
        let message = "<limit> has neither lower nor upper: the joint counts as unlimited";
        let help = "give the range in rad or m, or use type=\"continuous\" or \"fixed\"";
        scope.warning("U044", node.tag_at(), message, help);
        return None;
    }
    if let Some(missing) = match given {
        (true, false) => Some("upper"),
        (false, true) => Some("lower"),
        _ => None,
    } {
        let message = format!("<limit> has no {missing}: it is 0, as in URDF");
        let help = format!("write {missing}=\"0\" if that is meant, or the limit in rad or m");
        scope.note("U044", node.tag_at(), &message, help);
    }
    let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
    if lower > upper {
        let at = node
            .attribute("lower")
            .or_else(|| node.attribute("upper"))
            .map_or_else(|| node.tag_at(), |a| a.at.clone());
        let message = format!("the lower limit {lower} is above the upper limit {upper}");
        // PyBullet itself takes all of them for none.
        if scope.pybullet || NO_LIMITS.contains(&(lower, upper)) {
            let message = format!("{message}: PyBullet's way to write \"none\", and read so");
            let help = "give the range in rad or m, or use type=\"continuous\"";
            scope.warning("U043", at, &message, help);
            return None;
        }
        let message = format!("{message}: the range between them is used");
        let help = "exchange them; for a joint without limits, as MuJoCo and PyBullet take it, use \
                    type=\"continuous\"";
        scope.warning("U043", at, &message, help);
        return Some((upper, lower));
    }
    Some((lower, upper))
}

/// A number of a `<limit>`. Programs write the largest number that they know, or infinity, where
/// there is no limit.
fn limit_number(scope: &mut Scope, node: Node, name: &str) -> Option<f64> {
    let attribute = node.attribute(name)?;
    let beyond = |number: &f64| number.abs() > LARGEST;
    let Some(number) = attribute.value.trim().parse().ok().filter(beyond) else {
        return scope.number(node, name);
    };
    let message = format!("<limit> {name} {number:e} counts as unlimited");
    let help = "write a number of up to 1e30, or leave it out";
    scope.warning("U032", attribute.at.clone(), &message, help);
    Some(number.clamp(-LARGEST, LARGEST))
}

/// The effort or the velocity of a `<limit>`; many files write -1 for "none", and other programs
/// take it so or do not look at it.
fn limit_size(scope: &mut Scope, node: Node, name: &str) -> Option<f64> {
    let value = limit_number(scope, node, name)?;
    if value >= 0.0 {
        // Limits of any size stand for "none".
        return scope.within(node, name, value, Physical::LimitSize);
    }
    let at = node
        .attribute(name)
        .map_or_else(|| node.tag_at(), |a| a.at.clone());
    let value = Digits(value);
    let message = format!("<limit> {name} {value} is negative: it counts as unlimited");
    scope.warning("U033", at, &message, "write its size, or leave it out");
    None
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

/// The joint whose name has the same prefix as this one and then `name`: copies of a hand get a
/// prefix, and what their joints mimic may have been forgotten.
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
