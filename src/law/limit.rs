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

    /// The vector, shortened to `length` where it is longer.
    #[must_use]
    fn clip(self, length: f64) -> Self;
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

    #[inline]
    fn clip(self, length: f64) -> Self {
        self.clamp(-length, length)
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

    #[inline]
    fn clip(self, length: f64) -> Self {
        let squared = self.norm_squared();
        if squared > length * length {
            self * (length / squared.sqrt())
        } else {
            self
        }
    }
}

/// What a friction element gives for a velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resistance<X> {
    /// Force against the velocity, N or N·m.
    pub force: X,
    /// Derivative of the force with the velocity in every direction but `slip`, N·s/m or N·m·s/rad.
    pub slope: f64,
    /// The same across the slip and the normal of a face.
    pub around: f64,
    /// Direction in which the element slips and the force does not change, the normal of the set of
    /// what it can bear; zero while it sticks.
    pub slip: X,
}

impl<X: Vector> Resistance<X> {
    /// Of an element that sticks, where the force changes with the velocity by `slope`.
    #[inline]
    pub fn sticking(force: X, slope: f64) -> Self {
        Self {
            force,
            slope,
            around: slope,
            slip: X::default(),
        }
    }
}

/// A convex set of forces about zero, in proportion to a cap.
pub trait Limit<X>: Copy + Default {
    /// Whether a force belongs to it.
    fn holds(&self, y: &X, cap: f64) -> bool;

    /// The nearest force of the set to one that changes with the velocity by `slope`.
    fn bear(&self, y: X, cap: f64, slope: f64) -> Resistance<X>;

    /// The same force alone.
    fn clip(&self, x: X, cap: f64) -> X;
}

/// A ball.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radial;

impl<X: Vector> Limit<X> for Radial {
    #[inline]
    fn holds(&self, y: &X, cap: f64) -> bool {
        y.dot(y) <= cap * cap
    }

    #[inline]
    fn bear(&self, y: X, cap: f64, slope: f64) -> Resistance<X> {
        match y.beyond(cap) {
            None => Resistance::sticking(y, slope),
            Some((slip, inverse)) => {
                let slope = slope * cap * inverse;
                Resistance {
                    force: slip * cap,
                    slope,
                    around: slope,
                    slip,
                }
            }
        }
    }

    #[inline]
    fn clip(&self, x: X, cap: f64) -> X {
        x.clip(cap)
    }
}
