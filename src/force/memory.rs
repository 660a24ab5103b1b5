//! What force terms remember from step to step. The law by which that changes is in
//! [`super::Terms`].

use super::contact::Contact;
use crate::model::Model;
use crate::spatial::{Vec3, Vec6};
use crate::tuning::TANGENTIAL_RATIO;
use std::iter::Peekable;

/// What a contact remembers from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Index of the shape, or that of a pair of shapes: see [`Model::slots`].
    pub slot: usize,
    /// Elastic displacement of the friction, m, in axes of the body that is pushed against, along
    /// the normal against drilling: the one with which it would hold its energy at the stiffness
    /// that it has without a load.
    pub displacement: [f64; 3],
    /// Elastic angle of the friction against turning, in the same axes, rad: the one with which it
    /// would hold its energy at the stiffness that it has with a quarter of the weight.
    pub turn: [f64; 3],
    /// Dissipation with which it bounces, of its touch-down or of a faster impact that has come
    /// through others since, s/m; 0 for a contact that does not.
    pub bounce: f64,
    /// Share of its sliding speed that the spring of its friction does not take up, 0 … 1: 0 where
    /// it sticks, 1 where nothing is known.
    pub sliding: f64,
}

impl Default for Touch {
    fn default() -> Self {
        Self::from_numbers(0, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    }
}

impl Touch {
    /// Every number that is stored of it but the slot, in saved order.
    pub fn numbers(&self) -> [f64; 8] {
        let ([x, y, z], [a, b, c]) = (self.displacement, self.turn);
        [x, y, z, a, b, c, self.bounce, self.sliding]
    }

    /// The inverse of [`Self::numbers`].
    pub fn from_numbers(slot: usize, numbers: [f64; 8]) -> Self {
        let [x, y, z, a, b, c, bounce, sliding] = numbers;
        Self {
            slot,
            displacement: [x, y, z],
            turn: [a, b, c],
            bounce,
            sliding,
        }
    }
}

/// What the force terms of a robot remember: elastic displacements, and how contacts have begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    /// Of the contacts, by ascending slot; slots that are not listed remember nothing.
    pub touches: Vec<Touch>,
    /// Elastic displacement of each velocity motor, one per actuator, rad or m.
    pub motor: Vec<f64>,
    /// Elastic displacement of the dry friction of each degree of freedom, rad or m.
    pub dry: Vec<f64>,
    /// What [`Touch::sliding`] is, of the dry friction of each degree of freedom.
    pub sliding: Vec<f64>,
}

impl Memory {
    /// Nothing remembered; room for all that a robot can touch.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        Self {
            touches: Vec::with_capacity(model.contact_room()[0]),
            motor: vec![0.0; model.actuators.len()],
            dry: vec![0.0; model.nv()],
            sliding: vec![1.0; model.nv()],
        }
    }

    /// Overwrites it with that of another state of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.touches.clear();
        self.touches.extend_from_slice(&other.touches);
        self.motor.copy_from_slice(&other.motor);
        self.dry.copy_from_slice(&other.dry);
        self.sliding.copy_from_slice(&other.sliding);
    }
}

impl Contact {
    /// A vector that is remembered, in world axes.
    #[inline]
    pub fn recall(&self, stored: &[f64; 3]) -> Vec3 {
        let stored = Vec3::from(*stored);
        self.other.map_or(stored, |other| other.axes * stored)
    }

    /// The inverse of [`Self::recall`].
    #[inline]
    pub fn keep(&self, x: &Vec3) -> [f64; 3] {
        self.other
            .map_or(*x, |other| other.axes.transpose() * x)
            .into()
    }

    /// What friction remembers of its displacement `slip`, m: the displacement with which it would
    /// hold the same energy at the stiffness that it has without a load, m, in the axes of
    /// [`Self::keep`]. The reason is in [`super::contact`].
    #[inline]
    pub(super) fn keep_slip(&self, slip: &Vec3) -> [f64; 3] {
        self.keep(&(slip * self.stiffened()))
    }

    /// The inverse of [`Self::keep_slip`].
    #[inline]
    pub(super) fn recall_slip(&self, stored: &[f64; 3]) -> Vec3 {
        self.recall(stored) / self.stiffened()
    }

    /// Square root of how much stiffer friction is than without a load.
    #[inline]
    fn stiffened(&self) -> f64 {
        let unloaded = TANGENTIAL_RATIO * self.spring.slope(0.0);
        (self.friction.stiffness / unloaded).sqrt()
    }

    /// How fast what its friction remembers changes where no steps are taken, m/s, in the axes in
    /// which it is kept, for the velocities of all bodies.
    pub fn memory_rate(&self, V: &[Vec6]) -> [f64; 3] {
        self.keep_slip(&self.friction.rate(self.slid(&self.sliding(V))))
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
