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

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::Touch;
use crate::kinematics::Kinematics;
use crate::spatial::Pose;
use crate::state::State;
use crate::step::driver::{Stepper, Stop};
use crate::step::point::Context;
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
    /// What trees remember that are not being moved, by ascending slots.
    others: Vec<Touch>,
    /// Scratch of joining them.
    joined: Vec<Touch>,
}

#[cfg(test)]
crate::spoil::spoil!(Islands: leader limits others joined;);

impl Islands {
    /// Room for a tree with as many touches.
    pub fn new(tree: &Tree, touches: usize) -> Self {
        Self {
            leader: Vec::with_capacity(tree.trees.len()),
            limits: Vec::with_capacity(tree.contact.colliders.len()),
            others: Vec::with_capacity(touches),
            joined: Vec::with_capacity(touches),
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

/// Pose of a shape in the world.
fn pose_of(kin: &Kinematics, collider: &TreeCollider) -> Pose {
    let mut X = kin.X[collider.body].compose(&collider.X);
    X.p += kin.origins[collider.tree];
    X
}

impl Stepper {
    /// Begins a communication step from `state` to `end`.
    pub fn begin(&mut self, state: &mut State, end: f64) {
        self.backup.copy_from(state);
        (self.tried, self.implicit.iterations, self.stages.iterations) = (0, 0, 0);
        state.stepping.last_step = end - state.time;
        state.stepping.impulse.fill([0.0; 3]);
        // What no term writes is what the state has.
        self.attempt.stay(state);
    }

    /// Begins it again.
    pub fn begin_again(&mut self, state: &mut State, end: f64) {
        let tried = self.tried;
        state.copy_from(&self.backup);
        self.begin(state, end);
        self.tried = tried;
    }

    /// Parts the trees into islands that do not meet within `span` seconds of `state`; the guess
    /// how far shapes may go is that for `share` times as long. Tells whether there are trees to
    /// part; `ctx` works on all.
    pub fn part(&mut self, ctx: &Context, state: &State, span: f64, share: f64) -> bool {
        let tree = ctx.tree;
        let moving = tree.trees.iter().filter(|tree| tree.moves()).count();
        self.islands.join_all(tree);
        if moving < 2 || !ctx.rules.islands || share.is_infinite() {
            return moving > 1;
        }
        let (kin, islands) = (&mut self.there.kin, &mut self.islands);
        kin.update_poses(tree, &state.physical.q);
        kin.update_velocities(tree, &state.physical.v);
        let h = share * ISLAND_TIME * span;
        let margin = 2.0 * (h * h * tree.world.gravity.norm() + CONTACT_MARGIN);
        let first = islands.leader[0];
        for (index, tree) in tree.trees.iter().enumerate() {
            // Scenery goes with all.
            islands.leader[index] = if tree.moves() { index } else { first };
        }
        let contacts = &mut self.there.terms.contacts;
        contacts.group(tree, kin, [h, margin], &mut islands.leader);
        if islands.leader.iter().all(|leader| *leader == first) {
            return true;
        }
        for collider in &tree.contact.colliders {
            let (_, speed) = kin.ball(collider);
            let reach = h * speed + 0.5 * margin;
            islands.limits.push((pose_of(kin, collider), reach));
        }
        true
    }

    /// Begins with an island, whose trees `ctx` works on: what it remembers is that of all its
    /// trees together.
    pub fn enter(&mut self, ctx: &Context, state: &mut State) {
        let (tree, stepping) = (ctx.tree, &mut state.stepping);
        let lead = tree.island.lead;
        let sizes = &mut stepping.sizes;
        for (index, _) in tree.moved() {
            sizes.proposed[lead] = sizes.proposed[lead].min(sizes.proposed[index]);
            sizes.after_jump[lead] = sizes.after_jump[lead].min(sizes.after_jump[index]);
            sizes.floor[lead] = sizes.floor[lead].max(sizes.floor[index]);
        }
        if !stepping.ahead.is_under_way(tree) {
            stepping.ahead.clear(tree);
        }
        let touches = &mut state.physical.memory.touches;
        let of_island = |touch: &Touch| {
            let trees = ctx.model.touches_of(touch.slot);
            let own = |index: usize| tree.takes(index) && tree.trees[index].moves();
            trees.iter().flatten().any(|index| own(*index))
        };
        let others = touches.iter().filter(|touch| !of_island(touch));
        self.islands.others.clear();
        self.islands.others.extend(others);
        touches.retain(of_island);
        for point in [&mut self.here, &mut self.there, &mut self.stages.middle] {
            point.terms.select(ctx.model, tree);
        }
        // Of other trees, a try holds what the state does.
        self.attempt.stay(state);
    }

    /// Ends with an island: each of its trees remembers what the island does.
    pub fn leave(&mut self, ctx: &Context, state: &mut State) {
        let (tree, sizes) = (ctx.tree, &mut state.stepping.sizes);
        let lead = tree.island.lead;
        for (index, _) in tree.moved() {
            sizes.proposed[index] = sizes.proposed[lead];
            sizes.after_jump[index] = sizes.after_jump[lead];
            sizes.floor[index] = sizes.floor[lead];
        }
        let (touches, Islands { others, joined, .. }) =
            (&mut state.physical.memory.touches, &mut self.islands);
        joined.clear();
        let mut own = touches.iter().peekable();
        for other in others.iter() {
            while let Some(touch) = own.next_if(|touch| touch.slot < other.slot) {
                joined.push(*touch);
            }
            joined.push(*other);
        }
        joined.extend(own);
        touches.clear();
        touches.extend_from_slice(joined);
    }

    /// Ends a communication step that has led to `result` at `end`.
    ///
    /// # Errors
    /// [`Stop`] of `result`; `state` is then what it was.
    pub fn end(
        &mut self,
        ctx: &Context,
        state: &mut State,
        end: f64,
        result: Result<(), Stop>,
    ) -> Result<(), Stop> {
        if result.is_err() {
            state.copy_from(&self.backup);
            return result;
        }
        state.time = end;
        let stepping = &mut state.stepping;
        stepping.ahead.changed.fill(0.0);
        let newton_max = &mut stepping.counters.newton_max;
        let iterations = self.implicit.iterations.max(self.stages.iterations);
        *newton_max = (*newton_max).max(iterations as u64);
        for (index, last) in stepping.commands.iter_mut().enumerate() {
            *last = ctx.inputs.values(index, stepping.last_step);
        }
        Ok(())
    }

    /// Whether what stands at `self.here` has stayed where its island may go.
    pub(super) fn check_limits(&self, ctx: &Context) -> Result<(), Stop> {
        if self.islands.hold(ctx.tree, &self.here.kin) {
            Ok(())
        } else {
            Err(Stop::Strayed)
        }
    }
}
