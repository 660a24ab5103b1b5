//! Checks that a try does not add energy: kinetic, potential, and stored by springs.
//!
//! The laws dissipate energy in continuous time. A step may add some, because it uses the robot's
//! position at one time of the step. The gain is measured here, and a step that adds too much is
//! replaced by a shorter one or by one without extrapolation.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::{kinetic, potential};
use crate::dynamics::rnea::about_origin;
use crate::force::detect;
use crate::kinematics::{Kinematics, forward};
use crate::spatial::{Vec3, Vec6, angular, dot6, linear};
use crate::state::Physical;
use crate::step::convex::Newton;
use crate::step::point::{Context, Point, stiffness_limit};
use crate::tree::Tree;
use crate::tuning::REFERENCE_GRAVITY;

/// Energies at the start of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Books {
    /// Kinetic, of gravity, of contacts and limits, and what friction elements hold and may give
    /// back.
    held: f64,
    /// What the step may make, a share of kinetic energy and of weight times reach.
    allowed: f64,
}

/// Opens the books on a step from where `here` stands, which may make `share` of kinetic energy and
/// weight times reach.
pub(super) fn open_books(ctx: &Context, here: &Point, from: &Physical, share: f64) -> Books {
    let tree = ctx.tree;
    let Point { kin, terms } = here;
    let moving = kinetic(tree, kin, &from.v);
    Books {
        held: moving
            + terms.friction()
            + potential(tree, kin)
            + terms.springs()
            + limits(tree, here, &from.q),
        allowed: share * (moving + tree.moving_mass() * REFERENCE_GRAVITY * tree.reach()),
    }
}

/// Whether `rise`, J, is more than `share` of the kinetic energy where `here` stands and of weight
/// times reach.
pub(super) fn exceeds(
    ctx: &Context,
    here: &Point,
    from: &Physical,
    [rise, share]: [f64; 2],
) -> bool {
    let tree = ctx.tree;
    let weight = tree.moving_mass() * REFERENCE_GRAVITY;
    let allowed = share * weight * tree.reach();
    // NaN must not pass.
    ctx.rules.energy
        && (rise.is_nan()
            || rise > allowed && rise > allowed + share * kinetic(tree, &here.kin, &from.v))
}

/// Whether the step to `end` has made more energy than allowed; poses and velocities of `there`
/// then stand at its end.
///
/// - `h`: the step's length, s
/// - `work`: of motors and external wrenches, J
pub(super) fn gains(
    ctx: &Context,
    books: &Books,
    (here, there): (&Point, &mut Point),
    end: &Physical,
    [h, work]: [f64; 2],
) -> bool {
    let tree = ctx.tree;
    let Point { kin, terms } = there;
    kin.update_poses(tree, &end.q);
    kin.update_velocities(tree, &end.v);
    let limit = stiffness_limit(ctx, h);
    let (touches, contacts) = (&end.memory.touches, &mut terms.contacts);
    detect(ctx.model, tree, touches, kin, 0.0, limit, contacts);
    let held = kinetic(tree, kin, &end.v)
        + potential(tree, kin)
        + terms.springs()
        + limits(tree, here, &end.q);
    ctx.rules.energy && held - books.held - work > books.allowed
}

/// The same for an explicit step: nothing touches.
///
/// - `end`: where it ends, and poses and velocities there
pub(super) fn gains_explicitly(
    ctx: &Context,
    books: &Books,
    here: &Point,
    from: &Physical,
    (end, kin): (&Physical, &Kinematics),
) -> bool {
    let mut work = 0.0;
    for term in &here.terms.joints {
        let place = term.coordinate;
        let way = end.q[place] - from.q[place];
        work += term.drive_force(from.v[term.dof], 0.0).0 * way;
    }
    let held = kinetic(ctx.tree, kin, &end.v) + potential(ctx.tree, kin);
    ctx.rules.energy && held - books.held - work > books.allowed
}

/// What the joint limits hold at `q`, J.
fn limits(tree: &Tree, here: &Point, q: &[f64]) -> f64 {
    let mut sum = 0.0;
    for term in &here.terms.joints {
        if let Some(limits) = &tree.dofs.limits[term.dof] {
            let q = q[term.coordinate];
            let depth = (limits.lower - q).max(q - limits.upper).max(0.0);
            sum += term.limit.stored(-depth);
        }
    }
    sum
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

/// What gravity, contacts and limits take up, J, when positions move by `more` after the step of
/// `h` seconds that has been solved from `point`; the bodies' displacements go into `way`.
pub(super) fn lifted(
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
