//! Terms that carry force and memory: contacts and their friction, friction against turning, and
//! along each degree of freedom damping, dry friction, limits and drives.
//!
//! Every term answers a velocity at the end of a step with an impulse that falls with it
//! (*respond*), tells what it remembers after the step (*next memory*), and what energy its springs
//! hold (*stored*). The laws themselves are in [`crate::law`]; [`Memory`] is what the terms of a
//! robot remember.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

mod act;
mod apart;
mod between;
mod cones;
mod contact;
mod detect;
mod drive;
mod gather;
mod joint;
mod kept;
mod meeting;
mod memory;
mod named;
mod pair;
mod pairs;
mod point;
mod remember;
mod secant;
mod spread;
mod spring;
mod terms;
mod turn;

pub use cones::Growth;
pub use contact::{Contact, Other, Response};
pub use detect::{detect, held, is_clear};
pub use drive::Drive;
pub use gather::ContactSet;
pub use joint::{JointResponse, JointTerm, Start, effort};
pub(crate) use memory::seek;
pub use memory::{Memory, Touch};
pub use named::NamedPairs;
pub use pair::{can_pass, light_touch};
pub use pairs::may_pass;
pub use point::{ContactPoint, PointResponse, PointVelocity, Rim};
pub use secant::Secant;
pub use spring::{SpringTerm, held_by_springs, pull_back, push_springs};
pub use terms::{Responses, Solved, Terms, Velocities};
pub use turn::{Turn, TurnResponse, find_turns};

#[cfg(test)]
pub(crate) mod tests;
