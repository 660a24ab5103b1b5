//! The joint-space mass matrix by the composite-rigid-body algorithm.
//!
//! Source: Featherstone 2008, table 6.2, in world axes: no transforms between bodies.

#![allow(non_snake_case, reason = "frame notation, see docs/style.md")]

use crate::kinematics::Kinematics;
use crate::spatial::dot6;
use crate::tree::Tree;
use crate::tuning::DRIVEN_MASS;

/// Fills `kin.M` (with armature) and `kin.inverse_diagonal` from `kin.I` and `kin.S`, and the rows
/// of closed loops.
pub fn mass_matrix(tree: &Tree, kin: &mut Kinematics) {
    let Kinematics {
        S,
        I,
        composite,
        M,
        inverse_diagonal,
        ..
    } = kin;
    let pattern = &tree.sparsity;
    composite.copy_from_slice(I);
    if !tree.pure {
        M.fill(0.0);
    }
    for span in tree.island.spans.iter().rev() {
        for (b, body) in tree.bodies_of(span).rev() {
            if body.kind.is_free() {
                let lower = composite[b].lower();
                let first = pattern.start[body.dof];
                let rows = &mut M[first..first + 21];
                if tree.pure {
                    rows.copy_from_slice(&lower);
                } else {
                    for (m, x) in rows.iter_mut().zip(&lower) {
                        *m += x;
                    }
                }
                continue;
            }
            if !body.kind.moves() {
                continue;
            }
            // Not what the pattern looks like: the rows of a fixed serial chain of six joints or
            // more look the same as those on a floating base.
            let floating = tree.is_free(b);
            for c in body.column..body.column + body.columns {
                let F = composite[b].mul(&S[c]);
                if tree.pure {
                    let (start, depth) = (pattern.start[c], pattern.depth[c]);
                    let mut from = 0;
                    if floating {
                        M[start..start + 6].copy_from_slice(&F);
                        from = 6;
                    }
                    let places = &mut M[start + from..=start + depth];
                    let columns = &pattern.column[start + from..=start + depth];
                    for (m, &a) in places.iter_mut().zip(columns) {
                        *m = dot6(&S[a as usize], &F);
                    }
                } else {
                    add_row(tree, S, b, c, &F, M);
                }
            }
            let sub = composite[b];
            composite[body.parent].add(&sub);
        }
    }
    for k in tree.worked_dofs() {
        let diagonal = &mut M[pattern.diagonal(k)];
        *diagonal += tree.dofs.armature[k];
        inverse_diagonal[k] = 1.0 / diagonal.max(f64::MIN_POSITIVE);
    }
    for (_, first, _) in tree.driven() {
        for k in first..first + 6 {
            M[pattern.diagonal(k)] = DRIVEN_MASS;
            // Its scale is that of nothing else.
            inverse_diagonal[k] = 0.0;
        }
    }
    kin.update_loops(tree);
}

/// Fills `kin.inverse_diagonal` alone, for trees without mimic joints; `kin.M` stays as it is.
pub fn diagonal(tree: &Tree, kin: &mut Kinematics) {
    let Kinematics {
        S,
        I,
        composite,
        inverse_diagonal,
        ..
    } = kin;
    composite.copy_from_slice(I);
    for (b, body) in tree.worked_bodies().rev() {
        for c in body.column..body.column + body.columns {
            let diagonal = dot6(&S[c], &composite[b].mul(&S[c])) + tree.dofs.armature[c];
            inverse_diagonal[c] = 1.0 / diagonal.max(f64::MIN_POSITIVE);
        }
        if !body.kind.is_base() {
            let sub = composite[b];
            composite[body.parent].add(&sub);
        }
    }
    for (_, first, _) in tree.driven() {
        inverse_diagonal[first..first + 6].fill(0.0);
    }
}

/// Adds `S_aᵀ F` for column `c` of body `b` and every column `a` between the base and `c`, where
/// columns share degrees of freedom.
pub(crate) fn add_row(
    tree: &Tree,
    S: &[[f64; 6]],
    b: usize,
    c: usize,
    F: &[f64; 6],
    M: &mut [f64],
) {
    let pattern = &tree.sparsity;
    let dof = tree.dof[c];
    let mut other = b;
    loop {
        let body = &tree.bodies[other];
        for a in (body.column..body.column + body.columns).filter(|&a| a <= c) {
            let value = dot6(&S[a], F);
            let twice = if a != c && tree.dof[a] == dof {
                2.0
            } else {
                1.0
            };
            M[pattern.place(dof, tree.dof[a])] += twice * value;
        }
        if body.kind.is_base() {
            return;
        }
        other = body.parent;
    }
}
