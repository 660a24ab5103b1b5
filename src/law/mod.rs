//! The pure laws of force: functions of gaps, displacements and velocities that know no robot.
//!
//! Each is the gradient of a convex function of the velocity at the end of the step, so that a step
//! is a convex minimisation whatever acts. What carries such a law, and where it acts, is in
//! [`crate::force`].

pub mod face;
pub mod friction;
pub mod leaving;
pub mod limit;
pub mod motor;
pub mod normal;
pub mod stop;

pub use face::Face;
pub use friction::{ElastoPlastic, stribeck};
pub use leaving::Damping;
pub use limit::{Limit, Radial, Resistance};
pub use motor::{SpeedLine, motor_constants};
pub use normal::{HuntCrossley, dissipation_number};
pub use stop::Stop;
