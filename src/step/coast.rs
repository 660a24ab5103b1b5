//! A rigid body on which nothing acts but gravity.
//!
//! Its centre of mass follows a parabola, and it turns by Euler's equations alone. The stages of a
//! step take it along with what it may meet, and know its turn to the third order: a body that
//! whirls among others gained or lost energy in every step, and since its angular momentum is kept
//! ([`super::flight`]) its axis went over to that of the least or largest inertia. Where the solved
//! step has no force on such a body, its end is that of the body alone. The steps stay as short as
//! the stages' error asks: a corner that sweeps through a step may meet something.
//!
//! A body that nothing comes near takes no other step at all: Runge–Kutta steps make errors of
//! angles, which grow with the square of the time, and these do not.
//!
//! 1. In axes that turn with the body, with `w` its angular velocity and `I` its inertia about the
//!    centre of mass, Euler's equations are `I ẇ = −w × I w`. One implicit midpoint step of `s`
//!    seconds solves `I (w₁ − w₀) = −s w × I w` with `w = (w₀ + w₁)/2`.
//! 2. Multiplied by `w` this keeps the energy `½ w·I w`. With the turn `Q₁ = Q₀ cay(s w)` it keeps
//!    the angular momentum `Q I w` in the world: `(1 − s ŵ/2)⁻¹ (1 + s ŵ/2) I w₁ = I w₀` says the
//!    same as 1. Both are kept to the last digits.
//! 3. Three of them, of `g s`, `(1 − 2 g) s` and `g s` with `g = 1/(2 − ∛2)`, are of the fourth
//!    order: what is left of an error is in the angle about the axes.
//!
//! Source: Yoshida 1990 (composition); Hairer, Lubich & Wanner 2006, section VII.5 (rigid bodies).

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::force::{Contact, Terms};
use crate::kinematics::Kinematics;
use crate::spatial::{
    Mat3, Vec3, quaternion_normalized, quaternion_product, rotation_from_quaternion,
};
use crate::state::Physical;
use crate::step::convex::Newton;
use crate::step::point::Context;
use crate::tuning::{COASTING_ACCURACY, COASTING_ITERATIONS, COASTING_MOST, COASTING_TURN, THIN};

/// `1/(2 − ∛2)`.
const OUTER: f64 = 1.351_207_191_959_657_8;

/// A step of `h` seconds from a place that has been solved in two stages.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    /// That place.
    pub from: &'a Physical,
    /// s
    pub h: f64,
    /// What acts in each stage.
    pub terms: &'a [Terms; 2],
    /// Solution of each stage.
    pub solved: &'a [Newton; 2],
}

/// Whether the tree `index` is one free body on which nothing but contacts acts in a step.
fn is_rigid(ctx: &Context, index: usize) -> bool {
    let tree = ctx.tree;
    let extent = &tree.trees[index];
    let base = extent.bodies.start;
    let alone = extent.bodies.len() == 1 && !extent.tied;
    let rigid = extent.free && alone && tree.carrier[base].is_some();
    if !ctx.rules.coast || !rigid || tree.world.drag != 0.0 {
        return false;
    }
    let mut wrenches = ctx.inputs.wrenches.iter();
    !wrenches.any(|wrench| extent.bodies.contains(&wrench.body))
}

/// Whether the tree `index` is one free body on which nothing acts in a step.
fn coasts(ctx: &Context, index: usize, step: Step) -> bool {
    if !is_rigid(ctx, index) {
        return false;
    }
    let own = |c: &Contact| ctx.model.touches_of(c.slot).contains(&Some(index));
    let pushed = |(terms, solved): (&Terms, &Newton)| {
        let (list, responses) = (&terms.contacts.list, &solved.responses);
        let mut contacts = list.iter().zip(&responses.contacts);
        let mut turns = terms.turns.iter().zip(&responses.turns);
        contacts.any(|(c, r)| {
            own(c) && (c.load > 0.0 || r.presses() || r.friction.force != Vec3::zeros())
        }) || turns.any(|(turn, r)| own(&list[turn.contact]) && r.impulse != Vec3::zeros())
    };
    !step.terms.iter().zip(step.solved).any(pushed)
}

/// Puts what bodies on which nothing acts do within a step into its `end`.
///
/// - `here`: poses and inertias at its start
pub(super) fn go_on(ctx: &Context, here: &Kinematics, step: Step, end: &mut Physical) {
    for (index, _) in ctx.tree.moved() {
        if coasts(ctx, index, step) {
            coast(ctx, index, (here, step.from), step.h, end);
        }
    }
}

/// Whether each tree that a step works on is one free body on which nothing but contacts acts.
pub(super) fn are_rigid(ctx: &Context) -> bool {
    ctx.tree.moved().all(|(index, _)| is_rigid(ctx, index))
}

/// Puts what such bodies do within `h` seconds into `end`; tells whether that could be found.
///
/// - `here`: poses and inertias at the start `from`, where nothing touches
pub(super) fn fly(
    ctx: &Context,
    (here, from): (&Kinematics, &Physical),
    h: f64,
    end: &mut Physical,
) -> bool {
    let mut trees = ctx.tree.moved();
    trees.all(|(index, _)| coast(ctx, index, (here, from), h, end))
}

/// The same of one tree; tells whether it could be found.
fn coast(
    ctx: &Context,
    index: usize,
    (here, from): (&Kinematics, &Physical),
    h: f64,
    end: &mut Physical,
) -> bool {
    let tree = ctx.tree;
    let b = tree.trees[index].bodies.start;
    let body = &tree.bodies[b];
    let (q, v) = (&from.q[body.coordinate..], &from.v[body.dof..]);
    let (w, velocity) = (Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]));
    let I = &here.I[b];
    let center = I.center();
    let most = COASTING_TURN * libm::sqrt(libm::sqrt(ctx.tolerance));
    let Some((turn, after)) = tumble(&I.about_center(), w, h, most) else {
        return false;
    };
    let place = [q[3], q[4], q[5], q[6]];
    let place = quaternion_normalized(&quaternion_product(&turn, &place));
    let Q = rotation_from_quaternion(&turn);
    let gravity = tree.world.gravity;
    let speed = velocity + w.cross(&center);
    let (w, moved) = (Q * after, Q * center);
    let way = (center - moved) + speed * h + gravity * (0.5 * h * h);
    let velocity = speed + gravity * h - w.cross(&moved);
    let finite = |x: &Vec3| x.iter().all(|x| x.is_finite());
    if !(finite(&way) && finite(&velocity) && finite(&w)) {
        return false;
    }
    for i in 0..3 {
        end.q[body.coordinate + i] = q[i] + way[i];
        end.v[body.dof + i] = w[i];
        end.v[body.dof + 3 + i] = velocity[i];
    }
    end.q[body.coordinate + 3..body.coordinate + 7].copy_from_slice(&place);
    true
}

/// Turn of a body within `h` seconds, as a quaternion w, x, y, z, and its angular velocity then in
/// axes that have turned with it; none of what is thin, or turns too far.
///
/// - `I`: about its centre of mass, kg·m²; `w`: at the start, rad/s; both in the axes of the start
/// - `most`: angle between two places at which Euler's equations are solved, rad
fn tumble(I: &Mat3, mut w: Vec3, h: f64, most: f64) -> Option<([f64; 4], Vec3)> {
    let inverse = I.try_inverse()?;
    if I.trace() * inverse.trace() * THIN >= 1.0 {
        return None;
    }
    let parts = libm::ceil(w.norm() * h / most).max(1.0);
    if parts > COASTING_MOST || parts.is_nan() {
        return None;
    }
    let mut turn = [1.0, 0.0, 0.0, 0.0];
    let mut part = 0.0;
    while part < parts {
        for share in [OUTER, 1.0 - 2.0 * OUTER, OUTER] {
            let s = share * h / parts;
            let mut middle = w;
            for _ in 0..COASTING_ITERATIONS {
                let L = I * middle;
                let off = (L - I * w) * 2.0 + middle.cross(&L) * s;
                let slope = I * 2.0 + (middle.cross_matrix() * I - L.cross_matrix()) * s;
                let by = slope.try_inverse()? * off;
                middle -= by;
                // The error of the next place is the square of this.
                if by.norm_squared() <= COASTING_ACCURACY * w.norm_squared() {
                    break;
                }
            }
            w = middle * 2.0 - w;
            let half = middle * (0.5 * s);
            let by = quaternion_normalized(&[1.0, half.x, half.y, half.z]);
            turn = quaternion_product(&turn, &by);
        }
        part += 1.0;
    }
    Some((quaternion_normalized(&turn), w))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energy and momentum stay to the last digits, at any turn within a step.
    #[test]
    fn a_body_alone_keeps_its_energy_and_its_momentum() {
        let I = Mat3::new(2.0, 0.3, -0.1, 0.3, 1.1, 0.2, -0.1, 0.2, 1.5);
        for h in [1e-3, 0.1, 1.0] {
            let w0 = Vec3::new(1.0, -2.0, 0.7);
            let (turn, w) = tumble(&I, w0, h, 0.05).expect("a compact body");
            let Q = rotation_from_quaternion(&turn);
            let energy = |w: &Vec3| 0.5 * w.dot(&(I * w));
            assert!((energy(&w) / energy(&w0) - 1.0).abs() < 1e-13, "{h}");
            assert!((Q * (I * w) - I * w0).norm() < 1e-13, "{h}");
        }
    }

    /// A symmetric body nutates: its axis goes round the momentum `L` by `|L|/I₁`, and the body
    /// turns about its axis by `w₃ (1 − I₃/I₁)` beside that (Euler; Goldstein, section 5.6).
    #[test]
    fn a_symmetric_body_nutates_as_euler_says() {
        let (across, along, h) = (1.0, 0.2, 0.7);
        let I = Mat3::from_diagonal(&Vec3::new(across, across, along));
        let w0 = Vec3::new(1.5, 0.0, 2.0);
        let (turn, _) = tumble(&I, w0, h, 0.05).expect("a compact body");
        let L = I * w0;
        let half = |axis: Vec3, angle: f64| {
            let (sin, cos) = libm::sincos(0.5 * angle);
            let v = axis.normalize() * sin;
            [cos, v.x, v.y, v.z]
        };
        let precession = half(L, L.norm() / across * h);
        let spin = half(Vec3::z(), w0.z * (1.0 - along / across) * h);
        let exact = quaternion_product(&precession, &spin);
        let off = (0..4).fold(0.0_f64, |most, i| most.max((turn[i] - exact[i]).abs()));
        assert!(off < 1e-6, "{off}");
    }
}
