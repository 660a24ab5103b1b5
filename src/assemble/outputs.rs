//! Which links have outputs and inputs of their own.

use super::findings::Findings;
use crate::model::{ActuatorId, ActuatorMode, Group, JointKind, LinkId, Model, RootId};
use crate::pattern::Pattern;
use crate::settings::{ContactOutputs, GroupSettings, Settings};
use crate::variables::identifier;

/// Fills `model.outputs` from the settings.
pub(super) fn select(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    let has_shape = shaped(model);
    let contacts = match &settings.contact_outputs {
        ContactOutputs::Auto if model.world.ground.is_none() => Vec::new(),
        ContactOutputs::Auto => chosen(&has_shape),
        ContactOutputs::Links(patterns) => {
            let unsuitable = |l: usize| {
                (!has_shape[l]).then(|| "has no collision shape that can touch anything".to_owned())
            };
            links(model, patterns, unsuitable, findings)
        }
    };
    // That of no links at all is told in the settings.
    let named = settings.contact_outputs != ContactOutputs::Links(Vec::new());
    if settings.contact_points && contacts.is_empty() && named && !findings.has_errors() {
        let (why, help) = match settings.contact_outputs {
            ContactOutputs::Auto if model.world.ground.is_none() => (
                "without a ground no link has contact outputs",
                "name the links in contacts of [outputs], or leave it out",
            ),
            _ => ("no link has contact outputs", "leave it out"),
        };
        let message = format!("'contact_points' of [outputs] changes nothing: {why}");
        findings.warning("A144", None, message, help);
    }
    let shown = links(model, &settings.link_outputs, |_| None, findings);
    let welded = |l: usize| {
        let body = model.links[l].body;
        (!model.bodies[body.index()].motion.kind().moves())
            .then(|| "belongs to the fixed base: a wrench cannot move it".to_owned())
    };
    let wrenches = links(model, &settings.external_wrenches, welded, findings);
    model.outputs.contacts = contacts;
    model.outputs.contact_points = settings.contact_points;
    model.outputs.links = shown;
    model.outputs.external_wrenches = wrenches;
    if settings.conveyor {
        model.outputs.conveyors = vec![RootId::from(0)];
    }
    for group in &settings.groups {
        if let Some(group) = self::group(model, group, findings) {
            model.outputs.groups.push(group);
        }
    }
}

/// The commanded joints of a group, which then have one effort limit.
fn group(model: &mut Model, settings: &GroupSettings, findings: &mut Findings) -> Option<Group> {
    let name = &settings.name.text;
    let place = || settings.name.place.clone();
    let mut error = |message: String, help: &str| -> Option<Group> {
        findings.error("A130", place(), message, help);
        None
    };
    if let Some(joint) = model
        .joints
        .iter()
        .find(|joint| identifier(&joint.name) == identifier(name))
    {
        let message = format!("group '{name}' has the name of joint '{}'", joint.name);
        return error(message, "give it another one");
    }
    let taken = |group: &&Group| identifier(&group.name) == identifier(name);
    if let Some(other) = model.outputs.groups.iter().find(taken) {
        let message = if other.name == *name {
            format!("a second group is named '{name}'")
        } else {
            format!(
                "groups '{}' and '{name}' have the same name among variables",
                other.name
            )
        };
        return error(message, "give it another name");
    }
    let names: Vec<&str> = model.joints.iter().map(|j| j.name.as_str()).collect();
    let commanded: Vec<Option<usize>> = (0..names.len())
        .map(|j| model.actuators.iter().position(|a| a.joint.index() == j))
        .collect();
    let mut chosen = vec![false; model.actuators.len()];
    for (i, pattern) in settings.joints.iter().enumerate() {
        let mut before = settings.joints[..i].iter();
        if before.any(|other| other.text == pattern.text) {
            let message = format!("'{}' stands twice in group '{name}'", pattern.text);
            let help = "remove it, or name the joint that is meant";
            findings.warning("A144", pattern.place.clone(), message, help);
        }
        let unsuitable = |j: usize| {
            commanded[j]
                .is_none()
                .then(|| "is not commanded: it is fixed, passive or follows another one".to_owned())
        };
        for j in findings.select(pattern, "joint", &names, unsuitable) {
            if let Some(a) = commanded[j] {
                chosen[a] = true;
            }
        }
    }
    let members: Vec<usize> = (0..chosen.len()).filter(|&a| chosen[a]).collect();
    let &first = members.first()?;
    let joint_name = |a: usize| &model.joints[model.actuators[a].joint.index()].name;
    let slides =
        |a: usize| model.joints[model.actuators[a].joint.index()].kind == JointKind::Prismatic;
    let start = |a: usize| model.initial.joint_positions[model.actuators[a].joint.index()];
    let holds_position = matches!(
        model.actuators[first].mode,
        ActuatorMode::Position | ActuatorMode::Pd
    );
    for &a in &members {
        let grouped = model
            .outputs
            .groups
            .iter()
            .find(|group| group.actuators.contains(&ActuatorId::from(a)));
        let (one, other) = (joint_name(first), joint_name(a));
        let (message, help) = if let Some(group) = grouped {
            let message = format!("joint '{other}' is in group '{}' already", group.name);
            (message, "a joint takes one command")
        } else if slides(a) != slides(first) {
            // Before the mode, which would not be of use here.
            let message = format!("of joints '{one}' and '{other}' one turns and one slides");
            (message, "make a group of each")
        } else if model.actuators[a].mode != model.actuators[first].mode {
            let message = format!("joints '{one}' and '{other}' take different commands");
            (message, "give them one mode with [[actuator]]")
        } else if holds_position && start(a).to_bits() != start(first).to_bits() {
            let message = format!(
                "joints '{one}' and '{other}' share a position, but start at {} and {}",
                start(first),
                start(a)
            );
            (message, "let them start alike with [initial] joints")
        } else {
            continue;
        };
        findings.error("A130", place(), format!("group '{name}': {message}"), help);
        return None;
    }
    share(model, name, &members, findings);
    Some(Group {
        name: name.clone(),
        actuators: members.into_iter().map(ActuatorId::from).collect(),
    })
}

/// Gives the members of a group one effort limit, the least of theirs, and one pair of gains, the
/// first's.
fn share(model: &mut Model, name: &str, members: &[usize], findings: &mut Findings) {
    let Some(&first) = members.first() else {
        return;
    };
    let least = members
        .iter()
        .map(|&a| model.actuators[a].max_effort)
        .fold(f64::INFINITY, f64::min);
    #[expect(clippy::float_cmp, reason = "copies of one number are equal")]
    let differs = |a: &usize| {
        let (own, first) = (&model.actuators[*a], &model.actuators[first]);
        own.max_effort != least || own.kp != first.kp || own.kd != first.kd
    };
    if members.iter().any(differs) {
        let message = format!(
            "the joints of group '{name}' share max_effort = {least}, the least of theirs, and the gains of '{}'",
            model.joints[model.actuators[first].joint.index()].name
        );
        findings.note(
            "A130",
            message,
            "set [[actuator]] max_effort, kp, kd for all of them",
        );
    }
    let (kp, kd) = (model.actuators[first].kp, model.actuators[first].kd);
    for &a in members {
        let actuator = &mut model.actuators[a];
        (actuator.max_effort, actuator.kp, actuator.kd) = (least, kp, kd);
    }
}

/// Links that match any of the patterns, in the model's order, each once.
fn links(
    model: &Model,
    patterns: &[Pattern],
    unsuitable: impl Fn(usize) -> Option<String>,
    findings: &mut Findings,
) -> Vec<LinkId> {
    let names: Vec<&str> = model.links.iter().map(|l| l.name.as_str()).collect();
    let mut chosen = vec![false; names.len()];
    for pattern in patterns {
        for l in findings.select(pattern, "link", &names, &unsuitable) {
            chosen[l] = true;
        }
    }
    self::chosen(&chosen)
}

/// The links that are marked.
fn chosen(marked: &[bool]) -> Vec<LinkId> {
    let links = marked.iter().enumerate().filter(|(_, marked)| **marked);
    links.map(|(l, _)| LinkId::from(l)).collect()
}

/// Links that can touch something.
pub(super) fn touching(model: &Model) -> Vec<LinkId> {
    chosen(&shaped(model))
}

/// Links with a shape that is not on a fixed base.
fn shaped(model: &Model) -> Vec<bool> {
    let mut shaped = vec![false; model.links.len()];
    for collider in &model.colliders {
        shaped[collider.link.index()] = model.bodies[collider.body.index()].motion.kind().moves();
    }
    shaped
}
