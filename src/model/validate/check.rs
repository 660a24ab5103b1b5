//! Single conditions that numbers, vectors and poses of a model must meet.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::model::ModelError;
use crate::spatial::{Mat3, Pose, Vec3};

/// Largest magnitude of any number: squares and products of a few of them stay finite.
const LARGEST: f64 = 1e50;

/// How far rotations and unit vectors may be off: far above round-off, far below what matters.
const UNIT_TOLERANCE: f64 = 1e-6;

pub(super) type Check = Result<(), ModelError>;

/// An error unless `holds`.
pub(super) fn require(holds: bool, part: impl FnOnce() -> String, wrong: &'static str) -> Check {
    if holds {
        Ok(())
    } else {
        Err(ModelError::Invalid {
            part: part(),
            wrong,
        })
    }
}

pub(super) fn number(value: f64) -> bool {
    value.is_finite() && value.abs() <= LARGEST
}

pub(super) fn not_negative(value: f64) -> bool {
    number(value) && value >= 0.0
}

pub(super) fn positive(value: f64) -> bool {
    number(value) && value > 0.0
}

pub(super) fn vector(v: &Vec3) -> bool {
    v.iter().all(|&x| number(x))
}

pub(super) fn unit(v: &Vec3) -> bool {
    vector(v) && (v.norm() - 1.0).abs() <= UNIT_TOLERANCE
}

pub(super) fn symmetric(I: &Mat3) -> bool {
    let size = I.iter().copied().map(f64::abs).fold(0.0, f64::max);
    I.iter().all(|&x| number(x)) && (I - I.transpose()).amax() <= 1e-9 * size
}

pub(super) fn pose(X: &Pose, part: impl Fn() -> String) -> Check {
    require(vector(&X.p), &part, "has a position that is not finite")?;
    let rotation = X.R.iter().all(|&x| number(x))
        && (X.R.transpose() * X.R - Mat3::identity()).amax() <= UNIT_TOLERANCE
        && X.R.determinant() > 0.0;
    require(rotation, &part, "has a rotation that is none")
}
