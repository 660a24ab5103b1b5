//! Poses and velocities, base to tip.
//!
//! All spatial quantities are in world axes about one common point O, the origin of the base: contact stiffness and
//! inertia of any body then add up without transforms, and a robot far from the world's origin loses no digits.
//!
//! Source: Featherstone 2008, chapters 2 and 4.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::spatial::{
    Mat3, Pose, SpatialInertia, Vec3, Vec6, add_scaled6, quaternion_exp, quaternion_log,
    quaternion_normalized, quaternion_product, rotation_from_quaternion,
};
use crate::tree::{Move, Tree};

/// What depends on `q` and `v` alone. Filled by the functions of this module and of [`crate::dynamics`].
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// O in the world, m.
    pub origin: Vec3,
    /// Pose of each body's solver frame: rotation to world axes, position from O.
    pub X: Vec<Pose>,
    /// Motion of each column: `V_child = V_parent + Σ S v`.
    pub S: Vec<Vec6>,
    /// Velocity of each body.
    pub V: Vec<Vec6>,
    /// Inertia of each body.
    pub I: Vec<SpatialInertia>,
    /// Inertia of each subtree; scratch of the mass matrix.
    pub composite: Vec<SpatialInertia>,
    /// Joint-space mass matrix with armature, packed as [`Tree::sparsity`] says.
    pub M: Vec<f64>,
    /// Reciprocal square of the scale of each degree of freedom: `1 / M_kk`.
    pub inverse_diagonal: Vec<f64>,
    /// `k(q, v)`: Coriolis, centrifugal and gravity terms, and what external wrenches take off them.
    pub bias: Vec<f64>,
    /// Forces of the bodies; scratch of the bias.
    pub force: Vec<Vec6>,
    /// Bias accelerations of the bodies; scratch of the bias.
    pub C: Vec<Vec6>,
}

impl Kinematics {
    /// Buffers for a tree.
    pub fn new(tree: &Tree) -> Self {
        let (nb, nv) = (tree.bodies.len(), tree.sparsity.len());
        Self {
            origin: Vec3::zeros(),
            X: vec![Pose::IDENTITY; nb],
            S: vec![[0.0; 6]; tree.dof.len()],
            V: vec![[0.0; 6]; nb],
            I: vec![SpatialInertia::default(); nb],
            composite: vec![SpatialInertia::default(); nb],
            M: vec![0.0; tree.sparsity.entries()],
            inverse_diagonal: vec![1.0; nv],
            bias: vec![0.0; nv],
            force: vec![[0.0; 6]; nb],
            C: vec![[0.0; 6]; nb],
        }
    }

    /// Poses, joint motions and inertias for `q`.
    pub fn update_poses(&mut self, tree: &Tree, q: &[f64]) {
        for (b, body) in tree.bodies.iter().enumerate() {
            let X = match body.motion {
                Move::Welded => {
                    self.origin = tree.base.p;
                    Pose {
                        R: tree.base.R,
                        p: Vec3::zeros(),
                    }
                }
                Move::Free => {
                    let c = body.coordinate;
                    self.origin = Vec3::new(q[c], q[c + 1], q[c + 2]);
                    // Columns 0 … 5 are the unit vectors: angular, then linear velocity of the origin.
                    for i in 0..6 {
                        self.S[body.column + i] =
                            std::array::from_fn(|k| f64::from(u8::from(k == i)));
                    }
                    Pose {
                        R: rotation_from_quaternion(&[q[c + 3], q[c + 4], q[c + 5], q[c + 6]]),
                        p: Vec3::zeros(),
                    }
                }
                Move::Turn => {
                    let parent = &self.X[body.parent];
                    let R = parent.R * body.X.R;
                    let p = parent.R * body.X.p + parent.p;
                    let angle = body.ratio * q[body.coordinate] + body.offset;
                    let (s, c) = libm::sincos(angle);
                    let (x, y, z) = (R.column(0), R.column(1), R.column(2));
                    let axis: Vec3 = z.into_owned();
                    let R = Mat3::from_columns(&[x * c + y * s, y * c - x * s, axis]);
                    let moment = p.cross(&axis);
                    let k = body.ratio;
                    self.S[body.column] = [
                        axis.x * k,
                        axis.y * k,
                        axis.z * k,
                        moment.x * k,
                        moment.y * k,
                        moment.z * k,
                    ];
                    Pose { R, p }
                }
                Move::Slide => {
                    let parent = &self.X[body.parent];
                    let R = parent.R * body.X.R;
                    let axis: Vec3 = R.column(2).into_owned();
                    let travel = body.ratio * q[body.coordinate] + body.offset;
                    let p = parent.R * body.X.p + parent.p + axis * travel;
                    let k = body.ratio;
                    self.S[body.column] = [0.0, 0.0, 0.0, axis.x * k, axis.y * k, axis.z * k];
                    Pose { R, p }
                }
                Move::Ball => {
                    let parent = &self.X[body.parent];
                    let c = body.coordinate;
                    let turn = rotation_from_quaternion(&[q[c], q[c + 1], q[c + 2], q[c + 3]]);
                    let R = parent.R * body.X.R * turn;
                    let p = parent.R * body.X.p + parent.p;
                    for i in 0..3 {
                        let axis: Vec3 = R.column(i).into_owned();
                        let moment = p.cross(&axis);
                        self.S[body.column + i] =
                            [axis.x, axis.y, axis.z, moment.x, moment.y, moment.z];
                    }
                    Pose { R, p }
                }
            };
            self.X[b] = X;
            self.I[b] = if body.mass > 0.0 {
                let c = X.p + X.R * body.com;
                SpatialInertia::new(body.mass, &c, &rotated(&X.R, &body.I_cm))
            } else {
                SpatialInertia {
                    rotational: rotated(&X.R, &body.I_cm),
                    ..SpatialInertia::default()
                }
            };
        }
    }

    /// Velocities of all bodies for `v`, into `self.V`.
    pub fn update_velocities(&mut self, tree: &Tree, v: &[f64]) {
        forward(tree, &self.S, v, &mut self.V);
    }
}

/// `V_i = V_parent + Σ S v`, base to tip; the base starts from rest.
#[inline]
pub fn forward(tree: &Tree, S: &[Vec6], v: &[f64], V: &mut [Vec6]) {
    for (b, body) in tree.bodies.iter().enumerate() {
        match body.motion {
            Move::Welded => V[b] = [0.0; 6],
            Move::Free => V[b] = std::array::from_fn(|k| v[k]),
            Move::Turn | Move::Slide => {
                let mut sum = V[body.parent];
                add_scaled6(&mut sum, &S[body.column], v[tree.dof[body.column]]);
                V[b] = sum;
            }
            Move::Ball => {
                let mut sum = V[body.parent];
                for c in body.column..body.column + 3 {
                    add_scaled6(&mut sum, &S[c], v[tree.dof[c]]);
                }
                V[b] = sum;
            }
        }
    }
}

/// `R I Rᵀ` of a symmetric matrix given and returned as xx, yy, zz, xy, xz, yz.
#[inline]
fn rotated(R: &Mat3, I: &[f64; 6]) -> [f64; 6] {
    let [xx, yy, zz, xy, xz, yz] = *I;
    let full = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let T = R * full;
    let e =
        |i: usize, j: usize| T[(i, 0)] * R[(j, 0)] + T[(i, 1)] * R[(j, 1)] + T[(i, 2)] * R[(j, 2)];
    [e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(0, 2), e(1, 2)]
}

/// `q ⊕ h v`: positions after moving with constant velocity `v` for `h` seconds. Reads `from`, writes `to`.
pub fn advance(tree: &Tree, from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
    for body in &tree.bodies {
        let c = body.coordinate;
        match body.motion {
            Move::Welded => {}
            Move::Free => {
                for i in 0..3 {
                    to[c + i] = from[c + i] + h * v[3 + i];
                }
                let turn = quaternion_exp(&(Vec3::new(v[0], v[1], v[2]) * h));
                let q = [from[c + 3], from[c + 4], from[c + 5], from[c + 6]];
                let q = quaternion_normalized(&quaternion_product(&turn, &q));
                to[c + 3..c + 7].copy_from_slice(&q);
            }
            Move::Turn | Move::Slide => {
                // A mimic body shares its coordinate: writing it twice gives the same value.
                to[c] = from[c] + h * v[tree.dof[body.column]];
            }
            Move::Ball => {
                let d = tree.dof[body.column];
                let turn = quaternion_exp(&(Vec3::new(v[d], v[d + 1], v[d + 2]) * h));
                let q = [from[c], from[c + 1], from[c + 2], from[c + 3]];
                let q = quaternion_normalized(&quaternion_product(&q, &turn));
                to[c..c + 4].copy_from_slice(&q);
            }
        }
    }
}

/// `b ⊖ a`: the velocity that leads from `a` to `b` in one second, see [`advance`].
pub fn difference(tree: &Tree, b: &[f64], a: &[f64], out: &mut [f64]) {
    for body in &tree.bodies {
        let c = body.coordinate;
        match body.motion {
            Move::Welded => {}
            Move::Free => {
                for i in 0..3 {
                    out[3 + i] = b[c + i] - a[c + i];
                }
                let qb = [b[c + 3], b[c + 4], b[c + 5], b[c + 6]];
                let qa = [a[c + 3], -a[c + 4], -a[c + 5], -a[c + 6]];
                let r = quaternion_log(&quaternion_product(&qb, &qa));
                out[..3].copy_from_slice(r.as_slice());
            }
            Move::Turn | Move::Slide => out[tree.dof[body.column]] = b[c] - a[c],
            Move::Ball => {
                let d = tree.dof[body.column];
                let qb = [b[c], b[c + 1], b[c + 2], b[c + 3]];
                let qa = [a[c], -a[c + 1], -a[c + 2], -a[c + 3]];
                let r = quaternion_log(&quaternion_product(&qa, &qb));
                out[d..d + 3].copy_from_slice(r.as_slice());
            }
        }
    }
}
