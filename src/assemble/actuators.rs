//! Which joints are commanded, how, and with how much effort.

use super::findings::{Findings, counted, listed};
use super::initial::{Poses, reach};
use super::robot::{Tags, is_scalar, kind_name};
use crate::model::{Actuator, ActuatorMode, JointId, JointKind, Model};
use crate::range::Range;
use crate::settings::{ActuatorSettings, Compat, ModeChoice, Settings};
use crate::tuning::REFERENCE_GRAVITY;

/// Shortest lever of a default effort, m.
const SHORTEST_REACH: f64 = 0.1;

/// Smallest default effort, N·m or N, for a robot whose moving parts weigh nothing.
const SMALLEST_EFFORT: f64 = 1e-3;

/// Fills `model.actuators`: one for each independent turning or sliding joint that is not passive.
pub(super) fn add(
    model: &mut Model,
    poses: &Poses,
    tags: &Tags,
    settings: &Settings,
    findings: &mut Findings,
) {
    let chosen = choices(model, settings, findings);
    // Able to carry the whole robot at its full reach twice over, or ten times its weight.
    let weight = poses.tree.moving_mass() * REFERENCE_GRAVITY;
    let turning = (2.0 * weight * reach(model, poses).max(SHORTEST_REACH)).max(SMALLEST_EFFORT);
    let sliding = (10.0 * weight).max(SMALLEST_EFFORT);
    // The greatest that settings can give.
    let (_, unlimited) = Range::LimitSize.bounds();
    let (mut without, mut without_gains, mut powerless) = (Vec::new(), Vec::new(), Vec::new());
    let mut other_interface: Vec<(ActuatorMode, &str)> = Vec::new();
    for (j, choice) in chosen.iter().enumerate() {
        let joint = &model.joints[j];
        let id = JointId::from(j);
        let (Some(body), None) = (model.scalar_body(id), joint.mimic) else {
            continue;
        };
        let mode = choice.mode.or(settings.default_mode).unwrap_or({
            ModeChoice::Commanded(
                if joint.limits.is_some() && settings.compat == Compat::None {
                    ActuatorMode::Position
                } else {
                    ActuatorMode::Velocity
                },
            )
        });
        let ModeChoice::Commanded(mode) = mode else {
            continue;
        };
        if let [first, ..] = tags.interfaces[j][..]
            && choice.mode.or(settings.default_mode).is_none()
            && !tags.interfaces[j].contains(&mode)
        {
            other_interface.push((first, &joint.name));
        }
        let default = round(if joint.kind == JointKind::Prismatic {
            sliding
        } else {
            turning
        });
        // PyBullet's motors do not know the file's limit.
        let file = settings.compat.motor_effort().or(joint.effort);
        let given = choice.max_effort.or(file);
        let limited = mode != ActuatorMode::Effort || choice.no_load_speed.is_some();
        if given.is_none() && limited {
            without.push(format!("{} = {default}", joint.name));
        }
        if given == Some(0.0) && mode != ActuatorMode::Effort && choice.max_effort.is_none() {
            powerless.push(j);
        }
        let gains = choice.kp.is_some() || choice.kd.is_some();
        if mode == ActuatorMode::Pd && !gains {
            without_gains.push(joint.name.clone());
        } else if mode != ActuatorMode::Pd && gains {
            let message = format!("the gains of joint '{}' are not used", joint.name);
            findings.warning("A120", None, message, "set mode = \"pd\"");
        }
        let positive = |value: &f64| *value > 0.0;
        model.actuators.push(Actuator {
            joint: id,
            dof: model.bodies[body.index()].dof,
            mode,
            max_effort: given.unwrap_or(if limited { default } else { unlimited }),
            reference_effort: given
                .filter(positive)
                .or(file.filter(positive))
                .unwrap_or(default),
            kp: choice.kp.unwrap_or(0.0),
            kd: choice.kd.unwrap_or(0.0),
            no_load_speed: choice.no_load_speed,
        });
    }
    if !without.is_empty() {
        let message = format!(
            "{} without effort limit can hold the whole robot outstretched: {}",
            counted(without.len(), "joint"),
            listed(&without).replace('\'', "")
        );
        let help = "set [[actuator]] max_effort; units are N·m and N";
        findings.note("A113", message, help);
    }
    if let [first, ..] = powerless[..] {
        let names: Vec<&str> = powerless
            .iter()
            .map(|&j| model.joints[j].name.as_str())
            .collect();
        let message = format!(
            "the motors of {} can do nothing until max_effort is set, because the effort limit is 0: {}",
            counted(names.len(), "joint"),
            listed(&names)
        );
        let help = "set [[actuator]] max_effort, or mode = \"none\"";
        findings.warning("A114", findings.tag(&tags.joints[first]), message, help);
    }
    report_interfaces(&other_interface, findings);
    if !without_gains.is_empty() {
        let message = format!(
            "pd mode without gains gives no effort of its own: {}",
            listed(&without_gains)
        );
        let help = "set [[actuator]] kp and kd, or the FMU's parameters of that name";
        findings.warning("A120", None, message, help);
    }
}

/// Tells which joints are commanded otherwise than the file's hardware does it.
fn report_interfaces(other_interface: &[(ActuatorMode, &str)], findings: &mut Findings) {
    for (mode, word) in [
        (ActuatorMode::Position, "position"),
        (ActuatorMode::Velocity, "velocity"),
        (ActuatorMode::Effort, "effort"),
    ] {
        let names: Vec<&str> = other_interface
            .iter()
            .filter(|(of, _)| *of == mode)
            .map(|(_, name)| *name)
            .collect();
        if !names.is_empty() {
            let message = format!(
                "the file's hardware takes {word} commands for {}, the FMU others: {}",
                counted(names.len(), "joint"),
                listed(&names)
            );
            let help =
                format!("--mode {word}, or [[actuator]] mode = \"{word}\", does as the hardware");
            findings.note("A126", message, &help);
        }
    }
}

/// Tells which velocity limits of the file do not bind.
pub(super) fn report_velocity_limits(model: &Model, findings: &mut Findings) {
    let servo = |id: JointId| {
        let mut actuators = model.actuators.iter();
        actuators.any(|a| a.joint == id && a.mode == ActuatorMode::Position)
    };
    let names: Vec<&str> = (0..)
        .map(JointId)
        .zip(&model.joints)
        .filter(|(id, joint)| joint.velocity.is_some() && !joint.enforce_velocity && !servo(*id))
        .map(|(_, joint)| joint.name.as_str())
        .collect();
    if !names.is_empty() {
        let message = format!(
            "the velocity limits of {} do not bind: {}",
            counted(names.len(), "joint"),
            listed(&names)
        );
        let help = "set [joint.\"…\"] enforce_velocity = true; position servos keep to it anyway";
        findings.note("A124", message, help);
    }
}

/// Three digits: a default should not look measured.
fn round(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(value)) - 2.0);
    let rounded = libm::round(value / unit) * unit;
    // Without the noise of the multiplication.
    format!("{rounded:.2e}").parse().unwrap_or(rounded)
}

/// What the settings say about each joint; each key is the last entry's that has it.
fn choices(model: &Model, settings: &Settings, findings: &mut Findings) -> Vec<ActuatorSettings> {
    let names: Vec<&str> = model.joints.iter().map(|j| j.name.as_str()).collect();
    let mut merged = vec![ActuatorSettings::new(""); names.len()];
    let unsuitable = |j: usize| {
        let joint = &model.joints[j];
        match joint.mimic {
            _ if !is_scalar(joint.kind) => Some(format!(
                "{}: only turning and sliding joints can be driven",
                kind_name(joint.kind)
            )),
            Some(mimic) => Some(format!(
                "follows '{}', which can be driven",
                model.joints[mimic.joint.index()].name
            )),
            None => None,
        }
    };
    for entry in &settings.actuators {
        for j in findings.select(&entry.joint, "joint", &names, unsuitable) {
            let choice = &mut merged[j];
            choice.mode = entry.mode.or(choice.mode);
            choice.max_effort = entry.max_effort.or(choice.max_effort);
            choice.kp = entry.kp.or(choice.kp);
            choice.kd = entry.kd.or(choice.kd);
            choice.no_load_speed = entry.no_load_speed.or(choice.no_load_speed);
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(
        clippy::float_cmp,
        reason = "the nearest double of three digits is meant"
    )]
    fn default_efforts_have_three_digits() {
        assert_eq!(round(1234.5), 1230.0);
        assert_eq!(round(0.001_239), 0.001_24);
        assert_eq!(round(99.96), 100.0);
    }
}
