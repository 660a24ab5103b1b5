//! Derivatives of the continuous states.

use super::{Level, Readout};
use crate::continuous::Events;
use crate::state::State;
use crate::step::point::Context;

impl Readout {
    /// Derivatives of all continuous states, with quaternions of unit length.
    pub fn rates(&mut self, ctx: &Context, state: &State) -> &[f64] {
        self.at(ctx, state, Level::Accelerations);
        let (derivatives, known) = &mut self.derivatives;
        if !*known {
            let found = (&self.point, self.vdot.as_slice());
            derivatives.find(&self.states, ctx, found, &state.physical);
            *known = true;
        }
        &derivatives.rates
    }

    /// See [`Events::watch`].
    pub fn watch(&self, ctx: &Context, events: &mut Events) {
        events.watch(ctx, &self.point);
    }

    /// See [`Events::margin`].
    pub fn margin(&mut self, ctx: &Context, state: &State, events: &Events) -> f64 {
        self.at(ctx, state, Level::Forces);
        events.margin(&self.point)
    }

    /// See [`Events::indicate`].
    pub fn indicate(&mut self, ctx: &Context, state: &State, events: &mut Events) -> f64 {
        self.at(ctx, state, Level::Forces);
        events.indicate(&self.point)
    }

    /// See [`Events::update`].
    pub fn plan(&mut self, ctx: &Context, state: &State, events: &mut Events) -> Option<f64> {
        self.at(ctx, state, Level::BodyAccelerations);
        events.update(ctx, (&self.point, &self.A), state.time)
    }

    /// See [`Events::has_come`].
    pub fn has_event(&mut self, ctx: &Context, state: &State, events: &mut Events) -> bool {
        self.at(ctx, state, Level::BodyAccelerations);
        events.has_come(ctx, (&self.point, &self.A), state.time)
    }
}
