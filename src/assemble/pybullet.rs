//! Rotational inertia as `PyBullet` computes it from collision shapes.
//!
//! Measured on 3.2.7 through `getDynamicsInfo`, see `docs/pybullet.md`; held to it by the Python tests.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::spatial::{Mat3, Pose, Vec3};
use crate::urdf::CollisionDescription;

/// Collision margin of shapes that come from a URDF, m.
const MARGIN: f64 = 0.001;

/// Inertia tensor in the link's axes of a link of `mass` kg: that of the box about the shapes in the axes of
/// `<inertial>`, `X_LI`, as if its middle were the centre of mass.
///
/// A single shape that lies exactly in those axes counts as itself: a ball as a ball, a box without margin.
pub(super) fn inertia(mass: f64, X_LI: &Pose, shapes: &[CollisionDescription]) -> Mat3 {
    let X_IL = X_LI.inverse();
    let own = match shapes {
        [one] => {
            let X_IG = X_IL.compose(&one.X_LG);
            let same = X_IG.p == Vec3::zeros() && X_IG.R == Mat3::identity();
            same.then(|| alone(mass, &one.shape))
        }
        _ => None,
    };
    let moments = own.unwrap_or_else(|| {
        let (mut least, mut most) = (Vec3::repeat(f64::MAX), Vec3::repeat(f64::MIN));
        for collision in shapes {
            let (low, high) = bounds(&X_IL.compose(&collision.X_LG), &collision.shape);
            least = least.inf(&low);
            most = most.sup(&high);
        }
        let half = if shapes.is_empty() {
            Vec3::zeros()
        } else {
            (most - least) * 0.5
        };
        cuboid(mass, &half.add_scalar(MARGIN))
    });
    let I = X_LI.R * Mat3::from_diagonal(&moments) * X_LI.R.transpose();
    // Symmetric to the last bit.
    (I + I.transpose()) * 0.5
}

/// Principal moments of a solid box, kg·m².
fn cuboid(mass: f64, half: &Vec3) -> Vec3 {
    let [x, y, z] = [half.x, half.y, half.z].map(|h| h * h);
    Vec3::new(y + z, x + z, x + y) * (mass / 3.0)
}

/// Principal moments of a shape on its own.
fn alone(mass: f64, shape: &Shape) -> Vec3 {
    match shape {
        Shape::Sphere { radius } => Vec3::repeat(0.4 * mass * radius * radius),
        Shape::Box { half } => cuboid(mass, half),
        // Its margin is its radius, which is counted already.
        Shape::Capsule { .. } => {
            let (low, high) = own_bounds(shape);
            cuboid(mass, &((high - low) * 0.5))
        }
        // A hull's box has the margin twice, and once more when it is weighed.
        Shape::Cylinder { .. } | Shape::Hull { .. } => {
            let (low, high) = own_bounds(shape);
            cuboid(mass, &((high - low) * 0.5).add_scalar(3.0 * MARGIN))
        }
    }
}

/// Box around a shape in its own axes.
fn own_bounds(shape: &Shape) -> (Vec3, Vec3) {
    let reach = |sign: f64| {
        let depth = |i: usize| {
            let mut direction = Vec3::zeros();
            direction[i] = -sign;
            sign * shape.depth(&direction)
        };
        Vec3::new(depth(0), depth(1), depth(2))
    };
    (reach(-1.0), reach(1.0))
}

/// Box around a shape at `X_IG` in the axes of I: for boxes and hulls the box around its own turned box.
fn bounds(X_IG: &Pose, shape: &Shape) -> (Vec3, Vec3) {
    let (low, high) = match shape {
        Shape::Sphere { .. } => {
            let (low, high) = own_bounds(shape);
            return (X_IG.p + low, X_IG.p + high);
        }
        Shape::Capsule { .. } => own_bounds(shape),
        Shape::Box { half } => {
            let core = half.add_scalar(-MARGIN);
            (-core, core)
        }
        Shape::Cylinder { .. } | Shape::Hull { .. } => {
            let (low, high) = own_bounds(shape);
            (low.add_scalar(-MARGIN), high.add_scalar(MARGIN))
        }
    };
    let margin = match shape {
        Shape::Sphere { .. } | Shape::Capsule { .. } => 0.0,
        Shape::Box { .. } | Shape::Cylinder { .. } | Shape::Hull { .. } => MARGIN,
    };
    let middle = X_IG.p + X_IG.R * ((low + high) * 0.5);
    let half = (X_IG.R.abs() * ((high - low) * 0.5)).add_scalar(margin);
    (middle - half, middle + half)
}
