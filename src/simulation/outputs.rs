//! Reading outputs and their derivatives, and the derivatives of states.

use super::Simulation;
use super::posed::{Posed, seen};
use crate::continuous::stretch;
use crate::inputs::Inputs;
use crate::model::StateId;
use crate::readout::Readout;
use crate::slots::{InputSlot, OutputSlot, ParameterSlot};
use crate::state::State;
use crate::step::point::Context;

/// All that can be read of a simulation until something is set. Made once for many values, because
/// importers read many; the first read after a change computes what is needed.
pub struct Reading<'a> {
    ctx: Context<'a>,
    /// As it was set or reached.
    state: &'a State,
    /// As outputs show it, where that is another one.
    posed: Option<&'a mut Posed>,
    readout: &'a mut Readout,
    /// As they were set.
    inputs: &'a Inputs,
}

impl Simulation {
    /// What can be read now.
    #[inline]
    pub fn reading(&mut self) -> Reading<'_> {
        if self.stale {
            self.place();
        }
        let ctx = reading!(self, applied);
        Reading {
            posed: seen(&mut self.posed, &ctx, &self.state),
            ctx,
            state: &self.state,
            readout: &mut self.readout,
            inputs: &self.inputs,
        }
    }

    /// Reads an output; the first read after a change computes what is needed.
    pub fn output(&mut self, slot: OutputSlot) -> f64 {
        self.reading().output(slot)
    }

    /// First time derivative of an output; None where it has none, see `readout`.
    #[cfg_attr(small, optimize(size))]
    pub fn output_derivative(&mut self, slot: OutputSlot) -> Option<f64> {
        let reading = self.reading();
        let state = shown(&reading.posed, reading.state);
        reading.readout.derivative(&reading.ctx, state, slot)
    }

    /// Derivatives of all continuous states at the present time, states and inputs; none unless the
    /// outside integrates.
    pub fn rates(&mut self) -> &[f64] {
        self.reading().into_rates()
    }
}

/// The state that outputs show.
#[inline]
fn shown<'a>(posed: &'a Option<&mut Posed>, state: &'a State) -> &'a State {
    posed.as_ref().map_or(state, |posed| &posed.state)
}

impl<'a> Reading<'a> {
    /// An output.
    #[inline]
    pub fn output(&mut self, slot: OutputSlot) -> f64 {
        let state = shown(&self.posed, self.state);
        self.readout.read(&self.ctx, state, slot)
    }

    /// An input, as it was set.
    pub fn input(&self, slot: InputSlot) -> f64 {
        self.inputs.get(slot)
    }

    /// A parameter.
    pub fn parameter(&self, slot: ParameterSlot) -> f64 {
        self.ctx.parameters.get(slot)
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// The value of a continuous state, in its unit.
    pub fn state(&self, id: StateId) -> f64 {
        let states = &self.readout.states;
        states.value(id.index(), &self.state.physical)
    }

    /// The derivative of a continuous state, where the outside integrates.
    pub fn rate(&mut self, id: StateId) -> f64 {
        self.derive();
        let posed = self.posed.as_ref();
        posed.map_or(0.0, |posed| posed.rates[id.index()])
    }

    /// See [`Simulation::plan_event`].
    pub(super) fn plan_event(self) -> Option<f64> {
        let posed = self.posed?;
        let (state, events) = (&posed.state, &mut posed.events);
        self.readout.plan(&self.ctx, state, events)
    }

    /// The least margin of what acts where the outside integrates, see [`Simulation::indicator`];
    /// asking for it changes nothing.
    #[cfg_attr(small, optimize(size))]
    pub fn margin(&mut self) -> f64 {
        self.posed.as_deref().map_or(1.0, |posed| {
            let (state, events) = (&posed.state, &posed.events);
            self.readout.margin(&self.ctx, state, events)
        })
    }

    /// See [`Simulation::indicator`].
    #[cfg_attr(small, optimize(size))]
    pub(super) fn indicate(self) -> f64 {
        self.posed.map_or(1.0, |posed| {
            let (state, events) = (&posed.state, &mut posed.events);
            self.readout.indicate(&self.ctx, state, events)
        })
    }

    /// See [`Simulation::has_event`].
    pub(super) fn has_event(self) -> bool {
        self.posed.is_some_and(|posed| {
            let (state, events) = (&posed.state, &mut posed.events);
            self.readout.has_event(&self.ctx, state, events)
        })
    }

    fn into_rates(mut self) -> &'a [f64] {
        self.derive();
        self.posed.map_or(&[], |posed| &posed.rates)
    }

    /// Computes the derivatives of all states.
    #[cfg_attr(small, optimize(size))]
    fn derive(&mut self) {
        let Some(posed) = &mut self.posed else {
            return;
        };
        if !posed.derived {
            let rates = self.readout.rates(&self.ctx, &posed.state);
            posed.rates.copy_from_slice(rates);
            self.readout.watch(&self.ctx, &mut posed.events);
            let (states, q) = (&self.readout.states, &self.state.physical.q);
            stretch(states, q, &mut posed.rates);
            posed.derived = true;
        }
    }
}
