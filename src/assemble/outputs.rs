//! Which links have outputs and inputs of their own.

use super::findings::Findings;
use crate::model::{JointKind, LinkId, Model, Motion};
use crate::settings::{ContactOutputs, Pattern, Settings};

/// Fills `model.outputs` from the settings.
pub(super) fn select(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    let contacts = match &settings.contact_outputs {
        ContactOutputs::Auto => leaves(model),
        ContactOutputs::Links(patterns) => {
            let has_shape = shaped(model);
            let unsuitable = |l: usize| {
                (!has_shape[l]).then(|| "has no collision shape that can touch anything".to_owned())
            };
            links(model, patterns, unsuitable, findings)
        }
    };
    let shown = links(model, &settings.link_outputs, |_| None, findings);
    let welded = |l: usize| {
        let body = model.links[l].body;
        (model.bodies[body.index()].motion == Motion::Welded)
            .then(|| "belongs to the fixed base: a wrench cannot move it".to_owned())
    };
    let wrenches = links(model, &settings.external_wrenches, welded, findings);
    model.outputs.contacts = contacts;
    model.outputs.links = shown;
    model.outputs.external_wrenches = wrenches;
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
    (0..names.len())
        .filter(|&l| chosen[l])
        .map(LinkId::from)
        .collect()
}

/// Links with a shape that is not on a fixed base.
fn shaped(model: &Model) -> Vec<bool> {
    let mut shaped = vec![false; model.links.len()];
    for collider in &model.colliders {
        shaped[collider.link.index()] =
            model.bodies[collider.body.index()].motion != Motion::Welded;
    }
    shaped
}

/// Links at the end of the tree: they can touch something and carry no moving link, not even by way of links
/// fixed to them. None without a ground.
fn leaves(model: &Model) -> Vec<LinkId> {
    if model.world.ground.is_none() {
        return Vec::new();
    }
    let mut leaf = shaped(model);
    let mut carries = vec![false; model.links.len()];
    for joint in model.joints.iter().rev() {
        let moving = joint.kind != JointKind::Fixed;
        carries[joint.parent.index()] |= moving || carries[joint.child.index()];
    }
    for (leaf, carries) in leaf.iter_mut().zip(&carries) {
        *leaf &= !carries;
    }
    (0..leaf.len())
        .filter(|&l| leaf[l])
        .map(LinkId::from)
        .collect()
}
