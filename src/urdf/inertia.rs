//! Checks of mass and rotational inertia.
//!
//! A rigid body of any shape has `I = tr(J) 1 − J` with the second moments `J = ∫ r rᵀ dm`,
//! positive semi-definite. So `I` is positive semi-definite and no principal moment exceeds the sum
//! of the other two.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::checked::{CheckedInertial, CheckedLink, CheckedRobot, LinkReference, Order, Suspect};
use super::options::{ImpossibleInertia, MissingMass};
use super::scope::Scope;
use super::xml::Node;
use crate::model::JointKind;
use crate::spatial::{Mat3, Pose, RigidInertia, rotation_from_rpy};
use std::collections::HashMap;

/// URDF's order.
pub(super) const NAMES: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// The other half of the matrix, which is symmetric; some exporters write it, too.
const MIRRORED: [(&str, &str); 3] = [("iyx", "ixy"), ("izx", "ixz"), ("izy", "iyz")];

/// Warns about what `<inertia>` has that is not known, and about a second half of the matrix
/// that contradicts the first.
pub(super) fn known_attributes(scope: &mut Scope, node: Node) {
    let known: Vec<&str> = NAMES
        .into_iter()
        .chain(MIRRORED.map(|pair| pair.0))
        .collect();
    scope.leaf(node, &known);
    for (second, first) in MIRRORED {
        let number = |name: &str| node.value(name)?.trim().parse::<f64>().ok();
        if let (Some(a), Some(b)) = (number(first), number(second))
            && (a - b).abs() > 0.0
            && let Some(attribute) = node.attribute(second)
        {
            let message = format!("<inertia> {second} is not {first}, which is used");
            let help = "the matrix of inertia is symmetric: correct one of them";
            scope.warning("U019", attribute.at.clone(), &message, help);
        }
    }
}

/// The number of the other half of the matrix, with its name, where the first half lacks `name`.
pub(super) fn mirrored(
    scope: &mut Scope,
    node: Node,
    name: &'static str,
) -> Option<(&'static str, f64)> {
    let (second, _) = MIRRORED.into_iter().find(|(_, first)| *first == name)?;
    let at = node.attribute(second)?.at.clone();
    let number = scope.number(node, second)?;
    let message = format!("<inertia> has no {name}: {second} is used, the same by symmetry");
    let help = format!("write {name}, which is the name in URDF");
    scope.warning("U063", at, &message, &help);
    Some((second, number))
}

/// Part of the largest principal moment below which a negative moment is round-off: files are
/// printed with six digits.
const ROUND_OFF: f64 = 1e-5;

/// Part of the largest principal moment by which it may exceed the sum of the others before it is
/// told.
const TRIANGLE: f64 = 1e-3;

/// Radius of gyration, m, below which a body counts as a point: exporters write round-off such as
/// 1e-20.
const POINT: f64 = 1e-6;

/// The symmetric matrix of six numbers in URDF's order.
pub(super) fn matrix(i: &[f64; 6]) -> Mat3 {
    Mat3::new(i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5])
}

/// The six numbers of a symmetric matrix in URDF's order.
fn numbers(I: &Mat3) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| I[at])
}

/// Reports what no body can have.
pub(super) fn check(scope: &mut Scope, inertial: &mut CheckedInertial, mass: Node, inertia: Node) {
    let at = |node: Node, name: &str| {
        node.attribute(name)
            .map_or_else(|| node.tag_at(), |a| a.at.clone())
    };
    if inertial.mass < 0.0 {
        let message = format!("mass {} kg is negative", inertial.mass);
        let help = "give the mass in kg; a frame that does not move needs no <inertial>";
        scope.problem("U060", at(mass, "value"), &message, help);
        // So that what else is wrong with the robot can be looked for.
        inertial.mass = -inertial.mass;
        return;
    }
    if inertial.mass == 0.0 {
        // The file's numbers hold, as in Pinocchio: franka_panda of pybullet_data has such a link
        // on its hand.
        let zero = inertial.inertia.iter().all(|i| i.abs() <= POINT * POINT);
        if zero {
            inertial.inertia = [0.0; 6];
            return;
        }
        scope.warning(
            "U064",
            at(mass, "value"),
            "the mass is zero and the inertia is not: it is used as it is",
            "give a mass, or, of a frame that does not move, leave <inertial> out",
        );
    }
    let point = inertial.mass * POINT * POINT;
    let zero = inertial.inertia.iter().all(|i| i.abs() <= point);
    if zero {
        let message = format!(
            "{} kg without rotational inertia: a point mass, where the robot can move with one",
            inertial.mass
        );
        let help = "give its inertia, or use --inertia collision";
        scope.warning("U063", inertia.tag_at(), &message, help);
        inertial.inertia = [0.0; 6];
        return;
    }
    let moments = principal_moments(&matrix(&inertial.inertia));
    let [smallest, middle, largest] = moments;
    let suggestion = || {
        let values = numbers(&nearest_physical(&matrix(&inertial.inertia)));
        let pairs = NAMES.iter().zip(values);
        let pairs: Vec<String> = pairs
            .map(|(name, value)| format!("{name}=\"{value:.6e}\""))
            .collect();
        pairs.join(" ")
    };
    // Not the round-off of a zero.
    let shown = |moment: f64| {
        if moment.abs() <= 1e-12 * largest {
            "0".to_owned()
        } else {
            format!("{moment:.4e}")
        }
    };
    if !is_possible(&moments) {
        let message = format!(
            "the inertia is not positive definite: its principal moments are {smallest:.4e}, {middle:.4e}, {largest:.4e} kg m²"
        );
        let help = if largest > 0.0 {
            format!(
                "check the signs and the order ixx ixy ixz iyy iyz izz; the nearest a body can have \
                 is\n{}",
                suggestion()
            )
        } else {
            "check the signs: ixx, iyy and izz are positive".to_owned()
        };
        inertial.suspect = Some(Suspect {
            at: inertia.tag_at(),
            message,
            help,
        });
    } else if largest - smallest - middle > TRIANGLE * largest {
        let message = format!(
            "no body has this inertia: the principal moment {largest:.4e} exceeds the sum of the others, {} + {} kg m²",
            shown(smallest),
            shown(middle)
        );
        let help = format!(
            "it is used as it is; the nearest a body can have is\n{}",
            suggestion()
        );
        scope.warning("U062", inertia.tag_at(), &message, help);
    }
}

/// Decides on implausible inertias: links that are fixed together only count together, so a bad
/// inertia is an error where the rigid body that it is part of cannot exist, and a warning
/// elsewhere.
pub(super) fn judge(scope: &mut Scope, robot: &mut CheckedRobot, order: &Order) {
    let suspects = |robot: &CheckedRobot, i: usize| -> Option<Suspect> {
        robot.links[i].inertial.as_ref()?.suspect.clone()
    };
    let all: Vec<usize> = (0..robot.links.len())
        .filter(|&i| suspects(robot, i).is_some())
        .collect();
    if all.is_empty() {
        return;
    }
    let bodies = rigid_bodies(robot, order);
    let shaped = |i: usize| !robot.links[i].collisions.is_empty();
    let computable = all.iter().all(|&i| shaped(i));
    let nearest = |robot: &CheckedRobot, i: usize| {
        let own = robot.links[i].inertial.as_ref();
        own.map_or_else(Mat3::zeros, |own| nearest_physical(&matrix(&own.inertia)))
    };
    // A body without width needs an inertia about its axis.
    let wide = |i: usize| {
        let [smallest, _, largest] = principal_moments(&nearest(robot, i));
        shaped(i) || smallest > TRIANGLE * largest
    };
    let option = if all.iter().all(|&i| wide(i)) {
        "--inertia nearest"
    } else {
        "--inertia nearest --missing-mass 0.1"
    };
    let mut remedy = format!("or use the nearest without a change of the file: {option}");
    if computable {
        remedy.push_str("\nor compute all from the collision shapes: --inertia collision");
    }
    for i in all {
        let Some(mut suspect) = suspects(robot, i) else {
            continue;
        };
        scope.owner = format!("link '{}'", robot.links[i].name);
        if is_possible(&principal_moments(&bodies[i].I_cm)) {
            suspect
                .message
                .push_str("; together with the links fixed to it the body is possible");
            scope.warning("U061", suspect.at, &suspect.message, suspect.help);
            continue;
        }
        match scope.impossible_inertia {
            ImpossibleInertia::Unused => {
                scope.warning("U061", suspect.at, &suspect.message, suspect.help);
            }
            ImpossibleInertia::Nearest => {
                let I = nearest(robot, i);
                if let Some(own) = &mut robot.links[i].inertial {
                    own.inertia = numbers(&I);
                }
                suspect.message.push_str("; the nearest is used");
                scope.warning("U061", suspect.at, &suspect.message, suspect.help);
            }
            ImpossibleInertia::Refused => {
                let help = format!("{}\n{remedy}", suspect.help);
                scope.problem("U061", suspect.at, &suspect.message, help);
            }
        }
    }
}

/// Warns of what moves without mass in a file that is refused for something else: that would be
/// told only once the rest is mended.
pub(super) fn foretell(scope: &mut Scope, robot: &CheckedRobot, order: &Order) {
    if scope.missing_mass == MissingMass::All {
        return;
    }
    let dense = scope.missing_mass == MissingMass::Shapes;
    let links = || robot.links.iter().enumerate();
    let index: HashMap<&str, usize> = links().map(|(i, link)| (link.name, i)).collect();
    // What each link and all below it has; children come after their parents.
    let weighs = |inertial: &CheckedInertial| inertial.mass > 0.0 || inertial.density.is_some();
    // What a link weighs that only a joint names is not known, nor what cannot be read of it.
    let unread = |link: &CheckedLink| {
        let mass = link
            .node
            .child("inertial")
            .and_then(|own| own.child("mass"));
        link.inertial.is_none() && mass.is_some()
    };
    let mut shaped: Vec<bool> = links()
        .map(|(_, link)| !link.collisions.is_empty())
        .collect();
    let mut heavy: Vec<bool> = links()
        .map(|(_, link)| {
            !link.own_name || unread(link) || link.inertial.as_ref().is_some_and(weighs)
        })
        .zip(&shaped)
        .map(|(weighs, &shaped)| weighs || dense && shaped)
        .collect();
    let mut light = Vec::new();
    for &j in order.joints.iter().rev() {
        let joint = &robot.joints[j];
        let of = |end: &Option<LinkReference>| index.get(end.as_ref()?.name).copied();
        let (Some(parent), Some(child)) = (of(&joint.parent), of(&joint.child)) else {
            continue;
        };
        if joint.kind != JointKind::Fixed && !heavy[child] {
            light.push((joint, shaped[child]));
        }
        heavy[parent] |= heavy[child];
        shaped[parent] |= shaped[child];
    }
    let Some((first, _)) = light.last() else {
        return;
    };
    let message = format!(
        "joint '{}' moves nothing that has mass{}: this comes next",
        first.name,
        match light.len() - 1 {
            0 => String::new(),
            1 => ", and another joint likewise".to_owned(),
            n => format!(", and {n} other joints likewise"),
        }
    );
    let of_shapes = "--density 1000 for masses from the collision shapes and a density";
    let of_all = "--missing-mass 0.1 for 0.1 kg in each link that cannot move without";
    let way = if light.iter().all(|&(_, shaped)| shaped) {
        of_shapes.to_owned()
    } else if !dense && light.iter().any(|&(_, shaped)| shaped) {
        format!("{of_shapes} and {of_all}")
    } else {
        of_all.to_owned()
    };
    let help = format!(
        "pass {way}, or --compat pybullet for 1 kg in each link without <inertial>, together with \
         what mends the rest"
    );
    let at = first.node.tag_at();
    scope.report.warning("U066", at, message, help);
}

/// Per link the inertia of all that is rigidly connected with it.
fn rigid_bodies(robot: &CheckedRobot, order: &Order) -> Vec<RigidInertia> {
    let index: HashMap<&str, usize> = robot
        .links
        .iter()
        .enumerate()
        .map(|(i, link)| (link.name, i))
        .collect();
    // Per link: the highest link of its body, and its pose there.
    let mut top: Vec<(usize, Pose)> = (0..robot.links.len())
        .map(|i| (i, Pose::IDENTITY))
        .collect();
    let mut bodies = vec![RigidInertia::ZERO; robot.links.len()];
    let joints = std::iter::once(None).chain(order.joints.iter().map(|&j| Some(&robot.joints[j])));
    for (&i, joint) in order.links.iter().zip(joints) {
        let fixed = joint.filter(|joint| joint.kind == JointKind::Fixed);
        let parent = fixed
            .and_then(|joint| joint.parent.as_ref())
            .and_then(|parent| index.get(parent.name));
        if let (Some(joint), Some(&parent)) = (fixed, parent) {
            let (body, X) = top[parent];
            top[i] = (body, X.compose(&Pose::from_xyz_rpy(joint.xyz, joint.rpy)));
        }
        let (body, X) = top[i];
        if let Some(inertial) = &robot.links[i].inertial {
            let R = rotation_from_rpy(&inertial.rpy);
            let own = RigidInertia {
                mass: inertial.mass,
                com: inertial.xyz,
                I_cm: R * matrix(&inertial.inertia) * R.transpose(),
            };
            bodies[body] = bodies[body].joined(&own.transformed(&X));
        }
    }
    top.iter().map(|(body, _)| bodies[*body]).collect()
}

/// Whether no moment is negative but for round-off; the moments ascend.
fn is_possible(moments: &[f64; 3]) -> bool {
    let [smallest, _, largest] = *moments;
    smallest >= -ROUND_OFF * largest.abs().max(smallest.abs())
}

/// Eigenvalues, ascending.
pub(super) fn principal_moments(I: &Mat3) -> [f64; 3] {
    let mut moments: [f64; 3] = I.symmetric_eigen().eigenvalues.into();
    moments.sort_by(f64::total_cmp);
    moments
}

/// The inertia whose second moments are those of `I` with the negative ones set to zero.
fn nearest_physical(I: &Mat3) -> Mat3 {
    let J = Mat3::identity() * (0.5 * I.trace()) - I;
    let eigen = J.symmetric_eigen();
    let moments = eigen.eigenvalues.map(|m| m.max(0.0));
    let J = eigen.eigenvectors * Mat3::from_diagonal(&moments) * eigen.eigenvectors.transpose();
    let I = Mat3::identity() * J.trace() - J;
    // Round-off beside the largest entry is not worth printing.
    let largest = I.iter().copied().map(f64::abs).fold(0.0, f64::max);
    I.map(|i| if i.abs() < 1e-12 * largest { 0.0 } else { i })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Vec3;

    #[test]
    fn the_nearest_physical_inertia_of_a_body_is_its_own() {
        // A box of 2 kg, 0.1 × 0.2 × 0.3 m: m/12 (b² + c²).
        let I = Mat3::from_diagonal(&(Vec3::new(0.13, 0.10, 0.05) * (2.0 / 12.0)));
        assert!((nearest_physical(&I) - I).norm() < 1e-15);
    }

    #[test]
    fn the_nearest_physical_inertia_has_the_properties_of_a_body() {
        let I = matrix(&[1.0, 0.3, 0.0, 5.0, -0.2, -0.5]);
        let [smallest, middle, largest] = principal_moments(&nearest_physical(&I));
        assert!(smallest >= 0.0);
        assert!(largest <= smallest + middle + 1e-12);
    }
}
