//! Sensors with errors, and sensors that take samples and hold them.
//!
//! A sample is taken at the first communication point at or after each of its times, `k/rate` after
//! the start. Bias and noise are added to the value at that moment. Noise is a function of seed,
//! name, channel and `k`, so that the state holds nothing but the samples.

use super::Readout;
use super::channels::{channel, quantity};
use crate::clock::round_off;
use crate::model::{Sensor, SensorId, SensorKind};
use crate::slots::{OutputSlot, Sensed};
use crate::state::State;
use crate::step::point::Context;
use crate::tuning::SAMPLE_EARLY;

impl Readout {
    /// Whether an output is held between samples.
    pub(super) fn is_held(ctx: &Context, slot: OutputSlot) -> bool {
        match slot {
            OutputSlot::Sensor(id, _) => {
                let sensor = &ctx.model.outputs.sensors[id.index()];
                sensor.sampling.rate.is_some()
            }
            _ => false,
        }
    }

    /// What a sensor that is not ideal says; None of one that is.
    pub(super) fn measured(
        &mut self,
        ctx: &Context,
        state: &State,
        id: SensorId,
        what: Sensed,
    ) -> Option<f64> {
        let sensor = &ctx.model.outputs.sensors[id.index()];
        if sensor.sampling.is_ideal() {
            return None;
        }
        let channel = channel(sensor, what);
        if sensor.sampling.rate.is_some() {
            let held = &state.stepping.samples[self.sampler.places[id.index()]..];
            if held[0] > 0.0 {
                return Some(held[2 + channel]);
            }
        }
        // Before the start, or without a rate: as things are at this moment.
        let value = self.read_now(ctx, state, OutputSlot::Sensor(id, what));
        Some(self.wrong(sensor, id, (channel, 0), value))
    }

    /// A value with bias and noise.
    fn wrong(
        &self,
        sensor: &Sensor,
        id: SensorId,
        (channel, sample): (usize, u64),
        value: f64,
    ) -> f64 {
        let (first, count) = sensor.erring();
        let error = match &sensor.kind {
            SensorKind::Ray {
                directions, range, ..
            } if channel >= directions.len() || value >= *range => return value,
            SensorKind::Ray { .. } => 0,
            _ if !(first..first + count).contains(&channel) => return value,
            _ => channel - first,
        };
        let of = |list: &[f64]| list.get(error).copied().unwrap_or(0.0);
        let mut wrong = value + of(&sensor.sampling.bias);
        let deviation = of(&sensor.sampling.noise);
        if deviation > 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a model has fewer channels"
            )]
            let channel = channel as u32;
            wrong += deviation * self.sampler.streams[id.index()].normal(sample, channel);
        }
        match &sensor.kind {
            SensorKind::Ray { near, range, .. } => wrong.clamp(*near, *range),
            _ => wrong,
        }
    }

    /// Takes the samples that are due at the time of a state that begins at `start`, s.
    pub fn sample(&mut self, ctx: &Context, state: &mut State, start: f64) {
        for (s, sensor) in ctx.model.outputs.sensors.iter().enumerate() {
            let Some(rate) = sensor.sampling.rate else {
                continue;
            };
            let (id, place) = (SensorId::from(s), self.sampler.places[s]);
            let early = SAMPLE_EARLY + rate * round_off(state.time.abs().max(start.abs()));
            let number = libm::floor((state.time - start) * rate + early).max(0.0);
            let taken = state.stepping.samples[place];
            if number < taken {
                continue;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number; beyond 2^64 the noise repeats"
            )]
            let index = number as u64;
            for channel in 0..sensor.channels() {
                let slot = OutputSlot::Sensor(id, quantity(sensor, channel));
                let value = self.read_now(ctx, state, slot);
                self.sampler.fresh[channel] = self.wrong(sensor, id, (channel, index), value);
            }
            let held = &mut state.stepping.samples[place..place + sensor.held()];
            let passed = state.time - held[1];
            if matches!(sensor.kind, SensorKind::Encoder { .. }) && taken > 0.0 && passed > 0.0 {
                self.sampler.fresh[1] = (self.sampler.fresh[0] - held[2]) / passed;
            }
            (held[0], held[1]) = (number + 1.0, state.time);
            held[2..].copy_from_slice(&self.sampler.fresh[..sensor.channels()]);
        }
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
