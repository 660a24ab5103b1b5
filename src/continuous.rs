//! The robot as a system of ordinary differential equations `ẋ = f(x, u)`: what Model Exchange
//! integrates.
//!
//! The states are positions, velocities, and what friction elements and velocity motors remember.
//! All laws are those of the steps in the limit of a step of no length; forces and accelerations
//! are what the outputs show. The memory needs a law of its own here, the last one, and limits of
//! joints are softer ([`Stop`](crate::law::Stop)).
//!
//! 1. Positions: `q̇` for the velocities `v`. A quaternion is divided by its length before use, and
//!    comes back to unit length by `γ (1 − q·q) q` with `γ = 1/s`.
//! 2. Velocities: `v̇ = M⁻¹ (τ − k + Jᵀ f)`.
//! 3. An elasto-plastic element gives `F = clip(k ς + d u, F̄)` and remembers `ς̇ = (F − k ς)/d`:
//!    while it sticks that is `u`; while it slips, its displacement tends to that at which the
//!    spring alone gives the cap, with the time constant `d/k`; in the air it tends to 0.
//!
//! A step uses another law for the memory where an element slips so fast that its spring carries
//! nothing (`law/friction.rs`). As a differential equation that law would jump at the onset of
//! slip. With the law above `f` is continuous and has bounded slopes in `x` and `u`. What an
//! importer must be told nevertheless is in `continuous/events.rs`.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod events;
mod memory;
mod states;

pub use events::Events;
pub use memory::{Element, Relaxing};
pub use states::{Place, State, States};

use crate::kinematics::position_rates;
use crate::state::Physical;
use crate::step::point::{Context, Point};
use crate::tuning::QUATERNION_RATE;

/// What is computed of the derivatives of the states.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// `ẋ`, one a state.
    pub rates: Vec<f64>,
    /// `q̇`.
    positions: Vec<f64>,
}

#[cfg(test)]
crate::spoil::spoil!(Derivatives: rates positions;);

impl Derivatives {
    /// Room for so many states and positions.
    pub fn new(states: usize, positions: usize) -> Self {
        Self {
            rates: vec![0.0; states],
            positions: vec![0.0; positions],
        }
    }

    /// Finds all derivatives where `point` stands at `at`, and `vdot` are the accelerations.
    ///
    /// - `at`: with quaternions of unit length
    pub fn find(
        &mut self,
        states: &States,
        ctx: &Context,
        (point, vdot): (&Point, &[f64]),
        at: &Physical,
    ) {
        position_rates(ctx.tree, &at.q, &at.v, &mut self.positions);
        states.pick(&self.positions, vdot, &mut self.rates);
        states.carry_rates(at, vdot, &mut self.rates);
        states.memory.rates(ctx, point, at, &mut self.rates);
    }
}

/// Turns the derivatives at unit quaternions into those at the quaternions of `q`, as they are.
pub fn stretch(states: &States, q: &[f64], rates: &mut [f64]) {
    for quaternion in states.quaternions() {
        let squared: f64 = quaternion
            .places
            .iter()
            .map(|place| q[*place].powi(2))
            .sum();
        let length = squared.sqrt();
        for (rate, place) in rates[quaternion.first..].iter_mut().zip(quaternion.places) {
            *rate = *rate * length + QUATERNION_RATE * (1.0 - squared) * q[place];
        }
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests;
