//! By how much a convex shape is to be lifted so that it touches a triangle.
//!
//! The distance `d` of two convex sets of which one is lifted by `t` is a convex function of `t`,
//! and its slope is the vertical part `n_z` of the unit vector `n` between their nearest points.
//! Newton's method, `t − d / n_z`, therefore comes to the first zero from one side without ever
//! passing it, from above as well as from below; where the slope changes its sign, the sets pass
//! each other. Any plane that separates the sets does the same, so that no step depends on how
//! exact the nearest points are.
//!
//! The shapes are the sharp ones, of which a face lies on a face and a corner on a corner.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::super::Shape;
use super::core::{Core, Solid};
use super::corners::Corners;
use super::gjk;
use super::placed::{Placed, separation};
use crate::spatial::{Pose, Vec3};

/// Distance at which two sets touch, as a share of their sizes: some hundred times the round-off of
/// the nearest points.
const TOUCH: f64 = 1e-13;
/// Steps of Newton's method, at most. A few are usual; where the sets graze each other, so that
/// distance and slope become zero together, each step leaves half of the distance.
const MOST_STEPS: usize = 64;

/// A shape that stands somewhere, as what is below it sees it.
#[derive(Clone, Debug)]
pub struct Lifted {
    solid: Solid,
    radius: f64,
    X: Pose,
    low: Vec3,
    high: Vec3,
}

impl Lifted {
    /// A convex shape at a pose; none of terrain.
    pub fn new(shape: &Shape, X: &Pose) -> Option<Self> {
        let (core, radius) = match shape {
            Shape::Sphere { radius } => (Core::Point, *radius),
            Shape::Capsule {
                radius,
                half_length: half,
            } => (Core::Segment { half: *half }, *radius),
            Shape::Cylinder {
                radius,
                half_length: half,
            } => (
                Core::Cylinder {
                    radius: *radius,
                    half: *half,
                },
                0.0,
            ),
            Shape::Box { half } => (Core::Box { half: *half }, 0.0),
            Shape::Hull { vertices } => (Core::Corners(Corners::new(vertices.clone())), 0.0),
            Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => return None,
        };
        let along = |k: usize, sign: f64| {
            let mut d = Vec3::zeros();
            d[k] = sign;
            sign * shape.lowest(X, &d)
        };
        Some(Self {
            solid: Solid {
                core,
                ..Solid::half_space()
            },
            radius,
            X: *X,
            low: Vec3::from_fn(|k, _| along(k, 1.0)),
            high: Vec3::from_fn(|k, _| along(k, -1.0)),
        })
    }

    /// Its height above z = 0, m: that of its lowest and of its highest point.
    pub fn heights(&self) -> [f64; 2] {
        [self.low.z, self.high.z]
    }

    /// The least and the greatest lift with which it touches a triangle that it comes higher than
    /// `above` for, m; none where it passes it.
    pub fn touching(&self, corners: &[Vec3; 3], above: f64) -> Option<[f64; 2]> {
        let [a, b, c] = corners;
        let (low, high) = (a.inf(b).inf(c), a.sup(b).sup(c));
        let beside = |k: usize| low[k] > self.high[k] || high[k] < self.low[k];
        let span = [low.z - self.high.z, high.z - self.low.z];
        if span[1] <= above || beside(0) || beside(1) {
            return None;
        }
        let triangle = Solid {
            core: Core::Corners(Corners::new(corners.to_vec())),
            ..Solid::half_space()
        };
        let greatest = self.first(&triangle, span, 1.0)?;
        Some([self.first(&triangle, span, -1.0)?, greatest])
    }

    /// Where it touches first: coming down from the end of `span`, or up from its start with the
    /// `way` −1.
    fn first(&self, triangle: &Solid, span: [f64; 2], way: f64) -> Option<f64> {
        let origin = self.X.p;
        let below = Placed::new(triangle, &Pose::IDENTITY, &origin);
        let size = (self.high - self.low).norm() + span[1].abs().max(span[0].abs());
        let touch = TOUCH * size;
        let mut lift = if way > 0.0 { span[1] } else { span[0] };
        for _ in 0..MOST_STEPS {
            let mut X = self.X;
            X.p.z += lift;
            let own = Placed::new(&self.solid, &X, &origin);
            let near = [self.radius + touch, f64::INFINITY];
            let Some(simplex) = gjk::distance(&own, &below, near) else {
                return Some(lift);
            };
            let (a, b) = simplex.nearest();
            let n = (a - b).normalize();
            // A plane between them, also where the nearest points have not been found to the end.
            let gap = separation(&own, &below, &n) - self.radius;
            if gap <= touch {
                return Some(lift);
            }
            if n.z * way <= 0.0 {
                return None;
            }
            lift -= gap / n.z;
            if !(span[0] - touch..=span[1] + touch).contains(&lift) {
                return None;
            }
        }
        Some(lift)
    }
}
