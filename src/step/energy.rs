//! What a step has done to the energy of a robot: kinetic, of gravity, and held by springs.
//!
//! The laws take energy in continuous time. A step may give some: it sees the robot as it is at one place of its way. What it
//! gives is measured here, and a step that gives too much is taken otherwise: shorter, or without extrapolation.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::{kinetic, potential};
use crate::dynamics::rnea::about_origin;
use crate::force::detect;
use crate::kinematics::forward;
use crate::spatial::{Vec3, Vec6, angular, dot6, linear};
use crate::state::State;
use crate::step::control::Stepper;
use crate::step::convex::Newton;
use crate::step::point::{Context, Point, stiffness_limit};
use crate::tree::Tree;
use crate::tuning::REFERENCE_GRAVITY;

/// Energy that a fixed step may make out of nothing, as a share of kinetic energy and weight times reach: hundreds of steps
/// together a thousandth.
pub(super) const GAIN: f64 = 1e-5;
/// The same for extrapolation, as a share of the tolerance.
pub(super) const EXTRAPOLATION_GAIN: f64 = 0.05;

/// Energies at the start of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Books {
    /// Kinetic, of gravity, of contacts and limits, and what friction elements hold and may give back.
    held: f64,
    /// What the step may make, a share of kinetic energy and of weight times reach.
    allowed: f64,
}

impl Stepper {
    /// Opens the books on a step from `state`, where `self.start` stands, which may make `share` of kinetic energy and
    /// weight times reach.
    pub(super) fn open_books(&self, ctx: &Context, state: &State, share: f64) -> Books {
        let tree = ctx.tree;
        let Point { kin, terms } = &self.start;
        let moving = kinetic(tree, kin, &state.v);
        Books {
            held: moving
                + terms.friction()
                + potential(tree, kin)
                + terms.springs()
                + self.limits(ctx, &state.q),
            allowed: share * (moving + tree.moving_mass() * REFERENCE_GRAVITY * tree.reach()),
        }
    }

    /// Whether extrapolating the step of `h` seconds from `state` that has just been solved may add more than `share` of
    /// kinetic energy and weight times reach to what the half steps have left: to first order, with springs exact.
    pub(super) fn may_gain(&mut self, ctx: &Context, state: &State, h: f64, share: f64) -> bool {
        // Kinetic energy at twice the half steps' velocity less the full one's, less that at the former, where
        // `M (v − full)` is what the second half step's solve has changed of its guess.
        let mut rise = 0.0;
        let velocities = self.second.v.iter().zip(&self.full.v);
        let changes = self.second.change.iter().zip(&self.second.guessed_change);
        for ((v, full), (change, guessed)) in velocities.zip(changes) {
            rise += (change - guessed) * (1.5 * v - 0.5 * full);
        }
        let (solved, way) = (&self.second, &mut self.end.kin.V);
        let (point, moved) = (&self.middle, &self.difference);
        rise += lifted(ctx.tree, point, solved, 0.5 * h, moved, way);
        self.exceeds(ctx, state, rise, share)
    }

    /// Whether taking the known error off the full solve of `h` seconds from `state` may add more than `share` likewise, where
    /// it moves positions by `self.difference`. `self.end.kin.V` is then the displacement of the bodies.
    pub(super) fn may_gain_singly(
        &mut self,
        ctx: &Context,
        state: &State,
        h: f64,
        share: f64,
    ) -> bool {
        let (tree, lag) = (ctx.tree, &state.lag.velocities);
        let mass = &self.start.kin.M;
        tree.sparsity.multiply(mass, lag, &mut self.guess);
        let mut rise = 0.0;
        for ((momentum, v), lag) in self.guess.iter().zip(&self.full.v).zip(lag) {
            rise -= h * h * momentum * (v - 0.5 * h * h * lag);
        }
        let (solved, way) = (&self.full, &mut self.end.kin.V);
        rise += lifted(tree, &self.start, solved, h, &self.difference, way);
        self.exceeds(ctx, state, rise, share)
    }

    /// Whether `rise`, J, is more than `share` of the kinetic energy of `state` and weight times reach.
    fn exceeds(&self, ctx: &Context, state: &State, rise: f64, share: f64) -> bool {
        let tree = ctx.tree;
        let weight = tree.moving_mass() * REFERENCE_GRAVITY;
        let allowed = share * weight * tree.reach();
        // A number that is none must not pass.
        ctx.rules.energy
            && (rise.is_nan()
                || rise > allowed
                    && rise > allowed + share * kinetic(tree, &self.start.kin, &state.v))
    }

    /// Whether the step to `state` has made more energy than allowed; poses and velocities of `self.end` then stand there.
    ///
    /// - `h`: the step's length, s
    /// - `work`: of motors and external wrenches, J
    pub(super) fn gains(
        &mut self,
        ctx: &Context,
        books: &Books,
        state: &State,
        h: f64,
        work: f64,
    ) -> bool {
        let tree = ctx.tree;
        let kin = &mut self.end.kin;
        kin.update_poses(tree, &state.q);
        kin.update_velocities(tree, &state.v);
        let limit = stiffness_limit(ctx, h);
        let (touches, contacts) = (&state.memory.touches, &mut self.end.terms.contacts);
        detect(ctx.model, tree, touches, kin, 0.0, limit, contacts);
        let held = kinetic(tree, kin, &state.v)
            + potential(tree, kin)
            + self.end.terms.springs()
            + self.limits(ctx, &state.q);
        ctx.rules.energy && held - books.held - work > books.allowed
    }

    /// The same for the explicit step from `state` that has just been tried: nothing touches, and `self.middle` stands at its
    /// end.
    pub(super) fn gains_explicitly(&self, ctx: &Context, books: &Books, state: &State) -> bool {
        let (tree, kin) = (ctx.tree, &self.middle.kin);
        let mut work = 0.0;
        for term in &self.start.terms.joints {
            let place = term.coordinate;
            let way = self.explicit.q[place] - state.q[place];
            work += term.drive_force(state.v[term.dof], 0.0).0 * way;
        }
        let held = kinetic(tree, kin, &self.explicit.v) + potential(tree, kin);
        ctx.rules.energy && held - books.held - work > books.allowed
    }

    /// What the joint limits hold at `q`.
    fn limits(&self, ctx: &Context, q: &[f64]) -> f64 {
        let mut sum = 0.0;
        for term in &self.start.terms.joints {
            if let Some(limits) = &ctx.tree.dofs.limits[term.dof] {
                let q = q[term.coordinate];
                let depth = (limits.lower - q).max(q - limits.upper).max(0.0);
                sum += term.limit.stored(-depth);
            }
        }
        sum
    }
}

/// Work of motors and external wrenches over a solved step of `h` seconds, J.
pub(super) fn work(ctx: &Context, point: &Point, newton: &Newton, h: f64) -> f64 {
    let mut power = 0.0;
    for term in &point.terms.joints {
        let v = newton.v[term.dof];
        power += term.drive_force(v, h).0 * v;
    }
    for wrench in &ctx.inputs.wrenches {
        power += dot6(
            &about_origin(&point.kin, wrench, ctx.elapsed),
            &point.kin.V[wrench.body],
        );
    }
    h * power
}

/// What gravity, contacts and limits take up, J, when positions move by `more` after the step of `h` seconds that has been
/// solved from `point`; the bodies' displacements go into `way`.
fn lifted(
    tree: &Tree,
    point: &Point,
    solved: &Newton,
    h: f64,
    more: &[f64],
    way: &mut [Vec6],
) -> f64 {
    let kin = &point.kin;
    forward(tree, &kin.S, more, way);
    let mut rise = 0.0;
    for (body, (I, way)) in tree.bodies.iter().zip(kin.I.iter().zip(way.iter())) {
        if body.kind.moves() {
            let torque = Vec3::from(I.moment).cross(&tree.world.gravity);
            rise -= torque.dot(&angular(way)) + I.mass * tree.world.gravity.dot(&linear(way));
        }
    }
    for (contact, v) in point.terms.contacts.iter().zip(&solved.at.points) {
        let depth = -contact.gap - h * contact.normal.dot(v);
        rise += contact
            .spring
            .taken_up(depth, -contact.normal_velocity(way));
    }
    for term in &point.terms.joints {
        let (v, more) = (solved.v[term.dof], more[term.dof]);
        let [lower, upper] = term.gap;
        rise += term.limit.taken_up(-lower - h * v, -more);
        rise += term.limit.taken_up(-upper + h * v, more);
    }
    rise
}
