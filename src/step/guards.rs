//! Checks that a try does not add energy: kinetic, potential, and stored by springs.
//!
//! The laws dissipate energy in continuous time. A step may add some, because it uses the robot's
//! position at one time of the step. The gain is measured here; a step that adds too much is
//! replaced by shorter ones.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::dynamics::energy::{kinetic, potential};
use crate::dynamics::rnea::about_origin;
use crate::force::{self, Drive, JointTerm, Terms};
use crate::inputs::ExternalWrench;
use crate::kinematics::Kinematics;
use crate::spatial::dot6;
use crate::state::Physical;
use crate::step::convex::Newton;
use crate::step::point::{Context, Point};
use crate::tree::{Extent, Tree};
use crate::tuning::{DRAINED, MENDED_GAIN, REFERENCE_GRAVITY};

/// Energies at the start of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Books {
    /// Kinetic, of gravity, of contacts and limits, and what friction elements hold and may give
    /// back.
    held: f64,
    /// What the step may make, a share of kinetic energy and of weight times reach.
    allowed: f64,
    /// What it may make without being solved again, as a multiple of that.
    pub(super) mended: f64,
    /// Kinetic energy and weight times reach.
    whole: f64,
}

impl Books {
    /// Whether the method has taken more than a share of these energies in a part of a fixed step.
    pub(super) fn are_drained(&self, lost: f64, part: f64) -> bool {
        lost > DRAINED * part * self.whole
    }
}

/// Energies at the start of a step from where `here` stands, which may add `share` of kinetic
/// energy and of weight times reach.
pub(super) fn open_books(ctx: &Context, here: &Point, from: &Physical, share: f64) -> Books {
    let tree = ctx.tree;
    let Point { kin, terms, .. } = here;
    let moving = kinetic(tree, kin, &from.v);
    let whole = moving + fall(tree);
    Books {
        held: moving
            + terms.friction()
            + potential(tree, kin)
            + terms.springs()
            + limits(tree, here, &from.q),
        mended: (MENDED_GAIN / share).min(1.0),
        allowed: share * whole,
        whole,
    }
}

/// Weight times reach, J.
fn fall(tree: &Tree) -> f64 {
    tree.moving_mass() * REFERENCE_GRAVITY * tree.reach()
}

/// Whether the energy, J, that a step to `end` has taken is more than a share of kinetic energy and
/// of weight times reach.
///
/// - `kin`: has the poses there; its velocities are overwritten
pub(super) fn takes(
    ctx: &Context,
    kin: &mut Kinematics,
    end: &Physical,
    [taken, share]: [f64; 2],
) -> bool {
    let fall = fall(ctx.tree);
    ctx.rules.energy && taken > share * fall && {
        kin.update_velocities(ctx.tree, &end.v);
        taken > share * (kinetic(ctx.tree, kin, &end.v) + fall)
    }
}

/// Whether the step to `end` has made more energy than allowed, see [`gain`], or has missed that
/// shapes have met.
pub(super) fn spoils(
    ctx: &Context,
    books: &Books,
    (here, there): (&Point, &mut Point),
    end: &Physical,
    [h, work]: [f64; 2],
) -> bool {
    gain(ctx, books, (here, there), end, work) > 1.0 || has_missed(ctx, (here, there), h)
}

/// Whether shapes have met in the step of `h` seconds from `here` that it knows nothing of. Poses
/// and velocities of `there` stand at its end; they do after [`gain`].
pub(super) fn has_missed(ctx: &Context, (here, there): (&Point, &mut Point), h: f64) -> bool {
    let Point { kin, terms, .. } = there;
    let known = &here.terms.contacts;
    terms.contacts.has_missed(ctx.tree, kin, h, known)
}

/// Energy that the step to `end` has made, as a multiple of what is allowed; poses and velocities
/// of `there` then stand at its end.
///
/// - `work`: of motors and external wrenches, J
pub(super) fn gain(
    ctx: &Context,
    books: &Books,
    (here, there): (&Point, &mut Point),
    end: &Physical,
    work: f64,
) -> f64 {
    let tree = ctx.tree;
    let Point { kin, terms, .. } = there;
    kin.update_poses(tree, &end.q);
    kin.update_velocities(tree, &end.v);
    let held = kinetic(tree, kin, &end.v)
        + potential(tree, kin)
        + force::held(ctx.model, tree, kin, &mut terms.contacts)
        + force::held_by_springs(tree, kin)
        + limits(tree, here, &end.q);
    if ctx.rules.energy && is_booked(tree) {
        (held - books.held - work) / books.allowed
    } else {
        0.0
    }
}

/// Whether all work is known: what drives a base works on the joints and loops that hang on it,
/// too, which nothing counts.
fn is_booked(tree: &Tree) -> bool {
    let bare = |(_, tree): (usize, &Extent)| {
        tree.driven.is_none() || tree.bodies.len() == 1 && !tree.closed
    };
    tree.moved().all(bare)
}

/// The same for an explicit step of `h` seconds: nothing touches. Less than nothing is what it has
/// taken.
///
/// - `end`: where it ends, and poses and velocities there
pub(super) fn gain_explicitly(
    ctx: &Context,
    books: &Books,
    here: &Point,
    (from, h): (&Physical, f64),
    (end, kin): (&Physical, &Kinematics),
) -> f64 {
    let (first, last) = (ctx.elapsed, ctx.elapsed + h);
    let powers = [
        push(ctx, (&here.kin, &from.v), first),
        push(ctx, (kin, &end.v), last),
    ];
    let mut work = 0.5 * h * (powers[0] + powers[1]);
    for term in &here.terms.joints {
        let (place, dof) = (term.coordinate, term.dof);
        let way = end.q[place] - from.q[place];
        let (mut last, _) = term.drive_force(end.v[dof], 0.0);
        if let Drive::Pd { kp, cap, .. } = term.drive {
            last = (last - kp * way).clamp(-cap, cap);
        }
        work += 0.5 * (term.drive_force(from.v[dof], 0.0).0 + last) * way;
    }
    let held = kinetic(ctx.tree, kin, &end.v)
        + potential(ctx.tree, kin)
        + force::held_by_springs(ctx.tree, kin);
    if ctx.rules.energy && ctx.tree.driven().next().is_none() {
        (held - books.held - work) / books.allowed
    } else {
        0.0
    }
}

/// Whether nothing takes energy but what [`gain_explicitly`] counts to the last digits: no damper,
/// no air, no law of a motor, no wrench that changes.
pub(super) fn is_kept(ctx: &Context, terms: &Terms) -> bool {
    let pd = |term: &JointTerm| matches!(term.drive, Drive::Pd { .. });
    let mut springs = ctx.tree.springs.iter();
    ctx.tree.world.drag <= 0.0
        && ctx.inputs.wrenches.is_empty()
        && springs.all(|spring| spring.damping <= 0.0)
        && !terms.joints.iter().any(|t| t.damping > 0.0 || pd(t))
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

/// Work of motors, external wrenches, surfaces that move and driven bases over a solved step, J.
///
/// - `h`: its length, s
/// - `when`: time since the communication point of which it has taken the external wrenches, s
pub(super) fn work(
    ctx: &Context,
    kin: &Kinematics,
    (terms, newton): (&Terms, &Newton),
    [h, when]: [f64; 2],
) -> f64 {
    let mut power = push(ctx, (kin, &newton.v), when);
    power += newton.driving_power((ctx.tree, terms), h);
    for term in &terms.joints {
        let v = newton.v[term.dof];
        power += term.drive_force(v, h).0 * v;
    }
    for (contact, r) in terms.contacts.iter().zip(&newton.responses.contacts) {
        power += r.friction.force.dot(&contact.carried);
    }
    h * power
}

/// Power of external wrenches, W.
///
/// - `kin`: poses, with the velocities there
/// - `when`: time since the communication point, s
fn push(ctx: &Context, (kin, v): (&Kinematics, &[f64]), when: f64) -> f64 {
    let tree = ctx.tree;
    let takes = |body: usize| tree.takes(tree.bodies[body].tree);
    let wrenches = ctx.inputs.wrenches.iter().filter(|w| takes(w.body));
    let power = |w: &ExternalWrench| {
        let wrench = about_origin(kin, w, when);
        let along = |c: usize| dot6(&wrench, &kin.S[c]) * v[tree.dof[c]];
        tree.columns_to(w.body).map(along).sum::<f64>()
    };
    wrenches.map(power).sum()
}
