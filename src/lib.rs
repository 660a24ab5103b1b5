//! Articulated-body simulator for URDF robots: contact, force-limited motors, error control.
#![forbid(unsafe_code)]

pub mod geometry;
pub mod model;
pub mod prepared;
#[cfg(feature = "urdf")]
pub mod settings;
pub mod simulation;
pub mod spatial;
#[cfg(feature = "urdf")]
pub mod urdf;
pub mod variables;
