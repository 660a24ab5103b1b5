//! What keeps its momentum: bodies that move freely, with all that hangs on them.
//!
//! The joints of a chain of bodies let the last of them, and all beyond, move in the space `V` of
//! twists that their columns of `S` span. Let the joints be free (nothing acts along them) and the
//! bodies between them have no mass. Then what the world before the chain does to all beyond it is
//! a wrench `f` with `Vᵀ f = 0`, whatever acts beyond. With the momentum `H` of all that moves with
//! the last body, about a place that stands still, and a twist `ξ` of `V` that stays the same,
//!
//! ```text
//! d(ξᵀ H)/dt = ξᵀ f = 0
//! ```
//!
//! So momentum is kept along all of `V` if `V` is the same at all times. It is if no motion of what
//! the chain hangs on, nor of the chain itself, leads out of it:
//!
//! ```text
//! S_a × V ⊂ V    of each column a from the base to the last body
//! ```
//!
//! Gravity is the acceleration of the world, so that the same has to be true of a slide along it.
//! A floating base is such a chain of one body with all six directions. So are a floating joint
//! wherever it hangs, a planar joint that hangs in the world or on slides, chains of x, y and yaw
//! joints in any order, a slide that hangs on slides however heavy these are, and a rotor about an
//! axis that stands still and along which gravity acts or which gravity does not act on.
//!
//! Source: Noether's theorem; subgroups of motions that are normal in those of what they hang on.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::spatial::{Vec6, cross_motion, dot6};

/// A chain of free joints along which momentum is kept; filled by `Tree::tune`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    /// Its tree.
    pub tree: usize,
    /// Its last body: what moves with it keeps its momentum.
    pub body: usize,
    /// Columns of its joints, the slides first.
    pub(super) columns: [usize; 6],
    /// Their places in `q`.
    pub(super) places: [usize; 6],
    /// How many columns there are, and slides among them.
    pub(super) count: usize,
    pub(super) slides: usize,
    /// The nearest of `Tree::kept` that moves with it all that this one does, and more.
    pub outer: Option<usize>,
    /// Whether there is another one of which this is the nearest.
    pub inner: bool,
}

impl Kept {
    /// Columns of its joints, the slides first.
    pub fn columns(&self) -> &[usize] {
        &self.columns[..self.count]
    }

    /// Places of the slides among them in `q`.
    pub fn places(&self) -> &[usize] {
        &self.places[..self.slides]
    }
}

/// A space of twists by an orthonormal basis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Space {
    basis: [Vec6; 6],
    count: usize,
}

impl Space {
    /// Of no twist.
    pub const NONE: Self = Self {
        basis: [[0.0; 6]; 6],
        count: 0,
    };

    /// What of a twist is not in it; none where that is round-off.
    pub fn beside(&self, twist: &Vec6) -> Option<Vec6> {
        let mut rest = *twist;
        // Twice, because the first time leaves round-off of what it has taken away.
        for basis in self.basis[..self.count]
            .iter()
            .chain(&self.basis[..self.count])
        {
            let along = dot6(basis, &rest);
            for (r, b) in rest.iter_mut().zip(basis) {
                *r -= along * b;
            }
        }
        let size = dot6(twist, twist).max(1.0);
        // Half of the digits.
        (dot6(&rest, &rest) > f64::EPSILON * size).then_some(rest)
    }

    /// Adds a twist; tells whether it is not in it yet.
    pub fn add(&mut self, twist: &Vec6) -> bool {
        let Some(rest) = self.beside(twist) else {
            return false;
        };
        let norm = dot6(&rest, &rest).sqrt();
        self.basis[self.count] = rest.map(|r| r / norm);
        self.count += 1;
        true
    }

    /// Whether a motion along a twist leaves it as it is.
    pub fn stays(&self, along: &Vec6) -> bool {
        let mut basis = self.basis[..self.count].iter();
        basis.all(|b| self.beside(&cross_motion(along, b)).is_none())
    }
}
