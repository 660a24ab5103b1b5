//! Outputs of sensors.

use super::build::{Group, Row, Table, XYZ, XYZW, group, identifier, units};
use super::row::{Kind, Unit};
use crate::model::{JointId, Sensor, SensorId, SensorKind};
use crate::slots::{Axis, OutputSlot, Sensed};

type OfSensor = fn(Axis) -> Sensed;

const IMU: [Group<OfSensor>; 3] = [
    group(
        "orientation",
        &XYZW,
        Unit::One,
        Sensed::Orientation,
        "Orientation quaternion in the world of",
    ),
    group(
        "angular_velocity",
        &XYZ,
        Unit::RadianPerSecond,
        Sensed::AngularVelocity,
        "Angular velocity in its own axes of",
    ),
    group(
        "linear_acceleration",
        &XYZ,
        Unit::MeterPerSecondSquared,
        Sensed::Acceleration,
        "Specific force (acceleration less gravity) in its own axes at",
    ),
];

const FORCE_TORQUE: [Group<OfSensor>; 2] = [
    group(
        "force",
        &XYZ,
        Unit::Newton,
        Sensed::Force,
        "Force of the parent link on the child link, at",
    ),
    group(
        "torque",
        &XYZ,
        Unit::NewtonMeter,
        Sensed::Torque,
        "Torque of the parent link on the child link about its origin, at",
    ),
];

const CONTACT: [Group<OfSensor>; 1] = [group(
    "point",
    &XYZ,
    Unit::Meter,
    Sensed::Point,
    "Where the normal forces act, in its own frame, else 0, of",
)];

impl Table<'_> {
    #[cfg_attr(small, optimize(size))]
    pub(super) fn sensor_outputs(&mut self) {
        for (s, sensor) in self.model.outputs.sensors.iter().enumerate() {
            let (id, first) = (SensorId::from(s), self.len());
            let owner = format!("sensor '{}'", sensor.name);
            let prefix = format!("sensor.{}", identifier(&sensor.name));
            let groups: &[Group<OfSensor>] = match &sensor.kind {
                SensorKind::Imu => &IMU,
                SensorKind::ForceTorque { .. } => &FORCE_TORQUE,
                SensorKind::Ray { .. } => {
                    self.ray_outputs(id, sensor, &owner, &prefix);
                    &[]
                }
                SensorKind::Encoder { joint, .. } => {
                    self.encoder_outputs(id, *joint, &owner, &prefix);
                    &[]
                }
                SensorKind::Contact { .. } => {
                    let about = about!("Sum of the normal forces on {owner}");
                    let slot = OutputSlot::Sensor(id, Sensed::NormalForce);
                    let row = Row::output(slot, Unit::Newton, about);
                    self.add(format_args!("{prefix}.force"), &owner, row);
                    let about = about!("Deepest overlap, else 0, at {owner}");
                    let row =
                        Row::output(OutputSlot::Sensor(id, Sensed::Depth), Unit::Meter, about);
                    self.add(format_args!("{prefix}.depth"), &owner, row);
                    &CONTACT
                }
            };
            let slot = |of: OfSensor, axis| OutputSlot::Sensor(id, of(axis));
            self.groups(groups, slot, &owner, &prefix);
            let counts = matches!(sensor.kind, SensorKind::Encoder { .. });
            if counts || sensor.sampling.rate.is_some() {
                self.stepped_from(first);
            }
        }
    }

    #[cfg_attr(small, optimize(size))]
    fn ray_outputs(&mut self, id: SensorId, sensor: &Sensor, owner: &str, prefix: &str) {
        let SensorKind::Ray {
            directions,
            columns,
            range,
            hits,
            ..
        } = &sensor.kind
        else {
            return;
        };
        let rows = directions.len() / (*columns).max(1) as usize;
        // One row is a list, several are a matrix.
        let number = |ray: u32| match rows {
            0 | 1 => format!("{}", ray + 1),
            _ => format!("{},{}", ray / columns + 1, ray % columns + 1),
        };
        let shape: Vec<u32> = match rows {
            0 | 1 => vec![u32::try_from(directions.len()).unwrap_or(u32::MAX)],
            rows => vec![u32::try_from(rows).unwrap_or(u32::MAX), *columns],
        };
        let first = self.len();
        for ray in (0..).take(directions.len()) {
            let number = number(ray);
            let about = about!(
                "Distance to the first thing along ray {number} of {owner}, {range} m where there is none"
            );
            let row = Row::output(
                OutputSlot::Sensor(id, Sensed::Distance(ray)),
                Unit::Meter,
                about,
            );
            self.add(format_args!("{prefix}.ray[{number}]"), owner, row);
        }
        let about = about!(
            "Distances to the first thing along each ray of {owner}, {range} m where there is none"
        );
        self.whole(first, &format!("{prefix}.ray"), &shape, &about);
        let first = self.len();
        for ray in (0..).take(if *hits { directions.len() } else { 0 }) {
            let number = number(ray);
            let about = about!(
                "What ray {number} of {owner} hits: 0 nothing, -1 the ground, n the n-th link of the model"
            );
            let row = Row::output(OutputSlot::Sensor(id, Sensed::Hit(ray)), Unit::One, about);
            let row = row.kind(Kind::Integer);
            self.add(format_args!("{prefix}.hit[{number}]"), owner, row);
        }
        let about = about!(
            "What each ray of {owner} hits: 0 nothing, -1 the ground, n the n-th link of the model"
        );
        self.whole(first, &format!("{prefix}.hit"), &shape, &about);
    }

    #[cfg_attr(small, optimize(size))]
    fn encoder_outputs(&mut self, id: SensorId, joint: JointId, owner: &str, prefix: &str) {
        let joint = &self.model.joints[joint.index()];
        let units = units(joint.kind);
        let about = about!("Position of joint '{}' in steps of {owner}", joint.name);
        let row = Row::output(
            OutputSlot::Sensor(id, Sensed::Position),
            units.position,
            about,
        );
        self.add(format_args!("{prefix}.position"), owner, row);
        let sampling = &self.model.outputs.sensors[id.index()].sampling;
        if sampling.rate.is_some() {
            let about = about!(
                "Velocity of joint '{}' from the last two samples of {owner}",
                joint.name
            );
            let row = Row::output(
                OutputSlot::Sensor(id, Sensed::Velocity),
                units.velocity,
                about,
            );
            let row = row.of_joint(joint.kind);
            self.add(format_args!("{prefix}.velocity"), owner, row);
        }
    }
}
