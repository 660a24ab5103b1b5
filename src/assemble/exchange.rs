//! What Model Exchange has no equations for.

use super::findings::Findings;
use crate::continuous::States;
use crate::model::Model;
use crate::parameters::Parameters;
use crate::tree::Tree;
use crate::tuning::MOST_STATES;

/// Tells what of a model that is to be exchanged needs an event, a sample, or more states than an
/// importer can work with.
pub(super) fn check(model: &Model, findings: &mut Findings) {
    if !model.outputs.interface.exchanges() {
        return;
    }
    let mut refuse = |message: String, help: &str| findings.error("A142", None, message, help);
    let bouncing = model.links.iter().find(|link| link.restitution > 0.0);
    let ground = model.world.ground.as_ref();
    let ground = ground.is_some_and(|ground| ground.restitution > 0.0);
    if bouncing.is_some() || ground {
        let owner = bouncing.map_or_else(
            || "the ground".to_owned(),
            |link| format!("link '{}'", link.name),
        );
        refuse(
            format!("{owner} has a restitution, and in Model Exchange a rebound is an event"),
            "set restitution to 0 and choose contact dissipation, or export with --interface cs",
        );
    }
    for sensor in &model.outputs.sensors {
        if !sensor.sampling.is_ideal() {
            refuse(
                format!(
                    "sensor '{}' takes samples or errs, and in Model Exchange outputs follow the \
                     states",
                    sensor.name
                ),
                "leave out its rate, bias and noise, or export with --interface cs",
            );
        }
    }
    if let Some(root) = model.outputs.driven.first() {
        refuse(
            format!(
                "object '{}' is driven, and Model Exchange has no steps at whose ends it would \
                 have the velocity of its inputs",
                model.roots[root.index()].name
            ),
            "leave out driven, or export with --interface cs",
        );
    }
    if let Some(part) = model.loops.first() {
        refuse(
            format!(
                "loop '{}' closes a chain, and Model Exchange has no equations for closed loops",
                part.name
            ),
            "leave the loop out, or export with --interface cs",
        );
    }
    let tree = Tree::new(model, &Parameters::new(model));
    let states = States::new(model, &tree).len();
    if states > MOST_STATES {
        let own = if model.roots.iter().any(|root| root.self_collision) {
            "set robot.self_collision = false, "
        } else {
            ""
        };
        refuse(
            format!(
                "the model has {states} continuous states, most of them of pairs of shapes that may \
                 touch; importers factor matrices of that size, and at most {MOST_STATES} are \
                 exported"
            ),
            &format!(
                "{own}leave out pairs by ignore_contact, use fewer shapes, or export with \
                 --interface cs"
            ),
        );
    }
}
