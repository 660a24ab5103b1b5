//! One communication step: the convex step, smooth explicit steps, and the control of their size.

pub mod control;
pub mod convex;
pub mod smooth;

#[cfg(test)]
mod tests;
