//! Poses and velocities, base to tip.
//!
//! All spatial quantities of a tree are in world axes about one common point O, the origin of its
//! base: contact stiffness and inertia of any body then add up without transforms, and a robot far
//! from the world's origin loses no digits. Each tree has an O of its own, so that what one tree
//! does has the same digits whatever else is in the world.
//!
//! Source: Featherstone 2008, chapters 2 and 4.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::closure::{Places, Rows};
use crate::joint::Mount;
use crate::spatial::{Mat3, Pose, SpatialInertia, Vec3, Vec6, velocity_at};
use crate::tree::{Tree, TreeCollider};

/// What depends on `q` and `v` alone. Filled by the functions of this module and of
/// [`crate::dynamics`], for the bodies that a step works on, see [`Tree::select`].
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// O of each tree in the world, m.
    pub origins: Vec<Vec3>,
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
    /// `k(q, v)`: Coriolis, centrifugal and gravity terms, and what external wrenches take off
    /// them.
    pub bias: Vec<f64>,
    /// Forces of the bodies; scratch of the bias.
    pub force: Vec<Vec6>,
    /// Bias accelerations of the bodies; scratch of the bias.
    pub C: Vec<Vec6>,
    /// Rows of closed loops: gaps and `J` with the mass matrix, `J̇v` with the bias.
    pub loops: Rows,
}

impl Kinematics {
    /// Buffers for a tree.
    #[cfg_attr(small, optimize(size))]
    pub fn new(tree: &Tree) -> Self {
        let (nb, nv) = (tree.bodies.len(), tree.sparsity.len());
        Self {
            origins: vec![Vec3::zeros(); tree.trees.len()],
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
            loops: Rows::new(tree),
        }
    }

    /// Gaps and rows of closed loops for the poses.
    pub fn update_loops(&mut self, tree: &Tree) {
        if !tree.closures.is_empty() {
            let Self {
                origins,
                X,
                S,
                loops,
                ..
            } = self;
            loops.find(tree, Places { origins, X, S });
        }
    }

    /// `J̇v` of closed loops for velocities and bias accelerations, after [`Self::update_loops`].
    pub fn update_loop_bias(&mut self, tree: &Tree) {
        if !tree.closures.is_empty() {
            let Self {
                origins,
                X,
                S,
                V,
                C,
                loops,
                ..
            } = self;
            loops.find_bias(tree, Places { origins, X, S }, (V, C));
        }
    }

    /// Poses, joint motions and inertias for `q`.
    pub fn update_poses(&mut self, tree: &Tree, q: &[f64]) {
        for span in &tree.island.spans {
            for (b, body) in tree.bodies_of(span) {
                let mount = Mount {
                    base: &tree.trees[body.tree].base,
                    parent: &self.X[body.parent],
                    X: &body.X,
                    ratio: body.ratio,
                    offset: body.offset,
                };
                let (q, S) = (&q[body.coordinate..], &mut self.S[body.column..]);
                let origin = &mut self.origins[body.tree];
                let X = body.kind.place(&mount, q, S, origin);
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
    }

    /// O of a body's tree in the world, m.
    #[inline]
    pub fn origin(&self, tree: &Tree, body: usize) -> &Vec3 {
        &self.origins[tree.bodies[body].tree]
    }

    /// Centre of a shape from O of its tree, m, and how fast one of its points moves at most, m/s.
    #[inline]
    pub fn ball(&self, collider: &TreeCollider) -> (Vec3, f64) {
        let (X_OB, V) = (&self.X[collider.body], &self.V[collider.body]);
        let center = X_OB.p + X_OB.R * collider.X.p;
        let spin = V[0].abs() + V[1].abs() + V[2].abs();
        // Terrain has no end and does not turn.
        let turning = if spin > 0.0 {
            spin * collider.radius
        } else {
            0.0
        };
        (center, velocity_at(V, &center).norm() + turning)
    }

    /// Velocities of all bodies for `v`, into `self.V`.
    pub fn update_velocities(&mut self, tree: &Tree, v: &[f64]) {
        forward(tree, &self.S, v, &mut self.V);
    }
}

/// `V_i = V_parent + Σ S v`, base to tip; the base starts from rest.
#[inline]
pub fn forward(tree: &Tree, S: &[Vec6], v: &[f64], V: &mut [Vec6]) {
    for span in &tree.island.spans {
        for (b, body) in tree.bodies_of(span) {
            let (S, v) = (&S[body.column..], &v[body.dof..]);
            V[b] = body.kind.velocity(&V[body.parent], S, v);
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

/// `q ⊕ h v`: positions after moving with constant velocity `v` for `h` seconds. Reads `from`,
/// writes `to`.
pub fn advance(tree: &Tree, from: &[f64], v: &[f64], h: f64, to: &mut [f64]) {
    for (_, body) in tree.worked_bodies() {
        let (from, to) = (&from[body.coordinate..], &mut to[body.coordinate..]);
        body.kind.advance(from, &v[body.dof..], h, to);
    }
}

/// Adds to the mean velocity of a way of `h` seconds, over which it changes by `change`, what makes
/// [`advance`] lead to its end.
pub fn wind(tree: &Tree, change: &[f64], h: f64, mean: &mut [f64]) {
    for (_, body) in tree.worked_bodies() {
        let (change, mean) = (&change[body.dof..], &mut mean[body.dof..]);
        body.kind.wind(change, h, mean);
    }
}

/// `b ⊖ a`: the velocity that leads from `a` to `b` in one second, see [`advance`].
pub fn difference(tree: &Tree, b: &[f64], a: &[f64], out: &mut [f64]) {
    for (_, body) in tree.worked_bodies() {
        let (b, a) = (&b[body.coordinate..], &a[body.coordinate..]);
        body.kind.difference(b, a, &mut out[body.dof..]);
    }
}

/// `q̇` for velocities `v`.
pub(crate) fn position_rates(tree: &Tree, q: &[f64], v: &[f64], rate: &mut [f64]) {
    for (_, body) in tree.worked_bodies() {
        let (q, rate) = (&q[body.coordinate..], &mut rate[body.coordinate..]);
        body.kind.position_rates(q, &v[body.dof..], rate);
    }
}
