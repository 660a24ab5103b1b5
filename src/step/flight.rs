//! A robot in flight keeps its momentum.
//!
//! While nothing but gravity acts on a robot from outside, its centre of mass flies a parabola, its linear momentum grows by
//! its weight, and its angular momentum about the centre of mass stays: whatever motors, limits and friction inside do.
//! A step knows this to its own error only. Here the base takes up what the steps of a communication step have lost or
//! made: its velocity and its place, which change neither joints nor orientation. Under error control, where that is little;
//! fixed steps that lose momentum lose energy with it, which giving it back would make.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::momentum;
use crate::kinematics::Kinematics;
use crate::spatial::{Mat3, SpatialInertia, Vec3, angular, linear};
use crate::state::State;
use crate::step::control::Stepper;
use crate::step::point::Context;
use crate::tuning::THIN;

/// What a flying robot keeps; world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
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
    /// What stands in poses, inertias and velocities.
    fn of(kin: &Kinematics) -> Self {
        let mut whole = SpatialInertia::default();
        for I in &kin.I {
            whole.add(I);
        }
        let center = Vec3::from(whole.moment) / whole.mass;
        let momentum = momentum(kin);
        let linear = linear(&momentum);
        Self {
            origin: kin.origin,
            center,
            inertia: whole,
            linear,
            angular: angular(&momentum) - center.cross(&linear),
        }
    }

    /// Angular velocity, rad/s, that gives the robot `angular` more angular momentum, N·m·s; none if it is thin.
    fn turn(&self, angular: &Vec3) -> Option<Vec3> {
        let [xx, yy, zz, xy, xz, yz] = self.inertia.rotational;
        let about_origin = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let lever = self.center.cross_matrix();
        let inertia = about_origin + lever * lever * self.inertia.mass;
        let inverse = inertia.try_inverse()?;
        let compact = 1.0 / (inertia.trace() * inverse.trace());
        (compact > THIN).then(|| inverse * angular)
    }
}

impl Stepper {
    /// What the robot keeps if it flies from `state` on: nothing holds it, nothing pushes it, and it touches nothing.
    /// Poses and velocities of `self.end` then stand at `state`.
    pub(super) fn flight(&mut self, ctx: &Context, state: &State) -> Option<Flight> {
        let tree = ctx.tree;
        let free = tree.is_free();
        let undisturbed = tree.world.drag == 0.0 && ctx.inputs.wrenches.is_empty();
        if !ctx.rules.momentum || !free || !undisturbed || !state.memory.touches.is_empty() {
            return None;
        }
        self.end.pose(ctx, state);
        Some(Flight::of(&self.end.kin))
    }

    /// Gives `state`, `h` seconds after the robot was in `flight`, what the robot has kept, if nothing has touched it since.
    pub(super) fn keep_momentum(
        &mut self,
        ctx: &Context,
        state: &mut State,
        flight: &Flight,
        h: f64,
    ) {
        if state.impulse.iter().flatten().any(|x| *x != 0.0) {
            return;
        }
        self.end.pose(ctx, state);
        let now = Flight::of(&self.end.kin);
        let (mass, gravity) = (now.inertia.mass, ctx.tree.world.gravity);
        let way = flight.linear * (h / mass) + gravity * (0.5 * h * h);
        // Differences first: far from the world's origin its digits are few.
        let moved = (flight.origin - now.origin) + (flight.center - now.center) + way;
        let linear = flight.linear + gravity * (mass * h) - now.linear;
        let lost = flight.angular - now.angular;
        let turn = now.turn(&lost).unwrap_or_default();
        let velocity = linear / mass - turn.cross(&now.center);
        let finite = |v: &Vec3| v.iter().all(|x| x.is_finite());
        if finite(&moved) && finite(&turn) && finite(&velocity) {
            for i in 0..3 {
                state.q[i] += moved[i];
                state.v[i] += turn[i];
                state.v[3 + i] += velocity[i];
            }
        }
    }
}
