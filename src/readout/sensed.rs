//! What is at a sensor at this moment, whatever the sensor makes of it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::{Readout, joint_position, quaternion};
use crate::model::{Model, SensorId, SensorKind};
use crate::sensor::{self, frame::pose};
use crate::slots::OutputSlot;
use crate::state::State;
use crate::step::point::Context;

impl Readout {
    /// Value of an output of a sensor; all that it needs has been prepared.
    pub(super) fn sensed(&mut self, ctx: &Context, state: &State, slot: OutputSlot) -> f64 {
        use OutputSlot as O;
        let (sensors, point, A) = (&mut self.sensors, &self.point, &self.A);
        match slot {
            O::SensorOrientation(id, axis) => {
                let (_, X) = pose(ctx, point, id.index());
                quaternion(&X)[axis as usize]
            }
            O::SensorAngularVelocity(id, axis) => {
                sensor::angular_velocity(ctx, point, id.index())[axis as usize]
            }
            O::SensorAcceleration(id, axis) => {
                sensor::specific_force(ctx, point, A, id.index())[axis as usize]
            }
            O::SensorTorque(id, axis) => {
                let [torque, _] = sensors.wrench(ctx, point, A, id.index());
                torque[axis as usize]
            }
            O::SensorForce(id, axis) => {
                let [_, force] = sensors.wrench(ctx, point, A, id.index());
                force[axis as usize]
            }
            O::SensorDistance(id, ray) => {
                let scans = &mut sensors.scans;
                scans.distance(ctx, point, id.index(), ray as usize)
            }
            O::SensorHit(id, ray) => sensors.scans.hit(ctx, point, id.index(), ray as usize),
            O::SensorPosition(id) => encoder_position(ctx.model, state, id),
            O::SensorNormalForce(id) => self.touched(ctx, id).force,
            O::SensorPoint(id, axis) => self.touched(ctx, id).point[axis as usize],
            O::SensorDepth(id) => self.touched(ctx, id).depth,
            // The velocity of an encoder, which has none before its second sample.
            _ => 0.0,
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
