//! Joint accelerations by the articulated-body algorithm, in O(n).
//!
//! Solves `M(q) vdot + k(q, v) = tau` without forming `M`. For trees without mimic joints: exact coupling of two
//! branches needs the joint-space matrix, see [`crate::dynamics::crba`].
//!
//! Source: Featherstone 2008, table 7.1, in world axes.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::spatial::{Vec6, add_scaled6, add6, cross_motion, dot6};
use crate::tree::{Move, Tree};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// Scratch of the algorithm.
#[derive(Clone, Debug)]
pub struct Articulated {
    IA: Vec<Matrix6<f64>>,
    pA: Vec<Vec6>,
    c: Vec<Vec6>,
    /// `IA S`, per column.
    U: Vec<Vec6>,
    /// Inverse of `Sᵀ IA S` of a body: a scalar in the corner, or 3×3.
    D: Vec<Matrix3<f64>>,
    /// `tau − Sᵀ pA`, per column.
    u: Vec<f64>,
    A: Vec<Vec6>,
}

impl Articulated {
    /// Buffers for a tree.
    pub fn new(tree: &Tree) -> Self {
        let (nb, nc) = (tree.bodies.len(), tree.dof.len());
        Self {
            IA: vec![Matrix6::zeros(); nb],
            pA: vec![[0.0; 6]; nb],
            c: vec![[0.0; 6]; nb],
            U: vec![[0.0; 6]; nc],
            D: vec![Matrix3::zeros(); nb],
            u: vec![0.0; nc],
            A: vec![[0.0; 6]; nb],
        }
    }

    /// Joint accelerations.
    ///
    /// - `kin`: poses, velocities for `v`, inertias, and `kin.bias` with the external wrenches in
    ///   `kin.force` *not* accumulated; this function recomputes the body forces itself and ignores wrenches
    /// - `tau`: `nv`, N·m or N
    /// - `vdot`: `nv`, overwritten
    ///
    /// # Panics
    /// If the tree has mimic joints.
    pub fn accelerations(
        &mut self,
        tree: &Tree,
        kin: &Kinematics,
        v: &[f64],
        tau: &[f64],
        vdot: &mut [f64],
    ) {
        assert!(
            tree.pure,
            "the articulated-body algorithm does not couple branches"
        );
        // Pass 1, base to tip: rigid inertia, velocity-product acceleration, bias force.
        for (b, body) in tree.bodies.iter().enumerate() {
            let (V, I) = (&kin.V[b], &kin.I[b]);
            self.c[b] = match body.motion {
                Move::Welded => [0.0; 6],
                Move::Free => {
                    let a = -crate::spatial::angular(V).cross(&crate::spatial::linear(V));
                    [0.0, 0.0, 0.0, a.x, a.y, a.z]
                }
                _ => {
                    let mut relative = [0.0; 6];
                    let columns = body.column..body.column + body.columns;
                    for (S, v) in kin.S[columns.clone()].iter().zip(&v[columns]) {
                        add_scaled6(&mut relative, S, *v);
                    }
                    cross_motion(V, &relative)
                }
            };
            self.IA[b] = full(I);
            self.pA[b] = crate::spatial::cross_force(V, &I.mul(V));
        }
        // Pass 2, tip to base: articulated inertia and bias force.
        for b in (1..tree.bodies.len()).rev() {
            let body = &tree.bodies[b];
            let columns = body.column..body.column + body.columns;
            let IA = self.IA[b];
            let mut D = Matrix3::identity();
            for c in columns.clone() {
                let U = IA * Vector6::from(kin.S[c]);
                self.U[c] = U.into();
                self.u[c] = tau[c] - dot6(&kin.S[c], &self.pA[b]);
                for a in columns.clone() {
                    D[(a - body.column, c - body.column)] = dot6(&kin.S[a], &self.U[c]);
                }
                D[(c - body.column, c - body.column)] += tree.armature[c];
            }
            // Positive definite: checked when the model was built.
            let D = invert(&D, body.columns);
            self.D[b] = D;
            let mut Ia = IA;
            let mut pa = self.pA[b];
            for i in 0..body.columns {
                let mut gain = 0.0;
                for j in 0..body.columns {
                    let d = D[(i, j)];
                    let (Ui, Uj) = (self.U[body.column + i], self.U[body.column + j]);
                    Ia -= Vector6::from(Ui) * Vector6::from(Uj).transpose() * d;
                    gain += d * self.u[body.column + j];
                }
                let Ui = self.U[body.column + i];
                add_scaled6(&mut pa, &Ui, gain);
            }
            let carried: Vec6 = (Ia * Vector6::from(self.c[b])).into();
            add6(&mut pa, &carried);
            self.IA[body.parent] += Ia;
            add6(&mut self.pA[body.parent], &pa);
        }
        // Pass 3, base to tip: accelerations; gravity as an upward acceleration of the base.
        let g = tree.gravity;
        let base = &tree.bodies[0];
        if base.motion == Move::Free {
            let mut a0 = self.c[0];
            for i in 0..3 {
                a0[3 + i] -= g[i];
            }
            let right = Vector6::from_fn(|i, _| {
                tau[i] - self.pA[0][i] - (self.IA[0] * Vector6::from(a0))[i]
            });
            let mut IA = self.IA[0];
            for i in 0..6 {
                IA[(i, i)] += tree.armature[i];
            }
            let x = IA
                .cholesky()
                .map_or(Vector6::zeros(), |factor| factor.solve(&right));
            for i in 0..6 {
                vdot[i] = x[i];
                self.A[0][i] = a0[i] + x[i];
            }
        } else {
            self.A[0] = [0.0, 0.0, 0.0, -g.x, -g.y, -g.z];
        }
        for b in 1..tree.bodies.len() {
            let body = &tree.bodies[b];
            let mut A = self.A[body.parent];
            add6(&mut A, &self.c[b]);
            let rest = Vector3::from_fn(|i, _| {
                if i < body.columns {
                    self.u[body.column + i] - dot6(&self.U[body.column + i], &A)
                } else {
                    0.0
                }
            });
            let x = self.D[b] * rest;
            for i in 0..body.columns {
                vdot[body.column + i] = x[i];
                add_scaled6(&mut A, &kin.S[body.column + i], x[i]);
            }
            self.A[b] = A;
        }
    }
}

/// Inverse of the leading `n` by `n` block, n = 1 or 3.
fn invert(D: &Matrix3<f64>, n: usize) -> Matrix3<f64> {
    if n == 1 {
        let mut inverse = Matrix3::zeros();
        inverse[(0, 0)] = 1.0 / D[(0, 0)];
        inverse
    } else {
        D.try_inverse().unwrap_or_else(Matrix3::zeros)
    }
}

/// The 6×6 matrix of an inertia.
fn full(I: &crate::spatial::SpatialInertia) -> Matrix6<f64> {
    let lower = I.lower();
    Matrix6::from_fn(|i, j| {
        let (i, j) = (i.max(j), i.min(j));
        lower[i * (i + 1) / 2 + j]
    })
}
