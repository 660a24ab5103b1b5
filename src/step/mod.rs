//! One communication step: the convex step, smooth explicit steps, and the control of their size.

mod cones;
pub mod control;
pub mod convex;
mod doubled;
mod energy;
mod fixed;
mod flight;
pub mod point;
pub mod runge_kutta;
mod single;
mod smooth;

#[cfg(test)]
mod tests;
