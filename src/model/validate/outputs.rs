//! What is selected as output or input: links, groups, sensors.

use super::check::{Check, pose, positive, require, unit};
use crate::model::{ActuatorMode, JointId, JointKind, Model, SensorKind};
use std::collections::BTreeSet;

/// Most rays of one sensor.
const MOST_RAYS: usize = 10_000;

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
    groups(model)?;
    sensors(model)
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
        require(
            sensor.link.index() < model.links.len(),
            part,
            "is on a link that does not exist",
        )?;
        pose(&sensor.X_LS, part)?;
        match &sensor.kind {
            SensorKind::Imu => {}
            SensorKind::ForceTorque { joint } => require(
                joint.index() < model.joints.len(),
                part,
                "is in a joint that does not exist",
            )?,
            SensorKind::Ray { directions, range } => require(
                directions.len() <= MOST_RAYS && directions.iter().all(unit) && positive(*range),
                part,
                "has a ray or range that is none",
            )?,
        }
    }
    Ok(())
}
