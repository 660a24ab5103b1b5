//! Single conditions that numbers, vectors and poses of a model must meet.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::model::ModelError;
use crate::spatial::{Mat3, Pose, Vec3};

/// Largest magnitude of any number: squares and products of a few of them stay finite.
const LARGEST: f64 = 1e50;

/// How far rotations and unit vectors may be off: far above round-off, far below what matters.
const UNIT_TOLERANCE: f64 = 1e-6;

pub(super) type Check = Result<(), ModelError>;

// What follows is not inlined: a model has a hundred conditions, each with a copy of it otherwise.

/// An error unless `holds`.
pub(super) fn require(holds: bool, part: impl FnOnce() -> String, wrong: &'static str) -> Check {
    if holds { Ok(()) } else { refuse(part, wrong) }
}

/// Not inlined: the name of a part is then put together in one place for all conditions on it.
#[cold]
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn refuse(part: impl FnOnce() -> String, wrong: &'static str) -> Check {
    Err(ModelError::Invalid {
        part: part(),
        wrong,
    })
}

#[inline(never)]
pub(super) fn number(value: f64) -> bool {
    value.is_finite() && value.abs() <= LARGEST
}

#[inline(never)]
pub(super) fn not_negative(value: f64) -> bool {
    number(value) && value >= 0.0
}

#[inline(never)]
pub(super) fn positive(value: f64) -> bool {
    number(value) && value > 0.0
}

#[inline(never)]
pub(super) fn vector(v: &Vec3) -> bool {
    v.iter().all(|&x| number(x))
}

#[inline(never)]
pub(super) fn unit(v: &Vec3) -> bool {
    vector(v) && (v.norm() - 1.0).abs() <= UNIT_TOLERANCE
}

#[inline(never)]
pub(super) fn symmetric(I: &Mat3) -> bool {
    let size = I.iter().copied().map(f64::abs).fold(0.0, f64::max);
    I.iter().all(|&x| number(x)) && (I - I.transpose()).amax() <= 1e-9 * size
}

pub(super) fn pose(X: &Pose, part: impl Fn() -> String) -> Check {
    require(vector(&X.p), &part, "has a position that is not finite")?;
    require(rotation(&X.R), &part, "has a rotation that is none")
}

#[inline(never)]
fn rotation(R: &Mat3) -> bool {
    R.iter().all(|&x| number(x))
        && (R.transpose() * R - Mat3::identity()).amax() <= UNIT_TOLERANCE
        && R.determinant() > 0.0
}
