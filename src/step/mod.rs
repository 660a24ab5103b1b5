//! One communication step: the implicit and the explicit method, and the control of their steps.
//!
//! | file | what |
//! |---|---|
//! | `driver` | from one communication point to the next: propose, cap, try, guard, accept |
//! | `communication`, `islands` | begin and end of a communication step; which trees go together |
//! | `settle` | rest, and what is set down |
//! | `size` | lengths of steps; what becomes of a try |
//! | `caps` | where a step must end |
//! | `guards`, `flight` | what a try must not do: make energy, lose momentum |
//! | `company` | who has pushed whom |
//! | `coast` | bodies on which nothing acts |
//! | `going` | steps in which nothing touches |
//! | `ends`, `closing` | loops are closed at the end of a step |
//! | `attempt` | a try of a step, accepted whole or dropped |
//! | `implicit`, `convex` | convex solves, their error, extrapolation |
//! | `explicit` | Runge–Kutta pairs |
//! | `fixed` | rules of steps of a length that the user fixes |
//! | `point` | the robot at the start of a step |
//!
//! Every number of the method is in [`crate::tuning`].

mod attempt;
mod caps;
mod closing;
mod coast;
pub mod communication;
mod company;
pub mod convex;
pub mod driver;
mod ends;
pub mod explicit;
mod fixed;
mod flight;
mod going;
mod guards;
mod implicit;
pub mod islands;
pub mod point;
mod settle;
mod size;
mod stages;

pub use stages::late_acceleration;

#[cfg(test)]
mod tests;
