//! Closed loops: the rows that they add to the equations of motion, and the forces that keep them.
//!
//! A loop requires `g(q) = 0`. Its rows are `J v = 0` for velocities, with `dg/dt = J v`, and
//! `J v̇ + J̇v = 0` for accelerations; its forces are `Jᵀλ`. All rows are in metres: those of
//! angles are multiplied by the reach of what turns.
//!
//! The force between two bodies acts on both at the midpoint of the two points, so that momenta are
//! kept to the last digit even where the points do not coincide exactly.

mod felt;
mod rows;
mod schur;
mod search;
mod skyline;
mod spare;

pub use felt::{Carried, Felt};
pub use rows::{Gap, Places, Rows};
pub use schur::Schur;

#[cfg(test)]
mod ropes;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
