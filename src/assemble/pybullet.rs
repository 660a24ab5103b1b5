//! Rotational inertia as `PyBullet` computes it from collision shapes.
//!
//! It was measured on PyBullet 3.2.7 through `getDynamicsInfo`, see `docs/pybullet.md`; the Python
//! tests compare the two.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::geometry::Shape;
use crate::spatial::{Mat3, Pose, Vec3};
use crate::urdf::CollisionDescription;

/// Collision margin of shapes that come from a URDF, m.
const MARGIN: f64 = 0.001;

/// Inertia tensor in the link's axes of a link of `mass` kg: that of the box about the shapes in
/// the axes of `<inertial>`, `X_LI`, as if its middle were the centre of mass.
///
/// A single shape that lies there exactly, neither it nor the axes turned in the link, counts as
/// itself: a ball as a ball, a box without margin. (Two equal turns do not cancel to the last bit
/// in `PyBullet`, and so do not count.)
pub(super) fn inertia(mass: f64, X_LI: &Pose, shapes: &[CollisionDescription]) -> Mat3 {
    let X_IL = X_LI.inverse();
    // The parts of a mesh share its box, and count once.
    let same = |a: &CollisionDescription, b: &CollisionDescription| {
        a.part && b.part && a.mesh == b.mesh && a.X_LG.p == b.X_LG.p && a.X_LG.R == b.X_LG.R
    };
    let first = |i: &usize| *i == 0 || !same(&shapes[*i - 1], &shapes[*i]);
    let wholes: Vec<&CollisionDescription> = (0..shapes.len())
        .filter(first)
        .map(|i| &shapes[i])
        .collect();
    let own = match wholes[..] {
        [one] => {
            let turned = X_LI.R != Mat3::identity() || one.X_LG.R != Mat3::identity();
            let same = one.X_LG.p == X_LI.p && !turned;
            same.then(|| alone(mass, one))
        }
        _ => None,
    };
    let moments = own.unwrap_or_else(|| {
        let (mut least, mut most) = (Vec3::repeat(f64::MAX), Vec3::repeat(f64::MIN));
        for collision in wholes {
            let (low, high) = bounds(&X_IL.compose(&collision.X_LG), collision);
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
fn alone(mass: f64, collision: &CollisionDescription) -> Vec3 {
    let half = || {
        let (low, high) = own_bounds(collision);
        (high - low) * 0.5
    };
    match &collision.shape {
        Shape::Sphere { radius } => Vec3::repeat(0.4 * mass * radius * radius),
        // A capsule's margin is its radius, which is counted already.
        Shape::Box { .. } | Shape::Capsule { .. } => cuboid(mass, &half()),
        // A hull is weighed with three margins on each side.
        Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => Vec3::zeros(),
        Shape::Cylinder { .. } | Shape::Hull { .. } => {
            cuboid(mass, &half().add_scalar(3.0 * MARGIN))
        }
    }
}

/// Box around a shape in its own axes; of a mesh around all of it, not around the corners that its
/// hull keeps.
fn own_bounds(collision: &CollisionDescription) -> (Vec3, Vec3) {
    if let Some([low, high]) = collision.bounds {
        return (low, high);
    }
    let reach = |sign: f64| {
        let depth = |i: usize| {
            let mut direction = Vec3::zeros();
            direction[i] = -sign;
            sign * collision.shape.depth(&direction)
        };
        Vec3::new(depth(0), depth(1), depth(2))
    };
    (reach(-1.0), reach(1.0))
}

/// Box around a shape at `X_IG` in the axes of I: the box around its own turned box, but for balls.
fn bounds(X_IG: &Pose, collision: &CollisionDescription) -> (Vec3, Vec3) {
    let (low, high) = own_bounds(collision);
    // An OBJ file may hold several hulls: its compound has a margin of its own.
    let obj = collision.mesh.as_ref().and_then(|mesh| mesh.extension());
    let obj = obj.is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
    let (margin, R) = match collision.shape {
        Shape::Sphere { .. } | Shape::Plane | Shape::Field { .. } | Shape::Surface { .. } => {
            (0.0, Mat3::identity())
        }
        Shape::Capsule { .. } | Shape::Box { .. } => (0.0, X_IG.R),
        Shape::Hull { .. } if obj => (3.0 * MARGIN, X_IG.R),
        Shape::Cylinder { .. } | Shape::Hull { .. } => (2.0 * MARGIN, X_IG.R),
    };
    let middle = X_IG.p + X_IG.R * ((low + high) * 0.5);
    let half = R.abs() * ((high - low) * 0.5).add_scalar(margin);
    (middle - half, middle + half)
}
