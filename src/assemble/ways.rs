//! Options that give inertia to links without it: each is tried before it is offered.
//!
//! A file that was made for drawing only has no masses at all. A user who follows the advice must
//! not get the same error for the next link.

use super::findings::{Findings, listed};
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::Model;
use crate::settings::{Compat, InertiaSource, JointSettings, Settings};
use crate::urdf::solids::of_density;
use crate::urdf::{Description, LinkDescription};

/// Density that is offered, kg/m³: most robot parts are between plastics and hollow metal.
const DENSITY: f64 = 1000.0;

/// Rotor inertia that is offered for joints that move nothing but frames, kg·m² or kg.
const ARMATURE: f64 = 1e-4;

/// Makes a model, or says what is wrong.
pub(super) type Assemble = fn(&Description, &Settings, &mut Findings) -> Option<Model>;

/// Adds the ways that work to the finding on links without inertia.
pub(super) fn offer(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) {
    let Some(at) = findings.list.iter().position(is_of_inertia) else {
        return;
    };
    let density = by_density(assemble, description, settings, &findings.list);
    let pybullet = by_pybullet(assemble, description, settings, &findings.list);
    // What needs no settings file comes first.
    let partial = density.as_ref().is_some_and(|way| way.contains("armature"));
    let ways = if partial {
        [pybullet, density]
    } else {
        [density, pybullet]
    };
    let ways: Vec<String> = ways.into_iter().flatten().collect();
    if let Some(help) = &mut findings.list[at].help
        && !ways.is_empty()
    {
        *help = format!(
            "without a change of the file there {}\n{}\n{help}",
            if ways.len() > 1 {
                "are two ways:"
            } else {
                "is one way:"
            },
            ways.join("\n")
        );
    }
}

/// Whether a finding is about inertia that is missing.
fn is_of_inertia(finding: &Diagnostic) -> bool {
    finding.severity == Severity::Error && ["A104", "A105"].contains(&finding.code)
}

/// None where it helps, whatever else is wrong; else the joints along which nothing has inertia
/// even so.
///
/// - `known`: what is found without it
fn left(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    known: &[Diagnostic],
) -> Option<Vec<String>> {
    let mut findings = Findings::new(description);
    let model = assemble(description, settings, &mut findings);
    let of_way = |finding: &Diagnostic| {
        is_of_inertia(finding) || finding.severity == Severity::Error && !known.contains(finding)
    };
    let fails = model.is_none() || findings.list.iter().any(of_way);
    fails.then(|| std::mem::take(&mut findings.unmoved))
}

fn by_density(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    known: &[Diagnostic],
) -> Option<String> {
    let weighs = |link: &LinkDescription| {
        link.inertial.is_none_or(|own| own.mass <= 0.0)
            && of_density(DENSITY, &link.collisions).is_some()
    };
    if settings.density.is_some() || !description.links.iter().any(weighs) {
        return None;
    }
    let mut tried = Settings {
        density: Some(DENSITY),
        ..settings.clone()
    };
    // Where some links have masses, their inertias are the file's.
    let massless = description
        .links
        .iter()
        .all(|link| link.inertial.is_none_or(|own| own.mass <= 0.0));
    let options = if massless && settings.inertia == InertiaSource::Urdf {
        tried.inertia = InertiaSource::Collision;
        format!("--inertia collision --density {DENSITY}")
    } else {
        format!("--density {DENSITY}")
    };
    let keys = if tried.inertia == settings.inertia {
        format!("density = {DENSITY}")
    } else {
        format!("inertia = \"collision\" and density = {DENSITY}")
    };
    let way = format!(
        "  masses from the collision shapes and a density: {options} (in the settings [robot] {keys})"
    );
    let joints = match left(assemble, description, &tried, known) {
        None => return Some(way),
        Some(joints) if joints.is_empty() => return None,
        Some(joints) => joints,
    };
    for joint in &joints {
        tried.joints.push(JointSettings {
            armature: Some(ARMATURE),
            ..JointSettings::new(joint)
        });
    }
    let all = joints
        .iter()
        .map(|joint| format!("[joint.\"{joint}\"] armature = {ARMATURE:e}"));
    let all: Vec<String> = all.collect();
    left(assemble, description, &tried, known)
        .is_none()
        .then(|| {
            format!(
                "{way},\n  and rotor inertia for what has no volume ({}), in the settings: {}",
                listed(&joints),
                all.join(", ")
            )
        })
}

fn by_pybullet(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    known: &[Diagnostic],
) -> Option<String> {
    if settings.compat == Compat::PyBullet {
        return None;
    }
    let defaults = Settings::of(Compat::PyBullet);
    let tried = Settings {
        compat: Compat::PyBullet,
        inertia: defaults.inertia,
        ..settings.clone()
    };
    left(assemble, description, &tried, known).is_none().then(|| {
        "  1 kg for each link without <inertial>, and all else as PyBullet does: --compat pybullet"
            .to_owned()
    })
}
