//! A robot in flight keeps its momentum.
//!
//! While nothing but gravity acts on a robot from outside, its centre of mass follows a parabola,
//! its linear momentum grows by its weight, and its angular momentum about the centre of mass
//! stays, whatever motors, limits and friction inside do. The same is true of several trees that
//! push each other and nothing else, as a gripper in space and what it holds: see
//! [`super::company`]. A step knows this to its own error only: its lever arms and inertias are
//! those of its middle, and what turns or slides within it gets the impulse of a contact in
//! another place.
//!
//! Here the bases take up what the steps of a communication step have lost or made: velocities and
//! places change, joints and orientations do not. All trees of a company turn and move as one rigid
//! body, which of all changes of velocity that restore the momentum has the least kinetic energy.
//! This is done under error control alone, where it is little: fixed steps that lose momentum lose
//! energy with it, and restoring the momentum would add energy.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::momentum;
use crate::kinematics::Kinematics;
use crate::spatial::{Mat3, SpatialInertia, Vec3, angular, linear};
use crate::state::{Physical, State};
use crate::step::attempt::Attempt;
use crate::step::company::Company;
use crate::step::point::Context;
use crate::tree::Tree;
use crate::tuning::THIN;

/// What a flying tree keeps; world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    /// Index of the tree.
    tree: usize,
    /// The base's origin, m.
    origin: Vec3,
    /// The centre of mass, from the base's origin, m.
    center: Vec3,
    /// Of all bodies, about the base's origin.
    inertia: SpatialInertia,
    /// Linear momentum, N·s.
    linear: Vec3,
    /// Angular momentum about the centre of mass, N·m·s.
    angular: Vec3,
}

impl Flight {
    /// Which trees fly from `state` on, and what they keep, into `flights`: nothing holds them,
    /// nothing pushes them, and they touch nothing but what flies with them. Poses and velocities
    /// of `kin` then stand at `state`; tells whether there are any.
    pub fn begin(
        ctx: &Context,
        state: &State,
        (kin, company): (&mut Kinematics, &mut Company),
        flights: &mut Vec<Self>,
    ) -> bool {
        flights.clear();
        let tree = ctx.tree;
        let undisturbed = tree.world.drag == 0.0 && ctx.inputs.wrenches.is_empty();
        let may_fly = |index: usize| tree.takes(index) && tree.trees[index].is_loose();
        company.part(|index| ctx.rules.momentum && undisturbed && may_fly(index));
        for touch in &state.physical.memory.touches {
            company.join(ctx.model.touches_of(touch.slot));
        }
        company.accept();
        company.ground();
        company.separate();
        for (index, _) in tree.moved() {
            if !company.flies(index) {
                continue;
            }
            if flights.is_empty() {
                pose(kin, tree, &state.physical);
            }
            flights.push(Self::of(tree, kin, index));
        }
        !flights.is_empty()
    }

    /// What trees should be in that have flown, `h` seconds later in `state`, into `attempt`; tells
    /// whether that is known of any: nothing that is held has touched it since.
    pub fn keep(
        flights: &[Self],
        ctx: &Context,
        state: &State,
        h: f64,
        (kin, attempt): (&mut Kinematics, &mut Attempt),
    ) -> bool {
        let company = &mut attempt.company;
        for flight in flights {
            // Something carries what has come to rest, with or without friction.
            if state.stepping.rested[flight.tree] > 0.0 {
                company.keep_down(flight.tree);
            }
        }
        company.ground();
        if !flights.iter().any(|flight| company.flies(flight.tree)) {
            return false;
        }
        pose(kin, ctx.tree, &state.physical);
        attempt.stay(state);
        let Attempt { company, end, .. } = attempt;
        let mut kept = false;
        for first in flights {
            if company.flies(first.tree) && company.leader(first.tree) == first.tree {
                let members = flights.iter();
                let members = members.filter(|f| company.leader(f.tree) == first.tree);
                kept |= Self::keep_all(members, ctx, h, kin, end);
            }
        }
        kept
    }

    /// The same for the trees of one company.
    fn keep_all<'a>(
        members: impl Iterator<Item = &'a Self> + Clone,
        ctx: &Context,
        h: f64,
        kin: &Kinematics,
        end: &mut Physical,
    ) -> bool {
        let now = |flight: &Self| Self::of(ctx.tree, kin, flight.tree);
        let before = Together::of(members.clone().copied());
        let after = Together::of(members.clone().map(now));
        let (mass, gravity) = (before.mass, ctx.tree.world.gravity);
        let mut moved = before.linear * (h / mass) + gravity * (0.5 * h * h);
        for flight in members.clone() {
            // Differences first: far from the world's origin its digits are few.
            let now = now(flight);
            let back = (flight.origin - now.origin) + (flight.center - now.center);
            moved += back * (flight.inertia.mass / mass);
        }
        let linear = before.linear + gravity * (mass * h) - after.linear;
        let lost = before.angular - after.angular;
        let turn = inverse(&after.inertia).map_or_else(Vec3::zeros, |inverse| inverse * lost);
        let finite = |v: &Vec3| v.iter().all(|x| x.is_finite());
        if ![moved, turn, linear].iter().all(finite) {
            return false;
        }
        for flight in members {
            let now = now(flight);
            let velocity = linear / mass - turn.cross(&(now.center - after.lever(&now)));
            let base = &ctx.tree.bodies[ctx.tree.trees[flight.tree].bodies.start];
            let q = &mut end.q[base.coordinate..];
            let v = &mut end.v[base.dof..];
            for i in 0..3 {
                q[i] += moved[i];
                v[i] += turn[i];
                v[3 + i] += velocity[i];
            }
        }
        true
    }

    /// What stands in poses, inertias and velocities of the tree `index`.
    fn of(tree: &Tree, kin: &Kinematics, index: usize) -> Self {
        let bodies = &tree.trees[index].bodies;
        let mut whole = SpatialInertia::default();
        for I in &kin.I[bodies.clone()] {
            whole.add(I);
        }
        let center = whole.center();
        let momentum = momentum(kin, bodies.clone());
        let linear = linear(&momentum);
        Self {
            tree: index,
            origin: kin.origins[index],
            center,
            inertia: whole,
            linear,
            angular: angular(&momentum) - center.cross(&linear),
        }
    }
}

/// What several trees are together.
struct Together {
    /// kg
    mass: f64,
    /// Origin of the base of the first one, m, and the common centre of mass from there, m.
    origin: Vec3,
    center: Vec3,
    /// About the common centre of mass.
    inertia: Mat3,
    /// Linear momentum, N·s.
    linear: Vec3,
    /// Angular momentum about the common centre of mass, N·m·s.
    angular: Vec3,
}

impl Together {
    fn of(trees: impl Iterator<Item = Flight> + Clone) -> Self {
        let zero = Vec3::zeros();
        let mut whole = Self {
            mass: trees.clone().map(|tree| tree.inertia.mass).sum(),
            origin: trees.clone().next().map_or(zero, |first| first.origin),
            center: zero,
            inertia: Mat3::zeros(),
            linear: zero,
            angular: zero,
        };
        let share = |tree: Flight| whole.lever(&tree) * (tree.inertia.mass / whole.mass);
        whole.center = trees
            .clone()
            .map(share)
            .fold(zero, |sum, lever| sum + lever);
        for tree in trees {
            let lever = whole.lever(&tree);
            let across = lever.cross_matrix();
            whole.inertia += tree.inertia.about_center() - across * across * tree.inertia.mass;
            whole.linear += tree.linear;
            whole.angular += tree.angular + lever.cross(&tree.linear);
        }
        whole
    }

    /// Centre of mass of one of them, from the common one, m.
    fn lever(&self, tree: &Flight) -> Vec3 {
        (tree.origin - self.origin) + tree.center - self.center
    }
}

/// Inverse of an inertia about a centre of mass; none of what is thin.
pub(super) fn inverse(inertia: &Mat3) -> Option<Mat3> {
    let inverse = inertia.try_inverse()?;
    let compact = 1.0 / (inertia.trace() * inverse.trace());
    (compact > THIN).then_some(inverse)
}

/// Poses and velocities of what a robot is in.
fn pose(kin: &mut Kinematics, tree: &Tree, physical: &Physical) {
    kin.update_poses(tree, &physical.q);
    kin.update_velocities(tree, &physical.v);
}

#[cfg(test)]
crate::spoil::spoil!(Flight: tree origin center inertia linear angular;);
