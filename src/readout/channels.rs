//! Which number of a sensor a quantity is, and where its samples are held.

use crate::model::{Model, Sensor, SensorKind};
use crate::sensor::noise::Stream;
use crate::slots::{Axis, Sensed};

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

/// Which number of a sensor a quantity is.
pub(super) fn channel(sensor: &Sensor, what: Sensed) -> usize {
    match what {
        Sensed::Orientation(axis) | Sensed::Force(axis) => usize::from(axis),
        Sensed::AngularVelocity(axis) => 4 + usize::from(axis),
        Sensed::Acceleration(axis) => 7 + usize::from(axis),
        Sensed::Torque(axis) => 3 + usize::from(axis),
        Sensed::Distance(ray) => ray as usize,
        Sensed::Hit(ray) => rays(sensor) + ray as usize,
        Sensed::Position | Sensed::NormalForce => 0,
        Sensed::Velocity => 1,
        Sensed::Point(axis) => 1 + usize::from(axis),
        Sensed::Depth => 4,
    }
}

/// The inverse.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a model has fewer channels"
)]
pub(super) fn quantity(sensor: &Sensor, channel: usize) -> Sensed {
    let axis = |first: usize| (channel - first) as Axis;
    match (&sensor.kind, channel) {
        (SensorKind::Imu, 0..=3) => Sensed::Orientation(axis(0)),
        (SensorKind::Imu, 4..=6) => Sensed::AngularVelocity(axis(4)),
        (SensorKind::Imu, _) => Sensed::Acceleration(axis(7)),
        (SensorKind::ForceTorque { .. }, 0..=2) => Sensed::Force(axis(0)),
        (SensorKind::ForceTorque { .. }, _) => Sensed::Torque(axis(3)),
        (SensorKind::Ray { directions, .. }, ray) if ray < directions.len() => {
            Sensed::Distance(ray as u32)
        }
        (SensorKind::Ray { directions, .. }, ray) => Sensed::Hit((ray - directions.len()) as u32),
        (SensorKind::Encoder { .. }, 0) => Sensed::Position,
        (SensorKind::Encoder { .. }, _) => Sensed::Velocity,
        (SensorKind::Contact { .. }, 0) => Sensed::NormalForce,
        (SensorKind::Contact { .. }, 1..=3) => Sensed::Point(axis(1)),
        (SensorKind::Contact { .. }, _) => Sensed::Depth,
    }
}

fn rays(sensor: &Sensor) -> usize {
    match &sensor.kind {
        SensorKind::Ray { directions, .. } => directions.len(),
        _ => 0,
    }
}
