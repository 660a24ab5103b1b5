//! Joint accelerations by the articulated-body algorithm, in O(n).
//!
//! Solves `M(q) vdot + k(q, v) = tau` without forming `M`. For trees without mimic joints: exact
//! coupling of two branches needs the joint-space matrix, see [`crate::dynamics::crba`].
//!
//! Source: Featherstone 2008, table 7.1, in world axes: inertias of parent and child add up without
//! transforms.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use super::rnea::{add_drag, add_wrenches};
use crate::inputs::ExternalWrench;
use crate::kinematics::Kinematics;
use crate::spatial::{Mat3, Vec3, Vec6, add_scaled6, add6, cross_force, dot6, multiply_lower};
use crate::tree::Tree;
use nalgebra::{Matrix6, Vector6};

/// Scratch of the algorithm.
#[derive(Clone, Debug)]
pub struct Articulated {
    /// Articulated inertia of each body: lower triangle of the 6×6 matrix, row by row.
    IA: Vec<[f64; 21]>,
    pA: Vec<Vec6>,
    c: Vec<Vec6>,
    /// `IA S`, per column.
    U: Vec<Vec6>,
    /// Inverse of `Sᵀ IA S`, per column; of a ball joint the inverse 3×3 matrix, a row per column.
    D: Vec<[f64; 3]>,
    /// `tau − Sᵀ pA`, per column.
    u: Vec<f64>,
    A: Vec<Vec6>,
}

#[cfg(test)]
crate::spoil::spoil!(Articulated: IA pA c U D u A;);

impl Articulated {
    /// Buffers for a tree.
    #[cfg_attr(small, optimize(size))]
    pub fn new(tree: &Tree) -> Self {
        let (nb, nc) = (tree.bodies.len(), tree.dof.len());
        Self {
            IA: vec![[0.0; 21]; nb],
            pA: vec![[0.0; 6]; nb],
            c: vec![[0.0; 6]; nb],
            U: vec![[0.0; 6]; nc],
            D: vec![[0.0; 3]; nc],
            u: vec![0.0; nc],
            A: vec![[0.0; 6]; nb],
        }
    }

    /// Joint accelerations.
    ///
    /// - `kin`: poses, joint motions, inertias, and velocities for `v`
    /// - `tau`: `nv`, N·m or N
    /// - `wrenches`: external wrenches on bodies, and the time since the communication point
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
        wrenches: (&[ExternalWrench], f64),
        vdot: &mut [f64],
    ) {
        self.accelerations_with(tree, kin, v, &tree.dofs.armature, tau, wrenches, vdot);
    }

    /// The same with another diagonal than [`crate::tree::Dofs::armature`] added to the mass
    /// matrix.
    ///
    /// # Panics
    /// If the tree has mimic joints.
    #[expect(clippy::too_many_arguments, reason = "all that acts")]
    pub fn accelerations_with(
        &mut self,
        tree: &Tree,
        kin: &Kinematics,
        v: &[f64],
        armature: &[f64],
        tau: &[f64],
        (wrenches, t): (&[ExternalWrench], f64),
        vdot: &mut [f64],
    ) {
        assert!(
            tree.pure,
            "the articulated-body algorithm does not couple branches"
        );
        // Base to tip: rigid inertia, velocity-product acceleration, bias force.
        for (b, body) in tree.worked_bodies() {
            let (V, I) = (&kin.V[b], &kin.I[b]);
            let S = &kin.S[body.column..];
            self.c[b] = body.kind.velocity_product(V, S, &v[body.dof..]);
            self.IA[b] = I.lower();
            self.pA[b] = cross_force(V, &I.mul(V));
        }
        add_drag(tree, kin, &mut self.pA);
        add_wrenches(kin, wrenches, t, &mut self.pA);
        for (b, body) in tree.worked_bodies().rev() {
            if body.kind.is_base() {
                continue;
            }
            if body.columns == 1 {
                self.fold_one(tree, kin, armature, tau, b);
            } else {
                self.fold_ball(tree, kin, armature, tau, b);
            }
        }
        self.spread(tree, kin, armature, tau, vdot);
    }

    /// Hangs the body `b` of a turning or sliding joint on its parent.
    #[inline]
    fn fold_one(&mut self, tree: &Tree, kin: &Kinematics, armature: &[f64], tau: &[f64], b: usize) {
        let body = &tree.bodies[b];
        let column = body.column;
        let S = &kin.S[column];
        let mut IA = self.IA[b];
        let mut pA = self.pA[b];
        let U = multiply_lower(&IA, S);
        let u = tau[column] - dot6(S, &pA);
        // Positive definite: checked when the model was built.
        let D = 1.0 / (dot6(S, &U) + armature[column]);
        let mut place = 0;
        for i in 0..6 {
            let scaled = U[i] * D;
            for (x, y) in IA[place..=place + i].iter_mut().zip(&U) {
                *x -= scaled * y;
            }
            place += i + 1;
        }
        add6(&mut pA, &multiply_lower(&IA, &self.c[b]));
        add_scaled6(&mut pA, &U, D * u);
        self.U[column] = U;
        self.u[column] = u;
        self.D[column][0] = D;
        for (sum, x) in self.IA[body.parent].iter_mut().zip(&IA) {
            *sum += x;
        }
        add6(&mut self.pA[body.parent], &pA);
    }

    /// Hangs the body `b` of a ball joint on its parent.
    fn fold_ball(
        &mut self,
        tree: &Tree,
        kin: &Kinematics,
        armature: &[f64],
        tau: &[f64],
        b: usize,
    ) {
        let body = &tree.bodies[b];
        let first = body.column;
        let mut IA = self.IA[b];
        let mut pA = self.pA[b];
        let mut D = Mat3::zeros();
        for i in 0..3 {
            let S = &kin.S[first + i];
            let U = multiply_lower(&IA, S);
            self.U[first + i] = U;
            self.u[first + i] = tau[first + i] - dot6(S, &pA);
            for j in 0..3 {
                D[(j, i)] = dot6(&kin.S[first + j], &U);
            }
            D[(i, i)] += armature[first + i];
        }
        let D = D.try_inverse().unwrap_or_else(Mat3::zeros);
        for i in 0..3 {
            let mut scaled = [0.0; 6];
            let mut gain = 0.0;
            for j in 0..3 {
                self.D[first + i][j] = D[(i, j)];
                add_scaled6(&mut scaled, &self.U[first + j], D[(i, j)]);
                gain += D[(i, j)] * self.u[first + j];
            }
            let U = self.U[first + i];
            let mut place = 0;
            for row in 0..6 {
                for (x, y) in IA[place..=place + row].iter_mut().zip(&scaled) {
                    *x -= U[row] * y;
                }
                place += row + 1;
            }
            add_scaled6(&mut pA, &U, gain);
        }
        add6(&mut pA, &multiply_lower(&IA, &self.c[b]));
        for (sum, x) in self.IA[body.parent].iter_mut().zip(&IA) {
            *sum += x;
        }
        add6(&mut self.pA[body.parent], &pA);
    }

    /// Acceleration of the base `b`, with gravity as an upward acceleration.
    fn release(&mut self, b: usize, g: &Vec3, armature: &[f64], tau: &[f64], vdot: &mut [f64]) {
        if vdot.is_empty() {
            self.A[b] = [0.0, 0.0, 0.0, -g.x, -g.y, -g.z];
            return;
        }
        let mut a0 = self.c[b];
        for i in 0..3 {
            a0[3 + i] -= g[i];
        }
        let carried = multiply_lower(&self.IA[b], &a0);
        let right = Vector6::from_fn(|i, _| tau[i] - self.pA[b][i] - carried[i]);
        let IA = Matrix6::from_fn(|i, j| {
            let (high, low) = (i.max(j), i.min(j));
            let armature = if i == j { armature[i] } else { 0.0 };
            self.IA[b][high * (high + 1) / 2 + low] + armature
        });
        let x = IA
            .cholesky()
            .map_or(Vector6::zeros(), |factor| factor.solve(&right));
        vdot.copy_from_slice(x.as_slice());
        self.A[b] = std::array::from_fn(|i| a0[i] + x[i]);
    }

    /// Base to tip: accelerations; gravity as an upward acceleration of the base.
    fn spread(
        &mut self,
        tree: &Tree,
        kin: &Kinematics,
        armature: &[f64],
        tau: &[f64],
        vdot: &mut [f64],
    ) {
        let g = tree.world.gravity;
        for (b, body) in tree.worked_bodies() {
            if body.kind.is_base() {
                let dofs = body.dof..body.dof + body.columns;
                let (armature, tau) = (&armature[dofs.clone()], &tau[dofs.clone()]);
                if let (true, Some(a)) = (tree.is_driven(b), &tree.trees[body.tree].driven) {
                    vdot[dofs].copy_from_slice(a);
                    self.A[b] = std::array::from_fn(|i| self.c[b][i] + a[i]);
                    for i in 0..3 {
                        self.A[b][3 + i] -= g[i];
                    }
                    continue;
                }
                self.release(b, &g, armature, tau, &mut vdot[dofs]);
                continue;
            }
            let mut A = self.A[body.parent];
            add6(&mut A, &self.c[b]);
            let columns = body.column..body.column + body.columns;
            if body.columns == 1 {
                let c = body.column;
                let x = self.D[c][0] * (self.u[c] - dot6(&self.U[c], &A));
                vdot[c] = x;
                add_scaled6(&mut A, &kin.S[c], x);
            } else {
                let mut rest = [0.0; 3];
                for (rest, c) in rest.iter_mut().zip(columns.clone()) {
                    *rest = self.u[c] - dot6(&self.U[c], &A);
                }
                for c in columns {
                    let x = self.D[c].iter().zip(&rest).map(|(d, r)| d * r).sum();
                    vdot[c] = x;
                    add_scaled6(&mut A, &kin.S[c], x);
                }
            }
            self.A[b] = A;
        }
    }
}
