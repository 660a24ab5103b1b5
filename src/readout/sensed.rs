//! The quantity at a sensor at this moment, before the sensor's errors and sampling.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Level, Readout, joint_position, quaternion};
use crate::model::{Model, SensorId, SensorKind};
use crate::sensor::{self, frame::pose};
use crate::slots::Sensed;
use crate::state::State;
use crate::step::point::Context;

impl Readout {
    /// What must be computed for a quantity of a sensor.
    pub(super) fn needed_of(what: Sensed) -> Level {
        match what {
            Sensed::Position | Sensed::Velocity => Level::State,
            Sensed::Orientation(_)
            | Sensed::AngularVelocity(_)
            | Sensed::Distance(_)
            | Sensed::Hit(_) => Level::Kinematics,
            Sensed::NormalForce | Sensed::Point(_) | Sensed::Depth => Level::Forces,
            Sensed::Acceleration(_) | Sensed::Force(_) | Sensed::Torque(_) => {
                Level::BodyAccelerations
            }
        }
    }

    /// Value of a quantity of a sensor; all that it needs has been prepared.
    #[inline(never)]
    pub(super) fn sensed(
        &mut self,
        ctx: &Context,
        state: &State,
        id: SensorId,
        what: Sensed,
    ) -> f64 {
        let (sensors, point, A) = (&mut self.sensors, &self.point, &self.A);
        let loads = (A.as_slice(), self.loops.as_slice(), self.held.pushed());
        match what {
            Sensed::Orientation(axis) => {
                let (_, X) = pose(ctx, point, id.index());
                quaternion(&X)[axis as usize]
            }
            Sensed::AngularVelocity(axis) => {
                sensor::angular_velocity(ctx, point, id.index())[axis as usize]
            }
            Sensed::Acceleration(axis) => {
                sensor::specific_force(ctx, point, A, id.index())[axis as usize]
            }
            Sensed::Torque(axis) => {
                let [torque, _] = sensors.wrench(ctx, point, loads, id.index());
                torque[axis as usize]
            }
            Sensed::Force(axis) => {
                let [_, force] = sensors.wrench(ctx, point, loads, id.index());
                force[axis as usize]
            }
            Sensed::Distance(ray) => {
                let scans = &mut sensors.scans;
                scans.distance(ctx, point, id.index(), ray as usize)
            }
            Sensed::Hit(ray) => sensors.scans.hit(ctx, point, id.index(), ray as usize),
            Sensed::Position => encoder_position(ctx.model, state, id),
            Sensed::NormalForce => self.touched(ctx, id).force,
            Sensed::Point(axis) => self.touched(ctx, id).point[axis as usize],
            Sensed::Depth => self.touched(ctx, id).depth,
            // Of an encoder, which has none before its second sample.
            Sensed::Velocity => 0.0,
        }
    }
}

/// Position of an encoder's joint, to the nearest of its steps.
fn encoder_position(model: &Model, state: &State, id: SensorId) -> f64 {
    match model.outputs.sensors[id.index()].kind {
        SensorKind::Encoder { joint, step } => {
            step * libm::round(joint_position(model, state, joint, 0) / step)
        }
        _ => 0.0,
    }
}
