//! Points of a contact: corners of a face, and the lowest point of a cylinder's rim. What they do
//! together is in [`super::contact`].

use crate::spatial::{Vec3, across};

/// A point of a contact, as found at the start of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactPoint {
    /// Which one of its shape.
    pub corner: usize,
    /// Position from O, m, world axes.
    pub x: Vec3,
    /// Depth along the normal, negative apart, m.
    pub depth: f64,
    /// Share `m_i` in a face.
    pub share: f64,
    /// Share `ŵ_i` of the load at the start; 0 of all points where none is inside.
    pub load: f64,
    /// The rim whose lowest point it is, of a cylinder.
    pub rim: Option<Rim>,
}

/// The rim of a cylinder, as it stands at the start of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rim {
    /// The cylinder's axis, a unit vector.
    pub axis: Vec3,
    /// m
    pub radius: f64,
    /// What of the axis lies in the tangent plane, times the radius, m.
    pub a: Vec3,
    /// Crown, m.
    pub crown: f64,
    /// The same for damping, m: as deep as the contact is under a load, so that the far side of
    /// the face lands like the corner of a box.
    pub landing: f64,
}

impl Rim {
    /// Where `a` goes that moves by `tilt`, its `q = √(|a|² + s²)`, how much deeper the lowest
    /// point then is than the point that was the lowest one, and `e₀ − e`.
    #[inline]
    pub(super) fn tilted(&self, tilt: &Vec3) -> (Vec3, f64, f64, Vec3) {
        let length = |a: &Vec3| (a.norm_squared() + self.crown * self.crown).sqrt();
        let a = self.a + tilt;
        let (q0, q) = (length(&self.a), length(&a));
        let e0 = self.a / q0;
        // The difference of the two lengths by their squares: it may be small.
        let longer = (a - self.a).dot(&(a + self.a)) / (q + q0);
        (a, q, longer - e0.dot(tilt), e0 - a / q)
    }

    /// `T x` for a vector in the tangent plane.
    #[inline]
    fn tilting(&self, x: &Vec3) -> Vec3 {
        let squared = self.a.norm_squared() + self.crown * self.crown;
        let chi = self.crown * self.crown / squared;
        x * chi + self.a * (self.a.dot(x) / squared)
    }

    /// `χ`: 1 where the face is flat on the ground, 0 where it leans.
    #[inline]
    pub(super) fn flatness(&self) -> f64 {
        let crown = self.crown * self.crown;
        crown / (self.a.norm_squared() + crown)
    }

    /// Share `½ χ²`, with `χ` of the landing, of the damping of rocking that acts against tilting.
    #[inline]
    pub(crate) fn tilt_damping(&self) -> f64 {
        let squared = self.landing * self.landing;
        let chi = squared / (self.a.norm_squared() + squared);
        0.5 * chi * chi
    }

    /// A unit vector across the axis.
    #[inline]
    pub(crate) fn axis_across(&self) -> Vec3 {
        across(&self.axis)
    }

    /// `ȧ`, m/s, for an angular velocity.
    #[inline]
    pub(super) fn rate(&self, normal: &Vec3, w: &Vec3) -> Vec3 {
        let across = w.cross(&self.axis) * self.radius;
        self.tilting(&(across - normal * normal.dot(&across)))
    }

    /// Turns the rim by the small rotation `w`; returns how much deeper its lowest point is than
    /// the point that was the lowest one.
    pub(super) fn shift(&mut self, normal: &Vec3, w: &Vec3) -> f64 {
        let (a, _, deeper, _) = self.tilted(&self.rate(normal, w));
        self.a = a;
        deeper
    }

    /// The moment that does to the body what `force`, along the tangent plane, does to `a`.
    #[inline]
    pub(crate) fn moment(&self, force: &Vec3) -> Vec3 {
        self.axis.cross(&self.tilting(force)) * self.radius
    }
}

/// Velocity of a contact point.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointVelocity {
    /// Along the normal, positive apart, m/s.
    pub along: f64,
    /// `ȧ` of its rim, m/s; zero without one.
    pub tilt: Vec3,
}

impl PointVelocity {
    /// This and `share` times another.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self, share: f64) -> Self {
        Self {
            along: self.along + share * other.along,
            tilt: self.tilt + other.tilt * share,
        }
    }
}

/// What a contact point gives for a velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointResponse {
    /// `w_i = ∂δ/∂d_i`.
    pub weight: f64,
    /// `∂w_i/∂d_i` as far as the point is its own, `3 m_i (d_i/δ)²/δ`, 1/m.
    pub bend: f64,
    /// Impulse along the normal, N·s.
    pub impulse: f64,
    /// Damping of rocking, N, and its slope, N·s/m.
    pub rock: f64,
    /// See `rock`.
    pub rocking: f64,
    /// Impulse along `ȧ` of its rim, N·s; zero without one.
    pub tilting: Vec3,
    /// `e₀ − e`, by which its rim has tilted; zero without one.
    pub lean: Vec3,
    /// `a/q` and `1/q` of its rim at the end of the step.
    pub end: (Vec3, f64),
}

/// Depth `δ` of points and the sum of `∂δ/∂d_i`; the deepest one's and 1 where none is inside.
pub(super) fn norm(points: &[ContactPoint]) -> (f64, f64) {
    let (mut deepest, mut fourth, mut third) = (f64::NEG_INFINITY, 0.0, 0.0);
    for p in points {
        deepest = deepest.max(p.depth);
        let d = p.depth.max(0.0);
        third += p.share * d * d * d;
        fourth += p.share * d * d * d * d;
    }
    if deepest <= 0.0 {
        return (deepest, 1.0);
    }
    let delta = fourth.sqrt().sqrt();
    (delta, third / (delta * delta * delta))
}
