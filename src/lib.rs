//! Articulated-body simulator for URDF robots: contact, force-limited motors, error control.
#![forbid(unsafe_code)]

pub mod actuator;
#[cfg(feature = "urdf")]
pub mod assemble;
pub mod contact;
pub mod dynamics;
pub mod geometry;
pub mod kinematics;
pub mod model;
pub mod parameters;
pub mod prepared;
mod readout;
#[cfg(feature = "urdf")]
pub mod settings;
pub mod simulation;
mod snapshot;
pub mod sparsity;
pub mod spatial;
pub mod state;
pub mod step;
#[cfg(test)]
mod testing;
pub mod tree;
#[cfg(feature = "urdf")]
pub mod urdf;
pub mod variables;
