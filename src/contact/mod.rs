//! Contact: where shapes meet the ground, and the law of the force there.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod detect;
mod law;
mod turn;

pub use detect::{Plane, detect, is_clear};
pub use law::{Response, dissipation_number};
pub(crate) use law::{clip, stretched, stribeck};
pub use turn::{Turn, angular, find_turns};

use crate::spatial::{Vec3, Vec6, velocity_at};
use std::iter::Peekable;

/// A contact point of a step: what was found at its start, constant while the step is solved.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contact {
    /// Index of the body.
    pub body: usize,
    /// Index of the link, for outputs.
    pub link: usize,
    /// Place of its displacement in the state.
    pub slot: usize,
    /// Position from O, m, world axes.
    pub x: Vec3,
    /// Unit vector from the ground into the body.
    pub normal: Vec3,
    /// Distance along the normal, positive apart, m.
    pub gap: f64,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
    /// Hunt–Crossley dissipation, s/m.
    pub dissipation: f64,
    /// Approach speed that the dissipation was chosen for, m/s; 0 without restitution.
    pub touchdown: f64,
    /// Coulomb coefficient at the sliding speed at the start of the step.
    pub mu: f64,
    /// Friction force that slips, N: `μ` times the normal force at the start of the step.
    pub cap: f64,
    /// Stiffness of the sticking friction, N/m.
    pub tangential_stiffness: f64,
    /// Damping of the sticking friction, N·s/m.
    pub tangential_damping: f64,
    /// Elastic displacement at the start, in the tangent plane, world axes, m.
    pub displacement: Vec3,
}

impl Contact {
    /// Velocity of the point on its body, m/s, world axes, where `V` are those of all bodies.
    #[inline]
    pub fn velocity(&self, V: &[Vec6]) -> Vec3 {
        velocity_at(&V[self.body], &self.x)
    }

    /// Its part along the normal, m/s, positive apart.
    #[inline]
    pub fn normal_velocity(&self, V: &[Vec6]) -> f64 {
        self.normal.dot(&self.velocity(V))
    }
}

/// The item of `slot` in a list by ascending slots; those before it are left behind.
///
/// - `slot_of`: an item's slot
#[inline]
pub(crate) fn seek<I: Iterator>(
    list: &mut Peekable<I>,
    slot: usize,
    slot_of: impl Fn(&I::Item) -> usize,
) -> Option<I::Item> {
    while list.next_if(|item| slot_of(item) < slot).is_some() {}
    list.next_if(|item| slot_of(item) == slot)
}

/// Length of `x` along the unit vector `normal`, and what is left of it.
#[inline]
fn normal_part(normal: &Vec3, x: &Vec3) -> (f64, Vec3) {
    let along = normal.dot(x);
    (along, x - normal * along)
}

#[cfg(test)]
mod tests;
