//! Mass and rotational inertia of links, as file and settings give them.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::{Findings, counted, listed};
use super::{idle, pybullet};
use crate::settings::{Compat, InertiaSource, LinkSettings, Settings};
use crate::spatial::{Mat3, Pose, RigidInertia, Vec3};
use crate::urdf::solids::{of_density, of_solids};
use crate::urdf::{Description, LinkDescription};

/// What a link without mass weighs by the density that the settings give.
pub(super) fn weighed(link: &LinkDescription, settings: &Settings) -> Option<RigidInertia> {
    let density = settings.density?;
    let massless = link.inertial.is_none_or(|own| own.mass <= 0.0);
    massless
        .then(|| of_density(density, &link.collisions))
        .flatten()
}

/// The file's inertia, or the mass that the settings or the conventions give a link without one.
pub(super) fn given_inertia(link: &LinkDescription, settings: &Settings) -> Option<RigidInertia> {
    weighed(link, settings).or(link.inertial).or_else(|| {
        let mass = settings.compat.missing_mass(&link.name)?;
        // PyBullet's own inertia of such a link, where it is asked not to compute one.
        let I_cm = Mat3::identity();
        let com = Vec3::zeros();
        Some(RigidInertia { mass, com, I_cm })
    })
}

/// Which links have a mass that their file does not give.
pub(super) fn report_missing_masses(
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) {
    let dense: Vec<(&str, f64)> = description
        .links
        .iter()
        .filter_map(|link| Some((link.name.as_str(), weighed(link, settings)?.mass)))
        .collect();
    if dense.is_empty() {
        idle::of_density(settings, findings);
    } else {
        let names: Vec<&str> = dense.iter().map(|&(name, _)| name).collect();
        let total: f64 = dense.iter().map(|(_, mass)| mass).sum();
        let message = format!(
            "{} without mass in the file {} what the collision shapes weigh as solids of {} kg/m³, \
             {total:.4} kg together: {}",
            counted(names.len(), "link"),
            if names.len() == 1 { "weighs" } else { "weigh" },
            settings.density.unwrap_or_default(),
            listed(&names)
        );
        findings.note("A138", message, "[link.\"…\"] mass sets the mass of one");
    }
    let names: Vec<&str> = description
        .links
        .iter()
        .filter(|link| link.inertial.is_none() && weighed(link, settings).is_none())
        .filter(|link| given_inertia(link, settings).is_some())
        .map(|link| link.name.as_str())
        .collect();
    if !names.is_empty() {
        let message = format!(
            "{} without <inertial> {} 1 kg, as in PyBullet: {}",
            counted(names.len(), "link"),
            if names.len() == 1 { "weighs" } else { "weigh" },
            listed(&names)
        );
        findings.note("A132", message, "give the link an <inertial>");
    }
}

/// The file's inertia, its mass replaced and its tensor recomputed where the settings want it.
pub(super) fn link_inertia(
    link: &LinkDescription,
    overrides: &LinkSettings,
    settings: &Settings,
    findings: &mut Findings,
) -> RigidInertia {
    let Some(mut inertia) = given_inertia(link, settings) else {
        return RigidInertia::ZERO;
    };
    if inertia.mass <= 0.0 {
        return match settings.inertia {
            InertiaSource::Urdf | InertiaSource::Nearest => inertia,
            InertiaSource::Collision | InertiaSource::PyBullet => RigidInertia::ZERO,
        };
    }
    if let Some(mass) = overrides.mass {
        inertia.I_cm *= mass / inertia.mass;
        inertia.mass = mass;
    }
    if settings.inertia == InertiaSource::PyBullet {
        let X_LI = Pose {
            R: link.R_LI,
            p: inertia.com,
        };
        inertia.I_cm = pybullet::inertia(inertia.mass, &X_LI, &link.collisions);
    }
    if settings.inertia == InertiaSource::PyBullet || settings.compat == Compat::PyBullet {
        inertia.I_cm *= link.inertia_scaling.unwrap_or(1.0);
    }
    if settings.inertia == InertiaSource::Collision {
        match of_solids(inertia.mass, &link.collisions) {
            Some(I_cm) => inertia.I_cm = I_cm,
            None if link.collisions.is_empty() => {
                let message = format!(
                    "link '{}' has no collision shape: its inertia is the file's",
                    link.name
                );
                findings.note("A119", message, "");
            }
            None => {
                let names: Vec<_> = link
                    .collisions
                    .iter()
                    .filter_map(|c| c.mesh.as_ref())
                    .collect();
                let names: Vec<_> = names
                    .iter()
                    .map(|path| path.display().to_string())
                    .collect();
                let message = format!(
                    "the collision shapes of link '{}' have no volume ({}): its inertia is the file's",
                    link.name,
                    listed(&names)
                );
                findings.warning("A119", findings.tag(&link.tag), message, "");
            }
        }
    }
    inertia
}
