//! Which number of a sensor an output is, and where its samples are held.

use crate::model::{Model, Sensor, SensorId, SensorKind};
use crate::sensor::noise::Stream;
use crate::slots::{Axis, OutputSlot};

/// Where the sensors' samples are held, and scratch for one of them.
#[derive(Clone, Debug)]
pub(super) struct Sampler {
    /// Per sensor: its first place in [`crate::state::Stepping::samples`]; never changes.
    pub(super) places: Vec<usize>,
    /// Per sensor: its noise; never changes.
    pub(super) streams: Vec<Stream>,
    /// Channels of a new sample.
    pub(super) fresh: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Sampler: fresh; places streams);

impl Sampler {
    pub(super) fn new(model: &Model) -> Self {
        let sensors = &model.outputs.sensors;
        let places = sensors.iter().scan(0, |next, sensor| {
            let place = *next;
            *next += sensor.held();
            Some(place)
        });
        let stream = |sensor: &Sensor| Stream::new(sensor.sampling.seed, &sensor.name);
        let most = sensors.iter().map(Sensor::channels).max();
        Self {
            places: places.collect(),
            streams: sensors.iter().map(stream).collect(),
            fresh: vec![0.0; most.unwrap_or(0)],
        }
    }
}

/// The sensor of an output, and its channel.
pub(super) fn channel(model: &Model, slot: OutputSlot) -> Option<(SensorId, usize)> {
    use OutputSlot as O;
    Some(match slot {
        O::SensorOrientation(id, axis) | O::SensorForce(id, axis) => (id, usize::from(axis)),
        O::SensorAngularVelocity(id, axis) => (id, 4 + usize::from(axis)),
        O::SensorAcceleration(id, axis) => (id, 7 + usize::from(axis)),
        O::SensorTorque(id, axis) => (id, 3 + usize::from(axis)),
        O::SensorDistance(id, ray) => (id, ray as usize),
        O::SensorHit(id, ray) => (id, rays(&model.outputs.sensors[id.index()]) + ray as usize),
        O::SensorPosition(id) | O::SensorNormalForce(id) => (id, 0),
        O::SensorVelocity(id) => (id, 1),
        O::SensorPoint(id, axis) => (id, 1 + usize::from(axis)),
        O::SensorDepth(id) => (id, 4),
        _ => return None,
    })
}

/// The inverse.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a model has fewer channels"
)]
pub(super) fn slot(sensor: &Sensor, id: SensorId, channel: usize) -> OutputSlot {
    use OutputSlot as O;
    let axis = |first: usize| (channel - first) as Axis;
    match (&sensor.kind, channel) {
        (SensorKind::Imu, 0..=3) => O::SensorOrientation(id, axis(0)),
        (SensorKind::Imu, 4..=6) => O::SensorAngularVelocity(id, axis(4)),
        (SensorKind::Imu, _) => O::SensorAcceleration(id, axis(7)),
        (SensorKind::ForceTorque { .. }, 0..=2) => O::SensorForce(id, axis(0)),
        (SensorKind::ForceTorque { .. }, _) => O::SensorTorque(id, axis(3)),
        (SensorKind::Ray { directions, .. }, ray) if ray < directions.len() => {
            O::SensorDistance(id, ray as u32)
        }
        (SensorKind::Ray { directions, .. }, ray) => {
            O::SensorHit(id, (ray - directions.len()) as u32)
        }
        (SensorKind::Encoder { .. }, 0) => O::SensorPosition(id),
        (SensorKind::Encoder { .. }, _) => O::SensorVelocity(id),
        (SensorKind::Contact { .. }, 0) => O::SensorNormalForce(id),
        (SensorKind::Contact { .. }, 1..=3) => O::SensorPoint(id, axis(1)),
        (SensorKind::Contact { .. }, _) => O::SensorDepth(id),
    }
}

fn rays(sensor: &Sensor) -> usize {
    match &sensor.kind {
        SensorKind::Ray { directions, .. } => directions.len(),
        _ => 0,
    }
}
