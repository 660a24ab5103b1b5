//! Options that give inertia to links without it: each is tried before it is offered.
//!
//! A file that was made for drawing only has no masses at all. A user who follows the advice must
//! not get the same error for the next link.

use super::findings::Findings;
use super::inertia::{SUGGESTED_DENSITY, SUGGESTED_MASS};
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::Model;
use crate::settings::{Compat, Settings};
use crate::urdf::solids::of_density;
use crate::urdf::{Description, LinkDescription};

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
    let ways = [
        by_masses(assemble, description, settings, &findings.list),
        by_pybullet(assemble, description, settings, &findings.list),
    ];
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

/// Whether settings help, whatever else is wrong.
///
/// - `known`: what is found without them
fn helps(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    known: &[Diagnostic],
) -> bool {
    let mut findings = Findings::new(description);
    let model = assemble(description, settings, &mut findings);
    let of_way = |finding: &Diagnostic| {
        is_of_inertia(finding) || finding.severity == Severity::Error && !known.contains(finding)
    };
    model.is_some() && !findings.list.iter().any(of_way)
}

/// A density for what has shapes, a mass for what has none.
fn by_masses(
    assemble: Assemble,
    description: &Description,
    settings: &Settings,
    known: &[Diagnostic],
) -> Option<String> {
    let weighs = |link: &LinkDescription| {
        link.inertial.is_none_or(|own| own.mass <= 0.0)
            && of_density(SUGGESTED_DENSITY, &link.collisions).is_some()
    };
    let shaped = settings.density.is_none() && description.links.iter().any(weighs);
    let density = Settings {
        density: Some(SUGGESTED_DENSITY),
        ..settings.clone()
    };
    let (d, m) = (SUGGESTED_DENSITY, SUGGESTED_MASS);
    if shaped && helps(assemble, description, &density, known) {
        return Some(format!(
            "  masses from the collision shapes and a density: --density {d} (in the settings \
             [robot] density = {d})"
        ));
    }
    let both = Settings {
        missing_mass: Some(m),
        ..if shaped { density } else { settings.clone() }
    };
    if settings.missing_mass.is_some() || !helps(assemble, description, &both, known) {
        return None;
    }
    Some(if shaped {
        format!(
            "  masses from the collision shapes and a density, and {m} kg for each link that cannot \
             move even so: --density {d} --missing-mass {m} (in the settings [robot] density = {d} \
             and missing_mass = {m})"
        )
    } else {
        format!(
            "  {m} kg for each link that cannot move without: --missing-mass {m} (in the settings \
             [robot] missing_mass = {m})"
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
    helps(assemble, description, &tried, known).then(|| {
        "  1 kg for each link without <inertial>, and all else as PyBullet does: --compat pybullet"
            .to_owned()
    })
}
