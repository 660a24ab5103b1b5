//! Which forces dry friction can bear: of a point, and about an axis, those that are no longer
//! than the cap `F̄`; of a face see [`super::face`].

use crate::spatial::Vec3;
use std::ops::{Add, Div, Mul, Sub};

/// A displacement, velocity or force along a line ([`f64`]) or in a plane or in space ([`Vec3`]).
pub trait Vector:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Inner product.
    fn dot(&self, other: &Self) -> f64;

    /// Direction of a vector that is longer than `length`, and one over its own length; zero
    /// instead of the latter along a line, which has no directions but its own. None for a vector
    /// that is not longer.
    fn beyond(&self, length: f64) -> Option<(Self, f64)>;
}

impl Vector for f64 {
    #[inline]
    fn dot(&self, other: &Self) -> f64 {
        self * other
    }

    #[inline]
    fn beyond(&self, length: f64) -> Option<(Self, f64)> {
        if self.abs() <= length {
            None
        } else {
            Some((self.signum(), 0.0))
        }
    }
}

impl Vector for Vec3 {
    #[inline]
    fn dot(&self, other: &Self) -> f64 {
        Self::dot(self, other)
    }

    #[inline]
    fn beyond(&self, length: f64) -> Option<(Self, f64)> {
        let squared = self.norm_squared();
        if squared <= length * length {
            None
        } else {
            let inverse = 1.0 / squared.sqrt();
            Some((self * inverse, inverse))
        }
    }
}

/// The norm `H` of an element: it slips where the norm of what spring and damper give is more than
/// the cap.
pub trait Limit<X>: Copy + Default {
    /// Whether the element sticks.
    fn holds(&self, y: &X, cap: f64) -> bool;

    /// Whether it bears the force `y` as a spring does: the same under another cap that does so.
    fn springs(&self, y: &X, cap: f64) -> bool;

    /// What becomes of the force `y` of spring and damper.
    fn bear(&self, y: X, cap: f64) -> Borne<X>;

    /// Energy that a spring of unit stiffness holds with the force `y`, times two, N².
    fn twice_held(&self, y: &X, cap: f64) -> f64;
}

/// What an element makes of the force of its spring and damper.
#[derive(Clone, Copy, Debug)]
pub struct Borne<X> {
    /// The force.
    pub force: X,
    /// What is left of that of spring and damper.
    pub left: X,
    /// That as a share.
    pub share: f64,
    /// Unit vector along it; zero while the element sticks.
    pub slip: X,
    /// Derivative of the force with the cap; zero while the element sticks.
    pub growth: X,
}

/// The length of a vector.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radial;

impl<X: Vector> Limit<X> for Radial {
    #[inline]
    fn holds(&self, y: &X, cap: f64) -> bool {
        y.dot(y) <= cap * cap
    }

    #[inline]
    fn springs(&self, y: &X, cap: f64) -> bool {
        self.holds(y, cap)
    }

    #[inline]
    fn twice_held(&self, y: &X, _: f64) -> f64 {
        y.dot(y)
    }

    #[inline]
    fn bear(&self, y: X, cap: f64) -> Borne<X> {
        match y.beyond(cap) {
            None => Borne {
                force: y,
                left: y,
                share: 1.0,
                slip: X::default(),
                growth: X::default(),
            },
            Some((slip, inverse)) => Borne {
                force: slip * cap,
                left: slip * cap,
                share: cap * inverse,
                slip,
                growth: slip,
            },
        }
    }
}
