//! Model Exchange: the importer integrates, the simulation computes derivatives.

use super::posed::Posed;
use super::{Simulation, SimulationError};
use crate::continuous::States;
use crate::slots::ParameterSlot;

impl Simulation {
    /// From now on the outside integrates: inputs act at once, and outputs follow states, time and
    /// inputs as they are set. There is no way back.
    pub fn exchange(&mut self) {
        self.posed = Some(Box::new(Posed::new(&self.model, self.readout.states.len())));
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
