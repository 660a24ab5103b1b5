//! Scratch of what [`super::hold`] finds.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::Rows;
use crate::force::{Contact, JointTerm, Responses, SpringTerm, Velocities};
use crate::model::Model;
use crate::spatial::Vec6;
use crate::step::convex::{Factor, Newton};
use crate::tree::Tree;

/// What holds, and what it changes.
#[derive(Clone, Debug)]
pub(super) struct Held {
    /// Whether anything does.
    pub any: bool,
    /// For how long contacts count, s.
    pub tau: f64,
    /// Has the factor of `M + G`.
    pub newton: Newton,
    /// Stiffness of the joint terms as damping, and springs, of which there are none.
    pub joints: Vec<JointTerm>,
    pub springs: Vec<SpringTerm>,
    /// Of the motor of each joint term its stiffness, kg·m² or kg, as far as it counts, and what
    /// it pulls towards the acceleration that it asks for, N·m or N.
    pub motors: Vec<[f64; 2]>,
    /// Stiffness of the springs of contacts, N/m, and the loads that damp them, N, N·s/m.
    pub normal: Vec<[f64; 3]>,
    /// `a_s`, and `M a_s`; then `v̇ − a_s`.
    pub late: Vec<f64>,
    pub change: Vec<f64>,
    /// Velocities of the bodies with which friction has its forces, and what it answers to them.
    pub V: Vec<Vec6>,
    pub at: Velocities,
    pub responses: Responses,
    /// What each contact pushes its body more by, about O, N·m and N; one contact at a time.
    pub pushed: Vec<Vec6>,
    pub F: Vec<Vec6>,
    /// No rows.
    pub open: Rows,
}

#[cfg(test)]
crate::spoil::spoil!(
    Held: any tau newton motors normal late change V at responses pushed F; joints springs open
);

impl Held {
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let (room, nv, nb) = (model.contact_room(), model.nv(), tree.bodies.len());
        Self {
            any: false,
            tau: 0.0,
            newton: Newton::new(tree, room),
            joints: Vec::with_capacity(nv),
            springs: Vec::new(),
            motors: Vec::with_capacity(nv),
            normal: Vec::with_capacity(room[0]),
            late: vec![0.0; nv],
            change: vec![0.0; nv],
            V: vec![[0.0; 6]; nb],
            at: Velocities::new(room).with(tree.springs.len()),
            responses: Responses::new(room, nv).with(tree.springs.len()),
            pushed: Vec::with_capacity(room[0]),
            F: vec![[0.0; 6]; nb],
            open: Rows::new(tree),
        }
    }

    /// What each contact pushes its body more by than its state says, about O; none where nothing
    /// holds.
    pub fn pushed(&self) -> &[Vec6] {
        &self.pushed
    }

    /// Leaves contacts their friction alone.
    pub fn loosen(&mut self, contacts: &mut [Contact]) {
        self.normal.clear();
        for contact in contacts {
            let Contact {
                spring,
                load,
                tilting,
                ..
            } = contact;
            self.normal.push([spring.stiffness, *load, *tilting]);
            (spring.stiffness, *load, *tilting) = (0.0, 0.0, 0.0);
        }
    }

    /// Undoes [`Self::loosen`].
    pub fn tighten(&self, contacts: &mut [Contact]) {
        for (contact, [stiffness, load, tilting]) in contacts.iter_mut().zip(&self.normal) {
            contact.spring.stiffness = *stiffness;
            (contact.load, contact.tilting) = (*load, *tilting);
        }
    }

    /// Solves with `M + G`, of which `factor` is the factor.
    pub fn solve(&self, tree: &Tree, factor: &Factor, x: &mut [f64]) {
        factor.solve((tree, &self.open), x, &mut Vec::new());
    }
}
