//! What every kind of joint gives, and what it is given.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::spatial::{Pose, Vec3, Vec6, add_scaled6, cross_motion};

/// What an error of one of a joint's velocities moves, and how far: the error weights follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// The whole subtree by as much.
    Along,
    /// Points of the subtree by their distance from the joint's z axis.
    AboutAxis,
    /// Points of the subtree by their distance from the joint's origin.
    AboutPoint,
}

/// Where a joint hangs, and how its coordinate is scaled.
#[derive(Clone, Copy, Debug)]
pub struct Mount<'a> {
    /// Pose of a fixed base in the world.
    pub base: &'a Pose,
    /// Pose of the parent body: rotation to world axes, position from O, m.
    pub parent: &'a Pose,
    /// Pose of the body in its parent where the joint stands at zero.
    pub X: &'a Pose,
    /// Multiplier of a mimic joint, else 1.
    pub ratio: f64,
    /// Offset of a mimic joint, rad or m, else 0.
    pub offset: f64,
}

/// What a kind of joint gives. Slices have exactly [`Self::NQ`] or [`Self::NV`] entries.
pub(super) trait Freedom {
    /// Places in `q`.
    const NQ: usize;
    /// Places in `v`, and columns of `S`.
    const NV: usize;
    /// Whether the body hangs in the world: O, about which all is expressed, is then its origin.
    const BASE: bool = false;
    /// First place in `q` of the orientation w, x, y, z, where there is one.
    const QUATERNION: Option<usize> = None;
    /// Pose of the body from O, with the motions of its velocities in `S`, both in world axes; a
    /// base also says where O is in the world.
    fn place(mount: &Mount, q: &[f64], S: &mut [Vec6], origin: &mut Vec3) -> Pose;

    /// Velocity of the body about O: that of its parent and `S v`.
    #[inline]
    fn velocity(parent: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
        let mut sum = *parent;
        for (S, v) in S.iter().zip(v) {
            add_scaled6(&mut sum, S, *v);
        }
        sum
    }

    /// Acceleration of the body about O that its velocity `V` makes beyond its parent's: `Ṡ v`.
    fn velocity_product(V: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6;

    /// Positions after moving with the constant velocity `v` for `h` seconds.
    fn advance(from: &[f64], v: &[f64], h: f64, to: &mut [f64]);

    /// Adds to the mean velocity of a way of `h` seconds, over which it changes evenly by `change`,
    /// what makes [`Self::advance`] lead to its end. Turns do not add up where their axis turns:
    /// with `ω = m + α t` from `−h/2` to `h/2`, the second term of Magnus' series of the rotation
    /// vector is
    ///
    /// ```text
    /// ½ ∫∫ ω(t) × ω(s) ds dt = ½ (α × m) ∫∫ (t − s) ds dt = h³/12 α × m,   s < t
    /// ```
    ///
    /// in the axes in which the turn begins, and its negative in those that turn along.
    ///
    /// Source: Iserles & Nørsett 1999.
    #[inline]
    fn wind(_change: &[f64], _h: f64, _mean: &mut [f64]) {}

    /// The velocity that leads from `a` to `b` in one second: the inverse of [`Self::advance`].
    fn difference(b: &[f64], a: &[f64], out: &mut [f64]);

    /// `q̇` at `q` for the velocity `v`.
    fn position_rates(q: &[f64], v: &[f64], rate: &mut [f64]);

    /// A small change of `q`, by place, as a change in the directions of `v`.
    fn position_error(change: impl Fn(usize) -> f64, out: &mut [f64]);

    /// How fast the body turns in its parent, rad/s; `ratio` as in [`Mount`].
    fn turn_rate(ratio: f64, v: &[f64]) -> f64;

    /// What an error in direction `axis` of `v` moves.
    fn sweep(axis: usize) -> Sweep;
}

/// Adds `h/12 change × mean` to an angular velocity, see [`Freedom::wind`]; `h` is negative in axes
/// that turn along.
#[inline]
pub(super) fn wind_turn(change: &[f64], h: f64, mean: &mut [f64]) {
    let [change, before] = [change, &*mean].map(|w| Vec3::new(w[0], w[1], w[2]));
    let winding = change.cross(&before) * (h / 12.0);
    for (mean, winding) in mean.iter_mut().zip(winding.iter()) {
        *mean += winding;
    }
}

/// `V × S v` of a joint with one column: its own share of `V` vanishes.
#[inline]
pub(super) fn one_column_product(V: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
    let mut c = cross_motion(V, &S[0]);
    for c in &mut c {
        *c *= v[0];
    }
    c
}
