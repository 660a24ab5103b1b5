//! What is selected as output or input: links, pairs, groups, sensors.

use super::check::{Check, pose, positive, require, unit};
use crate::model::{
    ActuatorMode, Interface, JointId, JointKind, LinkId, Model, RootId, SensorKind,
};
use std::collections::BTreeSet;

/// Most rays of one sensor.
const MOST_RAYS: usize = 10_000;
/// Most pairs with outputs: contacts are compared with each of them.
const MOST_PAIRS: usize = 1_000;

#[cfg_attr(small, optimize(size))]
pub(super) fn validate(model: &Model) -> Check {
    let outputs = &model.outputs;
    for list in [
        &outputs.contacts,
        &outputs.links,
        &outputs.external_wrenches,
    ] {
        let mut seen = BTreeSet::new();
        require(
            list.iter()
                .all(|link| link.index() < model.links.len() && seen.insert(*link)),
            || "the selection of outputs".to_owned(),
            "names a link twice or one that does not exist",
        )?;
    }
    let stands = |id: &RootId| {
        let root = model.roots.get(id.index());
        let body = root.and_then(|root| model.bodies.get(root.body.index()));
        body.is_some_and(|body| !body.motion.kind().moves())
    };
    require(
        outputs.conveyors.iter().all(stands),
        || "the selection of inputs".to_owned(),
        "gives something that moves a surface that moves",
    )?;
    let floats = |id: &RootId| {
        let root = model.roots.get(id.index());
        let body = root.and_then(|root| model.bodies.get(root.body.index()));
        body.is_some_and(|body| body.motion.kind().is_free())
    };
    require(
        outputs.driven.iter().all(floats),
        || "the selection of inputs".to_owned(),
        "drives something that stands still",
    )?;
    let rising = outputs.driven.is_sorted_by(|a, b| a < b);
    require(
        rising && (outputs.driven.is_empty() || outputs.interface == Interface::Cs),
        || "the selection of inputs".to_owned(),
        "drives something twice, or in Model Exchange",
    )?;
    pairs(model)?;
    groups(model)?;
    sensors(model)
}

fn pairs(model: &Model) -> Check {
    let pairs = &model.outputs.pairs;
    require(
        pairs.len() <= MOST_PAIRS,
        || "the selection of outputs".to_owned(),
        "has more than 1000 pairs",
    )?;
    let mut names = BTreeSet::new();
    for pair in pairs {
        let part = || format!("pair '{}'", pair.name);
        let new = names.insert(pair.name.as_str());
        require(new, part, "has the name of another pair")?;
        let [first, second] = &pair.sides;
        let exists = |link: &Option<LinkId>| link.is_none_or(|l| l.index() < model.links.len());
        for side in [first, second] {
            require(
                !side.is_empty() && side.is_sorted_by(|a, b| a < b) && side.iter().all(exists),
                part,
                "has a side that is empty, or names a link twice, out of order or one that does not exist",
            )?;
        }
        require(
            !first.iter().any(|link| second.binary_search(link).is_ok()),
            part,
            "has a link on both sides",
        )?;
    }
    Ok(())
}

fn groups(model: &Model) -> Check {
    let mut grouped = BTreeSet::new();
    for group in &model.outputs.groups {
        let part = || format!("group '{}'", group.name);
        let members = &group.actuators;
        require(
            !members.is_empty()
                && members.is_sorted_by(|a, b| a < b)
                && members
                    .iter()
                    .all(|a| a.index() < model.actuators.len() && grouped.insert(*a)),
            part,
            "names an actuator twice, out of order or one that does not exist",
        )?;
        let all: Vec<_> = members
            .iter()
            .map(|a| &model.actuators[a.index()])
            .collect();
        let slides = |joint: JointId| model.joints[joint.index()].kind == JointKind::Prismatic;
        let start = |joint: JointId| model.initial.joint_positions[joint.index()].to_bits();
        require(
            all.windows(2).all(|pair| {
                pair[0].mode == pair[1].mode
                    && slides(pair[0].joint) == slides(pair[1].joint)
                    && pair[0].max_effort.to_bits() == pair[1].max_effort.to_bits()
                    && (pair[0].mode != ActuatorMode::Position && pair[0].mode != ActuatorMode::Pd
                        || start(pair[0].joint) == start(pair[1].joint))
            }),
            part,
            "has actuators of different kinds or start values",
        )?;
    }
    Ok(())
}

fn sensors(model: &Model) -> Check {
    for sensor in &model.outputs.sensors {
        let part = || format!("sensor '{}'", sensor.name);
        let exists = |link: &LinkId| link.index() < model.links.len();
        require(
            exists(&sensor.link),
            part,
            "is on a link that does not exist",
        )?;
        pose(&sensor.X_LS, part)?;
        match &sensor.kind {
            SensorKind::Imu => {}
            SensorKind::ForceTorque { joint, .. } => require(
                joint.index() < model.joints.len(),
                part,
                "is in a joint that does not exist",
            )?,
            SensorKind::Ray {
                directions,
                columns,
                near,
                range,
                hits: _,
                ignored,
            } => {
                require(
                    directions.len() <= MOST_RAYS
                        && directions.iter().all(unit)
                        && *columns > 0
                        && directions.len().is_multiple_of(*columns as usize),
                    part,
                    "has a ray that is none, or too many",
                )?;
                require(
                    positive(*range) && *near >= 0.0 && near < range,
                    part,
                    "has a range that is none",
                )?;
                require(
                    ignored.is_sorted_by(|a, b| a < b) && ignored.iter().all(exists),
                    part,
                    "ignores a link that does not exist, or links out of order",
                )?;
            }
            SensorKind::Encoder { joint, step } => require(
                joint.index() < model.joints.len()
                    && model.scalar_body(*joint).is_some()
                    && positive(*step),
                part,
                "is in a joint that it cannot be in, or has a step that is none",
            )?,
            SensorKind::Contact { half } => require(
                half.is_none_or(|half| half.iter().all(|&x| positive(x))),
                part,
                "has a size that is none",
            )?,
        }
        let (sampling, (_, erring)) = (&sensor.sampling, sensor.erring());
        let fits = |list: &[f64]| list.is_empty() || list.len() == erring;
        require(
            sampling.rate.is_none_or(positive)
                && fits(&sampling.bias)
                && sampling.bias.iter().all(|x| x.is_finite())
                && fits(&sampling.noise)
                && sampling.noise.iter().all(|x| x.is_finite() && *x >= 0.0)
                && (sampling.rate.is_some() || !sampling.is_noisy()),
            part,
            "has a rate, a bias or a noise out of range",
        )?;
    }
    Ok(())
}
