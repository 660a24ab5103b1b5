//! How fast the bias turns that a step takes from its middle.
//!
//! Where a limb turns, what acts on it turns with it, at its own rate. A wheel turns without moving
//! anything, but keeps the axis of its angular momentum, `J ω` of its moment `J` about the unit
//! vector `a`: what carries it, with the inertia `I`, has the bias `Ω × J ω a` when it turns with
//! `Ω`, and free of forces it nutates. In
//!
//! ```text
//! I dΩ/dt = J ω a × Ω
//! ```
//!
//! the matrix `A = I⁻¹ J ω [a]×` has the trace 0, as `I⁻¹` is symmetric, the determinant 0, and
//! thus the eigenvalues 0 and `±i λ` with `λ²` the sum of its principal minors of second order.
//! With `det(I) I⁻¹` the matrix of cofactors, it is
//!
//! ```text
//! λ = J ω sqrt(aᵀ I a / det I)
//! ```
//!
//! `I` is that of the wheel and of the body which its joint hangs on. What else this body carries,
//! or hangs on, makes it slower.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::parts::{Tree, TreeBody};
use crate::spatial::{Mat3, RigidInertia, Vec3};
use crate::tuning::WHEEL;

impl Tree {
    /// Finds how fast each body makes the bias turn, see above.
    pub(super) fn find_spinning(&mut self) {
        for b in 0..self.bodies.len() {
            self.bodies[b].spinning = if self.is_wheel(b) {
                self.nutation(&self.bodies[b])
            } else {
                1.0
            };
        }
    }

    /// Whether a body turns about its joint's axis and looks the same to the rest of the robot
    /// however it has turned.
    fn is_wheel(&self, index: usize) -> bool {
        let body = &self.bodies[index];
        let [xx, yy, zz, xy, xz, yz] = body.I_cm;
        let eccentric = body.mass * (body.com.x * body.com.x + body.com.y * body.com.y);
        let uneven = (xx - yy).abs() + xy.abs() + xz.abs() + yz.abs() + eccentric;
        body.kind.turns_about_its_axis()
            && uneven <= WHEEL * (xx + yy + zz)
            && self
                .bodies
                .iter()
                .enumerate()
                .all(|(b, body)| b == index || body.parent != index)
    }

    /// `λ/ω` of a wheel; 0 on what never turns.
    fn nutation(&self, wheel: &TreeBody) -> f64 {
        let carrier = &self.bodies[wheel.parent];
        if carrier.kind.is_base() && carrier.columns == 0 {
            return 0.0;
        }
        let own = rigid(wheel);
        let I = own.transformed(&wheel.X).joined(&rigid(carrier)).I_cm;
        let a: Vec3 = wheel.X.R.column(2).into_owned();
        let rate = own.I_cm[(2, 2)] * (a.dot(&(I * a)) / I.determinant()).sqrt();
        // Round-off of the determinant of two bodies that are nearly a line.
        if rate.is_finite() { rate } else { 1.0 }
    }
}

/// Inertia of a body in its solver frame.
fn rigid(body: &TreeBody) -> RigidInertia {
    let [xx, yy, zz, xy, xz, yz] = body.I_cm;
    RigidInertia {
        mass: body.mass,
        com: body.com,
        I_cm: Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}
