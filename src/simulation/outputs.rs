//! Reading outputs and their derivatives.

use super::{Simulation, posed};
use crate::slots::OutputSlot;
use crate::step::point::Context;

impl Simulation {
    /// Reads an output; the first read after a change computes what is needed.
    pub fn output(&mut self, slot: OutputSlot) -> f64 {
        if self.stale {
            self.place();
        }
        let ctx = reading!(self, applied);
        let state = posed::seen(&mut self.posed, &ctx, &self.state);
        self.readout.read(&ctx, state, slot)
    }

    /// First time derivative of an output; None where it has none, see `readout`.
    pub fn output_derivative(&mut self, slot: OutputSlot) -> Option<f64> {
        if self.stale {
            self.place();
        }
        let ctx = reading!(self, applied);
        let state = posed::seen(&mut self.posed, &ctx, &self.state);
        self.readout.derivative(&ctx, state, slot)
    }
}
