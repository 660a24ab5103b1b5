//! Which contacts belong to the pairs that the outputs name, see
//! [`crate::model::OutputSelection::pairs`].

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::contact::{Contact, normal_part};
use crate::kinematics::Kinematics;
use crate::model::{LinkId, Model};
use crate::spatial::{Vec3, Vec6, velocity_at};
use crate::tree::Tree;

/// The side of each named pair that a link is on. It follows from the model and never changes.
#[derive(Clone, Debug)]
pub struct NamedPairs {
    /// Number of named pairs, and of links.
    pairs: usize,
    links: usize,
    /// Per link, and last for the ground: one for each named pair.
    sides: Vec<Option<Side>>,
}

/// One of the two sides of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    First,
    Second,
}

impl NamedPairs {
    /// Those of a model.
    #[cfg_attr(small, optimize(size))]
    pub fn new(model: &Model) -> Self {
        let (pairs, links) = (model.outputs.pairs.len(), model.links.len());
        let mut sides = vec![None; pairs * (links + 1)];
        for (p, pair) in model.outputs.pairs.iter().enumerate() {
            for (side, members) in [Side::First, Side::Second].into_iter().zip(&pair.sides) {
                for member in members {
                    let link = member.map_or(links, LinkId::index);
                    sides[link * pairs + p] = Some(side);
                }
            }
        }
        Self {
            pairs,
            links,
            sides,
        }
    }

    /// What the first side of a pair gets of the force of a contact on the first of two `links`, of
    /// which none is the ground: all, all reversed, or nothing where the contact is not one between
    /// its sides.
    #[inline]
    pub fn share(&self, pair: usize, links: [Option<usize>; 2]) -> f64 {
        let side = |link: Option<usize>| self.sides[link.unwrap_or(self.links) * self.pairs + pair];
        match links.map(side) {
            [Some(Side::First), Some(Side::Second)] => 1.0,
            [Some(Side::Second), Some(Side::First)] => -1.0,
            _ => 0.0,
        }
    }
}

impl Contact {
    /// The link that it pushes, and the one that is pushed back; none is the ground.
    pub fn links(&self) -> [Option<usize>; 2] {
        [Some(self.link), self.other_link]
    }

    /// What a link gets of its force: all, all reversed, or nothing.
    pub fn share_of(&self, link: usize) -> f64 {
        if self.link == link {
            1.0
        } else if self.other_link == Some(link) {
            -1.0
        } else {
            0.0
        }
    }

    /// O of the tree of its first body, seen from O of the tree of `link`, one of its two, m. That
    /// may be a link which never moves, too.
    pub fn seen_from(&self, (model, tree): (&Model, &Tree), kin: &Kinematics, link: usize) -> Vec3 {
        if self.link == link {
            return Vec3::zeros();
        }
        let body = model.links[link].body.index();
        kin.origin(tree, self.body) - kin.origin(tree, body)
    }

    /// How fast its two shapes slide on each other at the centre of its load, m/s, for the
    /// velocities of all bodies.
    pub fn slip_speed(&self, V: &[Vec6]) -> f64 {
        let (_, along) = normal_part(&self.normal, &velocity_at(&self.relative(V), &self.center));
        (along + self.carried).norm()
    }
}
