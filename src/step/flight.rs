//! A robot in flight keeps its momentum.
//!
//! While nothing but gravity acts on a robot from outside, its centre of mass follows a parabola,
//! its linear momentum grows by its weight, and its angular momentum about the centre of mass
//! stays, whatever motors, limits and friction inside do. A step knows this to its own error only.
//! Here the base takes up what the steps of a communication step have lost or made: its velocity
//! and its place change, joints and orientation do not. This is done under error control alone,
//! where it is little: fixed steps that lose momentum lose energy with it, and restoring the
//! momentum would add energy.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::momentum;
use crate::force::Touch;
use crate::kinematics::Kinematics;
use crate::spatial::{Mat3, SpatialInertia, Vec3, angular, linear};
use crate::state::{Physical, State};
use crate::step::attempt::Attempt;
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
    /// nothing pushes them, and they touch nothing. Poses and velocities of `kin` then stand at
    /// `state`; tells whether there are any.
    pub fn begin(
        ctx: &Context,
        state: &State,
        kin: &mut Kinematics,
        flights: &mut Vec<Self>,
    ) -> bool {
        flights.clear();
        let tree = ctx.tree;
        let undisturbed = tree.world.drag == 0.0 && ctx.inputs.wrenches.is_empty();
        if !ctx.rules.momentum || !undisturbed {
            return false;
        }
        let touches = &state.physical.memory.touches;
        for (index, extent) in tree.moved() {
            let held = |touch: &Touch| ctx.model.touches_of(touch.slot).contains(&Some(index));
            if !extent.free || extent.tied || touches.iter().any(held) {
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
    /// whether that is known of any: nothing has touched it since.
    pub fn keep(
        flights: &[Self],
        ctx: &Context,
        state: &State,
        h: f64,
        (kin, attempt): (&mut Kinematics, &mut Attempt),
    ) -> bool {
        let (impulse, rested) = (&state.stepping.impulse, &state.stepping.rested);
        let touched = |flight: &Self| {
            // Something carries what has come to rest, with or without friction.
            if rested[flight.tree] > 0.0 {
                return true;
            }
            let bodies = &ctx.tree.trees[flight.tree].bodies;
            let mut links = ctx.model.links.iter().zip(impulse);
            links
                .any(|(link, J)| bodies.contains(&link.body.index()) && J.iter().any(|x| *x != 0.0))
        };
        if flights.iter().all(touched) {
            return false;
        }
        pose(kin, ctx.tree, &state.physical);
        attempt.stay(state);
        let mut kept = false;
        for flight in flights.iter().filter(|flight| !touched(flight)) {
            kept |= flight.keep_one(ctx, h, kin, &mut attempt.end);
        }
        kept
    }

    /// The same for one tree.
    fn keep_one(&self, ctx: &Context, h: f64, kin: &Kinematics, end: &mut Physical) -> bool {
        let now = Self::of(ctx.tree, kin, self.tree);
        let (mass, gravity) = (now.inertia.mass, ctx.tree.world.gravity);
        let way = self.linear * (h / mass) + gravity * (0.5 * h * h);
        // Differences first: far from the world's origin its digits are few.
        let moved = (self.origin - now.origin) + (self.center - now.center) + way;
        let linear = self.linear + gravity * (mass * h) - now.linear;
        let lost = self.angular - now.angular;
        let turn = now.turn(&lost).unwrap_or_default();
        let velocity = linear / mass - turn.cross(&now.center);
        let finite = |v: &Vec3| v.iter().all(|x| x.is_finite());
        if !(finite(&moved) && finite(&turn) && finite(&velocity)) {
            return false;
        }
        let base = &ctx.tree.bodies[ctx.tree.trees[self.tree].bodies.start];
        let q = &mut end.q[base.coordinate..];
        let v = &mut end.v[base.dof..];
        for i in 0..3 {
            q[i] += moved[i];
            v[i] += turn[i];
            v[3 + i] += velocity[i];
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

    /// Angular velocity, rad/s, that gives the robot `angular` more angular momentum, N·m·s; none
    /// if it is thin.
    fn turn(&self, angular: &Vec3) -> Option<Vec3> {
        inverse(&self.inertia.about_center()).map(|inverse| inverse * angular)
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
