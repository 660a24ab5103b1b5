//! Robots that stand deep in the ground, because contacts are made softer than their weight allows.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::Findings;
use super::initial::{Poses, lowest_point, static_depth};
use crate::digits::Digits;
use crate::geometry::Shape;
use crate::model::{LinkId, Model};
use crate::settings::Settings;
use crate::spatial::Vec3;

/// Share of the smallest size of the shapes that a robot stands on by which it may sink without a
/// word. A wheel as deep as a twentieth of its diameter rolls as if its radius were a tenth less,
/// and stands on a chord of almost half its diameter: what it does is no longer what the file says.
const DEEPEST: f64 = 0.05;

/// What is thinner stands for a point, a line or a face, which have no size, m.
const THINNEST: f64 = 1e-6;

/// Warns where the robot sinks deeply under its weight because the settings, or the file, say how
/// soft its contacts are. With the usual ones it sinks by a tenth of a millimetre at most.
pub(super) fn warn(model: &Model, poses: &Poses, settings: &Settings, findings: &mut Findings) {
    let stands = model.is_floating() && model.world.ground.is_some() && !settings.driven;
    let lowest = lowest_point(model, poses, false);
    let (true, Some((link, z)), false) = (stands, lowest, findings.has_errors()) else {
        return;
    };
    let Some(key) = softness(model, settings, link) else {
        return;
    };
    let mut touching = model.clone();
    touching.roots[0].position.z = -z + 0.0;
    let depth = static_depth(&touching);
    let Some(size) = smallest_size(model, poses, z + depth) else {
        return;
    };
    if depth > DEEPEST * size {
        let weight = -poses.tree.moving_mass() * model.world.gravity.z;
        let message = format!(
            "the robot sinks {:.1} mm into the ground under its weight of {:.3} N, on link '{}': the \
             smallest size of what it stands on is {:.1} mm",
            1e3 * depth,
            weight,
            model.links[link.index()].name,
            1e3 * size
        );
        let help = format!(
            "{key} makes its contacts so soft; a penetration below {:.1e} m, or a stiffness above \
             {:.1e} N/m, keeps it on the ground",
            model.contact.penetration.min(DEEPEST * size),
            weight / (DEEPEST * size)
        );
        findings.warning("A145", None, message, &help);
    }
}

/// What says how soft the contacts of a link are; none where it is what it usually is.
fn softness(model: &Model, settings: &Settings, link: LinkId) -> Option<String> {
    let link = &model.links[link.index()];
    if let Some(k) = link.stiffness {
        let mut entries = settings.links.iter().rev();
        let entry = entries.find(|e| e.stiffness.is_some() && e.link.matches(&link.name));
        return Some(match entry {
            Some(entry) => format!("[link.\"{}\"] stiffness = {}", entry.link.text, Digits(k)),
            None => "<stiffness> in the <contact> of the link".to_owned(),
        });
    }
    if let Some(k) = model.contact.stiffness {
        return Some(format!("[contact] stiffness = {}", Digits(k)));
    }
    let own = Settings::of(settings.compat).contact.penetration;
    let set = model.contact.penetration;
    (set > own).then(|| format!("[contact] penetration = {}", Digits(set)))
}

/// The smallest size of the shapes that reach below a height over the base's origin, m, along their
/// own axes; none where they are points.
fn smallest_size(model: &Model, poses: &Poses, height: f64) -> Option<f64> {
    let base = poses.base_height(model);
    let below = model.colliders.iter().filter(|collider| {
        let X = poses.collider(model, collider);
        collider.shape.lowest(&X, &Vec3::z()) - base <= height
    });
    let sizes = below.flat_map(|collider| sizes(&collider.shape));
    sizes.filter(|size| *size > THINNEST).reduce(f64::min)
}

fn sizes(shape: &Shape) -> [f64; 3] {
    [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| shape.depth(&axis) + shape.depth(&-axis))
}
