//! Articulated-body simulator for URDF robots: contact, force-limited motors, error control.
//!
//! A robot goes from text to motion in four steps: [`urdf::read_str`] checks a URDF and reads its
//! meshes, [`assemble::build`] makes a [`model::Model`] of it with the [`settings`] of the user,
//! [`simulation::Simulation`] runs it, [`variables::table`] names what can be set and read. An FMU
//! carries the model ([`prepared`]) and begins at the third step.
//!
//! ```
//! # #[cfg(feature = "urdf")] {
//! use std::path::Path;
//! use std::sync::Arc;
//! use urdf2fmu_core::model::RootId;
//! use urdf2fmu_core::simulation::{OutputSlot, Simulation};
//! use urdf2fmu_core::{assemble, settings::Settings, urdf};
//!
//! let ball = r#"<robot name="ball"><link name="ball">
//!   <inertial>
//!     <mass value="1"/>
//!     <inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/>
//!   </inertial>
//!   <collision><geometry><sphere radius="0.1"/></geometry></collision>
//! </link></robot>"#;
//! let settings = Settings::parse("[initial]\nxyz = [0, 0, 1]", "ball.toml").unwrap();
//! let description =
//!     urdf::read_str(ball, "ball.urdf", Path::new("."), &urdf::ReadOptions::default()).unwrap();
//! let model = assemble::build(&description, &settings).unwrap().model;
//!
//! let mut simulation = Simulation::new(Arc::new(model));
//! simulation.initialize(0.0).unwrap();
//! simulation.advance_to(0.4).unwrap();
//! // Free fall: z = 1 − g t²/2.
//! let height = OutputSlot::BasePosition(RootId::ROBOT, 2);
//! let z = simulation.output(height);
//! assert!((z - (1.0 - 9.81 * 0.4 * 0.4 / 2.0)).abs() < 1e-9);
//! simulation.advance_to(3.0).unwrap();
//! // At rest on the ground, half of `contact.penetration` deep.
//! assert!((simulation.output(height) - (0.1 - 5e-5)).abs() < 1e-9);
//! # }
//! ```
//!
//! Inside, from the bottom up: [`spatial`] vectors, [`geometry`] of shapes, [`sparsity`] of the
//! joint-space matrix; the [`tree`] that follows from a model and its [`parameters`], the
//! [`inputs`]; [`kinematics`] and [`dynamics`]; the [`law`]s of [`force`] and what carries it; the
//! [`state`]; the [`step`]. The method is described in `docs/design.md`.
//!
//! # Bibliography
//!
//! - R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008.
//! - K. H. Hunt & F. R. E. Crossley, *Coefficient of restitution interpreted as damping in
//!   vibroimpact*, 1975.
//! - A. Castro, F. Permenter & X. Han, *An unconstrained convex formulation of compliant contact*,
//!   arXiv 2110.10107.
//! - A. Castro et al., *Irrotational contact fields*, arXiv 2312.03908.
//! - V. Kurtz & A. Castro, *CENIC*, arXiv 2511.08771.
//! - J. R. Dormand & P. J. Prince, *A family of embedded Runge–Kutta formulae*, 1980.
//! - E. Hairer, S. P. Nørsett & G. Wanner, *Solving Ordinary Differential Equations I*,
//!   Springer 1993.
//! - J. W. H. Liu, *The role of elimination trees in sparse factorization*, 1990.
// What runs once is compiled for size in a small library, see build/platforms/tools.sh.
#![cfg_attr(small, feature(optimize_attribute))]
#![forbid(unsafe_code)]

#[cfg(feature = "urdf")]
pub mod assemble;
pub mod clock;
pub mod closure;
pub mod continuous;
#[cfg(feature = "urdf")]
pub mod diagnostic;
pub mod digits;
pub mod dynamics;
#[cfg(feature = "urdf")]
pub mod encoding;
pub mod folder;
pub mod force;
pub mod geometry;
pub mod hash;
mod initial;
pub mod inputs;
pub mod joint;
pub mod kinematics;
pub mod law;
pub mod model;
#[cfg(feature = "urdf")]
pub mod parallel;
pub mod parameters;
#[cfg(feature = "urdf")]
pub mod pattern;
pub mod prepared;
pub mod range;
pub mod reading;
mod readout;
mod sensor;
#[cfg(feature = "urdf")]
pub mod settings;
pub mod simulation;
pub mod slots;
mod snapshot;
pub mod sparsity;
pub mod spatial;
#[cfg(test)]
mod spoil;
pub mod state;
pub mod step;
#[cfg(test)]
mod testing;
pub mod tree;
pub mod tuning;
#[cfg(feature = "urdf")]
pub mod urdf;
pub mod variables;
