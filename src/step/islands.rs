//! Islands: trees that cannot meet before the next communication point go there by themselves.
//!
//! A ball that bounces far from a robot would cut the robot's steps short, and the last digits of
//! what the robot does would follow the ball. So the trees are parted at each communication point:
//! those of which shapes may come near each other are one island, and each island has steps of its
//! own.
//!
//! How far a shape may go is a guess: as far as its fastest point goes with its velocity in twice
//! the time, and gravity takes it in twice the time, and some more. What goes farther, because a
//! motor accelerates it or something has thrown it back, might have met another island. Then all
//! islands begin again, with a guess for a longer time, until all have stayed within it.
//!
//! A tree that has rested all through a communication step, and of which nothing has changed since,
//! rests through the next one, too, unless something that moves comes near it or near what it
//! touches. Nothing is computed for it.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{ContactSet, Touch};
use crate::kinematics::Kinematics;
use crate::spatial::Pose;
use crate::state::{State, Stepping};
use crate::step::point::{Context, Point};
use crate::tree::{Extent, Tree, TreeCollider};
use crate::tuning::{CONTACT_MARGIN, ISLAND_TIME};

/// Which trees go together, and scratch of parting them.
#[derive(Clone, Debug)]
pub struct Islands {
    /// The first tree of the island of each tree.
    leader: Vec<usize>,
    /// Where each shape is at the communication point, in the world, and how far any of its points
    /// may go, m; empty where all trees go together.
    limits: Vec<(Pose, f64)>,
    /// Which trees rest, and scenery.
    rest: Vec<bool>,
    /// Whether anything moves in the island that each tree leads.
    awake: Vec<bool>,
    /// What trees remember that are not being moved.
    others: Vec<Touch>,
}

#[cfg(test)]
crate::spoil::spoil!(Islands: leader limits rest awake others;);

impl Islands {
    /// Room for a tree with as many touches.
    pub fn new(tree: &Tree, touches: usize) -> Self {
        Self {
            leader: Vec::with_capacity(tree.trees.len()),
            limits: Vec::with_capacity(tree.contact.colliders.len()),
            rest: Vec::with_capacity(tree.trees.len()),
            awake: Vec::with_capacity(tree.trees.len()),
            others: Vec::with_capacity(touches),
        }
    }

    /// Whether a tree is the first one of an island.
    pub fn leads(&self, tree: usize) -> bool {
        self.leader[tree] == tree
    }

    /// Whether a tree goes with the island of the tree `lead`.
    pub fn takes(&self, tree: usize, lead: usize) -> bool {
        self.leader[tree] == lead
    }

    /// Whether the island of the tree `lead` rests.
    pub fn rests(&self, lead: usize) -> bool {
        self.rest[lead]
    }

    /// Notes which trees would rest if nothing came near; tells whether all do.
    fn find_rest(&mut self, ctx: &Context, stepping: &Stepping) -> bool {
        let may_rest = ctx.rules.rest && !ctx.inputs.varies();
        let rests = |index: usize| {
            may_rest && stepping.rested[index] > 0.0 && stepping.ahead.changed[index] == 0.0
        };
        self.rest.clear();
        let trees = ctx.tree.trees.iter().enumerate();
        self.rest
            .extend(trees.map(|(index, tree)| !tree.moves() || rests(index)));
        self.rest.iter().all(|rests| *rests)
    }

    /// Joins the trees of which shapes may come near each other. What rests is left out, but for
    /// what something that moves comes near to, and what that touches.
    ///
    /// - `times`: how long velocities last, s, and a gap that is near whatever they are, m
    fn join_near(
        &mut self,
        tree: &Tree,
        (contacts, kin): (&mut ContactSet, &Kinematics),
        times: [f64; 2],
    ) {
        let none: &[bool] = &[];
        let first = self.leader[0];
        for resting in [true, false] {
            for (index, tree) in tree.trees.iter().enumerate() {
                // Scenery goes with all.
                self.leader[index] = if tree.moves() { index } else { first };
            }
            let left_out = if resting { &self.rest } else { none };
            tree.join_closed(&mut self.leader);
            contacts.group((tree, kin), times, left_out, &mut self.leader);
            self.awake.clear();
            self.awake.resize(tree.trees.len(), false);
            for (leader, rests) in self.leader.iter().zip(&self.rest) {
                self.awake[*leader] |= !rests;
            }
            let mut trees = tree.trees.iter().zip(&self.rest).zip(&self.leader);
            let awake = &self.awake;
            if !trees.any(|((tree, rests), leader)| tree.moves() && *rests && awake[*leader]) {
                break;
            }
        }
        for (rests, leader) in self.rest.iter_mut().zip(&self.leader) {
            *rests &= !self.awake[*leader];
        }
    }

    /// Parts the trees into islands that do not meet within `span` seconds of `state`; the guess
    /// how far shapes may go is that for `share` times as long. Tells whether there are trees to
    /// part; `ctx` works on all, and what stands at `point` is lost.
    pub fn part(
        &mut self,
        ctx: &Context,
        state: &State,
        point: &mut Point,
        [span, share]: [f64; 2],
    ) -> bool {
        let tree = ctx.tree;
        let moving = tree.trees.iter().filter(|tree| tree.moves()).count();
        self.join_all(tree);
        let all_rest = self.find_rest(ctx, &state.stepping);
        if all_rest || moving < 2 || !ctx.rules.islands || share.is_infinite() {
            if !all_rest {
                self.rest.fill(false);
            }
            return moving > 1;
        }
        point.pose(ctx, &state.physical);
        let Point { kin, terms, .. } = point;
        let h = share * ISLAND_TIME * span;
        let margin = 2.0 * (h * h * tree.world.gravity.norm() + CONTACT_MARGIN);
        let first = self.leader[0];
        self.join_near(tree, (&mut terms.contacts, kin), [h, margin]);
        if self.leader.iter().any(|leader| *leader != first) {
            for collider in &tree.contact.colliders {
                let (_, speed) = kin.ball(collider);
                let reach = h * speed + 0.5 * margin;
                self.limits.push((pose_of(kin, collider), reach));
            }
        }
        true
    }

    /// Sets aside what trees remember that are not being moved.
    pub fn set_aside(&mut self, ctx: &Context, touches: &mut Vec<Touch>) {
        let of_island = |touch: &Touch| is_moved(ctx, touch.slot);
        self.others.clear();
        let others = touches.iter().filter(|touch| !of_island(touch));
        self.others.extend(others);
        touches.retain(of_island);
    }

    /// Takes it back.
    pub fn take_back(&mut self, touches: &mut Vec<Touch>) {
        touches.extend_from_slice(&self.others);
        touches.sort_unstable_by_key(|touch| touch.slot);
    }

    /// One island of all trees.
    fn join_all(&mut self, tree: &Tree) {
        let first = tree.trees.iter().position(Extent::moves);
        self.leader.clear();
        self.leader
            .resize(tree.trees.len(), first.unwrap_or_default());
        self.limits.clear();
    }

    /// Whether there is more than one island.
    pub fn are_limited(&self) -> bool {
        !self.limits.is_empty()
    }

    /// Whether all shapes that a step works on are as near to where they were as was guessed.
    pub fn hold(&self, tree: &Tree, kin: &Kinematics) -> bool {
        if self.limits.is_empty() {
            return true;
        }
        tree.worked_colliders().all(|(place, collider)| {
            let (start, reach) = &self.limits[place];
            let now = pose_of(kin, collider);
            let turned = (now.R - start.R).norm();
            (now.p - start.p).norm() + turned * collider.radius <= *reach
        })
    }
}

/// Whether a contact is one of what a step moves.
pub(super) fn is_moved(ctx: &Context, slot: usize) -> bool {
    let tree = ctx.tree;
    let own = |index: usize| tree.takes(index) && tree.trees[index].moves();
    let trees = ctx.model.touches_of(slot);
    trees.iter().flatten().any(|index| own(*index))
}

/// Pose of a shape in the world.
fn pose_of(kin: &Kinematics, collider: &TreeCollider) -> Pose {
    let mut X = kin.X[collider.body].compose(&collider.X);
    X.p += kin.origins[collider.tree];
    X
}
