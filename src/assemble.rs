//! Description and settings → [`Model`]: bodies, mimic joints, defaults, initial pose.
//!
//! In: [`Description`] (checked URDF, lengths already scaled, see [`crate::urdf::ReadOptions`]) and
//! [`Settings`]. Out: [`Model`] and every assumption that was taken, as notes.
//!
//! - Links joined by fixed joints are one body; each keeps its frame (`Link::X_BL`). A body's frame
//!   is the frame of the link that its joint carries.
//! - A planar joint is a chain of two sliding and one turning body. With the normal `n` these slide
//!   along `u` and `n × u`; `u` is the part of a coordinate axis in the plane: x for a normal along
//!   z, y for x, z for y. A floating joint slides along x, y, z and then turns freely.
//! - A spherical joint is one body that turns freely; it has no actuator.
//! - A massless root whose only joint is floating is the world: root and joint are left out, the
//!   child is a floating base.
//! - Mimic joints share the coordinate of the last joint of their chain.
//! - A mesh on a continuous joint that is round about it becomes a cylinder or a ball.
//! - A moving link may be massless if its children give every degree of freedom inertia.
//!
//! Not done here: reading files, scaling, solving.
//!
//! | code | about |
//! |---|---|
//! | A101 | a name or glob that matches nothing |
//! | A102 | a name or glob that means something unsuitable |
//! | A103 | mimic |
//! | A104 | a moving link without inertia |
//! | A105 | a floating base without mass |
//! | A106 | an initial value outside the limits |
//! | A107 | how the base was chosen |
//! | A108 | merged links |
//! | A109 | massless moving links |
//! | A110 | joint zero outside the limits |
//! | A111 | initial height |
//! | A112 | a start inside the ground |
//! | A113 | effort limits that the file does not give |
//! | A114 | effort limits of zero |
//! | A115 | velocity limits of zero |
//! | A116 | friction that the file does not give |
//! | A117 | position limits that are no range |
//! | A118 | limits narrowed by mimic joints |
//! | A119 | inertia from the collision shapes |
//! | A120 | gains |
//! | A121 | a model that cannot be computed with |
//! | A122 | damping and friction of planar and floating joints |
//! | A123 | a singular inertia replaced by that of the shapes |
//! | A124 | velocity limits that do not bind |
//! | A125 | friction at rest that does not go with sliding friction |
//! | A126 | commands that the file's hardware takes |
//! | A127 | wheels fitted to meshes |
//! | A128 | driven wheels that are polygons |
//! | A130 | groups |
//! | A131 | sensors |
//! | A132 | masses that the conventions of another simulator give |
//! | A133 | links of one robot that overlap before anything moves |

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod actuators;
mod bodies;
mod findings;
mod inertia;
mod initial;
mod masses;
mod mimic;
mod outputs;
mod pybullet;
mod robot;
mod solids;
mod touch;
mod wheels;

use crate::diagnostic::Diagnostic;
use crate::model::{BodyId, Initial, Model, OutputSelection, Root};
use crate::settings::{Compat, InertiaSource, Settings};
use crate::urdf::{Description, ReadOptions};
use findings::Findings;
use robot::Robot;

/// A robot, ready to simulate.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The robot.
    pub model: Model,
    /// Notes and warnings: what was assumed.
    pub diagnostics: Vec<Diagnostic>,
}

/// What the settings mean for the reader of the URDF: `options` with scale, source of inertia and
/// links whose meshes become several parts.
pub fn read_options(settings: &Settings, options: ReadOptions) -> ReadOptions {
    ReadOptions {
        scale: settings.scale,
        ignore_inertia: settings.inertia != InertiaSource::Urdf,
        pybullet: settings.compat == Compat::PyBullet
            || settings.inertia == InertiaSource::PyBullet,
        decomposed: settings
            .links
            .iter()
            .filter_map(|entry| Some((entry.link.clone(), entry.decompose?)))
            .collect(),
        ..options
    }
}

/// Builds the model of a described robot.
///
/// [`Settings::scale`] and [`Settings::inertia`] concern the reader too, see [`read_options`].
///
/// # Errors
/// Everything that is wrong, with the notes and warnings found on the way.
pub fn build(description: &Description, settings: &Settings) -> Result<Assembled, Vec<Diagnostic>> {
    let mut findings = Findings::new(description);
    let model = assemble(description, settings, &mut findings);
    match model {
        Some(model) if !findings.has_errors() => Ok(Assembled {
            model,
            diagnostics: findings.list,
        }),
        _ => Err(findings.list),
    }
}

/// None only after an error was reported.
fn assemble(
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) -> Option<Model> {
    let mut robot = Robot::new(description, settings, findings);
    let base = bodies::choose_base(&mut robot, settings, findings);
    mimic::resolve(&mut robot, findings);
    if findings.has_errors() {
        return None;
    }
    let mut model = Model {
        name: robot.name,
        links: robot.links,
        joints: robot.joints,
        bodies: Vec::new(),
        roots: vec![Root::new(String::new(), BodyId(0))],
        dofs: Vec::new(),
        nq: 0,
        colliders: Vec::new(),
        apart: Vec::new(),
        actuators: Vec::new(),
        initial: Initial::default(),
        solver: settings.solver.clone(),
        contact: settings.contact.clone(),
        world: settings.world.clone(),
        outputs: OutputSelection {
            flat_names: settings.flat_names,
            ..OutputSelection::default()
        },
    };
    bodies::add(&mut model, &base, &robot.shapes, findings);
    let polygons = wheels::fit(&mut model, &robot.shapes, &robot.wheels, findings);
    initial::joints(&mut model, settings, findings);
    initial::base(&mut model, &base, settings, findings);
    if let Err(error) = model.validate() {
        let help = "make what is named smaller or simpler, or correct its numbers";
        findings.error("A121", None, error.to_string(), help);
    }
    if findings.has_errors() {
        return None;
    }
    let poses = initial::poses(&model);
    let poses = inertia::complete(&mut model, poses, &robot.shapes, &robot.lines, findings);
    initial::height(&mut model, &poses, settings, findings);
    actuators::add(&mut model, &poses, &robot.lines, settings, findings);
    actuators::report_velocity_limits(&model, findings);
    wheels::warn(&model, &poses, &polygons, findings);
    outputs::select(&mut model, settings, findings);
    touch::select(&mut model, settings, findings);
    if !findings.has_errors()
        && let Err(error) = model.validate()
    {
        let help = "make what is named smaller or simpler, or correct its numbers";
        findings.error("A121", None, error.to_string(), help);
    }
    Some(model)
}

#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
