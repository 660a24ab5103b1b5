//! Sensors of the settings → sensors of the model.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::findings::Findings;
use crate::digits::Digits;
use crate::geometry::Shape;
use crate::geometry::pair::{Patch, Solid};
use crate::model::{JointId, LinkId, Model, Sampling, Sensor, SensorKind};
use crate::pattern::Pattern;
use crate::settings::{Errors, Fan, SensorSettings, SensorSettingsKind};
use crate::spatial::{Pose, Vec3};
use crate::tuning::SENSED_BORDER;
use crate::urdf::{SensedKind, SensorDescription};
use crate::variables::identifier;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Adds sensors to the outputs of a model.
pub(super) fn select(
    model: &mut Model,
    described: &[SensorDescription],
    sensors: &[SensorSettings],
    findings: &mut Findings,
) {
    let described: Vec<_> = described.iter().map(of_description).collect();
    for settings in described.iter().chain(sensors) {
        if let Some(sensor) = sensor(model, settings, findings) {
            model.outputs.sensors.push(sensor);
        }
    }
}

/// A sensor of a URDF as the settings would say it.
fn of_description(sensor: &SensorDescription) -> SensorSettings {
    let fan = |&(count, angles): &(u32, [f64; 2])| Fan { count, angles };
    SensorSettings {
        name: Some(sensor.name.clone()),
        on: sensor.on.clone(),
        xyz: sensor.xyz,
        rpy: sensor.rpy,
        kind: match &sensor.kind {
            SensedKind::Imu => SensorSettingsKind::Imu,
            SensedKind::ForceTorque {
                in_parent,
                reversed,
            } => SensorSettingsKind::ForceTorque {
                in_parent: *in_parent,
                reversed: *reversed,
            },
            SensedKind::Ray {
                columns,
                rows,
                range: [near, range],
            } => SensorSettingsKind::Ray {
                columns: fan(columns),
                rows: fan(rows),
                near: *near,
                range: *range,
                hits: false,
                ignored: Vec::new(),
            },
            SensedKind::Contact => SensorSettingsKind::Contact { size: None },
        },
        rate: sensor.rate,
        seed: 1,
        errors: sensor
            .errors
            .iter()
            .map(|&[bias, noise]| Errors { bias, noise })
            .collect(),
    }
}

fn sensor(model: &Model, settings: &SensorSettings, findings: &mut Findings) -> Option<Sensor> {
    let index = part(model, settings, findings)?;
    let name = name(model, settings, index, findings)?;
    let mut link = LinkId::from(index);
    let kind = match &settings.kind {
        SensorSettingsKind::Imu => SensorKind::Imu,
        SensorSettingsKind::ForceTorque {
            in_parent,
            reversed,
        } => {
            let joint = &model.joints[index];
            link = if *in_parent {
                joint.parent
            } else {
                joint.child
            };
            let joint = JointId::from(index);
            SensorKind::ForceTorque {
                joint,
                reversed: *reversed,
            }
        }
        SensorSettingsKind::Ray {
            columns,
            rows,
            near,
            range,
            hits,
            ignored,
        } => {
            tell_of_a_doubled_ray(&name, columns, findings);
            for (fan, what, angle) in [(columns, "rays", "fov"), (rows, "rows", "vertical_fov")] {
                tell_of_one_direction(&name, fan, [what, angle], findings);
            }
            let ignored = ignored_links(model, (&name, index), ignored, findings);
            SensorKind::Ray {
                directions: directions(columns, rows),
                columns: columns.count,
                near: *near,
                range: *range,
                hits: *hits,
                ignored: ignored.into_iter().map(LinkId::from).collect(),
            }
        }
        SensorSettingsKind::Encoder { counts } => {
            link = model.joints[index].child;
            let joint = JointId::from(index);
            let turns = model.joints[index].kind != crate::model::JointKind::Prismatic;
            let step = if turns { TAU } else { 1.0 } / counts;
            SensorKind::Encoder { joint, step }
        }
        SensorSettingsKind::Contact { size } => SensorKind::Contact {
            half: size.map(|size| size * 0.5),
        },
    };
    let mut sensor = Sensor {
        name,
        link,
        X_LS: Pose::from_xyz_rpy(settings.xyz, settings.rpy),
        kind,
        sampling: Sampling {
            rate: settings.rate,
            ..Sampling::default()
        },
    };
    tell_of_an_area_off_its_link(model, &sensor, &settings.on, findings);
    let (_, count) = sensor.erring();
    let list = |of: fn(&Errors) -> [f64; 3]| -> Vec<f64> {
        let all: Vec<f64> = settings.errors.iter().flat_map(of).take(count).collect();
        if all.iter().all(|x| *x == 0.0) {
            Vec::new()
        } else {
            all
        }
    };
    sensor.sampling.bias = list(|errors| errors.bias);
    sensor.sampling.noise = list(|errors| errors.noise);
    if sensor.sampling.is_noisy() {
        sensor.sampling.seed = settings.seed;
    } else if settings.seed != 1 {
        let name = &sensor.name;
        let message = format!("'seed' of sensor '{name}' changes nothing: its noise is 0");
        let help = "give it a noise that is not 0, or leave the seed out";
        findings.warning("A144", settings.on.place.clone(), message, help);
    }
    Some(sensor)
}

/// Links that the rays of a sensor go through, by what the settings name; tells where all of a name
/// are of the body that it is on.
///
/// - `on`: the sensor's name and link
fn ignored_links(
    model: &Model,
    (name, on): (&str, usize),
    patterns: &[Pattern],
    findings: &mut Findings,
) -> BTreeSet<usize> {
    let names: Vec<&str> = model.links.iter().map(|l| l.name.as_str()).collect();
    let mut ignored = BTreeSet::new();
    for pattern in patterns {
        let links = findings.select(pattern, "link", &names, |_| None);
        let own = |link: &usize| model.links[*link].body == model.links[on].body;
        if !links.is_empty() && links.iter().all(own) {
            let text = &pattern.text;
            let message = format!(
                "'{text}' in 'ignore' of sensor '{name}' changes nothing: rays go through what is \
                 joined to the sensor's link anyway"
            );
            findings.warning("A144", pattern.place.clone(), message, "leave it out");
        }
        ignored.extend(links);
    }
    ignored
}

/// Tells of a row of rays all around whose last one is where the first one is, or nearly so: nearer
/// than half of the angle between the others.
fn tell_of_a_doubled_ray(name: &str, columns: &Fan, findings: &mut Findings) {
    let [first, last] = columns.angles;
    let (count, angle) = (f64::from(columns.count), (last - first).abs());
    let gap = (TAU - angle).abs();
    if columns.count > 2 && gap < 0.5 * angle / (count - 1.0) {
        let [gap, all] = [gap, TAU * (count - 1.0) / count].map(Digits);
        let message = format!(
            "sensor '{name}': the last of its {} rays is {gap} rad from the first: what is there is \
             seen twice",
            columns.count
        );
        let help = format!("a row of so many rays all around has fov = {all}");
        findings.note("A131", message, &help);
    }
}

/// Tells of several rays that all see the same.
fn tell_of_one_direction(name: &str, fan: &Fan, [what, angle]: [&str; 2], findings: &mut Findings) {
    let [first, last] = fan.angles;
    if fan.count > 1 && first >= last && last >= first {
        let count = fan.count;
        let message =
            format!("sensor '{name}': its {count} {what} have one direction, and see the same");
        let help =
            format!("set {angle}, the angle from the first to the last, or leave {what} out");
        findings.warning("A144", None, message, &help);
    }
}

/// Tells of a contact sensor whose box has nothing in common with the shapes of its link, so that
/// it always measures 0.
fn tell_of_an_area_off_its_link(
    model: &Model,
    sensor: &Sensor,
    on: &Pattern,
    findings: &mut Findings,
) {
    let SensorKind::Contact { half: Some(half) } = sensor.kind else {
        return;
    };
    let X_BS = model.links[sensor.link.index()].X_BL.compose(&sensor.X_LS);
    let area = Shape::Box {
        half: half * (1.0 + SENSED_BORDER),
    };
    let area = Solid::new(&area, 0.0);
    let mut patch = Patch::new();
    let mut own = model.colliders.iter().filter(|c| c.link == sensor.link);
    let meets = own.any(|collider| {
        let solid = Solid::new(&collider.shape, 0.0);
        patch.find((&area, &X_BS), (&solid, &collider.X_BG), 0.0)
    });
    if !meets {
        let message = format!(
            "sensor '{}': its box lies off the shapes of link '{}', so it measures 0",
            sensor.name,
            model.links[sensor.link.index()].name
        );
        let help = "correct xyz, rpy or size: they count from the frame of the link, in m and rad";
        findings.warning("A131", on.place.clone(), message, help);
    }
}

/// The link or joint of a sensor.
fn part(model: &Model, settings: &SensorSettings, findings: &mut Findings) -> Option<usize> {
    let joints = || model.joints.iter().map(|j| j.name.as_str()).collect();
    let links = || model.links.iter().map(|l| l.name.as_str()).collect();
    let (kind, names): (&str, Vec<&str>) = match &settings.kind {
        SensorSettingsKind::ForceTorque { .. } | SensorSettingsKind::Encoder { .. } => {
            ("joint", joints())
        }
        _ => ("link", links()),
    };
    let touches: BTreeSet<usize> = model.colliders.iter().map(|c| c.link.index()).collect();
    let unsuitable = |index: usize| match &settings.kind {
        SensorSettingsKind::Encoder { .. } => {
            let joint = JointId::from(index);
            let scalar = model.scalar_body(joint).is_some();
            (!scalar).then(|| "neither turns nor slides: it has no one position".to_owned())
        }
        SensorSettingsKind::Contact { .. } => {
            let touches = touches.contains(&index);
            (!touches).then(|| "has no collision shape that can touch anything".to_owned())
        }
        _ => None,
    };
    let found = findings.select(&settings.on, kind, &names, unsuitable);
    if let [index] = found[..] {
        return Some(index);
    }
    if found.len() > 1 {
        let message = format!(
            "'{}' means {} {kind}s, a sensor has one",
            settings.on.text,
            found.len()
        );
        let help = "write a [[sensor]] for each";
        findings.error("A131", settings.on.place.clone(), message, help);
    }
    None
}

/// The name of a sensor, which no other one has.
fn name(
    model: &Model,
    settings: &SensorSettings,
    index: usize,
    findings: &mut Findings,
) -> Option<String> {
    let own = match &settings.kind {
        SensorSettingsKind::ForceTorque { .. } | SensorSettingsKind::Encoder { .. } => {
            &model.joints[index].name
        }
        _ => &model.links[index].name,
    };
    let name = settings.name.as_ref().map_or(own, |name| &name.text);
    let others = &model.outputs.sensors;
    let same = |other: &&Sensor| identifier(&other.name) == identifier(name);
    if let Some(other) = others.iter().find(same) {
        let message = if other.name == *name {
            format!("a second sensor is named '{name}'")
        } else {
            format!(
                "sensors '{}' and '{name}' have the same name among variables",
                other.name
            )
        };
        let place = settings.name.as_ref().unwrap_or(&settings.on).place.clone();
        findings.error("A131", place, message, "give one of them a name = \"…\"");
        return None;
    }
    Some(name.clone())
}

/// Unit vectors row by row, from the lowest row and the right to the left: azimuth about z from x
/// towards y, elevation from the plane x y towards z.
fn directions(columns: &Fan, rows: &Fan) -> Vec<Vec3> {
    let mut directions = Vec::new();
    for elevation in rows.directions() {
        let (up, level) = libm::sincos(elevation);
        for azimuth in columns.directions() {
            let (s, c) = libm::sincos(azimuth);
            directions.push(Vec3::new(level * c, level * s, up));
        }
    }
    directions
}
