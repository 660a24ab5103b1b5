//! Joint-space dynamics `M(q) vdot + k(q, v) = tau`: mass matrix, bias, accelerations, energy.
//!
//! World axes about the common point O throughout, see [`crate::kinematics`]. Gravity and the
//! motion of O enter as the base's bias acceleration.

pub mod aba;
pub mod crba;
pub mod energy;
pub mod rnea;

#[cfg(test)]
mod tests;
