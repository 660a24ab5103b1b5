//! Mimic joints: each chain is resolved to its independent joint.

use super::findings::Findings;
use super::robot::{Robot, is_scalar, kind_name};
use crate::diagnostic::words::likeliest;
use crate::model::{JointId, Mimic};
use std::collections::HashMap;

/// Sets `Joint::mimic`. With `q = m q₁ + o` and `q₁ = m₁ q₂ + o₁`: `q = m m₁ q₂ + (m o₁ + o)`.
pub(super) fn resolve(robot: &mut Robot, findings: &mut Findings) {
    let names: HashMap<String, usize> = robot
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| (joint.name.clone(), j))
        .collect();
    let direct: Vec<Option<(usize, f64, f64)>> = (0..robot.joints.len())
        .map(|j| direct(robot, &names, j, findings))
        .collect();
    for j in 0..robot.joints.len() {
        let Some((mut source, mut multiplier, mut offset)) = direct[j] else {
            continue;
        };
        let mut steps = 0;
        while let Some((next, m, o)) = direct[source] {
            offset += multiplier * o;
            multiplier *= m;
            source = next;
            steps += 1;
            if steps > robot.joints.len() {
                break;
            }
        }
        let place = findings.tag(&robot.tags.joints[j]);
        let name = &robot.joints[j].name;
        if steps > robot.joints.len() {
            let message = format!("joint '{name}' mimics itself by way of others");
            let help = "one joint of the circle must be independent";
            findings.error("A103", place, message, help);
            continue;
        }
        if !multiplier.is_finite() || !offset.is_finite() {
            let message = format!("the mimic ratio or offset of joint '{name}' is not finite");
            findings.error("A103", place, message, "check multiplier and offset");
            continue;
        }
        robot.joints[j].mimic = Some(Mimic {
            joint: JointId::from(source),
            multiplier,
            offset,
        });
    }
}

/// The joint that is followed directly, as the file says.
fn direct(
    robot: &Robot,
    names: &HashMap<String, usize>,
    j: usize,
    findings: &mut Findings,
) -> Option<(usize, f64, f64)> {
    let (target, multiplier, offset) = robot.mimics[j].as_ref()?;
    let joint = &robot.joints[j];
    let place = findings.tag(&robot.tags.joints[j]);
    if !is_scalar(joint.kind) {
        let message = format!(
            "joint '{}' {}: its <mimic> is not used",
            joint.name,
            kind_name(joint.kind)
        );
        findings.warning("A103", place, message, "remove <mimic>");
        return None;
    }
    let Some(&source) = names.get(target) else {
        let all = robot.joints.iter().map(|joint| joint.name.as_str());
        let help = likeliest(target, all)
            .map_or_else(String::new, |name| format!("the nearest joint is '{name}'"));
        let message = format!(
            "joint '{}' mimics '{target}', which does not exist",
            joint.name
        );
        findings.error("A103", place, message, &help);
        return None;
    };
    if source == j {
        let message = format!("joint '{}' mimics itself", joint.name);
        findings.error("A103", place, message, "remove <mimic>");
        return None;
    }
    let kind = robot.joints[source].kind;
    if !is_scalar(kind) {
        let message = format!(
            "joint '{}' mimics '{target}', which {}",
            joint.name,
            kind_name(kind)
        );
        let help = "only turning and sliding joints can be mimicked";
        findings.error("A103", place, message, help);
        return None;
    }
    Some((source, *multiplier, *offset))
}
