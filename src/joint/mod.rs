//! The kinds of motion that a joint can give a body, one file a kind.
//!
//! A kind says how many numbers it has in `q` and `v`, where the body is for given positions, which
//! motions its velocities mean, and how positions go on. `Freedom` lists all that a kind gives;
//! the macro in this file is the only place that tells kinds apart, so a new kind is a file, a line
//! in [`Kind`] and one in [`Motion`]. A planar or floating joint of a URDF is a chain of these.
//!
//! Slices that the methods of [`Kind`] take begin at the joint's first place in `q`, in `v` or
//! among the columns of `S`, and may be longer than the joint needs.
//!
//! Source: Featherstone 2008, chapter 4.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod ball;
mod free;
mod freedom;
mod slide;
mod turn;
mod welded;

use crate::spatial::{Mat3, Pose, Vec3, Vec6, quaternion_normalized, rotation_to_axis};
use freedom::Freedom;
pub use freedom::{Mount, Sweep};
use serde::{Deserialize, Serialize};

/// What a body's inboard joint lets it do, as a model states it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// A fixed base.
    Welded,
    /// A floating base: `q = [p_WB(3), quaternion(w, x, y, z)]`, `v = [ω_WB_W(3), ṗ_WB(3)]`.
    Free,
    /// Turns about a unit axis of its own frame: `q` in rad.
    Revolute(Vec3),
    /// Slides along a unit axis of its own frame: `q` in m.
    Prismatic(Vec3),
    /// Turns freely: `q = quaternion(w, x, y, z)` of `R_PB` after `X_PB`, `v = ω_PB_B`.
    Spherical,
}

/// The same without axes: in the solver's frames turning and sliding joints act along their own z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Does not move in the world: a fixed base.
    Welded,
    /// Moves in the world in six ways: a floating base.
    Free,
    /// Turns about z.
    Turn,
    /// Slides along z.
    Slide,
    /// Turns about any axis.
    Ball,
}

/// Evaluates `$call` with `$K` as the type that stands for `$kind`.
macro_rules! of_kind {
    ($kind:expr, $K:ident => $call:expr) => {
        match $kind {
            Kind::Welded => {
                type $K = welded::Welded;
                $call
            }
            Kind::Free => {
                type $K = free::Free;
                $call
            }
            Kind::Turn => {
                type $K = turn::Turn;
                $call
            }
            Kind::Slide => {
                type $K = slide::Slide;
                $call
            }
            Kind::Ball => {
                type $K = ball::Ball;
                $call
            }
        }
    };
}

impl Motion {
    /// The same without its axis.
    pub fn kind(self) -> Kind {
        match self {
            Self::Welded => Kind::Welded,
            Self::Free => Kind::Free,
            Self::Revolute(_) => Kind::Turn,
            Self::Prismatic(_) => Kind::Slide,
            Self::Spherical => Kind::Ball,
        }
    }

    /// The unit axis of a turning or sliding joint, in the body's frame.
    pub fn axis(self) -> Option<Vec3> {
        match self {
            Self::Revolute(axis) | Self::Prismatic(axis) => Some(axis),
            Self::Welded | Self::Free | Self::Spherical => None,
        }
    }

    /// Rotation `R_BS` of the solver's frame, whose z axis is the joint's axis, in the body's
    /// frame.
    pub fn solver_frame(self) -> Mat3 {
        self.axis()
            .map_or_else(Mat3::identity, |axis| rotation_to_axis(&axis))
    }

    /// Places in `q`.
    pub fn nq(self) -> usize {
        self.kind().nq()
    }

    /// Places in `v`.
    pub fn nv(self) -> usize {
        self.kind().nv()
    }
}

impl Kind {
    /// Places in `q`.
    pub fn nq(self) -> usize {
        of_kind!(self, K => K::NQ)
    }

    /// Places in `v`.
    pub fn nv(self) -> usize {
        of_kind!(self, K => K::NV)
    }

    /// Whether it is the motion of a base: the body hangs in the world.
    pub fn is_base(self) -> bool {
        of_kind!(self, K => K::BASE)
    }

    /// Whether it moves at all.
    #[inline]
    pub fn moves(self) -> bool {
        of_kind!(self, K => K::NV != 0)
    }

    /// Whether it is that of a floating base: its columns of `S` are the unit vectors.
    #[inline]
    pub fn is_free(self) -> bool {
        of_kind!(self, K => K::BASE && K::NV != 0)
    }

    /// Whether it turns about one axis that is fixed in the body.
    pub fn turns_about_its_axis(self) -> bool {
        of_kind!(self, K => K::NV == 1 && K::sweep(0) == Sweep::AboutAxis)
    }

    /// First place in `q` of the orientation w, x, y, z, where there is one.
    pub fn quaternion(self) -> Option<usize> {
        of_kind!(self, K => K::QUATERNION)
    }

    /// Positions at zero: no displacement, no rotation.
    pub fn identity(self, q: &mut [f64]) {
        q[..self.nq()].fill(0.0);
        if let Some(first) = self.quaternion() {
            q[first] = 1.0;
        }
    }

    /// Brings the quaternion in `q`, where there is one, back to unit length.
    #[inline]
    pub fn normalize(self, q: &mut [f64]) {
        if let Some(c) = self.quaternion() {
            let unit = quaternion_normalized(&[q[c], q[c + 1], q[c + 2], q[c + 3]]);
            q[c..c + 4].copy_from_slice(&unit);
        }
    }

    /// Pose of the body from O, with the motions of its velocities in `S`, both in world axes; a
    /// base also says where O is in the world.
    #[inline]
    pub fn place(self, mount: &Mount, q: &[f64], S: &mut [Vec6], origin: &mut Vec3) -> Pose {
        of_kind!(self, K => K::place(mount, &q[..K::NQ], &mut S[..K::NV], origin))
    }

    /// Velocity of the body about O: that of its parent and `S v`; a base starts from rest.
    #[inline]
    pub fn velocity(self, parent: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
        of_kind!(self, K => K::velocity(parent, &S[..K::NV], &v[..K::NV]))
    }

    /// Acceleration of the body about O that its velocity `V` makes beyond its parent's: `Ṡ v`.
    #[expect(
        clippy::inline_always,
        reason = "a call takes as long as a turning joint"
    )]
    #[inline(always)]
    pub fn velocity_product(self, V: &Vec6, S: &[Vec6], v: &[f64]) -> Vec6 {
        of_kind!(self, K => K::velocity_product(V, &S[..K::NV], &v[..K::NV]))
    }

    /// `q ⊕ h v`: positions after moving with the constant velocity `v` for `h` seconds.
    #[inline]
    pub fn advance(self, from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
        of_kind!(self, K => K::advance(&from[..K::NQ], &v[..K::NV], h, &mut to[..K::NQ]));
    }

    /// Adds to the mean velocity of a way of `h` seconds, over which it changes by `change`, what
    /// makes [`Self::advance`] lead to its end.
    #[inline]
    pub fn wind(self, change: &[f64], h: f64, mean: &mut [f64]) {
        of_kind!(self, K => K::wind(&change[..K::NV], h, &mut mean[..K::NV]));
    }

    /// `b ⊖ a`: the velocity that leads from `a` to `b` in one second.
    #[inline]
    pub fn difference(self, b: &[f64], a: &[f64], out: &mut [f64]) {
        of_kind!(self, K => K::difference(&b[..K::NQ], &a[..K::NQ], &mut out[..K::NV]));
    }

    /// `q̇` at `q` for the velocity `v`.
    #[inline]
    pub fn position_rates(self, q: &[f64], v: &[f64], rate: &mut [f64]) {
        of_kind!(self, K => K::position_rates(&q[..K::NQ], &v[..K::NV], &mut rate[..K::NQ]));
    }

    /// A small change of `q`, by place, as a change in the directions of `v`.
    #[inline]
    pub fn position_error(self, change: impl Fn(usize) -> f64, out: &mut [f64]) {
        of_kind!(self, K => K::position_error(change, &mut out[..K::NV]));
    }

    /// How fast the body turns in its parent, rad/s; `ratio` as in [`Mount`].
    #[inline]
    pub fn turn_rate(self, ratio: f64, v: &[f64]) -> f64 {
        of_kind!(self, K => K::turn_rate(ratio, &v[..K::NV]))
    }

    /// What an error in direction `axis` of `v` moves.
    pub fn sweep(self, axis: usize) -> Sweep {
        of_kind!(self, K => K::sweep(axis))
    }
}

#[cfg(test)]
mod tests;
