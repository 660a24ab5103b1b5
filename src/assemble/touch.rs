//! Which links of a robot touch each other.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::Findings;
use super::initial::poses;
use crate::geometry::pair::Patch;
use crate::model::{LinkId, Model};
use crate::settings::Settings;
use std::collections::BTreeSet;

/// Overlap before anything moves that is worth a warning, m. Links of one robot then do not touch
/// each other: shapes of neighbours are drawn into each other, and a robot that is pushed apart at
/// once helps nobody.
const DRAWN_TOGETHER: f64 = 1e-3;

/// Lets the robot's links touch each other if the settings say so, but for those that they and the
/// SRDF name, and those that overlap from the beginning.
pub(super) fn select(model: &mut Model, settings: &Settings, findings: &mut Findings) {
    model.roots[0].self_collision = settings.self_collision;
    let names: Vec<&str> = model.links.iter().map(|link| link.name.as_str()).collect();
    let id = |link: usize| LinkId::from(link);
    let mut apart = BTreeSet::new();
    for patterns in &settings.ignored_contacts {
        let mut links = BTreeSet::new();
        for pattern in patterns {
            links.extend(findings.select(pattern, "link", &names, |_| None));
        }
        for &a in &links {
            let above = links.range(a + 1..);
            apart.extend(above.map(|&b| [id(a), id(b)]));
        }
    }
    for pair in &settings.disabled_contacts {
        let place = |name: &String| names.iter().position(|other| other == name);
        if let [Some(a), Some(b)] = [&pair[0], &pair[1]].map(place) {
            apart.insert([id(a.min(b)), id(a.max(b))]);
        }
    }
    model.apart = apart.into_iter().collect();
    if !settings.self_collision {
        return;
    }
    // At joint zero, too: many robots are drawn with what touches there.
    let mut zero = model.clone();
    zero.initial.joint_positions.fill(0.0);
    let mut drawn: Vec<([LinkId; 2], f64)> = Vec::new();
    for model in [&*model, &zero] {
        for (pair, depth) in overlaps(model) {
            match drawn.iter_mut().find(|(known, _)| *known == pair) {
                Some((_, most)) => *most = most.max(depth),
                None => drawn.push((pair, depth)),
            }
        }
    }
    drawn.sort_by_key(|(pair, _)| *pair);
    for (pair, depth) in &drawn {
        let [a, b] = pair.map(|link| &model.links[link.index()].name);
        let message = format!(
            "links '{a}' and '{b}' overlap by {:.1} mm before anything moves, so they do not touch each other",
            1e3 * depth
        );
        let help = "name them in [[ignore_contact]] if that is right, else correct their shapes";
        findings.warning("A136", None, message, help);
    }
    model.apart.extend(drawn.into_iter().map(|(pair, _)| pair));
    model.apart.sort_unstable();
}

/// Links whose shapes may touch and overlap at the start by more than [`DRAWN_TOGETHER`], and by
/// how much, m.
pub(super) fn overlaps(model: &Model) -> Vec<([LinkId; 2], f64)> {
    let poses = poses(model);
    let contacts = &poses.tree.contact;
    let colliders = &contacts.colliders;
    let mut patch = Patch::new();
    let mut found: Vec<([LinkId; 2], f64)> = Vec::new();
    for (i, a) in colliders.iter().enumerate() {
        for (j, b) in colliders.iter().enumerate().skip(i + 1) {
            let (Some(first), Some(second)) = (&a.solid, &b.solid) else {
                continue;
            };
            if !contacts.may_touch([i, j]) {
                continue;
            }
            let X = poses.pair([a, b]);
            patch.find((first, &X[0]), (second, &X[1]), 0.0);
            let deepest = patch.points().iter().map(|p| p.depth).fold(0.0, f64::max);
            let pair = [a.link.min(b.link), a.link.max(b.link)].map(LinkId::from);
            if deepest > DRAWN_TOGETHER {
                match found.iter_mut().find(|(known, _)| *known == pair) {
                    Some((_, most)) => *most = most.max(deepest),
                    None => found.push((pair, deepest)),
                }
            }
        }
    }
    found
}
