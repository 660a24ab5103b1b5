//! Checks of the `<limit>` of a joint.

use super::numbers::LARGEST;
use super::scope::{Scope, Version};
use super::xml::Node;
use crate::diagnostic::angles::{self, HELP};
use crate::digits::Digits;
use crate::model::JointKind;
use crate::range::Range as Physical;
use std::f64::consts::TAU;

/// Lower and upper limits that PyBullet's own files write for a joint without limits: its solver
/// takes a lower limit above the upper one for none.
const NO_LIMITS: [(f64, f64); 2] = [(1.0, -1.0), (0.0, -1.0)];

/// Whether a joint has one position, which may have limits.
pub(super) fn turns_or_slides(kind: JointKind) -> bool {
    matches!(
        kind,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic
    )
}

/// Range, rad or m; effort; velocity.
pub(super) type Limit = (Option<(f64, f64)>, Option<f64>, Option<f64>);

/// Range, effort and velocity; none of what counts as unlimited.
pub(super) fn read(scope: &mut Scope, node: Node, kind: JointKind) -> Limit {
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
        tell_unbounded(scope, child, kind, (lower, upper));
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

/// Tells of the `<limit>` of a joint with several degrees of freedom, which bounds none of them. A
/// range that is one changes the motion of whoever reads it.
fn tell_unbounded(
    scope: &mut Scope,
    limit: Node,
    kind: JointKind,
    (lower, upper): (Option<f64>, Option<f64>),
) {
    if turns_or_slides(kind) || kind == JointKind::Fixed {
        return;
    }
    let message = format!(
        "<limit> is not used: a {} joint moves without limits",
        kind.name()
    );
    if lower.unwrap_or(0.0) < upper.unwrap_or(0.0) {
        let help = "leave it out, or make the joint of prismatic and revolute ones, each with a \
                    limit of its own";
        scope.warning("U020", limit.tag_at(), &message, help);
    } else {
        scope.note("U020", limit.tag_at(), &message, "");
    }
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
