//! From one communication point to the next, island by island.

use super::{Simulation, SimulationError};
use crate::range::SHORTEST_FIXED_STEP;
use crate::slots::ParameterSlot;
use crate::step::driver::{Stepper, Stop};
use crate::step::point::Context;
use crate::tuning::{DEFAULT_TOLERANCE, TOLERANCES, WIDER, WIDEST};

impl Simulation {
    /// Simulates up to exactly `end`, s; does nothing unless it lies after [`Self::time`].
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`], [`SimulationError::Apart`], [`SimulationError::Work`]; the
    /// state is then that of [`Self::time`].
    pub fn advance_to(&mut self, end: f64) -> Result<(), SimulationError> {
        self.advance_part(end, end)
    }

    /// The same for a part of a communication step that ends at `whole`, s, where driven bases
    /// reach the velocities of their inputs and sensors take their samples.
    ///
    /// # Errors
    /// As [`Self::advance_to`].
    pub fn advance_part(&mut self, end: f64, whole: f64) -> Result<(), SimulationError> {
        if self.stale {
            self.place();
        }
        if end.is_nan() || end <= self.state.time {
            return Ok(());
        }
        let span = end - self.state.time;
        let refused = |time| SimulationError::NotFinite {
            time,
            hint: "forces or commands are out of all proportion to the masses",
        };
        if !self.inputs.is_finite_at(span) {
            return Err(refused(self.state.time));
        }
        let most = libm::floor(self.parameters.get(ParameterSlot::MaxSteps) * span.max(1.0));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number above 0; one beyond the type saturates"
        )]
        let budget = most as u64;
        let result = self.advance_islands([end, whole], budget);
        self.drive_on();
        self.forget();
        let time = self.state.time;
        match result {
            Ok(()) => {}
            Err(Stop::NotFinite) => return Err(refused(time)),
            Err(Stop::Apart(closure)) => {
                let name = self.model.loops[closure].name.clone();
                return Err(SimulationError::Apart { name, time });
            }
            Err(Stop::Budget | Stop::Strayed) => return Err(SimulationError::Work { time, most }),
        }
        self.applied.copy_from(&self.inputs);
        if self.inputs.varies() {
            self.applied.shift(span);
            self.applied.gather(&self.model, &self.tree);
            self.inputs.copy_from(&self.applied);
            self.inputs.hold();
            self.inputs.gather(&self.model, &self.tree);
            self.state.stepping.ahead.all_changed();
        }
        if end >= whole {
            self.sample();
        }
        Ok(())
    }

    /// Gives driven bases the accelerations that take them to the velocities of their inputs at
    /// `whole`, s.
    fn drive(&mut self, whole: f64) {
        let span = whole - self.state.time;
        let (inputs, v) = (&self.inputs, &self.state.physical.v);
        self.tree.drive(|root, dof| {
            let target = inputs.base_velocity(root, span).unwrap_or_default();
            std::array::from_fn(|i| (target[i] - v[dof + i]) / span)
        });
        let stepping = &mut self.state.stepping;
        for (body, first, a) in self.tree.driven() {
            // What is expected of it.
            for trend in [&mut stepping.trend.first, &mut stepping.trend.whole] {
                trend[first..first + 6].copy_from_slice(a);
            }
            if a.iter().any(|a| *a != 0.0) {
                let index = self.tree.bodies[body].tree;
                stepping.ahead.input_changed(&self.tree, index);
            }
        }
    }

    /// Gives driven bases the accelerations of the last step: outputs are those of its end.
    pub(super) fn drive_on(&mut self) {
        let trend = &self.state.stepping.trend.whole;
        self.tree
            .drive(|_, dof| std::array::from_fn(|i| trend[dof + i]));
    }

    /// Error allowed per step, as parameter, importer and default say.
    pub fn tolerance(&self) -> f64 {
        let own = self.parameters.get(ParameterSlot::Tolerance);
        let tolerance = if own > 0.0 {
            own
        } else if self.importer_tolerance > 0.0 {
            self.importer_tolerance
        } else {
            DEFAULT_TOLERANCE
        };
        tolerance.clamp(TOLERANCES.0, TOLERANCES.1)
    }

    /// Where a step that all trees take together would end on the way to `end`, s: as long as the
    /// solver thinks fit now, and never after `end`.
    pub fn common_step_to(&self, end: f64) -> f64 {
        let (now, ctx) = (self.state.time, context!(self, inputs));
        let next = now + Stepper::common_step(&ctx, &self.state, end - now);
        if next > now && next < end { next } else { end }
    }

    /// Takes all trees up to `end`, by at most `budget` tries of a step.
    fn advance_islands(&mut self, [end, whole]: [f64; 2], budget: u64) -> Result<(), Stop> {
        let span = end - self.state.time;
        self.stepper.begin(&mut self.state, end);
        self.drive(whole);
        let mut share = 1.0;
        let result = loop {
            let result = self.each_island(span, share, |simulation| {
                let ctx = Context {
                    budget,
                    ..context!(simulation, inputs)
                };
                simulation.stepper.advance(&ctx, &mut simulation.state, end)
            });
            if result != Err(Stop::Strayed) {
                break result;
            }
            self.stepper.begin_again(&mut self.state, end);
            self.drive(whole);
            share *= if share < WIDEST { WIDER } else { f64::INFINITY };
        };
        let ctx = context!(self, inputs);
        self.stepper
            .end(&ctx, &mut self.state, [end, whole], result)
    }

    /// Stretches springs of friction in the initial state and sets down what is to be.
    pub(super) fn settle(&mut self) {
        let settled = self.each_island(0.0, 1.0, |simulation| {
            let ctx = context!(simulation, inputs);
            simulation.stepper.settle(&ctx, &mut simulation.state);
            Ok(())
        });
        debug_assert!(settled.is_ok());
    }

    /// Does something with each island of the trees that may meet within `span` seconds, see
    /// [`crate::step::driver::Stepper::part`]; the tree then works on it alone.
    fn each_island(
        &mut self,
        span: f64,
        share: f64,
        mut act: impl FnMut(&mut Self) -> Result<(), Stop>,
    ) -> Result<(), Stop> {
        let ctx = context!(self, inputs);
        let many = self.stepper.part(&ctx, &self.state, [span, share]);
        if !many && !self.stepper.islands.rests(self.tree.island.lead) {
            return act(self);
        }
        let mut result = Ok(());
        for lead in 0..self.tree.trees.len() {
            let islands = &self.stepper.islands;
            if result.is_err() || !islands.leads(lead) || islands.rests(lead) {
                continue;
            }
            self.tree.select(|index| islands.takes(index, lead));
            self.stepper.enter(&context!(self, inputs), &mut self.state);
            result = act(self);
            self.stepper.leave(&context!(self, inputs), &mut self.state);
        }
        self.tree.select_all();
        result
    }
}
