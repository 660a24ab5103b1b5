//! Bases that move as inputs say, whatever pushes them.
//!
//! In the mass matrix they stand with [`crate::tuning::DRIVEN_MASS`] and the bias of their
//! acceleration, so that a step takes them to the velocity that it knows beforehand. They have no
//! mass of their own: what touches them is as stiff as its own weight asks, and no energy is
//! theirs.

use super::parts::Tree;
use crate::model::RootId;
use crate::spatial::Vec6;

impl Tree {
    /// Whether a body moves as inputs say.
    #[inline]
    pub fn is_driven(&self, body: usize) -> bool {
        let tree = &self.trees[self.bodies[body].tree];
        tree.driven.is_some() && tree.bodies.start == body
    }

    /// The driven bases that a step moves: their bodies, first degrees of freedom, accelerations.
    pub fn driven(&self) -> impl Iterator<Item = (usize, usize, &Vec6)> + '_ {
        self.moved().filter_map(|(_, tree)| {
            let driven = tree.driven.as_ref();
            driven.map(|a| (tree.bodies.start, tree.dofs.start, a))
        })
    }

    /// Sets the accelerations of driven bases.
    ///
    /// - `acceleration`: of a tree with its first degree of freedom
    pub fn drive(&mut self, acceleration: impl Fn(RootId, usize) -> Vec6) {
        for (root, tree) in (0..).map(RootId::from).zip(&mut self.trees) {
            let dof = tree.dofs.start;
            if let Some(driven) = &mut tree.driven {
                *driven = acceleration(root, dof);
            }
        }
    }
}
