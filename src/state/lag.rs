//! The error of a single solve, as measured by the last step that was solved in full and in halves.
//!
//! Where a communication step cuts steps short, this error hardly changes from one to the next: it
//! is measured once and subtracted a few times.

use crate::model::Model;
use crate::tuning::LAG_USES;

/// Error of a solve by itself, which grows with the square of its step, and how long it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Lag {
    /// Of the positions, per s² of the step squared.
    pub positions: Vec<f64>,
    /// Of the velocities, likewise.
    pub velocities: Vec<f64>,
    /// Of the contact impulse per link, likewise.
    pub impulses: Vec<[f64; 3]>,
    /// Length of the step that measured it, s.
    pub length: f64,
    /// Length of the last step that measured it or took it off, s.
    pub last: f64,
    /// Contact points that pressed in the step that measured it.
    pub pressing: f64,
    /// Steps that may still take it off.
    pub uses: f64,
}

impl Lag {
    /// Nothing known.
    pub fn new(model: &Model) -> Self {
        Self {
            positions: vec![0.0; model.nv()],
            velocities: vec![0.0; model.nv()],
            impulses: vec![[0.0; 3]; model.links.len()],
            length: 0.0,
            last: 0.0,
            pressing: 0.0,
            uses: 0.0,
        }
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        self.uses = 0.0;
    }

    /// Takes it from a step of `h` seconds; impulses and contact points are the caller's.
    ///
    /// - `moved`: positions after the half steps less those after the full one
    /// - `full`, `halves`: velocities after each
    pub fn measure(&mut self, h: f64, moved: &[f64], full: &[f64], halves: &[f64]) {
        // The half steps have half of it.
        let share = 2.0 / (h * h);
        for (lag, moved) in self.positions.iter_mut().zip(moved) {
            *lag = -share * moved;
        }
        let ends = full.iter().zip(halves);
        for (lag, (full, halves)) in self.velocities.iter_mut().zip(ends) {
            *lag = share * (full - halves);
        }
        self.length = h;
        self.last = h;
        self.uses = LAG_USES;
    }

    /// Whether it is known for a step of `h` seconds in which `pressing` contact points press.
    #[expect(clippy::float_cmp, reason = "counts")]
    pub fn is_known(&self, h: f64, pressing: f64) -> bool {
        let share = h / self.length;
        let alike = (0.5..=1.0 + 1e-6).contains(&share) && pressing == self.pressing;
        self.uses > 0.0 && self.uses <= LAG_USES && alike
    }

    /// Overwrites it with that of another state of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.positions.copy_from_slice(&other.positions);
        self.velocities.copy_from_slice(&other.velocities);
        self.impulses.copy_from_slice(&other.impulses);
        self.length = other.length;
        self.last = other.last;
        self.pressing = other.pressing;
        self.uses = other.uses;
    }
}
