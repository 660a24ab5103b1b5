//! Model Exchange: the importer integrates, the simulation computes derivatives.

use super::posed::Posed;
use super::{Simulation, SimulationError};
use crate::continuous::States;
use crate::slots::{InputSlot, ParameterSlot};
use crate::tuning::REFERENCE_GRAVITY;

impl Simulation {
    /// From now on the outside integrates: inputs act at once, and outputs follow states, time and
    /// inputs as they are set. There is no way back.
    pub fn exchange(&mut self) {
        self.posed = Some(Box::new(Posed::new(
            &self.model,
            &self.tree,
            self.readout.states.len(),
        )));
        self.applied.copy_from(&self.inputs);
    }

    /// The continuous states; none of a model that is for co-simulation alone.
    pub fn states(&self) -> &States {
        &self.readout.states
    }

    /// Reads the values of all continuous states.
    pub fn read_states(&mut self, x: &mut [f64]) {
        if self.stale {
            self.place();
        }
        self.readout.states.read(&self.state.physical, x);
    }

    /// Sets the values of all continuous states, which are finite.
    pub fn set_states(&mut self, x: &[f64]) {
        self.readout.states.write(x, &mut self.state.physical);
        self.forget();
    }

    /// Sets the time, s.
    pub fn set_time(&mut self, time: f64) {
        self.state.time = time;
    }

    /// The size by which a change of an input counts: of forces and torques the weight of the tree
    /// that they act on, N or N·m, else 1 in its unit.
    pub fn nominal_input(&self, slot: InputSlot) -> f64 {
        if !matches!(
            slot,
            InputSlot::Effort(_) | InputSlot::ExternalForce(..) | InputSlot::ExternalTorque(..)
        ) {
            return 1.0;
        }
        let root = self.model.root_of(self.acted_on(slot));
        let tree = &self.tree.trees[root.index()];
        let weight = tree.moving_mass * REFERENCE_GRAVITY;
        if weight > 0.0 { weight } else { 1.0 }
    }

    /// Takes note of what acts, at an event of the outside, and plans the time of the next one, s;
    /// none where no two shapes can pass each other.
    pub fn plan_event(&mut self) -> Option<f64> {
        self.reading().plan_event()
    }

    /// The event indicator at the end of a step of the integrator outside: below 0 where something
    /// has left that acted, see [`Events`](crate::continuous::Events).
    pub fn indicator(&mut self) -> f64 {
        self.reading().indicate()
    }

    /// Whether a step of the outside that ends here ends in an event: something has left that
    /// acted, or shapes may pass each other before the event that is planned.
    pub fn has_event(&mut self) -> bool {
        self.reading().has_event()
    }

    /// [`Self::rates`], if they are finite.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`].
    pub fn derivatives(&mut self) -> Result<&[f64], SimulationError> {
        let time = self.state.time;
        let rates = self.rates();
        if rates.iter().all(|rate| rate.is_finite()) {
            Ok(rates)
        } else {
            Err(SimulationError::NotFinite {
                time,
                hint: "states, forces or commands are out of all proportion to the masses",
            })
        }
    }

    /// Whether a parameter may have this value where the outside integrates: what would need an
    /// event, or a state that is not there, may not be switched on.
    pub(super) fn check_exchanged(
        &self,
        slot: ParameterSlot,
        value: f64,
    ) -> Result<(), SimulationError> {
        if self.posed.is_none() || value <= 0.0 {
            return Ok(());
        }
        let refused = |expected| {
            Err(SimulationError::Value {
                what: format!("parameter {slot:?}"),
                expected,
                value,
            })
        };
        match slot {
            ParameterSlot::GroundRestitution => {
                refused("0 in Model Exchange, because a rebound is an event; use co-simulation")
            }
            ParameterSlot::JointFriction(joint) => {
                let joint = &self.model.joints[joint.index()];
                let memory = &self.states().memory;
                let mut bodies = joint.bodies.iter();
                let known = bodies.all(|body| {
                    let body = &self.model.bodies[body.index()];
                    body.motion.nv() != 1 || memory.has_dry(body.dof.index())
                });
                if known {
                    Ok(())
                } else {
                    refused(
                        "0 in Model Exchange, because the joint has no state for it; export the \
                         robot with friction of this joint above 0",
                    )
                }
            }
            _ => Ok(()),
        }
    }
}
