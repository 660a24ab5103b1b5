//! One robot or object by itself.

use super::findings::Findings;
use super::robot::Robot;
use super::{
    actuators, base, bodies, exchange, idle, inertia, initial, loops, mimic, outputs, pairs,
    sensors, sink, touch, ways, wheels,
};
use crate::diagnostic::Diagnostic;
use crate::diagnostic::gravity::{self, Unusual};
use crate::digits::Digits;
use crate::model::{BodyId, Initial, Model, OutputSelection, Root, RootId, World};
use crate::settings::Settings;
use crate::urdf::Description;

/// A robot, ready to simulate.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The robot.
    pub model: Model,
    /// Notes and warnings: what was assumed.
    pub diagnostics: Vec<Diagnostic>,
}

/// Builds the model of a described robot.
///
/// [`Settings::scale`] and [`Settings::inertia`] concern the reader too, see
/// [`super::read_options`].
///
/// # Errors
/// Everything that is wrong, with the notes and warnings found on the way.
pub fn build(description: &Description, settings: &Settings) -> Result<Assembled, Vec<Diagnostic>> {
    match attempt(description, settings) {
        (Some(model), mut diagnostics, false) => {
            diagnostics.extend(idle::of_world(&model, settings));
            Ok(Assembled { model, diagnostics })
        }
        (_, findings, _) => Err(findings),
    }
}

/// The model as far as there is one, what is found, and whether it is in the way of a model.
pub(super) fn attempt(
    description: &Description,
    settings: &Settings,
) -> (Option<Model>, Vec<Diagnostic>, bool) {
    let mut findings = Findings::new(description);
    let model = assemble(description, settings, &mut findings);
    let failed = model.is_none() || findings.has_errors();
    if failed {
        ways::offer(assemble, description, settings, &mut findings);
    }
    (model, findings.list, failed)
}

/// What can be told of a robot that has faults, and the model as far as there is one.
pub fn inspect(description: &Description, settings: &Settings) -> (Option<Model>, Vec<Diagnostic>) {
    let mut findings = Findings::new(description);
    let model = assemble(description, settings, &mut findings);
    (model, findings.list)
}

/// None only after an error was reported; where there is a model, errors may have been reported,
/// too.
fn assemble(
    description: &Description,
    settings: &Settings,
    findings: &mut Findings,
) -> Option<Model> {
    let mut robot = Robot::new(description, settings, findings);
    let base = base::choose_base(&mut robot, settings, findings);
    // A fault is told, and what is left goes on, so that the others are told with it.
    mimic::resolve(&mut robot, findings);
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
        loops: Vec::new(),
        springs: Vec::new(),
        actuators: Vec::new(),
        initial: Initial::default(),
        solver: settings.solver.clone(),
        contact: settings.contact.clone(),
        world: settings.world.clone(),
        outputs: OutputSelection {
            flat_names: settings.flat_names,
            arrays: settings.fmu.arrays,
            interface: settings.fmu.interface,
            // From the start: what is driven needs no mass, and no force moves it.
            driven: settings.driven.then_some(RootId(0)).into_iter().collect(),
            ..OutputSelection::default()
        },
    };
    bodies::add(&mut model, &base, &robot.shapes, findings);
    let polygons = wheels::fit(&mut model, &robot.shapes, &robot.wheels, findings);
    bodies::center(&mut model);
    initial::joints(&mut model, settings, findings);
    initial::base(&mut model, &base, settings, findings);
    if let Err(error) = model.validate() {
        let help = "make what is named smaller or simpler, or correct its numbers";
        findings.error("A121", None, error.to_string(), help);
        return None;
    }
    // Names that match nothing do not keep the others from being looked up.
    let mut places = loops::of_file(&mut model, description, findings);
    loops::select(&mut model, settings, &mut places, findings);
    let given = loops::given(&model, settings, "");
    if !findings.has_errors() {
        loops::close(&mut model, &given, (&places, true), findings);
    }
    let poses = initial::poses(&model);
    let (shapes, tags) = (&robot.shapes, &robot.tags);
    let poses = inertia::complete(&mut model, poses, shapes, tags, settings, findings);
    initial::height(&mut model, &poses, settings, findings);
    sink::warn(&model, &poses, settings, findings);
    warn_of_gravity(&model.world, findings);
    idle::report(&model, &robot.shapes, settings, findings);
    idle::of_actuators(&model, settings, findings);
    actuators::add(&mut model, &poses, &robot.tags, settings, findings);
    actuators::report_velocity_limits(&model, findings);
    wheels::warn(&model, &poses, &polygons, findings);
    if !findings.has_errors() {
        loops::close(&mut model, &given, (&places, false), findings);
    }
    outputs::select(&mut model, settings, findings);
    let described = &description.sensors;
    idle::of_described_sensors(description, settings, findings);
    sensors::select(&mut model, described, &settings.sensors, findings);
    touch::select(&mut model, settings, findings);
    pairs::select(&mut model, &settings.pairs, findings);
    if !findings.has_errors()
        && let Err(error) = model.validate()
    {
        let help = "make what is named smaller or simpler, or correct its numbers";
        findings.error("A121", None, error.to_string(), help);
    }
    if !findings.has_errors() {
        exchange::check(&model, findings);
    }
    Some(model)
}

/// Warns of gravity that is nearly always meant otherwise.
fn warn_of_gravity(world: &World, findings: &mut Findings) {
    let g = &world.gravity;
    let [x, y, z] = [g.x, g.y, g.z].map(Digits);
    let Some(unusual) = gravity::unusual((*g).into(), world.ground.is_some()) else {
        return;
    };
    let help = match unusual {
        Unusual::Upwards => format!(
            "write gravity = [{x}, {y}, -{z}] in [world]; what hangs from a ceiling is turned by \
             [initial] rpy = [3.14159265, 0, 0] instead"
        ),
        Unusual::AlongY => format!(
            "write gravity = [0, 0, -{}] in [world]; without a ground, [world.ground] type = \
             \"none\", it may point anywhere",
            Digits(g.norm())
        ),
        Unusual::Unit(_) => "write gravity = [0, 0, -9.81] in [world]".to_owned(),
    };
    let message = format!("gravity {unusual}: it is [{x}, {y}, {z}] m/s², and z is up");
    findings.warning("A143", None, message, &help);
}
